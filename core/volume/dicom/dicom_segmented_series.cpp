#include "core/volume/dicom/dicom_segmented_series.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/volume/contours.h"
#include "core/volume/dicom/dicom_arrangement.h"
#include "core/volume/dicom/dicom_copies.h"
#include "core/volume/dicom/dicom_segments.h"
#include "core/volume/dicom/dicom_series.h"
#include "core/volume/readers.h"
#include "core/volume/referenced_images.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

/// The files of a folder that may be DICOM, by name.
std::vector<fs::path> dicom_files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error, not_a_file;
  for (auto entry = fs::directory_iterator(folder, error); !error && entry != fs::directory_iterator();
       entry.increment(error))
    if (entry->is_regular_file(not_a_file) && !is_hidden(entry->path()) && looks_like_dicom(entry->path()))
      files.push_back(entry->path());
  std::sort(files.begin(), files.end());
  return files;
}

/// The grid of a series and its images; nothing where its slices are no even stack.
std::optional<ImageGrid> grid_of_series(const fs::path& folder, const std::vector<DicomHeader>& all) {
  std::vector<std::string> ignored;
  const std::vector<DicomHeader> headers = without_copies(folder, all, ignored);
  const auto arrangement = arrange(folder, headers, ignored);
  if (!arrangement) return {};
  const auto grid = make_geometry(folder, {headers.front().columns, headers.front().rows, arrangement->slices},
                                  arrangement->steps_mm, arrangement->origin_mm);
  if (!grid) return {};
  return ImageGrid{*grid, headers.front().frame_of_reference, images_of(headers, *arrangement)};
}

/// The series in the folder of a segmentation that lie in its space. Files that cannot be read are no part of it.
SeriesByUid series_beside(const DicomSet& segmentation, Progress* progress) {
  const std::string space = text_of(segmentation.elements, 0x00200052);
  const fs::path folder = segmentation.path.has_parent_path() ? segmentation.path.parent_path() : fs::path(".");
  SeriesByUid series;
  for (const fs::path& file : dicom_files_in(folder)) {
    if (progress && progress->cancelled()) return {};
    const auto set = parse_dicom(file);
    if (!set || is_dicom_segmentation(*set)) continue;
    DicomHeader header = dicom_header(*set);
    if (header.is_image() && header.frame_of_reference == space) series[header.series_uid].push_back(std::move(header));
  }
  return series;
}

}  // namespace

SeriesByUid::const_iterator series_of(const ReferencedImages& made_on, const SeriesByUid& series) {
  const std::set<std::string> wanted(made_on.instances.begin(), made_on.instances.end());
  auto best = series.end();
  std::ptrdiff_t most = 0;
  for (auto one = series.begin(); one != series.end(); ++one) {
    const auto held =
        std::ranges::count_if(one->second, [&](const DicomHeader& h) { return wanted.contains(h.instance_uid); });
    if (held > most) best = one;
    most = std::max(most, held);
  }
  for (const std::string& uid : made_on.series)
    if (best == series.end()) best = series.find(uid);
  return best;
}

Result<VolumeRead> read_segmentation_on_series(const DicomSet& set, const std::optional<ImageGrid>& image,
                                               Progress* progress) {
  const bool in_space =
      image && (image->frame_of_reference.empty() || image->frame_of_reference == text_of(set.elements, 0x00200052));
  auto on_image = in_space ? read_dicom_segmentation(set, image, progress) : Result<VolumeRead>(VolumeRead());
  if (!on_image || (in_space && !on_image->volume.empty_beyond_slices)) return on_image;
  const ReferencedImages made_on = segmented_images(set);
  const bool made_on_some = !made_on.series.empty() || !made_on.instances.empty();
  const SeriesByUid series = made_on_some ? series_beside(set, progress) : SeriesByUid();
  const auto own = series_of(made_on, series);
  const auto beside = own == series.end() ? series.begin() : own;
  if (beside == series.end())
    return in_space ? std::move(on_image) : read_dicom_segmentation(set, std::nullopt, progress);
  const fs::path folder = set.path.parent_path();
  std::vector<SourceImage> images;
  for (const DicomHeader& header : beside->second) images.push_back({.uid = header.instance_uid});
  auto read = read_dicom_segmentation(set, own == series.end() ? std::nullopt : grid_of_series(folder, beside->second),
                                      progress);
  auto other = other_images(set.path, made_on, "the image beside it", beside->first, images);
  if (read && other) read->warnings.push_back(std::move(*other));
  return read;
}

std::vector<fs::path> segmentations_in(const fs::path& folder) {
  std::vector<fs::path> found;
  for (const fs::path& file : dicom_files_in(folder)) {
    const auto set = parse_dicom(file);
    if (set && is_dicom_segmentation(*set))
      found.push_back(file);
    else if (set && dicom_header(*set).is_image())
      return {};  // a scan, with what was segmented of it
  }
  return found.size() > 1 ? found : std::vector<fs::path>();
}

ReferencedImages images_made_on(const fs::path& path) {
  if (!looks_like_dicom(path)) return {};
  const auto set = parse_dicom(path);
  if (set && is_dicom_segmentation(*set)) return segmented_images(*set);
  const auto contours = set ? read_contours(path) : Result<Contours>(Contours());
  return contours ? contours->referenced : ReferencedImages();
}

fs::path folder_of_series(const fs::path& folder, const std::vector<std::string>& series) {
  std::error_code ignored;
  if (series.empty() || !fs::is_directory(folder, ignored) || !dicom_files_in(folder).empty()) return folder;
  std::vector<fs::path> folders;
  std::error_code error;
  for (auto entry = fs::directory_iterator(folder, error); !error && entry != fs::directory_iterator();
       entry.increment(error))
    if (entry->is_directory(ignored)) folders.push_back(entry->path());
  std::sort(folders.begin(), folders.end());
  for (const fs::path& one : folders)
    for (const fs::path& file : dicom_files_in(one)) {
      const auto set = parse_dicom(file);
      if (set && dicom_header(*set).is_image() &&
          std::ranges::find(series, dicom_header(*set).series_uid) != series.end())
        return one;
    }
  return folder;
}

}  // namespace homolog
