#include "core/adapt/boundary/mirrored_landmarks.h"

#include <cmath>
#include <utility>

#include "core/adapt/boundary/landmark_pull.h"
#include "core/mesh/mesh_quality.h"
#include "core/placement/mirror_symmetry.h"

namespace homolog {

namespace {

/// Shares of the root of the area.
constexpr double as_known_share = 0.08;   ///< nearer to a known place, a mirrored one tells nothing new
constexpr double asymmetry_share = 0.01;  ///< how far a place may lie from its mirror image, each coordinate

}  // namespace

std::vector<MirroredLandmark> mirrored_landmarks(const Template& the_template, const Boundary& boundary,
                                                 const std::map<std::string, Vec3>& landmarks,
                                                 const VertexScalars& trust, const Similarity& placement) {
  const SurfaceSearch own({the_template.topology, the_template.points});
  const auto own_mirror = mirror_symmetry(own, sagittal_reflection(the_template.points));
  if (!own_mirror) return {};
  const SurfaceSearch there(boundary.surface);
  const auto there_mirror = mirror_symmetry(there, carried_by(placement, *own_mirror));
  if (!there_mirror) return {};
  const std::pair<Points, Points> matched = matched_landmarks(the_template, landmarks);
  const Points &known = matched.first, &known_there = matched.second;
  const double near_mm = as_known_share * std::sqrt(surface_area_mm2(own.mesh()));
  const auto near_one = [&](const Vec3& place) {
    for (Eigen::Index k = 0; k < known.rows(); ++k)
      if (trust[k] >= believable && (known.row(k).transpose() - place).norm() < near_mm) return true;
    return false;
  };
  std::vector<MirroredLandmark> mirrored;
  for (Eigen::Index k = 0; k < known.rows(); ++k) {
    if (trust[k] < believable) continue;
    const auto place = own.nearest(own_mirror->apply(known.row(k)));
    if (near_one(place.position)) continue;
    mirrored.push_back({k, place.at, there.nearest(there_mirror->apply(known_there.row(k))).position});
  }
  return mirrored;
}

void add_mirrored(const std::vector<MirroredLandmark>& mirrored, const Mesh& placed, KnownMatches& known) {
  const double asymmetry_mm = asymmetry_share * std::sqrt(surface_area_mm2(placed));
  const Eigen::Index before = known.from.rows(), all = before + std::ssize(mirrored);
  known.from.conservativeResize(all, Eigen::NoChange);
  known.to.conservativeResize(all, Eigen::NoChange);
  known.noise_mm.conservativeResize(all);
  for (Eigen::Index row = before; row < all; ++row) {
    const auto& [of, place, there] = mirrored[row - before];
    known.from.row(row) = place.interpolate(*placed.topology, placed.points);
    known.to.row(row) = there.transpose();
    known.noise_mm[row] = std::hypot(known.noise_mm[of], asymmetry_mm);
  }
}

}  // namespace homolog
