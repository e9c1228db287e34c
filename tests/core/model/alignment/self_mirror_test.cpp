#include "core/model/alignment/self_mirror.h"

#include <doctest/doctest.h>

#include <cmath>

#include "core/mesh/construction/icosphere.h"
#include "core/model/alignment/procrustes.h"
#include "tests/must.h"

using namespace homolog;

namespace {

/// A body that is its own mirror image across x = 0 and no other plane, whose vertices are not: they are turned.
Mesh symmetric_body(double turn = 0.3) {
  Mesh body = icosphere(4, 1);
  const Mat3 turned = Eigen::AngleAxisd(turn, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (Eigen::Index v = 0; v < body.points.rows(); ++v) {
    const Vec3 p = turned * body.points.row(v).transpose();
    body.points.row(v) = Vec3(30 * p.x(), 20 * p.y() + 6 * p.x() * p.x(), 12 * p.z() + 4 * p.y() * p.y() + 3 * p.y());
  }
  return body;
}

}  // namespace

TEST_CASE("a symmetric body is its own mirror image in its own numbering, though its vertices are not symmetric") {
  const Mesh body = symmetric_body();
  const SelfMirror mirror = test::must(self_mirror(body));
  const Points image = aligned_to(mirrored_in_itself(mirror, body.points), body.points, Alignment::rigid);
  CHECK(mirror.off_mm < 0.03);  // flat faces lie so far within the curved surface
  const VertexScalars off = (image - body.points).rowwise().norm();
  CHECK(off.mean() < 0.03);
  CHECK(off.maxCoeff() < 0.2);
  // Not thinner: along the normals there is nothing left on average.
  CHECK(std::abs(image.norm() / body.points.norm() - 1) < 2e-4);
}

TEST_CASE("a bump on one side is on the other side of the mirror image") {
  const Mesh body = symmetric_body();
  const SelfMirror mirror = test::must(self_mirror(body));
  Points bumped = body.points;
  const Vec3 left(-20, 0, 0), right(20, 0, 0);
  for (Eigen::Index v = 0; v < bumped.rows(); ++v)
    if ((bumped.row(v).transpose() - left).norm() < 14) bumped.row(v) += Eigen::RowVector3d(0, 0, 3);
  const Points image = mirrored_in_itself(mirror, bumped);
  const Points moved = image - mirrored_in_itself(mirror, body.points);
  for (Eigen::Index v = 0; v < moved.rows(); ++v) {
    const Vec3 at = body.points.row(v).transpose();
    if ((at - right).norm() < 12) CHECK(moved(v, 2) == doctest::Approx(3).epsilon(0.05));
    if ((at - right).norm() > 17) CHECK(moved.row(v).norm() < 0.05);
  }
}

TEST_CASE("a body without a mirror plane is refused in a sentence") {
  Mesh body = symmetric_body();
  for (Eigen::Index v = 0; v < body.points.rows(); ++v) {
    const Vec3 p = body.points.row(v).transpose() / 20;
    body.points.row(v) += 6 * Eigen::RowVector3d(p.y() * p.z(), p.x() * p.z() * p.z(), p.x() * p.y());
  }
  const auto refused = self_mirror(body);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().what.find("is not symmetric in itself") != std::string::npos);
}
