#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "core/mesh/construction/icosphere.h"
#include "render/hued_shapes.h"
#include "render/mesh_pass.h"
#include "render/outline.h"
#include "tests/render_help.h"

namespace homolog {
namespace {

using test::picture_of, test::pixel;

/// How often each edge of the mesh is an end of a segment: twice where outlines are closed.
bool closed(const std::vector<OutlineSegment>& outline) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> ends;
  for (const OutlineSegment& segment : outline) {
    ++ends[{segment.from.low, segment.from.high}];
    ++ends[{segment.to.low, segment.to.high}];
  }
  return std::all_of(ends.begin(), ends.end(), [](const auto& end) { return end.second == 2; });
}

SliceView tilted_view(const Vec3& centre, double mm_per_px) {
  const Mat3 turn = Eigen::AngleAxisd(0.8, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  return {centre, turn.col(0), turn.col(1), mm_per_px};
}

Camera3D some_camera(double fov_deg) {
  Camera3D camera;
  camera.target = Vec3(10, -20, 30);
  camera.to_eye = Vec3(1, -2, 0.7).normalized();
  camera.up = Vec3(0.1, 0.3, 1).normalized();
  camera.distance_mm = 250;
  camera.fov_deg = fov_deg;
  return camera;
}

}  // namespace

TEST_CASE("a camera without perspective shows the sphere that its distance is made for") {
  Camera3D camera = some_camera(0);
  camera.distance_mm = distance_that_shows(40);
  CHECK(camera.distance_mm == doctest::Approx(40 / std::tan(std::numbers::pi / 12)));
  CHECK(shown_radius_mm(camera) == doctest::Approx(40));
}

TEST_CASE("a vertex has its hue on the surface and as a sphere") {
  const std::vector<float> hues{0, 1.0f / 3, 2.0f / 3};
  const auto surface = hued_surface(hues);
  REQUIRE(surface->size() == 3);
  CHECK((*surface)[1] == hsv_to_rgb(hues[1], 0.4f, 1));
  Points points(3, 3);
  points << 1, 2, 3, 4, 5, 6, 7, 8, 9;
  GlyphLayer layer;
  add_hued_glyphs(layer, points, {2, 0}, hues, 1.5);
  REQUIRE(layer.glyphs.size() == 2);
  CHECK(layer.glyphs[0] == GlyphLayer::Glyph{Vec3(7, 8, 9), hsv_to_rgb(hues[2], 1, 1), 1.5f});
  CHECK(layer.glyphs[1] == GlyphLayer::Glyph{Vec3(1, 2, 3), hsv_to_rgb(hues[0], 1, 1), 1.5f});
}

TEST_CASE("the intersection of a mesh with a plane lies in the plane and on the surface") {
  const Mesh ball = icosphere(3, 30, Vec3(3, 4, 5));
  const Vec3 normal = Vec3(1, 2, -0.5).normalized(), on_plane = Vec3(5, 6, 1);
  const auto outline = intersect_plane(*ball.topology, ball.points, on_plane, normal);
  REQUIRE(outline.size() > 40);
  CHECK(closed(outline));
  for (const OutlineSegment& segment : outline) {
    for (const EdgeCrossing& end : {segment.from, segment.to}) {
      CHECK(std::abs(normal.dot(end.point - on_plane)) < 1e-10);
      const double radius_mm = (end.point - Vec3(3, 4, 5)).norm();
      CHECK(radius_mm <= 30 + 1e-9);
      CHECK(radius_mm > 29.7);
    }
  }
}

TEST_CASE("outlines stay closed where the plane goes through vertices and along edges") {
  // The icosahedron's coordinate planes each hold four vertices and two edges.
  for (int subdivisions = 0; subdivisions < 3; ++subdivisions) {
    const Mesh ball = icosphere(subdivisions, 10);
    for (const Vec3 normal : {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}) {
      for (const double sign : {-1.0, 1.0}) {
        const auto outline = intersect_plane(*ball.topology, ball.points, Vec3::Zero(), sign * normal);
        CHECK(outline.size() > 5);
        CHECK(closed(outline));
      }
    }
  }
}

TEST_CASE("a plane that only touches a vertex or misses the mesh gives no outline of any length") {
  const Mesh ball = icosphere(1, 10);
  const Vec3 first = ball.points.row(0);
  for (const auto& outline : {intersect_plane(*ball.topology, ball.points, first, first),
                              intersect_plane(*ball.topology, ball.points, first, -first),
                              intersect_plane(*ball.topology, ball.points, 1.01 * first, first)}) {
    for (const OutlineSegment& segment : outline) CHECK((segment.from.point - segment.to.point).norm() < 1e-12);
  }
}

TEST_CASE("the outline of a sphere is a circle two pixels wide to within a pixel") {
  constexpr double kRadius_mm = 40, kAbove_mm = 12;
  const Mesh ball = icosphere(4, kRadius_mm, Vec3(100, -50, 20));
  Scene scene;
  scene.meshes.push_back(test::layer_of(ball));
  const Mat3 turn = Eigen::AngleAxisd(0.8, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  const SliceView view = tilted_view(Vec3(100, -50, 20) + kAbove_mm * turn.col(2) + 3 * turn.col(0), 0.5);
  const Viewport target{0, 0, 220, 200, 1};
  const Picture picture = picture_of(scene, view, target.width, target.height);
  const double circle_px = std::sqrt(kRadius_mm * kRadius_mm - kAbove_mm * kAbove_mm) / view.mm_per_px;
  const Eigen::Vector2d middle_px = slice_point_px(view, target, Vec3(100, -50, 20));
  double ink = 0;
  int stray = 0;
  for (int y = 0; y < target.height; ++y) {
    for (int x = 0; x < target.width; ++x) {
      const double value =
          std::max({pixel(picture, x, y)[0], pixel(picture, x, y)[1], pixel(picture, x, y)[2]}) / 255.0;
      ink += value / std::max({mesh_colour[0], mesh_colour[1], mesh_colour[2]});
      const double off_px = std::abs((Eigen::Vector2d(x + 0.5, y + 0.5) - middle_px).norm() - circle_px);
      stray += value > 0.1 && off_px > 2;
    }
  }
  CHECK(stray == 0);
  CHECK(ink / (2 * std::numbers::pi * circle_px) == doctest::Approx(2).epsilon(0.03));
}

TEST_CASE("an outline's width follows the content scale and its opacity is even along it") {
  const Mesh ball = icosphere(4, 40);
  Scene scene;
  scene.meshes.push_back(test::layer_of(ball));
  scene.meshes[0].outline_opacity = 0.5f;
  auto renderer = test::must(Renderer::make());
  auto framebuffer = test::must(Framebuffer::make(200, 200, 1));
  framebuffer->bind();
  REQUIRE(renderer->draw(scene, test::axial(Vec3::Zero(), 0.5), {0, 0, 200, 200, 3}));
  const Picture picture = framebuffer->read();
  int highest = 0, columns = 0;
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 200; ++x) highest = std::max(highest, pixel(picture, x, y)[0]);
  }
  for (int x = 0; x < 100; ++x) columns += pixel(picture, x, 100)[0] > highest / 2;
  CHECK(std::abs(highest - 0.5 * 255 * mesh_colour[0]) < 3);
  CHECK(columns == 6);
}

TEST_CASE("outline colours are those of the vertices at full saturation") {
  const Mesh ball = icosphere(3, 40);
  Scene scene;
  scene.meshes.push_back(test::layer_of(ball));
  scene.meshes[0].colours =
      std::make_shared<const std::vector<Rgb>>(static_cast<std::size_t>(ball.points.rows()), Rgb{1, 0.6f, 0.8f});
  const SliceView view = test::axial(Vec3::Zero(), 0.5);
  CHECK(pixel(picture_of(scene, view, 200, 200), 20, 100) == std::array{255, 0, 128, 255});
  scene.meshes[0].saturated_outline = false;
  CHECK(pixel(picture_of(scene, view, 200, 200), 20, 100) == std::array{255, 153, 204, 255});
}

TEST_CASE("a place in a slice and its pixel are inverses") {
  const SliceView view = tilted_view(Vec3(1, 2, 3), 0.37);
  const Viewport target{0, 0, 333, 222, 1};
  for (const Eigen::Vector2d& px : {Eigen::Vector2d(0, 0), Eigen::Vector2d(100.25, 7), Eigen::Vector2d(333, 222)}) {
    const Vec3 p_mm = slice_point_mm(view, target, px.x(), px.y());
    CHECK(std::abs(view.normal().dot(p_mm - view.centre)) < 1e-9);
    CHECK((slice_point_px(view, target, p_mm) - px).norm() < 1e-9);
  }
}

TEST_CASE("a ray through a pixel and a point on it are inverses") {
  for (const double fov_deg : {0.0, 30.0, 75.0}) {
    for (const Viewport& target : {Viewport{0, 0, 400, 300, 1}, Viewport{0, 0, 200, 300, 1}}) {
      const Camera3D camera = some_camera(fov_deg);
      for (const Eigen::Vector2d& px : {Eigen::Vector2d(0, 0), Eigen::Vector2d(150.5, 20), Eigen::Vector2d(60, 299)}) {
        const Ray ray = camera_ray(camera, target, px.x(), px.y());
        CHECK(ray.direction.norm() == doctest::Approx(1));
        const Vec3 back = camera_point_px(camera, target, ray.from + 210 * ray.direction);
        CHECK((back.head<2>() - px).norm() < 1e-9);
        CHECK(back.z() > 100);
      }
      CHECK(camera_point_px(camera, target, camera.target + 300 * camera.to_eye).z() < 0);
      CHECK(camera_point_px(camera, target, camera.target).z() == doctest::Approx(250));
    }
  }
}

TEST_CASE("what is drawn is where picking says") {
  const Viewport target{0, 0, 160, 120, 1};
  const Vec3 p_mm(25, -12, 38);
  Scene scene;
  scene.glyphs.glyphs.push_back({p_mm, {0, 1, 0}, 4});
  const auto middle_of_ink = [&](const Picture& picture) {
    Eigen::Vector2d sum(0, 0);
    double ink = 0;
    for (int y = 0; y < target.height; ++y) {
      for (int x = 0; x < target.width; ++x) {
        const double green = pixel(picture, x, y)[1];
        sum += green * Eigen::Vector2d(x + 0.5, y + 0.5);
        ink += green;
      }
    }
    REQUIRE(ink > 1000);
    return Eigen::Vector2d(sum / ink);
  };
  for (const double fov_deg : {0.0, 30.0}) {
    const Camera3D camera = some_camera(fov_deg);
    const Vec3 px = camera_point_px(camera, target, p_mm);
    CHECK((middle_of_ink(picture_of(scene, camera, target.width, target.height, 4)) - px.head<2>()).norm() < 0.7);
  }
  const SliceView view = tilted_view(p_mm + Vec3(2, 1, 0), 0.4);
  const SliceView through{p_mm + 4 * view.right + 7 * view.down, view.right, view.down, 0.4};
  const Eigen::Vector2d px = slice_point_px(through, target, p_mm);
  CHECK((middle_of_ink(picture_of(scene, through, target.width, target.height)) - px).norm() < 0.1);
}

TEST_CASE("a glyph is a disc in slices that meet it and absent from others") {
  Scene scene;
  scene.glyphs.glyphs.push_back({Vec3(0, 0, 5), {1, 1, 0}, 5});
  const auto width = [&](double z_mm) {
    const Picture picture = picture_of(scene, test::axial(Vec3(0, 0, z_mm), 0.1), 120, 20);
    int lit = 0;
    for (int x = 0; x < 120; ++x) lit += pixel(picture, x, 10)[3] == 255 && pixel(picture, x, 10)[0] > 0;
    return lit;
  };
  CHECK(std::abs(width(5) - 100) <= 2);
  CHECK(std::abs(width(8) - 80) <= 2);
  CHECK(width(10.5) == 0);
}

TEST_CASE("a line shows in the slices that it lies in and no others") {
  Scene scene;
  scene.lines.lines.push_back({Vec3(-4, 0, 2), Vec3(4, 0, 2), {1, 0, 0, 1}, 3});
  const auto seen = [&](const SliceView& view) { return pixel(picture_of(scene, view, 100, 41), 50, 20)[0]; };
  CHECK(seen(test::axial(Vec3(0, 0, 2), 0.1)) == 255);
  CHECK(seen(test::axial(Vec3(0, 0, 2.2), 0.1)) == 0);
  CHECK(seen(test::coronal(Vec3(0, 0, 2), 0.1)) == 255);
  CHECK(seen(test::sagittal(Vec3(0, 0, 2), 0.1)) == 0);
}

TEST_CASE("a line from behind the eye is cut and not mirrored") {
  Scene scene;
  Camera3D camera;
  scene.lines.lines.push_back(
      {camera.target + 800 * camera.to_eye + Vec3(30, 0, 0), camera.target + Vec3(30, 0, 0), {1, 1, 1, 1}, 4});
  const Picture picture = picture_of(scene, camera, 200, 200, 4);
  int right = 0, left = 0;
  for (int x = 0; x < 200; ++x) (x < 95 ? left : right) += pixel(picture, x, 100)[0] > 100;
  CHECK(right > 50);
  CHECK(left == 0);
}

TEST_CASE("the edges of a surface on a transparent background have its colour and not the background's") {
  const Mesh ball = icosphere(4, 60);
  Scene scene;
  scene.background = {0, 0, 0, 0};
  scene.meshes.push_back(test::layer_of(ball));
  const Picture picture = picture_of(scene, Camera3D{}, 200, 200, 4);
  int soft = 0, fringe = 0;
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 200; ++x) {
      const auto [r, g, b, a] = pixel(picture, x, y);
      if (a == 0 || a == 255) continue;
      ++soft;
      // The nearest wholly covered pixel towards the middle.
      int inner_x = x, inner_y = y;
      while (pixel(picture, inner_x, inner_y)[3] < 255) {
        inner_x += inner_x < 100 ? 1 : -1;
        inner_y += inner_y < 100 ? 1 : -1;
      }
      fringe += std::abs(r - pixel(picture, inner_x, inner_y)[0]) > 50;
    }
  }
  CHECK(soft > 100);
  CHECK(fringe < soft / 20);
  CHECK(pixel(picture, 0, 0)[3] == 0);
  CHECK(pixel(picture, 100, 100)[3] == 255);
}

TEST_CASE("a surface behind a plane shines through it faintly and before it hides it") {
  VolumeGeometry grid;
  grid.dims = {10, 2, 10};
  grid.spacing_mm = Vec3(10, 10, 10);
  grid.origin_mm = Vec3(-45, -5, -45);
  Scene scene;
  scene.image.volume = test::volume_of<std::uint8_t>(grid, [](int, int, int) { return 1; });
  scene.image.window_high = 4;
  scene.planes.push_back({test::coronal(Vec3::Zero(), 1), 50, 50, {0, 0, 1}});
  scene.meshes.push_back(test::layer_of(icosphere(3, 10, Vec3(0, 15, 0))));
  const Camera3D from_front;
  const auto behind = pixel(picture_of(scene, from_front, 100, 100, 4), 50, 50);
  CHECK(behind[0] > 64 + 20);
  CHECK(behind[0] < 150);
  CHECK(pixel(picture_of(scene, from_front, 100, 100, 4), 32, 32) == std::array{64, 64, 64, 255});
  scene.meshes[0] = test::layer_of(icosphere(3, 10, Vec3(0, -15, 0)));
  CHECK(pixel(picture_of(scene, from_front, 100, 100, 4), 50, 50)[0] > 150);
  scene.meshes[0].surface_opacity = 0.5f;
  const int through = pixel(picture_of(scene, from_front, 100, 100, 4), 50, 50)[0];
  CHECK(through > 100);
  CHECK(through < 230);
}

TEST_CASE("a surface that yields is not seen where it lies on another one, and is where it lies before it") {
  const Mesh ball = icosphere(3, 20);
  Mesh read = ball;
  for (Eigen::Index v = 0; v < read.points.rows(); ++v) read.points.row(v) *= v % 2 == 0 ? 1 + 1e-6 : 1 - 1e-6;
  Scene alone;
  alone.meshes.push_back(test::layer_of(ball));
  alone.meshes.back().colours =
      std::make_shared<const std::vector<Rgb>>(static_cast<std::size_t>(ball.points.rows()), Rgb{0.2f, 0.3f, 0.8f});
  const auto differing = [&](const Mesh& other, float opacity) {
    Scene both = alone;
    MeshLayer white = test::layer_of(other);
    white.yields = true;
    white.surface_opacity = opacity;
    both.meshes.insert(both.meshes.begin(), white);
    Camera3D camera;
    camera.to_eye = Vec3(1, -2, 0.7).normalized();
    camera.distance_mm = 150;
    const Picture one = picture_of(alone, camera, 120, 120), two = picture_of(both, camera, 120, 120);
    std::size_t count = 0;
    for (std::size_t k = 0; k < one.rgba.size(); k += 4)
      if (std::abs(static_cast<int>(one.rgba[k]) - static_cast<int>(two.rgba[k])) > 8) ++count;
    return count;
  };
  for (const float opacity : {0.45f, 1.0f}) {
    CAPTURE(opacity);
    constexpr std::size_t of_the_rim = 100;
    CHECK(differing(read, opacity) < of_the_rim);
    Mesh grown = ball;
    grown.points *= 1.05;
    CHECK(differing(grown, opacity) > 2000);
  }
}

TEST_CASE("meshes that are seen through look the same laid in as a layer, but where a mesh lies between two of them") {
  VolumeGeometry grid;
  grid.dims = {10, 2, 10};
  grid.spacing_mm = Vec3(10, 10, 10);
  grid.origin_mm = Vec3(-45, 5, -45);
  Scene others;
  others.image.volume = test::volume_of<std::uint8_t>(grid, [](int, int, int) { return 1; });
  others.image.window_high = 4;
  others.planes.push_back({test::coronal(Vec3(0, 8, 0), 1), 20, 50, {0, 0, 1}});  // solid, cuts the farther ball
  for (const double y : {-14.0, 10.0}) {
    others.meshes.push_back(test::layer_of(icosphere(3, 12, Vec3(0, y, 0))));
    others.meshes.back().surface_opacity = 0.4f;
  }
  constexpr int size = 100;
  const auto renderer = test::must(Renderer::make());
  const auto layer = test::must(FaintLayer::make(size, size));
  const Camera3D from_front;
  CHECK(renderer->draw_faint(others, from_front, layer));
  // How many channels of the picture differ visibly with an active ball there.
  const auto differing = [&](const Vec3& at) {
    Scene whole = others, over = others;
    over.meshes.clear();
    const MeshLayer active = test::layer_of(icosphere(3, 8, at));
    whole.meshes.push_back(active);
    over.meshes.push_back(active);
    auto framebuffer = test::must(Framebuffer::make(size, size, 1));
    framebuffer->bind();
    CHECK(renderer->draw(over, from_front, {0, 0, size, size, 1}, layer));
    const Picture laid_in = framebuffer->read(), drawn = picture_of(whole, from_front, size, size);
    std::size_t count = 0;
    for (std::size_t k = 0; k < drawn.rgba.size(); ++k)
      if (std::abs(static_cast<int>(drawn.rgba[k]) - static_cast<int>(laid_in.rgba[k])) > 3) ++count;
    return count;
  };
  CHECK(differing(Vec3(8, -40, 0)) == 0);   // before both
  CHECK(differing(Vec3(0, 30, 0)) == 0);    // behind both and the plane
  CHECK(differing(Vec3(30, 0, 5)) == 0);    // beside them
  CHECK(differing(Vec3(6, -2, 0)) > 0);     // between them
  CHECK(differing(Vec3(6, -2, 0)) < 2000);  // and nowhere else: its disc has about 600 pixels of four channels
}

TEST_CASE("moved points and changed colours are drawn when the revision moves") {
  const Mesh ball = icosphere(2, 20);
  auto points = std::make_shared<Points>(ball.points);
  auto colours = std::make_shared<std::vector<Rgb>>(static_cast<std::size_t>(ball.points.rows()), Rgb{1, 0, 0});
  Scene scene;
  MeshLayer layer = test::layer_of(ball);
  layer.points = points;
  layer.colours = colours;
  scene.meshes.push_back(layer);
  auto renderer = test::must(Renderer::make());
  const auto middle = [&] { return pixel(test::draw(*renderer, scene, Camera3D{}, 60, 60).picture, 30, 30); };
  CHECK(middle()[0] > 150);
  std::fill(colours->begin(), colours->end(), Rgb{0, 1, 0});
  ++scene.meshes[0].colours_revision;
  CHECK(middle()[1] > 150);
  CHECK(middle()[0] < 100);
  points->rowwise() += Eigen::RowVector3d(80, 0, 0);
  ++scene.meshes[0].points_revision;
  CHECK(middle() == std::array{0, 0, 0, 255});
  scene.meshes[0] = layer;
  scene.meshes[0].points = std::make_shared<const Points>(ball.points);
  CHECK(middle()[1] > 150);
}

TEST_CASE("a mesh stays on the GPU wherever it stands in the scene and while others are drawn") {
  const Mesh ball = icosphere(2, 20);
  std::vector<MeshLayer> layers;
  for (int k = 0; k < 6; ++k) {
    layers.push_back(test::layer_of({ball.topology, ball.points * (1 - 0.1 * k)}));
    if (k % 2 == 0)
      layers.back().colours =
          std::make_shared<const std::vector<Rgb>>(static_cast<std::size_t>(ball.points.rows()), Rgb{0, 1, 0});
  }
  MeshPass pass = test::must(MeshPass::make());
  pass.update(layers);
  CHECK(pass.uploads() == 6);
  std::vector<MeshLayer> turned(layers.rbegin(), layers.rend());
  pass.update(turned);
  for (const MeshLayer& one : layers) pass.update({one});  // a scene each, as a gallery draws
  turned.erase(turned.begin() + 2);
  pass.update(turned);
  CHECK(pass.uploads() == 6);
  // A mesh that is dragged takes the place of its points that are gone.
  for (int k = 0; k < 20; ++k) {
    layers[0].points = std::make_shared<const Points>(ball.points * (1 + 0.01 * k));
    pass.update(layers);
  }
  CHECK(pass.uploads() == 26);
  CHECK(pass.kept() <= 7);
}

TEST_CASE("a picture wider than the driver draws is refused with its limit") {
  const auto framebuffer = Framebuffer::make(1 << 24, 4, 4);
  REQUIRE(!framebuffer);
  CHECK(framebuffer.error().what.find("16777216 × 4") != std::string::npos);
}

TEST_CASE("a solid slice before an organ lets it be seen and still hides what has no mesh") {
  Scene scene;
  VolumeGeometry grid;
  grid.dims = {40, 40, 40};
  grid.spacing_mm.setConstant(3);
  grid.origin_mm.setConstant(-58.5);
  scene.image = {test::volume_of<std::uint8_t>(grid, [](int, int, int) { return 100; }), 0, 0, 200, true};
  scene.meshes.push_back(test::layer_of(icosphere(4, 25)));
  scene.background = {0, 0, 0, 1};
  scene.planes = {{test::coronal(Vec3(0, -40, 0), 1), 58, 58}};  // between the eye and the ball
  Camera3D camera;
  camera.distance_mm = 300;
  const Picture with = picture_of(scene, camera, 200, 200);
  Scene without = scene;
  without.meshes.clear();
  const Picture plane = picture_of(without, camera, 200, 200);
  const auto brightness = [](const Picture& picture, int x, int y) {
    const auto p = pixel(picture, x, y);
    return p[0] + p[1] + p[2];
  };
  // Its middle is lit, and differs from its rim: its shape is seen, not a shadow.
  CHECK(std::abs(brightness(with, 100, 100) - brightness(plane, 100, 100)) > 60);
  CHECK(std::abs(brightness(with, 100, 100) - brightness(with, 121, 118)) > 20);
  CHECK(pixel(with, 50, 50) == pixel(plane, 50, 50));
  // Half before the plane, half behind it: the half before is as it is without the plane.
  scene.planes[0].plane = test::sagittal(Vec3(0, 0, 0), 1);
  camera.to_eye = Vec3(-0.9, -0.3, 0).normalized();
  const Picture cut = picture_of(scene, camera, 200, 200);
  scene.planes.clear();
  const Picture alone = picture_of(scene, camera, 200, 200);
  CHECK(pixel(cut, 95, 100) == pixel(alone, 95, 100));
}

TEST_CASE("shapes far larger than an organ are drawn too") {
  for (const double fov_deg : {0.0, 30.0}) {
    CAPTURE(fov_deg);
    Scene scene;
    scene.meshes.push_back(test::layer_of(icosphere(4, 25'000)));
    scene.background = {0, 0, 0, 1};
    Camera3D camera;
    camera.distance_mm = 300'000;
    camera.fov_deg = fov_deg;
    CHECK(pixel(picture_of(scene, camera, 200, 200), 100, 100)[0] > 40);
  }
}

}  // namespace homolog
