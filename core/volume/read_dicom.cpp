#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

#include "core/base/memory.h"
#include "core/volume/dicom_header.h"
#include "core/volume/dicom_pixels.h"
#include "core/volume/readers.h"

// DICOM: planes from one file or a folder, put in their place.
namespace homolog {
namespace fs = std::filesystem;

namespace {

tl::unexpected<Error> file_cut(const DicomHeader& header) {
  return fail(header.path.string(), "is cut short: pixels are missing; copy or download it again");
}

Result<void> check_image(const DicomHeader& header) {
  if (header.pixels_missing) return file_cut(header);
  if (header.is_image()) return {};
  return fail(header.path.string(), "holds no image" +
                                        (header.modality.empty() ? "" : " (its modality is " + header.modality + ")") +
                                        "; open the image series instead");
}

/// A plane and where it comes from.
struct PlaneSource {
  std::size_t file = 0, plane_in_file = 0;
  const DicomPlane* plane = nullptr;
  double along_normal_mm = 0;
};

/// The planes in the order of the volume (slices fastest, then frames), and its grid.
struct Arrangement {
  std::vector<PlaneSource> planes;
  int slices = 0, frames = 1;
  Mat3 steps_mm = Mat3::Identity();
  Vec3 origin_mm = Vec3::Zero();
  double frame_seconds = 0;
};

std::string mm_text(double mm) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f mm", mm);
  return text;
}

std::string slices_text(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " slice" : " slices");
}

std::vector<PlaneSource> all_planes(const std::vector<DicomHeader>& headers) {
  std::vector<PlaneSource> planes;
  for (std::size_t f = 0; f < headers.size(); ++f)
    for (std::size_t p = 0; p < headers[f].planes.size(); ++p) planes.push_back({f, p, &headers[f].planes[p], 0});
  return planes;
}

Result<void> check_alike(const fs::path& path, const std::vector<DicomHeader>& headers) {
  const DicomHeader& first = headers.front();
  for (const DicomHeader& header : headers) {
    if (header.rows != first.rows || header.columns != first.columns)
      return fail(path.string(), "mixes slices of different sizes in one series (" + first.path.filename().string() +
                                     " and " + header.path.filename().string() + "); keep those of one scan");
    for (const DicomPlane& plane : header.planes) {
      const DicomPlane& model = first.planes.front();
      const bool same_axes = plane.axes.has_value() == model.axes.has_value() &&
                             (!plane.axes || ((plane.axes->first - model.axes->first).norm() < 1e-3 &&
                                              (plane.axes->second - model.axes->second).norm() < 1e-3));
      const bool same_pixels = plane.pixel_mm.has_value() == model.pixel_mm.has_value() &&
                               (!plane.pixel_mm || (std::abs(plane.pixel_mm->first - model.pixel_mm->first) < 1e-4 &&
                                                    std::abs(plane.pixel_mm->second - model.pixel_mm->second) < 1e-4));
      if (!same_axes || !same_pixels)
        return fail(path.string(), "mixes slices of different directions or pixel sizes in one series (" +
                                       first.path.filename().string() + " and " + header.path.filename().string() +
                                       "); keep those of one scan");
    }
  }
  return {};
}

/// Sorts by place, then time; several planes at every place are the frames of a cine.
Result<void> sort_planes(const fs::path& path, const std::vector<DicomHeader>& headers, const Vec3& normal,
                         Arrangement& result) {
  auto& planes = result.planes;
  for (PlaneSource& source : planes) source.along_normal_mm = source.plane->position_mm->dot(normal);
  std::stable_sort(planes.begin(), planes.end(),
                   [](const PlaneSource& a, const PlaneSource& b) { return a.along_normal_mm < b.along_normal_mm; });
  std::vector<std::vector<PlaneSource>> places;
  for (const PlaneSource& source : planes) {
    if (places.empty() || source.along_normal_mm - places.back().front().along_normal_mm > 1e-2) places.emplace_back();
    places.back().push_back(source);
  }
  result.slices = static_cast<int>(places.size());
  result.frames = static_cast<int>(places.front().size());
  for (auto& place : places) {
    if (place.size() != places.front().size())
      return fail(path.string(), "has " + slices_text(places.front().size()) + " at " +
                                     mm_text(places.front().front().along_normal_mm) + " along its normal and " +
                                     slices_text(place.size()) + " at " + mm_text(place.front().along_normal_mm) +
                                     "; copy the whole series again, or keep one acquisition of it");
    std::stable_sort(place.begin(), place.end(), [&](const PlaneSource& a, const PlaneSource& b) {
      return std::tuple(a.plane->time_ms, headers[a.file].instance_number, a.plane_in_file) <
             std::tuple(b.plane->time_ms, headers[b.file].instance_number, b.plane_in_file);
    });
  }
  planes.clear();
  for (std::size_t frame = 0; frame < places.front().size(); ++frame)
    for (const auto& place : places) planes.push_back(place[frame]);
  return {};
}

/// The step from slice to slice; refuses where one is missing or they are not stacked straight.
Result<Vec3> slice_step(const fs::path& path, const std::vector<DicomHeader>& headers, const Arrangement& arrangement,
                        const Vec3& normal, double pixel_mm) {
  const auto slices = static_cast<std::size_t>(arrangement.slices);
  std::vector<double> gaps;
  for (std::size_t s = 1; s < slices; ++s)
    gaps.push_back(arrangement.planes[s].along_normal_mm - arrangement.planes[s - 1].along_normal_mm);
  std::vector<double> sorted = gaps;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
  const double usual = sorted[sorted.size() / 2];
  for (std::size_t s = 0; s < gaps.size(); ++s) {
    // Positions are often rounded to a tenth of a millimetre.
    const double tolerance = std::min(std::max(0.1, 0.02 * usual), 0.25 * usual);
    if (std::abs(gaps[s] - usual) <= tolerance) continue;
    const PlaneSource &before = arrangement.planes[s], &after = arrangement.planes[s + 1];
    const std::string where = headers[before.file].path.filename().string() + " (" + mm_text(before.along_normal_mm) +
                              ") and " + headers[after.file].path.filename().string() + " (" +
                              mm_text(after.along_normal_mm) + ")";
    return fail(path.string(), (gaps[s] > 1.5 * usual ? "lacks slices: " : "has unevenly spaced slices: ") + where +
                                   " lie " + mm_text(gaps[s]) + " apart, the others " + mm_text(usual) +
                                   "; copy the whole series again or resample it evenly");
  }
  const Vec3 whole = *arrangement.planes[slices - 1].plane->position_mm - *arrangement.planes[0].plane->position_mm;
  if ((whole - whole.dot(normal) * normal).norm() > 0.5 * pixel_mm)
    return fail(path.string(),
                "has slices that are shifted sideways against one another (a tilted gantry); resample it "
                "to a rectangular grid first");
  return whole.dot(normal) / static_cast<double>(slices - 1) * normal;
}

/// Planes without a position stay in the order of their file.
Result<Arrangement> arrange_unplaced(const fs::path& path, const std::vector<DicomHeader>& headers, Arrangement result,
                                     std::vector<std::string>& warnings) {
  if (headers.size() > 1)
    return fail(path.string(),
                "gives no positions for its slices, so that their order is unknown; convert it with the "
                "scanner's tools, or open it as a stack of pictures");
  const DicomHeader& header = headers.front();
  const bool cine = header.planes.size() > 1 && header.frame_ms > 0 && !header.step_is_given;
  (cine ? result.frames : result.slices) = static_cast<int>(header.planes.size());
  if (cine) result.slices = 1;
  if (cine) result.frame_seconds = header.frame_ms / 1000;
  warnings.push_back(path.string() +
                     ": says nothing of its place in the patient; its axes are taken to run to the left, "
                     "back and head");
  return result;
}

Result<Arrangement> arrange(const fs::path& path, const std::vector<DicomHeader>& headers,
                            std::vector<std::string>& warnings) {
  if (const auto alike = check_alike(path, headers); !alike) return fail(alike.error());
  Arrangement result;
  result.planes = all_planes(headers);
  const DicomPlane& first = headers.front().planes.front();
  if (!first.pixel_mm) warnings.push_back(path.string() + ": gives no pixel size; 1 mm is assumed");
  const auto [dx, dy] = first.pixel_mm.value_or(std::pair(1.0, 1.0));
  const bool placed =
      first.axes && std::all_of(result.planes.begin(), result.planes.end(),
                                [](const PlaneSource& source) { return source.plane->position_mm.has_value(); });
  const auto [along_columns, along_rows] = placed ? *first.axes : std::pair<Vec3, Vec3>(Vec3::UnitX(), Vec3::UnitY());
  const Vec3 normal = along_columns.cross(along_rows).normalized();
  if (placed) {
    if (const auto sorted = sort_planes(path, headers, normal, result); !sorted) return fail(sorted.error());
  } else {
    auto unplaced = arrange_unplaced(path, headers, std::move(result), warnings);
    if (!unplaced) return unplaced;
    result = std::move(*unplaced);
  }
  Vec3 step = first.slice_step_mm.value_or(1) * normal;
  if (placed && result.slices > 1) {
    const auto found = slice_step(path, headers, result, normal, std::min(dx, dy));
    if (!found) return fail(found.error());
    step = *found;
  } else if (!first.slice_step_mm) {
    warnings.push_back(path.string() + ": gives no slice thickness; 1 mm is assumed");
  }
  result.steps_mm << dx * along_columns, dy * along_rows, step;
  if (placed) result.origin_mm = *result.planes.front().plane->position_mm;
  if (placed && result.frames > 1) {
    const double ms =
        result.planes[static_cast<std::size_t>(result.slices)].plane->time_ms - result.planes[0].plane->time_ms;
    if (headers.front().frame_ms > 0)
      result.frame_seconds = headers.front().frame_ms / 1000;
    else if (ms > 1)
      result.frame_seconds = ms / 1000;
  }
  return result;
}

/// Refuses sizes that a file's pixels cannot hold, before memory is taken for them.
Result<void> check_pixel_claim(const DicomHeader& header, std::size_t plane_bytes) {
  const double claimed = static_cast<double>(plane_bytes) * static_cast<double>(header.planes.size());
  // An evenly grey picture of 512 × 512 takes about a hundred bytes in JPEG 2000. Deflated pixels have been counted.
  constexpr double best_ratio = 20000;
  const double ratio = header.pixels->fragments.empty() ? 1 : best_ratio;
  if (claimed <= static_cast<double>(header.pixels->bytes) * ratio) return {};
  return file_cut(header);
}

/// Where each plane of each file lies in the volume.
std::vector<std::vector<std::size_t>> places_by_file(const std::vector<DicomHeader>& headers,
                                                     const Arrangement& arrangement) {
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
                                 const Arrangement& arrangement, Progress* progress) {
  const auto type = dicom_stored_type(headers.front());
  if (!type) return fail(type.error());
  const std::size_t places = arrangement.planes.size();
  const std::size_t plane_voxels =
      static_cast<std::size_t>(headers.front().rows) * static_cast<std::size_t>(headers.front().columns);
  const std::size_t plane_bytes = plane_voxels * bytes_per_voxel(*type);
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
  const auto room = [&](std::size_t bytes) { return add_voxels(stored, bytes / bytes_per_voxel(*type)); };
  for (const std::size_t f : files) {
    if (progress) {
      if (progress->cancelled()) return fail(path.string(), "was not read: cancelled");
      progress->report(static_cast<double>(arrived.size()) / static_cast<double>(places));
    }
    if (const auto own = dicom_stored_type(headers[f]); !own || *own != *type)
      return fail(headers[f].path.string(), "stores its pixels otherwise than the rest of its series; export it again");
    const auto read = read_dicom_pixels(headers[f], room, headers.size() == 1 ? progress : nullptr);
    if (!read) return fail(read.error());
    arrived.insert(arrived.end(), place_of[f].begin(), place_of[f].end());
  }
  put_in_place(bytes_of(stored), plane_bytes, std::move(arrived));
  return stored;
}

/// Planes that are rescaled each in its own way (PET) become floats.
StoredVoxels rescaled_by_plane(const StoredVoxels& stored, const std::vector<PlaneSource>& planes) {
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

Result<VolumeRead> read_headers(const fs::path& path, const std::vector<DicomHeader>& headers, Progress* progress) {
  VolumeRead result;
  Volume& volume = result.volume;
  for (const DicomHeader& header : headers)
    if (const auto image = check_image(header); !image) return fail(image.error());
  for (const DicomHeader& header : headers)
    result.warnings.insert(result.warnings.end(), header.warnings.begin(), header.warnings.end());
  auto arrangement = arrange(path, headers, result.warnings);
  if (!arrangement) return fail(arrangement.error());
  auto geometry = make_geometry(path, {headers.front().columns, headers.front().rows, arrangement->slices},
                                arrangement->steps_mm, arrangement->origin_mm);
  if (!geometry) return fail(geometry.error());
  volume.geometry = *geometry;
  volume.frames = arrangement->frames;
  volume.frame_seconds = arrangement->frame_seconds;
  volume.series_uid = headers.front().series_uid;
  volume.modality = headers.front().modality;
  volume.file_window = arrangement->planes[static_cast<std::size_t>(arrangement->slices / 2)].plane->window;
  auto stored = read_planes(path, headers, *arrangement, progress);
  if (!stored) return fail(stored.error());
  Rescale rescale = arrangement->planes.front().plane->rescale;
  if (std::any_of(arrangement->planes.begin(), arrangement->planes.end(),
                  [&](const PlaneSource& source) { return !(source.plane->rescale == rescale); })) {
    stored = rescaled_by_plane(*stored, arrangement->planes);
    rescale = {};
  }
  if (auto kept = keep_voxels(std::move(*stored), rescale, path.string(), volume, result.warnings); !kept)
    return fail(kept.error());
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
    if (names.contains(name_without_numbers(file)) || names.contains(file.extension().string()))
      return fail(file.string(),
                  "is named like the slices beside it but cannot be read as DICOM; copy the series again, or move the "
                  "file elsewhere if it is no part of it");
  return {};
}

/// The image headers in a folder, by series.
Result<std::map<std::string, std::vector<DicomHeader>>> scan_folder(const fs::path& folder, Progress* progress) {
  std::map<std::string, std::vector<DicomHeader>> series;
  std::error_code error, not_a_file;
  std::vector<fs::path> files;
  for (auto entry = fs::directory_iterator(folder, error); !error && entry != fs::directory_iterator();
       entry.increment(error))
    if (!entry->is_directory(not_a_file)) files.push_back(entry->path());
  if (error) return fail(folder.string(), "cannot be listed (" + error.message() + ")");
  std::sort(files.begin(), files.end());
  const auto others = std::stable_partition(files.begin(), files.end(), looks_like_dicom);
  if (const auto whole = check_others({files.begin(), others}, {others, files.end()}); !whole)
    return fail(whole.error());
  files.erase(others, files.end());
  for (const fs::path& file : files) {
    if (progress && progress->cancelled()) return fail(folder.string(), "was not read: cancelled");
    const auto set = parse_dicom(file);
    if (!set) return fail(set.error());
    DicomHeader header = dicom_header(*set);
    if (header.is_image()) series[header.series_uid].push_back(std::move(header));
  }
  return series;
}

}  // namespace

Result<VolumeRead> read_dicom_file(const fs::path& path, Progress* progress) {
  const auto set = parse_dicom(path);
  if (!set) return fail(set.error());
  DicomHeader header = dicom_header(*set);
  return read_headers(path, {std::move(header)}, progress);
}

Result<VolumeRead> read_dicom_folder(const fs::path& folder, const std::string& series_uid, Progress* progress) {
  auto series = scan_folder(folder, progress);
  if (!series) return fail(series.error());
  if (series->empty()) return fail(folder.string(), "holds no DICOM images; choose the folder that does");
  auto chosen = series_uid.empty() ? series->begin() : series->find(series_uid);
  if (chosen != series->end() && (!series_uid.empty() || series->size() == 1))
    return read_headers(folder, chosen->second, progress);
  std::string list;
  for (const auto& [uid, headers] : *series)
    list += (list.empty() ? "" : ", ") + uid + " (" + headers.front().modality + " \"" +
            headers.front().series_description + "\", " + std::to_string(headers.size()) +
            (headers.size() == 1 ? " file)" : " files)");
  if (!series_uid.empty()) return fail(folder.string(), "holds no series " + series_uid + "; it holds " + list);
  return fail(folder.string(),
              "holds " + std::to_string(series->size()) + " series; choose one with --series UID: " + list);
}

Result<std::vector<SeriesInfo>> list_series(const fs::path& folder) {
  const auto series = scan_folder(folder, nullptr);
  if (!series) return fail(series.error());
  std::vector<SeriesInfo> list;
  for (const auto& [uid, headers] : *series)
    list.push_back(
        {uid, headers.front().series_description, headers.front().modality, static_cast<int>(headers.size())});
  return list;
}

}  // namespace homolog
