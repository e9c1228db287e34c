#include <nifti2_io.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>

#include "core/base/files/files.h"
#include "core/volume/formats/formats.h"
#include "core/volume/formats/write_nifti.h"
#include "core/volume/labels/label_tables.h"
#include "core/volume/length_units.h"
#include "core/volume/readers.h"

// NIfTI-1 and -2 through libnifti2. Its header conversion is used on bytes that were read here, never its search for
// files: asked for a.nii.gz it opens a sibling a.nii. ITK's NIfTI reader is not linked, since the libnifti that it
// carries exports the names of libnifti2 with other structures.
namespace homolog {
namespace fs = std::filesystem;

namespace {

struct NiftiImageDeleter {
  void operator()(nifti_image* image) const { nifti_image_free(image); }
};
using NiftiImage = std::unique_ptr<nifti_image, NiftiImageDeleter>;

/// The header converted, and whether the voxels have the other byte order.
struct NiftiHeader {
  NiftiImage image;
  bool other_byte_order = false;
  bool analyze = false;     ///< the older format, which says nothing of the patient
  std::size_t bytes = 0;    ///< the header's own bytes
  double voxels_begin = 0;  ///< as the header says: vox_offset
  bool sized = true;        ///< it says how large a voxel is
  bool scale_is_finite = true;
  double analyze_scale = 1;    ///< the older format's scale, as SPM keeps it there
  double analyze_unit_mm = 1;  ///< the unit of the older format, which is a word
  int bits = 0;                ///< bits of a voxel, as it says; 0 where it does not
};

/// The two files of a pair by the name of either; for a single file both are that file.
struct Pair {
  fs::path header, voxels;
};

Result<Pair> find_pair(const fs::path& path) {
  const std::string name = path.string();
  for (const char* end : {".hdr", ".hdr.gz", ".img", ".img.gz"}) {
    if (!name.ends_with(end)) continue;
    const std::string stem = name.substr(0, name.size() - std::strlen(end));
    const bool given_header = std::string(end).starts_with(".hdr");
    const bool compressed = std::string_view(end).ends_with(".gz");
    const std::string partner = stem + (given_header ? ".img" : ".hdr");
    for (const std::string& candidate : {partner + (compressed ? ".gz" : ""), partner + (compressed ? "" : ".gz")})
      if (std::error_code ignored; fs::exists(candidate, ignored))
        return given_header ? Pair{path, candidate} : Pair{candidate, path};
    return fail(name, "has no partner " + fs::path(partner).filename().string() +
                          (given_header ? " with its voxels" : " with its header") + "; put it into the same folder");
  }
  return Pair{path, path};
}

template <class Header>
Header header_from(const std::string& head) {
  Header header;
  std::memcpy(&header, head.data(), sizeof header);
  return header;
}

/// libnifti prints what it dislikes, so that dims and type are looked at before it sees them.
template <class Header>
bool plausible(const Header& header) {
  if (header.dim[0] < 1 || header.dim[0] > 7 || !nifti_is_valid_datatype(header.datatype)) return false;
  return std::all_of(header.dim + 1, header.dim + 1 + header.dim[0], [](auto n) { return n > 0; });
}

/// Takes out where the voxels begin, which libnifti would round and move without a word.
template <class Header>
double take_voxels_begin(Header& header) {
  const auto begin = static_cast<double>(header.vox_offset);
  header.vox_offset = 0;
  return begin;
}

/// Negative and missing voxel sizes are mended as nibabel does; their sign carries no meaning. False where one is
/// missing.
template <class Header>
bool mend_pixdim(Header& header) {
  bool sized = true;
  for (int d = 1; d <= 3; ++d) {
    header.pixdim[d] = std::abs(header.pixdim[d]);
    const bool given = std::isfinite(header.pixdim[d]) && header.pixdim[d] > 0;
    sized = sized && (given || d > header.dim[0] || header.dim[d] == 1);
  }
  return sized;
}

/// Takes what is read of a header here and not by libnifti.
template <class Header>
void take_header_over(Header& header, NiftiHeader& result) {
  result.sized = mend_pixdim(header);
  result.bits = header.bitpix;
  // A slope that is NaN, which nibabel writes, or 0 says that there is none.
  const bool scaled = !std::isnan(header.scl_slope) && header.scl_slope != 0;
  result.scale_is_finite =
      !scaled || (std::isfinite(header.scl_slope) && (result.analyze || std::isfinite(header.scl_inter)));
  // SPM's scale factor lies where NIfTI keeps its slope. Other programs leave 0 there.
  if (scaled && result.analyze) result.analyze_scale = static_cast<double>(header.scl_slope);
  result.bytes = sizeof header;
  result.voxels_begin = take_voxels_begin(header);
}

std::optional<NiftiHeader> parse_nifti_header(const std::string& head, const fs::path& path) {
  NiftiHeader result;
  std::int32_t size = 0;
  if (head.size() < sizeof(nifti_1_header)) return {};
  std::memcpy(&size, head.data(), sizeof size);
  std::int32_t swapped_size = size;
  nifti_swap_4bytes(1, &swapped_size);
  const std::string name = path.string();
  if (size == sizeof(nifti_1_header) || swapped_size == sizeof(nifti_1_header)) {
    auto header = header_from<nifti_1_header>(head);
    result.other_byte_order = size != sizeof(nifti_1_header);
    result.analyze = std::memcmp(header.magic, "n+1", 4) != 0 && std::memcmp(header.magic, "ni1", 4) != 0;
    if (result.other_byte_order)
      result.analyze ? nifti_swap_as_analyze(reinterpret_cast<nifti_analyze75*>(&header))
                     : nifti_swap_as_nifti1(&header);
    if (!plausible(header)) return {};
    take_header_over(header, result);
    constexpr std::size_t units_at = 56, units_bytes = 4;
    if (result.analyze) result.analyze_unit_mm = mm_per_unit(head.substr(units_at, units_bytes).c_str()).value_or(1);
    result.image.reset(nifti_convert_n1hdr2nim(header, name.c_str()));
  } else if (size == sizeof(nifti_2_header) || swapped_size == sizeof(nifti_2_header)) {
    if (head.size() < sizeof(nifti_2_header)) return {};
    auto header = header_from<nifti_2_header>(head);
    result.other_byte_order = size != sizeof(nifti_2_header);
    if (result.other_byte_order) nifti_swap_as_nifti2(&header);
    if (!plausible(header)) return {};
    take_header_over(header, result);
    result.image.reset(nifti_convert_n2hdr2nim(header, name.c_str()));
  }
  if (!result.image) return {};
  return result;
}

/// The begin of the voxels in their file [nifti1.h, "vox_offset"]. In a single file that is behind the header and the
/// four bytes that tell of extensions. libnifti (and with it ITK) reads from byte 348 where a header says less, so that
/// all voxels are shifted; nibabel refuses. A header that is wrong here gives no other hint, so that it is refused.
Result<std::uintmax_t> voxels_begin(const NiftiHeader& header, const Pair& pair) {
  const double begin = header.voxels_begin;
  const bool single = pair.header == pair.voxels;
  const double least = single ? static_cast<double>(header.bytes + 4) : 0;
  constexpr double most = 1e15;
  if (begin >= least && begin <= most && begin == std::floor(begin)) return static_cast<std::uintmax_t>(begin);
  char number[32];
  std::snprintf(number, sizeof number, "%g", begin);
  return fail(pair.header.string(),
              std::string("says that its voxels begin at byte ") + number +
                  (begin >= 0 && begin < least ? ", within its own header" : ", which is impossible") +
                  "; export it again");
}

Result<Scalar> stored_nifti_type(const nifti_image& image, const fs::path& path) {
  switch (image.datatype) {
    case NIFTI_TYPE_UINT8:
      return Scalar::uint8;
    case NIFTI_TYPE_INT8:
      return Scalar::int8;
    case NIFTI_TYPE_UINT16:
      return Scalar::uint16;
    case NIFTI_TYPE_INT16:
      return Scalar::int16;
    case NIFTI_TYPE_UINT32:
      return Scalar::uint32;
    case NIFTI_TYPE_INT32:
      return Scalar::int32;
    case NIFTI_TYPE_UINT64:
      return Scalar::uint64;
    case NIFTI_TYPE_INT64:
      return Scalar::int64;
    case NIFTI_TYPE_FLOAT32:
      return Scalar::float32;
    case NIFTI_TYPE_FLOAT64:
      return Scalar::float64;
    default:
      return fail(path.string(), std::string("holds voxels of type ") + nifti_datatype_to_string(image.datatype) +
                                     " (colour, complex or extended); export one scalar channel");
  }
}

struct Affine {
  Mat3 steps;
  Vec3 origin;
};

Affine to_lps(const nifti_dmat44& ras, double mm_per_unit) {
  Affine affine;
  for (int row = 0; row < 3; ++row) {
    const double sign = row < 2 ? -mm_per_unit : mm_per_unit;
    for (int column = 0; column < 3; ++column) affine.steps(row, column) = sign * ras.m[row][column];
    affine.origin[row] = sign * ras.m[row][3];
  }
  return affine;
}

double mm_per_nifti_unit(int units) {
  return units == NIFTI_UNITS_METER ? 1e3 : units == NIFTI_UNITS_MICRON ? 1e-3 : 1;
}

double seconds_per_nifti_unit(int units) {
  switch (units) {
    case NIFTI_UNITS_MSEC:
      return 1e-3;
    case NIFTI_UNITS_USEC:
      return 1e-6;
    case NIFTI_UNITS_SEC:
    case NIFTI_UNITS_UNKNOWN:
      return 1;
    default:
      return 0;  // hertz, ppm, radians: the fourth axis is not time
  }
}

/// The sform where it is given and at right angles, else the qform [nifti1.h, methods 3 and 2]. nibabel prefers the
/// sform likewise; ITK falls back to the qform where the sform is sheared. Without either, the axes are taken for LPS
/// with the origin at the first voxel, as ITK does.
Result<VolumeGeometry> geometry_of(const NiftiHeader& header, const fs::path& path,
                                   std::vector<std::string>& warnings) {
  const nifti_image& image = *header.image;
  const std::array<std::int64_t, 3> dims{image.nx, image.ny, image.nz};
  const double scale = header.analyze ? header.analyze_unit_mm : mm_per_nifti_unit(image.xyz_units);
  const Affine qform = to_lps(image.qto_xyz, scale), sform = to_lps(image.sto_xyz, scale);
  const bool has_qform = image.qform_code > 0 && !header.analyze;
  if (image.sform_code > 0 && !header.analyze) {
    auto by_sform = make_geometry(path, dims, sform.steps, sform.origin);
    if (by_sform || !has_qform) return by_sform;
    auto by_qform = make_geometry(path, dims, qform.steps, qform.origin);
    if (!by_qform) return by_sform;
    warnings.push_back(path.string() + ": its sform is sheared or damaged, so its qform was used");
    return by_qform;
  }
  if (!header.sized) warnings.push_back(path.string() + ": does not say how large a voxel is; 1 mm is assumed");
  if (has_qform) return make_geometry(path, dims, qform.steps, qform.origin);
  warnings.push_back(path.string() +
                     ": does not give the patient's orientation; its axes are assumed to run to the "
                     "left, back and head");
  return make_geometry(path, dims, scale * Vec3(image.dx, image.dy, image.dz).asDiagonal().toDenseMatrix(),
                       Vec3::Zero());
}

/// The scale factor that SPM writes into Analyze headers, which other programs ignore.
Rescale analyze_rescale(const NiftiHeader& header, const fs::path& path, std::vector<std::string>& warnings) {
  if (header.analyze_scale == 1) return {};
  char factor[32];
  std::snprintf(factor, sizeof factor, "%g", header.analyze_scale);
  warnings.push_back(path.string() + ": its values are multiplied by " + factor +
                     ", the scale factor of SPM's Analyze header; programs that do not know it show others");
  return {header.analyze_scale, 0};
}

/// The names of labels in the extensions behind the header [nifti1.h, "extender"]: in XML (Caret, TotalSegmentator), or
/// JSON. What they claim of their size is bounded by where the voxels begin.
Segmentation names_in_extensions(const NiftiHeader& header, const Pair& pair) {
  constexpr double most_bytes = 1 << 22;
  const bool single = pair.header == pair.voxels;
  const double end = single ? std::min(header.voxels_begin, most_bytes) : most_bytes;
  constexpr std::size_t extender = 4, size_and_code = 8;
  std::size_t at = header.bytes + extender;
  if (!(end > static_cast<double>(at))) return {};
  const auto head = read_head(pair.header, static_cast<std::size_t>(end));
  if (!head || head->size() < at || (*head)[header.bytes] == 0) return {};
  while (at + size_and_code <= head->size()) {
    std::int32_t size = 0;
    std::memcpy(&size, head->data() + at, sizeof size);
    if (header.other_byte_order) nifti_swap_4bytes(1, &size);
    if (size < static_cast<std::int32_t>(size_and_code)) break;
    const std::string_view text =
        std::string_view(*head).substr(at + size_and_code, static_cast<std::size_t>(size) - size_and_code);
    Segmentation names = labels_of_xml(text);
    const auto last = text.find_last_not_of(std::string_view(" \t\r\n\0", 5));
    if (text.starts_with('{') && last != text.npos)
      if (auto read = labels_of_json(text.substr(0, last + 1))) names = std::move(*read);
    if (!names.segments.empty()) return names;
    at += static_cast<std::size_t>(size);
  }
  return {};
}

Result<VolumeRead> read_nifti(const fs::path& path, const VolumeReadOptions& options) {
  const auto pair = find_pair(path);
  if (!pair) return fail(pair.error());
  const auto head = read_head(pair->header, sizeof(nifti_2_header));
  if (!head) return fail(head.error());
  const auto header = parse_nifti_header(*head, pair->header);
  if (!header)
    return fail(pair->header.string(),
                "is not a NIfTI file, or its header is damaged; check what it is and export it again");
  const nifti_image& image = *header->image;
  if (image.nu > 1 || image.nv > 1 || image.nw > 1)
    return fail(path.string(),
                "has more than four dimensions (vectors or several channels); export one scalar volume, "
                "or a series of frames in the fourth");
  const auto type = stored_nifti_type(image, path);
  if (!type) return fail(type.error());
  if (header->bits != 0 && header->bits != 8 * image.nbyper)
    return fail(pair->header.string(), "says that its voxels are of type " +
                                           std::string(nifti_datatype_to_string(image.datatype)) + " and have " +
                                           std::to_string(header->bits) + " bits; export it again");

  VolumeRead result;
  Volume& volume = result.volume;
  auto geometry = geometry_of(*header, path, result.warnings);
  if (!geometry) return fail(geometry.error());
  volume.geometry = *geometry;
  if (image.nt > 1) volume.frame_seconds = std::max(0.0, image.dt * seconds_per_nifti_unit(image.time_units));
  const std::int64_t frames = std::max<std::int64_t>(image.nt, 1);
  if (frames > std::numeric_limits<int>::max()) return fail(path.string(), "claims more frames than there can be");
  volume.frames = static_cast<int>(frames);
  if (options.without_voxels) return result;
  Rescale rescale;
  if (!header->scale_is_finite)
    return fail(pair->header.string(), "scales its voxels by a number that is not finite; export it again");
  if (std::isfinite(image.scl_slope) && image.scl_slope != 0 && std::isfinite(image.scl_inter))
    rescale = {image.scl_slope, image.scl_inter};
  if (header->analyze) rescale = analyze_rescale(*header, path, result.warnings);

  const auto begin = voxels_begin(*header, *pair);
  if (!begin) return fail(begin.error());
  const VoxelRun run{
      {{.file = pair->voxels, .skip = *begin, .compression = compression_of(pair->voxels), .ends_file = true}},
      *type,
      header->other_byte_order};
  auto stored = read_run(run, volume.geometry, frames, !rescale.identity(), options.progress);
  if (!stored) return fail(stored.error());
  if (auto kept = keep_voxels(std::move(*stored), rescale, path.string(), volume, result.warnings); !kept)
    return fail(kept.error());
  if (!header->analyze) result.segmentation = names_in_extensions(*header, *pair);
  return result;
}

}  // namespace

const VolumeFormat formats::nifti{
    .name = "NIfTI",
    .endings = {".nii.gz", ".nii", ".hdr", ".hdr.gz", ".img", ".img.gz"},
    .written = {".nii.gz", ".nii"},
    .note = "version 1 and 2, also as pairs of header and voxels; the fourth dimension as frames",
    .read = read_nifti,
    .write = write_nifti};

}  // namespace homolog
