#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/adapt/fit.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/voxels/label_map.h"
#include "core/template_making/template_file.h"

/// Helpers that tests of fits share.
namespace homolog {

inline std::shared_ptr<const Template> built_in(Organ organ) {
  return make_template(built_in_template(organ), "built-in").value();
}

/// A grid around points, `margin_mm` wider on each side.
inline VolumeGeometry grid_around(const Points& points, double spacing_mm, double margin_mm = 10) {
  const Box box = bounds_of(points);
  VolumeGeometry grid;
  grid.spacing_mm.setConstant(spacing_mm);
  grid.origin_mm = box.min() - Vec3::Constant(margin_mm);
  for (std::size_t axis = 0; axis < 3; ++axis)
    grid.dims[axis] = 1 + static_cast<int>((box.sizes()[static_cast<Eigen::Index>(axis)] + 2 * margin_mm) / spacing_mm);
  return grid;
}

/// The boundary of the label map of a shape.
inline Boundary boundary_of(const Mesh& mesh, double spacing_mm = 1.25) {
  return label_boundary(label_map(mesh, grid_around(mesh.points, spacing_mm)), 1, 0, 0, mesh.points.rows()).value();
}

inline void check_sound(const FitResult& fit) {
  CHECK(fit.turned_triangles == 0);
  CHECK(fit.self_intersections == 0);
  CHECK(fit.mesh.points.allFinite());
}

inline std::map<std::string, Vec3> landmarks_of(const MeshFile& file, const std::vector<std::string>& names) {
  std::map<std::string, Vec3> landmarks;
  for (const Landmark& landmark : file.landmarks)
    if (std::find(names.begin(), names.end(), landmark.name) != names.end())
      landmarks[landmark.name] = landmark.position;
  return landmarks;
}

}  // namespace homolog
