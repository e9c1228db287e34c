#include "core/phantom/solid_template.h"

#include <cassert>

#include "core/mesh/colours.h"
#include "core/mesh/construction/remesh.h"
#include "core/mesh/voxels/voxelise.h"
#include "core/phantom/imaging.h"
#include "core/template_making/level_set.h"

namespace homolog::phantom {
namespace {

Vec3 gradient(Solid solid, const Vec3& p) {
  const double step_mm = 1e-4;
  Vec3 slope;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 offset = step_mm * Vec3::Unit(axis);
    slope[axis] = (solid(p + offset) - solid(p - offset)) / (2 * step_mm);
  }
  return slope;
}

/// The point of the solid's surface reached from `p` down its gradient.
Vec3 onto_surface(Solid solid, Vec3 p) {
  for (int round = 0; round < 8; ++round) {
    const double d = solid(p);
    if (std::abs(d) < 1e-9) break;
    const Vec3 slope = gradient(solid, p);
    p -= d / std::max(slope.squaredNorm(), 0.25) * slope;
  }
  return p;
}

/// The solid's values near its surface.
LevelSet level_set_of(Solid solid, const Box& box, double spacing_mm) {
  VolumeGeometry grid;
  grid.spacing_mm.setConstant(spacing_mm);
  grid.origin_mm = box.min();
  for (int axis = 0; axis < 3; ++axis) grid.dims[axis] = static_cast<int>(box.sizes()[axis] / spacing_mm) + 1;
  std::vector<float> values;
  values.reserve(grid.voxels());
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i)
        values.push_back(static_cast<float>(solid(grid.to_mm({1.0 * i, 1.0 * j, 1.0 * k}))));
  return {grid, std::move(values)};
}

Eigen::Index vertex_nearest(const Points& points, const Vec3& place) {
  Eigen::Index nearest = 0;
  (points.rowwise() - place.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
  return nearest;
}

}  // namespace

SolidTemplate template_of(Solid solid, const Box& box, int vertices, const std::vector<NamedPlace>& places) {
  const auto rough = surface_of(level_set_of(solid, box, 1.5));
  assert(rough && "the solid lies inside the box");
  const Mesh even = remesh_to_count(*rough, vertices, [solid](const Vec3& p) { return onto_surface(solid, p); });
  const auto mesh = renumbered(even, vertex_nearest(even.points, places.front().near));

  SolidTemplate result;
  result.mesh.points = mesh.points;
  result.mesh.triangles = mesh.topology;
  result.centre_mm = even.points.colwise().mean().transpose();
  for (const auto& [name, near] : places) {
    const Vec3 place = result.mesh.points.row(vertex_nearest(result.mesh.points, near));
    result.mesh.landmarks.push_back({name, place - result.centre_mm});
  }
  result.mesh.points.rowwise() -= result.centre_mm.transpose();
  result.mesh.stiffness = std::make_shared<const VertexScalars>(VertexScalars::Ones(result.mesh.points.rows()));
  return result;
}

MeshFile deformed(const MeshFile& mean, const Deformation& deformation) {
  MeshFile subject = mean;
  subject.points = deformation.to_subject(mean.points);
  for (Landmark& landmark : subject.landmarks) landmark.position = deformation.to_subject(landmark.position);
  return subject;
}

PhantomSubject solid_subject(const SolidTemplate& mean, const Deformation& deformation, Volume image) {
  PhantomSubject subject;
  MeshFile truth = deformed(mean.mesh, deformation);
  const auto topology = Topology::make(truth.points.rows(), truth.triangles);
  assert(topology);
  subject.label_map.geometry = image.geometry;
  subject.label_map.data = voxelise({*topology, truth.points}, image.geometry);
  note_range(subject.label_map);
  subject.image = std::move(image);
  subject.landmarks = truth.landmarks;
  subject.truth.push_back(std::move(truth));
  return subject;
}

}  // namespace homolog::phantom
