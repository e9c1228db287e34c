#include <doctest/doctest.h>

#include <imgui.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "app/editor/drawing/gallery_pictures.h"
#include "app/editor/widgets/imgui_context.h"
#include "app/editor/window/editor_app.h"
#include "app/editor/window/editor_picture.h"
#include "app/editor/work/models/study_folder.h"
#include "core/experiment/demo_case.h"
#include "core/mesh/construction/icosphere.h"
#include "render/offscreen.h"
#include "render/renderer.h"
#include "tests/must.h"
#include "tests/screens.h"
#include "tests/temporary_folder.h"

namespace homolog {

TEST_CASE("golden picture of the whole window") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  const Document document = test::must(demo_document(Organ::kidney, 1));
  std::vector<DrawnItem> items;
  const auto picture = [&](bool ShownParts::*left_out) {
    EditorPictureOptions options;
    options.items = &items;
    options.arrange = [left_out](EditorState& state) {
      state.look.window_low = -160;
      state.look.window_high = 240;
      state.preferences.hints = {true, true, true};
      if (left_out != nullptr) state.preferences.show.*left_out = false;
    };
    return test::must(editor_picture(EditSession(document), options));
  };
  const Picture without_outline = picture(&ShownParts::outline), without_surface = picture(&ShownParts::surface);
  const Picture whole = picture(nullptr);
  std::vector<test::PicturePart> parts{test::part_drawn("the outlines", whole, without_outline),
                                       test::part_drawn("the surface", whole, without_surface, 0.02)};
  test::add_items(parts, items, whole);
  CHECK(parts.size() > 100);
  test::check_golden(whole, "window", parts);
  // The button that is dark then is no outline.
  std::erase_if(parts, [](const test::PicturePart& part) { return part.name.starts_with("top bar/Outlines"); });
  CHECK(test::golden_fault(without_outline, whole, parts).find("the outlines: ") == 0);
}

namespace {

/// A study of phantom vertebrae, and options that show it.
struct ShownStudy {
  TemporaryFolder folder;
  EditorPictureOptions options;

  ShownStudy() {
    Progress progress;
    const std::filesystem::path path = test::must(make_phantom_study(Organ::vertebra, folder.path, progress));
    options.arrange = [path](EditorState& state) {
      show_study(state.models, test::must(read_study(path)).study, path);
    };
    options.models = StartEvaluation{};
  }
  Result<Picture> draw() const { return editor_picture(EditSession(new_document({}, nullptr, nullptr)), options); }
};

/// The editor that draws on a framebuffer of its own; an OpenGL context must be there.
struct DrawingEditor {
  ImGuiOnOpenGl imgui;
  EditorApp app{[] {}};

  explicit DrawingEditor(Document document) {
    REQUIRE(app.start_drawing(1));
    app.start_session(EditSession(std::move(document)));
  }
};

}  // namespace

TEST_CASE("a study is drawn in a window of any size") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  ShownStudy study;
  for (const auto& [width, height] : {std::pair(960, 640), std::pair(900, 600), std::pair(640, 480)}) {
    study.options.width_px = width;
    study.options.height_px = height;
    CHECK(study.draw());
  }
}

TEST_CASE("nothing of a grid before is left between the cells of the gallery") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  const auto renderer = test::must(Renderer::make());
  const Mesh ball = icosphere(3, 40);
  const auto state_of = [&](std::size_t shapes) {
    auto model = std::make_shared<StudyModel>();
    model->topology = ball.topology;
    model->mean = ball;
    model->hues = std::make_shared<const std::vector<float>>(static_cast<std::size_t>(ball.points.rows()), 0.3f);
    model->names.assign(shapes, "ball");
    PrincipalComponents components;
    components.mean = ball.points.reshaped<Eigen::RowMajor>();
    components.centred.setZero(components.mean.size(), static_cast<Eigen::Index>(shapes));
    model->components = std::make_shared<const PrincipalComponents>(std::move(components));
    ModelsState state;
    state.gallery.glyphs = false;
    state.made.model = std::move(model);
    state.gallery.camera.distance_mm = 60;  // larger than its cell
    return state;
  };
  ModelsLayout layout;
  layout.gallery = {0, 0, 200, 200};
  const auto screen = test::must(Framebuffer::make(200, 200, 1));
  const auto shown = [&](GalleryPictures& pictures) {
    screen->bind();
    pictures.copy(layout, 200);
    return screen->read().rgba;
  };
  GalleryPictures reused, fresh;
  for (const std::size_t shapes : {std::size_t{1}, std::size_t{4}}) reused.draw(state_of(shapes), layout, 1, *renderer);
  fresh.draw(state_of(4), layout, 1, *renderer);
  CHECK(shown(reused) == shown(fresh));
}

TEST_CASE("golden picture of the models") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  ShownStudy study;
  std::vector<DrawnItem> items;
  study.options.items = &items;
  const auto picture = test::must(study.draw());
  study.options.arrange = [arrange = study.options.arrange](EditorState& state) {
    arrange(state);
    state.models.gallery.glyphs = false;
  };
  study.options.items = nullptr;
  const auto without_glyphs = test::must(study.draw());
  std::vector<test::PicturePart> parts{test::part_drawn("the glyphs", picture, without_glyphs)};
  test::add_items(parts, items, picture);
  test::check_golden(picture, "models", parts);
}

TEST_CASE("an exported picture of the window is what is on the screen without what the pointer adds") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  DrawingEditor editor(test::must(demo_document(Organ::kidney, 1)));
  EditorApp& app = editor.app;
  app.state().preferences.hints = {true, true, true};
  constexpr int width = 1100, height = 700;
  const auto framebuffer = test::must(Framebuffer::make(width, height, 1));
  ImGuiIO& io = ImGui::GetIO();
  io.DeltaTime = 1.0f / 60;
  DrawnItems drawn;
  const auto frames = [&](ImVec2 pointer) {
    for (int k = 0; k < 3; ++k) {
      io.DisplaySize = {width, height};
      io.MousePos = pointer;
      framebuffer->bind();
      drawn.clear();
      app.settle();
      app.draw(width, height, 0);
    }
    return framebuffer->read();
  };
  const Picture untouched = frames({-FLT_MAX, -FLT_MAX});
  CHECK(frames({200, 22}).rgba != untouched.rgba);  // a button is lit, and explained
  PictureOptions options;
  options.width = 1600;
  options.height = 1200;
  CHECK(test::must(app.picture(options)).rgba == untouched.rgba);
}

TEST_CASE("a view is exported on a dark and a light and a transparent ground with captions or without") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  DrawingEditor editor(test::must(demo_document(Organ::kidney, 1)));
  EditorApp& app = editor.app;
  app.settle();
  ImGui::GetIO().DisplaySize = {1280, 800};
  const auto framebuffer = test::must(Framebuffer::make(1280, 800, 1));
  framebuffer->bind();
  app.draw(1280, 800, 0);
  for (const ViewKind view : {ViewKind::axial, ViewKind::space}) {
    PictureOptions options{view, 400, 300};
    const auto corner = [&] {
      const Picture picture = test::must(app.picture(options));
      return std::vector<int>(picture.rgba.begin(), picture.rgba.begin() + 4);
    };
    CHECK(corner()[0] < 40);
    const Picture captioned = test::must(app.picture(options));
    options.captions = false;
    CHECK(test::must(app.picture(options)).rgba != captioned.rgba);
    options.light = true;
    CHECK(corner() == std::vector<int>{255, 255, 255, 255});
    options.transparent = true;
    CHECK(corner()[3] == 0);
  }
}

TEST_CASE("the gallery and the modes are exported with their captions on any ground") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  const ShownStudy study;
  DrawingEditor editor(new_document({}, nullptr, nullptr));
  EditorApp& app = editor.app;
  study.options.arrange(app.state());
  app.settle();
  REQUIRE(app.state().models.made.model);
  ImGui::GetIO().DisplaySize = {1280, 800};
  for (const StudyPicture what : {StudyPicture::gallery, StudyPicture::modes}) {
    PictureOptions options;
    options.width = 640;
    options.height = 480;
    options.study = what;
    const Picture dark = test::must(app.picture(options));
    options.captions = false;
    CHECK(test::count_of(test::differing_pixels(dark, test::must(app.picture(options)), 100)) > 100);
    options.light = true;
    const Picture light = test::must(app.picture(options));
    CHECK(light.rgba[0] == 255);
    options.transparent = true;
    const Picture transparent = test::must(app.picture(options));
    CHECK(transparent.rgba[3] == 0);
    // The shapes are there on both: where the ground does not show through, they are the same.
    std::size_t drawn = 0;
    for (std::size_t i = 0; i < transparent.rgba.size(); i += 4) drawn += transparent.rgba[i + 3] == 255;
    CHECK(drawn > 5000);
  }
}

}  // namespace homolog
