#include "app/verbs/set/set_cases.h"

#include <algorithm>
#include <map>
#include <set>

#include "app/verbs/case_landmarks.h"
#include "app/verbs/case_of_fit.h"
#include "app/verbs/case_pool.h"
#include "app/verbs/input_folders.h"
#include "app/verbs/record.h"
#include "core/base/files/file_stem.h"
#include "core/base/files/files.h"
#include "core/base/files/paths.h"
#include "core/base/text/listed.h"
#include "core/model/shapes/shape_folder.h"
#include "core/session/case_file.h"
#include "core/session/case_keeping.h"
#include "core/structures/fitting/set_in_case.h"
#include "core/structures/naming/level_names.h"
#include "core/volume/labels/read_labels.h"
#include "core/volume/volume_io.h"

namespace homolog {

namespace fs = std::filesystem;

Result<SubjectMap> read_subject(const fs::path& path, const std::optional<int>& frame, Progress& progress,
                                bool can_choose) {
  VolumeReadOptions reading;
  reading.progress = &progress;
  reading.all_layers = true;
  auto read = read_labels(path, reading);
  if (!read) return fail(read.error());
  const int frames = read->volume.frames;
  if (frame && *frame >= frames)
    return fail(path.string(),
                "has no frame " + std::to_string(*frame) + "; its last one is " + std::to_string(frames - 1));
  if (!frame && frames > 1)
    read->warnings.push_back(path.string() + ": has " + std::to_string(frames) +
                             " frames, of which the first is taken" +
                             (can_choose ? "; choose another by --frame" : ""));
  return SubjectMap{std::move(*read), frame.value_or(0)};
}

Result<void> check_structures(const SetInMap& subject, const TemplateSet& set, const fs::path& path) {
  const auto is_known = [](const StructureInMap& one) { return one.is_there() || !one.why_left_out.empty(); };
  if (std::ranges::any_of(subject.structures, is_known)) return {};
  if (subject.without_template.empty())
    return fail(path.string(), "holds no label; give a label map in which there is one");
  return fail(path.string(), "holds no structure of the set; its labels: " + some_of(subject.without_template) +
                                 "; those of the set: " + names_in_set(set) +
                                 "; give the map these names, or the set other values");
}

Json json_of_variants(const std::vector<Variant>& variants, const TemplateSet& set) {
  Json rows = Json::array();
  for (const Variant& variant : variants) {
    for (const Segment& segment : variant.more) rows.push_back({{"name", segment.name}, {"value", segment.value}});
    for (const std::size_t k : variant.absent) rows.push_back({{"name", set.structures[k].name}, {"value", nullptr}});
  }
  return rows;
}

namespace {

/// Whether a folder is one map of single masks: a file is called as a structure of the set. "T1" alone may be a point
/// in time, so where files are called by levels alone, one of them has to be a mask.
bool is_folder_of_masks(const TemplateSet& set, const std::vector<fs::path>& files) {
  const auto is_structure = [&](const fs::path& file) { return set.find(file_stem(file)) != nullptr; };
  const auto is_level = [&](const fs::path& file) {
    return std::ranges::any_of(set.structures,
                               [&](const TemplateOfSet& one) { return is_same_vertebra(file_stem(file), one.name); });
  };
  if (std::ranges::any_of(files, is_structure)) return true;
  const auto first = std::ranges::find_if(files, is_level);
  if (first == files.end()) return false;
  const auto read = read_volume(*first);
  return read && read->volume.frames == 1 && read->other_layers.empty() && labels_of(read->volume).size() < 2;
}

}  // namespace

std::vector<fs::path> maps_of(const std::vector<fs::path>& paths, const TemplateSet& set) {
  std::vector<fs::path> maps;
  for (const fs::path& path : paths) {
    std::error_code error;
    const auto files = fs::is_directory(path, error) ? volumes_in(path) : std::vector<fs::path>();
    if (files.empty() || is_folder_of_masks(set, files))
      maps.push_back(path);
    else
      maps.insert(maps.end(), files.begin(), files.end());
  }
  return maps;
}

Result<std::vector<NamedMap>> named_maps(const std::vector<fs::path>& paths) {
  std::vector<NamedMap> maps;
  std::vector<fs::path> above;  // the folder that a name could get before it
  std::set<fs::path> met;
  for (const fs::path& path : paths) {
    const fs::path whole = absolute_path(path / "x").parent_path();
    if (!met.insert(whole).second)
      return fail(path.string(), "is given twice, and both would be written to one place; name each map once");
    maps.push_back({path, case_name_of(whole), case_name_of(whole)});
    above.push_back(whole.parent_path());
  }
  while (true) {
    std::map<std::string, std::vector<std::size_t>> called;
    for (std::size_t k = 0; k < maps.size(); ++k) called[maps[k].name].push_back(k);
    bool all_differ = true;
    for (const auto& [name, alike] : called) {
      if (alike.size() < 2) continue;
      all_differ = false;
      for (const std::size_t k : alike) {
        if (!above[k].has_filename())
          return fail(maps[k].path.string(),
                      "has the name of another case, so that both would be written to one place; rename one");
        maps[k].name = above[k].filename().string() + "-" + maps[k].name;
        above[k] = above[k].parent_path();
      }
    }
    if (all_differ) return maps;
  }
}

bool are_named_by_files(const std::vector<NamedMap>& maps) {
  return std::ranges::all_of(maps, [](const NamedMap& map) { return map.name == map.alone; });
}

namespace {

/// Why somebody has to look at the fits of a subject, as a sentence; empty where nobody has to.
std::string doubt_of(const SetOfTemplates& set, const FittedSet& fitted) {
  std::vector<std::string> doubtful;
  for (std::size_t k = 0; k < fitted.structures.size(); ++k)
    if (fitted.structures[k].fit && fitted.structures[k].judgement.doubtful)
      doubtful.push_back(set.set.structures[k].name);
  if (doubtful.empty()) return {};
  return "Look at " + some_of(doubtful) + ": " + (doubtful.size() == 1 ? "its fit is" : "their fits are") +
         " doubtful.";
}

/// A new case of the map with what was fitted. `first`: of the set, the structure that the case begins with.
Result<EditSession> case_of_set(const SetOfTemplates& set, std::size_t first, const fs::path& image,
                                const SubjectMap& map, const fs::path& file, const std::string& record) {
  const std::shared_ptr<const Volume> grid = grid_of(map.read.volume);
  Document document = new_document(absolute_path(image).string(), grid, set.templates[first]);
  document.hold_landmarks();
  auto session = create_case(std::move(document), file, {}, record);
  if (session && map.frame > 0)
    if (auto shown = session->apply(SetFrame{map.frame}); !shown) return fail(shown.error());
  return session;
}

}  // namespace

Result<StudyCase> write_case_of_set(const SetOfTemplates& set, const NamedMap& of, const SubjectMap& map,
                                    const SetInMap& subject, const FittedSet& fitted, const fs::path& folder,
                                    const std::string& record, std::vector<std::string>& warnings) {
  StudyCase one;
  const fs::path& path = of.path;
  one.name = of.name;
  one.file = absolute_path(folder / (one.name + case_extension));
  one.from_scan = true;
  one.state = CaseState::in_work;
  one.labels = absolute_path(path);
  one.doubt = doubt_of(set, fitted);
  std::error_code ignored;
  if (fs::exists(one.file, ignored) && was_worked_on(one.file)) {
    warnings.push_back(one.file.string() + ": was worked on, so it stays as it is; move it away to begin anew");
    return one;
  }
  if (map.read.volume.frames > 1) one.frame = map.frame;
  const auto first = std::ranges::find_if(fitted.structures,
                                          [](const FittedStructure& structure) { return structure.fit.has_value(); });
  if (first == fitted.structures.end()) return fail(path.string(), "has no structure that could be fitted");
  auto session = case_of_set(set, static_cast<std::size_t>(first - fitted.structures.begin()), path, map, one.file,
                             record_of_output(record, of.alone + case_extension));
  if (!session) return fail(session.error());
  std::vector<EditStep> steps = steps_of_fitted_set(session->document(), set, subject, fitted);
  const auto fit =
      std::make_shared<const KeptMapFit>(map_fit_of(set.set, subject, fitted, steps, session->document().frame));
  for (EditStep& step : steps)
    if (auto done = session->apply(std::move(step)); !done) return fail(path.string(), done.error().what);
  // The case says itself that nobody worked on it since [goes_on_after_fit].
  if (auto noted = session->apply(Note{"fit", {}, {}, {}, {}, fit}); !noted) return fail(noted.error());
  if (auto named = name_labels(*session, one.labels); !named) return fail(named.error());
  return one;
}

fs::path study_in(const fs::path& folder) {
  const fs::path whole = absolute_path(folder / "x").parent_path();
  return folder / (whole.filename().string() + ".study.json");
}

Result<Report> run_set_cases(const SetOfTemplates& set, const std::vector<NamedMap>& maps, const fs::path& out,
                             const char* done, const std::function<Result<Report>(const NamedMap&, Progress&)>& work,
                             Progress& progress) {
  const auto folder = ResultFolder::make(out);
  if (!folder) return fail(folder.error());
  Report report;
  report.warnings = set.warnings;
  Json cases = Json::array();
  std::vector<std::string> failed;
  for (const NamedMap& map : maps) {
    set_case_in_work(map.name);
    Progress own(progress, 1 / static_cast<double>(maps.size()));
    auto one = work(map, own);
    own.part(0, 1);
    own.report(1);
    if (progress.cancelled())
      return fail("", cases.empty() ? "the run was cancelled before a case was finished"
                                    : "the run was cancelled; the cases finished so far are kept");
    if (!one) {
      failed.push_back(one.error().sentence());
      report.warnings.push_back(failed.back());
      cases.push_back({{"name", map.name}, {"case", map.path.string()}, {"error", failed.back()}});
      continue;
    }
    report.warnings.insert(report.warnings.end(), one->warnings.begin(), one->warnings.end());
    cases.push_back(std::move(one->values));
  }
  if (failed.size() == maps.size()) return fail(out.string(), "no case came to an end; the first: " + failed.front());
  report.values = {{done, maps.size() - failed.size()}, {"failed", failed.size()}, {"cases", std::move(cases)}};
  return report;
}

}  // namespace homolog
