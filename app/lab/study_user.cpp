#include "app/lab/experiment.h"

#include "app/verbs/read_image.h"
#include "core/catalogue/catalogue.h"
#include "core/measure/compare.h"
#include "core/mesh/files/landmark_io.h"
#include "core/session/case_file.h"
#include "core/volume/volume_io.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct UserOptions {
  std::string template_source, scheme;
  fs::path mask, landmarks, image, out;
  TargetOptions target;
  SchemeRunOptions work{.most_pulls = 120};
  bool mirror = false;
};

Result<ExperimentSubject> subject_of(const UserOptions& options, const Template& the_template,
                                     std::vector<std::string>& warnings, Progress& progress) {
  auto subject = mask_subject(options.mask, options.target, the_template, warnings, progress);
  if (!subject || options.landmarks.empty()) return subject;
  auto landmarks = read_landmarks(options.landmarks);
  if (!landmarks) return fail(landmarks.error());
  subject->shown = std::move(*landmarks);
  return subject;
}

Result<Report> study_user(const UserOptions& options, Progress& progress) {
  const auto scheme =
      working_scheme(options.scheme.empty() ? pulling_scheme(!options.landmarks.empty()) : options.scheme);
  if (!scheme) return fail(scheme.error());
  auto the_template = load_template(options.template_source);
  if (!the_template) return fail(the_template.error());
  Report report;
  const auto subject = subject_of(options, **the_template, report.warnings, progress);
  if (!subject) return fail(subject.error());
  std::shared_ptr<const Volume> image;
  if (!options.image.empty()) {
    auto read = read_image(options.image, 0, progress);
    if (!read) return fail(read.error());
    image = std::make_shared<const Volume>(std::move(read->volume));
  }
  // In memory, so that the case appears whole or not at all.
  EditSession session(new_document(options.image.string(), image, *the_template));
  if (options.mirror) {
    if (auto mirrored = session.apply(MirrorTemplate{}); !mirrored) return fail(mirrored.error());
  }
  SchemeRunOptions work = options.work;
  work.progress = &progress;
  const auto run = run_scheme(session, *subject, *scheme, work);
  if (!run) return fail(options.out.string(), run.error().what);
  if (auto saved = save_case_as(session, options.out); !saved) return fail(saved.error());
  report.values = {{"case", options.out.string()}, {"scheme", scheme->name}};
  report.values.update(json_of(*run));
  return report;
}

}  // namespace

void add_study_user(CLI::App& study, CommandLine& asked) {
  auto options = std::make_shared<UserOptions>();
  CLI::App* verb = add_verb(study, lab_user.name, lab_user.description);
  verb->add_option("TEMPLATE", options->template_source, template_sources())->required();
  verb->add_option("--mask", options->mask, "The label map to adapt to")->required();
  add_target_options(*verb, options->target);
  verb->add_option("--landmarks", options->landmarks, "Named places on the organ that the scripted user is shown");
  verb->add_option(
      "--scheme", options->scheme,
      "anchored, raw, paper-1, paper-10 or spacing; then +grab, +warp or +hold if wanted; then +refine if wanted");
  verb->add_option("--image", options->image, "The volume that the case is for");
  verb->add_option("--pulls", options->work.most_pulls, "At most this many pulls")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  verb->add_option("--seed", options->work.seed, "Seed of the random disturbance of the placement")
      ->check(CLI::NonNegativeNumber);
  verb->add_flag("--mirror", options->mirror, "Use the template of the other side (left for right)");
  verb->add_option("-o,--output", options->out, "The case file to write")->required();
  verb->callback(
      [options, &asked] { asked.run = [options](Progress& progress) { return study_user(*options, progress); }; });
}

void add_target_options(CLI::App& verb, TargetOptions& options) {
  add_label_option(verb, options.label,
                   "Which label of the mask, where it holds several, by number or name; 1,2: both together");
  add_mask_frame_option(verb, options.frame);
  add_ball_option(verb, "--closing-mm", options.closing_mm, "Clefts narrower than twice this radius (mm) are filled");
}

Result<ExperimentSubject> mask_subject(const fs::path& path, const TargetOptions& options, const Template& the_template,
                                       std::vector<std::string>& warnings, Progress& progress) {
  auto mask = read_mask(path, options.label, {options.frame, {}}, progress);
  if (!mask) return fail(mask.error());
  warnings.insert(warnings.end(), mask->warnings.begin(), mask->warnings.end());
  auto boundary =
      label_boundary(mask->volume, mask->label, mask->frame, options.closing_mm, the_template.points.rows());
  if (!boundary) return fail(path.string(), mask->named(boundary.error().what));
  ExperimentSubject subject;
  subject.target = std::move(boundary->surface);
  subject.visible_mm = mask->volume.geometry.spacing_mm.maxCoeff();
  return subject;
}

Json json_of(const SchemeRun& run) {
  const auto or_null = [](const auto& value) { return value ? Json(*value) : Json(); };
  return {{"landmarks_placed_mm", or_null(run.landmarks_placed)},
          {"landmarks_after_features_mm", or_null(run.landmarks_after_features)},
          {"landmarks_mm", or_null(run.landmarks)},
          {"assd_placed_mm", run.assd_placed},
          {"assd_mm", run.assd},
          {"hd95_mm", run.hd95},
          {"dice", run.dice},
          {"feature_strokes", run.feature_strokes},
          {"pulls", run.pulls},
          {"pulls_to_1mm", or_null(run.pulls_to_1mm)},
          {"edge_spread", run.edge_spread},
          {"min_angle_deg", run.min_angle_deg},
          {"turned_triangles", run.turned_triangles}};
}

}  // namespace homolog
