#include "core/model/study.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/base/file_record.h"
#include "core/base/file_stem.h"
#include "core/base/files.h"
#include "core/base/json.h"
#include "core/base/paths.h"
#include "core/base/text.h"
#include "core/catalogue/catalogue.h"

namespace homolog {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr int version = 1;
constexpr std::size_t longest_case_name = 200;  // bytes: files are named by it
constexpr std::array<const char*, 3> state_names{"to do", "in work", "done"};

fs::path absolute_in(const fs::path& folder, const std::string& text) {
  if (!names_file(text)) return text;
  return (folder / text).lexically_normal();
}

fs::path folder_of(const fs::path& study) {
  return absolute_path(study).parent_path();
}

/// Takes a text out of `json`. Errors: there, but no text.
Result<std::string> take_text(Json& json, const char* key, const std::string& where) {
  const auto found = json.find(key);
  if (found == json.end()) return std::string();
  if (!found->is_string()) return fail("", where + " has a \"" + key + "\" that is no text; correct it in an editor");
  auto text = found->get<std::string>();
  json.erase(found);
  return text;
}

Result<CaseState> parsed_state(const std::string& text, const std::string& where) {
  if (text.empty()) return CaseState::to_do;
  for (std::size_t k = 0; k < state_names.size(); ++k)
    if (text == state_names[k]) return static_cast<CaseState>(k);
  return fail("",
              where + R"( has the state ")" + excerpt(text) + R"(", which is none of "to do", "in work" and "done")");
}

Result<StudyCase> parsed_case(Json json, std::size_t number, const fs::path& folder) {
  std::string where = "case " + std::to_string(number);
  if (!json.is_object()) return fail("", where + " is no object; correct it in an editor");
  std::array<std::string, 9> texts;
  constexpr std::array<const char*, 9> keys{"name",     "file",   "group", "state",    "notes",
                                            "imported", "labels", "doubt", "structure"};
  for (std::size_t k = 0; k < keys.size(); ++k) {
    auto text = take_text(json, keys[k], where);
    if (!text) return fail(text.error());
    texts[k] = std::move(*text);
  }
  if (texts[1].empty()) return fail("", where + " has no \"file\"; name its case file or mesh");
  StudyCase one;
  one.name = texts[0].empty() ? file_stem(texts[1]) : texts[0];
  where = "case \"" + excerpt(one.name) + "\"";
  if (one.name.size() > longest_case_name) return fail("", where + " has too long a name; shorten it");
  one.file = absolute_in(folder, texts[1]);
  one.group = texts[2];
  one.notes = texts[4];
  one.imported = absolute_in(folder, texts[5]);
  if (!texts[6].empty()) one.labels = absolute_in(folder, texts[6]);
  one.doubt = texts[7];
  one.structure = texts[8];
  const auto state = parsed_state(texts[3], where);
  if (!state) return fail(state.error());
  one.state = *state;
  if (const auto frame = json.find("frame"); frame != json.end()) {
    if (!frame->is_number_unsigned() || *frame > 100000)
      return fail("", where + " has a \"frame\" that is no frame number");
    one.frame = frame->get<int>();
    json.erase(frame);
  }
  for (const auto& [key, value] : {std::pair("flipped", &one.flipped), std::pair("from_scan", &one.from_scan)}) {
    const auto found = json.find(key);
    if (found == json.end()) continue;
    if (!found->is_boolean()) return fail("", where + " has a \"" + key + "\" that is neither true nor false");
    *value = *found;
    json.erase(found);
  }
  if (const auto seconds = json.find("seconds"); seconds != json.end() && seconds->is_number() && *seconds >= 0) {
    one.seconds = seconds->get<double>();
    json.erase(seconds);
  }
  if (const auto gestures = json.find("gestures"); gestures != json.end() && gestures->is_number_unsigned()) {
    one.gestures = gestures->get<std::int64_t>();
    json.erase(gestures);
  }
  one.other = std::move(json);
  return one;
}

Result<Study> parsed_study(Json json, const fs::path& folder) {
  const auto stamp = json.is_object() ? json.find("homolog_study") : json.end();
  if (!json.is_object() || stamp == json.end() || !stamp->is_number_integer())
    return fail("", "is no study; a study starts with \"homolog_study\"");
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
  json.erase(std::string(record_key));  // of the file as it was made: a study goes on
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
  Json json{{"name", one.name}, {"file", relative_source(folder, one.file.string())}, {"state", state_name(one.state)}};
  if (!one.structure.empty()) json["structure"] = one.structure;
  if (one.frame) json["frame"] = *one.frame;
  if (one.flipped) json["flipped"] = true;
  if (!one.imported.empty()) json["imported"] = relative_source(folder, one.imported.string());
  if (one.from_scan) json["from_scan"] = true;
  if (!one.labels.empty()) json["labels"] = relative_source(folder, one.labels.string());
  if (!one.doubt.empty()) json["doubt"] = one.doubt;
  if (one.seconds > 0) json["seconds"] = std::round(10 * one.seconds) / 10;
  if (one.gestures > 0) json["gestures"] = one.gestures;
  if (!one.group.empty()) json["group"] = one.group;
  if (!one.notes.empty()) json["notes"] = one.notes;
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

const char* state_name(CaseState state) {
  return state_names[static_cast<std::size_t>(state)];
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
    const StudyCase& one = cases[static_cast<std::size_t>(k)];
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
