#include "core/solve/energy.h"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/base/numbers/rotation.h"
#include "core/deform/local_rotations.h"
#include "core/solve/shape_solver.h"
#include "tests/refusal.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

/// Unequal weights, so that a formula that mixes up w_i and w_j is found out.
VertexScalars uneven_weights(Eigen::Index n) {
  VertexScalars w(n);
  for (Eigen::Index i = 0; i < n; ++i) w[i] = 0.5 + 0.37 * static_cast<double>(i % 7);
  return w;
}

Points random_points(Eigen::Index n, double size_mm, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size_mm, size_mm);
  return Points::NullaryExpr(n, 3, [&] { return uniform(random); });
}

/// A of the paper's overdetermined system A p = b [Erdt 2009, §2.2], stacked: n rows of E_force, then √w_i (p_i − p_j)
/// for every i and every j in its one-ring. AᵀA = I + Λ exactly; the solver assembles that directly.
Eigen::SparseMatrix<double> stacked_system(const Topology& topology, const VertexScalars& w) {
  const Eigen::Index n = topology.vertices();
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index i = 0; i < n; ++i) entries.emplace_back(i, i, 1.0);
  Eigen::Index row = n;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (const std::int32_t j : topology.one_ring(i)) {
      entries.emplace_back(row, i, std::sqrt(w[i]));
      entries.emplace_back(row, j, -std::sqrt(w[i]));
      ++row;
    }
  }
  Eigen::SparseMatrix<double> a(row, n);
  a.setFromTriplets(entries.begin(), entries.end());
  return a;
}

/// S(P) = (I + Λ) P − Λ R: the only force targets whose minimiser is `p`.
Points implied_targets(const Topology& topology, const VertexScalars& w, const Points& p, const Points& r) {
  return p + shape_laplacian(topology, w) * (p - r);
}

struct Solved {
  Mesh mesh = icosphere(2, 30);
  VertexScalars w = uneven_weights(mesh.points.rows());
  ShapeSolver solver{mesh.topology};
  Solved() { REQUIRE(solver.factorise(w)); }
  Points minimiser(const Points& s) const {
    return solver.solve(Points(s + shape_laplacian(*mesh.topology, w) * mesh.points));
  }
};

}  // namespace

TEST_CASE("the stacked system of the paper has the assembled matrix as its normal equations") {
  for (const Mesh& mesh : {shapes::tetrahedron(), shapes::box(), icosphere(1)}) {
    const VertexScalars w = uneven_weights(mesh.points.rows());
    const auto a = stacked_system(*mesh.topology, w);
    Eigen::MatrixXd m = shape_laplacian(*mesh.topology, w);
    m.diagonal().array() += 1;
    CHECK((Eigen::MatrixXd(a.transpose() * a) - m).cwiseAbs().maxCoeff() < 1e-12);
  }
}

TEST_CASE("rows of the system matrix sum to one") {
  const Mesh mesh = icosphere(1);
  const auto laplacian = shape_laplacian(*mesh.topology, uneven_weights(mesh.points.rows()));
  CHECK((laplacian * VertexScalars::Ones(mesh.points.rows())).cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("targets at the reference give the reference and a translated target translates the shape") {
  const Solved s;
  CHECK((s.minimiser(s.mesh.points) - s.mesh.points).cwiseAbs().maxCoeff() < 1e-10);
  const Eigen::RowVector3d shift(3, -5, 11);
  const Points target = s.mesh.points.rowwise() + shift;
  CHECK((s.minimiser(target) - target).cwiseAbs().maxCoeff() < 1e-10);
}

TEST_CASE("the solution minimises the energy against random perturbations") {
  const Solved s;
  const Points targets = s.mesh.points + random_points(s.mesh.points.rows(), 5, 1);
  const Points p = s.minimiser(targets);
  const double least = deformation_energy(*s.mesh.topology, s.w, p, s.mesh.points, targets);
  for (unsigned seed = 2; seed < 22; ++seed) {
    const Points other = p + random_points(p.rows(), seed % 2 == 0 ? 1e-3 : 1, seed);
    CHECK(deformation_energy(*s.mesh.topology, s.w, other, s.mesh.points, targets) > least);
  }
}

TEST_CASE("implied targets are those whose minimiser is the given shape") {
  const Solved s;
  const Points p = s.mesh.points + random_points(s.mesh.points.rows(), 4, 3);
  const Points targets = implied_targets(*s.mesh.topology, s.w, p, s.mesh.points);
  CHECK((s.minimiser(targets) - p).cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("the solver agrees with a dense solve and held vertices hardly follow") {
  const Solved s;
  VertexScalars hold = VertexScalars::Zero(s.w.size());
  hold.head(20).setConstant(1e4);
  ShapeSolver held(s.mesh.topology);
  REQUIRE(held.factorise(s.w, hold));
  Eigen::MatrixXd m = shape_laplacian(*s.mesh.topology, s.w);
  m.diagonal() += VertexScalars(1 + hold.array());
  const VertexScalars b = random_points(s.w.size(), 1, 4).col(0);
  const VertexScalars x = held.solve(b);
  CHECK((m * x - b).cwiseAbs().maxCoeff() < 1e-9);
  CHECK(x.head(20).cwiseAbs().maxCoeff() < 1e-2 * x.cwiseAbs().maxCoeff());
}

TEST_CASE("the energy of one moved vertex and the matrix are those worked out by hand") {
  // Every vertex of a tetrahedron neighbours the three others.
  const Mesh mesh = shapes::tetrahedron(10);
  VertexScalars w(4);
  w << 1, 2, 4, 8;
  const Eigen::Matrix4d laplacian = shape_laplacian(*mesh.topology, w);
  Eigen::Matrix4d by_hand;
  by_hand << 17, -3, -5, -9, -3, 19, -6, -10, -5, -6, 23, -12, -9, -10, -12, 31;
  CHECK((laplacian - by_hand).cwiseAbs().maxCoeff() < 1e-12);
  Points moved = mesh.points;
  moved(0, 2) += 2;
  // 2 mm, squared, once for the target and for each edge by the stiffness of both its ends.
  CHECK(deformation_energy(*mesh.topology, w, moved, mesh.points, mesh.points) == doctest::Approx(4 * (1 + 17)));
  CHECK(deformation_energy(*mesh.topology, w, moved, mesh.points, moved) == doctest::Approx(4 * 17));
  const Points targets = implied_targets(*mesh.topology, w, moved, mesh.points);
  CHECK(targets(0, 2) - moved(0, 2) == doctest::Approx(2 * 17));
  CHECK(targets(3, 2) - moved(3, 2) == doctest::Approx(-2 * 9));
}

TEST_CASE("a firm hold outweighs what pulls at a vertex by the same factor everywhere") {
  const Mesh mesh = shapes::tetrahedron(10);
  VertexScalars w(4), held(4);
  w << 1, 2, 4, 8;
  held << 1, 0, 0.5, 1;
  const VertexScalars hold = firm_hold(*mesh.topology, w, held);
  CHECK(hold[0] == doctest::Approx(holding_weight * 18));
  CHECK(hold[1] == 0);
  CHECK(hold[2] == doctest::Approx(holding_weight * 24 / 2));
  CHECK(hold[3] == doctest::Approx(holding_weight * 32));
}

TEST_CASE("a stiffness that is zero or not a number is refused") {
  const Mesh mesh = icosphere(1);
  ShapeSolver solver(mesh.topology);
  VertexScalars w = uneven_weights(mesh.points.rows());
  for (const double wrong : {0.0, std::nan("")}) {
    w[3] = wrong;
    CHECK(says(solver.factorise(w), "the stiffness of vertex 3 is not a positive number"));
  }
}

TEST_CASE("stiffness as a length survives a change of the vertex count") {
  CHECK(stiffness_length_mm(10, 2.7) == doctest::Approx(14.79).epsilon(0.001));
  CHECK(stiffness_from_length(stiffness_length_mm(10, 2.7), 2.7) == doctest::Approx(10));
}

TEST_CASE("local rotations of a turned shape are that rotation and cancel in the rotated reference") {
  const Solved s;
  const Mat3 turn = Eigen::AngleAxisd(2.5, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  const Points turned = s.mesh.points * turn.transpose();
  for (const Mat3& r : local_rotations(*s.mesh.topology, s.mesh.points, turned)) {
    CHECK((r - turn).cwiseAbs().maxCoeff() < 1e-6);
  }
  const std::vector<Mat3> none(s.w.size(), Mat3::Identity());
  const Points laplacian_r = shape_laplacian(*s.mesh.topology, s.w) * s.mesh.points;
  CHECK((rotated_reference_force(*s.mesh.topology, s.w, s.mesh.points, none) - laplacian_r).cwiseAbs().maxCoeff() <
        1e-9);
}

TEST_CASE("in a turned reference each end of an edge turns its own share") {
  const Mesh mesh = icosphere(1, 20);
  const VertexScalars w = uneven_weights(mesh.points.rows());
  std::vector<Mat3> turns;
  for (Eigen::Index i = 0; i < w.size(); ++i)
    turns.push_back(
        Eigen::AngleAxisd(0.3 * static_cast<double>(i), Vec3(1, static_cast<double>(i), 2).normalized()).matrix());
  const Points force = rotated_reference_force(*mesh.topology, w, mesh.points, turns);
  for (Eigen::Index i = 0; i < w.size(); ++i) {
    Vec3 expected = Vec3::Zero();
    for (const std::int32_t j : mesh.topology->one_ring(i)) {
      const Vec3 edge = (mesh.points.row(i) - mesh.points.row(j)).transpose();
      expected +=
          w[i] * (turns[static_cast<std::size_t>(i)] * edge) + w[j] * (turns[static_cast<std::size_t>(j)] * edge);
    }
    CHECK((force.row(i).transpose() - expected).norm() < 1e-9);
  }
}

TEST_CASE("local rotations agree with the singular value decomposition and are never reflections") {
  const Mesh mesh = icosphere(2, 30);
  for (const bool reflected : {false, true}) {
    Points bent = mesh.points + random_points(mesh.points.rows(), 3, 5);
    if (reflected) bent.col(0) *= -1;
    const auto rotations = local_rotations(*mesh.topology, mesh.points, bent);
    for (Eigen::Index i = 0; i < mesh.points.rows(); ++i) {
      Mat3 covariance = Mat3::Zero();
      for (const std::int32_t j : mesh.topology->one_ring(i)) {
        covariance += (bent.row(i) - bent.row(j)).transpose() * (mesh.points.row(i) - mesh.points.row(j));
      }
      const Mat3& fitted = rotations[static_cast<std::size_t>(i)];
      CHECK(fitted.determinant() == doctest::Approx(1));
      // Least squares over edges is the largest trace of Rᵀ·covariance.
      const double reached = (fitted.transpose() * covariance).trace();
      const double best = (nearest_rotation(covariance).transpose() * covariance).trace();
      if (!reflected) CHECK(reached == doctest::Approx(best).epsilon(1e-6));
    }
  }
}
