#include "core/volume/dicom_header.h"

#include <algorithm>
#include <cmath>

namespace homolog {

namespace {

namespace tag {
constexpr DicomTag modality = 0x00080060, series_description = 0x0008103e, acquisition_time = 0x00080032,
                   slice_thickness = 0x00180050, spacing_between_slices = 0x00180088, trigger_time = 0x00181060,
                   frame_time = 0x00181063, imager_pixel_spacing = 0x00181164, series_uid = 0x0020000e,
                   instance_number = 0x00200013, image_position = 0x00200032, image_orientation = 0x00200037,
                   temporal_position = 0x00200100, temporal_index = 0x00209128, trigger_delay = 0x00209153,
                   samples = 0x00280002, photometric = 0x00280004, frame_count = 0x00280008, rows = 0x00280010,
                   columns = 0x00280011, pixel_spacing = 0x00280030, bits_allocated = 0x00280100,
                   bits_stored = 0x00280101, high_bit = 0x00280102, pixel_representation = 0x00280103,
                   window_centre = 0x00281050, window_width = 0x00281051, rescale_intercept = 0x00281052,
                   rescale_slope = 0x00281053, grid_offsets = 0x3004000c, dose_scaling = 0x3004000e,
                   shared_groups = 0x52009229, plane_groups = 0x52009230;
// Sequences within the functional groups of enhanced files [DICOM PS3.3, C.7.6.16].
constexpr DicomTag cardiac_group = 0x00189118, content_group = 0x00209111, position_group = 0x00209113,
                   orientation_group = 0x00209116, measures_group = 0x00289110, window_group = 0x00289132,
                   rescale_group = 0x00289145;
}  // namespace tag

/// The elements that describe one aspect of one plane: those of the plane's functional group, else of the group shared
/// by all, else of the file itself.
const DicomItem& aspect_of(const DicomItem& data, std::size_t plane, DicomTag aspect) {
  if (const DicomItem* own = item_of(data, tag::plane_groups, plane))
    if (const DicomItem* found = item_of(*own, aspect, 0)) return *found;
  if (const DicomItem* shared = item_of(data, tag::shared_groups, 0))
    if (const DicomItem* found = item_of(*shared, aspect, 0)) return *found;
  return data;
}

Vec3 vector_from(const std::vector<double>& numbers, std::size_t first) {
  return {numbers[first], numbers[first + 1], numbers[first + 2]};
}

DicomPlane plane_from(const DicomItem& data, std::size_t index, bool big_endian) {
  DicomPlane plane;
  if (const auto p = numbers_of(aspect_of(data, index, tag::position_group), tag::image_position); p.size() == 3)
    plane.position_mm = vector_from(p, 0);
  if (const auto o = numbers_of(aspect_of(data, index, tag::orientation_group), tag::image_orientation);
      o.size() == 6) {
    const Vec3 along_columns = vector_from(o, 0), along_rows = vector_from(o, 3);
    if (along_columns.norm() > 0.5 && along_rows.norm() > 0.5)
      plane.axes = std::pair(along_columns.normalized(), along_rows.normalized());
  }
  const DicomItem& measures = aspect_of(data, index, tag::measures_group);
  auto spacing = numbers_of(measures, tag::pixel_spacing);
  if (spacing.size() != 2) spacing = numbers_of(data, tag::imager_pixel_spacing);
  if (spacing.size() == 2 && spacing[0] > 0 && spacing[1] > 0) plane.pixel_mm = std::pair(spacing[1], spacing[0]);
  for (const DicomTag source : {tag::spacing_between_slices, tag::slice_thickness})
    for (const DicomItem* item : {&measures, &data})
      if (const auto step = number_of(*item, source); step && *step != 0 && !plane.slice_step_mm)
        plane.slice_step_mm = std::abs(*step);
  const DicomItem& transformation = aspect_of(data, index, tag::rescale_group);
  plane.rescale.slope =
      number_of(transformation, tag::rescale_slope).value_or(number_of(data, tag::dose_scaling).value_or(1));
  if (plane.rescale.slope == 0) plane.rescale.slope = 1;
  plane.rescale.intercept = number_of(transformation, tag::rescale_intercept).value_or(0);
  const DicomItem& voi = aspect_of(data, index, tag::window_group);
  const auto centre = number_of(voi, tag::window_centre), width = number_of(voi, tag::window_width);
  if (centre && width && *width > 0) plane.window = std::pair(*centre, *width);
  const auto delay = binary_number_of(aspect_of(data, index, tag::cardiac_group), tag::trigger_delay, big_endian);
  const auto position = binary_number_of(aspect_of(data, index, tag::content_group), tag::temporal_index, big_endian);
  plane.time_ms = delay.value_or(position.value_or(0));
  return plane;
}

/// The most planes that the pixels can be: of encoded ones, each has a fragment of its own.
double planes_held(const DicomHeader& header) {
  if (!header.pixels) return 0;
  if (!header.pixels->fragments.empty()) return static_cast<double>(header.pixels->fragments.size());
  const double plane_bytes =
      static_cast<double>(header.rows) * header.columns * header.samples_per_pixel * header.bits_allocated / 8;
  return plane_bytes > 0 ? std::floor(static_cast<double>(header.pixels->bytes) / plane_bytes) : 0;
}

/// The number of planes; where the file's own is damaged, what its pixels hold. Checked before anything is made for
/// each.
std::size_t plane_count(const DicomItem& data, DicomHeader& header) {
  const std::string text = text_of(data, tag::frame_count);
  if (text.empty()) return 1;
  constexpr double most = 1e6;
  const double held = planes_held(header);
  if (const auto number = number_of(data, tag::frame_count); number && *number >= 1 && *number < most) {
    header.pixels_missing = header.is_image() && *number > held;
    return *number > held ? 1 : static_cast<std::size_t>(*number);
  }
  const double planes = std::clamp(held, 1.0, most);
  header.warnings.push_back(header.path.string() + ": its number of frames, \"" + text +
                            "\", is no number; its pixels hold " + std::to_string(static_cast<int>(planes)));
  return static_cast<std::size_t>(planes);
}

}  // namespace

DicomHeader dicom_header(const DicomSet& set) {
  const DicomItem& data = set.elements;
  const auto small_number = [&](DicomTag wanted, int otherwise) {
    const auto number = binary_number_of(data, wanted, set.big_endian);
    return number && *number >= 0 && *number <= 65535 ? static_cast<int>(*number) : otherwise;
  };
  DicomHeader header;
  header.path = set.path;
  header.transfer_syntax = set.transfer_syntax;
  header.big_endian = set.big_endian;
  header.pixels = set.pixels;
  header.series_uid = text_of(data, tag::series_uid);
  header.series_description = text_of(data, tag::series_description);
  header.modality = text_of(data, tag::modality);
  header.instance_number = number_of(data, tag::instance_number).value_or(0);
  header.rows = small_number(tag::rows, 0);
  header.columns = small_number(tag::columns, 0);
  header.samples_per_pixel = small_number(tag::samples, 1);
  header.bits_allocated = small_number(tag::bits_allocated, 0);
  header.bits_stored = small_number(tag::bits_stored, header.bits_allocated);
  header.high_bit = small_number(tag::high_bit, header.bits_stored - 1);
  header.is_signed = small_number(tag::pixel_representation, 0) == 1;
  header.photometric = text_of(data, tag::photometric);
  header.frame_ms = number_of(data, tag::frame_time).value_or(0);
  header.step_is_given = number_of(data, tag::spacing_between_slices).has_value();
  const std::size_t planes = plane_count(data, header);
  for (std::size_t p = 0; p < planes; ++p) header.planes.push_back(plane_from(data, p, set.big_endian));
  if (planes == 1) {
    DicomPlane& plane = header.planes.front();
    for (const DicomTag source : {tag::trigger_time, tag::temporal_position, tag::acquisition_time})
      if (const auto time = number_of(data, source); time && plane.time_ms == 0) plane.time_ms = *time;
  }
  // Dose grids give their planes as offsets along the normal [DICOM PS3.3, C.8.8.3.2].
  const auto offsets = numbers_of(data, tag::grid_offsets);
  if (const DicomPlane first = header.planes.front();
      offsets.size() == planes && planes > 1 && first.position_mm && first.axes) {
    const Vec3 normal = first.axes->first.cross(first.axes->second);
    for (std::size_t p = 0; p < offsets.size(); ++p)
      header.planes[p].position_mm = *first.position_mm + (offsets[p] - offsets[0]) * normal;
  }
  return header;
}

}  // namespace homolog
