#include <array>
#include <cmath>
#include <map>
#include <thread>

#include "app/verbs/bench_pictures.h"
#include "app/verbs/median.h"
#include "app/verbs/verb.h"
#include "core/case/session.h"
#include "core/deform/shape_solver.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

using Clock = std::chrono::steady_clock;

/// A sphere of 10·4^level + 2 evenly spread vertices on radius 40 mm.
Mesh ball(int level) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  std::vector<Vec3> points;
  for (const Vec3& p :
       {Vec3(-1, g, 0), Vec3(1, g, 0), Vec3(-1, -g, 0), Vec3(1, -g, 0), Vec3(0, -1, g), Vec3(0, 1, g), Vec3(0, -1, -g),
        Vec3(0, 1, -g), Vec3(g, 0, -1), Vec3(g, 0, 1), Vec3(-g, 0, -1), Vec3(-g, 0, 1)}) {
    points.push_back(p.normalized());
  }
  std::vector<std::array<std::int32_t, 3>> faces{{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                                 {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                                 {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                                 {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int l = 0; l < level; ++l) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
    const auto middle = [&](std::int32_t a, std::int32_t b) {
      const auto [at, added] = middles.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(points.size()));
      if (added)
        points.push_back((points[static_cast<std::size_t>(a)] + points[static_cast<std::size_t>(b)]).normalized());
      return at->second;
    };
    std::vector<std::array<std::int32_t, 3>> finer;
    for (const auto& [a, b, c] : faces) {
      const auto ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    faces = std::move(finer);
  }
  Mesh mesh;
  mesh.points.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i)
    mesh.points.row(static_cast<Eigen::Index>(i)) = 40 * points[i].transpose();
  Triangles triangles(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    triangles.row(static_cast<Eigen::Index>(f)) << faces[f][0], faces[f][1], faces[f][2];
  }
  mesh.topology = Topology::make(mesh.points.rows(), std::move(triangles)).value();
  return mesh;
}

/// What one frame of a drag costs on the core thread, job in to points out.
Json drag_figures(int level) {
  const Mesh mesh = ball(level);
  EditSession session(
      new_document("", nullptr, make_template({mesh.points, mesh.topology->triangles()}, "ball").value()));
  Stroke pull;
  pull.at = Vec3(0, 0, 40);
  pull.sigma_mm = 12;
  const auto begin = Clock::now();
  pull.to = Vec3(0, 0, 41);
  (void)session.preview(pull);
  const double begin_ms = milliseconds(Clock::now() - begin);
  // The cursor goes around, so that the surface point under it, and with it the falloff, is another one in every frame.
  const double moves = median_ms([&](int k) {
    const double a = 0.02 * k;
    pull.to = 43 * Vec3(0.2 * std::sin(a), 0.2 * std::cos(a), std::sqrt(1 - 0.04));
    (void)session.preview(pull);
  });
  Stroke grab = pull;
  grab.tool = Tool::grab;
  (void)session.preview(grab);
  const double still = median_ms([&](int k) {
    grab.to = Vec3(0.01 * (k % 100), 0, 43);
    (void)session.preview(grab);
  });
  Stroke commit = pull;
  const double committed = median_ms([&](int) {
    (void)session.apply(commit);
    (void)session.apply(Undo{});
  });
  // The paper's whole optimisation: normal equations assembled, factorised and solved for x, y and z.
  const VertexScalars w = VertexScalars::Constant(mesh.points.rows(), 10);
  ShapeSolver solver(mesh.topology);
  const double analyse = median_ms([&](int) { ShapeSolver again(mesh.topology); });
  const double factorise = median_ms([&](int) { (void)solver.factorise(w); });
  const double solve = median_ms([&](int) { (void)solver.solve(mesh.points); });
  return {{"vertices", mesh.points.rows()},
          {"drag_frame_falloff_moves_ms", moves},
          {"drag_frame_falloff_still_ms", still},
          {"gesture_begin_ms", begin_ms},
          {"commit_ms", committed},
          {"analyse_ms", analyse},
          {"factorise_ms", factorise},
          {"solve_xyz_ms", solve},
          {"whole_optimisation_ms", analyse + factorise + solve}};
}

/// Reading speed of memory beyond every cache, the bound of all solves.
double memory_gb_per_s() {
  const std::vector<double> large(std::size_t{1} << 25, 1.0);
  double sum = 0;
  const double ms = median_ms([&](int) {
    sum += Eigen::Map<const Eigen::VectorXd>(large.data(), static_cast<Eigen::Index>(large.size())).sum();
  });
  return sum > 0 ? static_cast<double>(large.size() * sizeof(double)) / 1e6 / ms : 0;
}

}  // namespace

void add_bench(CLI::App& app, VerbRun& run) {
  CLI::App* verb = add_verb(app, "bench", "Times the solver, slices and pictures on this machine (medians)");
  const auto bench = [](Progress& progress) -> Result<Report> {
    Report report;
    report.values["cores"] = std::thread::hardware_concurrency();
    report.values["memory_gb_per_s"] = memory_gb_per_s();
    Json drags = Json::array();
    for (const int level : {4, 5, 6}) {
      drags.push_back(drag_figures(level));
      progress.report(0.2 * (level - 3));
      if (progress.cancelled()) return fail("bench", "was stopped");
    }
    report.values["drag"] = std::move(drags);
    report.values["pictures"] = picture_figures();
    return report;
  };
  verb->callback([bench, &run] { run = bench; });
}

}  // namespace homolog
