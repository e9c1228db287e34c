#include <algorithm>

#include "app/lab/experiment.h"
#include "app/verbs/read_image.h"
#include "app/verbs/template/subjects.h"
#include "core/groupwise/cohort_template.h"
#include "core/mesh/mesh_io.h"

// The verb `study bias`: how much results depend on the subject that the template was made from.

namespace homolog {

namespace {

struct BiasJob {
  SubjectFiles subjects;
  bool consensus = false;
};

Result<Report> study_bias(const BiasJob& options, Progress& progress) {
  progress.part(0, 0.05);
  auto read = read_subjects(options.subjects, progress);
  if (!read) return fail(read.error());
  progress.part(0.05, 1);
  const auto bias = template_bias(read->subjects, {options.subjects.vertices, options.consensus, &progress});
  if (!bias) return fail(bias.error());
  Report report;
  report.warnings = std::move(read->warnings);
  report.warnings.insert(report.warnings.end(), bias->warnings.begin(), bias->warnings.end());
  for (const std::string& name : bias->failed)
    report.warnings.push_back(name + ": its template did not fit all subjects, so it is left out as a start");
  for (const std::string& name : bias->doubtful) report.warnings.push_back(other_organ_warning(name));
  report.values = {
      {"subjects", read->subjects.size()},
      {"starts", read->subjects.size() - bias->failed.size()},
      {"consensus", options.consensus},
      {"spread_mm", {{"mean", bias->spread_mm}, {"p95", bias->spread_p95_mm}, {"max", bias->spread_max_mm}}},
      {"spread_of_mm", bias->spread_of_mm},
      {"apart_mm_of", bias->apart_mm_of},
      {"best_start", bias->best_start},
      {"rv", bias->rv},
      {"rv_least", bias->rv_least},
      {"flipped", read->flipped}};
  read->report_frames(report.values);
  return report;
}

}  // namespace

void add_study_bias(CLI::App& study, CommandLine& asked) {
  auto options = std::make_shared<BiasJob>();
  CLI::App* verb = add_verb(study, lab_bias.name, lab_bias.description);
  SubjectFiles& subjects = options->subjects;
  verb->add_option("SHAPE", subjects.files, "Surfaces or label maps of at least three subjects, or a folder of them")
      ->required();
  verb->add_option("--landmarks", subjects.landmarks,
                   "Folder with NAME.mrk.json, .fcsv or .json for each: the places whose spread is measured (default: "
                   "places all over the surface)")
      ->check(CLI::ExistingDirectory);
  add_label_option(*verb, subjects.label,
                   "Which label of label maps that hold several, by number or name; 1,2: both together");
  add_mask_frame_option(*verb, subjects.frame);
  add_ball_option(*verb, "--closing-mm", subjects.closing_mm, "Clefts narrower than twice this radius (mm) are filled");
  verb->add_option("--vertices", subjects.vertices, "How many vertices the templates have")
      ->check(CLI::Range(100, 200000))
      ->capture_default_str();
  verb->add_flag("--flip-mirrored", subjects.flip_mirrored, "Flip subjects that are mirror images of most others");
  verb->add_flag("--consensus", options->consensus, "Make a consensus template from each start first");
  verb->callback(
      [options, &asked] { asked.run = [options](Progress& progress) { return study_bias(*options, progress); }; });
}

}  // namespace homolog
