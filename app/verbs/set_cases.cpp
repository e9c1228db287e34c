#include "app/verbs/set_cases.h"

#include <algorithm>
#include <set>

#include "app/verbs/case_landmarks.h"
#include "app/verbs/case_pool.h"
#include "app/verbs/input_folders.h"
#include "core/base/file_stem.h"
#include "core/base/files.h"
#include "core/volume/read_labels.h"

namespace homolog {

namespace fs = std::filesystem;

Result<SubjectMap> read_subject(const fs::path& path, const std::optional<int>& frame, Progress& progress) {
  VolumeReadOptions reading;
  reading.progress = &progress;
  auto read = read_labels(path, reading);
  if (!read) return fail(read.error());
  const int frames = read->volume.frames;
  if (frame && *frame >= frames)
    return fail(path.string(),
                "has no frame " + std::to_string(*frame) + "; its last one is " + std::to_string(frames - 1));
  if (!frame && frames > 1)
    read->warnings.push_back(path.string() + ": has " + std::to_string(frames) +
                             " frames, of which the first is taken; choose another by --frame");
  return SubjectMap{std::move(*read), frame.value_or(0)};
}

std::vector<fs::path> maps_of(const std::vector<fs::path>& paths, const TemplateSet& set) {
  std::vector<fs::path> maps;
  for (const fs::path& path : paths) {
    std::error_code error;
    const auto files = fs::is_directory(path, error) ? volumes_in(path) : std::vector<fs::path>();
    const bool is_one =
        std::ranges::any_of(files, [&](const fs::path& file) { return set.find(file_stem(file)) != nullptr; });
    if (files.empty() || is_one)
      maps.push_back(path);
    else
      maps.insert(maps.end(), files.begin(), files.end());
  }
  return maps;
}

std::string some_of(const std::vector<std::string>& names) {
  constexpr std::size_t most = 6;
  std::string text;
  for (std::size_t k = 0; k < std::min(most, names.size()); ++k) text += (k > 0 ? ", " : "") + names[k];
  return names.size() > most ? text + " and " + std::to_string(names.size() - most) + " more" : text;
}

Result<Report> run_set_cases(const SetOfTemplates& set, const std::vector<fs::path>& paths, const fs::path& out,
                             const char* done, const std::function<Result<Report>(const fs::path&, Progress&)>& work,
                             Progress& progress) {
  std::set<std::string> names;
  for (const fs::path& path : paths)
    if (!names.insert(case_name_of(path)).second)
      return fail(path.string(),
                  "has the name of another case, so that both would be written to one place; rename one");
  const auto folder = ResultFolder::make(out);
  if (!folder) return fail(folder.error());
  Report report;
  report.warnings = set.warnings;
  Json cases = Json::array();
  std::vector<std::string> failed;
  for (const fs::path& path : paths) {
    const std::string name = case_name_of(path);
    set_case_in_work(name);
    Progress own(progress, 1 / static_cast<double>(paths.size()));
    auto one = work(path, own);
    own.part(0, 1);
    own.report(1);
    if (progress.cancelled()) return fail("", "the run was cancelled; the cases finished so far are kept");
    if (!one) {
      failed.push_back(one.error().sentence());
      report.warnings.push_back(failed.back());
      cases.push_back({{"name", name}, {"case", path.string()}, {"error", failed.back()}});
      continue;
    }
    report.warnings.insert(report.warnings.end(), one->warnings.begin(), one->warnings.end());
    cases.push_back(std::move(one->values));
  }
  if (failed.size() == paths.size()) return fail(out.string(), "no case came to an end; the first: " + failed.front());
  report.values = {{done, paths.size() - failed.size()}, {"failed", failed.size()}, {"cases", std::move(cases)}};
  return report;
}

}  // namespace homolog
