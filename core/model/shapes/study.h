#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/base/result.h"

namespace homolog {

enum class CaseState { to_do, in_work, done };
inline constexpr std::array case_state_names{"to do", "in work", "done"};

/// One shape of a study: a structure of a case file (a cine: in one of its frames), or a mesh made elsewhere.
struct StudyCase {
  std::string name;
  std::filesystem::path file;  ///< .homolog or a mesh; absolute in memory, relative to the study's folder on disk
  std::optional<int> frame;    ///< the frame of a cine's case file; the one it shows where absent
  std::string group;           ///< e.g. "healthy"; empty: none
  CaseState state = CaseState::to_do;
  std::string notes;
  bool flipped = false;            ///< taken left for right
  std::filesystem::path imported;  ///< the mesh that the case file was made from, to repair it; empty: none
  bool from_scan = false;          ///< the case was made for a scan of a worklist, and has no shape while it is to do
  std::filesystem::path labels;    ///< the label map of that scan that the template is fitted to; empty: none
  std::string doubt;               ///< why a person has to look at what the fit gave, as a sentence; empty: no doubt
  double seconds = 0;              ///< that a person worked on it
  std::int64_t gestures = 0;       ///< that a person did on it
  std::string structure;           ///< of a case file, by its id; empty: the first
  nlohmann::ordered_json label;    ///< of `labels`: its number or its name; null: none is said
  nlohmann::ordered_json covariates = nlohmann::ordered_json::object();  ///< by column: numbers and texts; empty: none
  nlohmann::ordered_json other = nlohmann::ordered_json::object();       ///< fields that are not known here, kept

  /// Whether it has no shape of its own yet: the template lies somewhere in its scan.
  bool waits() const { return from_scan && state == CaseState::to_do; }
  bool operator==(const StudyCase&) const = default;
};

/// The project file of a study, `*.study.json`: readable JSON, its paths relative to its own folder, so that the
/// folder can be moved as a whole.
struct Study {
  std::filesystem::path template_file;  ///< or a built-in template's name; empty: none
  std::vector<StudyCase> cases;
  nlohmann::ordered_json other = nlohmann::ordered_json::object();

  /// Names of the groups in the order of their first cases.
  std::vector<std::string> groups() const;
  /// The next case that is not done: after `from`, then on from the start. Cases in doubt come before the rest, except
  /// `from` itself. −1 where all are done.
  std::ptrdiff_t next_case(std::ptrdiff_t from = -1) const;
  bool operator==(const Study&) const = default;
};

/// The cases of a study by name, where many are looked up. The study must outlive it, and keep its cases.
class CasesByName {
 public:
  explicit CasesByName(const Study& study);
  /// Null where there is none of that name.
  const StudyCase* find(const std::string& name) const;

 private:
  std::unordered_map<std::string_view, const StudyCase*> cases_;
};

struct StudyRead {
  Study study;
  std::vector<std::string> warnings;  ///< a sentence for each file that is not where the study says
};

/// Errors: absent, not JSON, not a study, a newer version, a case without a name or file, two cases of one name. Files
/// that are missing are warnings; where all are, one sentence says that the folder was moved without them.
Result<StudyRead> read_study(const std::filesystem::path& path);

/// Whole or not at all, and only where the file does not hold the same already. Fields that were read and are not known
/// here are written again. `record`: of how the file is made [file_record.h]. A record that it has is not written
/// again, for a study that was changed.
Result<void> write_study(const Study& study, const std::filesystem::path& path, const std::string& record = {});

/// Whether a file is called as studies are.
bool is_study_file(const std::filesystem::path& file);

/// The sentence for a case whose file is not there.
std::string missing_case(const StudyCase& one);

inline const char* state_name(CaseState state) {
  return case_state_names[static_cast<std::size_t>(state)];
}

}  // namespace homolog
