#include "core/volume/dicom/dicom_segment_frames.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/base/text/text.h"
#include "core/volume/dicom/dicom_text.h"
#include "core/volume/referenced_images.h"

namespace homolog {

namespace {

namespace seg {
constexpr DicomTag frame_of_reference = 0x00200052, position = 0x00200032, orientation = 0x00200037,
                   pixel_spacing = 0x00280030, thickness = 0x00180050, spacing_between = 0x00180088,
                   padding = 0x00280120, type = 0x00620001, segments = 0x00620002, number = 0x00620004,
                   label = 0x00620005, colour = 0x0062000d, fraction_full = 0x0062000e, tiling = 0x00209311;
// Sequences: of a frame's place on a slide, its place, direction, pixels and segment.
constexpr DicomTag slide_group = 0x0048021a, position_group = 0x00209113, orientation_group = 0x00209116,
                   measures_group = 0x00289110, segment_group = 0x0062000a, referenced_number = 0x0062000b,
                   groups_of_frames = 0x52009230, derivation_group = 0x00089124, source_images = 0x00082112;
}  // namespace seg

std::optional<std::array<double, 3>> three_shorts(const DicomItem& item, DicomTag tag, bool big_endian) {
  const auto found = item.find(tag);
  if (found == item.end() || found->second.value.size() != 6) return {};
  std::array<double, 3> numbers{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto byte = [&](std::size_t b) { return static_cast<unsigned char>(found->second.value[2 * k + b]); };
    numbers[k] = big_endian ? byte(0) * 256.0 + byte(1) : byte(1) * 256.0 + byte(0);
  }
  return numbers;
}

/// CIELab in 16 bits [DICOM PS3.3, C.10.7.1.1] as sRGB. The white point is D65, as DCMTK writes it, on which dcmqi and
/// 3D Slicer are built.
std::array<std::uint8_t, 3> colour_of_lab(const std::array<double, 3>& stored) {
  const double l = stored[0] / 65535 * 100, a = stored[1] / 65535 * 255 - 128, b = stored[2] / 65535 * 255 - 128;
  const double fy = (l + 16) / 116;
  const auto inverse = [](double f) { return f > 6.0 / 29 ? f * f * f : 3 * (6.0 / 29) * (6.0 / 29) * (f - 4.0 / 29); };
  const Vec3 xyz(0.950456 * inverse(fy + a / 500), inverse(fy), 1.088754 * inverse(fy - b / 200));
  Mat3 to_rgb;
  to_rgb << 3.2404542, -1.5371385, -0.4985314, -0.9692660, 1.8760108, 0.0415560, 0.0556434, -0.2040259, 1.0572252;
  const Vec3 rgb = to_rgb * xyz;
  std::array<std::uint8_t, 3> colour{};
  for (int c = 0; c < 3; ++c) {
    const double linear = std::clamp(rgb[c], 0.0, 1.0);
    const double encoded = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
    colour[c] = static_cast<std::uint8_t>(std::lround(255 * encoded));
  }
  return colour;
}

/// The colour of each value in a palette [DICOM PS3.3, C.7.6.3.1.5]; label maps may give their colours so.
std::optional<std::array<std::uint8_t, 3>> palette_colour(const DicomItem& data, int value, bool big_endian) {
  constexpr std::array<DicomTag, 3> descriptors{0x00281101, 0x00281102, 0x00281103},
      tables{0x00281201, 0x00281202, 0x00281203};
  std::array<std::uint8_t, 3> colour{};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto about = three_shorts(data, descriptors[c], big_endian);
    const auto table = data.find(tables[c]);
    if (!about || table == data.end()) return {};
    const double entries = (*about)[0] == 0 ? 65536 : (*about)[0], at = value - (*about)[1];
    if (at < 0 || at >= entries) return {};
    const std::size_t bytes = (*about)[2] > 8 ? 2 : 1, index = static_cast<std::size_t>(at) * bytes;
    if (index + bytes > table->second.value.size()) return {};
    // The upper byte tells, and a table of single bytes lies as it does in little-endian words.
    colour[c] = static_cast<std::uint8_t>(table->second.value[index + (bytes == 2 && !big_endian ? 1 : 0)]);
  }
  return colour;
}

/// The segments that the file describes, by number. `warnings`: names that cannot be read.
Result<std::vector<Segment>> described_segments(const DicomSet& set, std::vector<std::string>& warnings) {
  Segmentation known;
  const DicomAlphabets alphabets(set.elements);
  bool unread = false;
  const std::string name = set.path.string();
  for (std::size_t k = 0;; ++k) {
    const DicomItem* item = item_of(set.elements, seg::segments, k);
    if (item == nullptr) break;
    const auto number = binary_number_of(*item, seg::number, set.big_endian);
    if (!number || *number < 0 || *number > 65535)
      return fail(name, "describes a segment without a number; export it again");
    Segment segment{.name = alphabets.name_of(*item, seg::label, unread), .value = static_cast<int>(*number)};
    if (const auto lab = three_shorts(*item, seg::colour, set.big_endian)) segment.colour = colour_of_lab(*lab);
    if (!segment.colour) segment.colour = palette_colour(set.elements, segment.value, set.big_endian);
    const bool twice = known.find(segment.value, 0) != nullptr;
    if (!known.add(std::move(segment)) && !twice)
      return fail(name, "describes more than 16,384 segments, the most that are read; export fewer of them");
    if (twice)
      return fail(name, "describes its segment " + std::to_string(static_cast<int>(*number)) +
                            " twice; export it again with a number for each");
  }
  if (known.segments.empty()) return fail(name, "describes no segments; export it again");
  if (unread) warnings.push_back(unread_names(name, alphabets));
  return known.segments;
}

Result<SegmentFrames::Kind> kind_of(const DicomSet& set) {
  const std::string type = text_of(set.elements, seg::type);
  if (type == "BINARY") return SegmentFrames::Kind::binary;
  if (type == "FRACTIONAL") return SegmentFrames::Kind::fractional;
  if (type == "LABELMAP") return SegmentFrames::Kind::label_map;
  return fail(set.path.string(), "is a segmentation of the type \"" + excerpt(type) +
                                     "\", which is not known; export it as a binary one or a label map");
}

/// The segment of each frame. Errors: one that is not described.
Result<std::vector<int>> numbers_of_frames(const DicomSet& set, const SegmentFrames& frames, std::size_t count) {
  std::vector<int> numbers(count);
  if (frames.kind == SegmentFrames::Kind::label_map) return numbers;
  for (std::size_t f = 0; f < count; ++f) {
    const auto number =
        binary_number_of(aspect_of(set.elements, f, seg::segment_group), seg::referenced_number, set.big_endian);
    if (!number && frames.segments.size() > 1)
      return fail(set.path.string(),
                  "does not say to which segment its frame " + std::to_string(f + 1) + " belongs; export it again");
    numbers[f] = number ? static_cast<int>(*number) : frames.segments.front().value;
    if (std::none_of(frames.segments.begin(), frames.segments.end(),
                     [&](const Segment& segment) { return segment.value == numbers[f]; }))
      return fail(set.path.string(), "refers in its frame " + std::to_string(f + 1) + " to segment " +
                                         std::to_string(numbers[f]) + ", which it does not describe; export it again");
  }
  return numbers;
}

/// Six numbers of a direction, made unit vectors; nothing where they are none.
std::optional<std::pair<Vec3, Vec3>> axes_of(const std::vector<double>& numbers) {
  if (numbers.size() != 6) return {};
  const Vec3 columns(numbers[0], numbers[1], numbers[2]), rows(numbers[3], numbers[4], numbers[5]);
  if (!(columns.norm() > 0.5 && rows.norm() > 0.5)) return {};
  return std::pair(columns.normalized(), rows.normalized());
}

/// The image that a frame was made of [named_image]; empty where it names none, or several.
std::string source_of(const DicomItem& data, std::size_t frame) {
  std::string name;
  const DicomItem* derivation = own_aspect(data, frame, seg::derivation_group);
  for (std::size_t k = 0; derivation != nullptr; ++k) {
    const DicomItem* image = item_of(*derivation, seg::source_images, k);
    if (image == nullptr) break;
    const std::string own = named_image(*image);
    if (k > 0 && own != name) return {};
    name = own;
  }
  return name;
}

/// Errors: the place, direction or pixel size of a frame is missing, or differs where all have to be alike.
Result<PlacedFrames> placed_frames(const DicomSet& set, const DicomHeader& header) {
  const DicomItem& data = set.elements;
  const std::string name = set.path.string();
  PlacedFrames placed;
  placed.columns = header.columns;
  placed.rows = header.rows;
  for (std::size_t f = 0; f < header.planes.size(); ++f) {
    const auto p = numbers_of(aspect_of(data, f, seg::position_group), seg::position);
    const auto axes = axes_of(numbers_of(aspect_of(data, f, seg::orientation_group), seg::orientation));
    const DicomItem& measures = aspect_of(data, f, seg::measures_group);
    const auto spacing = numbers_of(measures, seg::pixel_spacing);
    const bool sized = spacing.size() == 2 && spacing[0] > 0 && spacing[1] > 0;
    if (p.size() != 3 || !axes || !sized) {
      if (item_of(data, 0x00480008, 0) != nullptr || own_aspect(data, f, seg::slide_group) != nullptr)
        return fail(name,
                    "is the segmentation of a slide of microscopy, which has no place in a patient; export a "
                    "segmentation of a scan");
      return fail(name,
                  "does not say where its frame " + std::to_string(f + 1) +
                      " lies (its position, direction or pixel size is missing); export it again with its series");
    }
    const std::pair pixel(spacing[1], spacing[0]);
    if (f == 0) {
      placed.axes = *axes;
      placed.pixel_mm = pixel;
      const auto length = [&](DicomTag tag) {
        auto number = number_of(measures, tag);
        if (number) *number = std::abs(*number);
        return number && *number > 0 ? number : std::nullopt;
      };
      placed.spacing_mm = length(seg::spacing_between);
      placed.thickness_mm = length(seg::thickness);
    }
    constexpr double same_direction = 1e-4, same_mm = 1e-5;
    if ((axes->first - placed.axes.first).norm() > same_direction ||
        (axes->second - placed.axes.second).norm() > same_direction ||
        std::abs(pixel.first - placed.pixel_mm.first) > same_mm ||
        std::abs(pixel.second - placed.pixel_mm.second) > same_mm)
      return fail(name, "mixes frames of different directions or pixel sizes (1 and " + std::to_string(f + 1) +
                            "); export each as a segmentation of its own");
    placed.positions_mm.emplace_back(p[0], p[1], p[2]);
    placed.images.push_back(source_of(data, f));
  }
  return placed;
}

/// How many bytes frames of single bits take: behind one another, or each from a byte of its own on.
struct BytesOfBits {
  std::uint64_t joined = 0, apart = 0;

  explicit BytesOfBits(const DicomHeader& header) {
    const std::uint64_t frames = header.planes.size();
    const auto pixels = static_cast<std::uint64_t>(header.rows) * static_cast<std::uint64_t>(header.columns);
    joined = (frames * pixels + 7) / 8;
    apart = frames * ((pixels + 7) / 8);
  }
};

/// Whether bits that are not encoded are too many to lie behind one another [DICOM PS3.5, 8.1.1], and as many as they
/// are where each frame begins with a byte of its own. A last byte may be there to make their number even.
bool begin_bytes(const DicomHeader& header) {
  if (header.bits_allocated != 1 || !header.pixels->fragments.empty()) return false;
  const BytesOfBits bytes(header);
  return header.pixels->bytes > bytes.joined + 1 && header.pixels->bytes == bytes.apart + bytes.apart % 2;
}

/// Errors: frames, their descriptions and their pixels are not equally many.
Result<void> check_count(const DicomSet& set, const DicomHeader& header) {
  const std::size_t frames = header.planes.size();
  std::size_t groups = 0;
  while (item_of(set.elements, seg::groups_of_frames, groups) != nullptr) ++groups;
  if (groups == 0 && frames > 0 && text_of(set.elements, seg::tiling) == "TILED_FULL")
    return fail(
        set.path.string(),
        "is tiled (TILED_FULL), as segmentations of slides of microscopy are, which is not read; export it with "
        "the place in the patient of each frame");
  if (groups != frames && (groups > 0 || frames > 1))
    return fail(set.path.string(), "has " + std::to_string(frames) + (frames == 1 ? " frame" : " frames") +
                                       " and describes " + std::to_string(groups) +
                                       " (functional groups), so that it does not tell which lies where; export it "
                                       "again");
  if (!header.pixels->fragments.empty() || begin_bytes(header)) return {};
  // A last byte may be there to make their number even.
  const double bits = static_cast<double>(header.rows) * header.columns * header.bits_allocated;
  const double held = std::floor(8 * (static_cast<double>(header.pixels->bytes) - 1) / bits);
  if (held > static_cast<double>(frames))
    return fail(set.path.string(), "says that it has " + std::to_string(frames) + (frames == 1 ? " frame" : " frames") +
                                       ", and has the pixels of " + std::to_string(static_cast<long>(held)) +
                                       "; export it again");
  if (const BytesOfBits bytes(header);
      header.bits_allocated == 1 && bytes.apart != bytes.joined && header.pixels->bytes > bytes.joined + 1)
    return fail(set.path.string(), "holds " + std::to_string(header.pixels->bytes) + " bytes of pixels, where its " +
                                       std::to_string(frames) + (frames == 1 ? " frame takes " : " frames take ") +
                                       std::to_string(bytes.joined) +
                                       ", so that it does not tell where each begins; export it again");
  return {};
}

}  // namespace

Result<SegmentFrames> segment_frames(const DicomSet& set, const DicomHeader& header) {
  const std::string name = set.path.string();
  if (auto alike = check_count(set, header); !alike) return fail(alike.error());
  if (text_of(set.elements, seg::frame_of_reference).empty() && item_of(set.elements, 0x00480008, 0) == nullptr)
    return fail(name,
                "names no frame of reference, so that its place in the patient is not known; export it again from "
                "the series that it was drawn on");
  SegmentFrames frames;
  const auto kind = kind_of(set);
  if (!kind) return fail(kind.error());
  frames.kind = *kind;
  frames.begin_bytes = begin_bytes(header);
  if (frames.begin_bytes)
    frames.warnings.push_back(name +
                              ": each of its frames begins with a byte of its own, which DICOM does not allow; it was "
                              "read so, since its pixels take as many bytes");
  auto segments = described_segments(set, frames.warnings);
  if (!segments) return fail(segments.error());
  frames.segments = std::move(*segments);
  if (frames.kind == SegmentFrames::Kind::fractional) {
    frames.full = binary_number_of(set.elements, seg::fraction_full, set.big_endian).value_or(0);
    if (!(frames.full > 0))
      return fail(name,
                  "does not say which value stands for a whole voxel (maximum fractional value); export it again");
  }
  frames.background = static_cast<int>(binary_number_of(set.elements, seg::padding, set.big_endian).value_or(0));
  auto numbers = numbers_of_frames(set, frames, header.planes.size());
  if (!numbers) return fail(numbers.error());
  frames.numbers = std::move(*numbers);
  auto placed = placed_frames(set, header);
  if (!placed) return fail(placed.error());
  frames.placed = std::move(*placed);
  return frames;
}

}  // namespace homolog
