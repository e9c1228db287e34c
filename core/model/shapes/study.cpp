#include "core/model/shapes/study.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <type_traits>

#include "core/base/encoding/json.h"
#include "core/base/files/file_record.h"
#include "core/base/files/file_stem.h"
#include "core/base/files/files.h"
#include "core/base/files/paths.h"
#include "core/base/text/text.h"
#include "core/catalogue/catalogue.h"

namespace homolog {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr int version = 1;
constexpr std::size_t longest_case_name = 200;  // bytes: files are named by it

fs::path absolute_in(const fs::path& folder, const std::string& text) {
  if (!names_file(text)) return text;
  return (folder / text).lexically_normal();
}

fs::path folder_of(const fs::path& study) {
  return absolute_path(study).parent_path();
}

std::string no_text(const std::string& where, const char* key) {
  return where + " has a \"" + key + "\" that is no text; correct it in an editor";
}

/// Takes a text out of `json`. Errors: there, but no text.
Result<std::string> take_text(Json& json, const char* key, const std::string& where) {
  const auto found = json.find(key);
  if (found == json.end()) return std::string();
  if (!found->is_string()) return fail("", no_text(where, key));
  auto text = found->get<std::string>();
  json.erase(found);
  return text;
}

Result<CaseState> parsed_state(const std::string& text, const std::string& where) {
  if (text.empty()) return CaseState::to_do;
  for (std::size_t k = 0; k < case_state_names.size(); ++k)
    if (text == case_state_names[k]) return static_cast<CaseState>(k);
  return fail("",
              where + R"( has the state ")" + excerpt(text) + R"(", which is none of "to do", "in work" and "done")");
}

/// Visits the members of a case in the order in which they are written. So one list of them serves reading and writing.
/// A case always has the members that are `required`, and the others where they say something.
template <class Case, class Visitor>
void each_member(Case& one, Visitor& visit) {
  visit.required("name", one.name);
  visit.required("file", one.file);
  visit.required("state", one.state);
  visit.optional("structure", one.structure);
  visit.optional("frame", one.frame);
  visit.optional("flipped", one.flipped);
  visit.optional("imported", one.imported);
  visit.optional("from_scan", one.from_scan);
  visit.optional("labels", one.labels);
  visit.optional("doubt", one.doubt);
  visit.optional("seconds", one.seconds);
  visit.optional("gestures", one.gestures);
  visit.optional("group", one.group);
  visit.optional("notes", one.notes);
  visit.optional("label", one.label);
  visit.optional("covariates", one.covariates);
}

/// Looks for a member that is to be a text and is none.
struct CaseTexts {
  const Json& json;
  const char* wrong = nullptr;  ///< its key; null: there is none

  template <class Value>
  void required(const char* key, const Value&) {
    constexpr bool is_text =
        std::is_same_v<Value, std::string> || std::is_same_v<Value, fs::path> || std::is_same_v<Value, CaseState>;
    if (!is_text || wrong != nullptr) return;
    const auto found = json.find(key);
    if (found != json.end() && !found->is_string()) wrong = key;
  }
  template <class Value>
  void optional(const char* key, const Value& value) {
    required(key, value);
  }
};

/// Takes the members of a case out of its JSON, where they are there.
class CaseReader {
 public:
  CaseReader(Json& json, const fs::path& folder, const std::string& where)
      : json_(json), folder_(folder), where_(where) {}

  template <class Value>
  void required(const char* key, Value& value) {
    const auto found = json_.find(key);
    if (found != json_.end() && !fault_ && take(*found, key, value)) json_.erase(found);
  }
  template <class Value>
  void optional(const char* key, Value& value) {
    required(key, value);
  }

  /// The fault of the first member that cannot be read.
  const std::optional<Error>& fault() const { return fault_; }

 private:
  // Each tells whether it took the member; else that stays where it is.
  bool take(const Json& from, const char*, std::string& to) {
    to = from.get<std::string>();
    return true;
  }
  bool take(const Json& from, const char*, fs::path& to) {
    to = absolute_in(folder_, from.get<std::string>());
    return true;
  }
  bool take(const Json& from, const char*, CaseState& to) {
    const auto state = parsed_state(from.get<std::string>(), where_);
    if (!state) return refuse(state.error().what);
    to = *state;
    return true;
  }
  bool take(const Json& from, const char* key, std::optional<int>& to) {
    if (!from.is_number_unsigned() || from > 100000)
      return refuse(where_ + " has a \"" + key + "\" that is no frame number");
    to = from.get<int>();
    return true;
  }
  bool take(const Json& from, const char* key, bool& to) {
    if (!from.is_boolean()) return refuse(where_ + " has a \"" + key + "\" that is neither true nor false");
    to = from;
    return true;
  }
  bool take(const Json& from, const char*, double& to) {
    if (!from.is_number() || from < 0) return false;
    to = from.get<double>();
    return true;
  }
  bool take(const Json& from, const char*, std::int64_t& to) {
    if (!from.is_number_unsigned()) return false;
    to = from.get<std::int64_t>();
    return true;
  }
  /// An object where the member is one, else a number or a text.
  bool take(const Json& from, const char*, Json& to) {
    if (to.is_object() ? !from.is_object() || from.empty() : !from.is_number() && !from.is_string()) return false;
    to = from;
    return true;
  }
  bool refuse(const std::string& what) {
    fault_ = Error{"", what};
    return false;
  }

  Json& json_;
  const fs::path& folder_;
  const std::string& where_;
  std::optional<Error> fault_;
};

/// Writes the members of a case into its JSON.
class CaseWriter {
 public:
  CaseWriter(Json& json, const fs::path& folder) : json_(json), folder_(folder) {}

  template <class Value>
  void required(const char* key, const Value& value) {
    json_[key] = written(value);
  }
  template <class Value>
  void optional(const char* key, const Value& value) {
    if (says_something(value)) required(key, value);
  }

 private:
  static bool says_something(const std::string& text) { return !text.empty(); }
  static bool says_something(const fs::path& file) { return !file.empty(); }
  static bool says_something(const std::optional<int>& number) { return number.has_value(); }
  static bool says_something(bool flag) { return flag; }
  static bool says_something(double seconds) { return seconds > 0; }
  static bool says_something(std::int64_t count) { return count > 0; }
  static bool says_something(const Json& value) { return !value.empty(); }

  Json written(const std::string& text) const { return text; }
  Json written(const fs::path& file) const { return relative_source(folder_, file.string()); }
  Json written(CaseState state) const { return state_name(state); }
  Json written(const std::optional<int>& number) const { return *number; }
  Json written(bool flag) const { return flag; }
  Json written(double seconds) const { return std::round(10 * seconds) / 10; }
  Json written(std::int64_t count) const { return count; }
  Json written(const Json& value) const { return value; }

  Json& json_;
  const fs::path& folder_;
};

Result<StudyCase> parsed_case(Json json, std::size_t number, const fs::path& folder) {
  std::string where = "case " + std::to_string(number);
  if (!json.is_object()) return fail("", where + " is no object; correct it in an editor");
  StudyCase one;
  CaseTexts texts{json};
  each_member(one, texts);
  if (texts.wrong != nullptr) return fail("", no_text(where, texts.wrong));
  const auto file = json.value("file", std::string());
  if (file.empty()) return fail("", where + " has no \"file\"; name its case file or mesh");
  auto name = json.value("name", std::string());
  if (name.empty()) name = file_stem(file);
  where = "case \"" + excerpt(name) + "\"";
  if (name.size() > longest_case_name) return fail("", where + " has too long a name; shorten it");
  json["name"] = std::move(name);
  CaseReader reader(json, folder, where);
  each_member(one, reader);
  if (reader.fault()) return fail(*reader.fault());
  one.other = std::move(json);
  return one;
}

Result<Study> parsed_study(Json json, const fs::path& folder) {
  const auto stamp = json.is_object() ? json.find("homolog_study") : json.end();
  if (!json.is_object() || stamp == json.end() || !stamp->is_number_integer())
    return fail("", "is no study; a study starts with \"homolog_study\"");
  if (*stamp < 1)
    return fail(
        "", "says that it is of study version " + excerpt(stamp->dump()) + ", which there is none of; correct it to 1");
  if (*stamp > version)
    return fail(
        "", "was written by a newer version of this program (study version " + excerpt(stamp->dump()) + "); update it");
  json.erase(stamp);
  Study study;
  auto source = take_text(json, "template", "the study");
  if (!source) return fail(source.error());
  study.template_file = absolute_in(folder, *source);
  const Json cases = json.contains("cases") ? json["cases"] : Json::array();
  json.erase("cases");
  if (!cases.is_array()) return fail("", "has \"cases\" that are no list; correct it in an editor");
  std::set<std::string> names;
  for (const Json& entry : cases) {
    auto one = parsed_case(entry, study.cases.size() + 1, folder);
    if (!one) return fail(one.error());
    if (!names.insert(one->name).second)
      return fail("", "has two cases named \"" + excerpt(one->name) + "\"; rename one of them");
    study.cases.push_back(std::move(*one));
  }
  json.erase(std::string(record_key));  // the record is of the file as it was made: a study goes on
  study.other = std::move(json);
  return study;
}

std::vector<std::string> missing_files(const Study& study, const fs::path& path) {
  std::vector<std::string> warnings;
  std::error_code ignored;
  for (const StudyCase& one : study.cases)
    if (!fs::exists(one.file, ignored)) warnings.push_back(missing_case(one));
  if (!study.cases.empty() && warnings.size() == study.cases.size())
    warnings = {path.string() + ": none of its " + std::to_string(study.cases.size()) + " cases was found (first " +
                excerpt(study.cases.front().file.string()) + "); move the study together with its whole folder"};
  if (names_file(study.template_file.string()) && !fs::exists(study.template_file, ignored))
    warnings.push_back("template " + excerpt(study.template_file.string()) +
                       " does not exist; put it back, or choose another");
  return warnings;
}

Json case_json(const StudyCase& one, const fs::path& folder) {
  Json json = Json::object();
  CaseWriter writer(json, folder);
  each_member(one, writer);
  json.update(one.other);
  return json;
}

}  // namespace

bool is_study_file(const fs::path& file) {
  return file.string().ends_with(".study.json");
}

std::string missing_case(const StudyCase& one) {
  return "case \"" + excerpt(one.name) + "\": " + excerpt(one.file.string()) +
         " does not exist; put it back, or remove the case from the study";
}

std::vector<std::string> Study::groups() const {
  std::vector<std::string> names;
  for (const StudyCase& one : cases)
    if (!one.group.empty() && std::find(names.begin(), names.end(), one.group) == names.end())
      names.push_back(one.group);
  return names;
}

std::ptrdiff_t Study::next_case(std::ptrdiff_t from) const {
  const std::ptrdiff_t count = std::ssize(cases);
  std::ptrdiff_t next = -1;
  for (std::ptrdiff_t step = 1; step <= count; ++step) {
    const std::ptrdiff_t k = (from + step) % count;
    const StudyCase& one = cases[k];
    if (one.state == CaseState::done) continue;
    if (!one.doubt.empty() && k != from) return k;
    if (next < 0) next = k;
  }
  return next;
}

CasesByName::CasesByName(const Study& study) {
  for (const StudyCase& one : study.cases) cases_.emplace(one.name, &one);
}

const StudyCase* CasesByName::find(const std::string& name) const {
  const auto found = cases_.find(name);
  return found == cases_.end() ? nullptr : found->second;
}

Result<StudyRead> read_study(const fs::path& path) {
  const auto bytes = read_whole_file(path, std::uintmax_t{1} << 25);
  if (!bytes) return fail(bytes.error());
  auto json = read_json<Json>(*bytes);
  if (!json) return fail(path.string(), json.error().what + "; take its last good copy");
  auto study = parsed_study(std::move(*json), folder_of(path));
  if (!study) return fail(path.string(), study.error().what);
  StudyRead read;
  read.warnings = missing_files(*study, path);
  read.study = std::move(*study);
  return read;
}

namespace {

/// Errors: a file whose name a study cannot hold.
Result<void> check_names(const Study& study, const fs::path& path) {
  std::vector<fs::path> files{study.template_file};
  for (const StudyCase& one : study.cases) files.insert(files.end(), {one.file, one.imported, one.labels, one.name});
  for (const fs::path& file : files)
    if (!file.empty() && !is_utf8(relative_source(folder_of(path), file.string())))
      return fail(path.string(), "was not written: the name of " + file.string() +
                                     " is no UTF-8, so a study cannot hold it; rename that file or folder");
  return {};
}

}  // namespace

Result<void> write_study(const Study& study, const fs::path& path, const std::string& record) {
  const fs::path folder = folder_of(path);
  if (auto nameable = check_names(study, path); !nameable) return nameable;
  Json json{{"homolog_study", version}};
  if (!study.template_file.empty()) json["template"] = relative_source(folder, study.template_file.string());
  json.update(study.other);
  json["cases"] = Json::array();
  for (const StudyCase& one : study.cases) json["cases"].push_back(case_json(one, folder));
  const auto text = with_record(path, json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n', record);
  if (!text) return fail(text.error());
  std::error_code ignored;
  if (fs::file_size(path, ignored) >= text->size())
    if (const auto there = read_whole_file(path); there)
      if (*there == *text || without_record(path, *there) == *text) return {};
  return write_whole_file(path, *text);
}

}  // namespace homolog
