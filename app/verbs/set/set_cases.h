#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/verbs/verb.h"
#include "core/model/shapes/study.h"
#include "core/structures/fitting/fit_set.h"
#include "core/structures/variants.h"

namespace homolog {

// Things shared by the verbs that go through label maps with a template set.

/// A label map of a case, and which of its frames is meant.
struct SubjectMap {
  VolumeRead read;
  int frame = 0;
};

/// Errors: the reader's; no such frame. Warns where the first of several frames is taken.
Result<SubjectMap> read_subject(const std::filesystem::path& path, const std::optional<int>& frame, Progress& progress,
                                bool can_choose = true);

/// Errors: a map that holds no label, or none of the set's structures.
Result<void> check_structures(const SetInMap& subject, const TemplateSet& set, const std::filesystem::path& path);

/// Folders opened: one that has a file of a structure's name is one map of single masks, else it holds maps.
std::vector<std::filesystem::path> maps_of(const std::vector<std::filesystem::path>& paths, const TemplateSet& set);

/// A label map of a run.
struct NamedMap {
  std::filesystem::path path;
  std::string name;   ///< its case's name
  std::string alone;  ///< its case's name in a run with this map alone, which records are of
};

/// Names maps by their files: "seg". Where several have one name their folders stand before it: "p1-seg". Errors: a map
/// that is given twice, two whose folders have one name too.
Result<std::vector<NamedMap>> named_maps(const std::vector<std::filesystem::path>& paths);

/// Whether each name is that of the map's file, as it is wherever the files lie.
bool are_named_by_files(const std::vector<NamedMap>& maps);

/// Variants as a report has them: the labels without template, and those of the set that are absent, without a value.
Json json_of_variants(const std::vector<Variant>& variants, const TemplateSet& set);

/// Writes CASE.homolog into a folder that is there: the label map with all structures that were fitted to it, and gives
/// its entry in a study. One that somebody worked on stays as it is, with a warning. `record`: of how the
/// maps' files are made [record.h]. Errors: create_case's.
Result<StudyCase> write_case_of_set(const SetOfTemplates& set, const NamedMap& of, const SubjectMap& map,
                                    const SetInMap& subject, const FittedSet& fitted,
                                    const std::filesystem::path& folder, const std::string& record,
                                    std::vector<std::string>& warnings);

/// The study of a folder of fits: "fits/fits.study.json".
std::filesystem::path study_in(const std::filesystem::path& folder);

/// Does `work` on one case after the other: each uses all threads, and a large scan need not be in memory twice. The
/// report: `done`, `failed`, `cases`; a case that fails has an `error` and is a warning. Errors: the folder; all
/// fail; cancelled.
Result<Report> run_set_cases(const SetOfTemplates& set, const std::vector<NamedMap>& maps,
                             const std::filesystem::path& out, const char* done,
                             const std::function<Result<Report>(const NamedMap&, Progress&)>& work, Progress& progress);

}  // namespace homolog
