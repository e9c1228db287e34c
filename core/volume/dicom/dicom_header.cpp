#include "core/volume/dicom/dicom_header.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace homolog {

namespace {

namespace tag {
constexpr DicomTag image_type = 0x00080008, instance_uid = 0x00080018, modality = 0x00080060,
                   series_description = 0x0008103e, slice_thickness = 0x00180050, kilovolts = 0x00180060,
                   echo_time = 0x00180081, inversion_time = 0x00180082, echo_numbers = 0x00180086,
                   spacing_between_slices = 0x00180088, frame_time = 0x00181063, frame_times = 0x00181065,
                   imager_pixel_spacing = 0x00181164, kernel = 0x00181210, flip_angle = 0x00181314,
                   effective_echo_time = 0x00189082, b_value = 0x00189087, gradient_direction = 0x00189089,
                   study_uid = 0x0020000d, series_uid = 0x0020000e, acquisition_number = 0x00200012,
                   instance_number = 0x00200013, image_position = 0x00200032, image_orientation = 0x00200037,
                   frame_of_reference = 0x00200052, samples = 0x00280002, photometric = 0x00280004,
                   frame_count = 0x00280008, increment_pointer = 0x00280009, rows = 0x00280010, columns = 0x00280011,
                   pixel_spacing = 0x00280030, bits_allocated = 0x00280100, bits_stored = 0x00280101,
                   high_bit = 0x00280102, pixel_representation = 0x00280103, window_centre = 0x00281050,
                   window_width = 0x00281051, rescale_intercept = 0x00281052, rescale_slope = 0x00281053,
                   lossy = 0x00282110, lossy_ratio = 0x00282112, lossy_method = 0x00282114, modality_table = 0x00283000,
                   slice_vector = 0x00540080, slice_locations = 0x00182005, grid_offsets = 0x3004000c,
                   dose_scaling = 0x3004000e;
// Sequences within the functional groups of enhanced files [DICOM PS3.3, C.7.6.16].
constexpr DicomTag echo_group = 0x00189114, diffusion_group = 0x00189117, position_group = 0x00209113,
                   orientation_group = 0x00209116, measures_group = 0x00289110, window_group = 0x00289132,
                   rescale_group = 0x00289145;
}  // namespace tag

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
  plane.times = times_of(data, index, big_endian);
  plane.echo_ms = binary_number_of(aspect_of(data, index, tag::echo_group), tag::effective_echo_time, big_endian);
  if (!plane.echo_ms) plane.echo_ms = number_of(data, tag::echo_time);
  plane.b_value = binary_number_of(aspect_of(data, index, tag::diffusion_group), tag::b_value, big_endian);
  return plane;
}

std::vector<DicomSetting> settings_from(const DicomItem& data) {
  return {{"image types", text_of(data, tag::image_type)},
          {"echo numbers", text_of(data, tag::echo_numbers)},
          {"flip angles", text_of(data, tag::flip_angle)},
          {"inversion times", text_of(data, tag::inversion_time)},
          {"tube voltages", text_of(data, tag::kilovolts)},
          {"reconstruction kernels", text_of(data, tag::kernel)},
          {"gradient directions", text_of(data, tag::gradient_direction)}};
}

/// By what the planes of a file step on, as it says: the first tag of the frame increment pointer, 0 without one.
DicomTag increment_of(const DicomItem& data, bool big_endian) {
  const auto found = data.find(tag::increment_pointer);
  if (found == data.end() || found->second.value.size() < 4) return 0;
  const auto byte = [&](std::size_t i) {
    return static_cast<DicomTag>(static_cast<unsigned char>(found->second.value[i]));
  };
  return big_endian ? byte(0) << 24 | byte(1) << 16 | byte(2) << 8 | byte(3)
                    : byte(1) << 24 | byte(0) << 16 | byte(3) << 8 | byte(2);
}

/// The axis besides slices in which planes of nuclear medicine differ [DICOM PS3.3, C.8.4.8]; empty: none.
std::string steps_through(const DicomItem& data) {
  constexpr std::array<std::pair<DicomTag, const char*>, 7> vectors{{{0x00540010, "energy windows"},
                                                                     {0x00540020, "detectors"},
                                                                     {0x00540030, "phases"},
                                                                     {0x00540060, "R-R intervals"},
                                                                     {0x00540070, "time slots"},
                                                                     {0x00540090, "angles"},
                                                                     {0x00540100, "time slices"}}};
  for (const auto& [vector, name] : vectors) {
    const auto found = data.find(vector);
    if (found == data.end()) continue;
    const std::string& value = found->second.value;
    if (value.size() > 2 && value.substr(2) != value.substr(0, value.size() - 2)) return name;
  }
  return {};
}

/// Planes of a file that gives one position for all of them are a stack where it says how far they lie apart, and
/// frames where it says how long they take. What it says first counts: by what its planes step on.
void spread_planes(const DicomItem& data, bool big_endian, DicomHeader& header) {
  auto& planes = header.planes;
  const DicomTag increment = increment_of(data, big_endian);
  const auto steps = number_of(aspect_of(data, 0, tag::measures_group), tag::spacing_between_slices);
  const auto step = steps ? steps : number_of(data, tag::spacing_between_slices);
  const bool in_time = increment == tag::frame_time || increment == tag::frame_times;
  const bool by_slices = increment == tag::slice_vector || increment == tag::slice_locations;
  const bool in_space = !in_time && (by_slices || (step && *step != 0));
  header.planes_are_frames = planes.size() > 1 && (in_time || (header.frame_ms > 0 && !in_space));
  const DicomPlane first = planes.front();
  const bool alike = std::all_of(planes.begin(), planes.end(), [&](const DicomPlane& plane) {
    return plane.times == first.times && plane.position_mm == first.position_mm;
  });
  const auto apart = step ? step : first.slice_step_mm;
  // Scans of the beating heart give both a frame time and how far their slices lie apart.
  if (!alike || !in_space || (header.frame_ms > 0 && !by_slices) || !apart || !first.position_mm || !first.axes) return;
  for (std::size_t p = 0; p < planes.size(); ++p)
    if (own_aspect(data, p, tag::position_group)) return;
  // A step below zero runs against the normal.
  const Vec3 normal = first.axes->first.cross(first.axes->second);
  for (std::size_t p = 0; p < planes.size(); ++p)
    planes[p].position_mm = *first.position_mm + static_cast<double>(p) * *apart * normal;
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
  header.study_uid = text_of(data, tag::study_uid);
  header.series_uid = text_of(data, tag::series_uid);
  header.series_description = text_of(data, tag::series_description);
  header.modality = text_of(data, tag::modality);
  header.instance_uid = text_of(data, tag::instance_uid);
  header.frame_of_reference = text_of(data, tag::frame_of_reference);
  header.instance_number = number_of(data, tag::instance_number).value_or(0);
  header.acquisition_number = text_of(data, tag::acquisition_number);
  header.settings = settings_from(data);
  const auto table = data.find(tag::modality_table);
  header.steps_through = steps_through(data);
  header.has_modality_table = table != data.end() && !table->second.items.empty();
  header.lossy = text_of(data, tag::lossy);
  header.lossy_ratio = text_of(data, tag::lossy_ratio);
  header.lossy_method = text_of(data, tag::lossy_method);
  header.rows = small_number(tag::rows, 0);
  header.columns = small_number(tag::columns, 0);
  header.samples_per_pixel = small_number(tag::samples, 1);
  header.bits_allocated = small_number(tag::bits_allocated, 0);
  header.bits_stored = small_number(tag::bits_stored, header.bits_allocated);
  header.high_bit = small_number(tag::high_bit, header.bits_stored - 1);
  header.is_signed = small_number(tag::pixel_representation, 0) == 1;
  header.photometric = text_of(data, tag::photometric);
  const auto times = numbers_of(data, tag::frame_times);
  header.frame_ms = number_of(data, tag::frame_time).value_or(times.size() > 1 ? times[1] : 0);
  const std::size_t planes = plane_count(data, header);
  for (std::size_t p = 0; p < planes; ++p) header.planes.push_back(plane_from(data, p, set.big_endian));
  // Dose grids give their planes as offsets along the normal [DICOM PS3.3, C.8.8.3.2].
  const auto offsets = numbers_of(data, tag::grid_offsets);
  if (const DicomPlane first = header.planes.front();
      offsets.size() == planes && planes > 1 && first.position_mm && first.axes) {
    const Vec3 normal = first.axes->first.cross(first.axes->second);
    for (std::size_t p = 0; p < offsets.size(); ++p)
      header.planes[p].position_mm = *first.position_mm + (offsets[p] - offsets[0]) * normal;
  } else {
    spread_planes(data, set.big_endian, header);
  }
  return header;
}

}  // namespace homolog
