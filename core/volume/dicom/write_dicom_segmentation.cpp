#include "core/volume/dicom/write_dicom_segmentation.h"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>

#include "core/base/encoding/hash.h"
#include "core/base/files/files.h"
#include "core/base/processes/memory.h"
#include "core/base/text/listed.h"
#include "core/base/text/text.h"
#include "core/volume/dicom/dicom_elements.h"
#include "core/volume/dicom/dicom_series.h"
#include "core/volume/dicom/dicom_text.h"
#include "core/volume/dicom/dicom_written_frames.h"
#include "core/volume/dicom/dicom_written_segments.h"
#include "core/volume/labels/map_on_grid.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

constexpr const char* segmentation_storage = "1.2.840.10008.5.1.4.1.1.66.4";

/// A UID of what a hash has taken in and of what it names [DICOM PS3.5, B.2]: 38 digits at most.
std::string made_uid(Hash hash, std::string_view of) {
  for (const char c : of) hash.add(static_cast<unsigned char>(c));
  Hash lower = hash;
  lower.add(1);
  constexpr std::uint64_t digits_19 = 10'000'000'000'000'000'000U;
  std::string end = std::to_string(lower.value % digits_19);
  return "2.25." + std::to_string(hash.value % digits_19 + 1) + std::string(19 - end.size(), '0') + end;
}

/// The segmentation lies on a grid that the series was resampled to, whose slices are no images.
bool is_resampled(const DicomSeries& series) {
  return !series.arrangement.uneven.empty();
}

/// The image of a slice, and which plane of its file it is.
DicomElements referenced_image(const DicomSeries& series, int slice, bool with_frame) {
  const DicomPlaneSource& plane = series.arrangement.planes[slice];
  DicomElements image;
  image.put(0x00081150, "UI", text_of(series.about, 0x00080016))
      .put(0x00081155, "UI", series.headers[plane.file].instance_uid);
  if (with_frame && series.headers[plane.file].planes.size() > 1)
    image.put(0x00081160, "IS", std::to_string(plane.plane_in_file + 1));
  return image;
}

/// `rank`: which of the slices that have frames it is, from 1.
DicomElements frame_group(const DicomSeries& series, int number, int slice, std::uint32_t rank) {
  DicomElements derivation, content, position, identification, group;
  content.put_longs(0x00209157, {static_cast<std::uint32_t>(number), rank});
  identification.put_shorts(0x0062000b, {static_cast<std::uint16_t>(number)});
  const Vec3 on_grid = series.grid.to_mm(Vec3(0, 0, slice));
  if (is_resampled(series)) {
    position.put_decimals(0x00200032, {on_grid.x(), on_grid.y(), on_grid.z()});
    group.put_items(0x00209111, {content}).put_items(0x00209113, {position}).put_items(0x0062000a, {identification});
    return group;
  }
  DicomElements source = referenced_image(series, slice, true);
  source.put_items(0x0040a170, {coded("121322", "DCM", "Source image for image processing operation")});
  const DicomPlaneSource& plane = series.arrangement.planes[slice];
  // The image's own place: rounded, it may lie a little off the grid.
  const Vec3 place = series.headers[plane.file].planes[plane.plane_in_file].position_mm.value_or(on_grid);
  derivation.put_items(0x00082112, {source}).put_items(0x00089215, {coded("113076", "DCM", "Segmentation")});
  position.put_decimals(0x00200032, {place.x(), place.y(), place.z()});
  group.put_items(0x00089124, {derivation})
      .put_items(0x00209111, {content})
      .put_items(0x00209113, {position})
      .put_items(0x0062000a, {identification});
  return group;
}

DicomElements shared_groups_of(const VolumeGeometry& grid) {
  const Mat3& d = grid.direction;
  DicomElements orientation, measures, shared;
  orientation.put_decimals(0x00200037, {d(0, 0), d(1, 0), d(2, 0), d(0, 1), d(1, 1), d(2, 1)});
  measures.put_decimals(0x00180050, {grid.spacing_mm.z()})
      .put_decimals(0x00180088, {grid.spacing_mm.z()})
      .put_decimals(0x00280030, {grid.spacing_mm.y(), grid.spacing_mm.x()});
  shared.put_items(0x00209116, {orientation}).put_items(0x00289110, {measures});
  return shared;
}

/// Patient and study, as the series has them, in UTF-8. Elements in letters that are not known here stay empty, and are
/// named in `lost`.
void put_patient_and_study(const DicomItem& about, DicomElements& data, std::vector<std::string>& lost) {
  const DicomAlphabets alphabets(about);
  const auto copied = [&](DicomTag tag, const char* vr) { data.put(tag, vr, text_of(about, tag)); };
  const auto copied_text = [&](DicomTag tag, const char* vr, const char* name) {
    const auto text = alphabets.read(text_of(about, tag));
    data.put(tag, vr, text.value_or(""));
    if (!text) lost.emplace_back(name);
  };
  copied(0x00080020, "DA");
  copied(0x00080030, "TM");
  copied_text(0x00080050, "SH", "accession number");
  copied_text(0x00080090, "PN", "referring physician");
  copied_text(0x00100010, "PN", "patient's name");
  copied_text(0x00100020, "LO", "patient's ID");
  copied(0x00100030, "DA");
  copied(0x00100040, "CS");
  copied(0x0020000d, "UI");
  copied_text(0x00200010, "SH", "study ID");
  copied(0x00200052, "UI");
  // The same input gives the same bytes, so that no clock is asked.
  const std::string date = text_of(about, 0x00080020), time = text_of(about, 0x00080030);
  data.put(0x00080023, "DA", date.empty() ? "19700101" : date).put(0x00080033, "TM", time.empty() ? "000000" : time);
}

std::vector<std::string> lost_texts(const fs::path& path, const DicomSeries& series,
                                    const std::vector<std::string>& lost) {
  if (lost.empty()) return {};
  return {path.string() + ": lacks the " + listed(lost, " and ") + ", which " + series.headers.front().path.string() +
          " gives in letters that cannot be read (its character set is " +
          excerpt(DicomAlphabets(series.about).words()) + "); add them where the file is kept"};
}

void put_dimensions(const std::string& uid, DicomElements& data) {
  DicomElements organisation, by_segment, by_place;
  organisation.put(0x00209164, "UI", uid);
  by_segment.put(0x00209164, "UI", uid)
      .put_tag(0x00209165, 0x0062000b)
      .put_tag(0x00209167, 0x0062000a)
      .put(0x00209421, "LO", "Segment");
  by_place.put(0x00209164, "UI", uid)
      .put_tag(0x00209165, 0x00200032)
      .put_tag(0x00209167, 0x00209113)
      .put(0x00209421, "LO", "Position");
  data.put_items(0x00209221, {organisation}).put_items(0x00209222, {by_segment, by_place});
}

void put_equipment(DicomElements& data) {
  data.put(0x00080070, "LO", "Homolog")
      .put(0x00081090, "LO", "Homolog")
      .put(0x00181000, "LO", "0")
      .put(0x00181020, "LO", "Homolog");
}

void put_image(const VolumeGeometry& grid, const WrittenFrames& frames, DicomElements& data) {
  const std::uint16_t bits = frames.full > 0 ? 8 : 1;
  if (frames.full > 0)
    data.put_shorts(0x0062000e, {static_cast<std::uint16_t>(frames.full)}).put(0x00620010, "CS", "PROBABILITY");
  data.put_shorts(0x00280002, {1})
      .put(0x00280004, "CS", "MONOCHROME2")
      .put(0x00280008, "IS", std::to_string(frames.of.size()))
      .put_shorts(0x00280010, {static_cast<std::uint16_t>(grid.dims[1])})
      .put_shorts(0x00280011, {static_cast<std::uint16_t>(grid.dims[0])})
      .put_shorts(0x00280100, {bits})
      .put_shorts(0x00280101, {bits})
      .put_shorts(0x00280102, {static_cast<std::uint16_t>(bits - 1)})
      .put_shorts(0x00280103, {0});
}

/// Images that were compressed with loss hand that on to what is made of them [DICOM PS3.3, C.7.6.1.1.5].
void put_loss(const DicomSeries& series, DicomElements& data) {
  const auto lossy = std::ranges::find_if(series.headers, [](const DicomHeader& one) { return one.lossy == "01"; });
  data.put(0x00282110, "CS", lossy != series.headers.end() ? "01" : "00");
  if (lossy == series.headers.end()) return;
  if (!lossy->lossy_ratio.empty()) data.put(0x00282112, "DS", lossy->lossy_ratio);
  if (!lossy->lossy_method.empty()) data.put(0x00282114, "CS", lossy->lossy_method);
}

void add_text(const std::string& text, Hash& hash) {
  for (const char c : text + '\n') hash.add(static_cast<unsigned char>(c));
}

/// All elements but the UID of the instance and the pixels. `of_series`: what makes UIDs the series' own.
DicomElements data_set(const DicomSeries& series, const std::vector<DicomElements>& described_ones,
                       const WrittenFrames& frames, const Hash& of_series, std::vector<std::string>& lost) {
  DicomElements data;
  put_patient_and_study(series.about, data, lost);
  put_equipment(data);
  put_dimensions(made_uid(of_series, "dimensions"), data);
  put_image(series.grid, frames, data);
  put_loss(series, data);
  std::vector<DicomElements> groups, images;
  std::map<int, std::uint32_t> ranks;  // of the slices that have frames
  for (const auto& [number, slice] : frames.of) ranks[slice] = 0;
  for (std::uint32_t next = 1; auto& [slice, rank] : ranks) rank = next++;
  for (const auto& [number, slice] : frames.of) groups.push_back(frame_group(series, number, slice, ranks.at(slice)));
  if (series.headers.size() == 1)
    images.push_back(referenced_image(series, 0, false));
  else
    for (int k = 0; k < series.arrangement.slices; ++k) images.push_back(referenced_image(series, k, false));
  DicomElements referenced;
  referenced.put_items(0x0008114a, images).put(0x0020000e, "UI", series.headers.front().series_uid);
  data.put(0x00080005, "CS", "ISO_IR 192")
      .put(0x00080008, "CS", "DERIVED\\PRIMARY")
      .put(0x00080016, "UI", segmentation_storage)
      .put(0x00080060, "CS", "SEG")
      .put(0x0008103e, "LO", "Segmentation")
      .put_items(0x00081115, {referenced})
      .put(0x0020000e, "UI", made_uid(of_series, "series"))
      .put(0x00200011, "IS", "900")
      .put(0x00200013, "IS", "1")
      .put(0x00201040, "LO", "")
      .put(0x00620001, "CS", frames.full > 0 ? "FRACTIONAL" : "BINARY")
      .put_items(0x00620002, described_ones)
      .put(0x00700080, "CS", "SEGMENTATION")
      .put(0x00700081, "LO", "")
      .put(0x00700084, "PN", "Homolog")
      .put_items(0x52009229, {shared_groups_of(series.grid)})
      .put_items(0x52009230, groups);
  return data;
}

/// Errors: the series lacks what a segmentation refers to.
Result<void> check_series(const fs::path& path, const DicomSeries& series) {
  std::vector<std::string> missing;
  for (const auto& [tag, what] :
       {std::pair(0x0020000dU, "study"), std::pair(0x00200052U, "frame of reference"), std::pair(0x0020000eU, "series"),
        std::pair(0x00080018U, "instance"), std::pair(0x00080016U, "class")})
    if (text_of(series.about, tag).empty()) missing.push_back(std::string("no ") + what);
  if (!missing.empty())
    return fail(path.string(), "names " + listed(missing, " and ") + " (" +
                                   (missing.size() == 1 ? "its UID is" : "their UIDs are") +
                                   " missing), so that no segmentation can refer to it; take the series as the scanner "
                                   "wrote it");
  if (series.arrangement.frames > 1)
    return fail(path.string(),
                "holds several frames, of which a segmentation could not say which it is of; keep the "
                "images of one");
  return {};
}

std::vector<std::string> numbered_anew(const fs::path& path, const std::vector<WrittenSegment>& segments) {
  for (const WrittenSegment& one : segments)
    if (one.number != one.segment.value)
      return {path.string() + ": numbers its segments from 1, as the standard asks, so that " +
              label_words(one.segment) + " is segment " + std::to_string(one.number) +
              (one.number == static_cast<int>(segments.size()) ? "" : ", and so on")};
  return {};
}

}  // namespace

Result<std::vector<std::string>> write_dicom_segmentation(const VolumeRead& map, const fs::path& path,
                                                          const fs::path& series_path, Progress* progress,
                                                          const std::string& series_uid) {
  auto series = read_dicom_series(series_path, progress, map.resampled.has_value(), series_uid);
  if (!series) return fail(series.error());
  if (is_resampled(*series)) series->grid = map.volume.geometry;
  if (auto whole = check_series(series_path, *series); !whole) return fail(whole.error());
  if (map.volume.frames > 1) return fail(path.string(), "cannot hold the frames of a cine; write one frame by itself");
  std::optional<VoxelMapping> mapping = mapping_of(series->grid, map.volume.geometry);
  for (const Volume& layer : map.other_layers)
    if (!same_grid(layer.geometry, map.volume.geometry)) mapping.reset();
  if (!mapping)
    return fail(path.string(), "cannot be written: the label map does not lie on the voxels of " +
                                   series_path.string() + "; resample it to the series, or make it anew on it");
  const double layers = 1 + static_cast<double>(map.other_layers.size());
  if (auto enough = check_memory(path, layers * sizeof(int) * static_cast<double>(series->grid.voxels())); !enough)
    return fail(enough.error());
  const auto segments = segments_to_write(map);
  if (!segments) return fail(path.string(), segments.error().what);
  constexpr std::size_t most_segments = 65535;
  if (segments->empty() || segments->size() > most_segments)
    return fail(path.string(), segments->empty() ? "would hold no segment, since the label map is empty"
                                                 : "cannot hold more than 65,535 segments; choose fewer labels");
  const WrittenFrames frames = frames_to_write(map, *segments, series->grid, *mapping, progress);
  if (progress && progress->cancelled()) return fail(path.string(), "was not written: cancelled");
  if (frames.pixels.size() > std::numeric_limits<std::uint32_t>::max() - 2)
    return fail(path.string(), "would be larger than a DICOM file can be; choose fewer labels");
  Hash of_series = frames.hash;
  add_text(text_of(series->about, 0x0020000d), of_series);
  add_text(series->headers.front().series_uid, of_series);
  std::vector<std::string> lost;
  std::vector<std::string> about_segments;
  const auto described = described_segments(path, *segments, about_segments);
  DicomElements data = data_set(*series, described, frames, of_series, lost);
  if (auto holds = data.check(); !holds) return fail(path.string(), holds.error().what);
  Hash of_all = of_series;
  add_text(data.bytes(), of_all);
  const std::string instance = made_uid(of_all, "instance");
  data.put(0x00080018, "UI", instance).put(0x7fe00010, "OB", frames.pixels);
  DicomElements meta;
  meta.put(0x00020001, "OB", std::string("\0\1", 2))
      .put(0x00020002, "UI", segmentation_storage)
      .put(0x00020003, "UI", instance)
      .put(0x00020010, "UI", "1.2.840.10008.1.2.1")
      .put(0x00020012, "UI", made_uid({}, "Homolog"));
  const std::string head = meta.bytes();
  DicomElements length;
  length.put_longs(0x00020000, {static_cast<std::uint32_t>(head.size())});
  const std::string content = std::string(128, '\0') + "DICM" + length.bytes() + head + data.bytes();
  if (auto written = write_whole_file(path, content); !written) return fail(written.error());
  std::vector<std::string> warnings = lost_texts(path, *series, lost);
  warnings.insert(warnings.end(), about_segments.begin(), about_segments.end());
  if (frames.full == 0)
    for (std::string& one : numbered_anew(path, *segments)) warnings.push_back(std::move(one));
  constexpr double equal = 1e-6;
  if (frames.rounded > equal)
    warnings.push_back(path.string() +
                       ": keeps shares in 255ths, as DICOM does, so that they changed by up to 0.002; write a .nrrd to "
                       "keep them as they are");
  return warnings;
}

}  // namespace homolog
