#include "core/volume/readers.h"

#include <bit>
#include <cctype>
#include <limits>

#include "core/base/text.h"

namespace homolog {

bool native_big_endian() {
  return std::endian::native == std::endian::big;
}

std::string lower_case_name(const std::filesystem::path& path) {
  return lower_case(path.filename().string());
}

Result<VolumeGeometry> make_geometry(const std::filesystem::path& path, const std::array<std::int64_t, 3>& dims,
                                     const Mat3& steps_mm, const Vec3& origin_mm) {
  VolumeGeometry geometry;
  for (std::size_t a = 0; a < 3; ++a) {
    if (dims[a] < 1 || dims[a] > std::numeric_limits<int>::max())
      return fail(path.string(), "claims a size of " + std::to_string(dims[a]) +
                                     " voxels along an axis; its header is damaged, export the volume again");
    geometry.dims[a] = static_cast<int>(dims[a]);
  }
  const Vec3 lengths = steps_mm.colwise().norm();
  if (!origin_mm.allFinite() || !lengths.allFinite() || lengths.minCoeff() <= 0)
    return fail(path.string(), "gives its voxels no size or place; its header is damaged, export the volume again");
  geometry.spacing_mm = lengths;
  geometry.origin_mm = origin_mm.array() + 0.0;  // no negative zeros in reports
  geometry.direction = (steps_mm * lengths.cwiseInverse().asDiagonal()).array() + 0.0;
  // Files keep directions in single precision or a few decimals; a thousandth is half a voxel in 500.
  const Mat3 turned_back = geometry.direction.transpose() * geometry.direction;
  if ((turned_back - Mat3::Identity()).cwiseAbs().maxCoeff() > 1e-3)
    return fail(path.string(), "has sheared axes (not at right angles); resample it to a rectangular grid first");
  return geometry;
}

Result<StoredVoxels> read_run(const VoxelRun& run, const VolumeGeometry& geometry, std::int64_t frames, bool rescaled,
                              Progress* progress) {
  // In floating point, since what a header claims may overflow any integer.
  double voxels = static_cast<double>(frames);
  for (const int n : geometry.dims) voxels *= n;
  const double bytes = voxels * static_cast<double>(bytes_per_voxel(run.type));
  if (const auto credible = check_claim(run.block, bytes, bytes_while_reading(run.type, voxels, rescaled)); !credible)
    return fail(credible.error());
  StoredVoxels stored = make_stored_voxels(run.type, geometry.voxels() * static_cast<std::size_t>(frames));
  if (const auto read = read_block(run.block, bytes_of(stored), progress); !read) return fail(read.error());
  if (run.other_byte_order) swap_byte_order(stored);
  return stored;
}

}  // namespace homolog
