#include "core/solve/sparse_cholesky.h"

#include <doctest/doctest.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <thread>

#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/solve/energy.h"
#include "core/solve/shape_solver.h"
#include "tests/real_data.h"
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
  return a.solve(right) == b.solve(right) &&
         a.solve(VertexScalars(right.col(0))) == b.solve(VertexScalars(right.col(0)));
}

/// A mesh whose L does not stay in the caches near a core.
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

TEST_CASE("what solving reads is little more than the entries of L") {
  for (const Mesh& mesh : {icosphere(4), icosphere(5), large_mesh()}) {
    const auto plan = elimination_plan(*mesh.topology);
    CAPTURE(mesh.points.rows());
    CHECK(static_cast<double>(plan->factor_numbers()) <= 1.35 * static_cast<double>(plan->nonzeros()));
    CHECK(plan->factor_numbers() >= plan->nonzeros());
  }
}

TEST_CASE("solutions of a real femur half a metre from the origin are within 1e-5 mm of another solver's") {
  const auto folder = real_data();
  if (folder.empty()) return;
  const Mesh mesh = read_mesh(folder / "bones/fem_z009_R.ply").value();
  const Eigen::Index n = mesh.points.rows();
  const Vec3 centre = mesh.points.colwise().mean();
  const Points far = mesh.points.rowwise() + (Vec3(-500, 500, 500) - centre).transpose();
  const VertexScalars w = random_weights(n, 14).cwiseSqrt().array().pow(4.0 / 3);  // 0.01 to 100
  const VertexScalars held = painted(mesh, VertexScalars::Ones(n), 900, 2000, 1e6);
  for (const System& system : {System(mesh, w), System(mesh, w, held)}) {
    SparseCholesky cholesky(elimination_plan(*mesh.topology));
    REQUIRE(factorise(cholesky, system));
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> reference(system.matrix);
    // Targets, some of them pulled hard; and forces of stiffness, in which large numbers cancel.
    const Points targets = system.s.asDiagonal() * Points(far + 3 * random_points(n, 15));
    for (const Points& b : {targets, Points(targets + system.matrix * far - system.s.asDiagonal() * far)}) {
      const Points expected = reference.solve(Eigen::MatrixXd(b));
      CHECK((cholesky.solve(b) - expected).cwiseAbs().maxCoeff() <= 1e-5);
      CHECK(expected.cwiseAbs().maxCoeff() > 500);
    }
  }
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
