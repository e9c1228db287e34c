#include "core/volume/readers.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <limits>

#include "core/base/numbers/limits.h"
#include "core/base/processes/memory.h"
#include "core/base/text/text.h"

namespace homolog {

bool native_big_endian() {
  return std::endian::native == std::endian::big;
}

std::string name_without_numbers(const std::filesystem::path& path) {
  std::string alike;
  for (const char c : lower_case_name(path)) {
    const bool digit = c >= '0' && c <= '9';
    if (!digit)
      alike += c;
    else if (!alike.ends_with('#'))
      alike += '#';
  }
  return alike;
}

bool has_ending(const std::filesystem::path& path, const std::vector<std::string>& endings) {
  const std::string name = lower_case_name(path);
  return std::any_of(endings.begin(), endings.end(), [&](const std::string& ending) { return name.ends_with(ending); });
}

bool is_hidden(const std::filesystem::path& path) {
  return path.filename().string().starts_with('.');
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
  if (std::max(origin_mm.cwiseAbs().maxCoeff(), lengths.maxCoeff()) > farthest_mm)
    return fail(path.string(),
                std::string(beyond_farthest) + " by its header, which is damaged; export the volume again");
  geometry.spacing_mm = lengths;
  geometry.origin_mm = origin_mm.array() + 0.0;  // no negative zeros in reports
  geometry.direction = (steps_mm * lengths.cwiseInverse().asDiagonal()).array() + 0.0;
  // Files keep directions in single precision or a few decimals; a thousandth is half a voxel in 500.
  const Mat3 turned_back = geometry.direction.transpose() * geometry.direction;
  if ((turned_back - Mat3::Identity()).cwiseAbs().maxCoeff() > 1e-3)
    return fail(path.string(), "has sheared axes (not at right angles); resample it to a rectangular grid first");
  return geometry;
}

double claimed_voxels(const VolumeGeometry& geometry, std::int64_t frames) {
  double voxels = static_cast<double>(frames);
  for (const int n : geometry.dims) voxels *= n;
  return voxels;
}

Result<StoredVoxels> read_run(const VoxelRun& run, const VolumeGeometry& geometry, std::int64_t frames, bool rescaled,
                              Progress* progress) {
  const double voxels = claimed_voxels(geometry, frames), each = voxels / static_cast<double>(run.blocks.size());
  const ByteBlock& first = run.blocks.front();
  for (const ByteBlock& block : run.blocks)
    if (const auto credible = check_claim(block, each * static_cast<double>(size_of(run.type))); !credible)
      return fail(credible.error());
  if (const auto enough = check_memory(first.file, bytes_while_reading(run.type, voxels, rescaled)); !enough)
    return fail(enough.error());
  const std::size_t count = geometry.voxels() * static_cast<std::size_t>(frames);
  if (count % run.blocks.size() != 0)
    return fail(first.file.string(), "and its voxel files do not hold equal numbers of voxels; export them again");
  StoredVoxels stored = make_stored_voxels(run.type, 0);
  reserve_voxels(stored, count);
  const std::size_t block_bytes = count / run.blocks.size() * size_of(run.type);
  // Voxels that a size lacks are a slice at least, also where they are 0, as at a label map's border.
  const std::int64_t longest = std::max<std::int64_t>(std::ranges::max(geometry.dims), frames);
  const std::size_t fewest_lacking = block_bytes / static_cast<std::size_t>(longest);
  const auto room = [&](std::size_t bytes) { return add_voxels(stored, bytes / size_of(run.type)); };
  for (std::size_t b = 0; b < run.blocks.size(); ++b) {
    const bool alone = run.blocks.size() == 1;
    if (progress && !alone) progress->report(static_cast<double>(b) / static_cast<double>(run.blocks.size()));
    if (progress && progress->cancelled()) return fail(first.file.string(), "was not read: cancelled");
    ByteBlock block = run.blocks[b];
    block.most_zeros = fewest_lacking > 0 ? fewest_lacking - 1 : 0;
    if (const auto read = read_block(block, block_bytes, room, alone ? progress : nullptr); !read)
      return fail(read.error());
  }
  if (run.other_byte_order) swap_byte_order(stored);
  return stored;
}

}  // namespace homolog
