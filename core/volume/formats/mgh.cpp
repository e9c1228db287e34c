#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string>

#include "core/volume/formats/formats.h"
#include "core/volume/labels/named_labels.h"
#include "core/volume/readers.h"

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

/// FreeSurfer's colour table as it is embedded, of either version [FreeSurfer, CTABreadFromBinary].
Segmentation embedded_table(BigEndian& in) {
  Segmentation labels;
  std::int32_t entries = in.whole();
  const bool numbered = entries < 0;  // the second version says the value of each
  if (numbered && entries != -2) return {};
  if (numbered) in.number(4);  // the largest value
  if (!in.text(in.whole())) return {};
  if (numbered) entries = in.whole();
  for (std::int32_t k = 0; k < entries && in.left() > 0; ++k) {
    const std::int32_t value = numbered ? in.whole() : k;
    const auto name = in.text(in.whole());
    if (!name) return {};
    LabelColour colour{};
    for (std::uint8_t& channel : colour) channel = static_cast<std::uint8_t>(std::clamp(in.whole(), 0, 255));
    in.number(4);  // opacity
    if (value <= 0 || name->empty()) continue;
    if (!add_name(value, *name, colour, labels)) return {};
  }
  return labels;
}

/// The names of labels behind the voxels: five numbers of the scan, then tags, each with its length but for old ones.
Segmentation names_behind_voxels(const fs::path& path, std::size_t voxel_bytes) {
  constexpr std::uintmax_t most_bytes = 1 << 22;
  constexpr std::size_t scan_numbers = 20;
  constexpr std::int32_t table_tag = 1, old_transform_tag = 30;
  const auto rest = read_to_end(
      {.file = path, .skip = mgh_header_bytes + voxel_bytes, .compression = compression_of(path)}, most_bytes);
  if (!rest || rest->size() <= scan_numbers) return {};
  BigEndian in(*rest);
  in.text(scan_numbers);
  while (in.left() >= 8) {
    const std::int32_t tag = in.whole();
    if (tag == table_tag) return embedded_table(in);
    std::int64_t length = in.whole();
    if (tag != old_transform_tag) length = (length << 32) | static_cast<std::int64_t>(in.number(4));
    if (!in.text(length)) return {};
  }
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
      for (int row = 0; row < 3; ++row)
        axes(row, a) = static_cast<double>(header.place[static_cast<std::size_t>(3 * a + row)]);
      centre[a] = static_cast<double>(header.place[static_cast<std::size_t>(9 + a)]);
      spacing_mm[a] = static_cast<double>(header.spacing_mm[static_cast<std::size_t>(a)]);
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
  if (*type != Scalar::float32 && header->frames == 1)
    result.segmentation = names_behind_voxels(path, size_of(*type) * result.volume.geometry.voxels());
  return result;
}

}  // namespace

const VolumeFormat formats::mgh{
    .name = "MGH",
    .endings = {".mgz", ".mgh", ".mgh.gz"},
    .written = {},
    .in_folder = {},
    .note = "of FreeSurfer, also compressed; the place of its header (vox2ras), names and colours of an embedded table",
    .read = read_mgh};

}  // namespace homolog
