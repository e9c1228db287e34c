#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/files/file_record.h"
#include "core/base/files/files.h"
#include "core/volume/formats/formats.h"
#include "core/volume/labels/named_labels.h"
#include "core/volume/readers.h"
#include "core/volume/write_voxels.h"

// FreeSurfer's MGH [FreeSurfer wiki, MghFormat]: a header of 284 bytes with the most significant byte first, then the
// voxels. MGZ is the same in gzip.
namespace homolog {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t mgh_header_bytes = 284;

struct MghHeader {
  std::array<std::int64_t, 3> dims{};
  std::int64_t frames = 0;
  int type = 0;
  bool placed = false;  ///< else axes and place are those that FreeSurfer assumes
  std::array<float, 3> spacing_mm{};
  std::array<float, 12> place{};  ///< directions of the axes, then the centre; in RAS
};

/// Goes through numbers with the most significant byte first. Behind the end all are 0.
class BigEndian {
 public:
  explicit BigEndian(const std::string& bytes) : bytes_(bytes) {}
  std::uint32_t number(std::size_t size) {
    std::uint32_t value = 0;
    for (std::size_t b = 0; b < size; ++b)
      value = value << 8 | (at_ < bytes_.size() ? static_cast<std::uint8_t>(bytes_[at_++]) : 0U);
    return value;
  }
  std::size_t left() const { return bytes_.size() - at_; }
  /// The next bytes up to a 0 in them. Nothing where there are not as many.
  std::optional<std::string> text(std::int64_t bytes) {
    if (bytes < 0 || static_cast<std::uint64_t>(bytes) > left()) return {};
    const std::string whole = bytes_.substr(at_, static_cast<std::size_t>(bytes));
    at_ += static_cast<std::size_t>(bytes);
    return whole.substr(0, whole.find('\0'));
  }
  std::int32_t whole() { return static_cast<std::int32_t>(number(4)); }
  float real() {
    const std::uint32_t bits = number(4);
    float value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }

 private:
  const std::string& bytes_;
  std::size_t at_ = 0;
};

/// Nothing where the file is another.
std::optional<MghHeader> parse_mgh_header(const std::string& bytes) {
  if (bytes.size() < mgh_header_bytes) return {};
  BigEndian in(bytes);
  if (in.whole() != 1) return {};  // version
  MghHeader header;
  for (std::int64_t& n : header.dims) n = in.whole();
  header.frames = in.whole();
  header.type = in.whole();
  in.number(4);  // degrees of freedom
  header.placed = in.number(2) == 1;
  for (float& size : header.spacing_mm) size = in.real();
  for (float& number : header.place) number = in.real();
  return header;
}

/// FreeSurfer's colour table as it is embedded, of either version [FreeSurfer, CTABreadFromBinary]. Nothing where it is
/// cut short or damaged.
std::optional<Segmentation> embedded_table(BigEndian& in) {
  Segmentation labels;
  constexpr std::size_t count_and_length = 8, colour_bytes = 16;
  if (in.left() < count_and_length) return {};
  std::int32_t entries = in.whole();
  const bool numbered = entries < 0;  // the second version says the value of each
  if (numbered && entries != -2) return {};
  if (numbered) in.number(4);  // the largest value
  if (!in.text(in.whole())) return {};
  if (numbered && in.left() < 4) return {};
  if (numbered) entries = in.whole();
  for (std::int32_t k = 0; k < entries; ++k) {
    const std::int32_t value = numbered ? in.whole() : k;
    const auto name = in.text(in.whole());
    if (!name || in.left() < colour_bytes) return {};
    LabelColour colour{};
    for (std::uint8_t& channel : colour) channel = static_cast<std::uint8_t>(std::clamp(in.whole(), 0, 255));
    in.number(4);  // opacity
    if (value <= 0 || name->empty()) continue;
    if (!add_name(value, *name, colour, labels)) return {};
  }
  return labels;
}

/// What lies behind the voxels: five numbers of the scan, then tags, each with its length but for old ones.
struct BehindVoxels {
  Segmentation names;
  bool whole = true;    ///< else a tag is cut short or damaged
  bool voxels = false;  ///< it is no tags: the sizes in the header are smaller than the voxels
};

BehindVoxels read_behind_voxels(const std::string& rest, std::size_t slice_bytes) {
  constexpr std::size_t scan_numbers = 20;
  constexpr std::int32_t table_tag = 1, old_transform_tag = 30, highest_tag = 999;
  if (rest.size() <= scan_numbers) return {};
  const auto is_zero = [](char byte) { return byte == 0; };
  if (std::ranges::all_of(rest, is_zero)) return {.voxels = rest.size() >= slice_bytes};
  BigEndian in(rest);
  in.text(scan_numbers);
  while (in.left() >= 4) {
    const std::int32_t tag = in.whole();
    if (tag == 0)  // the last one
      return {.voxels = in.left() >= slice_bytes ||
                        !std::ranges::all_of(std::string_view(rest).substr(rest.size() - in.left()), is_zero)};
    if (tag < 0 || tag > highest_tag) return {.voxels = true};
    if (tag == table_tag) {
      auto names = embedded_table(in);
      if (!names) return {.whole = false};
      return {.names = std::move(*names)};
    }
    std::int64_t length = in.whole();
    if (tag != old_transform_tag) length = (length << 32) | static_cast<std::int64_t>(in.number(4));
    if (!in.text(length)) return {.whole = false};
  }
  return {};
}

/// Takes the names of labels behind the voxels, which `reals` have none of. Another than FreeSurfer may write what it
/// likes there, so that a plain file is only warned of; a compressed one, whose end is sure, is refused.
Result<void> take_names_behind_voxels(const fs::path& path, std::size_t voxel_bytes, bool reals, VolumeRead& read) {
  constexpr std::uintmax_t most_bytes = 1 << 22;
  const ByteBlock block{.file = path, .skip = mgh_header_bytes + voxel_bytes, .compression = compression_of(path)};
  const auto rest = read_to_end(block, most_bytes);
  const auto& dims = read.volume.geometry.dims;
  const auto longest = static_cast<std::size_t>(std::max(std::ranges::max(dims), read.volume.frames));
  BehindVoxels behind = rest ? read_behind_voxels(*rest, voxel_bytes / longest) : BehindVoxels{.voxels = true};
  if (behind.voxels && block.compression != Compression::None) return fail(path.string(), more_voxels_than_said);
  if (behind.voxels) read.warnings.push_back(path.string() + ": " + more_voxels_than_said);
  if (!behind.whole)
    read.warnings.push_back(
        path.string() +
        ": what lies behind its voxels (names and colours of labels) is cut short or damaged and was "
        "left out; copy or download it again");
  if (!reals && read.volume.frames == 1) read.segmentation = std::move(behind.names);
  return {};
}

std::optional<Scalar> mgh_type(int type) {
  switch (type) {
    case 0:
      return Scalar::uint8;
    case 1:
      return Scalar::int32;
    case 3:
      return Scalar::float32;
    case 4:
      return Scalar::int16;
    case 10:
      return Scalar::uint16;
    default:
      return {};
  }
}

/// The header's place is that of the voxel in the middle: its index is half the number of voxels along each axis.
Result<VolumeGeometry> mgh_geometry(const MghHeader& header, const fs::path& path, std::vector<std::string>& warnings) {
  Mat3 axes;
  Vec3 centre = Vec3::Zero(), spacing_mm = Vec3::Ones();
  axes << -1, 0, 0, 0, 0, 1, 0, -1, 0;
  if (header.placed) {
    for (int a = 0; a < 3; ++a) {
      for (int row = 0; row < 3; ++row) axes(row, a) = static_cast<double>(header.place[3 * a + row]);
      centre[a] = static_cast<double>(header.place[9 + a]);
      spacing_mm[a] = static_cast<double>(header.spacing_mm[a]);
    }
  } else {
    warnings.push_back(path.string() +
                       ": does not give the patient's orientation; that which FreeSurfer assumes is taken, with voxels "
                       "of 1 mm");
  }
  const Mat3 to_lps = Vec3(-1, -1, 1).asDiagonal();
  const Mat3 steps = to_lps * axes * spacing_mm.asDiagonal();
  const Vec3 middle(static_cast<double>(header.dims[0]) / 2, static_cast<double>(header.dims[1]) / 2,
                    static_cast<double>(header.dims[2]) / 2);
  return make_geometry(path, header.dims, steps, to_lps * centre - steps * middle);
}

Result<VolumeRead> read_mgh(const fs::path& path, const VolumeReadOptions& options) {
  const auto head = read_head(path, mgh_header_bytes);
  if (!head) return fail(head.error());
  const auto header = parse_mgh_header(*head);
  if (!header)
    return fail(path.string(), "is not an MGH file, or its header is damaged; check what it is and export it again");
  const auto type = mgh_type(header->type);
  if (!type)
    return fail(path.string(), "holds voxels of MGH type " + std::to_string(header->type) +
                                   ", which are no single numbers; export it as a scalar volume");
  if (header->frames < 1 || header->frames > std::numeric_limits<int>::max())
    return fail(path.string(),
                "claims " + std::to_string(header->frames) + " frames; its header is damaged, export the volume again");
  VolumeRead result;
  auto geometry = mgh_geometry(*header, path, result.warnings);
  if (!geometry) return fail(geometry.error());
  result.volume.geometry = *geometry;
  result.volume.frames = static_cast<int>(header->frames);
  const VoxelRun run{{{.file = path, .skip = mgh_header_bytes, .compression = compression_of(path)}},
                     *type,
                     size_of(*type) > 1 && !native_big_endian()};
  auto stored = read_run(run, result.volume.geometry, header->frames, false, options.progress);
  if (!stored) return fail(stored.error());
  if (auto kept = keep_voxels(std::move(*stored), {}, path.string(), result.volume, result.warnings); !kept)
    return fail(kept.error());
  const std::size_t voxel_bytes =
      size_of(*type) * result.volume.geometry.voxels() * static_cast<std::size_t>(result.volume.frames);
  if (auto taken = take_names_behind_voxels(path, voxel_bytes, *type == Scalar::float32, result); !taken)
    return fail(taken.error());
  return result;
}

/// Bytes of a file, each number with the most significant first.
class BigEndianBytes {
 public:
  void number(std::uint64_t value, std::size_t size) {
    for (std::size_t b = size; b-- > 0;) bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * b) & 255));
  }
  void whole(std::int64_t value) { number(static_cast<std::uint64_t>(value), 4); }
  void real(double value) { number(std::bit_cast<std::uint32_t>(static_cast<float>(value)), 4); }
  /// With its length, and a 0 at its end.
  void text(const std::string& text) {
    whole(std::ssize(text) + 1);
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    bytes_.push_back(0);
  }
  void fill_to(std::size_t size) { bytes_.resize(size); }
  std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// The header of a grid; single precision.
MghHeader mgh_header_of(const VolumeGeometry& grid) {
  MghHeader header;
  header.frames = 1;
  header.placed = true;
  const Vec3 to_ras(-1, -1, 1);
  Vec3 half;
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    header.dims[axis] = grid.dims[axis];
    header.spacing_mm[axis] = static_cast<float>(grid.spacing_mm[a]);
    half[a] = static_cast<double>(grid.dims[axis]) / 2;
    const Vec3 direction = to_ras.cwiseProduct(grid.direction.col(a));
    for (int row = 0; row < 3; ++row)
      header.place[3 * axis + static_cast<std::size_t>(row)] = static_cast<float>(direction[row]);
  }
  const Vec3 centre = to_ras.cwiseProduct(grid.to_mm(half));
  for (int row = 0; row < 3; ++row) header.place[9 + static_cast<std::size_t>(row)] = static_cast<float>(centre[row]);
  return header;
}

/// The table of names in its second version, behind the five numbers of a scan, of which nothing is known.
void add_table(const Segmentation& names, BigEndianBytes& bytes) {
  constexpr int scan_numbers = 5, table_tag = 1, numbered = -2;
  for (int k = 0; k < scan_numbers; ++k) bytes.real(0);
  std::vector<const Segment*> named;
  for (const Segment& segment : names.segments)
    if (segment.value > 0 && !segment.name.empty()) named.push_back(&segment);
  if (named.empty()) return;
  const auto highest = std::ranges::max(named, {}, &Segment::value)->value;
  bytes.whole(table_tag);
  bytes.whole(numbered);
  bytes.whole(static_cast<std::int64_t>(highest) + 1);
  bytes.text("labels");
  bytes.whole(std::ssize(named));
  for (const Segment* const segment : named) {
    bytes.whole(segment->value);
    bytes.text(segment->name);
    for (const std::uint8_t channel : segment->colour.value_or(colour_by_name(segment->name))) bytes.whole(channel);
    bytes.whole(0);  // opaque
  }
}

}  // namespace

Result<void> write_mgh_labels(const Volume& map, const Segmentation& names, const fs::path& path,
                              const std::string& record, Progress* progress) {
  constexpr int byte_type = 0, whole_type = 1;  // which every version of FreeSurfer reads
  if (map.range_min < 0) return fail(path.string(), "is no place for labels below 0; end its name in .nii.gz or .nrrd");
  const MghHeader header = mgh_header_of(map.geometry);
  std::vector<std::string> none;
  const auto read_again = mgh_geometry(header, path, none);
  if (!read_again || !same_grid(*read_again, map.geometry))
    return fail(path.string(), "cannot hold the place of the voxels in single precision; end its name in .nii.gz");
  const bool small = std::holds_alternative<std::vector<std::uint8_t>>(map.data);
  BigEndianBytes bytes;
  bytes.whole(1);  // version
  for (const std::int64_t n : header.dims) bytes.whole(n);
  bytes.whole(header.frames);
  bytes.whole(small ? byte_type : whole_type);
  bytes.whole(0);  // degrees of freedom
  bytes.number(1, 2);
  for (const float size : header.spacing_mm) bytes.real(static_cast<double>(size));
  for (const float number : header.place) bytes.real(static_cast<double>(number));
  bytes.fill_to(mgh_header_bytes);
  std::visit(
      [&](const auto& labels) {
        for (std::size_t v = 0; v < map.geometry.voxels(); ++v)
          bytes.number(static_cast<std::uint64_t>(rounded_label(static_cast<double>(labels[v]))), small ? 1 : 4);
      },
      map.data);
  add_table(names, bytes);
  const VoxelData all = bytes.take();
  auto written = write_whole_file(path, [&](std::ostream& out) -> Result<void> {
    return has_ending(path, {".mgh"}) ? write_plain(out, all, progress) : write_compressed(out, {}, all, progress);
  });
  return written ? write_record_file(path, record) : written;
}

const VolumeFormat formats::mgh{.name = "MGH",
                                .endings = {".mgz", ".mgh", ".mgh.gz"},
                                .written = {},
                                .in_folder = {},
                                .note =
                                    "of FreeSurfer, also compressed; the place of its header (vox2ras), names and "
                                    "colours of an embedded table; label maps are written so, too",
                                .read = read_mgh};

}  // namespace homolog
