#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numeric>
#include <thread>
#include <vector>

#include "app/verbs/bench_model.h"
#include "app/verbs/bench_pictures.h"
#include "app/verbs/bench_templates.h"
#include "app/verbs/median.h"
#include "app/verbs/verb.h"
#include "core/case/session.h"
#include "core/mesh/icosphere.h"
#include "core/solve/shape_solver.h"

namespace homolog {

namespace {

using Clock = std::chrono::steady_clock;

/// What one frame of a drag costs on the core thread, job in to points out.
Json drag_figures(int level) {
  const Mesh mesh = icosphere(level, 40);
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
  const double factorise = median_ms([&](int k) { (void)solver.factorise((1 + 0.1 * (k % 2)) * w); });
  const double solve = median_ms([&](int) { (void)solver.solve(mesh.points); });
  // A touch of the stiffness brush on 1,000 landmarks, until the solver is ready for the next drag. Numbers of a sphere
  // by subdivision are spread over all of it, which is the worst case: hardly a front stays.
  const auto paint_ms = [&](const std::vector<Eigen::Index>& touched) {
    return median_ms([&](int k) {
      VertexScalars painted = w;
      painted(touched).setConstant(11 + k % 7);
      (void)solver.factorise(painted);
    });
  };
  std::vector<Eigen::Index> landmarks(static_cast<std::size_t>(mesh.points.rows()));
  std::iota(landmarks.begin(), landmarks.end(), 0);
  const double paint_spread = paint_ms({landmarks.begin(), landmarks.begin() + 1000});
  std::nth_element(landmarks.begin(), landmarks.begin() + 1000, landmarks.end(), [&](Eigen::Index a, Eigen::Index b) {
    return mesh.points.row(a).dot(pull.at) > mesh.points.row(b).dot(pull.at);
  });
  const double paint = paint_ms({landmarks.begin(), landmarks.begin() + 1000});
  return {{"vertices", mesh.points.rows()},
          {"drag_frame_falloff_moves_ms", moves},
          {"drag_frame_falloff_still_ms", still},
          {"gesture_begin_ms", begin_ms},
          {"commit_ms", committed},
          {"analyse_ms", analyse},
          {"factorise_ms", factorise},
          {"solve_xyz_ms", solve},
          {"paint_1000_ready_ms", paint},
          {"paint_1000_spread_ready_ms", paint_spread},
          {"paint_1000_of_factorise", paint / factorise},
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
  CLI::App* verb = add_verb(app, "bench", "Times the solver, models, slices and pictures on this machine (medians)");
  struct Options {
    std::vector<std::filesystem::path> masks;
    int vertices = 2500;
  };
  auto options = std::make_shared<Options>();
  auto* masks = verb->add_option("--templates", options->masks,
                                 "Instead: a table of reference meshes, one of every label of these label maps");
  verb->add_option("--vertices", options->vertices, "Landmarks of each of them")
      ->check(CLI::Range(100, 200000))
      ->needs(masks)
      ->capture_default_str();
  const auto bench = [options](Progress& progress) -> Result<Report> {
    Report report;
    if (!options->masks.empty()) {
      report.values["templates"] = template_figures(options->masks, options->vertices, progress);
      return report;
    }
    report.values["cores"] = std::thread::hardware_concurrency();
    report.values["memory_gb_per_s"] = memory_gb_per_s();
    Json drags = Json::array();
    for (const int level : {4, 5, 6}) {
      drags.push_back(drag_figures(level));
      progress.report(0.2 * (level - 3));
      if (progress.cancelled()) return fail("bench", "was stopped");
    }
    report.values["drag"] = std::move(drags);
    report.values["model"] = model_figures();
    progress.report(0.8);
    if (progress.cancelled()) return fail("bench", "was stopped");
    report.values["pictures"] = picture_figures();
    return report;
  };
  verb->callback([bench, &run] { run = bench; });
}

}  // namespace homolog
