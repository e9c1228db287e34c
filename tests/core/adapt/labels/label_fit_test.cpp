#include "core/adapt/labels/label_fit.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "core/mesh/construction/icosphere.h"
#include "core/mesh/voxels/label_map.h"
#include "tests/must.h"

namespace homolog {

namespace {

VolumeGeometry wide_grid() {
  VolumeGeometry grid;
  grid.dims = {110, 60, 60};
  grid.origin_mm = Vec3(-54.5, -29.5, -29.5);
  return grid;
}

/// An egg about `centre`; `long_mm` along x.
Mesh egg(double long_mm, double short_mm, const Vec3& centre, int level = 3) {
  Mesh mesh = icosphere(level, 1);
  mesh.points = (mesh.points * Vec3(long_mm, short_mm, short_mm).asDiagonal()).rowwise() + centre.transpose();
  return mesh;
}

std::shared_ptr<const Template> template_of(const Mesh& mesh) {
  return test::must(make_template({mesh.points, mesh.topology->triangles()}, "egg"));
}

bool says(const std::vector<std::string>& sentences, const std::string& part) {
  return std::ranges::any_of(sentences, [&](const std::string& one) { return one.find(part) != std::string::npos; });
}

}  // namespace

TEST_CASE(
    "of two parts of about one size the one like the template is fitted, or the largest where that is asked for") {
  Volume map = label_map(egg(16, 16, Vec3(-28, 0, 0)), wide_grid(), 2);
  const Volume other = label_map(egg(22, 12.5, Vec3(26, 0, 0)), wide_grid(), 2);
  auto& voxels = std::get<std::vector<std::uint8_t>>(map.data);
  std::ranges::transform(voxels, std::get<std::vector<std::uint8_t>>(other.data), voxels.begin(),
                         [](std::uint8_t a, std::uint8_t b) { return std::max(a, b); });
  const auto the_template = template_of(egg(20, 11.5, Vec3::Zero()));
  const MapLabel target{map, 2};
  const LabelFit likeliest = test::must(fit_to_label(*the_template, target, {}, {}));
  CHECK(likeliest.fit.mesh.points.col(0).mean() == doctest::Approx(26).epsilon(0.02));
  CHECK_FALSE(likeliest.judgement.doubtful);
  CHECK(says(likeliest.judgement.warnings, "is most like the template and was taken"));
  const LabelFit largest = test::must(fit_to_label(*the_template, target, {.largest_part = true}, {}));
  CHECK(largest.fit.mesh.points.col(0).mean() == doctest::Approx(-28).epsilon(0.02));
  CHECK_FALSE(says(largest.judgement.warnings, "is most like the template"));
}

TEST_CASE("the reason of a doubt stays the last warning where wider closings help no more") {
  const Volume map = label_map(egg(24, 12, Vec3::Zero()), wide_grid(), 1);
  Mesh bent = egg(20, 12, Vec3::Zero());
  for (Eigen::Index i = 0; i < bent.points.rows(); ++i)
    bent.points(i, 2) += 14 * std::sin(bent.points(i, 0) / 5) * (bent.points(i, 1) > 0 ? 1 : -1);
  const auto the_template = template_of(bent);
  const LabelFit fitted = test::must(fit_to_label(*the_template, {map, 1}, {}, {}));
  const auto& said = fitted.judgement.warnings;
  REQUIRE(fitted.judgement.doubtful);
  REQUIRE_FALSE(fitted.tried.empty());
  CHECK_FALSE(fitted.widened);
  REQUIRE(says(said, "was tried and helps no more"));
  CHECK(reason_of_doubt(said).find("helps no more") == std::string::npos);
  const LabelFit asked = test::must(fit_to_label(*the_template, {map, 1}, {.closing_mm = fitted.closing_mm}, {}));
  CHECK(asked.tried.empty());
  CHECK(reason_of_doubt(asked.judgement.warnings) == reason_of_doubt(said));
}

}  // namespace homolog
