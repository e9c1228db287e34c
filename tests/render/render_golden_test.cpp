#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "core/mesh/colours.h"
#include "core/mesh/construction/icosphere.h"
#include "tests/golden.h"
#include "tests/render_help.h"

namespace homolog {
namespace {

/// A body with two organs and a spine in it, soft-edged, in CT numbers; and a label map of the organs.
struct Body {
  std::shared_ptr<const Volume> image, labels;
};

Body make_body() {
  VolumeGeometry grid;
  grid.dims = {80, 60, 50};
  grid.spacing_mm = Vec3(2.5, 2.5, 3);
  grid.origin_mm = Vec3(-98.75, -73.75, -73.5);
  struct Part {
    Vec3 centre, radii;
    double intensity;
  };
  const std::array<Part, 4> parts{
      Part{Vec3(0, 0, 0), Vec3(90, 65, 200), -80}, Part{Vec3(-45, 15, 5), Vec3(20, 24, 45), 120},
      Part{Vec3(45, 15, -5), Vec3(20, 24, 45), 90}, Part{Vec3(0, 38, 0), Vec3(16, 14, 200), 500}};
  const auto depth = [&](const Part& part, const Vec3& p) {
    return (1 - (p - part.centre).cwiseQuotient(part.radii).norm()) * part.radii.minCoeff();
  };
  const auto intensity = [&](int i, int j, int k) {
    const Vec3 p = grid.to_mm(Vec3(i, j, k));
    double value = -1000;
    for (const Part& part : parts) {
      const double share = std::clamp(depth(part, p) / 2.5 + 0.5, 0.0, 1.0);
      value += share * (part.intensity - value);
    }
    const int speckle = (i * 73 + j * 151 + k * 211 + i * j * 7 + j * k * 13) % 61 - 30;
    return std::round(value) + speckle;
  };
  const auto label = [&](int i, int j, int k) {
    const Vec3 p = grid.to_mm(Vec3(i, j, k));
    return depth(parts[1], p) > 0 ? 1 : depth(parts[2], p) > 0 ? 2 : depth(parts[3], p) > 0 ? 3 : 0;
  };
  return {test::volume_of<std::int16_t>(grid, intensity), test::volume_of<std::uint8_t>(grid, label)};
}

/// The organ on the left of the screen, as a mesh a little off its boundary, coloured by height.
MeshLayer make_organ() {
  Mesh organ = icosphere(4);
  std::vector<Rgb> colours;
  for (Eigen::Index i = 0; i < organ.points.rows(); ++i) {
    const Vec3 unit = organ.points.row(i);
    const double dent = 1 - 0.35 * std::exp(-6 * (unit - Vec3(1, 0, 0)).squaredNorm());
    organ.points.row(i) = (Vec3(-45, 15, 5) + unit.cwiseProduct(dent * Vec3(22, 25, 47))).transpose();
    colours.push_back(hsv_to_rgb(static_cast<float>(0.45 + 0.4 * unit.z()), 0.4f, 1));
  }
  MeshLayer layer = test::layer_of(organ);
  layer.colours = std::make_shared<const std::vector<Rgb>>(std::move(colours));
  return layer;
}

Scene make_scene() {
  Scene scene;
  const Body body = make_body();
  scene.image = {body.image, 0, -160, 240, true};
  scene.meshes.push_back(make_organ());
  const Points& points = *scene.meshes[0].points;
  for (Eigen::Index i = 0; i < 12; ++i) {
    const auto hue = static_cast<float>(i) / 12;
    scene.glyphs.glyphs.push_back({Vec3(points.row(i)), hsv_to_rgb(hue, 1, 1), 4});
  }
  scene.background = {0.075f, 0.08f, 0.09f, 1};
  return scene;
}

Camera3D camera_at(const Vec3& target, double distance_mm) {
  Camera3D camera;
  camera.target = target;
  camera.to_eye = Vec3(-0.5, -0.75, 0.4).normalized();
  camera.distance_mm = distance_mm;
  return camera;
}

/// A scene as it is drawn, and the same with something left out of it.
template <class View>
struct Drawing {
  const Scene& scene;
  View view;
  int width = 320, height = 240, samples = 1;

  Picture picture() const { return test::picture_of(scene, view, width, height, samples); }
  template <class LeaveOut>
  Picture without(const LeaveOut& leave_out) const {
    Scene less = scene;
    leave_out(less);
    return test::picture_of(less, view, width, height, samples);
  }
};

void no_outline(Scene& scene) {
  scene.meshes[0].outline = false;
}
void no_glyphs(Scene& scene) {
  scene.glyphs.glyphs.clear();
}
void no_lines(Scene& scene) {
  scene.lines.lines.clear();
}
void no_surface(Scene& scene) {
  scene.meshes[0].surface = false;
}

}  // namespace

TEST_CASE("golden picture of a slice with labels and an outline") {
  Scene scene = make_scene();
  scene.glyphs.glyphs.clear();
  scene.labels = {make_body().labels, 0, 0.3f};
  const Drawing<SliceView> drawing{scene, test::axial(Vec3(0, 0, 6), 0.7)};
  const Picture picture = drawing.picture();
  test::check_golden(picture, "slice_with_labels",
                     {test::part_drawn("the outline", picture, drawing.without(no_outline)),
                      test::part_drawn("the labels", picture, drawing.without([](Scene& s) { s.labels = {}; }), 0.01)});
}

TEST_CASE("golden picture of an oblique slice by nearest voxel with lines and discs") {
  Scene scene = make_scene();
  scene.image.linear = false;
  const Mat3 turn = Eigen::AngleAxisd(0.5, Vec3(0.2, 1, 0.3).normalized()).toRotationMatrix();
  const Vec3 centre(-40, 10, 5);
  const SliceView view{centre, turn.col(0), -turn.col(2), 0.5};
  scene.lines.lines.push_back({centre - 100 * view.right, centre + 100 * view.right, {0.95f, 0.77f, 0.3f, 0.8f}, 1});
  scene.lines.lines.push_back({centre - 100 * view.down, centre + 100 * view.down, {0.93f, 0.36f, 0.32f, 0.8f}, 1});
  scene.lines.lines.push_back({slice_point_mm(view, {0, 0, 320, 240, 1}, 40, 200),
                               slice_point_mm(view, {0, 0, 320, 240, 1}, 140, 180),
                               {1, 1, 1, 1},
                               3});
  const Drawing<SliceView> drawing{scene, view};
  const Picture picture = drawing.picture();
  test::check_golden(picture, "oblique_slice",
                     {test::part_drawn("the outline", picture, drawing.without(no_outline)),
                      test::part_drawn("the discs", picture, drawing.without(no_glyphs)),
                      test::part_drawn("the lines", picture, drawing.without(no_lines))});
}

TEST_CASE("golden picture of slices and a surface with glyphs in space") {
  Scene scene = make_scene();
  scene.planes = {{test::axial(Vec3(0, 0, -20), 1), 100, 75, {0.93f, 0.36f, 0.32f}},
                  {test::sagittal(Vec3(-20, 0, 0), 1), 75, 75, {0.95f, 0.77f, 0.3f}},
                  {test::coronal(Vec3(0, 40, 0), 1), 100, 75, {0.4f, 0.78f, 0.45f}}};
  const Drawing<Camera3D> drawing{scene, camera_at(Vec3::Zero(), 480), 400, 300, 4};
  const Picture picture = drawing.picture();
  test::check_golden(
      picture, "space",
      {test::part_drawn("the glyphs", picture, drawing.without(no_glyphs)),
       test::part_drawn("the surface", picture, drawing.without(no_surface), 0.02),
       test::part_drawn("the planes", picture, drawing.without([](Scene& s) { s.planes.clear(); }), 0.02)});
}

TEST_CASE("golden picture of a faint surface on a transparent background") {
  Scene scene = make_scene();
  scene.background = {0, 0, 0, 0};
  scene.meshes[0].surface_opacity = 0.4f;
  const Drawing<Camera3D> drawing{scene, camera_at(Vec3(-45, 15, 5), 220), 320, 240, 4};
  const Picture picture = drawing.picture();
  test::check_golden(picture, "faint_surface",
                     {test::part_drawn("the glyphs", picture, drawing.without(no_glyphs)),
                      test::part_drawn("the surface", picture, drawing.without(no_surface), 0.02)});
}

TEST_CASE("golden picture of a surface with its edges") {
  Scene scene = make_scene();
  scene.glyphs.glyphs.clear();
  scene.meshes[0].wireframe = true;
  const Drawing<Camera3D> drawing{scene, camera_at(Vec3(-45, 15, 5), 220), 320, 240, 4};
  const Picture picture = drawing.picture();
  test::check_golden(
      picture, "edges",
      {test::part_drawn("the edges", picture, drawing.without([](Scene& s) { s.meshes[0].wireframe = false; })),
       test::part_drawn("the surface", picture, drawing.without(no_surface), 0.02)});
}

TEST_CASE("a picture that lacks its outline or glyphs or shows them elsewhere is none like the golden one") {
  Scene scene = make_scene();
  scene.glyphs.glyphs.push_back({Vec3(-60, 15, 6), {1, 0, 0}, 3});
  const Drawing<SliceView> drawing{scene, test::axial(Vec3(0, 0, 6), 0.7)};
  const Picture golden = drawing.picture();
  const auto fault = [&](const Picture& picture) {
    return test::golden_fault(picture, golden,
                              {test::part_drawn("the outline", golden, drawing.without(no_outline)),
                               test::part_drawn("the glyphs", golden, drawing.without(no_glyphs))});
  };
  CHECK(fault(golden) == "");
  CHECK(fault(drawing.without(no_outline)).find("the outline: ") == 0);
  CHECK(fault(drawing.without(no_glyphs)).find("the glyphs: ") == 0);
  CHECK(fault(drawing.without([](Scene& s) { s.meshes[0].outline_px = 1; })).find("the outline: ") == 0);
  const Picture moved = drawing.without([](Scene& s) {
    s.meshes[0].points = std::make_shared<const Points>(s.meshes[0].points->rowwise() + Vec3(1.4, 0, 0).transpose());
    ++s.meshes[0].points_revision;
  });
  CHECK(fault(moved).find("the outline: ") == 0);
  CHECK(fault(drawing.without([](Scene& s) { s.image.window_low += 40; })) != "");
  // What is gone from the picture is gone from a part that is found in it.
  const Picture without = drawing.without(no_outline);
  CHECK(test::golden_fault(without, golden, {test::part_drawn("the outline", without, without)}).find("is not drawn") !=
        std::string::npos);
}

}  // namespace homolog
