#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>

#include "app/lab/chart.h"
#include "app/lab/experiment.h"
#include "app/lab/tables.h"
#include "app/verbs/case_pool.h"
#include "core/base/files/files.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/files/landmark_io.h"
#include "core/model/files/model_files.h"
#include "core/model/measures/measures.h"
#include "core/session/case_file.h"

// The verb `study schemes`: the claims measured [docs/lab.md].

namespace homolog {

namespace fs = std::filesystem;

namespace {

constexpr double doubtful_dice = 0.8;
constexpr int fewest_for_model = 4;
constexpr Eigen::Index model_modes = 3, model_samples = 1000;
constexpr std::uint64_t model_seed = 1;

struct SchemesOptions {
  std::string template_source;
  std::vector<int> phantoms;
  std::vector<fs::path> masks, meshes, landmarks;
  fs::path template_landmarks, out;
  TargetOptions target;
  std::vector<std::string> schemes;
  std::uint64_t seed = 1;
  int most_pulls = 40;
  double stiffness = 0;
  bool cases = false;

  const std::vector<fs::path>& files() const { return masks.empty() ? meshes : masks; }
  std::size_t subjects() const { return phantoms.empty() ? files().size() : phantoms.size(); }
};

/// What all runs share.
struct Plan {
  std::shared_ptr<const Template> the_template;
  std::vector<std::string> names;  ///< of the subjects
  std::vector<ExperimentSubject> subjects;
  std::vector<WorkingScheme> schemes;
};

/// The template, its landmarks and stiffness as asked for. Where cases are written it lies beside them, since a changed
/// one is not what its file says.
Result<std::shared_ptr<const Template>> template_of_runs(const SchemesOptions& options) {
  auto the_template = load_template(options.template_source);
  if (!the_template) return the_template;
  MeshFile file = to_mesh_file(**the_template);
  if (!options.template_landmarks.empty()) {
    auto landmarks = read_landmarks(options.template_landmarks);
    if (!landmarks) return fail(landmarks.error());
    file.landmarks = std::move(*landmarks);
  }
  if (options.stiffness > 0) file.stiffness_base = options.stiffness;
  std::string source = options.template_source;
  if (options.cases) {
    source = (options.out / "template.ply").string();
    if (auto written = write_mesh_file(file, source); !written) return fail(written.error());
  }
  return make_template(std::move(file), std::move(source));
}

/// Every other landmark is shown, in every other case the others, so that the error is measured at all of them.
void share_landmarks(std::vector<Landmark> landmarks, std::size_t index, ExperimentSubject& subject) {
  for (std::size_t k = 0; k < landmarks.size(); ++k)
    ((k + index) % 2 == 0 ? subject.shown : subject.hidden).push_back(std::move(landmarks[k]));
}

Result<ExperimentSubject> read_subject(const SchemesOptions& options, const Template& the_template, std::size_t index,
                                       std::vector<std::string>& warnings, Progress& progress) {
  if (!options.phantoms.empty()) {
    const auto organ = built_in_organ(options.template_source);
    if (!organ) return fail(organ.error());
    return phantom_experiment_subject(*organ, options.phantoms[index]);
  }
  const fs::path& path = options.files()[index];
  Result<ExperimentSubject> subject = ExperimentSubject{};
  if (options.masks.empty()) {
    const auto mesh = read_mesh(path);
    if (!mesh) return fail(mesh.error());
    subject->target = mesh_boundary(*mesh).surface;
  } else {
    subject = mask_subject(path, options.target, the_template, warnings, progress);
  }
  if (!subject || options.landmarks.empty()) return subject;
  auto landmarks = read_landmarks(options.landmarks[index]);
  if (!landmarks) return fail(landmarks.error());
  share_landmarks(std::move(*landmarks), index, *subject);
  return subject;
}

std::vector<std::string> subject_names(const SchemesOptions& options) {
  std::vector<std::string> files;
  for (const int number : options.phantoms) files.push_back("phantom-" + std::to_string(number));
  for (const fs::path& path : options.phantoms.empty() ? options.files() : std::vector<fs::path>{})
    files.push_back(path.string());
  return shape_names(files);
}

/// Reads all subjects; one that cannot be read is left out with a warning.
Result<Plan> plan_of(const SchemesOptions& options, Report& report, Progress& progress) {
  Plan plan;
  auto the_template = template_of_runs(options);
  if (!the_template) return fail(the_template.error());
  plan.the_template = *the_template;
  const std::vector<std::string> names = subject_names(options);
  std::vector<ExperimentSubject> read(options.subjects());
  const auto results = run_cases(
      read.size(),
      [&](std::size_t i, Progress& own) -> Result<Report> {
        set_case_in_work(names[i]);
        Report said;
        auto subject = read_subject(options, *plan.the_template, i, said.warnings, own);
        if (!subject) return fail(subject.error());
        read[i] = std::move(*subject);
        return said;
      },
      progress);
  for (std::size_t i = 0; i < read.size(); ++i) {
    if (!results[i]) {
      report.warnings.push_back(results[i].error().sentence());
      continue;
    }
    report.warnings.insert(report.warnings.end(), results[i]->warnings.begin(), results[i]->warnings.end());
    read[i].name = names[i];
    plan.subjects.push_back(std::move(read[i]));
  }
  if (plan.subjects.empty()) return fail(results.front().error());
  const bool with_features = !plan.subjects.front().shown.empty();
  for (const std::string& name : options.schemes.empty() ? compared_schemes(with_features) : options.schemes) {
    auto scheme = working_scheme(name);
    if (!scheme) return fail(scheme.error());
    if (scheme->features != LandmarkUse::none && !with_features)
      return fail(name, "needs landmarks to show; give a file for each case by --landmarks");
    plan.schemes.push_back(std::move(*scheme));
  }
  return plan;
}

/// The measures of the model that shapes in correspondence make, a shape a column.
Json model_figures(ShapeMatrix shapes) {
  if (shapes.cols() < fewest_for_model) return Json::object();
  align(shapes, Alignment::similarity);
  const PrincipalComponents components = principal_components(std::move(shapes));
  const Eigen::Index modes = std::min(model_modes, components.shapes() - 2);
  const auto at = static_cast<std::size_t>(modes - 1);
  return {{"model_modes", modes},
          {"variance_mm2", components.variances().sum()},
          {"modes_95", modes_holding(components.variances(), 0.95)},
          {"compactness", compactness(components)[at].mean},
          {"generalization_rms", generalisation_rms(components)[at].mean},
          {"specificity_rms", specificity_rms(components, model_samples, model_seed)[at].mean}};
}

ShapeMatrix matrix_of(const std::vector<Points>& shapes) {
  ShapeMatrix matrix(shapes.front().size(), static_cast<Eigen::Index>(shapes.size()));
  for (std::size_t k = 0; k < shapes.size(); ++k)
    matrix.col(static_cast<Eigen::Index>(k)) = shapes[k].reshaped<Eigen::RowMajor>();
  return matrix;
}

/// Rows of the runs that were done, and a row for each scheme.
struct Tables {
  std::vector<Json> runs, schemes;
};

Tables tables_of(const Plan& plan, const std::vector<Result<Report>>& results, const std::vector<SchemeRun>& runs,
                 Report& report) {
  Tables tables;
  std::map<std::string, double> best_dice;
  for (std::size_t s = 0; s < plan.schemes.size(); ++s) {
    std::vector<Json> own;
    std::vector<Points> shapes;
    for (std::size_t i = 0; i < plan.subjects.size(); ++i) {
      const std::size_t job = s * plan.subjects.size() + i;
      const ExperimentSubject& subject = plan.subjects[i];
      if (!results[job]) {
        report.warnings.push_back(subject.name + ", " + plan.schemes[s].name + ": " + results[job].error().sentence());
        continue;
      }
      Json row{{"case", subject.name}, {"scheme", plan.schemes[s].name}};
      row.update(json_of(runs[job]));
      best_dice[subject.name] = std::max(best_dice[subject.name], runs[job].dice);
      shapes.push_back(runs[job].points);
      own.push_back(row);
      tables.runs.push_back(std::move(row));
    }
    Json row = summary_of_runs(plan.schemes[s].name, own);
    if (!shapes.empty()) row.update(model_figures(matrix_of(shapes)));
    tables.schemes.push_back(std::move(row));
  }
  for (const auto& [name, dice] : best_dice)
    if (dice < doubtful_dice)
      report.warnings.push_back(name + ": no way of working comes near the target; check that " +
                                plan.the_template->source +
                                " is the template of this organ and side, and that the label is the right one");
  if (plan.subjects.front().truth) {
    std::vector<Points> truth;
    for (const ExperimentSubject& subject : plan.subjects) truth.push_back(*subject.truth);
    Json row{{"scheme", "truth"}};
    row.update(model_figures(matrix_of(truth)));
    tables.schemes.push_back(std::move(row));
  }
  return tables;
}

Result<void> write_tables(const Tables& tables, const fs::path& folder, Json& paths) {
  for (const auto& [name, rows] : {std::pair("runs.csv", &tables.runs), std::pair("schemes.csv", &tables.schemes)}) {
    if (auto written = write_csv(*rows, folder / name); !written) return written;
    paths.push_back((folder / name).string());
  }
  const std::string chart = landmark_chart(tables.schemes);
  for (const auto& [name, text] :
       {std::pair("schemes.md", markdown_table(tables.schemes)), std::pair("landmarks.svg", chart)}) {
    if (text.empty()) continue;
    if (auto written = write_whole_file(folder / name, text); !written) return written;
    paths.push_back((folder / name).string());
  }
  return {};
}

Result<Report> study_schemes(const SchemesOptions& options, Progress& progress) {
  Report report;
  std::optional<Result<ResultFolder>> folder;
  if (!options.out.empty()) folder.emplace(ResultFolder::make(options.out));
  if (folder && !*folder) return fail(folder->error());
  const auto plan = plan_of(options, report, progress);
  if (!plan) return fail(plan.error());
  std::vector<SchemeRun> runs(plan->schemes.size() * plan->subjects.size());
  const auto results = run_cases(
      runs.size(),
      [&](std::size_t job, Progress& own) -> Result<Report> {
        const std::size_t i = job % plan->subjects.size();
        const ExperimentSubject& subject = plan->subjects[i];
        set_case_in_work(subject.name);
        const WorkingScheme& scheme = plan->schemes[job / plan->subjects.size()];
        EditSession session(new_document("", nullptr, plan->the_template));
        auto run = run_scheme(session, subject, scheme, {options.seed + i, options.most_pulls, &own});
        if (!run) return fail(run.error());
        if (options.cases) {
          const fs::path path = options.out / (subject.name + "." + scheme.name + case_extension);
          if (auto saved = save_case_as(session, path); !saved) return fail(saved.error());
        }
        runs[job] = std::move(*run);
        return Report{};
      },
      progress);
  if (progress.cancelled()) return fail("", "the study was cancelled");
  if (std::none_of(results.begin(), results.end(), [](const auto& result) { return result.has_value(); }))
    return fail(results.front().error());
  const Tables tables = tables_of(*plan, results, runs, report);
  Json paths = Json::array();
  if (!options.out.empty())
    if (auto written = write_tables(tables, options.out, paths); !written) return fail(written.error());
  report.values = {{"template", options.template_source},
                   {"default_scheme", default_scheme(!plan->subjects.front().shown.empty())},
                   {"schemes", tables.schemes},
                   {"runs", tables.runs},
                   {"paths", std::move(paths)}};
  return report;
}

void check_schemes(const SchemesOptions& options) {
  const int kinds = !options.phantoms.empty() + !options.masks.empty() + !options.meshes.empty();
  if (kinds != 1) throw CLI::RequiredError("exactly one of --phantoms, --mask and --mesh");
  if (!options.phantoms.empty() && !is_built_in(options.template_source))
    throw CLI::ValidationError("--phantoms", "is for the built-in templates");
  if (!options.landmarks.empty() && options.landmarks.size() != options.subjects())
    throw CLI::ValidationError("--landmarks", "needs one file for each case, in their order");
  if (options.cases && options.out.empty()) throw CLI::ValidationError("--cases", "needs a folder by -o");
}

}  // namespace

void add_study_schemes(CLI::App& study, CommandLine& asked) {
  auto options = std::make_shared<SchemesOptions>();
  CLI::App* verb = add_verb(study, lab_schemes.name, lab_schemes.description);
  verb->add_option("TEMPLATE", options->template_source, template_sources())->required();
  verb->add_option("--phantoms", options->phantoms, "Numbers of phantom subjects of the built-in template's organ")
      ->check(CLI::NonNegativeNumber)
      ->delimiter(',');
  verb->add_option("--mask", options->masks, "Label maps to adapt to");
  verb->add_option("--mesh", options->meshes, "Surfaces to adapt to");
  add_target_options(*verb, options->target);
  verb->add_option(
      "--landmarks", options->landmarks,
      "Landmark files of the cases, in their order. Half of the landmarks are shown; errors are measured at the rest");
  verb->add_option("--template-landmarks", options->template_landmarks, "A file with the template's landmarks");
  verb->add_option("--schemes", options->schemes, "Which to compare (default: all)")->delimiter(',');
  verb->add_option("--stiffness", options->stiffness, "Stiffness base (default: the template's)")
      ->check(CLI::PositiveNumber);
  verb->add_option("--pulls", options->most_pulls, "At most this many pulls a run")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  verb->add_option("--seed", options->seed,
                   "Seed of the first case's disturbance. Each further case takes the next number")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  verb->add_option("-o,--output", options->out, "Folder for runs.csv, schemes.csv, schemes.md and landmarks.svg");
  verb->add_flag("--cases", options->cases, "Write a case file of every run there too");
  verb->callback([options, &asked] {
    check_schemes(*options);
    asked.run = [options](Progress& progress) { return study_schemes(*options, progress); };
  });
}

}  // namespace homolog
