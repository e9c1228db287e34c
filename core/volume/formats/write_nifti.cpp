#include "core/volume/formats/write_nifti.h"

#include <nifti2_io.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <ostream>

#include "core/base/files/files.h"
#include "core/volume/readers.h"
#include "core/volume/write_voxels.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

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

/// A number as NIfTI-1 keeps it. Volatile, since gcc 12 leaves out the rounding where it vectorises both casts.
double in_single_precision(double number) {
  const volatile auto single = static_cast<float>(number);
  return static_cast<double>(single);
}

/// Whether single precision, in which NIfTI-1 keeps sizes and places, moves no voxel by more than a thousandth of one.
bool is_held_by_floats(const VolumeGeometry& geometry) {
  const auto rounded = [](const auto& matrix) { return matrix.unaryExpr(&in_single_precision).eval(); };
  const Mat3 steps = geometry.direction * geometry.spacing_mm.asDiagonal();
  const Vec3 last(geometry.dims[0] - 1, geometry.dims[1] - 1, geometry.dims[2] - 1);
  const double most = 1e-3 * geometry.spacing_mm.minCoeff();
  const Mat3 off_steps = rounded(steps) - steps;
  const Vec3 off_origin = rounded(geometry.origin_mm) - geometry.origin_mm;
  const double off = (off_origin.cwiseAbs() + off_steps.cwiseAbs() * last).maxCoeff();
  const Vec3 sizes = rounded(geometry.spacing_mm);
  return off <= most && sizes.allFinite() && sizes.minCoeff() > 0;
}

/// Header and the four bytes that say that no extension follows.
template <class Header>
std::string header_bytes(Header header, std::int64_t offset) {
  header.vox_offset = static_cast<decltype(header.vox_offset)>(offset);
  std::string bytes(static_cast<std::size_t>(offset), '\0');
  std::memcpy(bytes.data(), &header, sizeof header);
  return bytes;
}

}  // namespace

Result<void> write_nifti(const Volume& volume, const fs::path& path, const std::string& /*record*/,
                         Progress* progress) {
  nifti_image image = nifti_header_image(volume);
  // NIfTI-1 counts voxels in 16 bits and keeps places in 32; what they do not hold is written as NIfTI-2.
  const bool small = is_held_by_floats(volume.geometry) && std::all_of(image.dim + 1, image.dim + 5, [](auto n) {
                       return n <= std::numeric_limits<short>::max();
                     });
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
    if (!lower_case_name(path).ends_with(".gz")) {
      out << header;
      return write_plain(out, volume.data, progress);
    }
    return write_compressed(out, header, volume.data, progress);
  });
}

}  // namespace homolog
