#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "core/mesh/mesh_quality.h"
#include "core/mesh/repair/mesh_faults.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/template_making/distance_map.h"
#include "core/template_making/label_body.h"
#include "core/template_making/mask_template.h"
#include "core/template_making/parts_template.h"
#include "core/template_making/tube_template.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

/// A mask of the points where `inside(p)`, p in mm from the middle of a cube-like grid.
template <class Inside>
Volume mask_where(Inside inside, const std::array<int, 3>& dims = {60, 60, 60}, const Vec3& spacing_mm = Vec3::Ones()) {
  Volume mask;
  mask.geometry.dims = dims;
  mask.geometry.spacing_mm = spacing_mm;
  for (int axis = 0; axis < 3; ++axis)
    mask.geometry.origin_mm[axis] = -0.5 * spacing_mm[axis] * (dims[static_cast<std::size_t>(axis)] - 1);
  std::vector<std::uint8_t> voxels;
  for (int k = 0; k < dims[2]; ++k)
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i) voxels.push_back(inside(mask.geometry.to_mm({1.0 * i, 1.0 * j, 1.0 * k})));
  mask.data = std::move(voxels);
  mask.range_max = 1;
  return mask;
}

bool in_torus(const Vec3& p, double ring_mm, double tube_mm) {
  return std::hypot(std::hypot(p.x(), p.y()) - ring_mm, p.z()) < tube_mm;
}

MaskTemplateOptions options_with(int vertices, GenusRule genus = {}) {
  MaskTemplateOptions options;
  options.vertices = vertices;
  options.genus = genus;
  return options;
}

constexpr GenusRule keep{GenusRule::Kind::keep, 0};

}  // namespace

TEST_CASE("the distance map agrees with a search over all voxels") {
  VolumeGeometry grid;
  grid.dims = {7, 6, 5};
  grid.spacing_mm = Vec3(0.7, 1.1, 2.5);
  std::mt19937 random(3);
  std::vector<std::uint8_t> set(grid.voxels());
  for (auto& voxel : set) voxel = random() % 20 == 0;
  set[17] = 1;
  const auto place = [&](std::size_t v) -> Vec3 {
    return grid.spacing_mm.cwiseProduct(
        Vec3(static_cast<double>(v % 7), static_cast<double>(v / 7 % 6), static_cast<double>(v / 42)));
  };
  const auto distance = distance_to(set, grid);
  for (std::size_t v = 0; v < set.size(); ++v) {
    double nearest = 1e9;
    for (std::size_t w = 0; w < set.size(); ++w)
      if (set[w] != 0) nearest = std::min(nearest, (place(v) - place(w)).norm());
    CHECK(distance[v] == doctest::Approx(nearest).epsilon(1e-5));
  }
}

TEST_CASE("flipping a simple point leaves the genus as it is and any other changes the surface") {
  // Over random 5×5×5 bodies: where is_simple says so the Euler characteristic of the surface must not change.
  std::mt19937 random(5);
  const std::array<int, 3> dims{5, 5, 5};
  int simple = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    std::vector<std::uint8_t> body(125, 0);
    std::uint32_t bits = 0;
    for (std::size_t n = 0; n < 27; ++n)
      if (random() % 2 == 0 && n != 13) {
        body[n % 3 + 1 + 5 * (n / 3 % 3 + 1) + 25 * (n / 9 + 1)] = 1;
        bits |= 1U << n;
      }
    if (!is_simple(bits)) continue;
    ++simple;
    const int before = genus_of(body, dims);
    body[62] = 1;
    CHECK(genus_of(body, dims) == before);
  }
  CHECK(simple > 100);
  CHECK_FALSE(is_simple(0));                                   // would make a new body
  CHECK_FALSE(is_simple(0x7FFFFFF));                           // would make a cavity
  CHECK_FALSE(is_simple(1U << 12 | 1U << 14));                 // joins two bodies
  CHECK(is_simple(1U << 12));                                  // makes one longer
  CHECK_FALSE(is_simple(0x7FFFFFF & ~(1U << 12 | 1U << 14)));  // a tunnel's narrowest place
}

TEST_CASE("a ball becomes a template with the asked count and even edges on its surface") {
  const Volume mask = mask_where([](const Vec3& p) { return p.norm() < 20; });
  for (const int vertices : {500, 2500}) {
    const auto made = make_mask_template(mask, options_with(vertices));
    REQUIRE(made);
    CHECK(made->mesh.points.rows() == vertices);
    CHECK(made->mesh.topology->closed());
    CHECK(made->mesh.topology->genus() == 0);
    CHECK(made->mesh.topology->components() == 1);
    const MeshQuality quality = mesh_quality(made->mesh);
    CHECK(quality.edge_cv < 0.12);
    CHECK(quality.min_angle_deg > 28);
    CHECK(quality.self_intersections == 0);
    CHECK(quality.volume_ml > 0);
    CHECK(made->mesh.points.rowwise().norm().mean() == doctest::Approx(20).epsilon(0.01));
    CHECK(made->to_mask.mean_mm < 0.35);
    CHECK(made->from_mask.max_mm < 1.5);
    Eigen::Index top = -1;
    made->mesh.points.col(2).maxCoeff(&top);
    CHECK(top == 0);  // numbered from the top
  }
}

TEST_CASE("a narrow tunnel is filled and a wide one stays unless a number is asked for") {
  const Volume narrow = mask_where([](const Vec3& p) { return in_torus(p, 9, 8); });  // a hole 2 mm wide
  const Volume wide = mask_where([](const Vec3& p) { return in_torus(p, 18, 7); });   // 22 mm
  MaskTemplateOptions unclosed = options_with(1500);
  unclosed.closing_mm = unclosed.opening_mm = 0;
  const auto filled = make_mask_template(narrow, unclosed);
  REQUIRE(filled);
  CHECK(filled->mesh.topology->genus() == 0);
  REQUIRE(filled->tunnels.size() == 1);
  CHECK(filled->tunnels.front().how == CutTunnel::How::filled);
  CHECK(filled->tunnels.front().at_mm.norm() < 2);
  CHECK(make_mask_template(wide, unclosed)->mesh.topology->genus() == 1);
  unclosed.genus = keep;
  CHECK(make_mask_template(narrow, unclosed)->mesh.topology->genus() == 1);
  unclosed.genus = {GenusRule::Kind::number, 0};
  const auto cut = make_mask_template(wide, unclosed);
  REQUIRE(cut);
  CHECK(cut->mesh.topology->genus() == 0);
  CHECK(mesh_quality(cut->mesh).self_intersections == 0);
  unclosed.genus.genus = 2;
  const auto refused = make_mask_template(wide, unclosed);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().what.find("fewer than --genus 2") != std::string::npos);
}

TEST_CASE("a strand thinner than the mesh can show is severed") {
  const Volume mask = mask_where([](const Vec3& p) {
    const bool handle = in_torus(p - Vec3(0, 0, 14), 10, 1.6) || in_torus({p.x(), p.z() - 14, p.y()}, 12, 1.6);
    return p.norm() < 16 || (handle && p.z() > 10);
  });
  MaskTemplateOptions options = options_with(800);
  options.closing_mm = options.opening_mm = 0;
  const auto made = make_mask_template(mask, options);
  REQUIRE(made);
  CHECK(made->mesh.topology->genus() == 0);
  CHECK(mesh_quality(made->mesh).self_intersections == 0);
  CHECK(std::any_of(made->tunnels.begin(), made->tunnels.end(),
                    [](const CutTunnel& tunnel) { return tunnel.how == CutTunnel::How::severed; }));
  options.genus = keep;
  CHECK(make_mask_template(mask, options).value().mesh.topology->genus() > 0);
}

TEST_CASE("what is lost between long voxels is said") {
  // A bowl of a thin wall in slices of 9 mm, as hearts are often scanned: its wall tears.
  VolumeGeometry grid;
  grid.dims = {100, 100, 10};
  grid.spacing_mm = {1.2, 1.2, 9};
  grid.origin_mm = {-60, -60, -45};
  Volume mask;
  mask.geometry = grid;
  std::vector<std::uint8_t> voxels;
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i) {
        const Vec3 p = grid.to_mm(Vec3(i, j, k));
        const double r = Vec3(p.x(), p.y(), 0.6 * p.z()).norm();
        voxels.push_back(r < 40 && r > 35.5 && p.z() < 30 ? 1 : 0);
      }
  mask.data = voxels;
  mask.range_max = 1;
  const auto torn = make_mask_template(mask, options_with(600));
  REQUIRE(torn);
  const auto says_far = [](const MaskTemplate& made) {
    return std::ranges::any_of(made.warnings, [](const std::string& one) {
      return one.find("thin parts were severed") != std::string::npos || one.find("made") != std::string::npos;
    });
  };
  CHECK(says_far(*torn));
  const auto whole = make_mask_template(mask_where([](const Vec3& p) { return p.norm() < 16; }), options_with(600));
  REQUIRE(whole);
  CHECK_FALSE(says_far(*whole));
}

TEST_CASE("islands and cavities are left out and reported") {
  const Volume mask =
      mask_where([](const Vec3& p) { return (p.norm() < 16 && p.norm() > 4) || (p - Vec3(25, 25, 25)).norm() < 3; });
  const auto made = make_mask_template(mask, options_with(1000));
  REQUIRE(made);
  CHECK(made->cavities == 1);
  CHECK(made->cavities_ml == doctest::Approx(0.268).epsilon(0.15));
  REQUIRE(made->islands_ml.size() == 1);
  CHECK(made->islands_ml.front() == doctest::Approx(0.113).epsilon(0.2));
  CHECK(made->warnings.empty());
  const Volume twins =
      mask_where([](const Vec3& p) { return (p - Vec3(14, 0, 0)).norm() < 10 || (p + Vec3(14, 0, 0)).norm() < 10; });
  const auto one = make_mask_template(twins, options_with(600));
  REQUIRE(one);
  REQUIRE(one->warnings.size() == 1);
  CHECK(one->warnings.front().find("has 2 parts, 2 of about one size; the largest was taken") != std::string::npos);
}

TEST_CASE("a template of all parts has a piece of each by its area and leaves crumbs out") {
  const Vec3 apart(17, 0, 0);
  const Volume mask = mask_where([&](const Vec3& p) {
    return (p - apart).norm() < 12 || (p + apart).norm() < 6 || (p - Vec3(0, 24, 24)).norm() < 1.2;
  });
  const MaskTemplate made = make_parts_template(mask, options_with(1000)).value();
  const Topology& topology = *made.mesh.topology;
  CHECK(topology.components() == 2);
  CHECK(topology.closed());
  CHECK(made.mesh.points.rows() == doctest::Approx(1000).epsilon(0.002));
  // Four fifths of the surface, and of the vertices, are the large ball's, which comes first.
  const Eigen::Index large = (made.mesh.points.col(0).array() > 0).count();
  CHECK(large == doctest::Approx(800).epsilon(0.02));
  CHECK((made.mesh.points.topRows(large).col(0).array() > 0).all());
  const auto ball_ml = [](double radius_mm) { return enclosed_volume_ml(icosphere(4, radius_mm)); };
  CHECK(enclosed_volume_ml(made.mesh) == doctest::Approx(ball_ml(12) + ball_ml(6)).epsilon(0.04));
  CHECK(made.to_mask.mean_mm < 0.5);
  CHECK(made.islands_ml.size() == 1);
  CHECK(made.warnings.empty());
  // Without, the part that is left out is said with its share.
  const auto largest = make_mask_template(mask, options_with(1000)).value();
  REQUIRE(largest.warnings.size() == 1);
  CHECK(largest.warnings.front().find("has 3 parts; the largest was taken, and the others with 11 % of its volume are "
                                      "left out; homolog template --parts all keeps them") != std::string::npos);
  MaskTemplateOptions few = options_with(200);
  CHECK(make_parts_template(mask, few).error().what.find("too many for 200 vertices") != std::string::npos);
}

TEST_CASE("thin parts that the mesh does not have are said") {
  const auto ball = [](const Vec3& p) { return p.norm() < 15; };
  const Volume finned =
      mask_where([&](const Vec3& p) { return ball(p) || (p.head<2>().norm() < 26 && std::abs(p.z()) < 1); });
  MaskTemplateOptions options = options_with(1000);
  options.opening_mm = 2;
  const auto made = make_mask_template(finned, options).value();
  CHECK(made.missed_ml == doctest::Approx(2 * 3.14 * (26 * 26 - 18 * 18) / 1000).epsilon(0.2));
  CHECK(made.missed_share > 0.05);
  REQUIRE(made.warnings.size() == 1);
  CHECK(made.warnings[0].find("more than two voxels from the mesh") != std::string::npos);
  const auto whole = make_mask_template(mask_where(ball), options).value();
  CHECK(whole.missed_share == 0);
  CHECK(whole.warnings.empty());
}

TEST_CASE("a label with walls of two voxels becomes a template without faults that has all of them") {
  const Volume cap = mask_where([](const Vec3& p) { return std::abs(p.norm() - 24) < 1 && p.z() > -12; });
  for (const int vertices : {800, 2500, 6000}) {
    CAPTURE(vertices);
    const auto made = make_mask_template(cap, options_with(vertices));
    REQUIRE(made);
    CHECK(made->missed_share < 0.01);
    CHECK(made->from_mask.max_mm < 6);
    const MeshFaults faults = mesh_faults(made->mesh);
    INFO(faults.words());
    CHECK_FALSE(faults.any());
    CHECK(made->tunnels.empty());
    if (vertices > 800) continue;
    REQUIRE(made->warnings.size() == 1);
    CHECK(made->warnings[0].find("thin walls were made") != std::string::npos);
  }
}

TEST_CASE("what cannot become a template is refused in a sentence") {
  const Volume mask = mask_where([](const Vec3& p) { return p.norm() < 10; });
  MaskTemplateOptions options = options_with(500);
  options.label = 7;
  CHECK(make_mask_template(mask, options).error().what.find("label 7 does not occur") != std::string::npos);
  const Volume sheet =
      mask_where([](const Vec3& p) { return std::abs(p.x()) < 20 && std::abs(p.y()) < 20 && std::abs(p.z()) < 0.6; });
  options = options_with(500);
  options.opening_mm = 3;
  options.closing_mm = 0;
  const auto vanished = make_mask_template(sheet, options);
  REQUIRE_FALSE(vanished);
  CHECK(vanished.error().what.find("opening radius below") != std::string::npos);
  Progress progress;
  progress.cancel();
  CHECK_FALSE(make_mask_template(mask, options_with(500), &progress));
}

TEST_CASE("an organ that the label map cuts off is closed flat and said to be") {
  const Volume mask = mask_where([](const Vec3& p) { return (p + Vec3(0, 0, 30)).norm() < 15; });
  const auto made = make_mask_template(mask, options_with(800));
  REQUIRE(made);
  REQUIRE(made->warnings.size() == 1);
  CHECK(made->warnings.front().find("(inferior)") != std::string::npos);
  CHECK(made->mesh.topology->closed());
  CHECK(made->mesh.points.col(2).minCoeff() == doctest::Approx(-30).epsilon(0.03));
  // The vertices of the flat face are named, and no others: a disc of the ball's radius, of all that is left.
  REQUIRE(made->cut.size() > 100);
  CHECK(made->cut.size() < 400);
  for (const std::int32_t i : made->cut) CHECK(made->mesh.points(i, 2) < -28.5);
  for (Eigen::Index i = 0; i < made->mesh.points.rows(); ++i)
    if (made->mesh.points(i, 2) < -29.7) CHECK(std::ranges::binary_search(made->cut, static_cast<std::int32_t>(i)));
  const Volume whole = mask_where([](const Vec3& p) { return p.norm() < 15; });
  CHECK(make_mask_template(whole, options_with(800)).value().cut.empty());
}

TEST_CASE("an island at the edge of the label map does not count as the organ being cut off") {
  const Volume mask = mask_where([](const Vec3& p) { return p.norm() < 15 || (p - Vec3(0, 0, -30)).norm() < 4; });
  const auto made = make_mask_template(mask, options_with(800));
  REQUIRE(made);
  CHECK(made->islands_ml.size() == 1);
  CHECK(made->warnings.empty());
}

TEST_CASE("a label larger than the grids hold is worked on in blocks") {
  Volume mask;
  mask.geometry.dims = {300, 300, 300};
  mask.data = std::vector<std::uint8_t>(mask.geometry.voxels(), 1);
  const LabelExtent extent = label_extent(mask, 1, 0);
  const double spacing_mm = worked_spacing_mm(mask, extent, 1, 2);
  CHECK(304 * 304 * 304 / std::pow(spacing_mm, 3) == doctest::Approx(16e6));
  const auto region = label_body(mask, 1, 0, extent, spacing_mm, 2).value();
  CHECK(region.grid.voxels() <= 16'000'000);
  CHECK(region.grid.spacing_mm == Vec3::Constant(2));
  CHECK(std::all_of(region.touches.begin(), region.touches.end(), [](bool touched) { return touched; }));
}

TEST_CASE("slices ten times as thick as their voxels leave no stairs") {
  const Volume mask = mask_where([](const Vec3& p) { return p.norm() < 25; }, {80, 80, 9}, {0.8, 0.8, 8});
  const auto made = make_mask_template(mask, options_with(1000));
  REQUIRE(made);
  CHECK(made->mesh.points.rows() == 1000);
  CHECK(mesh_quality(made->mesh).min_angle_deg > 25);
  const VertexScalars radius = made->mesh.points.rowwise().norm();
  CHECK(std::sqrt((radius.array() - 25).square().mean()) < 2.5);
}

TEST_CASE("a tube template is a grid of rings perpendicular to its axis") {
  // Half an ellipsoid, apex down, tilted: label 1 the cavity, 2 the wall.
  const Mat3 tilt = Eigen::AngleAxisd(0.3, Vec3(1, 0.5, 0).normalized()).toRotationMatrix();
  Volume mask = mask_where([&](const Vec3& p) {
    const Vec3 q = tilt.transpose() * p;
    const auto inside = [&](double a, double c) {
      return q.z() < 10 && Vec3(q.x() / a, q.y() / a, (q.z() - 10) / c).norm() < 1;
    };
    return static_cast<std::uint8_t>(inside(14, 32) ? 1 : inside(20, 38) ? 2 : 0);
  });
  TubeTemplateOptions options;
  options.rings = 12;
  options.sectors = 20;
  const auto made = make_tube_template(mask, options);
  REQUIRE(made);
  CHECK(made->mesh.points.rows() == 12 * 20 + 1);
  CHECK(made->mesh.topology->rims().size() == 1);
  CHECK(made->axis.dot(-tilt.col(2)) > 0.99);  // towards the narrow end
  for (int ring = 0; ring < 12; ++ring) {
    const auto heights = (made->mesh.points.middleRows(ring * 20, 20) * made->axis).eval();
    CHECK(heights.maxCoeff() - heights.minCoeff() < 1e-9);
  }
  CHECK(enclosed_volume_ml(made->mesh) > 0);
  CHECK(made->to_mask.mean_mm < 0.7);

  options.outer_label = 2;
  options.capped = true;
  const auto two = make_tube_template(mask, options);
  REQUIRE(two);
  CHECK(two->mesh.topology->components() == 2);
  CHECK(two->mesh.topology->closed());
  CHECK(mesh_quality(two->mesh).self_intersections == 0);
  options.label = 9;
  CHECK_FALSE(make_tube_template(mask, options));
}

TEST_CASE("a template of a scaled label map is the scaled template") {
  Volume mask = mask_where([](const Vec3& p) { return in_torus(p, 16, 8) || in_torus(p - Vec3(0, 0, 20), 6, 4.5); });
  for (const GenusRule& rule : {GenusRule{}, GenusRule{GenusRule::Kind::number, 0}}) {
    const MaskTemplate usual = make_mask_template(mask, options_with(300, rule)).value();
    Volume small = mask;
    small.geometry.spacing_mm /= 16;
    small.geometry.origin_mm /= 16;
    const MaskTemplate made = make_mask_template(small, options_with(300, rule)).value();
    CHECK(made.tunnels.size() == usual.tunnels.size());
    REQUIRE(made.mesh.topology->hash() == usual.mesh.topology->hash());
    CHECK(largest_difference(16 * made.mesh.points, usual.mesh.points) < 1e-6 * 60);
  }
}

TEST_CASE("sizes of labels are those that their extents say") {
  Volume mask = mask_where([](const Vec3& p) { return p.norm() < 20; });
  auto& voxels = std::get<std::vector<std::uint8_t>>(mask.data);
  const double whole_mm = organ_size_mm(label_extent(mask, 1, 0));
  for (std::size_t v = 0; v < voxels.size() / 2; ++v) voxels[v] = static_cast<std::uint8_t>(7 * voxels[v]);
  const auto sizes = label_sizes_mm(mask, 0);
  CHECK(sizes.size() == 3);
  for (const int label : {1, 7}) CHECK(sizes.at(label) == doctest::Approx(organ_size_mm(label_extent(mask, label, 0))));
  CHECK(sizes.at(every_label) == doctest::Approx(whole_mm));
  CHECK(organ_size_mm(label_extent(mask, every_label, 0)) == doctest::Approx(whole_mm));
}

TEST_CASE("a label of a few voxels is refused with their number") {
  Volume mask;
  mask.geometry.dims = {12, 12, 12};
  std::vector<std::uint8_t> voxels(12 * 12 * 12);
  voxels[5 + 12 * 5 + 144 * 5] = 43;
  mask.data = voxels;
  MaskTemplateOptions options;
  options.label = 43;
  options.vertices = 300;
  CHECK(make_mask_template(mask, options).error().what.starts_with("label 43 has 1 voxel, too few for a shape"));
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) voxels[static_cast<std::size_t>(4 + i + 12 * (4 + j) + 144 * (4 + k))] = 43;
  mask.data = voxels;
  CHECK(make_mask_template(mask, options));
}
