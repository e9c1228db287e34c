#include "app/verbs/fit/fit_many.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <utility>

#include "app/verbs/case_landmarks.h"
#include "app/verbs/case_pool.h"
#include "app/verbs/input_folders.h"
#include "app/verbs/read_image.h"
#include "app/verbs/set/set_cases.h"
#include "app/verbs/study/study_make.h"
#include "app/verbs/study/study_templates.h"
#include "core/base/files/files.h"
#include "core/groupwise/cohort_doubt.h"
#include "core/groupwise/same_place.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// The mesh to write for each case. Errors: two cases of one name.
Result<std::vector<fs::path>> outputs_of(const FitJob& options) {
  std::map<std::string, fs::path> taken;
  std::vector<fs::path> outputs;
  for (const fs::path& path : options.cases()) {
    const auto [other, is_new] = taken.emplace(case_name_of(path), path);
    if (!is_new)
      return fail(path.string(), "would be written to the same file as " + other->second.string() + "; rename one");
    outputs.push_back(options.out / (other->first + ".ply"));
  }
  return outputs;
}

/// Says in the report that several cases are off at one place of the template.
void report_place(const SamePlace& place, std::size_t fits, const std::string& source, const Template& the_template,
                  Report& report) {
  const Vec3 at = the_template.points(place.vertices, Eigen::all).colwise().mean().transpose();
  const double share = static_cast<double>(place.vertices.size()) / static_cast<double>(the_template.points.rows());
  report.values["same_place"] = {{"cases", place.fits}, {"vertices_share", share}, {"at", {at.x(), at.y(), at.z()}}};
  char text[320];
  std::snprintf(text, sizeof text,
                ": %zu of %zu cases lie off their organs at the same place of the template (around %.0f, %.0f, %.0f "
                "mm), where it has another form; make it of several subjects by template --consensus, or of another "
                "subject",
                place.fits, fits, at.x(), at.y(), at.z());
  report.warnings.push_back(source + text);
}

/// Fits of several cases, in their order.
struct ManyFits {
  std::vector<fs::path> outputs;
  std::vector<Result<Report>> results;
  std::vector<std::optional<FittedTarget>> kept;  ///< for fits by way of others
  std::vector<StudyCase> cases;                   ///< without a name: it could not be fitted
  std::vector<VertexScalars> off_shares;          ///< how far each vertex lies off its target, by the size
  Json rows = Json::array();                      ///< of the report
};

/// Errors: an output is a file that is read, or its folder cannot be made.
Result<ManyFits> begin_fits(const FitJob& options) {
  auto outputs = outputs_of(options);
  if (!outputs) return fail(outputs.error());
  std::vector<fs::path> read = options.cases();
  read.insert(read.end(), {fs::path(options.template_source), options.model});
  if (auto safe = check_not_read(*outputs, read); !safe) return fail(safe.error());
  ManyFits fits;
  fits.outputs = std::move(*outputs);
  fits.kept.resize(options.cases().size());
  fits.cases.resize(options.cases().size());
  fits.off_shares.resize(options.cases().size());
  return fits;
}

void fit_each(const FitJob& options, const FitShared& shared, ManyFits& fits, Progress& progress) {
  const auto& paths = options.cases();
  fits.results = run_cases(
      paths.size(),
      [&](std::size_t i, Progress& own) {
        set_case_in_work(case_name_of(paths[i]));
        AmongCases among;
        among.off_share = &fits.off_shares[i];
        if (options.ways_by_others() > 0)
          among.keep = &fits.kept[i];
        else
          among.of_study = &fits.cases[i];
        return fit_case(options, shared, paths[i], fits.outputs[i], own, among);
      },
      progress);
}

/// Fits each case once more, by way of others that were fitted; a first fit stays where that fails.
void fit_again_by_others(const FitJob& options, const FitShared& shared, ManyFits& fits, Progress& progress) {
  const auto& paths = options.cases();
  const std::size_t by_others = options.ways_by_others();
  std::vector<const FitResult*> first;
  for (const auto& one : fits.kept) first.push_back(one ? &one->fit : nullptr);
  const auto third = third_subjects(first, by_others + 1);
  auto again = run_cases(
      paths.size(),
      [&](std::size_t i, Progress& own) -> Result<Report> {
        if (first[i] == nullptr) return fail("", "was not fitted");
        set_case_in_work(case_name_of(paths[i]));
        AmongCases among{nullptr, &*fits.kept[i], {}, nullptr, &fits.cases[i]};
        for (const std::size_t k : third)
          if (k != i && among.others.size() < by_others) among.others.push_back(&first[k]->mesh.points);
        return fit_case(options, shared, paths[i], fits.outputs[i], own, among);
      },
      progress);
  for (std::size_t i = 0; i < again.size(); ++i)
    if (again[i]) fits.results[i] = std::move(again[i]);
}

/// How many were fitted; makes a row for each. Errors: none was.
Result<Report> report_of_fits(const FitJob& options, ManyFits& fits) {
  Report report;
  report.warnings = landmarks_of_no_case(options.landmark_files(), options.cases());
  std::size_t failed = 0, doubtful = 0;
  for (std::size_t i = 0; i < fits.results.size(); ++i) {
    const Result<Report>& result = fits.results[i];
    Json line{{"case", options.cases()[i].string()}};
    if (result) {
      line["doubtful"] = result->values["doubtful"];  // in front, where a wide table shows it
      line["mesh"] = fits.outputs[i].string();
      line.update(result->values);
      report.warnings.insert(report.warnings.end(), result->warnings.begin(), result->warnings.end());
      if (result->values["doubtful"] == true) ++doubtful;
    } else {
      ++failed;
      line["error"] = result.error().sentence();
      report.warnings.push_back(result.error().sentence());
    }
    fits.rows.push_back(std::move(line));
  }
  if (failed == 1 && fits.results.size() == 1) return fail(fits.results.front().error());
  if (failed == fits.results.size())
    return fail(options.out.string(), "none of the " + std::to_string(failed) + " cases could be fitted; the first: " +
                                          fits.results.front().error().sentence());
  report.values = {{"fitted", fits.results.size() - failed}, {"failed", failed}, {"doubtful", doubtful}};
  return report;
}

/// Writes the study of the cases, where there are any, and says where.
Result<void> write_study_of_fits(const FitJob& options, std::vector<StudyCase> cases, Report& report,
                                 Progress& progress) {
  std::erase_if(cases, [](const StudyCase& one) { return one.name.empty(); });
  if (cases.empty()) return {};
  const fs::path study = study_in(options.out);
  const auto record = record_of(options.command, progress);
  if (!record) return fail(record.error());
  if (auto written = write_cases_into(study, options.template_source, std::move(cases),
                                      record_of_made(*record, options.out, study));
      !written)
    return fail(written.error());
  report.values["study"] = study.string();
  return {};
}

}  // namespace

Result<Report> fit_many(FitJob options, const FitShared& shared, Progress& progress) {
  if (options.of_folder && !options.to_meshes()) {
    options.masks = label_maps_among(options.masks);
    if (options.masks.empty())
      return fail("", "the folder holds images, and no label map; name a folder of label maps by --mask");
  }
  std::error_code ignored;
  for (const fs::path& path : options.cases())
    if (fs::is_directory(path, ignored) && fs::is_empty(path, ignored))
      return fail(path.string(), "is an empty folder; name one that holds label maps or surfaces");
  // What else lies in a folder is no input. By way of others, a case alone stays one of a folder.
  if (options.of_folder && (options.cases().size() > 1 || options.ways_by_others() == 0))
    options.command = options.command.with(options.to_meshes() ? "--mesh" : "--mask", options.cases());
  auto fits = begin_fits(options);
  if (!fits) return fail(fits.error());
  const auto suits = check_template_of_study(study_in(options.out), {shared.template_of_file}, options.template_source,
                                             "give that template, or another folder");
  if (!suits) return fail(suits.error());
  const auto folder = ResultFolder::make(options.out);
  if (!folder) return fail(folder.error());
  const double first_share = 1 / (1 + static_cast<double>(options.ways_by_others()));
  progress.part(0, first_share);
  fit_each(options, shared, *fits, progress);
  if (options.ways_by_others() > 0 && !progress.cancelled()) {
    progress.part(first_share, 1);
    fit_again_by_others(options, shared, *fits, progress);
  }
  if (progress.cancelled()) return fail("", "the fit was cancelled; the meshes finished so far are kept");
  auto report = report_of_fits(options, *fits);
  if (!report) return report;
  std::erase_if(fits->off_shares, [](const VertexScalars& one) { return one.size() == 0; });
  if (const auto same = off_at_same_place(*shared.the_template->topology, fits->off_shares))
    report_place(*same, fits->off_shares.size(), options.template_source, *shared.the_template, *report);
  if (auto written = write_study_of_fits(options, std::move(fits->cases), *report, progress); !written)
    return fail(written.error());
  report->values["cases"] = std::move(fits->rows);
  return report;
}

}  // namespace homolog
