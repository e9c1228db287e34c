#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "app/lab/baselines.h"
#include "app/lab/experiment.h"
#include "app/lab/median.h"
#include "app/verbs/case_pool.h"
#include "app/verbs/template/subjects.h"
#include "core/adapt/fit.h"
#include "core/base/files/files.h"
#include "core/measure/compare.h"

// The verb `study experts`: fits and baselines against landmarks that experts set.

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct ExpertsJob {
  SubjectFiles subjects;
  int templates = 2;
  std::vector<std::string> shown;
  fs::path raters, out;
};

enum class ExpertMethod { fit, fit_shown, closest_points, point_drift };

/// What a method is called in the report, and in the names of the meshes.
struct MethodNames {
  const char *shown, *in_files;
};

MethodNames names_of(ExpertMethod method) {
  constexpr MethodNames names[] = {{"fit", "fit"},
                                   {"fit --landmarks", "shown"},
                                   {"similarity + closest points", "closest"},
                                   {"point drift", "drift"}};
  return names[static_cast<std::size_t>(method)];
}

/// One template fitted to one subject in one way.
struct ExpertRun {
  std::string of_template, subject;
  ExpertMethod method = ExpertMethod::fit;
  std::map<std::string, double> errors_mm;  ///< of the landmarks that were not shown
  double mean_mm = 0, assd_mm = 0, seconds = 0;
  fs::path mesh;
};

Result<std::shared_ptr<const Template>> expert_template(const BiasSubject& subject, int vertices,
                                                        std::vector<std::string>& warnings) {
  const auto own = own_template(subject.boundary, vertices);
  if (!own) return fail(subject.name, own.error().what);
  for (const std::string& warning : own->warnings) warnings.push_back(subject.name + ", as a template: " + warning);
  MeshFile file{own->mesh.points, own->mesh.topology->triangles()};
  file.landmarks = subject.landmarks;
  return make_template(std::move(file), subject.name);
}

Result<Points> fitted_points(const Template& the_template, const BiasSubject& subject, ExpertMethod method,
                             const ExpertsJob& options, Progress& progress) {
  if (method == ExpertMethod::closest_points) return closest_points_fit(the_template, subject.boundary);
  if (method == ExpertMethod::point_drift)
    return point_drift_fit(the_template, subject.boundary, {.progress = &progress});
  FitOptions fitting;
  fitting.progress = &progress;
  if (method == ExpertMethod::fit_shown)
    for (const Landmark& landmark : subject.landmarks)
      if (std::find(options.shown.begin(), options.shown.end(), landmark.name) != options.shown.end())
        fitting.landmarks[landmark.name] = landmark.position;
  auto fit = fit_to_boundary(the_template, subject.boundary, fitting);
  if (!fit) return fail(fit.error());
  return std::move(fit->mesh.points);
}

Result<Report> measure_run(const Template& the_template, const BiasSubject& subject, const ExpertsJob& options,
                           ExpertRun& run, Progress& progress) {
  const auto started = std::chrono::steady_clock::now();
  const auto points = fitted_points(the_template, subject, run.method, options, progress);
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  if (!points) return fail(subject.name, points.error().what);
  const auto carried = carried_landmarks(the_template, *points);
  for (const Landmark& truth : subject.landmarks) {
    if (std::find(options.shown.begin(), options.shown.end(), truth.name) != options.shown.end()) continue;
    for (const Landmark& one : carried)
      if (one.name == truth.name) run.errors_mm[truth.name] = (one.position - truth.position).norm();
  }
  run.mean_mm = mean_of(run.errors_mm, [](const auto& one) { return one.second; });
  run.assd_mm = mean_surface_distance_mm({the_template.topology, *points}, subject.boundary.surface);
  if (options.out.empty()) return Report{};
  run.mesh = options.out / (run.of_template + "-to-" + run.subject + "-" + names_of(run.method).in_files + ".ply");
  MeshFile file = to_mesh_file(the_template);
  file.points = *points;
  file.landmarks = carried;
  if (auto written = write_mesh_file(file, run.mesh); !written) return fail(written.error());
  return Report{};
}

/// Landmark → the raters' own mean distance: lines `name,mm`, under a title or without one. Errors: the file cannot be
/// read, another line has no number, a name stands twice, no line has one.
Result<std::map<std::string, double>> raters_of(const fs::path& path) {
  std::map<std::string, double> raters;
  if (path.empty()) return raters;
  const auto text = read_whole_file(path, 1 << 20);
  if (!text) return fail(text.error());
  std::istringstream in(*text);
  int at = 0;
  for (std::string line; std::getline(in, line);) {
    ++at;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const auto comma = line.rfind(',');
    const std::string number = comma == std::string::npos ? "" : line.substr(comma + 1);
    char* end = nullptr;
    const double mm = std::strtod(number.c_str(), &end);
    const bool whole = end != number.c_str() && std::string(end).find_first_not_of(" \t\r") == std::string::npos;
    if (at == 1 && end == number.c_str()) continue;  // a title
    if (!whole || !std::isfinite(mm) || mm < 0)
      return fail(path.string(), "has no NAME,MM in line " + std::to_string(at) + "; correct it");
    std::string name = line.substr(0, comma);
    if (name.size() > 1 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
    if (!raters.emplace(name, mm).second)
      return fail(path.string(), "names \"" + name + "\" twice; leave out one of the lines");
  }
  if (raters.empty()) return fail(path.string(), "has no line NAME,MM; write one for each landmark");
  return raters;
}

std::string mm_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", value);
  return text;
}

/// The runs of one template and method.
std::vector<const ExpertRun*> runs_of(const std::vector<ExpertRun>& runs, const std::string& of_template,
                                      ExpertMethod method) {
  std::vector<const ExpertRun*> found;
  for (const ExpertRun& run : runs)
    if (run.of_template == of_template && run.method == method && !run.errors_mm.empty()) found.push_back(&run);
  return found;
}

Json row_of_runs(const std::vector<const ExpertRun*>& runs) {
  std::vector<double> errors, means, assd, seconds;
  for (const ExpertRun* run : runs) {
    for (const auto& [name, error] : run->errors_mm) errors.push_back(error);
    means.push_back(run->mean_mm);
    assd.push_back(run->assd_mm);
    seconds.push_back(run->seconds);
  }
  return {{"template", runs.front()->of_template},
          {"method", names_of(runs.front()->method).shown},
          {"mean_mm", mean_of(errors)},
          {"median_mm", median_of(errors)},
          {"max_mm", *std::max_element(errors.begin(), errors.end())},
          {"worst_subject_mm", *std::max_element(means.begin(), means.end())},
          {"assd_mm", median_of(assd)},
          {"seconds", median_of(seconds)}};
}

std::string experts_table(const std::vector<Json>& rows, const std::vector<Json>& landmarks,
                          const std::vector<ExpertMethod>& methods) {
  std::string text =
      "| template | method | mean | median | max | worst subject | surface | s |\n|---|---|---|---|---|---|---|---|\n";
  for (const Json& row : rows) {
    text += "| " + row["template"].get<std::string>() + " | " + row["method"].get<std::string>();
    for (const char* key : {"mean_mm", "median_mm", "max_mm", "worst_subject_mm", "assd_mm", "seconds"})
      text += " | " + mm_text(row[key].get<double>());
    text += " |\n";
  }
  const bool rated = std::any_of(landmarks.begin(), landmarks.end(),
                                 [](const Json& landmark) { return !landmark["raters_mm"].is_null(); });
  text += rated ? "\n| landmark | raters |" : "\n| landmark |";
  std::string rule = rated ? "|---|---|" : "|---|";
  for (const ExpertMethod method : methods) {
    text += std::string(" ") + names_of(method).shown + " |";
    rule += "---|";
  }
  text += "\n" + rule + "\n";
  for (const Json& landmark : landmarks) {
    const auto cell = [](const Json& mm) { return " " + (mm.is_null() ? "–" : mm_text(mm.get<double>())) + " |"; };
    text += "| " + landmark["name"].get<std::string>() + " |";
    if (rated) text += cell(landmark["raters_mm"]);
    for (const ExpertMethod method : methods) text += cell(landmark["mm"][names_of(method).shown]);
    text += "\n";
  }
  return text;
}

std::vector<Json> landmark_rows(const std::vector<ExpertRun>& runs, const std::map<std::string, double>& raters,
                                const std::vector<ExpertMethod>& methods) {
  std::map<std::string, std::map<std::string, std::vector<double>>> errors;
  for (const ExpertRun& run : runs)
    for (const auto& [name, error] : run.errors_mm) errors[name][names_of(run.method).shown].push_back(error);
  std::vector<Json> rows;
  for (const auto& [name, by_method] : errors) {
    Json row{{"name", name}, {"raters_mm", raters.contains(name) ? Json(raters.at(name)) : Json()}};
    for (const ExpertMethod method : methods) {
      const auto found = by_method.find(names_of(method).shown);
      row["mm"][names_of(method).shown] = found == by_method.end() ? Json() : Json(mean_of(found->second));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

/// Errors: one subject alone, a name to show that nobody has.
Result<void> check_subjects(const ExpertsJob& options, const std::vector<BiasSubject>& subjects) {
  if (subjects.size() < 2) return fail(subjects.front().name, "is one subject alone; give at least two");
  for (const std::string& name : options.shown)
    if (std::none_of(subjects.begin(), subjects.end(), [&](const BiasSubject& subject) {
          return std::any_of(subject.landmarks.begin(), subject.landmarks.end(),
                             [&](const Landmark& landmark) { return landmark.name == name; });
        }))
      return fail(options.subjects.landmarks.string(),
                  "has no landmark \"" + name + "\" to show; name one as the files do");
  return {};
}

/// The fit that lies farthest off; null where none was measured.
Json described_worst(const std::vector<ExpertRun>& runs) {
  const ExpertRun* worst = nullptr;
  for (const ExpertRun& run : runs)
    if (run.method == ExpertMethod::fit && !run.errors_mm.empty() && (worst == nullptr || run.mean_mm > worst->mean_mm))
      worst = &run;
  if (worst == nullptr) return nullptr;
  return {{"template", worst->of_template},
          {"subject", worst->subject},
          {"mean_mm", worst->mean_mm},
          {"mesh", worst->mesh.string()}};
}

Result<Report> study_experts(const ExpertsJob& options, Progress& progress) {
  const auto raters = raters_of(options.raters);
  if (!raters) return fail(raters.error());
  std::optional<Result<ResultFolder>> folder;
  if (!options.out.empty()) folder.emplace(ResultFolder::make(options.out));
  if (folder && !*folder) return fail(folder->error());
  progress.part(0, 0.05);
  auto read = read_subjects(options.subjects, progress);
  if (!read) return fail(read.error());
  const auto& subjects = read->subjects;
  if (auto usable = check_subjects(options, subjects); !usable) return fail(usable.error());
  std::vector<ExpertMethod> methods{ExpertMethod::fit};
  if (!options.shown.empty()) methods.push_back(ExpertMethod::fit_shown);
  methods.insert(methods.end(), {ExpertMethod::closest_points, ExpertMethod::point_drift});

  std::vector<std::shared_ptr<const Template>> templates;
  std::vector<ExpertRun> runs;
  std::vector<std::pair<std::size_t, std::size_t>> of_run;  // template, subject
  const std::size_t count = std::min(static_cast<std::size_t>(options.templates), subjects.size());
  for (std::size_t t = 0; t < count; ++t) {
    const std::size_t own = t * subjects.size() / count;  // spread over the names
    auto the_template = expert_template(subjects[own], options.subjects.vertices, read->warnings);
    if (!the_template) return fail(the_template.error());
    for (const ExpertMethod method : methods)
      for (std::size_t k = 0; k < subjects.size(); ++k) {
        if (k == own) continue;
        runs.push_back({.of_template = subjects[own].name, .subject = subjects[k].name, .method = method});
        of_run.emplace_back(t, k);
      }
    templates.push_back(std::move(*the_template));
  }
  progress.part(0.05, 1);
  const auto results = run_cases(
      runs.size(),
      [&](std::size_t k, Progress& own) {
        return measure_run(*templates[of_run[k].first], subjects[of_run[k].second], options, runs[k], own);
      },
      progress);
  if (progress.cancelled()) return fail("", "the study was cancelled");
  Report report;
  report.warnings = std::move(read->warnings);
  for (const auto& result : results)
    if (!result) report.warnings.push_back(result.error().sentence());
  std::vector<Json> rows;
  for (const auto& the_template : templates)
    for (const ExpertMethod method : methods)
      if (const auto own = runs_of(runs, the_template->source, method); !own.empty()) rows.push_back(row_of_runs(own));
  if (rows.empty()) {
    for (const auto& result : results)
      if (!result) return fail(result.error());
    return fail(options.subjects.files.front().string(), "and the others share no landmarks to measure");
  }
  const auto landmarks = landmark_rows(runs, *raters, methods);
  std::set<std::string> known;
  for (const BiasSubject& subject : subjects)
    for (const Landmark& landmark : subject.landmarks) known.insert(landmark.name);
  for (const auto& [name, mm] : *raters)
    if (!known.contains(name))
      report.warnings.push_back(options.raters.string() + ": no subject has the landmark \"" + name +
                                "\"; check its name");
  const std::string table = experts_table(rows, landmarks, methods);
  report.values = {
      {"methods", rows}, {"landmarks", landmarks}, {"worst", described_worst(runs)}, {"flipped", read->flipped}};
  if (options.out.empty()) return report;
  if (auto written = write_whole_file(options.out / "experts.md", table); !written) return fail(written.error());
  report.values["table"] = (options.out / "experts.md").string();
  return report;
}

}  // namespace

void add_study_experts(CLI::App& study, CommandLine& asked) {
  auto options = std::make_shared<ExpertsJob>();
  options->subjects.vertices = 5000;
  CLI::App* verb = add_verb(study, lab_experts.name, lab_experts.description);
  verb->add_option("SHAPE", options->subjects.files, "Surfaces of at least two subjects, or a folder of them")
      ->required();
  verb->add_option("--landmarks", options->subjects.landmarks, "Folder with NAME.mrk.json, .fcsv or .json for each")
      ->required()
      ->check(CLI::ExistingDirectory);
  verb->add_option("--templates", options->templates, "How many of the subjects to make a template from, each in turn")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  verb->add_option("--vertices", options->subjects.vertices, "How many vertices the templates have")
      ->check(CLI::Range(100, 200000))
      ->capture_default_str();
  verb->add_option("--shown", options->shown,
                   "Names of landmarks that `fit --landmarks` is shown; no error counts there")
      ->delimiter(',');
  verb->add_option("--raters", options->raters, "Lines NAME,MM: how far raters lie from their consensus");
  verb->add_flag("--flip-mirrored", options->subjects.flip_mirrored,
                 "Flip subjects that are mirror images of most others");
  verb->add_option("-o,--output", options->out, "Folder for experts.md and the fitted meshes");
  verb->callback(
      [options, &asked] { asked.run = [options](Progress& progress) { return study_experts(*options, progress); }; });
}

}  // namespace homolog
