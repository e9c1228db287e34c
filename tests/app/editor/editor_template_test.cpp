#include <doctest/doctest.h>

#include <atomic>

#include "app/editor/scene/mesh_colouring.h"
#include "app/editor/update/controls.h"
#include "app/editor/work/template_maker.h"
#include "core/mesh/voxels/label_map.h"
#include "core/session/session.h"
#include "tests/ball.h"
#include "tests/wait.h"

using namespace homolog;

namespace {

std::shared_ptr<const Volume> ball_labels() {
  VolumeGeometry grid;
  grid.dims = {50, 50, 50};
  grid.origin_mm.setConstant(-24.5);
  return std::make_shared<const Volume>(label_map(icosphere(4, 18), grid, 3));
}

TemplateSettings ball_settings(int vertices) {
  TemplateSettings settings;
  settings.label = settings.mask.label = 3;
  settings.mask.vertices = vertices;
  return settings;
}

std::shared_ptr<const TemplateMaking> finished(TemplateMaker& maker) {
  maker.finish();
  return maker.latest();
}

}  // namespace

TEST_CASE("the stiffness brush makes the action of what it paints and Alt reverses it") {
  const Document document = ball_document(20);
  EditorState state;
  state.hand.tool = MouseTool::stiffness;
  state.hand.brush.region = "hilum";
  const Vec3 at(0, 0, 20);
  state.hand.brush.paints = BrushPaints::factor;
  CHECK(std::get<PaintStiffness>(*brush_action(state, document, at)).value ==
        document.structure()->paint.base * state.hand.brush.stiffness_factor);
  state.hand.brush.paints = BrushPaints::region;
  CHECK(std::get<PaintRegion>(*brush_action(state, document, at)).name == "hilum");
  CHECK(shown_colouring(state) == Colouring::regions);
  state.pointer.drag = BrushDrag{ViewKind::space, 0, 0, 0, true, true};
  CHECK(std::get<PaintRegion>(*brush_action(state, document, at)).name.empty());
  state.hand.brush.paints = BrushPaints::fill;
  CHECK(std::get<FillRegion>(*brush_action(state, document, at)).name.empty());
  state.hand.brush.paints = BrushPaints::smooth;
  CHECK(std::holds_alternative<SmoothStiffness>(*brush_action(state, document, at)));
  CHECK(shown_colouring(state) == Colouring::stiffness);
}

TEST_CASE("regions colour the mesh as they say") {
  EditSession session(ball_document(20));
  REQUIRE(session.apply(SetRegion{{"hilum", 1, {255, 0, 0}}}));
  REQUIRE(session.apply(PaintRegion{"hilum", {0, 0, 20}, 10, 0}));
  const Document& document = session.document();
  const auto colours = mesh_colours(*document.view(), Colouring::regions, {}, 1);
  for (std::size_t i = 0; i < colours.size(); ++i)
    CHECK((colours[i] == Rgb{1, 0, 0}) == (document.structure()->paint.regions->of_vertex[i] == 1));
}

TEST_CASE("the template maker shows every stage and undo brings the one before back") {
  std::atomic<int> woken = 0;
  TemplateMaker maker([&] { ++woken; });
  CHECK(maker.latest() == nullptr);
  maker.start(ball_labels(), "ball.nii.gz", ball_settings(500));
  const auto first = finished(maker);
  REQUIRE(first->mesh);
  CHECK(first->mesh->points.rows() == 500);
  REQUIRE(first->stages.size() == 6);
  CHECK(first->stages.back().surface->points == first->mesh->points);
  CHECK(first->quality.self_intersections == 0);
  CHECK(woken >= 6);
  CHECK_FALSE(maker.can_undo());
  maker.start(ball_labels(), "ball.nii.gz", ball_settings(800));
  CHECK(test::wait_until([&] { return maker.update() && !maker.latest()->stages.empty(); }));
  CHECK(finished(maker)->mesh->points.rows() == 800);
  REQUIRE(maker.can_undo());
  maker.undo();
  CHECK(maker.latest()->mesh->points == first->mesh->points);
  CHECK(maker.latest()->stages.size() == 1);  // the other stages are those of the latest alone
  CHECK(maker.latest()->stages.back().surface == first->stages.back().surface);
  maker.forget();
  CHECK(maker.latest() == nullptr);
}

TEST_CASE("a template that cannot be made or is cancelled says so") {
  TemplateMaker maker([] {});
  TemplateSettings settings = ball_settings(500);
  settings.mask.label = 9;
  maker.start(ball_labels(), "ball.nii.gz", settings);
  const auto refused = finished(maker);
  CHECK_FALSE(refused->mesh);
  CHECK(refused->error.find("label 9 does not occur") != std::string::npos);
  maker.start(ball_labels(), "ball.nii.gz", ball_settings(20000));
  maker.cancel();
  CHECK_FALSE(finished(maker)->mesh);
}

TEST_CASE("a cancelled template leaves the one made before") {
  TemplateMaker maker([] {});
  maker.start(ball_labels(), "ball.nii.gz", ball_settings(500));
  const auto first = finished(maker);
  REQUIRE(first->mesh);
  for (int again = 0; again < 2; ++again) {
    maker.start(ball_labels(), "ball.nii.gz", ball_settings(20000));
    maker.cancel();
    CHECK(finished(maker) == first);
    CHECK_FALSE(maker.can_undo());
  }
  maker.start(ball_labels(), "ball.nii.gz", ball_settings(800));
  CHECK(finished(maker)->mesh->points.rows() == 800);
  maker.undo();
  CHECK(maker.latest()->mesh->points == first->mesh->points);
}
