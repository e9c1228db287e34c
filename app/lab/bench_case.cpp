#include "app/lab/bench_case.h"

#include <algorithm>
#include <filesystem>
#include <random>
#include <vector>

#include "app/lab/median.h"
#include "core/base/processes/memory.h"
#include "core/base/processes/process.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/construction/icosphere.h"
#include "core/session/case_file.h"

namespace homolog {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr int gestures = 5000;
constexpr double radius_mm = 60;

/// Gestures of a day: strokes, touches of the stiffness brush, and, two of five, what a snap of the whole mesh finds: a
/// smooth way of half a millimetre and noise. (A real snap searches the image first, which is no matter of the case.)
class Day {
 public:
  Action gesture(const Document& document, int number) {
    std::normal_distribution<double> normal;
    const Vec3 at = radius_mm * Vec3(normal(random_), normal(random_), normal(random_)).normalized();
    if (number % 5 < 2) return snap(document, at);
    if (number % 10 == 9) return PaintStiffness{at, 15, 10, 0.5};
    return Stroke{Tool::pull, at, 1.02 * at, 8, {}, false, 1};
  }

 private:
  Action snap(const Document& document, const Vec3& at) {
    std::uniform_real_distribution<double> noise(-0.05, 0.05);
    Points points = *document.view()->shape.points;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      const double wave = 0.5 * std::sin(points.row(i).dot(at) / 600);
      points.row(i) += Eigen::RowVector3d(wave, -wave, wave);
      for (double& x : points.row(i)) x += noise(random_);
    }
    return points_edit(*document.view(), points, FoundBy::snap);
  }

  std::mt19937 random_{1};
};

Result<Json> work(EditSession session, Progress& progress) {
  Day day;
  std::vector<double> strokes, snaps;
  for (int k = 0; k < gestures; ++k) {
    const Action action = day.gesture(session.document(), k);
    const auto before = Clock::now();
    const auto done = session.apply(action);
    const double ms = milliseconds(Clock::now() - before);
    if (std::holds_alternative<SetPoints>(action)) {
      if (!done) return fail(done.error());
      snaps.push_back(ms);
    } else if (done && std::holds_alternative<Stroke>(action)) {
      strokes.push_back(ms);
    }
    progress.report(0.8 * k / gestures);
    if (progress.cancelled()) return fail("bench", "was stopped");
  }
  return Json{{"stroke_ms", median_of(strokes)}, {"snap_ms", median_of(snaps)}};
}

}  // namespace

Result<Json> case_figures(Progress& progress) {
  const ScratchFolder folder("homolog-bench");
  const fs::path source = folder.path / "ball.ply", file = folder.path / "day.homolog";
  const double before_mb = resident_memory_mb();
  forget_peak_memory();
  if (auto written = write_mesh(icosphere(5, radius_mm), source); !written) return fail(written.error());
  auto the_template = load_template(source.string());
  if (!the_template) return fail(the_template.error());
  auto session = create_case(new_document("", nullptr, *the_template), file);
  if (!session) return fail(session.error());
  auto done = work(std::move(*session), progress);
  if (!done) return done;
  Json figures{{"vertices", (*the_template)->points.rows()}, {"gestures", gestures}};
  figures.update(*done);
  figures["work_peak_mb"] = peak_memory_mb() - before_mb;
  std::error_code none;
  figures["file_mb"] = static_cast<double>(fs::file_size(file, none)) / 1e6;

  forget_peak_memory();
  const auto start = Clock::now();
  auto opened = open_case(file);
  if (!opened) return fail(opened.error());
  figures["open_seconds"] = milliseconds(Clock::now() - start) / 1000;
  figures["open_peak_mb"] = peak_memory_mb() - before_mb;
  double longest = 0;
  const auto begun = Clock::now();
  for (int k = 0; opened->session.can_undo(); ++k) {
    const auto before = Clock::now();
    if (auto undone = opened->session.apply(Undo{}); !undone) return fail(undone.error());
    longest = std::max(longest, milliseconds(Clock::now() - before));
    progress.report(0.8 + 0.2 * k / gestures);
    if (progress.cancelled()) return fail("bench", "was stopped");
  }
  figures["undo_all_seconds"] = milliseconds(Clock::now() - begun) / 1000;
  figures["longest_undo_ms"] = longest;
  figures["undo_peak_mb"] = peak_memory_mb() - before_mb;
  return figures;
}

}  // namespace homolog
