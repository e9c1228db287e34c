#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include "core/base/processes/memory.h"

int main(int argc, char** argv) {
  homolog::keep_freed_memory();  // as the program does: a fifth of the time of a fit else goes to the system
  return doctest::Context(argc, argv).run();
}
