#include <nifti2_io.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <limits>
#include <sstream>

#include "core/base/files.h"
#include "core/volume/readers.h"

// The headers written here are a dozen lines each; writing them through streams, unlike through the libraries, tells of
// a full disk. NIfTI's header is libnifti2's.
namespace homolog {
namespace fs = std::filesystem;

namespace {

using Bytes = std::span<const std::byte>;

Bytes bytes_of(const VoxelData& data) {
  return std::visit([](const auto& values) { return std::as_bytes(std::span(values)); }, data);
}

void write_bytes(std::ostream& out, Bytes bytes) {
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

/// The voxels in pieces, each handed to `write`. Errors: cancelled.
template <class Write>
Result<void> in_pieces(const VoxelData& data, Progress* progress, const Write& write) {
  constexpr std::size_t piece = std::size_t{4} << 20;
  const Bytes all = bytes_of(data);
  for (std::size_t at = 0; at < all.size(); at += piece) {
    write(all.subspan(at, std::min(piece, all.size() - at)));
    if (progress == nullptr) continue;
    progress->report(static_cast<double>(at) / static_cast<double>(all.size()));
    if (progress->cancelled()) return fail("", "was not written, since that was cancelled");
  }
  return {};
}

/// One gzip stream made of several pieces.
class GzipWriter {
 public:
  explicit GzipWriter(std::ostream& out) : out_(out), chunk_(std::size_t{256} << 10) {
    constexpr int gzip = 15 + 16, fast = 3, memory = 8;
    ready_ = deflateInit2(&stream_, fast, Z_DEFLATED, gzip, memory, Z_DEFAULT_STRATEGY) == Z_OK;
  }
  ~GzipWriter() { deflateEnd(&stream_); }
  GzipWriter(const GzipWriter&) = delete;
  GzipWriter& operator=(const GzipWriter&) = delete;

  /// At most 4 GB: zlib counts in 32 bits.
  void write(Bytes bytes) { push(bytes, Z_NO_FLUSH); }
  bool finish() {
    push({}, Z_FINISH);
    return ready_;
  }

 private:
  void push(Bytes bytes, int flush) {
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes.data()));
    stream_.avail_in = static_cast<uInt>(bytes.size());
    int status = Z_OK;
    do {
      stream_.next_out = reinterpret_cast<Bytef*>(chunk_.data());
      stream_.avail_out = static_cast<uInt>(chunk_.size());
      status = deflate(&stream_, flush);
      write_bytes(out_, Bytes(chunk_).first(chunk_.size() - stream_.avail_out));
    } while (stream_.avail_out == 0 && out_);
    ready_ = ready_ && status != Z_STREAM_ERROR;
  }

  std::ostream& out_;
  std::vector<std::byte> chunk_;
  z_stream stream_{};
  bool ready_ = false;
};

Result<void> write_plain(std::ostream& out, const VoxelData& data, Progress* progress) {
  return in_pieces(data, progress, [&](Bytes bytes) { write_bytes(out, bytes); });
}

/// `begin` and the voxels as one gzip stream.
Result<void> write_compressed(std::ostream& out, const std::string& begin, const VoxelData& data, Progress* progress) {
  GzipWriter gzip(out);
  gzip.write(std::as_bytes(std::span(begin)));
  if (auto written = in_pieces(data, progress, [&](Bytes bytes) { gzip.write(bytes); }); !written) return written;
  if (!gzip.finish()) return fail("", "could not be compressed; save it as .nii");
  return {};
}

int nifti_type(const VoxelData& data) {
  constexpr std::array types{NIFTI_TYPE_UINT8, NIFTI_TYPE_INT16, NIFTI_TYPE_UINT16, NIFTI_TYPE_FLOAT32};
  return types[data.index()];
}

/// RAS = diag(−1, −1, 1) · LPS.
nifti_dmat44 ras_affine(const VolumeGeometry& geometry) {
  nifti_dmat44 affine{};
  const Mat3 steps = geometry.direction * geometry.spacing_mm.asDiagonal();
  for (int row = 0; row < 3; ++row) {
    const double sign = row < 2 ? -1 : 1;
    for (int column = 0; column < 3; ++column) affine.m[row][column] = sign * steps(row, column);
    affine.m[row][3] = sign * geometry.origin_mm[row];
  }
  affine.m[3][3] = 1;
  return affine;
}

nifti_image nifti_header_image(const Volume& volume) {
  const VolumeGeometry& g = volume.geometry;
  nifti_image image{};
  const bool cine = volume.frames > 1;
  image.ndim = image.dim[0] = cine ? 4 : 3;
  image.nx = image.dim[1] = g.dims[0];
  image.ny = image.dim[2] = g.dims[1];
  image.nz = image.dim[3] = g.dims[2];
  image.nt = image.dim[4] = volume.frames;
  image.nu = image.nv = image.nw = image.dim[5] = image.dim[6] = image.dim[7] = 1;
  image.dx = image.pixdim[1] = g.spacing_mm[0];
  image.dy = image.pixdim[2] = g.spacing_mm[1];
  image.dz = image.pixdim[3] = g.spacing_mm[2];
  image.dt = image.pixdim[4] = cine ? volume.frame_seconds : 0;
  image.nvox = static_cast<std::int64_t>(g.voxels()) * volume.frames;
  image.datatype = nifti_type(volume.data);
  int swap_size = 0;
  nifti_datatype_sizes(image.datatype, &image.nbyper, &swap_size);
  image.scl_slope = 1;
  image.qform_code = image.sform_code = NIFTI_XFORM_SCANNER_ANAT;
  image.sto_xyz = ras_affine(g);
  nifti_dmat44_to_quatern(image.sto_xyz, &image.quatern_b, &image.quatern_c, &image.quatern_d, &image.qoffset_x,
                          &image.qoffset_y, &image.qoffset_z, nullptr, nullptr, nullptr, &image.qfac);
  image.xyz_units = NIFTI_UNITS_MM;
  image.time_units = cine ? NIFTI_UNITS_SEC : NIFTI_UNITS_UNKNOWN;
  return image;
}

/// Header and the four bytes that say that no extension follows. NIfTI-1 counts voxels in 16 bits; larger grids are
/// written as NIfTI-2.
template <class Header>
std::string header_bytes(Header header, std::int64_t offset) {
  header.vox_offset = static_cast<decltype(header.vox_offset)>(offset);
  std::string bytes(static_cast<std::size_t>(offset), '\0');
  std::memcpy(bytes.data(), &header, sizeof header);
  return bytes;
}

Result<void> write_nifti(const Volume& volume, const fs::path& path, bool compress, Progress* progress) {
  nifti_image image = nifti_header_image(volume);
  const bool small =
      std::all_of(image.dim + 1, image.dim + 5, [](auto n) { return n <= std::numeric_limits<short>::max(); });
  std::string header;
  constexpr std::int64_t nifti1_offset = 352, nifti2_offset = 544;
  image.nifti_type = small ? NIFTI_FTYPE_NIFTI1_1 : NIFTI_FTYPE_NIFTI2_1;
  image.iname_offset = small ? nifti1_offset : nifti2_offset;
  nifti_1_header first{};
  nifti_2_header second{};
  const int failed = small ? nifti_convert_nim2n1hdr(&image, &first) : nifti_convert_nim2n2hdr(&image, &second);
  if (failed != 0) return fail(path.string(), "cannot be written as NIfTI; choose .nrrd or .mha");
  header = small ? header_bytes(first, nifti1_offset) : header_bytes(second, nifti2_offset);
  return write_whole_file(path, [&](std::ostream& out) -> Result<void> {
    if (!compress) {
      out << header;
      return write_plain(out, volume.data, progress);
    }
    return write_compressed(out, header, volume.data, progress);
  });
}

std::ostringstream exact_text() {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(std::numeric_limits<double>::max_digits10);
  return text;
}

const char* endian_name() {
  return native_big_endian() ? "big" : "little";
}

Result<void> write_nrrd(const Volume& volume, const fs::path& path, Progress* progress) {
  constexpr std::array types{"uint8", "int16", "uint16", "float"};
  const VolumeGeometry& g = volume.geometry;
  const bool cine = volume.frames > 1;
  auto header = exact_text();
  const auto vector = [&header](const Vec3& v) { header << " (" << v[0] << ',' << v[1] << ',' << v[2] << ')'; };
  header << "NRRD0004\ntype: " << types[volume.data.index()] << "\ndimension: " << (cine ? 4 : 3)
         << "\nspace: left-posterior-superior\nsizes: " << g.dims[0] << ' ' << g.dims[1] << ' ' << g.dims[2];
  if (cine) header << ' ' << volume.frames;
  header << "\nspace directions:";
  for (int a = 0; a < 3; ++a) vector(g.direction.col(a) * g.spacing_mm[a]);
  if (cine) header << " none";
  header << "\nkinds: domain domain domain" << (cine ? " list" : "");
  if (cine && volume.frame_seconds > 0)
    header << "\nspacings: nan nan nan " << volume.frame_seconds << "\nunits: \"\" \"\" \"\" \"s\"";
  header << "\nendian: " << endian_name() << "\nencoding: gzip\nspace origin:";
  vector(g.origin_mm);
  header << "\n\n";
  return write_whole_file(path, [&](std::ostream& out) -> Result<void> {
    out << header.str();
    return write_compressed(out, {}, volume.data, progress);
  });
}

Result<void> write_metaimage(const Volume& volume, const fs::path& path, Progress* progress) {
  constexpr std::array types{"MET_UCHAR", "MET_SHORT", "MET_USHORT", "MET_FLOAT"};
  const VolumeGeometry& g = volume.geometry;
  const int n = volume.frames > 1 ? 4 : 3;
  auto header = exact_text();
  header << "ObjectType = Image\nNDims = " << n
         << "\nBinaryData = True\nBinaryDataByteOrderMSB = " << (native_big_endian() ? "True" : "False")
         << "\nCompressedData = False\nTransformMatrix =";
  for (int axis = 0; axis < n; ++axis)  // an axis's direction after the other
    for (int r = 0; r < n; ++r) header << ' ' << (axis < 3 && r < 3 ? g.direction(r, axis) : axis == r ? 1.0 : 0.0);
  header << "\nOffset = " << g.origin_mm[0] << ' ' << g.origin_mm[1] << ' ' << g.origin_mm[2] << (n == 4 ? " 0" : "");
  header << "\nElementSpacing = " << g.spacing_mm[0] << ' ' << g.spacing_mm[1] << ' ' << g.spacing_mm[2];
  if (n == 4) header << ' ' << (volume.frame_seconds > 0 ? volume.frame_seconds : 1);
  header << "\nDimSize = " << g.dims[0] << ' ' << g.dims[1] << ' ' << g.dims[2];
  if (n == 4) header << ' ' << volume.frames;
  header << "\nElementType = " << types[volume.data.index()] << "\nElementDataFile = LOCAL\n";
  return write_whole_file(path, [&](std::ostream& out) -> Result<void> {
    out << header.str();
    return write_plain(out, volume.data, progress);
  });
}

}  // namespace

Result<void> write_volume(const Volume& volume, const fs::path& path, Progress* progress) {
  const std::string name = lower_case_name(path);
  const auto written = [&]() -> Result<void> {
    if (name.ends_with(".nii")) return write_nifti(volume, path, false, progress);
    if (name.ends_with(".nii.gz")) return write_nifti(volume, path, true, progress);
    if (name.ends_with(".nrrd")) return write_nrrd(volume, path, progress);
    if (name.ends_with(".mha")) return write_metaimage(volume, path, progress);
    return fail("", "is not a kind of volume that can be written; end its name in .nii.gz, .nii, .nrrd or .mha");
  }();
  if (!written && written.error().subject.empty()) return fail(path.string(), written.error().what);
  return written;
}

}  // namespace homolog
