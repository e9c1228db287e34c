#include "core/volume/labels/label_tables.h"

#include <algorithm>
#include <array>
#include <vector>

#include "core/base/files/file_stem.h"
#include "core/base/files/files.h"
#include "core/base/text/text.h"
#include "core/volume/labels/label_likeness.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

/// Whether names from a file beside the volume are about it: it holds labels, or all that it holds has a name.
bool are_labels(const Volume& volume, const Segmentation& names) {
  if (volume.range_min < 0 || volume.range_max > 65535) return false;
  if (holds_labels(volume)) return true;
  const auto held = labels_of(volume);
  return std::all_of(held.begin(), held.end(), [&](const auto& label) { return names.find(label.first, 0); });
}

Result<Segmentation> names_in_file(const fs::path& file) {
  constexpr std::uintmax_t most_bytes = std::uintmax_t{16} << 20;
  auto text = read_whole_file(file, most_bytes);
  if (!text) return fail(text.error());
  if (text->starts_with("\xEF\xBB\xBF")) text->erase(0, 3);
  const std::string ending = lower_case(file.extension().string());
  return ending == ".json"                      ? labels_of_json(*text)
         : ending == ".csv" || ending == ".tsv" ? labels_of_table(*text)
                                                : labels_of_lines(*text);
}

std::vector<fs::path> files_beside(const fs::path& path) {
  const fs::path folder = path.parent_path();
  const std::string stem = file_stem(path);
  std::vector<fs::path> files{folder / (path.filename().string() + ".json")};
  static constexpr std::array endings{".json", ".csv", ".tsv", ".label", ".txt", ".ctbl", ".ctab"};
  for (const char* ending : endings) files.push_back(folder / (stem + ending));
  for (const char* name : {"labels", "label_map", "class_map"})
    for (const char* ending : endings) files.push_back(folder / (std::string(name) + ending));
  for (const char* name : {"dataset.json", "FreeSurferColorLUT.txt"}) files.push_back(folder / name);
  if (folder.filename().string().starts_with("labels")) files.push_back(folder.parent_path() / "dataset.json");
  return files;
}

}  // namespace

fs::path label_names_beside(const fs::path& path) {
  for (const fs::path& file : files_beside(path)) {
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) continue;
    const auto names = names_in_file(file);
    if (!names || !names->segments.empty()) return file;
  }
  return {};
}

void take_names_beside(const fs::path& path, VolumeRead& read) {
  if (!read.segmentation.segments.empty()) return;
  for (const fs::path& file : files_beside(path)) {
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) continue;
    const auto names = names_in_file(file);
    if (names && names->segments.empty()) continue;  // about something else
    if (!are_labels(read.volume, names ? *names : Segmentation())) return;
    if (names) {
      read.segmentation = *names;
    } else {
      read.segmentation.unread = file.string() + " " + names.error().what;
      read.warnings.push_back(file.string() + ": " + names.error().what +
                              ", so that its names are not used; correct it, or move it away");
    }
    return;
  }
}

}  // namespace homolog
