#include <doctest/doctest.h>

#include <filesystem>

#include "app/editor/update/demo.h"
#include "app/editor/window/editor_picture.h"
#include "render/offscreen.h"
#include "tests/golden.h"
#include "tests/must.h"
#include "tests/temporary_folder.h"

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

TEST_CASE("a study is drawn in a window of any size") {
  const auto gl = OffscreenContext::make();
  if (!gl) {
    MESSAGE("skipped: " << gl.error().sentence());
    return;
  }
  const TemporaryFolder folder;
  Progress progress;
  const std::filesystem::path path = test::must(make_phantom_study(Organ::vertebra, folder.path, progress));
  for (const auto& [width, height] : {std::pair(960, 640), std::pair(900, 600), std::pair(640, 480)}) {
    EditorPictureOptions options;
    options.width_px = width;
    options.height_px = height;
    options.arrange = [&](EditorState& state) { show_study(state.models, test::must(read_study(path)).study, path); };
    options.models = StartEvaluation{};
    CHECK(editor_picture(EditSession(new_document({}, nullptr, nullptr)), options));
  }
}

TEST_CASE("golden picture of the models") {
  const auto gl = OffscreenContext::make();
  if (!gl) {
    MESSAGE("skipped: " << gl.error().sentence());
    return;
  }
  const TemporaryFolder folder;
  Progress progress;
  const std::filesystem::path path = test::must(make_phantom_study(Organ::vertebra, folder.path, progress));
  EditorPictureOptions options;
  options.arrange = [&](EditorState& state) { show_study(state.models, test::must(read_study(path)).study, path); };
  options.models = StartEvaluation{};
  const auto picture = editor_picture(EditSession(new_document({}, nullptr, nullptr)), options);
  test::check_golden(test::must(picture), "models");
}

}  // namespace homolog
