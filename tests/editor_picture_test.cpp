#include <doctest/doctest.h>

#include "app/editor/demo.h"
#include "app/editor/editor_picture.h"
#include "tests/golden.h"
#include "tests/render_help.h"

namespace homolog {

TEST_CASE("golden picture of the whole window") {
  const auto gl = OffscreenContext::make();
  if (!gl) {
    MESSAGE("skipped: " << gl.error().sentence());
    return;
  }
  EditorPictureOptions options;
  options.arrange = [](EditorState& state) {
    state.window_low = -160;
    state.window_high = 240;
    state.preferences.hints = {true, true, true};
  };
  const auto picture = editor_picture(EditSession(test::must(demo_document(Organ::kidney, 1))), options);
  test::check_golden(test::must(picture), "window");
}

}  // namespace homolog
