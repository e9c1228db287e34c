#include "core/volume/dicom/dicom_lattice.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/volume/dicom/dicom_stack.h"
#include "core/volume/readers.h"
#include "core/volume/referenced_images.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

/// Places along the normal that differ by less are those of one slice.
constexpr double same_place_mm = 1e-2;

/// The different places, ascending, without the first of them: distances from it.
std::vector<double> heights_of(const PlacedFrames& frames, const Vec3& normal) {
  std::vector<double> all;
  for (const Vec3& position : frames.positions_mm) all.push_back(position.dot(normal));
  std::sort(all.begin(), all.end());
  std::vector<double> heights;
  for (const double height : all)
    if (heights.empty() || height - all.front() - heights.back() > same_place_mm)
      heights.push_back(height - all.front());
  return heights;
}

/// How far two places may differ along a direction since their coordinates were rounded to tenths: 0 where some are
/// not.
double rounded_by_mm(const PlacedFrames& frames, const Vec3& direction) {
  constexpr double exactly_tenths = 1e-5;
  for (const Vec3& position : frames.positions_mm)
    if ((10 * position - (10 * position).array().rint().matrix()).cwiseAbs().maxCoeff() > exactly_tenths) return 0;
  return 0.1 * direction.cwiseAbs().sum();
}

/// Whether all heights are different multiples of a step within a tolerance.
bool are_multiples(const std::vector<double>& heights, double step, double tolerance_mm) {
  double last = -1;
  for (const double height : heights) {
    const double slice = std::rint(height / step);
    if (std::abs(height - slice * step) > tolerance_mm || slice == last) return false;
    last = slice;
  }
  return true;
}

/// A step near `wanted` of which all heights are multiples within a tolerance; 0 where there is none.
double even_step(const std::vector<double>& heights, double wanted, double tolerance_mm) {
  const double count = std::rint(heights.back() / wanted);
  if (count < 1) return 0;
  const double step = heights.back() / count;
  return are_multiples(heights, step, tolerance_mm) ? step : 0;
}

/// Files round places to a tenth of a millimetre at worst, which is more across oblique slices (`rounded_mm`).
double given_tolerance(double step_mm, double rounded_mm) {
  return std::min(0.25 * step_mm, std::max({0.06, 0.02 * step_mm, rounded_mm}));
}

double smallest_gap(const std::vector<double>& heights) {
  double smallest = heights.back();
  for (std::size_t k = 1; k < heights.size(); ++k) smallest = std::min(smallest, heights[k] - heights[k - 1]);
  return smallest;
}

/// Whether most frames follow one another by the smallest gap, as those of a structure do that no slice leaves out.
bool mostly_next_to_another(const std::vector<double>& heights, double rounded_mm) {
  constexpr std::ptrdiff_t least = 3;
  const double smallest = smallest_gap(heights), tolerance = given_tolerance(smallest, rounded_mm);
  std::ptrdiff_t next = 0;
  for (std::size_t k = 1; k < heights.size(); ++k) next += heights[k] - heights[k - 1] < smallest + tolerance ? 1 : 0;
  return next >= least && 2 * next > static_cast<std::ptrdiff_t>(heights.size()) - 1;
}

/// The largest step of which all heights are multiples; 0 where there is none.
double common_step(const std::vector<double>& heights, double rounded_mm) {
  constexpr int most_parts = 8;
  constexpr double least_mm = 0.1;
  const double smallest = smallest_gap(heights);
  for (int parts = 1; parts <= most_parts && smallest / parts >= least_mm; ++parts) {
    const double wanted = smallest / parts;
    // A step that no gap shows must fit closely: by chance some small one nearly always does.
    const double tolerance = parts == 1 ? given_tolerance(wanted, rounded_mm) : std::min(same_place_mm, 0.01 * wanted);
    if (const double step = even_step(heights, wanted, tolerance); step > 0) return step;
  }
  return 0;
}

/// The heights that lie no whole steps from most of them.
struct OffMost {
  std::vector<double> heights;  ///< empty: none, or there are no such most
  double farthest_mm = 0;       ///< the farthest of them from a step
};

OffMost off_most(const std::vector<double>& heights, double step, double tolerance_mm) {
  constexpr std::size_t most_compared = 4096;  // slices that are read
  if (heights.size() > most_compared) return {};
  std::optional<OffMost> least;
  for (const double base : heights) {
    OffMost off;
    for (const double height : heights) {
      const double mm = std::abs(height - base - std::rint((height - base) / step) * step);
      if (mm <= tolerance_mm) continue;
      off.heights.push_back(height);
      off.farthest_mm = std::max(off.farthest_mm, mm);
    }
    if (!least || off.heights.size() < least->heights.size()) least = std::move(off);
  }
  return least && 2 * least->heights.size() < heights.size() ? std::move(*least) : OffMost();
}

/// Errors: most frames lie apart as the file says, and the others on slices of a smaller step alone, which most gaps do
/// not show. Then these lie in a wrong place. A thickness says less: only against a step that no gap shows.
Result<void> check_declared(const fs::path& path, const PlacedFrames& frames, const std::vector<double>& heights,
                            double rounded_mm, double step) {
  const double tolerance = given_tolerance(step, rounded_mm);
  std::size_t shown = 0;
  for (std::size_t k = 1; k < heights.size(); ++k)
    shown += std::abs(heights[k] - heights[k - 1] - step) <= tolerance ? 1 : 0;
  const auto contradicted = [&](const std::optional<double>& given, std::size_t most_shown) {
    return given && step < 0.98 * *given && shown <= most_shown
               ? off_most(heights, *given, given_tolerance(*given, rounded_mm))
               : OffMost();
  };
  OffMost off = contradicted(frames.spacing_mm, (heights.size() - 2) / 2);
  const bool by_spacing = !off.heights.empty();
  // Slices may overlap by half.
  const bool is_half = frames.thickness_mm && std::abs(*frames.thickness_mm - 2 * step) <= tolerance;
  if (!by_spacing && !is_half) off = contradicted(frames.thickness_mm, 0);
  if (off.heights.empty()) return {};
  const Vec3 normal = frames.axes.first.cross(frames.axes.second).normalized();
  std::vector<double> places;
  for (const Vec3& position : frames.positions_mm) places.push_back(position.dot(normal));
  const double lowest = *std::ranges::min_element(places);
  const auto first = std::ranges::find_if(
      places, [&](double place) { return std::abs(place - lowest - off.heights.front()) <= same_place_mm; });
  const std::string frame = "frame " + std::to_string(first - places.begin() + 1);
  const std::string others = off.heights.size() == 1 ? "its " + frame + " lies " + mm_text(off.farthest_mm)
                                                     : std::to_string(off.heights.size()) + " others (as " + frame +
                                                           ") lie up to " + mm_text(off.farthest_mm);
  return fail(path.string(), (by_spacing ? "says that its slices lie " : "has slices of ") +
                                 mm_text(by_spacing ? *frames.spacing_mm : *frames.thickness_mm) +
                                 (by_spacing ? " apart, as most of its frames do, and "
                                             : ", as far as most of its frames lie apart, and ") +
                                 others + " off these; export it again on the slices of its series");
}

/// The distance between slices. Errors: there is none.
Result<double> step_between(const fs::path& path, const PlacedFrames& frames, const std::vector<double>& heights,
                            double rounded_mm, std::vector<std::string>& warnings) {
  const auto& spacing = frames.spacing_mm;
  if (heights.size() == 1) {
    if (!spacing && !frames.thickness_mm)
      warnings.push_back(path.string() + ": gives no slice thickness; 1 mm is assumed");
    return spacing.value_or(frames.thickness_mm.value_or(1));
  }
  const auto fits = [&](const std::optional<double>& given) {
    const double tolerance = given ? given_tolerance(*given, rounded_mm) : 0;
    const double step = given ? even_step(heights, *given, tolerance) : 0;
    if (step > 0 && std::abs(step - *given) <= 0.02 * *given) return step;
    // Over few slices what places are rounded by is a large part of a step.
    return given && are_multiples(heights, *given, tolerance) ? *given : 0;
  };
  if (const double step = fits(spacing); step > 0) return step;
  // Thickness is not distance: slices overlap, or leave gaps.
  const bool next = mostly_next_to_another(heights, rounded_mm);
  const double thickness = next ? 0 : fits(frames.thickness_mm);
  const double step = thickness > 0 ? thickness : common_step(heights, rounded_mm);
  if (step == 0)
    return fail(path.string(),
                "has frames whose distances are no multiples of one another, so that they lie on no even slices; "
                "export it on the slices of its series, or resample it evenly");
  if (auto declared = check_declared(path, frames, heights, rounded_mm, step); !declared) return fail(declared.error());
  if (spacing)
    warnings.push_back(path.string() + ": says that its slices lie " + mm_text(*spacing) +
                       " apart, but its frames lie multiples of " + mm_text(step) + " apart, which was taken");
  else if (thickness > 0 && smallest_gap(heights) > 1.5 * step)
    warnings.push_back(path.string() + ": does not say how far its slices lie apart; their thickness, " +
                       mm_text(step) + ", was taken, though no two frames lie so near");
  else if (thickness == 0 && !next)
    warnings.push_back(path.string() + ": does not say how far its slices lie apart; " + mm_text(step) +
                       ", of which the distances of its frames are multiples, was assumed");
  else if (thickness == 0 && frames.thickness_mm && *frames.thickness_mm < 0.98 * step)
    warnings.push_back(path.string() + ": does not say how far its slices lie apart; " + mm_text(step) +
                       ", as far as its frames do, was taken, though its slices are " + mm_text(*frames.thickness_mm) +
                       " thick");
  return step;
}

/// Errors: a frame lies beside the normal through the first by more than a tenth of a pixel or what places are rounded
/// by.
Result<void> check_beside(const fs::path& path, const PlacedFrames& frames, const Vec3& normal) {
  const double pixel = std::min(frames.pixel_mm.first, frames.pixel_mm.second);
  const Vec3& first = frames.positions_mm.front();
  double worst = 0;
  for (const Vec3& position : frames.positions_mm) {
    const Vec3 way = position - first;
    worst = std::max(worst, (way - way.dot(normal) * normal).norm());
  }
  const double rounded =
      std::hypot(rounded_by_mm(frames, frames.axes.first), rounded_by_mm(frames, frames.axes.second));
  if (worst <= std::max({0.1 * pixel, std::min(0.15, 0.25 * pixel), std::min(rounded, 0.5 * pixel)})) return {};
  return fail(path.string(), "has frames that are shifted sideways against one another, by up to " + mm_text(worst) +
                                 "; convert it on the series that it was drawn on (--like, with --resample where that "
                                 "is tilted), or export it on slices that lie straight behind one another");
}

}  // namespace

Result<FrameLattice> lattice_of(const fs::path& path, const PlacedFrames& frames, std::vector<std::string>& warnings) {
  const Vec3 normal = frames.axes.first.cross(frames.axes.second).normalized();
  if (auto straight = check_beside(path, frames, normal); !straight) return fail(straight.error());
  const auto heights = heights_of(frames, normal);
  const auto step = step_between(path, frames, heights, rounded_by_mm(frames, normal), warnings);
  if (!step) return fail(step.error());
  const auto lowest = *std::min_element(frames.positions_mm.begin(), frames.positions_mm.end(),
                                        [&](const Vec3& a, const Vec3& b) { return a.dot(normal) < b.dot(normal); });
  const double slices = std::rint(heights.back() / *step) + 1;
  constexpr double most_slices = 4096;
  if (!(slices <= most_slices))
    return fail(path.string(),
                "spreads its frames over more than 4,096 slices; its places are damaged, export it again");
  Mat3 steps;
  steps << frames.pixel_mm.first * frames.axes.first, frames.pixel_mm.second * frames.axes.second, *step * normal;
  const auto geometry =
      make_geometry(path, {frames.columns, frames.rows, static_cast<std::int64_t>(slices)}, steps, lowest);
  if (!geometry) return fail(geometry.error());
  FrameLattice lattice{*geometry, {}};
  for (const Vec3& position : frames.positions_mm)
    lattice.slices.push_back(static_cast<int>(std::rint((position - lowest).dot(normal) / *step)));
  return lattice;
}

Vec3 near_voxels(const Vec3& spacing_mm) {
  constexpr double rounded_mm = 0.2, share = 0.01, most_share = 0.25;
  return (rounded_mm * spacing_mm.cwiseInverse()).cwiseMax(share).cwiseMin(most_share);
}

/// Whether the columns of frames go as those of a grid, and their rows too.
bool goes_along(const PlacedFrames& frames, const VolumeGeometry& grid, const Vec3& close) {
  const Vec3 origin = grid.to_voxel(grid.origin_mm);
  const auto is_off = [&](const Vec3& way_mm, const Vec3& wanted) {
    return (grid.to_voxel(grid.origin_mm + way_mm) - origin - wanted).cwiseAbs().cwiseQuotient(close).maxCoeff() > 1;
  };
  const auto [columns, rows] = frames.pixel_mm;
  return !is_off(columns * (frames.columns - 1) * frames.axes.first, {frames.columns - 1.0, 0, 0}) &&
         !is_off(rows * (frames.rows - 1) * frames.axes.second, {0, frames.rows - 1.0, 0});
}

std::optional<FrameLattice> on_grid(const PlacedFrames& frames, const VolumeGeometry& grid) {
  if (grid.dims[0] != frames.columns || grid.dims[1] != frames.rows) return {};
  FrameLattice lattice{grid, {}};
  const auto [columns, rows] = frames.pixel_mm;
  // How far the last voxel of a frame goes beside that of the grid, in voxels.
  const Vec3 last_step =
      columns * (frames.columns - 1) * frames.axes.first + rows * (frames.rows - 1) * frames.axes.second;
  const Vec3 normal = grid.direction.col(2), close = near_voxels(grid.spacing_mm);
  if (!goes_along(frames, grid, 2 * close)) return {};
  std::map<int, double> heights;
  for (const Vec3& position : frames.positions_mm) {
    const Vec3 first = grid.to_voxel(position), last = grid.to_voxel(position + last_step);
    const double slice = std::rint(first.z());
    const Vec3 last_wanted(frames.columns - 1, frames.rows - 1, slice);
    if (((first - Vec3(0, 0, slice)).cwiseAbs() - close).maxCoeff() > 0 ||
        ((last - last_wanted).cwiseAbs() - close).maxCoeff() > 0)
      return {};
    if (slice < 0 || slice >= grid.dims[2]) return {};
    lattice.slices.push_back(static_cast<int>(slice));
    // Two places in one slice are no places of its series.
    const double height = position.dot(normal);
    const auto known = heights.try_emplace(lattice.slices.back(), height).first;
    if (std::abs(known->second - height) > std::max(same_place_mm, 0.02 * grid.spacing_mm.z())) return {};
  }
  return lattice;
}

std::optional<FrameLattice> on_images(const PlacedFrames& frames, const ImageGrid& series) {
  const VolumeGeometry& grid = series.geometry;
  if (grid.dims[0] != frames.columns || grid.dims[1] != frames.rows) return {};
  const auto images = images_by_name(series.images);
  const Vec3 close = near_voxels(grid.spacing_mm);
  if (!goes_along(frames, grid, close)) return {};
  FrameLattice lattice{grid, {}, true};
  for (std::size_t f = 0; f < frames.positions_mm.size(); ++f) {
    const auto image = images.find(frames.images[f]);
    if (image == images.end() || image->second == nullptr || !image->second->position_mm) return {};
    const Vec3 off = grid.to_voxel(frames.positions_mm[f]) - grid.to_voxel(*image->second->position_mm);
    if (off.cwiseAbs().cwiseQuotient(close).maxCoeff() > 1) return {};
    lattice.slices.push_back(image->second->slice);
  }
  return lattice;
}

std::optional<FrameLattice> on_old_slices(const PlacedFrames& frames, const ImageGrid& series) {
  if (!series.resampled) return {};
  const ResampledSlices& done = *series.resampled;
  if (done.columns != frames.columns || done.rows != frames.rows) return {};
  const VolumeGeometry& grid = series.geometry;
  const Vec3 close = near_voxels(grid.spacing_mm);
  if (!goes_along(frames, grid, close)) return {};
  FrameLattice lattice{grid, {}};
  lattice.old_slices = true;
  lattice.geometry.dims = {frames.columns, frames.rows, done.from_slices};
  for (const Vec3& position : frames.positions_mm) {
    const Vec3 first = grid.to_voxel(position);
    const auto off = [&](const OldSlice& old) {
      return (first - Vec3(old.column, old.row, old.height)).cwiseAbs().cwiseQuotient(close).maxCoeff();
    };
    const auto nearest = std::ranges::min_element(done.slices, {}, off);
    if (nearest == done.slices.end() || !(off(*nearest) <= 1)) return {};
    lattice.slices.push_back(static_cast<int>(nearest - done.slices.begin()));
  }
  return lattice;
}

std::optional<FrameLattice> lattice_on_series(const PlacedFrames& frames, const ImageGrid& series) {
  if (!series.resampled) {
    auto by_images = on_images(frames, series);
    return by_images ? by_images : on_grid(frames, series.geometry);
  }
  const bool refer = std::ranges::none_of(frames.images, [](const std::string& uid) { return uid.empty(); });
  if (auto old = refer ? on_old_slices(frames, series) : std::nullopt) return old;
  auto on_new = on_grid(frames, series.geometry);
  return on_new ? on_new : on_old_slices(frames, series);
}

std::vector<std::string> doubts_about_places(const fs::path& path, const PlacedFrames& frames,
                                             const FrameLattice& lattice, const std::vector<SourceImage>& series) {
  constexpr double noticed_mm = 0.1;
  std::vector<std::string> doubts;
  const auto images = images_by_name(series);
  double worst = 0;
  for (std::size_t f = 0; f < frames.positions_mm.size(); ++f) {
    const int slice = lattice.slices[f];
    if (!lattice.old_slices)
      worst = std::max(worst, (frames.positions_mm[f] - lattice.geometry.to_mm(Vec3(0, 0, slice))).norm());
    const auto image = images.find(frames.images[f]);
    if (image == images.end() || image->second == nullptr || image->second->slice == slice || !doubts.empty()) continue;
    doubts.push_back(path.string() + ": its frame " + std::to_string(f + 1) + " lies on slice " +
                     std::to_string(slice + 1) + " of its series and refers to the image of slice " +
                     std::to_string(image->second->slice + 1) + "; its place was taken");
  }
  const Vec3 normal = frames.axes.first.cross(frames.axes.second);
  const double rounded = Vec3(rounded_by_mm(frames, frames.axes.first), rounded_by_mm(frames, frames.axes.second),
                              rounded_by_mm(frames, normal))
                             .norm();
  if (worst > std::max(noticed_mm, rounded))
    doubts.push_back(path.string() +
                     (lattice.by_images
                          ? ": its frames were put on the slices of the images that they refer to, which "
                            "lie up to " +
                                mm_text(worst) + " off even ones"
                          : ": its frames lie up to " + mm_text(worst) + " off the even slices that they were put on"));
  return doubts;
}

}  // namespace homolog
