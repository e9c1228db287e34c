#include "app/verbs/files_named.h"

#include <sstream>
#include <utility>

#include "app/verbs/case_table.h"
#include "app/verbs/verb.h"
#include "core/base/encoding/json.h"
#include "core/base/files/files.h"
#include "core/base/text/text.h"
#include "core/catalogue/catalogue.h"
#include "core/model/shapes/study.h"
#include "core/session/case_file.h"
#include "core/structures/template_set.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

void add_named(const Json& json, const char* key, std::vector<std::string>& names) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_string()) return;
  if (auto name = found->get<std::string>(); names_file(name)) names.push_back(std::move(name));
}

/// The image and the templates of a case. The label map is only shown.
std::vector<std::string> files_of_case(const std::string& text) {
  std::vector<std::string> names;
  std::istringstream lines(text);
  bool first = true;
  for (std::string line; std::getline(lines, line); first = false) {
    if (!first && !line.starts_with("{\"structure\"")) continue;
    const auto json = read_json<Json>(line);
    if (!json || !json->is_object()) continue;
    if (first) add_named(*json, "volume", names);
    const Json& holder = first ? *json : (*json)["structure"];
    if (holder.is_object()) add_named(holder, "template", names);
  }
  return names;
}

/// What a study or a set names.
std::vector<std::string> files_of_list(const std::string& text, const char* list, const char* key) {
  std::vector<std::string> names;
  const auto json = read_json<Json>(text);
  if (!json || !json->is_object()) return names;
  if (const auto found = json->find(list); found != json->end() && found->is_array())
    for (const Json& one : *found)
      if (one.is_object()) add_named(one, key, names);
  return names;
}

/// The voxels of a header that keeps them in a file of their own.
std::vector<std::string> voxels_of_header(const std::string& text, std::string_view key, char sign) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t at = line.find(sign);
    if (at == std::string::npos || trimmed(std::string_view(line).substr(0, at)) != key) continue;
    const std::string name(trimmed(std::string_view(line).substr(at + 1)));
    if (name != "LOCAL" && name.find_first_of("% ") == std::string::npos) return {name};
  }
  return {};
}

}  // namespace

std::vector<std::string> files_named_in(const fs::path& file) {
  constexpr std::uintmax_t most_bytes = std::uintmax_t{1} << 28;
  const std::string name = lower_case(file.filename().string());
  const bool is_case = is_case_file(file), is_study = is_study_file(name), is_set = is_template_set(file);
  const bool is_header = name.ends_with(".mhd") || name.ends_with(".nhdr");
  if (is_case_table(file)) {
    std::vector<std::string> names;
    for (FileOfTable& one : files_of_table(file)) names.push_back(std::move(one.file));
    return names;
  }
  if (!is_case && !is_study && !is_set && !is_header) return {};
  const auto text = read_whole_file(file, most_bytes);
  if (!text) return {};  // whoever reads it says why
  if (is_case) return files_of_case(*text);
  if (is_study) return files_of_list(*text, "cases", "file");
  if (is_set) return files_of_list(*text, "structures", "template");
  return name.ends_with(".mhd") ? voxels_of_header(*text, "ElementDataFile", '=')
                                : voxels_of_header(*text, "data file", ':');
}

}  // namespace homolog
