#include "app/editor/window/editor.h"
#include "app/verbs/program.h"

int main(int argc, char** argv) {
  using namespace homolog;
  return run_program(
      argc, argv,
      {"Homolog: segment organs and put their meshes in correspondence in one stroke.\nWithout a verb it "
       "is the editor. With a verb it works without a display.",
       all_verbs, run_editor});
}
