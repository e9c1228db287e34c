
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numeric>
#include <span>
#include <thread>
#include <vector>

#include "app/lab/bench_case.h"
#include "app/lab/bench_model.h"
#include "app/lab/bench_pictures.h"
#include "app/lab/bench_study.h"
#include "app/lab/bench_templates.h"
#include "app/lab/editor_frames.h"
#include "app/lab/experiment.h"
#include "app/lab/median.h"
#include "app/verbs/input_folders.h"
#include "core/base/processes/process.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/session/session.h"
#include "core/solve/dense_front.h"
#include "core/solve/elimination_plan.h"
#include "core/solve/shape_solver.h"

namespace homolog {

namespace {

using Clock = std::chrono::steady_clock;

/// What one frame of a drag costs on the core thread, job in to points out: a pull from the top of the mesh.
Json gesture_figures(const Mesh& mesh) {
  EditSession session(
      new_document("", nullptr, make_template({mesh.points, mesh.topology->triangles()}, "mesh").value()));
  const double radius_mm = bounds_of(mesh.points).sizes().mean() / 2;
  Eigen::Index top = 0;
  mesh.points.col(2).maxCoeff(&top);
  Stroke pull;
  pull.at = mesh.points.row(top);
  pull.sigma_mm = 0.3 * radius_mm;
  // As the window does while nobody works: the first gesture begins then as every other does.
  const auto opened = Clock::now();
  session.prepare();
  const double prepare_ms = milliseconds(Clock::now() - opened);
  const auto begin = Clock::now();
  pull.to = pull.at + Vec3(0, 0, 1);
  (void)session.preview(pull);
  const double begin_ms = milliseconds(Clock::now() - begin);
  // The cursor goes around, so that the surface point under it, and with it the falloff, is another one in every frame.
  const double moves = median_ms([&](int k) {
    const double a = 0.02 * k;
    pull.to = pull.at + radius_mm * Vec3(0.2 * std::sin(a), 0.2 * std::cos(a), 0.05);
    (void)session.preview(pull);
  });
  Stroke grab = pull;
  grab.tool = Tool::grab;
  (void)session.preview(grab);
  const double still = median_ms([&](int k) {
    grab.to = grab.at + Vec3(0.01 * (k % 100), 0, 3);
    (void)session.preview(grab);
  });
  Stroke commit = pull;
  const double committed = median_ms([&](int) {
    (void)session.apply(commit);
    (void)session.apply(Undo{});
  });
  return {{"vertices", mesh.points.rows()},       {"drag_frame_falloff_moves_ms", moves},
          {"drag_frame_falloff_still_ms", still}, {"prepare_ms", prepare_ms},
          {"gesture_begin_ms", begin_ms},         {"commit_ms", committed}};
}

/// What solving for x, y and z costs, and beside it a limit: reading as many numbers as the factor has twice, in single
/// precision, up and down as the solve does. Both by turns, so that they find the caches in one state.
Json solve_figures(const ShapeSolver& solver, const Points& points) {
  const Eigen::VectorXf numbers = Eigen::VectorXf::Ones(solver.factor_entries());
  const Eigen::Index count = numbers.size(), block = 4096;
  std::vector<double> solve_ms, limit_ms;
  float sum = 0;
  (void)median_ms([&](int) {
    const double start = thread_core_ms();
    (void)solver.solve(points);
    const double middle = thread_core_ms();
    for (Eigen::Index i = 0; i < count; i += block) sum += numbers.segment(i, std::min(block, count - i)).sum();
    for (Eigen::Index i = (count - 1) / block * block; i >= 0; i -= block)
      sum += numbers.segment(i, std::min(block, count - i)).sum();
    const double end = thread_core_ms();
    solve_ms.push_back(middle - start);
    limit_ms.push_back(end - middle);
  });
  const double solve = median_of(solve_ms), limit = sum > 0 ? median_of(limit_ms) : 0;
  return {{"solve_xyz_ms", solve}, {"limit_ms", limit}, {"solve_of_limit", solve / limit}};
}

/// The paper's whole optimisation: the system ordered, factorised and solved for x, y and z; and factorised again after
/// a touch of the stiffness brush.
Json system_figures(const Mesh& mesh) {
  const VertexScalars w = VertexScalars::Constant(mesh.points.rows(), 10);
  ShapeSolver solver(mesh.topology);
  const auto vertices = static_cast<int>(mesh.points.rows());
  const double analyse = median_ms([&](int) { EliminationPlan again(vertices, mesh.topology->edges()); });
  const double factorise = median_ms([&](int k) { (void)solver.factorise((1 + 0.1 * (k % 2)) * w); });
  const Vec3 centre = bounds_of(mesh.points).center();
  Json figures = solve_figures(solver, mesh.points.rowwise() - centre.transpose());
  // 1,000 landmarks are touched, until the solver is ready for the next drag. Numbers of a sphere by subdivision are
  // spread over all of it, which is the worst case: hardly a front stays.
  const auto paint_ms = [&](const std::vector<Eigen::Index>& touched) {
    return median_ms([&](int k) {
      VertexScalars painted = w;
      painted(touched).setConstant(11 + k % 7);
      (void)solver.factorise(painted);
    });
  };
  std::vector<Eigen::Index> landmarks(static_cast<std::size_t>(mesh.points.rows()));
  std::iota(landmarks.begin(), landmarks.end(), 0);
  const auto touched = landmarks.begin() + std::min<std::ptrdiff_t>(1000, std::ssize(landmarks));
  const double paint_spread = paint_ms({landmarks.begin(), touched});
  std::sort(landmarks.begin(), landmarks.end(),
            [&](Eigen::Index a, Eigen::Index b) { return mesh.points(a, 2) > mesh.points(b, 2); });
  const double paint = paint_ms({landmarks.begin(), touched});
  figures.update(Json{{"analyse_ms", analyse},
                      {"factorise_ms", factorise},
                      {"paint_1000_ready_ms", paint},
                      {"paint_1000_spread_ready_ms", paint_spread},
                      {"paint_1000_of_factorise", paint / factorise},
                      {"whole_optimisation_ms", analyse + factorise + figures["solve_xyz_ms"].get<double>()}});
  return figures;
}

Json drag_figures(const Mesh& mesh) {
  Json figures = gesture_figures(mesh);
  figures.update(system_figures(mesh));
  return figures;
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

struct BenchOptions {
  std::vector<std::filesystem::path> masks;
  std::filesystem::path mesh, opened;
  int vertices = 2500;
  bool editor = false, study = false;
  int shapes = 1000;
};

Result<Json> editor_figures() {
  const auto costs = frame_costs();
  if (!costs) return fail(costs.error());
  Json rows = Json::array();
  for (const FrameCost& cost : *costs) {
    rows.push_back({{"tool", cost.tool},
                    {"structures", cost.structures},
                    {"events_a_frame", events_a_frame},
                    {"frame_ms", cost.frame_ms},
                    {"slowest_frame_ms", cost.slowest_frame_ms}});
    if (cost.drawn_frame_ms) rows.back()["drawn_frame_ms"] = *cost.drawn_frame_ms;
  }
  return rows;
}

/// Of the built-in meshes, and of the one that is given.
Result<Json> drag_rows(const BenchOptions& options, Progress& progress) {
  Json drags = Json::array();
  for (const int level : {4, 5, 6, 7}) {
    drags.push_back(drag_figures(icosphere(level, 40)));
    progress.report(0.15 * (level - 3));
    if (progress.cancelled()) return fail("bench", "was stopped");
  }
  if (options.mesh.empty()) return drags;
  const auto mesh = read_mesh(options.mesh);
  if (!mesh) return fail(mesh.error());
  drags.push_back(drag_figures(*mesh));
  return drags;
}

Result<Report> run_bench(const BenchOptions& options, Progress& progress) {
  Report report;
  if (!options.masks.empty()) {
    report.values["templates"] = template_figures(options.masks, options.vertices, progress);
    return report;
  }
  if (options.study) {
    auto figures = study_figures(options.shapes, progress);
    if (!figures) return fail(figures.error());
    report.values["study"] = std::move(*figures);
    return report;
  }
  if (!options.opened.empty()) {
    if (auto there = check_there({options.opened}); !there) return fail(there.error());
    auto figures = figures_of_study(options.opened);
    if (!figures) return fail(figures.error());
    report.values["study"] = std::move(*figures);
    return report;
  }
  if (!options.editor) {
    report.values["cores"] = std::thread::hardware_concurrency();
    report.values["memory_gb_per_s"] = memory_gb_per_s();
    auto drags = drag_rows(options, progress);
    if (!drags) return fail(drags.error());
    report.values["drag"] = std::move(*drags);
    report.values["model"] = model_figures();
    progress.part(0.7, 0.95);
    auto day = case_figures(progress);
    if (!day) return fail(day.error());
    report.values["case"] = std::move(*day);
    progress.part(0, 1);
    progress.report(0.95);
    report.values["pictures"] = picture_figures();
  }
  auto editor = editor_figures();
  if (!editor) return fail(editor.error());
  report.values["editor"] = std::move(*editor);
  return report;
}

}  // namespace

void add_lab_bench(CLI::App& app, CommandLine& asked) {
  CLI::App* verb = add_verb(app, lab_bench.name, lab_bench.description);
  auto options = std::make_shared<BenchOptions>();
  auto* masks =
      verb->add_option("--templates", options->masks,
                       "Instead: makes a template of every label in these label maps and reports them as a table");
  verb->add_option("--vertices", options->vertices, "Vertices of each of these templates")
      ->check(CLI::Range(100, 200000))
      ->needs(masks)
      ->capture_default_str();
  auto* one_mesh = verb->add_option("--mesh", options->mesh, "Times the solver on this mesh too")->excludes(masks);
  auto* editor =
      verb->add_flag("--editor", options->editor, "Instead: only the editor's frames while a person drags and paints")
          ->excludes(masks)
          ->excludes(one_mesh);
  auto* study = verb->add_flag("--study", options->study, "Instead: opens a large study of phantoms in the Models mode")
                    ->excludes(masks)
                    ->excludes(one_mesh)
                    ->excludes(editor);
  verb->add_option("--opened", options->opened, "Instead: the same of a study of your own (.study.json)")
      ->excludes(masks)
      ->excludes(one_mesh)
      ->excludes(editor)
      ->excludes(study);
  verb->add_option("--shapes", options->shapes, "Shapes of that study")
      ->check(CLI::Range(2, 100000))
      ->needs(study)
      ->capture_default_str();
  verb->callback(
      [options, &asked] { asked.run = [options](Progress& progress) { return run_bench(*options, progress); }; });
}

}  // namespace homolog
