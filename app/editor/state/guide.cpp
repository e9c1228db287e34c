#include "app/editor/state/guide.h"

#include "core/mesh/geometry/surface_search.h"

namespace homolog {

Guide guide_to(const Mesh& mesh, const Points& truth) {
  struct Place {
    ViewKind view;
    Eigen::Index axis;  ///< of LPS
    bool high;
  };
  static constexpr std::array<Place, 5> places{{{ViewKind::coronal, 2, true},
                                                {ViewKind::coronal, 2, false},
                                                {ViewKind::axial, 0, false},
                                                {ViewKind::sagittal, 1, false},
                                                {ViewKind::sagittal, 1, true}}};
  Guide guide;
  for (const Place& place : places) {
    Eigen::Index vertex = 0;
    if (place.high)
      truth.col(place.axis).maxCoeff(&vertex);
    else
      truth.col(place.axis).minCoeff(&vertex);
    GuideStep step{place.view, truth.row(vertex), 0};
    step.far_mm = (pulled_from(step, mesh) - step.to_mm).norm();
    guide.steps.push_back(step);
  }
  return guide;
}

Vec3 pulled_from(const GuideStep& step, const Mesh& mesh) {
  return nearest_on_surface(*mesh.topology, mesh.points, step.to_mm).position;
}

bool is_done(const GuideStep& step, const Mesh& mesh) {
  constexpr double left_share = 0.4, near_mm = 1.5;
  return (pulled_from(step, mesh) - step.to_mm).norm() < std::max(near_mm, left_share * step.far_mm);
}

}  // namespace homolog
