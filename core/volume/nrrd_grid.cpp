#include "core/volume/nrrd_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/volume/length_units.h"
#include "core/volume/readers.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

/// The space has time as its fourth direction.
bool has_time(const Nrrd& nrrd) {
  switch (nrrd.space) {
    case nrrdSpaceRightAnteriorSuperiorTime:
    case nrrdSpaceLeftAnteriorSuperiorTime:
    case nrrdSpaceLeftPosteriorSuperiorTime:
    case nrrdSpaceScannerXYZTime:
    case nrrdSpace3DRightHandedTime:
    case nrrdSpace3DLeftHandedTime:
      return true;
    default:
      return false;
  }
}

unsigned space_dimensions(const Nrrd& nrrd) {
  return has_time(nrrd) ? 3 : nrrd.spaceDim;
}

/// Whether an axis runs through space: of those that have a direction, all but one along time alone.
bool is_placed(const Nrrd& nrrd, const NrrdAxisInfo& axis) {
  if (nrrd.spaceDim == 0 || !std::isfinite(axis.spaceDirection[0])) return false;
  return !has_time(nrrd) || std::any_of(axis.spaceDirection, axis.spaceDirection + 3, [](double d) { return d != 0; });
}

/// LPS = sign · the file's space [NRRD format, §"space"]; spaces that do not name the patient's sides stay as they are.
Vec3 lps_signs(int space, const fs::path& path, std::vector<std::string>& warnings) {
  switch (space) {
    case nrrdSpaceRightAnteriorSuperior:
    case nrrdSpaceRightAnteriorSuperiorTime:
      return {-1, -1, 1};
    case nrrdSpaceLeftAnteriorSuperior:
    case nrrdSpaceLeftAnteriorSuperiorTime:
      return {1, -1, 1};
    case nrrdSpaceLeftPosteriorSuperior:
    case nrrdSpaceLeftPosteriorSuperiorTime:
      return {1, 1, 1};
    default:
      warnings.push_back(path.string() +
                         ": does not give the patient's orientation; its axes are assumed to run to the left, "
                         "back and head");
      return {1, 1, 1};
  }
}

/// The k-th of some units; empty where it is not said.
std::string unit_at(const std::vector<std::string>& units, std::size_t k) {
  return k < units.size() ? units[k] : std::string();
}

/// How the axes of an array step through space, and where its first voxel's centre lies; in the file's units.
struct Steps {
  Mat3 steps = Mat3::Identity();
  Vec3 origin = Vec3::Zero();
};

/// An axis whose place is given by the space's directions.
void place_in_space(const Nrrd& nrrd, const NrrdAxisInfo& axis, Eigen::Index column, Steps& result) {
  for (unsigned s = 0; s < space_dimensions(nrrd); ++s) {
    result.steps(s, column) = axis.spaceDirection[s];
    if (std::isfinite(nrrd.spaceOrigin[s])) result.origin[s] = nrrd.spaceOrigin[s];
  }
}

/// The facts that an axis without a space tells of itself.
struct AxisSays {
  bool size = false, centering = true;
};

/// An axis that gives its spacing, or both ends, and perhaps where it begins. Where voxels are cells, it begins half a
/// voxel before the first one's centre; where nothing is said, they are cells, as ITK and teem have it.
AxisSays place_by_ends(const NrrdAxisInfo& axis, Eigen::Index column, Steps& result) {
  AxisSays says;
  const bool node = axis.center == nrrdCenterNode;
  double step = axis.spacing;
  if (!std::isfinite(step) && std::isfinite(axis.min) && std::isfinite(axis.max)) {
    const auto count = static_cast<double>(axis.size);
    step = (axis.max - axis.min) / (node ? std::max(count - 1, 1.0) : count);
  }
  says.size = (std::isfinite(step) && step != 0) || axis.size <= 1;
  if (!std::isfinite(step) || step == 0) step = 1;
  result.steps(column, column) = step;
  if (!std::isfinite(axis.min)) return says;
  says.centering = axis.center != nrrdCenterUnknown;
  result.origin[column] = axis.min + (node ? 0 : step / 2);
  return says;
}

/// Units must be those of every direction or axis, or one for all.
Result<void> check_units(const std::vector<std::string>& units, unsigned count, const fs::path& path) {
  if (units.empty() || units.size() == 1 || units.size() == count) return {};
  return fail(path.string(), "gives " + std::to_string(units.size()) + " units for " + std::to_string(count) +
                                 " directions; export it again");
}

}  // namespace

Result<NrrdAxes> find_axes(const Nrrd& nrrd, const fs::path& path) {
  NrrdAxes axes;
  for (unsigned a = 0; a < nrrd.dim; ++a) {
    const NrrdAxisInfo& axis = nrrd.axis[a];
    const bool domain = axis.kind == nrrdKindUnknown || axis.kind == nrrdKindDomain || axis.kind == nrrdKindSpace;
    if (is_placed(nrrd, axis) || (nrrd.spaceDim == 0 && domain && axes.space.size() < 3)) {
      axes.space.push_back(a);
    } else if (axis.size == 1) {
      continue;
    } else if (!axes.frames && (domain || axis.kind == nrrdKindTime || axis.kind == nrrdKindList)) {
      axes.frames = a;
    } else {
      return fail(path.string(),
                  "holds several values for each voxel (vectors, colours or five dimensions); export one "
                  "scalar volume or a series of frames");
    }
  }
  if (axes.space.size() < 2 || axes.space.size() > 3)
    return fail(path.string(), "is no image of two or three dimensions; export it as a volume");
  if (axes.frames && *axes.frames != 0 && *axes.frames != nrrd.dim - 1)
    return fail(path.string(), "keeps its frames between two axes of space; export it with the frames first or last");
  return axes;
}

Result<VolumeGeometry> grid_of(const Nrrd& nrrd, const NrrdHeader& header, const NrrdAxes& axes, const fs::path& path,
                               std::vector<std::string>& warnings) {
  if (space_dimensions(nrrd) > 3)
    return fail(path.string(), "is placed in four dimensions; export it in a space of three");
  if (auto units = check_units(header.space_units, nrrd.spaceDim, path); !units) return fail(units.error());
  if (auto units = check_units(header.units, nrrd.dim, path); !units) return fail(units.error());
  std::array<std::int64_t, 3> dims{1, 1, 1};
  Steps placed;
  bool unsized = false, negative = false, uncentred = false;
  Vec3 mm = Vec3::Ones();
  for (std::size_t a = 0; a < axes.space.size(); ++a) {
    const NrrdAxisInfo& axis = nrrd.axis[axes.space[a]];
    const auto column = static_cast<Eigen::Index>(a);
    dims[a] = static_cast<std::int64_t>(std::min<std::size_t>(axis.size, std::numeric_limits<std::int64_t>::max()));
    if (nrrd.spaceDim > 0) {
      place_in_space(nrrd, axis, column, placed);
      continue;
    }
    const AxisSays says = place_by_ends(axis, column, placed);
    unsized = unsized || !says.size;
    uncentred = uncentred || !says.centering;
    negative = negative || placed.steps(column, column) < 0;
    const std::size_t unit = header.units.size() == 1 ? 0 : axes.space[a];
    mm[column] = mm_or_warn(path, unit_at(header.units, unit), warnings);
  }
  // Some programs give the units of axes although there is a space.
  const std::vector<std::string> own{unit_at(header.units, header.units.size() == 1 ? 0 : axes.space[0])};
  const auto& units = header.space_units.empty() ? own : header.space_units;
  for (Eigen::Index s = 0; nrrd.spaceDim > 0 && s < 3; ++s)
    mm[s] = mm_or_warn(path, unit_at(units, units.size() == 1 ? 0 : static_cast<std::size_t>(s)), warnings);
  if (unsized) warnings.push_back(path.string() + ": does not say how large a voxel is; 1 mm is assumed");
  if (negative) warnings.push_back(path.string() + ": has spacings below 0; these axes are taken to run the other way");
  if (uncentred)
    warnings.push_back(
        path.string() +
        ": does not say whether its axes begin at a voxel's face or at its centre (centerings); the face "
        "is assumed");
  const Vec3 scale = lps_signs(nrrd.space, path, warnings).cwiseProduct(mm);
  return make_geometry(path, dims, scale.asDiagonal() * placed.steps, scale.asDiagonal() * placed.origin);
}

double seconds_between_frames(const Nrrd& nrrd, const NrrdHeader& header, unsigned axis) {
  const NrrdAxisInfo& frames = nrrd.axis[axis];
  double step = frames.spacing;
  std::string unit = unit_at(header.units, axis);
  if (has_time(nrrd) && std::isfinite(frames.spaceDirection[3])) {
    step = frames.spaceDirection[3];
    if (unit.empty()) unit = unit_at(header.space_units, 3);
  }
  if (!std::isfinite(step) || step <= 0) return 0;
  return step * seconds_per_unit(unit).value_or(1);
}

}  // namespace homolog
