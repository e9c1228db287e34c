#include "core/case/held_landmarks.h"

#include <algorithm>
#include <map>

namespace homolog {

namespace {

using Corners = std::array<Eigen::Index, 3>;

/// The vertices of the triangle on which a landmark lies.
Corners corners_of(const Template& the_template, std::size_t landmark) {
  const auto t = the_template.topology->triangles().row(the_template.landmark_points[landmark].face);
  return {t[0], t[1], t[2]};
}

bool is_confirmed(const Shape& shape, Eigen::Index vertex) {
  return shape.confirmed && (*shape.confirmed)[vertex] >= 1;
}

/// Whether the triangle lies within a larger part that a person confirmed.
bool is_surrounded(const Template& the_template, const Corners& corners, const Shape& shape) {
  const auto& triangles = the_template.topology->triangles();
  const auto is_corner = [&](Eigen::Index v) { return std::find(corners.begin(), corners.end(), v) != corners.end(); };
  bool surrounded = true;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const auto row = triangles.row(t);
    if (!is_corner(row[0]) && !is_corner(row[1]) && !is_corner(row[2])) continue;
    for (int k = 0; k < 3; ++k) surrounded = surrounded && (is_corner(row[k]) || is_confirmed(shape, row[k]));
  }
  return surrounded;
}

/// The place of a landmark in a template's list; its size where it is none.
std::size_t index_in(const Template& the_template, const std::string& name) {
  const auto& all = the_template.landmarks;
  const auto found = std::find_if(all.begin(), all.end(), [&](const Landmark& one) { return one.name == name; });
  return static_cast<std::size_t>(found - all.begin());
}

/// A shape's knowledge of a landmark by name, with the vertices that hold it.
struct Known {
  LandmarkHold hold;
  Corners corners{};
  Vec3 at = Vec3::Zero();
};

Known known(const Template& the_template, const std::string& name, const Shape& shape) {
  const std::size_t index = index_in(the_template, name);
  if (index == the_template.landmarks.size()) return {};
  Known found{landmark_hold(the_template, index, shape), corners_of(the_template, index)};
  if (found.hold.placed) found.at = shape.landmarks.at(name);
  return found;
}

}  // namespace

LandmarkHold landmark_hold(const Template& the_template, std::size_t landmark, const Shape& shape) {
  constexpr double met_mm = 2;
  LandmarkHold found;
  const Corners corners = corners_of(the_template, landmark);
  found.held = std::all_of(corners.begin(), corners.end(), [&](Eigen::Index v) { return is_confirmed(shape, v); });
  const auto place = shape.landmarks.find(the_template.landmarks[landmark].name);
  if (place == shape.landmarks.end()) return found;
  found.placed = true;
  found.distance_mm = (carried_landmark(the_template, landmark, *shape.points) - place->second).norm();
  const Points& reference = *shape.reference;
  double edge_mm = 0;
  for (std::size_t k = 0; k < 3; ++k)
    edge_mm = std::max(edge_mm, (reference.row(corners[k]) - reference.row(corners[(k + 1) % 3])).norm());
  found.met = found.distance_mm <= std::max(met_mm, edge_mm);
  return found;
}

void hold_landmark(const Template& the_template, std::size_t landmark, bool hold, Shape& shape) {
  const Corners corners = corners_of(the_template, landmark);
  if (!hold && (!shape.confirmed || is_surrounded(the_template, corners, shape))) return;
  VertexScalars confirmed = shape.confirmed ? *shape.confirmed : VertexScalars::Zero(shape.points->rows());
  for (const Eigen::Index v : corners) confirmed[v] = hold ? 1 : 0;
  shape.confirmed = confirmed.any() ? std::make_shared<const VertexScalars>(std::move(confirmed)) : nullptr;
}

std::shared_ptr<const VertexScalars> confirmed_without_landmarks(const ShapeView& view) {
  Shape shape = view.shape;
  if (!view.structure.landmarks.hold || !shape.confirmed) return shape.confirmed;
  const Template& the_template = view.the_template();
  for (std::size_t l = 0; l < the_template.landmarks.size(); ++l) {
    // Two landmarks may share a vertex, so each is asked of the shape as it is.
    const LandmarkHold hold = landmark_hold(the_template, l, view.shape);
    if (hold.held && hold.met) hold_landmark(the_template, l, false, shape);
  }
  return shape.confirmed;
}

void settle_landmarks(const Structure& before, Structure& after, int frame) {
  const Shape *shown_before = before.shape(frame), *shown_after = after.shape(frame);
  if (!after.landmarks.hold || shown_before == nullptr || shown_after == nullptr) return;
  if (shown_before->landmarks.empty() && shown_after->landmarks.empty()) return;
  const Shape& shape_before = *shown_before;
  Shape shape = *shown_after;
  const bool same_template = before.the_template->topology == after.the_template->topology;
  std::map<std::string, Vec3> names = shape.landmarks;
  names.insert(shape_before.landmarks.begin(), shape_before.landmarks.end());
  for (const auto& [name, at] : names) {
    const Known was = same_template ? known(*before.the_template, name, shape_before) : Known{};
    const Known now = known(*after.the_template, name, shape);
    const bool same_place = was.at == now.at && was.corners == now.corners;
    const std::size_t index_before = index_in(*before.the_template, name);
    if (was.hold.met && was.hold.held && (!now.hold.met || was.corners != now.corners))
      hold_landmark(*before.the_template, index_before, false, shape);
    if (now.hold.met && !(was.hold.met && same_place))
      hold_landmark(*after.the_template, index_in(*after.the_template, name), true, shape);
  }
  after.set_shape(frame, std::move(shape));
}

}  // namespace homolog
