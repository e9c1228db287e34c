#include "core/volume/dicom/dicom_arrangement.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "core/volume/dicom/dicom_frames.h"
#include "core/volume/dicom/dicom_stack.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

std::string slices_text(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " slice" : " slices");
}

std::vector<DicomPlaneSource> all_planes(const std::vector<DicomHeader>& headers) {
  std::vector<DicomPlaneSource> planes;
  for (std::size_t f = 0; f < headers.size(); ++f)
    for (std::size_t p = 0; p < headers[f].planes.size(); ++p) planes.push_back({f, p, &headers[f].planes[p], 0, {}});
  return planes;
}

tl::unexpected<Error> mixes(const fs::path& path, const std::string& what, const DicomHeader& one,
                            const DicomHeader& other) {
  return fail(path.string(), "mixes slices of different " + what + " in one series (" + one.path.filename().string() +
                                 " and " + other.path.filename().string() + "); keep those of one scan");
}

Result<void> check_planes_alike(const fs::path& path, const DicomHeader& first, const DicomHeader& header) {
  const DicomPlane& model = first.planes.front();
  const auto differ = [](double a, double b, double tolerance) { return std::abs(a - b) > tolerance; };
  for (const DicomPlane& plane : header.planes) {
    const bool same_axes = plane.axes.has_value() == model.axes.has_value() &&
                           (!plane.axes || ((plane.axes->first - model.axes->first).norm() < 1e-3 &&
                                            (plane.axes->second - model.axes->second).norm() < 1e-3));
    const bool same_pixels = plane.pixel_mm.has_value() == model.pixel_mm.has_value() &&
                             (!plane.pixel_mm || !(differ(plane.pixel_mm->first, model.pixel_mm->first, 1e-4) ||
                                                   differ(plane.pixel_mm->second, model.pixel_mm->second, 1e-4)));
    if (!same_axes || !same_pixels) return mixes(path, "directions or pixel sizes", first, header);
    constexpr double same_echo_ms = 0.01;
    if (plane.echo_ms && model.echo_ms && differ(*plane.echo_ms, *model.echo_ms, same_echo_ms)) {
      char times[64];
      std::snprintf(times, sizeof times, "echo times (%g and %g ms)", *model.echo_ms, *plane.echo_ms);
      return mixes(path, times, first, header);
    }
  }
  return {};
}

Result<void> check_alike(const fs::path& path, const std::vector<DicomHeader>& headers) {
  const DicomHeader& first = headers.front();
  for (const DicomHeader& header : headers) {
    if (header.rows != first.rows || header.columns != first.columns) return mixes(path, "sizes", first, header);
    if (!header.frame_of_reference.empty() && !first.frame_of_reference.empty() &&
        header.frame_of_reference != first.frame_of_reference)
      return mixes(path, "spaces (frames of reference)", first, header);
    if (const auto alike = check_planes_alike(path, first, header); !alike) return alike;
  }
  return {};
}

/// Sorts by place, then time; several planes at every place are the frames of a cine.
Result<void> sort_planes(const fs::path& path, const std::vector<DicomHeader>& headers, const Vec3& normal,
                         DicomArrangement& result, std::vector<std::string>& warnings) {
  auto& planes = result.planes;
  for (DicomPlaneSource& source : planes) {
    source.along_normal_mm = source.plane->position_mm->dot(normal);
    source.times = source.plane->times;
  }
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
  }
  if (const auto ordered = order_frames(path, headers, places, warnings); !ordered) return fail(ordered.error());
  if (result.frames > 1) result.frame_seconds = seconds_between_frames(headers, places);
  planes.clear();
  for (std::size_t frame = 0; frame < places.front().size(); ++frame)
    for (const auto& place : places) planes.push_back(place[frame]);
  return {};
}

/// Planes without a position stay in the order of their file.
Result<DicomArrangement> arrange_unplaced(const fs::path& path, const std::vector<DicomHeader>& headers,
                                          DicomArrangement result, std::vector<std::string>& warnings) {
  if (headers.size() > 1)
    return fail(path.string(),
                "gives no positions for its slices, so that their order is unknown; convert it with the "
                "scanner's tools, or open it as a stack of pictures");
  const DicomHeader& header = headers.front();
  const bool cine = header.planes_are_frames;
  (cine ? result.frames : result.slices) = static_cast<int>(header.planes.size());
  if (cine) result.slices = 1;
  if (cine) result.frame_seconds = header.frame_ms / 1000;
  warnings.push_back(path.string() +
                     ": does not give its place in the patient; its axes are assumed to run to the left, "
                     "back and head");
  return result;
}

/// The fault that an error names, without its verb and the remedy: "unevenly spaced slices: …".
std::string fault_alone(const std::string& what) {
  const std::string fault = what.substr(0, what.find(';'));
  for (const std::string& verb : {std::string("has "), std::string("lacks ")})
    if (fault.starts_with(verb)) return (verb == "lacks " ? "missing " : "") + fault.substr(verb.size());
  return fault;
}

}  // namespace

Result<DicomArrangement> arrange(const fs::path& path, const std::vector<DicomHeader>& headers,
                                 std::vector<std::string>& warnings, bool resample) {
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
    if (const auto sorted = sort_planes(path, headers, normal, result, warnings); !sorted) return fail(sorted.error());
  } else {
    auto unplaced = arrange_unplaced(path, headers, std::move(result), warnings);
    if (!unplaced) return unplaced;
    result = std::move(*unplaced);
  }
  const std::pair<Vec3, Vec3> axes(along_columns, along_rows);
  if (placed)
    if (const auto straight = check_straight(path, headers, result.planes, axes, std::min(dx, dy)); !straight) {
      if (!resample || result.slices < 2) return fail(straight.error());
      result.uneven = fault_alone(straight.error().what);
    }
  Vec3 step = first.slice_step_mm.value_or(1) * normal;
  if (placed && result.slices > 1) {
    const auto found = slice_step(path, headers, result, axes);
    if (!found && !resample) return fail(found.error());
    if (!found) result.uneven += (result.uneven.empty() ? "" : ", and ") + fault_alone(found.error().what);
    step = result.uneven.empty() ? *found : normal;
  } else if (!first.slice_step_mm) {
    warnings.push_back(path.string() + ": gives no slice thickness; 1 mm is assumed");
  }
  result.steps_mm << dx * along_columns, dy * along_rows, step;
  if (placed) result.origin_mm = *result.planes.front().plane->position_mm;
  return result;
}

std::vector<SourceImage> images_of(const std::vector<DicomHeader>& headers, const DicomArrangement& arrangement) {
  std::vector<SourceImage> images;
  for (std::size_t place = 0; place < arrangement.planes.size(); ++place) {
    const DicomPlaneSource& source = arrangement.planes[place];
    const DicomHeader& header = headers[source.file];
    if (header.instance_uid.empty()) continue;
    SourceImage& image = images.emplace_back();
    image.uid = header.instance_uid;
    if (header.planes.size() == 1) image.position_mm = source.plane->position_mm;
    if (header.planes.size() > 1) image.frame = static_cast<int>(source.plane_in_file) + 1;
    image.slice = static_cast<int>(place) % arrangement.slices;
  }
  return images;
}

}  // namespace homolog
