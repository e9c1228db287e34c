#include "core/assist/assist.h"

#include <chrono>
#include <filesystem>

#include "app/verbs/describe.h"
#include "app/verbs/record.h"
#include "core/deform/fold_guard.h"
#include "core/measure/compare.h"
#include "core/mesh/mesh_quality.h"
#include "core/session/case_file.h"

// The verb `refine`: moves the vertices of a case along the surface that its mesh has.

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct RefineVerb {
  fs::path file, out;
  std::string structure;
};

Result<Report> run_refine(const RefineVerb& verb, Progress& progress) {
  if (auto there = check_folder_of(verb.out); !there) return fail(there.error());
  auto read = open_case(verb.file, &progress);
  if (!read) return fail(read.error());
  EditSession& session = read->session;
  const auto start = std::chrono::steady_clock::now();
  const auto chosen = choose_structure(session.document(), verb.file, verb.structure);
  if (!chosen) return fail(chosen.error());
  const auto shown = shape_to("refine", session.document(), chosen->id);
  if (!shown) return fail(verb.file.string(), shown.error().what);
  auto refined = refine_shape(*shown, &progress);
  if (!refined) return fail(verb.file.string(), refined.error().what);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const Mesh before = shown->mesh();
  if (auto done = session.apply(std::move(refined->action), false, chosen->id); !done)
    return fail(verb.file.string(), done.error().what);
  const ShapeView done = *session.document().view(chosen->id);
  if (!verb.out.empty()) {
    MeshFile file = to_mesh_file(done, session.document().scan.frames() > 1);
    auto record = record_of_case(verb.file, verb.structure, progress);
    if (!record) return fail(record.error());
    file.record = std::move(*record);
    if (auto written = write_mesh_file(file, verb.out); !written) return fail(written.error());
  }
  const Mesh after = done.mesh();
  const auto moved_mm = (after.points - before.points).rowwise().norm();
  Report report;
  report.values = {{"moved_mm", {{"mean", moved_mm.mean()}, {"max", moved_mm.maxCoeff()}}},
                   {"surface_distance_mm", json_of(surface_distance(after, before))},
                   {"turned_triangles", turned_triangles(*before.topology, *done.shape.placed, after.points).size()},
                   {"self_intersections", self_intersections(after).size()},
                   {"seconds", seconds}};
  report.warnings = read->warnings;
  if (!chosen->warning.empty()) report.warnings.push_back(chosen->warning);
  if (!session.news().empty()) report.warnings.push_back(session.news());
  for (const std::string& warning : refined->warnings) report.warnings.push_back(verb.file.string() + ": " + warning);
  return report;
}

}  // namespace

void add_refine(CLI::App& app, CommandLine& asked) {
  auto options = std::make_shared<RefineVerb>();
  CLI::App* verb = add_verb(
      app, "refine", "Fits the template to a case's surface and moves its vertices along the surface accordingly");
  verb->add_option("CASE", options->file, "The case file, which gets one more edit")->required();
  verb->add_option("--structure", options->structure,
                   "Of a case of several structures this one, by name (default: the first)");
  keeps_correspondence(verb->add_option("-o,--output", options->out, "The mesh to write"));
  verb->callback(
      [options, &asked] { asked.run = [options](Progress& progress) { return run_refine(*options, progress); }; });
}

}  // namespace homolog
