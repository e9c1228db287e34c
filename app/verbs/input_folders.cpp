#include "app/verbs/input_folders.h"

#include <algorithm>

#include "core/base/processes/parallel.h"
#include "core/base/text/text.h"
#include "core/mesh/mesh_io.h"
#include "core/volume/dicom/dicom_series.h"
#include "core/volume/formats/formats.h"
#include "core/volume/labels/label_likeness.h"
#include "core/volume/volume_io.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

template <class Wanted>
std::vector<fs::path> files_in(const fs::path& folder, const Wanted& wanted) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    const std::string name = entry->path().filename().string();
    if (!name.starts_with('.') && !entry->is_directory(ignored) && wanted(entry->path()))
      files.push_back(entry->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

Result<void> check_there(const std::vector<fs::path>& named) {
  std::error_code ignored;
  for (const fs::path& one : named)
    if (!one.empty() && !fs::exists(one, ignored)) return fail(one.string(), "does not exist; check the name");
  return {};
}

std::vector<fs::path> volumes_in(const fs::path& folder) {
  const auto by_name = files_in(folder, [](const fs::path& file) {
    const std::string name = lower_case(file.filename().string());
    // Slices of one scan lie in folders of their own.
    for (const char* slice : {".dcm", ".ima", ".png", ".tif", ".tiff", ".jpg", ".jpeg"})
      if (name.ends_with(slice)) return false;
    static const auto endings = volume_format_endings(&VolumeFormat::endings);
    return std::any_of(endings.begin(), endings.end(), [&](const auto& ending) { return name.ends_with(ending); });
  });
  return by_name.empty() ? segmentations_in(folder) : by_name;
}

std::vector<fs::path> surfaces_in(const fs::path& folder) {
  return files_in(folder, [](const fs::path& file) { return is_mesh_name(file) && file.extension() != ".particles"; });
}

std::vector<fs::path> with_folders_opened(const std::vector<fs::path>& files,
                                          std::vector<fs::path> (*in)(const fs::path&), bool& any) {
  std::vector<fs::path> all;
  any = false;
  for (const fs::path& file : files) {
    std::error_code error;
    const auto found = fs::is_directory(file, error) ? in(file) : std::vector<fs::path>();
    if (found.empty())
      all.push_back(file);
    else
      all.insert(all.end(), found.begin(), found.end()), any = true;
  }
  return all;
}

std::vector<fs::path> label_maps_among(const std::vector<fs::path>& volumes) {
  std::vector<char> wanted(volumes.size(), 1);
  for_each_in_parallel(volumes.size(), [&](std::size_t k) {
    const auto read = read_volume(volumes[k]);
    wanted[k] = !read || holds_labels(read->volume) ? 1 : 0;
  });
  std::vector<fs::path> maps;
  for (std::size_t k = 0; k < volumes.size(); ++k)
    if (wanted[k] != 0) maps.push_back(volumes[k]);
  return maps;
}

}  // namespace homolog
