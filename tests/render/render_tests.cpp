#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <algorithm>
#include <string_view>

#include "render/offscreen.h"
#include "tests/skip.h"

/// One OpenGL context for all tests of the renderer. Without one they are skipped, with a sentence and exit status 77.
int main(int argc, char** argv) {
  const bool lists_only = std::any_of(argv, argv + argc, [](std::string_view arg) { return arg.find("list") == 2; });
  const auto gl = homolog::OffscreenContext::make();
  if (!gl && !lists_only) {
    homolog::test::skip(gl.error().sentence());
    return 77;
  }
  return doctest::Context(argc, argv).run();
}
