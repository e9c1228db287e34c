#include <chrono>
#include <cstdio>

#include "app/verbs/fit/snap_arguments.h"
#include "app/verbs/read_image.h"
#include "app/verbs/record.h"
#include "app/verbs/study/study_make.h"
#include "app/verbs/study/study_templates.h"
#include "core/adapt/propagate.h"
#include "core/assist/assist.h"
#include "core/base/files/files.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/files/mesh_frame.h"
#include "core/mesh/parts/rims.h"
#include "core/model/shapes/shape_folder.h"
#include "core/model/shapes/study.h"
#include "core/session/case_file.h"
#include "core/template/template_warnings.h"

// The verb `propagate`: the mesh of one frame through a whole cine.

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct PropagateVerb {
  std::string mesh;
  fs::path image, out;
  int frame = 0;
  PropagateOptions options;
  GivenCommand command;
};

std::string frame_name(std::size_t frame) {
  char name[32];
  std::snprintf(name, sizeof name, "frame-%02zu", frame);
  return name;
}

fs::path case_path_of(const PropagateVerb& verb) {
  return verb.out / "cine.homolog";
}

fs::path study_path_of(const PropagateVerb& verb) {
  return verb.out / "cine.study.json";
}

/// A case with a mesh in every frame. The frames' points become what the case keeps of them, so that the meshes that
/// are written are those of the case.
Result<EditSession> case_of_cine(const PropagateVerb& verb, const Document& initial, Propagation& propagation) {
  EditSession session(initial);
  const auto apply = [&](Action action) { return session.apply(std::move(action)); };
  if (auto done = apply(SetPlacement{Similarity{}}); !done) return fail(done.error());
  for (std::size_t f = 0; f < propagation.frames.size(); ++f) {
    PropagatedFrame& frame = propagation.frames[f];
    if (auto done = apply(SetFrame{static_cast<int>(f)}); !done) return fail(done.error());
    const bool given = static_cast<int>(f) == verb.frame;
    SetPoints edit =
        points_edit(*session.document().view(), frame.points, given ? FoundBy::start_of_cine : FoundBy::propagation);
    edit.doubt = frame.doubt;
    if (auto done = apply(std::move(edit)); !done) return fail(done.error());
    frame.points = *session.document().view()->shape.points;
    if (frame.doubt.empty()) continue;
    if (auto done = apply(Note{"frame " + std::to_string(f) + " " + frame.doubt}); !done) return fail(done.error());
  }
  if (auto done = apply(SetFrame{verb.frame}); !done) return fail(done.error());
  // The case says itself that nobody worked on it since [was_worked_on].
  if (auto noted = apply(Note{"fit", {}, {}}); !noted) return fail(noted.error());
  return session;
}

/// Every frame as a case of a study; those in doubt are still to do.
Study study_of(const PropagateVerb& verb, const Propagation& propagation, const fs::path& case_path) {
  Study study;
  study.template_file = names_file(verb.mesh) ? fs::absolute(verb.mesh) : fs::path(verb.mesh);
  for (std::size_t f = 0; f < propagation.frames.size(); ++f) {
    StudyCase one;
    one.name = frame_name(f);
    one.file = fs::absolute(case_path);
    one.frame = static_cast<int>(f);
    one.notes = propagation.frames[f].doubt;
    one.state = one.notes.empty() ? CaseState::done : CaseState::to_do;
    study.cases.push_back(std::move(one));
  }
  return study;
}

std::string volume_table(const Propagation& propagation, double frame_seconds) {
  std::string table = "frame,seconds,volume_ml,confidence,disagreement_mm,doubt\n";
  for (std::size_t f = 0; f < propagation.frames.size(); ++f) {
    const PropagatedFrame& frame = propagation.frames[f];
    char line[160];
    std::snprintf(line, sizeof line, "%zu,%.4f,%.3f,%.3f,", f, static_cast<double>(f) * frame_seconds, frame.volume_ml,
                  frame.confidence);
    table += line;
    if (frame.disagreement_mm) {
      std::snprintf(line, sizeof line, "%.3f", *frame.disagreement_mm);
      table += line;
    }
    table += "," + (frame.doubt.empty() ? "" : '"' + frame.doubt + '"') + "\n";
  }
  return table;
}

/// Errors: a mesh that would be written is the one that is carried.
Result<void> check_written_frames(const PropagateVerb& verb, int frames) {
  std::vector<fs::path> written;
  for (int f = 0; f < frames; ++f) written.push_back(verb.out / (frame_name(static_cast<std::size_t>(f)) + ".ply"));
  return check_not_read(written, {fs::path(verb.mesh)});
}

Result<void> write_all(const PropagateVerb& verb, const Document& initial, Propagation& propagation,
                       std::vector<std::string>& warnings, Progress& progress) {
  const auto made = ResultFolder::make(verb.out);
  if (!made) return fail(made.error());
  auto session = case_of_cine(verb, initial, propagation);
  if (!session) return fail(session.error());
  const Template& the_template = *initial.structure()->the_template;
  MeshFile file = to_mesh_file(the_template);
  const auto record = record_of(verb.command, progress);
  if (!record) return fail(record.error());
  for (std::size_t f = 0; f < propagation.frames.size(); ++f) {
    file.points = propagation.frames[f].points;
    file.landmarks = carried_landmarks(the_template, file.points);
    note_frame(file, static_cast<int>(f));
    const std::string output = frame_name(f) + ".ply";
    file.record = record_of_output(*record, output);
    if (auto written = write_mesh_file(file, verb.out / output); !written) return written;
  }
  const double frame_seconds = initial.scan.image->frame_seconds;
  const std::string table = volume_table(propagation, frame_seconds);
  if (auto written = write_whole_file(verb.out / "volumes.csv", table); !written) return written;
  const fs::path file_of_case = case_path_of(verb), study = study_path_of(verb);
  session->set_record(record_of_made(*record, verb.out, file_of_case));
  std::error_code ignored;
  if (fs::exists(file_of_case, ignored) && was_worked_on(file_of_case))
    warnings.push_back(file_of_case.string() +
                       ": was worked on, so it stays as it is; move it away, or name another folder");
  else if (auto saved = save_case_as(*session, file_of_case); !saved)
    return fail(saved.error());
  const auto added = write_cases_into(study, verb.mesh, study_of(verb, propagation, file_of_case).cases,
                                      record_of_made(*record, verb.out, study));
  return added ? Result<void>() : fail(added.error());
}

Report report_of(const PropagateVerb& verb, const Topology& topology, const Propagation& propagation,
                 double missing_share) {
  Report report;
  report.made = {verb.out / "volumes.csv"};
  if (const std::string closed = closed_flat(topology); !closed.empty())
    report.warnings.push_back(verb.mesh + ": " + closed);
  if (missing_share > 0)
    report.warnings.push_back(verb.mesh + ": every frame " + missing_doubt(missing_share) +
                              ", so volumes are too small; make the template again with another --axis");
  Json frames = Json::array(), doubtful = Json::array();
  for (std::size_t f = 0; f < propagation.frames.size(); ++f) {
    const PropagatedFrame& frame = propagation.frames[f];
    frames.push_back({{"frame", f},
                      {"mesh", (verb.out / (frame_name(f) + ".ply")).string()},
                      {"volume_ml", frame.volume_ml},
                      {"confidence", frame.confidence},
                      {"disagreement_mm", frame.disagreement_mm ? Json(*frame.disagreement_mm) : Json()},
                      {"doubt", frame.doubt}});
    if (frame.doubt.empty()) continue;
    doubtful.push_back(f);
    if (missing_share > 0 && frame.doubt == missing_doubt(missing_share)) continue;
    report.warnings.push_back(verb.image.string() + ": frame " + std::to_string(f) + " " + frame.doubt +
                              "; look at it in the editor");
  }
  const auto volume = [&](int f) { return propagation.frames[f].volume_ml; };
  report.values = {{"frames", std::move(frames)},
                   {"cycle", propagation.cycle},
                   {"end_diastole", propagation.ejection.end_diastole},
                   {"end_systole", propagation.ejection.end_systole},
                   {"end_diastolic_volume_ml", volume(propagation.ejection.end_diastole)},
                   {"end_systolic_volume_ml", volume(propagation.ejection.end_systole)},
                   {"ejection_fraction", propagation.ejection.fraction},
                   {"doubtful", std::move(doubtful)},
                   {"case", case_path_of(verb).string()},
                   {"study", study_path_of(verb).string()}};
  return report;
}

/// The frame that a mesh's file notes; none of a built-in template.
Result<std::optional<int>> noted_in(const std::string& mesh) {
  if (!names_file(mesh)) return std::optional<int>();
  const auto file = read_mesh_file(mesh);
  if (!file) return fail(file.error());
  return noted_frame(*file);
}

Result<Report> run_propagate(const PropagateVerb& verb, Progress& progress) {
  auto the_template = load_template(verb.mesh);
  if (!the_template) return fail(the_template.error());
  const auto noted = noted_in(verb.mesh);
  if (!noted) return fail(noted.error());
  const auto suits = check_template_of_study(study_path_of(verb), {*the_template}, verb.mesh,
                                             "give a mesh of that template, or another folder");
  if (!suits) return fail(suits.error());
  auto image = read_image(verb.image, verb.frame, progress);
  if (!image) return fail(image.error());
  if (auto safe = check_written_frames(verb, image->volume.frames); !safe) return fail(safe.error());
  PropagateOptions options = verb.options;
  options.progress = &progress;
  options.missing_share = (*the_template)->missing_share;
  const auto start = std::chrono::steady_clock::now();
  auto propagation = propagate(image->volume, verb.frame, {(*the_template)->topology, (*the_template)->points},
                               (*the_template)->stiffness, options);
  if (!propagation) return fail(verb.image.string(), propagation.error().what);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const Document initial =
      new_document(verb.image.string(), std::make_shared<const Volume>(std::move(image->volume)), *the_template);
  std::vector<std::string> kept;
  if (auto written = write_all(verb, initial, *propagation, kept, progress); !written) return fail(written.error());
  Report report = report_of(verb, *(*the_template)->topology, *propagation, options.missing_share);
  report.warnings.insert(report.warnings.end(), kept.begin(), kept.end());
  report.values["seconds"] = seconds;
  report.warnings.insert(report.warnings.begin(), image->warnings.begin(), image->warnings.end());
  const auto of_template = template_warnings(**the_template);
  report.warnings.insert(report.warnings.begin(), of_template.begin(), of_template.end());
  if (*noted && **noted != verb.frame)
    report.warnings.insert(report.warnings.begin(), verb.mesh + ": notes that it is of frame " +
                                                        std::to_string(**noted) + ", and was carried from frame " +
                                                        std::to_string(verb.frame) + "; check --frame");
  return report;
}

}  // namespace

void add_propagate(CLI::App& app, CommandLine& asked) {
  auto options = std::make_shared<PropagateVerb>();
  CLI::App* verb = add_verb(app, "propagate", "Carries the mesh of one frame through all frames of a cine");
  verb->add_option("MESH", options->mesh, "The mesh of one frame, lying on its organ")->required();
  verb->add_option("--image", options->image, "The cine")->required();
  verb->add_option("--frame", options->frame, "The frame that the mesh is of, from 0")
      ->check(CLI::NonNegativeNumber)
      ->required();
  verb->add_option("-o,--output", options->out, "The folder for meshes, case, study and volumes")->required();
  verb->add_option("--reach-mm", options->options.reach_mm,
                   "How far (mm) the boundary may move from one frame to the next")
      ->check(CLI::Range(0.5, 50.0))
      ->capture_default_str();
  verb->callback([options, verb, &asked] {
    options->command = given_command(*verb);
    asked.run = [options](Progress& progress) { return run_propagate(*options, progress); };
  });
}

}  // namespace homolog
