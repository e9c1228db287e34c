#include "core/placement/mirror_symmetry.h"

#include <doctest/doctest.h>

#include "core/catalogue/catalogue.h"
#include "core/phantom/phantom.h"
#include "tests/adapting.h"
#include "tests/real_data.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

std::optional<Reflection> mirror_of(const Mesh& mesh) {
  return mirror_symmetry(SurfaceSearch(mesh), sagittal_reflection(mesh.points));
}

Vec3 place_of(const Template& the_template, const std::string& name) {
  return landmarks_of({.landmarks = the_template.landmarks}, {name}).at(name);
}

}  // namespace

TEST_CASE("the reflection of a vertebra takes what is left to what is right") {
  const auto vertebra = built_in(Organ::vertebra);
  // Turned off the patient's axes and elsewhere.
  const Similarity moved{Eigen::Quaterniond(Eigen::AngleAxisd(0.2, Vec3(1, 2, -1).normalized())), 1.5,
                         Vec3(40, -120, 300)};
  const auto mirror = mirror_of({vertebra->topology, moved.apply(vertebra->points)});
  REQUIRE(mirror);
  CHECK(mirror->turn.determinant() == doctest::Approx(-1));
  for (const std::string of : {" transverse process tip", " superior articular process tip"}) {
    const Vec3 left = moved.apply(place_of(*vertebra, "left" + of)),
               right = moved.apply(place_of(*vertebra, "right" + of));
    CHECK((mirror->apply(left) - right).norm() < 1.5);
    CHECK((mirror->apply(right) - left).norm() < 1.5);
  }
}

TEST_CASE("a reflection carried by a similarity goes there with what it reflects") {
  const Similarity moved{Eigen::Quaterniond(Eigen::AngleAxisd(2, Vec3(1, 2, -1).normalized())), 1.5,
                         Vec3(40, -120, 300)};
  const auto vertebra = built_in(Organ::vertebra);
  const Reflection own = mirror_of({vertebra->topology, vertebra->points}).value();
  const Mesh there{vertebra->topology, moved.apply(vertebra->points)};
  const auto found = mirror_symmetry(SurfaceSearch(there), carried_by(moved, own));
  REQUIRE(found);  // though it lies upside down, where the sagittal plane is none of its own
  for (const Eigen::Index v : {0, 100, 1000}) {
    const Vec3 p = vertebra->points.row(v);
    CHECK((carried_by(moved, own).apply(moved.apply(p)) - moved.apply(own.apply(p))).norm() < 1e-9);
    CHECK((found->apply(moved.apply(p)) - moved.apply(own.apply(p))).norm() < 0.5);
  }
}

TEST_CASE("subjects that are not quite even have a mirror symmetry and a kidney has none") {
  const auto vertebra = built_in(Organ::vertebra), kidney = built_in(Organ::kidney);
  for (const int subject : {1, 3}) {
    CAPTURE(subject);
    CHECK(mirror_of({vertebra->topology, phantom_truth(Organ::vertebra, subject).front().points}));
    CHECK_FALSE(mirror_of({kidney->topology, phantom_truth(Organ::kidney, subject).front().points}));
  }
}

TEST_CASE("a surface without extent has no mirror symmetry that could be told") {
  Mesh point{built_in(Organ::vertebra)->topology, built_in(Organ::vertebra)->points};
  point.points *= 0;
  CHECK_FALSE(mirror_of(point));
}

TEST_CASE("real vertebrae have a mirror symmetry, and femora and hip bones have none") {
  const auto data = real_data();
  if (data.empty()) return;
  const auto symmetric = [&](const char* file) { return mirror_of(read_mesh(data / file).value()).has_value(); };
  CHECK(symmetric("vertebra_L1/ref_20.ply"));
  CHECK_FALSE(symmetric("bones/fem_z013_L.ply"));
  CHECK_FALSE(symmetric("bones/hip_z009_R.ply"));
}
