#include "core/solve/sparse_cholesky.h"

#include <doctest/doctest.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "core/mesh/icosphere.h"
#include "core/solve/energy.h"
#include "core/solve/shape_solver.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

using Lower = Eigen::SparseMatrix<double>;

/// Both shapes as one mesh of two sheets.
Mesh beside(const Mesh& a, const Mesh& b) {
  Mesh both;
  both.points.resize(a.points.rows() + b.points.rows(), 3);
  both.points << a.points, b.points;
  Triangles faces(a.topology->triangles().rows() + b.topology->triangles().rows(), 3);
  faces << a.topology->triangles(), (b.topology->triangles().array() + static_cast<int>(a.points.rows())).matrix();
  both.topology = Topology::make(both.points.rows(), faces).value();
  return both;
}

/// The same mesh with its vertices numbered at random.
Mesh shuffled(const Mesh& mesh, unsigned seed) {
  std::vector<int> number(static_cast<std::size_t>(mesh.points.rows()));
  std::iota(number.begin(), number.end(), 0);
  std::shuffle(number.begin(), number.end(), std::mt19937(seed));
  Mesh other{nullptr, mesh.points};
  for (std::size_t i = 0; i < number.size(); ++i) other.points.row(number[i]) = mesh.points.row(static_cast<int>(i));
  const Triangles faces = mesh.topology->triangles().unaryExpr(
      [&](std::int32_t i) { return std::int32_t{number[static_cast<std::size_t>(i)]}; });
  other.topology = Topology::make(mesh.points.rows(), faces).value();
  return other;
}

std::vector<Mesh> meshes() {
  return {shapes::tetrahedron(),
          shapes::box(),
          icosphere(3),
          shuffled(icosphere(4), 1),
          shapes::torus(60, 31),
          shapes::open_cylinder(70, 24),
          beside(shapes::open_cylinder(9, 50), shuffled(shapes::torus(20, 17), 2))};
}

/// Between 1/1000 and 1000.
VertexScalars random_weights(Eigen::Index n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> exponent(-3, 3);
  return VertexScalars::NullaryExpr(n, [&] { return std::pow(10, exponent(random)); });
}

Points random_points(Eigen::Index n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  return Points::NullaryExpr(n, 3, [&] { return uniform(random); });
}

/// The `count` vertices nearest to `centre` get `value`.
VertexScalars painted(const Mesh& mesh, VertexScalars w, Eigen::Index centre, int count, double value) {
  std::vector<std::pair<double, Eigen::Index>> by_distance;
  for (Eigen::Index i = 0; i < w.size(); ++i) {
    by_distance.emplace_back((mesh.points.row(i) - mesh.points.row(centre)).squaredNorm(), i);
  }
  std::sort(by_distance.begin(), by_distance.end());
  for (int k = 0; k < std::min(count, static_cast<int>(w.size())); ++k)
    w[by_distance[static_cast<std::size_t>(k)].second] = value;
  return w;
}

Eigen::SparseMatrix<double> system_matrix(const Mesh& mesh, const VertexScalars& w) {
  Eigen::SparseMatrix<double> m = shape_laplacian(*mesh.topology, w);
  for (Eigen::Index i = 0; i < w.size(); ++i) m.coeffRef(i, i) += 1;
  return m;
}

Lower lower_of(const Eigen::SparseMatrix<double>& m) {
  return m.triangularView<Eigen::Lower>();
}

bool same_bits(const SparseCholesky& a, const SparseCholesky& b, Eigen::Index n) {
  const Points right = random_points(n, 77);
  return a.solve(right) == b.solve(right) &&
         a.solve(VertexScalars(right.col(0))) == b.solve(VertexScalars(right.col(0)));
}

}  // namespace

TEST_CASE("the sparse factorisation solves as Eigen's does on closed and open and disconnected meshes") {
  unsigned seed = 1;
  for (const Mesh& mesh : meshes()) {
    const Eigen::Index n = mesh.points.rows();
    CAPTURE(n);
    const auto m = system_matrix(mesh, random_weights(n, ++seed));
    SparseCholesky cholesky(lower_of(m));
    REQUIRE(cholesky.factorise(lower_of(m)));
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> reference(m);
    const Points b = random_points(n, seed);
    const Points x = cholesky.solve(b);
    const Points expected = reference.solve(Eigen::MatrixXd(b));
    CHECK((x - expected).norm() <= 1e-10 * expected.norm());
    CHECK((m * x - b).norm() <= 1e-10 * b.norm());
    for (int k = 0; k < 3; ++k) {
      CHECK((cholesky.solve(VertexScalars(b.col(k))) - x.col(k)).norm() <= 1e-12 * x.col(k).norm());
    }
  }
}

TEST_CASE("factorising what changed gives the bits of factorising everything whatever came before") {
  unsigned seed = 100;
  for (const Mesh& mesh : meshes()) {
    const Eigen::Index n = mesh.points.rows();
    CAPTURE(n);
    VertexScalars w = random_weights(n, ++seed);
    const VertexScalars first = w;
    SparseCholesky kept(lower_of(system_matrix(mesh, w)));
    std::mt19937 random(seed);
    for (const int count : {0, 1, 5, 40, 1, 400, 100000, -1}) {
      const auto centre = static_cast<Eigen::Index>(random() % static_cast<unsigned>(n));
      w = count < 0 ? first : painted(mesh, w, centre, count, random_weights(1, ++seed)[0]);
      const Lower lower = lower_of(system_matrix(mesh, w));
      SparseCholesky fresh(lower);
      REQUIRE(kept.factorise(lower));
      REQUIRE(fresh.factorise(lower));
      CHECK(fresh.fronts_factorised() == fresh.fronts());
      CHECK(same_bits(kept, fresh, n));
    }
  }
}

TEST_CASE("a small change factorises few fronts and no change none") {
  const Mesh mesh = icosphere(4);
  const VertexScalars w = random_weights(mesh.points.rows(), 5);
  const Lower lower = lower_of(system_matrix(mesh, w));
  SparseCholesky cholesky(lower);
  REQUIRE(cholesky.factorise(lower));
  REQUIRE(cholesky.factorise(lower));
  CHECK(cholesky.fronts_factorised() == 0);
  REQUIRE(cholesky.factorise(lower_of(system_matrix(mesh, painted(mesh, w, 700, 1, 3.5)))));
  CHECK(cholesky.fronts_factorised() > 0);
  CHECK(cholesky.fronts_factorised() < cholesky.fronts() / 4);
}

TEST_CASE("a matrix that is not positive definite is refused and leaves no trace") {
  const Mesh mesh = shapes::torus(20, 20);
  const Eigen::Index n = mesh.points.rows();
  const Lower good = lower_of(system_matrix(mesh, random_weights(n, 6)));
  SparseCholesky kept(good), fresh(good);
  REQUIRE(fresh.factorise(good));
  for (const double wrong : {-1.0, 0.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    CAPTURE(wrong);
    REQUIRE(kept.factorise(good));
    Lower bad = good;
    bad.coeffRef(n / 2, n / 2) = wrong;
    CHECK(!kept.factorise(bad));
    REQUIRE(kept.factorise(good));
    CHECK(same_bits(kept, fresh, n));
  }
}

TEST_CASE("the shape solver does not depend on which stiffness and held regions it had before") {
  const Mesh mesh = shapes::open_cylinder(40, 30);
  const Eigen::Index n = mesh.points.rows();
  const VertexScalars w = random_weights(n, 7);
  const VertexScalars none = VertexScalars::Zero(n);
  const std::vector<VertexScalars> holds{{}, painted(mesh, none, 100, 60, 1e4), painted(mesh, none, 900, 200, 0.5), {}};
  ShapeSolver kept(mesh.topology);
  for (std::size_t k = 0; k < holds.size(); ++k) {
    const VertexScalars stiffness = painted(mesh, w, 300 * static_cast<Eigen::Index>(k), 50, 25);
    ShapeSolver fresh(mesh.topology);
    REQUIRE(kept.factorise(stiffness, holds[k]));
    REQUIRE(fresh.factorise(stiffness, holds[k]));
    const Points b = random_points(n, 8);
    CHECK(kept.solve(b) == fresh.solve(b));
    Eigen::SparseMatrix<double> m = system_matrix(mesh, stiffness);
    if (holds[k].size() > 0) m += Eigen::SparseMatrix<double>(Eigen::MatrixXd(holds[k].asDiagonal()).sparseView());
    CHECK((m * kept.solve(b) - b).norm() <= 1e-10 * b.norm());
  }
}

TEST_CASE("the shape solver refuses weights it cannot factorise and takes the next ones") {
  const Mesh mesh = icosphere(2);
  const Eigen::Index n = mesh.points.rows();
  const VertexScalars good = random_weights(n, 9);
  ShapeSolver solver(mesh.topology), fresh(mesh.topology);
  REQUIRE(fresh.factorise(good));
  for (const double wrong : {0.0, -2.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    VertexScalars w = good;
    w[17] = wrong;
    CHECK(!solver.factorise(w));
  }
  CHECK(!solver.factorise(VertexScalars::Constant(n, 1e308)));
  VertexScalars push = VertexScalars::Zero(n);
  push[40] = -1e6;
  CHECK(!solver.factorise(good, push));
  REQUIRE(solver.factorise(good));
  const Points b = random_points(n, 10);
  CHECK(solver.solve(b) == fresh.solve(b));
}
