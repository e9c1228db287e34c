#include <doctest/doctest.h>

#include "app/editor/picking/picking.h"
#include "app/editor/picking/shown_mesh.h"
#include "app/editor/state/layout.h"
#include "app/editor/state/view_geometry.h"
#include "core/mesh/construction/icosphere.h"
#include "tests/changed_shape.h"
#include "tests/render_help.h"

namespace homolog {

namespace {

const Mat3 patient = Mat3::Identity();

bool overlap(const RectPx& a, const RectPx& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

/// With this mesh, placed as it is.
Document document_of(const Mesh& mesh) {
  Template own;
  own.topology = mesh.topology;
  own.points = mesh.points;
  own.stiffness = VertexScalars::Ones(mesh.points.rows());
  return new_document("", nullptr, std::make_shared<const Template>(std::move(own)), Similarity{});
}

}  // namespace

TEST_CASE("radiological views have the patient's right on the left of the screen") {
  for (const ViewKind kind : {ViewKind::axial, ViewKind::coronal}) {
    CHECK(direction_letters(-screen_axes(kind, patient, true).right) == "R");
    CHECK(direction_letters(-screen_axes(kind, patient, false).right) == "L");
  }
  CHECK(direction_letters(screen_axes(ViewKind::axial, patient, true).down) == "P");
  CHECK(direction_letters(screen_axes(ViewKind::coronal, patient, true).down) == "I");
}

TEST_CASE("sagittal views have the front on the left whichever side is shown") {
  for (const bool radiological : {true, false}) {
    const ScreenAxes axes = screen_axes(ViewKind::sagittal, patient, radiological);
    CHECK(direction_letters(-axes.right) == "A");
    CHECK(direction_letters(-axes.down) == "S");
  }
}

TEST_CASE("axial slices are seen from the feet") {
  CHECK(direction_letters(screen_axes(ViewKind::axial, patient, true).normal()) == "S");
}

TEST_CASE("a second letter appears from 22.5 degrees on") {
  const auto turned_by = [](double degrees) {
    const double angle = degrees * 3.14159265358979 / 180;
    return direction_letters(Vec3(std::cos(angle), std::sin(angle), 0));
  };
  CHECK(turned_by(0) == "L");
  CHECK(turned_by(22) == "L");
  CHECK(turned_by(23) == "LP");
  CHECK(turned_by(67) == "PL");
  CHECK(turned_by(180) == "R");
}

TEST_CASE("a volume's own planes lie nearest the patient's and are right-handed") {
  VolumeGeometry geometry;
  geometry.dims = {10, 10, 10};
  // Columns to the feet, rows to the right, slices to the front, all turned by 20 degrees.
  Mat3 direction;
  direction.col(0) = Vec3(0, 0, -1);
  direction.col(1) = Vec3(-1, 0, 0);
  direction.col(2) = Vec3(0, 1, 0);
  const Mat3 turn = Eigen::AngleAxisd(0.35, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  geometry.direction = turn * direction;
  const Mat3 axes = slice_axes(geometry, true);
  CHECK(axes.isApprox(turn, 1e-9));
  CHECK(axes.determinant() == doctest::Approx(1));
  CHECK(slice_axes(geometry, false).isIdentity());
  CHECK(view_title(ViewKind::axial, geometry, true) == "Plane across i");
}

TEST_CASE("the step between slices is the spacing along an axis of the grid") {
  VolumeGeometry geometry;
  geometry.spacing_mm = Vec3(0.5, 0.7, 3);
  CHECK(slice_step_mm(geometry, Vec3::UnitX()) == doctest::Approx(0.5));
  CHECK(slice_step_mm(geometry, -Vec3::UnitZ()) == doctest::Approx(3));
}

TEST_CASE("a view maps mm to px and back") {
  const RectPx rect{100, 50, 400, 300};
  const Camera3D camera = turned(camera_from(LookFrom::left, Box(Vec3(-20, -30, -40), Vec3(20, 30, 40))), 37, -12);
  const SliceView slice = test::coronal(Vec3(3, 4, 5), 0.8);
  for (const ViewMap& map : {ViewMap(rect, slice), ViewMap(rect, camera)}) {
    const Vec3 on_plane = map.is_slice() ? slice.centre : Vec3(7, -3, 11);
    const Vec3 p_mm = map.on_facing_plane(220, 130, on_plane);
    const auto px = map.to_px(p_mm);
    REQUIRE(px);
    CHECK(px->x() == doctest::Approx(220));
    CHECK(px->y() == doctest::Approx(130));
    CHECK(map.into_screen().dot(p_mm - on_plane) == doctest::Approx(0));
  }
}

TEST_CASE("each side is looked at from there with the head or the front upwards") {
  struct Side {
    LookFrom from;
    const char *eye, *up, *right;
  };
  for (const Side& side : {Side{LookFrom::anterior, "A", "S", "L"}, Side{LookFrom::posterior, "P", "S", "R"},
                           Side{LookFrom::left, "L", "S", "P"}, Side{LookFrom::right, "R", "S", "A"},
                           Side{LookFrom::superior, "S", "A", "R"}, Side{LookFrom::inferior, "I", "A", "L"}}) {
    const Camera3D camera = camera_from(side.from, Box(Vec3(-10, -20, -30), Vec3(30, 20, 10)));
    CHECK(direction_letters(camera.to_eye) == side.eye);
    CHECK(direction_letters(camera.up) == side.up);
    CHECK(direction_letters(camera_right(camera)) == side.right);
    CHECK((camera.target - Vec3(10, 0, -10)).norm() < 1e-9);
    CHECK(side_names[static_cast<std::size_t>(side.from)][0] - 'a' + 'A' == side.eye[0]);
    CHECK(side_letters[static_cast<std::size_t>(side.from)] == side.eye[0]);
    Camera3D turned_there;
    look_from(turned_there, side.from);
    CHECK(turned_there.to_eye == camera.to_eye);
  }
}

TEST_CASE("positions name the side that they lie on") {
  CHECK(position_text(Vec3(-17.6, 35.34, 12.06)) == "R 17.6 P 35.3 S 12.1");
  CHECK(position_text(Vec3(1, -2, -3)) == "L 1.0 A 2.0 I 3.0");
}

TEST_CASE("a drag to the right brings the organ's left side to the front") {
  const Camera3D front = camera_from(LookFrom::anterior, Box());
  const Camera3D right = turned(front, 10, 0), down = turned(front, 0, 10);
  CHECK(right.to_eye.dot(camera_right(front)) == doctest::Approx(-std::sin(0.08)));
  CHECK(down.to_eye.dot(front.up) == doctest::Approx(std::sin(0.08)));
  CHECK(camera_mm_per_px(front, 500) ==
        doctest::Approx(2 * front.distance_mm * std::tan(front.fov_deg / 360 * 3.14159265358979) / 500));
}

TEST_CASE("a surface is looked at from its outside") {
  Camera3D camera;
  look_from_outside(camera, Vec3(2, 0, 0));
  CHECK((camera.to_eye - Vec3::UnitX()).norm() < 1e-9);
  CHECK((camera.up - Vec3::UnitZ()).norm() < 1e-9);
  look_from_outside(camera, Vec3(0, 0, 3));
  CHECK((camera.to_eye - Vec3::UnitZ()).norm() < 1e-9);
  CHECK((camera.up - Vec3(0, -1, 0)).norm() < 1e-9);
  const Camera3D kept = camera;
  look_from_outside(camera, Vec3::Zero());
  CHECK(camera.to_eye == kept.to_eye);
}

TEST_CASE("turning the camera keeps its distance and its axes at right angles") {
  const Camera3D camera = turned(camera_from(LookFrom::superior, Box()), 123, 45);
  CHECK(camera.to_eye.norm() == doctest::Approx(1));
  CHECK(camera.up.norm() == doctest::Approx(1));
  CHECK(camera.up.dot(camera.to_eye) == doctest::Approx(0));
}

TEST_CASE("the first point of a sphere along a ray is the near one and a plane before it hides it") {
  ShownMesh mesh;
  Document sphere = document_of(icosphere(3, 10));
  const Ray ray{Vec3(0, -100, 0), Vec3(0, 2, 0)};
  const auto hit = mesh.first_on_surface(*sphere.view(), ray);
  REQUIRE(hit);
  CHECK(hit->y() == doctest::Approx(-10).epsilon(0.02));
  VolumeGeometry image;
  image.dims = {100, 100, 100};
  image.origin_mm = Vec3(-49.5, -49.5, -49.5);
  const auto plane_at = [](double y) {
    return std::vector<PlaneInSpace>{{test::coronal(Vec3(0, y, 0), 1), 50, 50, {}}};
  };
  CHECK(hidden_by_planes(plane_at(-20), image, ray, *hit));
  CHECK_FALSE(hidden_by_planes(plane_at(0), image, ray, *hit));
  CHECK_FALSE(hidden_by_planes(plane_at(-60), image, ray, *hit));
  CHECK_FALSE(hidden_by_planes({}, image, ray, *hit));

  test::changed_shape(sphere).points = std::make_shared<const Points>(2 * *sphere.view()->shape.points);
  CHECK(mesh.first_on_surface(*sphere.view(), ray)->y() == doctest::Approx(-20).epsilon(0.02));
}

TEST_CASE("the nearest outline point of a sphere is found within reach only") {
  const ShownMesh mesh;
  const Document sphere = document_of(icosphere(3, 10));
  const SliceView slice = test::axial(Vec3::Zero(), 1);
  const auto near = mesh.nearest_on_outline(*sphere.view(), slice, Vec3(12, 0, 0), 3);
  REQUIRE(near);
  CHECK(near->x() == doctest::Approx(10).epsilon(0.02));
  CHECK_FALSE(mesh.nearest_on_outline(*sphere.view(), slice, Vec3(14, 0, 0), 3));
}

TEST_CASE("an outline is worked out once for a mesh and a plane, and anew for another") {
  Outlines outlines;
  const Mesh sphere = icosphere(3, 10);
  const auto points = std::make_shared<const Points>(sphere.points);
  const auto outline_at = [&](const std::shared_ptr<const Points>& mesh_points, double z) {
    return outlines.of(sphere.topology, mesh_points, Vec3(0, 0, z), Vec3(0, 0, 1));
  };
  const auto first = outline_at(points, 1);
  CHECK(outline_at(points, 1) == first);
  CHECK(outline_at(points, 2) != first);
  CHECK(outline_at(std::make_shared<const Points>(*points), 1) != first);
  CHECK(outline_at(points, 1) == first);
  CHECK(first->size() == intersect_plane(*sphere.topology, *points, Vec3(0, 0, 1), Vec3(0, 0, 1)).size());
  for (double z = 3; z < 9; z += 0.005) outline_at(points, z);
  CHECK(outline_at(points, 1) != first);  // what was not asked for is let go in time
}

TEST_CASE("dragging the knob scales and dragging the ring turns about the middle of the mesh") {
  const ViewMap map(RectPx{0, 0, 200, 200}, test::axial(Vec3::Zero(), 1));
  PlaceDrag drag;
  drag.centre_mm = Vec3(5, 0, 0);
  drag.press_mm = Vec3(15, 0, 0);
  drag.part = PlacePart::knob;
  const auto px = [&](const Vec3& p) { return *map.to_px(p); };
  const Eigen::Vector2d twice = px(Vec3(25, 0, 0)), quarter = px(Vec3(5, 10, 0));
  const Similarity scaled = dragged_placement(drag, map, twice.x(), twice.y());
  CHECK(scaled.scale == doctest::Approx(2));
  CHECK((scaled.apply(drag.centre_mm) - drag.centre_mm).norm() < 1e-9);
  drag.part = PlacePart::ring;
  const Similarity turned = dragged_placement(drag, map, quarter.x(), quarter.y());
  CHECK((turned.apply(Vec3(15, 0, 0)) - Vec3(5, 10, 0)).norm() < 1e-9);
}

TEST_CASE("nothing of the window overlaps at any size and scale") {
  for (const float scale : {1.0f, 1.5f, 2.0f})
    for (const auto& [width, height] :
         {std::pair(1280.0f, 800.0f), std::pair(2560.0f, 1600.0f), std::pair(700.0f, 500.0f)})
      for (const bool panel : {true, false}) {
        const Layout layout = make_layout(width, height, scale, {std::nullopt, panel});
        std::vector<RectPx> rects{layout.top_bar, layout.tool_strip, layout.panel, layout.status_line};
        rects.insert(rects.end(), layout.headers.begin(), layout.headers.end());
        rects.insert(rects.end(), layout.images.begin(), layout.images.end());
        for (std::size_t i = 0; i < rects.size(); ++i) {
          CHECK(rects[i].x + rects[i].width <= width);
          CHECK(rects[i].y + rects[i].height <= height);
          for (std::size_t j = i + 1; j < rects.size(); ++j) CHECK_FALSE(overlap(rects[i], rects[j]));
        }
      }
}

TEST_CASE("a maximised view is the only one under the pointer") {
  const Layout layout = make_layout(1280, 800, 1, {ViewKind::coronal, true});
  CHECK(layout.view_at(400, 400) == ViewKind::coronal);
  CHECK(layout.image(ViewKind::axial).width == 0);
  CHECK_FALSE(layout.view_at(10, 10));
}

}  // namespace homolog
