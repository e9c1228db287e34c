#include "core/volume/dicom/resample_slices.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "core/base/processes/memory.h"
#include "core/base/processes/parallel.h"
#include "core/volume/dicom/dicom_stack.h"
#include "core/volume/readers.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

/// The rest that decimals leave of whole steps, in voxels.
constexpr double rounded_voxels = 1e-3;

/// The old slices of a frame, and the new grid.
struct SlicePlaces {
  std::vector<std::vector<OldSlice>> frames;
  VolumeGeometry grid;
};

/// Errors: make_geometry's.
Result<SlicePlaces> places_of(const fs::path& path, const DicomArrangement& arrangement, const VolumeGeometry& old,
                              double step_mm) {
  const Mat3& axes = old.direction;
  const auto slices = static_cast<std::size_t>(arrangement.slices);
  const Vec3 first = *arrangement.planes.front().plane->position_mm;
  SlicePlaces places;
  Vec3 least = Vec3::Zero(), most = Vec3::Zero();
  for (std::size_t p = 0; p < arrangement.planes.size(); ++p) {
    if (p % slices == 0) places.frames.emplace_back();
    const Vec3 way = axes.transpose() * (*arrangement.planes[p].plane->position_mm - first);
    const Vec3 at(way.x() / old.spacing_mm.x(), way.y() / old.spacing_mm.y(), way.z() / step_mm);
    places.frames.back().push_back({at.z(), at.x(), at.y()});
    least = least.cwiseMin(at);
    most = most.cwiseMax(at);
  }
  // What is left over by rounding alone needs no further pixels.
  const auto over = [](double pixels) { return std::ceil(pixels - rounded_voxels); };
  const auto count = [](double voxels) { return static_cast<std::int64_t>(std::min(voxels, 1e15)); };
  Vec3 spacing_mm = old.spacing_mm;
  spacing_mm.z() = step_mm;
  auto grid =
      make_geometry(path,
                    {count(old.dims[0] + over(most.x() - least.x())), count(old.dims[1] + over(most.y() - least.y())),
                     count(std::floor(most.z() + rounded_voxels) + 1)},
                    axes * spacing_mm.asDiagonal(),
                    first + axes * Vec3(least.x() * old.spacing_mm.x(), least.y() * old.spacing_mm.y(), 0));
  if (!grid) return fail(grid.error());
  places.grid = old;  // its axes to the bit
  places.grid.dims = grid->dims;
  places.grid.spacing_mm = spacing_mm;
  places.grid.origin_mm = grid->origin_mm;
  for (auto& frame : places.frames)
    for (OldSlice& slice : frame) {
      slice.column -= least.x();
      slice.row -= least.y();
    }
  return places;
}

/// Bilinear value of a slice at a pixel of it; nothing beyond the centres of its outermost pixels.
template <class T>
std::optional<double> value_in_slice(std::span<const T> slice, int columns, int rows, double column, double row) {
  if (column < -rounded_voxels || column > columns - 1 + rounded_voxels || row < -rounded_voxels ||
      row > rows - 1 + rounded_voxels)
    return {};
  const auto place = [](double at, int count) {
    const double within = std::clamp(at, 0.0, count - 1.0);
    const int cell = std::clamp(static_cast<int>(within), 0, std::max(0, count - 2));
    return std::pair(cell, within - cell);
  };
  const auto [i, u] = place(column, columns);
  const auto [j, v] = place(row, rows);
  const auto at = [&](int c, int r) {
    return static_cast<double>(
        slice[static_cast<std::size_t>(std::min(r, rows - 1)) * static_cast<std::size_t>(columns) +
              static_cast<std::size_t>(std::min(c, columns - 1))]);
  };
  return (1 - v) * ((1 - u) * at(i, j) + u * at(i + 1, j)) + v * ((1 - u) * at(i, j + 1) + u * at(i + 1, j + 1));
}

/// Fills one new slice. `voxels`: of the frame's old ones.
template <class T>
void fill_slice(std::span<const T> voxels, const VolumeGeometry& old, const std::vector<OldSlice>& slices, int k,
                const VolumeGeometry& grid, float outside, std::span<float> filled) {
  const auto [below, above, t, column, row] = neighbours_of(slices, k);
  const std::size_t pixels = static_cast<std::size_t>(old.dims[0]) * static_cast<std::size_t>(old.dims[1]);
  const auto lower = voxels.subspan(below * pixels, pixels), upper = voxels.subspan(above * pixels, pixels);
  std::size_t at = 0;
  for (int j = 0; j < grid.dims[1]; ++j)
    for (int i = 0; i < grid.dims[0]; ++i, ++at) {
      const auto a = value_in_slice(lower, old.dims[0], old.dims[1], i - column, j - row);
      const auto b = below == above ? a : value_in_slice(upper, old.dims[0], old.dims[1], i - column, j - row);
      filled[at] = a && b ? static_cast<float>((1 - t) * *a + t * *b) : outside;
    }
}

}  // namespace

SliceNeighbours neighbours_of(std::span<const OldSlice> slices, int k) {
  SliceNeighbours found;
  while (found.above + 1 < slices.size() && slices[found.above].height < k - rounded_voxels) ++found.above;
  const bool between = found.above > 0 && slices[found.above].height > k + rounded_voxels;
  found.below = between ? found.above - 1 : found.above;
  const OldSlice &lower = slices[found.below], &upper = slices[found.above];
  const double gap = upper.height - lower.height;
  found.share = gap > 0 ? (k - lower.height) / gap : 0;
  found.column = (1 - found.share) * lower.column + found.share * upper.column;
  found.row = (1 - found.share) * lower.row + found.share * upper.row;
  return found;
}

TakenSlice taken_by(std::span<const OldSlice> slices, int k) {
  const SliceNeighbours at = neighbours_of(slices, k);
  constexpr double half = 0.5 + 1e-6;  // a slice in the middle goes to the lower one
  const std::size_t old = at.share > half ? at.above : at.below;
  return {old, at.column, at.row, std::abs(k - slices[old].height)};
}

Result<void> take_slices(const fs::path& path, const ResampledSlices& done, const VolumeGeometry& grid,
                         Volume& volume) {
  const double bytes = std::visit([]<class T>(const std::vector<T>&) { return sizeof(T) * 1.0; }, volume.data);
  if (auto enough = check_memory(path, bytes * static_cast<double>(grid.voxels())); !enough)
    return fail(enough.error());
  const VolumeGeometry old = volume.geometry;
  volume.data = std::visit(
      [&]<class T>(const std::vector<T>& voxels) -> VoxelData {
        std::vector<T> result(grid.voxels());
        std::size_t at = 0;
        for (int k = 0; k < grid.dims[2]; ++k) {
          const TakenSlice taken = taken_by(done.slices, k);
          for (int j = 0; j < grid.dims[1]; ++j)
            for (int i = 0; i < grid.dims[0]; ++i, ++at) {
              const double column = std::rint(i - taken.column), row = std::rint(j - taken.row);
              if (column < 0 || column >= old.dims[0] || row < 0 || row >= old.dims[1]) continue;
              result[at] = voxels[old.index(static_cast<std::int64_t>(column), static_cast<std::int64_t>(row),
                                            static_cast<std::int64_t>(taken.old))];
            }
        }
        return result;
      },
      volume.data);
  volume.geometry = grid;
  volume.range_min = std::min(volume.range_min, 0.0);
  volume.range_max = std::max(volume.range_max, 0.0);
  return {};
}

std::string taken_sentence(const fs::path& path, const std::string& what, const ResampledSlices& done,
                           const VolumeGeometry& grid) {
  double farthest = 0;
  for (int k = 0; k < done.dims[2]; ++k) farthest = std::max(farthest, taken_by(done.slices, k).off);
  return path.string() + ": was drawn on slices that were resampled; each slice of the grid has the " + what +
         " of the old one nearest to it, up to " + mm_text(farthest * grid.spacing_mm.z()) + " away";
}

Result<ResampledSlices> resample_slices(const fs::path& path, const DicomArrangement& arrangement, Volume& volume,
                                        Progress* progress) {
  const VolumeGeometry old = volume.geometry;
  std::vector<double> gaps;
  for (int s = 1; s < arrangement.slices; ++s) {
    const auto at = static_cast<std::size_t>(s);
    gaps.push_back(arrangement.planes[at].along_normal_mm - arrangement.planes[at - 1].along_normal_mm);
  }
  ResampledSlices done{
      .why = arrangement.uneven, .from_slices = arrangement.slices, .columns = old.dims[0], .rows = old.dims[1]};
  std::sort(gaps.begin(), gaps.end());
  done.least_mm = gaps.front();
  done.most_mm = gaps.back();
  const auto made = places_of(path, arrangement, old, gaps[gaps.size() / 2]);
  if (!made) return fail(made.error());
  const SlicePlaces& places = *made;
  const VolumeGeometry& grid = places.grid;
  done.dims = grid.dims;
  done.spacing_mm = grid.spacing_mm;
  done.slices = places.frames.front();
  for (const auto& frame : places.frames)
    for (const OldSlice& slice : frame)
      for (const OldSlice& other : frame)
        done.shifted_mm = std::max(done.shifted_mm, std::hypot((slice.column - other.column) * old.spacing_mm.x(),
                                                               (slice.row - other.row) * old.spacing_mm.y()));
  const double all = static_cast<double>(grid.voxels()) * volume.frames;
  if (auto enough = check_memory(path, sizeof(float) * all); !enough) return fail(enough.error());
  std::vector<float> filled(grid.voxels() * static_cast<std::size_t>(volume.frames));
  const auto outside = static_cast<float>(volume.range_min);
  const std::size_t pixels = static_cast<std::size_t>(grid.dims[0]) * static_cast<std::size_t>(grid.dims[1]);
  const int slices = grid.dims[2] * volume.frames;
  std::visit(
      [&]<class T>(const std::vector<T>& voxels) {
        in_parallel(slices, [&](int first, int last) {
          for (int s = first; s < last && !(progress && progress->cancelled()); ++s) {
            const auto frame = static_cast<std::size_t>(s / grid.dims[2]);
            fill_slice<T>(std::span(voxels).subspan(frame * old.voxels(), old.voxels()), old, places.frames[frame],
                          s % grid.dims[2], grid, outside,
                          std::span(filled).subspan(static_cast<std::size_t>(s) * pixels, pixels));
          }
        });
      },
      volume.data);
  if (progress && progress->cancelled()) return fail(path.string(), "was not read: cancelled");
  volume.geometry = grid;
  const auto [low, high] = std::minmax_element(filled.begin(), filled.end());
  volume.range_min = *low;
  volume.range_max = *high;
  volume.data = std::move(filled);
  return done;
}

std::string resampled_sentence(const fs::path& path, const ResampledSlices& done) {
  return path.string() + ": has " + done.why + "; its " + std::to_string(done.from_slices) +
         " slices were resampled to a rectangular grid of " + std::to_string(done.dims[2]) + ", " +
         mm_text(done.spacing_mm.z()) + " apart, by linear interpolation";
}

}  // namespace homolog
