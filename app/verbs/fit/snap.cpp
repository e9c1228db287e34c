#include <chrono>
#include <optional>

#include "app/verbs/describe.h"
#include "app/verbs/fit/snap_arguments.h"
#include "app/verbs/read_image.h"
#include "app/verbs/record.h"
#include "core/assist/assist.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/files/mesh_frame.h"
#include "core/session/case_file.h"
#include "core/template/template_warnings.h"

// The verb `snap`: draws a mesh, or a case's mesh as one more edit of it, to the boundary that an image shows.

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct SnapVerb {
  SnapArguments snap;
  fs::path source, image, out;
  std::string structure;
  std::vector<double> at;
  double sigma_mm = 10;
  bool frame_given = false;
  GivenCommand command;

  bool of_case() const { return is_case_file(source); }
};

/// The mesh on its image as a case in memory, as it lies.
Result<EditSession> session_of(const SnapVerb& verb, Progress& progress, std::vector<std::string>& warnings) {
  auto mesh = load_template(verb.source.string());
  if (!mesh) return fail(mesh.error());
  const auto file = read_mesh_file(verb.source);
  if (!file) return fail(file.error());
  const auto noted = noted_frame(*file);
  const int frame = verb.frame_given ? verb.snap.frame : noted.value_or(0);
  auto image = read_image(verb.image, frame, progress);
  if (!image) return fail(image.error());
  warnings = image->warnings;
  if (image->volume.frames > 1 && !verb.frame_given && !noted)
    warnings.push_back(frame_taken(verb.image, image->volume.frames, frame));
  EditSession session(
      new_document(verb.image.string(), std::make_shared<const Volume>(std::move(image->volume)), *mesh));
  for (const Action& action : {Action(SetFrame{frame}), Action(SetPlacement{Similarity{}})})
    if (auto done = session.apply(action); !done) return fail(done.error());
  return session;
}

Result<EditSession> opened(const SnapVerb& verb, Progress& progress, std::vector<std::string>& warnings) {
  if (!verb.of_case()) return session_of(verb, progress, warnings);
  auto read = open_case(verb.source, &progress);
  if (!read) return fail(read.error());
  return std::move(read->session);
}

/// What is to be said of the mesh's file, and of a mesh that does not lie in the image because of units or axes.
std::vector<std::string> meeting_warnings(const SnapVerb& verb, const Scan& scan, const ShapeView& shown) {
  std::vector<std::string> warnings = template_warnings(shown.the_template());
  const Points& points = *shown.shape.points;
  const VolumeGeometry& grid = scan.image->geometry;
  if (const auto misfit = misfit_in_image(bounds_of(points), grid))
    warnings.push_back(
        misfit_sentence(*misfit, meeting_of(verb.source, points), {scan.source, grid.bounds_mm().diagonal().norm()}));
  return warnings;
}

Result<Report> run_snap(const SnapVerb& verb, Progress& progress) {
  if (auto there = check_folder_of(verb.out); !there) return fail(there.error());
  std::vector<std::string> of_image;
  auto session = opened(verb, progress, of_image);
  if (!session) return fail(session.error());
  const Scan& scan = session->document().scan;
  const auto chosen = choose_structure(session->document(), verb.source, verb.structure);
  if (!chosen) return fail(chosen.error());
  const auto before = session->document().view(chosen->id);
  if (!before) return fail(verb.source.string(), "has no mesh in the frame it shows; start it in the editor");
  if (!scan.image) return fail(verb.source.string(), "has no image to snap to; give a case that has one");
  const auto met = meeting_warnings(verb, scan, *before);
  auto options = snap_options(verb.snap, before->shape.points->rows(), progress);
  if (!options) return fail(options.error());
  options->progress = &progress;
  std::optional<SnapArea> region;
  if (!verb.at.empty()) region = SnapArea{Vec3(verb.at[0], verb.at[1], verb.at[2]), verb.sigma_mm};

  const auto start = std::chrono::steady_clock::now();
  auto snapped = snap_shape(scan, *before, region, *options);
  const fs::path image = verb.image.empty() ? fs::path(scan.source) : verb.image;
  if (!snapped) return fail(image.string(), snapped.error().what);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (auto done = session->apply(std::move(snapped->action), false, chosen->id); !done)
    return fail(verb.source.string(), done.error().what);

  const auto after = session->document().view(chosen->id);
  if (!verb.out.empty()) {
    MeshFile file = to_mesh_file(*after, session->document().scan.frames() > 1);
    if (!verb.of_case()) file.landmarks = carried_landmarks(after->the_template(), *after->shape.points);
    // The case has gone on: it is playing it that gives this mesh.
    auto record =
        verb.of_case() ? record_of_case(verb.source, verb.structure, progress) : record_of(verb.command, progress);
    if (!record) return fail(record.error());
    file.record = std::move(*record);
    if (auto written = write_mesh_file(file, verb.out); !written) return fail(written.error());
  }
  Report report = snap_report(snapped->result, after->mesh(), *after->shape.placed, image);
  report.warnings.insert(report.warnings.begin(), met.begin(), met.end());
  report.warnings.insert(report.warnings.begin(), of_image.begin(), of_image.end());
  if (!chosen->warning.empty()) report.warnings.push_back(chosen->warning);
  report.values["held_landmarks"] = snapped->landmarks;
  report.values["held_contours"] = snapped->contours;
  report.values["held_pulls"] = snapped->pulls;
  report.values["seconds"] = seconds;
  if (!session->news().empty()) report.warnings.push_back(session->news());
  return report;
}

void check_snap(const SnapVerb& verb) {
  if (!verb.of_case() && verb.image.empty()) throw CLI::RequiredError("--image");
  if (!verb.of_case() && verb.out.empty()) throw CLI::RequiredError("--output");
  if (verb.of_case() && !verb.image.empty())
    throw CLI::ValidationError("--image", "is for a mesh; a case has its own image");
  if (!verb.of_case() && !verb.structure.empty())
    throw CLI::ValidationError("--structure", "is for a case; a mesh is one structure");
  if (verb.of_case() && verb.frame_given)
    throw CLI::ValidationError("--frame", "is for a mesh; a case is snapped in the frame that it shows");
}

}  // namespace

void add_snap(CLI::App& app, CommandLine& asked) {
  auto options = std::make_shared<SnapVerb>();
  CLI::App* verb = add_verb(app, "snap", "Draws a mesh to the boundary that an image shows");
  verb->add_option("MESH|CASE", options->source,
                   "A mesh that lies on its organ, or a case file, which gets one more edit")
      ->required();
  verb->add_option("--image", options->image, "The image; only with a mesh, since a case has its own");
  verb->add_option("--structure", options->structure,
                   "Of a case of several structures this one, by name (default: the first)");
  keeps_correspondence(verb->add_option("-o,--output", options->out, "The mesh to write"));
  auto* at = verb->add_option("--at", options->at, "x,y,z in mm: only the part of the mesh around this point")
                 ->delimiter(',')
                 ->expected(3);
  verb->add_option("--sigma-mm", options->sigma_mm, "How wide that part is (mm)")
      ->check(CLI::Range(0.5, 200.0))
      ->needs(at)
      ->capture_default_str();
  add_snap_arguments(*verb, options->snap);
  verb->callback([options, verb, &asked] {
    options->frame_given = verb->count("--frame") > 0;
    check_snap(*options);
    options->command = given_command(*verb);
    asked.run = [options](Progress& progress) { return run_snap(*options, progress); };
  });
}

}  // namespace homolog
