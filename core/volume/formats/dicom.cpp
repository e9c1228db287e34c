#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "core/base/processes/memory.h"
#include "core/base/text/listed.h"
#include "core/volume/dicom/dicom_arrangement.h"
#include "core/volume/dicom/dicom_copies.h"
#include "core/volume/dicom/dicom_header.h"
#include "core/volume/dicom/dicom_pixels.h"
#include "core/volume/dicom/dicom_segmented_series.h"
#include "core/volume/dicom/dicom_segments.h"
#include "core/volume/dicom/dicom_series.h"
#include "core/volume/dicom/resample_slices.h"
#include "core/volume/formats/formats.h"
#include "core/volume/readers.h"

// DICOM: planes from one file or a folder, put in their place.
namespace homolog {
namespace fs = std::filesystem;

namespace {

Result<void> check_image(const DicomHeader& header) {
  if (header.pixels_missing)
    return fail(header.path.string(), "is cut short: pixels are missing; copy or download it again");
  if (header.is_image() && header.has_modality_table)
    return fail(header.path.string(),
                "gives the meaning of its pixels by a table (Modality LUT), which cannot be read; export it with a "
                "rescale slope and intercept");
  if (header.is_image() && !header.steps_through.empty() && header.planes.size() > 1)
    return fail(header.path.string(), "holds planes of several " + header.steps_through +
                                          ", which are no stack of slices; export one of them as a volume");
  if (header.is_image()) return {};
  if (header.modality == "RTSTRUCT")
    return fail(header.path.string(),
                "holds no image but contours; make a label map of them: convert FILE OUT.seg.nrrd --like IMAGE");
  return fail(header.path.string(), "holds no image" +
                                        (header.modality.empty() ? "" : " (its modality is " + header.modality + ")") +
                                        "; open the image series instead");
}

/// The place of each plane of each file in the volume.
std::vector<std::vector<std::size_t>> places_by_file(const std::vector<DicomHeader>& headers,
                                                     const DicomArrangement& arrangement) {
  std::vector<std::vector<std::size_t>> place_of(headers.size());
  for (std::size_t f = 0; f < headers.size(); ++f) place_of[f].resize(headers[f].planes.size());
  for (std::size_t place = 0; place < arrangement.planes.size(); ++place)
    place_of[arrangement.planes[place].file][arrangement.planes[place].plane_in_file] = place;
  return place_of;
}

/// Sorts planes of `plane_bytes` bytes, without room for a second volume: `places[i]` is where the i-th of them
/// belongs.
void put_in_place(std::span<std::byte> planes, std::size_t plane_bytes, std::vector<std::size_t> places) {
  const auto plane = [&](std::size_t i) { return planes.subspan(i * plane_bytes, plane_bytes); };
  for (std::size_t i = 0; i < places.size(); ++i)
    while (places[i] != i) {
      const std::size_t place = places[i];
      std::swap_ranges(plane(i).begin(), plane(i).end(), plane(place).begin());
      std::swap(places[i], places[place]);
    }
}

/// Decodes every plane into its place. Memory is taken as planes arrive, file by file, those first that lie first.
Result<StoredVoxels> read_planes(const fs::path& path, const std::vector<DicomHeader>& headers,
                                 const DicomArrangement& arrangement, Progress* progress) {
  const auto type = dicom_stored_type(headers.front());
  if (!type) return fail(type.error());
  const std::size_t places = arrangement.planes.size();
  const std::size_t plane_voxels =
      static_cast<std::size_t>(headers.front().rows) * static_cast<std::size_t>(headers.front().columns);
  const std::size_t plane_bytes = plane_voxels * size_of(*type);
  bool encoded = false;
  for (const DicomHeader& header : headers) {
    if (const auto credible = check_pixel_claim(header, plane_bytes); !credible) return fail(credible.error());
    encoded = encoded || !header.pixels->fragments.empty();
  }
  const double voxels = static_cast<double>(places) * static_cast<double>(plane_voxels);
  // Decoders hold a plane in their own way, too.
  const double decoding = encoded ? 8 * static_cast<double>(plane_voxels) : 0;
  if (const auto enough = check_memory(path, bytes_while_reading(*type, voxels, true) + decoding); !enough)
    return fail(enough.error());
  const auto place_of = places_by_file(headers, arrangement);
  std::vector<std::size_t> files(headers.size()), arrived;
  std::iota(files.begin(), files.end(), std::size_t{0});
  std::sort(files.begin(), files.end(),
            [&](std::size_t a, std::size_t b) { return place_of[a].front() < place_of[b].front(); });
  StoredVoxels stored = make_stored_voxels(*type, 0);
  reserve_voxels(stored, places * plane_voxels);
  const auto room = [&](std::size_t bytes) { return add_voxels(stored, bytes / size_of(*type)); };
  for (const std::size_t f : files) {
    if (progress) {
      if (progress->cancelled()) return fail(path.string(), "was not read: cancelled");
      progress->report(static_cast<double>(arrived.size()) / static_cast<double>(places));
    }
    if (const auto own = dicom_stored_type(headers[f]); !own || *own != *type)
      return fail(headers[f].path.string(),
                  "stores its pixels in another way than the rest of its series; export it again");
    const auto read = read_dicom_pixels(headers[f], room, headers.size() == 1 ? progress : nullptr);
    if (!read) return fail(read.error());
    arrived.insert(arrived.end(), place_of[f].begin(), place_of[f].end());
  }
  put_in_place(bytes_of(stored), plane_bytes, std::move(arrived));
  return stored;
}

/// Planes that are rescaled each in its own way (PET) become floats.
StoredVoxels rescaled_by_plane(const StoredVoxels& stored, const std::vector<DicomPlaneSource>& planes) {
  return std::visit(
      [&](const auto& values) -> StoredVoxels {
        std::vector<float> result(values.size());
        const std::size_t plane = values.size() / planes.size();
        for (std::size_t p = 0; p < planes.size(); ++p) {
          const Rescale& rescale = planes[p].plane->rescale;
          for (std::size_t i = p * plane; i < (p + 1) * plane; ++i)
            result[i] = static_cast<float>(rescale.slope * static_cast<double>(values[i]) + rescale.intercept);
        }
        return result;
      },
      stored);
}

Result<VolumeRead> read_headers(const fs::path& path, const std::vector<DicomHeader>& all, bool resample,
                                Progress* progress) {
  VolumeRead result;
  Volume& volume = result.volume;
  for (const DicomHeader& header : all)
    if (const auto image = check_image(header); !image) return fail(image.error());
  const std::vector<DicomHeader> headers = without_copies(path, all, result.warnings);
  for (const DicomHeader& header : headers)
    result.warnings.insert(result.warnings.end(), header.warnings.begin(), header.warnings.end());
  auto arrangement = arrange(path, headers, result.warnings, resample);
  if (!arrangement) return fail(arrangement.error());
  auto geometry = make_geometry(path, {headers.front().columns, headers.front().rows, arrangement->slices},
                                arrangement->steps_mm, arrangement->origin_mm);
  if (!geometry) return fail(geometry.error());
  volume.geometry = *geometry;
  volume.frames = arrangement->frames;
  volume.frame_seconds = arrangement->frame_seconds;
  volume.series_uid = headers.front().series_uid;
  volume.study_uid = headers.front().study_uid;
  volume.modality = headers.front().modality;
  volume.frame_of_reference = headers.front().frame_of_reference;
  volume.images = images_of(headers, *arrangement);
  volume.file_window = arrangement->planes[arrangement->slices / 2].plane->window;
  auto stored = read_planes(path, headers, *arrangement, progress);
  if (!stored) return fail(stored.error());
  Rescale rescale = arrangement->planes.front().plane->rescale;
  if (std::any_of(arrangement->planes.begin(), arrangement->planes.end(),
                  [&](const DicomPlaneSource& source) { return !(source.plane->rescale == rescale); })) {
    stored = rescaled_by_plane(*stored, arrangement->planes);
    rescale = {};
  }
  if (auto kept = keep_voxels(std::move(*stored), rescale, path.string(), volume, result.warnings); !kept)
    return fail(kept.error());
  if (arrangement->uneven.empty()) return result;
  auto done = resample_slices(path, *arrangement, volume, progress);
  if (!done) return fail(done.error());
  result.warnings.push_back(resampled_sentence(path, *done));
  result.resampled = std::move(*done);
  volume.resampled = true;
  return result;
}

/// Whether those files of a folder that are not DICOM may be passed over. One that is named like a slice is a slice
/// that was damaged, and without it the volume would lack its place.
Result<void> check_others(const std::vector<fs::path>& dicom, const std::vector<fs::path>& others) {
  std::set<std::string> names;
  for (const fs::path& file : dicom) {
    names.insert(name_without_numbers(file));
    const std::string extension = name_without_numbers(file.extension());
    if (extension.find('#') == std::string::npos && !extension.empty()) names.insert(extension);
  }
  for (const fs::path& file : others)
    if (names.contains(name_without_numbers(file)) || names.contains(lower_case_name(file.extension())))
      return fail(file.string(),
                  "is named like the slices beside it but cannot be read as DICOM; copy the series again, or move the "
                  "file elsewhere if it is no part of it");
  return {};
}

/// The content of a folder: image headers by series, and segmentations, each of which is a file.
struct FolderContents {
  SeriesByUid series;
  std::vector<DicomSet> segmentations;
};

Result<FolderContents> scan_folder(const fs::path& folder, Progress* progress) {
  FolderContents contents;
  std::error_code error, not_a_file;
  std::vector<fs::path> files;
  for (auto entry = fs::directory_iterator(folder, error); !error && entry != fs::directory_iterator();
       entry.increment(error))
    if (!entry->is_directory(not_a_file) && !is_hidden(entry->path())) files.push_back(entry->path());
  if (error) return fail(folder.string(), "cannot be listed (" + error.message() + ")");
  std::sort(files.begin(), files.end());
  const auto cancelled = [&] { return progress && progress->cancelled(); };
  std::vector<fs::path> dicom, others;
  for (fs::path& file : files) {
    if (cancelled()) return fail(folder.string(), "was not read: cancelled");
    (looks_like_dicom(file) ? dicom : others).push_back(std::move(file));
  }
  if (const auto whole = check_others(dicom, others); !whole) return fail(whole.error());
  for (const fs::path& file : dicom) {
    if (cancelled()) return fail(folder.string(), "was not read: cancelled");
    auto set = parse_dicom(file);
    if (!set) return fail(set.error());
    if (is_dicom_segmentation(*set)) {
      contents.segmentations.push_back(std::move(*set));
      continue;
    }
    DicomHeader header = dicom_header(*set);
    if (header.is_image()) contents.series[header.series_uid].push_back(std::move(header));
  }
  return contents;
}

Result<VolumeRead> read_dicom_file(const fs::path& path, const VolumeReadOptions& options) {
  const auto set = parse_dicom(path);
  if (!set) return fail(set.error());
  if (is_dicom_segmentation(*set)) return read_segmentation_on_series(*set, options.image, options.progress);
  DicomHeader header = dicom_header(*set);
  return read_headers(path, {std::move(header)}, options.resample, options.progress);
}

/// Reads the lone segmentation of a folder without images.
Result<VolumeRead> read_lone_segmentation(const fs::path& folder, const std::vector<DicomSet>& segmentations,
                                          const VolumeReadOptions& options) {
  if (segmentations.empty()) return fail(folder.string(), "holds no DICOM images; choose the folder that does");
  if (segmentations.size() == 1)
    return read_segmentation_on_series(segmentations.front(), options.image, options.progress);
  std::vector<std::string> names;
  for (const DicomSet& set : segmentations) names.push_back(set.path.filename().string());
  return fail(folder.string(), "holds " + std::to_string(names.size()) +
                                   " DICOM segmentations and no images; name one of the files: " + listed(names, ", "));
}

/// `series_uid` chooses where the folder holds several series, else what images are wanted of. Segmentations beside
/// images count as series only there.
Result<VolumeRead> read_dicom_folder(const fs::path& folder, const VolumeReadOptions& options) {
  const std::string& series_uid = options.series_uid;
  const auto contents = scan_folder(folder, options.progress);
  if (!contents) return fail(contents.error());
  const auto& series = contents->series;
  for (const DicomSet& set : contents->segmentations)
    if (!series_uid.empty() && text_of(set.elements, 0x0020000e) == series_uid)
      return read_segmentation_on_series(set, options.image, options.progress);
  if (series.empty() && series_uid.empty()) return read_lone_segmentation(folder, contents->segmentations, options);
  const auto chosen = !series_uid.empty()  ? series.find(series_uid)
                      : series.size() == 1 ? series.begin()
                                           : series_of(options.of_images, series);
  if (chosen != series.end()) return read_headers(folder, chosen->second, options.resample, options.progress);
  std::vector<std::string> list;
  for (const auto& [uid, headers] : series)
    list.push_back(uid + " (" + headers.front().modality + " \"" + headers.front().series_description + "\", " +
                   std::to_string(headers.size()) + (headers.size() == 1 ? " file)" : " files)"));
  if (!series_uid.empty())
    return fail(folder.string(),
                "holds no series " + series_uid + (list.empty() ? "" : "; it holds " + listed(list, ", ")));
  return fail(folder.string(),
              "holds " + std::to_string(series.size()) +
                  (options.names_no_series ? " series; copy the files of one to a folder of their own, and give that: "
                                           : " series; choose one with --series UID: ") +
                  listed(list, ", "));
}

Result<VolumeRead> read_dicom(const fs::path& path, const VolumeReadOptions& options) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return read_dicom_folder(path, options);
  return read_dicom_file(path, options);
}

}  // namespace

const VolumeFormat formats::dicom{
    .name = "DICOM",
    .endings = {".dcm", ".ima"},
    .in_folder = "DICOM files",
    .note = "known by its content, whatever its name: the folder of a series, one file, or a segmentation (SEG)",
    .recognises = looks_like_dicom,
    .read = read_dicom};

Result<DicomSeries> read_dicom_series(const fs::path& path, Progress* progress, bool resample,
                                      const std::string& series_uid) {
  DicomSeries result;
  std::error_code ignored;
  std::vector<DicomHeader> all;
  if (fs::is_directory(path, ignored)) {
    auto contents = scan_folder(path, progress);
    if (!contents) return fail(contents.error());
    if (const auto chosen = contents->series.find(series_uid); chosen != contents->series.end())
      contents->series = {*chosen};
    if (contents->series.size() != 1)
      return fail(path.string(),
                  contents->series.empty()
                      ? "holds no DICOM images, to which a segmentation could refer; choose the folder that does"
                      : "holds several series; choose a folder with the one that was segmented");
    all = std::move(contents->series.begin()->second);
  } else {
    const auto set = parse_dicom(path);
    if (!set) return fail(set.error());
    all.push_back(dicom_header(*set));
  }
  for (const DicomHeader& header : all)
    if (const auto image = check_image(header); !image) return fail(image.error());
  std::vector<std::string> warnings;
  result.headers = without_copies(path, all, warnings);
  auto arrangement = arrange(path, result.headers, warnings, resample);
  if (!arrangement) return fail(arrangement.error());
  result.arrangement = std::move(*arrangement);
  const DicomHeader& first = result.headers.front();
  const auto grid = make_geometry(path, {first.columns, first.rows, result.arrangement.slices},
                                  result.arrangement.steps_mm, result.arrangement.origin_mm);
  if (!grid) return fail(grid.error());
  result.grid = *grid;
  auto set = parse_dicom(first.path);
  if (!set) return fail(set.error());
  result.about = std::move(set->elements);
  return result;
}

Result<std::vector<SeriesInfo>> list_series(const fs::path& folder) {
  const auto contents = scan_folder(folder, nullptr);
  if (!contents) return fail(contents.error());
  std::vector<SeriesInfo> list;
  for (const auto& [uid, headers] : contents->series)
    list.push_back(
        {uid, headers.front().series_description, headers.front().modality, static_cast<int>(headers.size())});
  return list;
}

}  // namespace homolog
