#include "app/verbs/verify/verify_inputs.h"

#include <algorithm>
#include <set>

#include "app/verbs/files_named.h"
#include "app/verbs/record.h"
#include "core/base/encoding/sha256.h"
#include "core/base/files/files.h"
#include "core/base/files/paths.h"
#include "core/base/text/text.h"
#include "core/catalogue/catalogue.h"
#include "core/session/case_file.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

bool is_file_input(const Json& json) {
  return json.is_object() && json.contains("file") && json["file"].is_string() &&
         is_file_name(json["file"].get<std::string>()) && json.contains("sha256") && json["sha256"].is_string() &&
         json.contains("bytes") && json["bytes"].is_number_unsigned();
}

/// All files of a record's options, once each.
Result<void> collect(const Json& json, std::vector<FoundInput>& into) {
  if (json.is_array() || (json.is_object() && !json.contains("file"))) {
    for (const Json& part : json)
      if (auto done = collect(part, into); !done) return done;
    return {};
  }
  if (!json.is_object()) return {};  // a value, or a file that was not there
  if (!is_file_input(json)) return fail(damaged_record());
  FoundInput one{json["file"], json["sha256"], json["bytes"], {}};
  const bool known = std::ranges::any_of(into, [&](const FoundInput& other) {
    return other.sha256 == one.sha256 && other.bytes == one.bytes && other.name == one.name;
  });
  if (!known) into.push_back(std::move(one));
  for (const char* key : {"names", "label_names"})
    if (json.contains(key))
      if (auto done = collect(json[key], into); !done) return done;
  return {};
}

bool may_be(const FoundInput& input, const fs::path& path, std::uintmax_t bytes) {
  if (is_case_file(input.name)) return is_case_file(path) && bytes >= input.bytes;
  return bytes == input.bytes;
}

struct FileOfSize {
  fs::path path;
  std::uintmax_t bytes;
};

/// The files below a folder by name. Links to folders are not followed, and what cannot be entered is passed over.
Result<std::vector<FileOfSize>> files_below(const fs::path& folder, const Progress& progress) {
  std::error_code error;
  if (!fs::is_directory(folder, error))
    return fail(folder.string(), "is no folder; name the one that holds the inputs");
  std::vector<FileOfSize> files;
  fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error);
  for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    if (progress.cancelled()) return fail(folder.string(), "cancelled");
    std::error_code none;
    if (!entry->is_regular_file(none)) continue;
    const std::uintmax_t bytes = entry->file_size(none);
    if (!none) files.push_back({entry->path(), bytes});
  }
  if (error) return fail(folder.string(), "cannot be looked through (" + error.message() + "); check its rights");
  std::ranges::sort(files, {}, &FileOfSize::path);
  return files;
}

}  // namespace

Error damaged_record() {
  return {"", "has a damaged record; copy the file again from where it was written"};
}

Result<FoundInputs> FoundInputs::find(const Json& options, const fs::path& folder, Progress& progress) {
  FoundInputs found;
  if (auto done = collect(options, found.inputs_); !done) return fail(done.error());
  if (found.inputs_.empty()) return found;
  const auto files = files_below(folder, progress);
  if (!files) return fail(files.error());
  for (std::size_t k = 0; k < files->size() && !found.missing().empty(); ++k) {
    const auto& [path, bytes] = (*files)[k];
    progress.report(static_cast<double>(k) / static_cast<double>(files->size()));
    for (FoundInput& input : found.inputs_) {
      if (!input.path.empty() || !may_be(input, path, bytes)) continue;
      const auto sum = sha256_of_file(path, &progress, input.bytes);
      if (progress.cancelled()) return fail(folder.string(), "cancelled");
      if (sum && *sum == input.sha256) input.path = absolute_path(path);
    }
  }
  return found;
}

std::vector<std::string> FoundInputs::missing() const {
  std::vector<std::string> names;
  for (const FoundInput& input : inputs_)
    if (input.path.empty()) names.push_back(input.name);
  return names;
}

const FoundInput* FoundInputs::of(const Json& file) const {
  const auto found = std::ranges::find_if(inputs_, [&](const FoundInput& one) {
    return one.sha256 == file["sha256"] && one.bytes == file["bytes"] && one.name == file["file"];
  });
  return found != inputs_.end() && !found->path.empty() ? &*found : nullptr;
}

Result<fs::path> FoundInputs::lay(const Json& input, const fs::path& folder, const fs::path& room) const {
  const char* const key = input.is_object() && input.contains("folder") ? "folder" : "file";
  if (!input.is_object() || !input.contains(key) || !input[key].is_string()) return fail(damaged_record());
  const auto name = input[key].get<std::string>();
  if (!is_file_name(name)) return fail(damaged_record());
  fs::path at = folder / name;
  if (auto done = lay_at(input, at, room); !done) return fail(done.error());
  return at;
}

Result<void> FoundInputs::lay_at(const Json& input, const fs::path& at, const fs::path& room) const {
  // A name may lead up and down, but not out.
  if (!at.lexically_normal().string().starts_with(room.string() + "/")) return fail(damaged_record());
  if (auto made = make_folder(at.parent_path()); !made) return made;
  if (input.contains("folder")) {
    if (auto made = make_folder(at); !made) return made;
    if (!input.contains("files") || !input["files"].is_array()) return fail(damaged_record());
    for (const Json& one : input["files"])
      if (auto done = lay(one, at, room); !done) return fail(done.error());
    return {};
  }
  if (!is_file_input(input)) return fail(damaged_record());
  const FoundInput* there = of(input);
  if (there == nullptr) return fail(damaged_record());
  std::error_code error;
  if (fs::exists(at, error)) return {};
  if (is_case_file(at)) {  // a copy, as far as the record knows it: verbs may add lines
    const auto text = read_whole_file(there->path);
    if (!text) return fail(text.error());
    if (auto written = write_whole_file(at, std::string_view(*text).substr(0, there->bytes)); !written) return written;
  } else {
    fs::create_symlink(there->path, at, error);
    if (error)
      return fail(at.string(), "cannot be made (" + error.message() + "); check the folder for temporary files");
  }
  if (input.contains("label_names"))
    if (auto done = lay(input["label_names"], at.parent_path(), room); !done) return fail(done.error());
  if (!input.contains("names")) return {};
  const std::vector<std::string> names = files_named_in(at);
  const Json& there_named = input["names"];
  const bool is_whole = there_named.is_array() && there_named.size() == names.size();
  if (!is_whole && !there_named.is_object()) return fail(damaged_record());
  for (std::size_t k = 0; k < names.size(); ++k) {
    const fs::path named = resolved_source(at.parent_path(), names[k]);
    const Json one = is_whole ? there_named[k] : there_named.value(std::to_string(k), Json());
    if (one.is_null()) continue;
    if (fs::path(names[k]).is_absolute())
      return fail(there->path.string(),
                  "names " + named.filename().string() +
                      " by its whole path, so what was made of it cannot be made elsewhere; " +
                      (is_case_file(there->path) ? "save the case beside it" : "name it relative to this file"));
    if (auto done = lay_at(one, named.lexically_normal(), room); !done) return done;
  }
  return {};
}

}  // namespace homolog
