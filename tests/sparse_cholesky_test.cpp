#include "core/solve/sparse_cholesky.h"

#include <doctest/doctest.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <thread>

#include "core/mesh/icosphere.h"
#include "core/solve/energy.h"
#include "core/solve/shape_solver.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

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

/// A = Λ + diag(s) of a mesh, as a solver takes it and as a matrix.
struct System {
  VertexScalars s, weights;
  Eigen::SparseMatrix<double> matrix;

  System(const Mesh& mesh, const VertexScalars& w, VertexScalars force = {})
      : s(force.size() > 0 ? std::move(force) : VertexScalars::Ones(w.size())),
        weights(static_cast<Eigen::Index>(mesh.topology->edges().size())),
        matrix(shape_laplacian(*mesh.topology, w)) {
    for (Eigen::Index k = 0; k < weights.size(); ++k) {
      const auto& [i, j] = mesh.topology->edges()[static_cast<std::size_t>(k)];
      weights[k] = w[i] + w[j];
    }
    matrix.diagonal() += s;
  }
};

bool factorise(SparseCholesky& cholesky, const System& system) {
  return cholesky.factorise(system.s, system.weights);
}

bool same_bits(const SparseCholesky& a, const SparseCholesky& b, Eigen::Index n) {
  const Points right = random_points(n, 77);
  return a.solve(right) == b.solve(right) && a.solve_in_double(right) == b.solve_in_double(right) &&
         a.solve(VertexScalars(right.col(0))) == b.solve(VertexScalars(right.col(0)));
}

/// A mesh whose L is large enough to be kept in single precision too.
const Mesh& large_mesh() {
  static const Mesh mesh = shuffled(shapes::torus(200, 120), 3);
  return mesh;
}

}  // namespace

TEST_CASE("the sparse factorisation solves as Eigen's does on closed and open and disconnected meshes") {
  unsigned seed = 1;
  for (const Mesh& mesh : meshes()) {
    const Eigen::Index n = mesh.points.rows();
    CAPTURE(n);
    const System system(mesh, random_weights(n, ++seed));
    const Eigen::SparseMatrix<double>& m = system.matrix;
    SparseCholesky cholesky(elimination_plan(*mesh.topology));
    REQUIRE(factorise(cholesky, system));
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
    SparseCholesky kept(elimination_plan(*mesh.topology));
    std::mt19937 random(seed);
    for (const int count : {0, 1, 5, 40, 1, 400, 100000, -1}) {
      const auto centre = static_cast<Eigen::Index>(random() % static_cast<unsigned>(n));
      w = count < 0 ? first : painted(mesh, w, centre, count, random_weights(1, ++seed)[0]);
      const System system(mesh, w);
      SparseCholesky fresh(elimination_plan(*mesh.topology));
      REQUIRE(factorise(kept, system));
      REQUIRE(factorise(fresh, system));
      CHECK(fresh.fronts_factorised() == static_cast<int>(fresh.plan().fronts().size()));
      CHECK(same_bits(kept, fresh, n));
    }
  }
}

TEST_CASE("a large factor has the same bits too after a change and as a whole and with any plan of its topology") {
  const Mesh& mesh = large_mesh();
  const Eigen::Index n = mesh.points.rows();
  const VertexScalars w = random_weights(n, 11);
  const System before(mesh, w), after(mesh, painted(mesh, w, 5, 300, 40));
  SparseCholesky kept(elimination_plan(*mesh.topology));
  SparseCholesky fresh(std::make_shared<const EliminationPlan>(static_cast<int>(n), mesh.topology->edges()));
  REQUIRE(factorise(kept, before));
  REQUIRE(factorise(kept, after));
  REQUIRE(factorise(fresh, after));
  CHECK(kept.fronts_factorised() < fresh.fronts_factorised() / 4);
  CHECK(same_bits(kept, fresh, n));
}

TEST_CASE("a large factor in single precision solves within 1e-5 mm of one in double precision") {
  const Mesh& mesh = large_mesh();
  const Eigen::Index n = mesh.points.rows();
  SparseCholesky cholesky(elimination_plan(*mesh.topology));
  const auto differ_mm = [&](const Points& b) {
    return (cholesky.solve(b) - cholesky.solve_in_double(b)).cwiseAbs().maxCoeff();
  };
  double worst_mm = 0, largest_mm = 0;
  for (const double base : {0.01, 1.0, 10.0, 1e4}) {
    const VertexScalars even = VertexScalars::Constant(n, base);
    const VertexScalars regions = painted(mesh, even, 700, 9000, 1000 * base);
    const VertexScalars held = painted(mesh, VertexScalars::Ones(n), 9000, 3000, 1e6);
    for (const System& system : {System(mesh, even), System(mesh, regions), System(mesh, base * random_weights(n, 12)),
                                 System(mesh, even, held)}) {
      REQUIRE(factorise(cholesky, system));
      // Targets of an organ that lies a metre from the origin, some of them pulled hard.
      const Points targets = (mesh.points + 3 * random_points(n, 13)).rowwise() + Eigen::RowVector3d(40, -300, 1000);
      const Points b = system.s.asDiagonal() * targets;
      worst_mm = std::max(worst_mm, differ_mm(b));
      largest_mm = std::max(largest_mm, cholesky.solve(b).cwiseAbs().maxCoeff());
      // Forces of stiffness, in which large numbers cancel.
      worst_mm = std::max(worst_mm, differ_mm(b + system.matrix * targets));
      // What a drag solves for: how far each landmark follows a pull of 50 mm.
      const Vec3 grabbed = mesh.points.row(100);
      const VertexScalars g =
          (-(mesh.points.rowwise() - grabbed.transpose()).rowwise().squaredNorm().array() / 18).exp();
      const VertexScalars u = cholesky.solve(g), exact = cholesky.solve_in_double(g.replicate(1, 3)).col(0);
      if (system.s[100] == 1)
        worst_mm = std::max(worst_mm, 50 * (u / u[100] - exact / exact[100]).cwiseAbs().maxCoeff());
    }
  }
  MESSAGE("worst difference " << worst_mm << " mm");
  CHECK(worst_mm <= 1e-5);
  CHECK(worst_mm > 0);  // single precision was used
  CHECK(largest_mm > 900);
}

TEST_CASE("a small change factorises few fronts and no change none") {
  const Mesh mesh = icosphere(4);
  const VertexScalars w = random_weights(mesh.points.rows(), 5);
  SparseCholesky cholesky(elimination_plan(*mesh.topology));
  REQUIRE(factorise(cholesky, System(mesh, w)));
  REQUIRE(factorise(cholesky, System(mesh, w)));
  CHECK(cholesky.fronts_factorised() == 0);
  REQUIRE(factorise(cholesky, System(mesh, painted(mesh, w, 700, 1, 3.5))));
  CHECK(cholesky.fronts_factorised() > 0);
  CHECK(cholesky.fronts_factorised() < static_cast<int>(cholesky.plan().fronts().size()) / 4);
}

TEST_CASE("values that make no positive definite matrix are refused and leave no trace") {
  const Mesh mesh = shapes::torus(20, 20);
  const Eigen::Index n = mesh.points.rows();
  const System good(mesh, random_weights(n, 6));
  SparseCholesky kept(elimination_plan(*mesh.topology)), fresh(elimination_plan(*mesh.topology));
  REQUIRE(factorise(fresh, good));
  for (const double wrong : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    CAPTURE(wrong);
    REQUIRE(factorise(kept, good));
    System bad = good;
    bad.s[n / 2] = wrong;
    CHECK(!factorise(kept, bad));
    bad = good;
    bad.weights[n] = wrong;
    CHECK(!factorise(kept, bad));
    REQUIRE(factorise(kept, good));
    CHECK(same_bits(kept, fresh, n));
  }
}

TEST_CASE("solvers of one topology share one elimination plan also when several threads ask first") {
  const Mesh mesh = shuffled(icosphere(3), 4);
  const VertexScalars w = random_weights(mesh.points.rows(), 21);
  const Points b = random_points(mesh.points.rows(), 22);
  const int before = EliminationPlan::made();
  std::vector<Points> solutions(4);
  {
    std::vector<std::jthread> threads;
    for (Points& solution : solutions) {
      threads.emplace_back([&] {
        ShapeSolver solver(mesh.topology);
        if (solver.factorise(w)) solution = solver.solve(b);
      });
    }
  }
  CHECK(EliminationPlan::made() == before + 1);
  REQUIRE(solutions[0].rows() == b.rows());
  for (const Points& solution : solutions) CHECK(solution == solutions[0]);
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
    const System system(mesh, stiffness, holds[k].size() > 0 ? VertexScalars(1 + holds[k].array()) : VertexScalars());
    CHECK((system.matrix * kept.solve(b) - b).norm() <= 1e-10 * b.norm());
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
