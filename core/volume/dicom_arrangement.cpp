#include "core/volume/dicom_arrangement.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <tuple>

namespace homolog {
namespace fs = std::filesystem;

namespace {

std::string mm_text(double mm) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f mm", mm);
  return text;
}

std::string slices_text(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " slice" : " slices");
}

std::vector<DicomPlaneSource> all_planes(const std::vector<DicomHeader>& headers) {
  std::vector<DicomPlaneSource> planes;
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
                         DicomArrangement& result) {
  auto& planes = result.planes;
  for (DicomPlaneSource& source : planes) source.along_normal_mm = source.plane->position_mm->dot(normal);
  std::stable_sort(planes.begin(), planes.end(), [](const DicomPlaneSource& a, const DicomPlaneSource& b) {
    return a.along_normal_mm < b.along_normal_mm;
  });
  std::vector<std::vector<DicomPlaneSource>> places;
  for (const DicomPlaneSource& source : planes) {
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
    std::stable_sort(place.begin(), place.end(), [&](const DicomPlaneSource& a, const DicomPlaneSource& b) {
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
Result<Vec3> slice_step(const fs::path& path, const std::vector<DicomHeader>& headers,
                        const DicomArrangement& arrangement, const Vec3& normal, double pixel_mm) {
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
    const DicomPlaneSource &before = arrangement.planes[s], &after = arrangement.planes[s + 1];
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
Result<DicomArrangement> arrange_unplaced(const fs::path& path, const std::vector<DicomHeader>& headers,
                                          DicomArrangement result, std::vector<std::string>& warnings) {
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
                     ": does not give its place in the patient; its axes are assumed to run to the left, "
                     "back and head");
  return result;
}

}  // namespace

Result<DicomArrangement> arrange(const fs::path& path, const std::vector<DicomHeader>& headers,
                                 std::vector<std::string>& warnings) {
  if (const auto alike = check_alike(path, headers); !alike) return fail(alike.error());
  DicomArrangement result;
  result.planes = all_planes(headers);
  const DicomPlane& first = headers.front().planes.front();
  if (!first.pixel_mm) warnings.push_back(path.string() + ": gives no pixel size; 1 mm is assumed");
  const auto [dx, dy] = first.pixel_mm.value_or(std::pair(1.0, 1.0));
  const bool placed =
      first.axes && std::all_of(result.planes.begin(), result.planes.end(),
                                [](const DicomPlaneSource& source) { return source.plane->position_mm.has_value(); });
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

}  // namespace homolog
