#include "core/adapt/image/fit_to_image.h"

#include <utility>

#include "core/placement/likely_similarity.h"

namespace homolog {

Result<Similarity> placement_by_landmarks(const Template& the_template, const std::map<std::string, Vec3>& landmarks) {
  const auto [from, to] = matched_landmarks(the_template, landmarks);
  if (from.rows() < fewest_placing_landmarks)
    return fail("", "needs at least three of the template's landmarks; place more of them");
  const Similarity placement =
      likely_similarity(from, to, PlacementPrior{}, bounds_of(the_template.points).diagonal().norm());
  if (!(placement.scale > 0))
    return fail("", "cannot be placed: the landmarks contradict each other; check their places and names");
  return placement;
}

std::vector<Pin> landmark_pins(const Template& the_template, const Points& points,
                               const std::map<std::string, Vec3>& landmarks, double reach_mm) {
  std::vector<Pin> pins;
  for (std::size_t l = 0; l < the_template.landmarks.size(); ++l) {
    const auto there = landmarks.find(the_template.landmarks[l].name);
    if (there == landmarks.end()) continue;
    if ((carried_landmark(the_template, l, points) - there->second).norm() <= reach_mm)
      pins.push_back({the_template.landmark_points[l], there->second});
  }
  return pins;
}

Result<ImageFit> fit_to_image(const Template& the_template, const Volume& image, int frame, const Similarity& placement,
                              const std::map<std::string, Vec3>& landmarks, SnapOptions options,
                              const AllowedShapes* allowed, double beyond) {
  ImageFit fit;
  fit.mesh = {the_template.topology, placement.apply(the_template.points)};
  if (allowed != nullptr) {
    auto nearest = snap_allowed(image, frame, *allowed, the_template.topology, placement, options);
    if (!nearest) return fail(nearest.error());
    fit.mesh.points = std::move(nearest->points);
    options.strength *= beyond;
  }
  fit.placed = fit.mesh.points;
  SnapStart start{fit.mesh, fit.placed, the_template.stiffness, VertexScalars::Ones(fit.placed.rows())};
  start.pins = landmark_pins(the_template, fit.placed, landmarks, options.edges.reach_mm);
  fit.held_landmarks = start.pins.size();
  auto snapped = snap(image, frame, start, options);
  if (!snapped) return fail(snapped.error());
  fit.snapped = std::move(*snapped);
  fit.mesh.points = fit.snapped.points;
  return fit;
}

}  // namespace homolog
