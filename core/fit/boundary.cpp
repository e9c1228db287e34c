#include "core/fit/boundary.h"

#include <algorithm>
#include <cmath>

#include "core/mesh/mesh_quality.h"
#include "core/template/label_region.h"
#include "core/template/level_set.h"
#include "core/template/voxel_components.h"

namespace homolog {

namespace {

constexpr double most_voxels = 16e6;

/// The voxel size to work on: a third of the mean edge of `vertices` landmarks spread over the label's surface.
double worked_mm(const LabelExtent& extent, const Vec3& voxel_mm, double margin_mm, Eigen::Index vertices) {
  const double edge_mm = std::sqrt(extent.area_mm2 * 2 / (std::sqrt(3.0) * static_cast<double>(vertices)));
  double volume_mm3 = 1;
  for (std::size_t axis = 0; axis < 3; ++axis)
    volume_mm3 *= (extent.last[axis] - extent.first[axis] + 1) * voxel_mm[static_cast<Eigen::Index>(axis)] +
                  2 * (margin_mm + edge_mm);
  return std::max({edge_mm / 3, 0.5 * voxel_mm.minCoeff(), std::cbrt(volume_mm3 / most_voxels)});
}

/// Where the label's largest part lies at the first or last plane of the label map in an axis.
std::vector<ScanEdge> edges_of(const LabelRegion& region, const VolumeGeometry& whole) {
  std::vector<ScanEdge> edges;
  for (std::size_t side = 0; side < 6; ++side) {
    if (!region.touches[side]) continue;
    const auto axis = static_cast<Eigen::Index>(side / 2);
    const bool last = side % 2 == 1;
    Vec3 face = Vec3::Zero();
    face[axis] = last ? whole.dims[side / 2] - 0.5 : -0.5;
    ScanEdge edge;
    edge.outward = whole.direction.col(axis) * (last ? 1 : -1);
    edge.offset_mm = edge.outward.dot(whole.to_mm(face));
    edge.doubt_mm = std::max(whole.spacing_mm[axis], region.grid.spacing_mm[axis]);
    edges.push_back(edge);
  }
  return edges;
}

/// closed_by of what a ball of `radius_mm` reaches from without: a pocket behind a narrower neck is filled too, even
/// where a ball would fit into it.
LevelSet closed_from_outside(const LevelSet& surface, double radius_mm) {
  if (radius_mm <= 0) return surface;
  std::vector<float> values = surface.values();
  std::vector<std::uint8_t> centres(values.size());
  std::transform(values.begin(), values.end(), centres.begin(),
                 [radius_mm](float value) { return static_cast<std::uint8_t>(value >= radius_mm); });
  const auto parts = connected_components(centres, surface.grid().dims, Touching::faces_and_edges).part;
  for (std::size_t v = 0; v < values.size(); ++v)
    if (parts[v] > 0) values[v] = 0;  // part 0 holds the grid's first corner
  return closed_by({surface.grid(), std::move(values)}, radius_mm);
}

}  // namespace

bool Boundary::shows(const Vec3& p) const {
  return std::none_of(scan_edges.begin(), scan_edges.end(),
                      [&](const ScanEdge& edge) { return edge.outward.dot(p) > edge.offset_mm - edge.doubt_mm; });
}

Result<Boundary> label_boundary(const Volume& mask, int label, int frame, double closing_mm, Eigen::Index vertices) {
  const LabelExtent extent = label_extent(mask, label, frame);
  const Vec3& voxel_mm = mask.geometry.spacing_mm;
  const double spacing_mm = worked_mm(extent, voxel_mm, closing_mm, vertices);
  auto region = label_region(mask, label, frame, spacing_mm, closing_mm + 3 * spacing_mm);
  if (!region) return fail(region.error());

  LevelSet surface = resampled(signed_distance(region->inside, region->grid), spacing_mm);
  surface = closed_from_outside(surface, closing_mm);
  make_one_body(surface);
  auto mesh = surface_of(surface);
  if (!mesh)
    return fail("", "label " + std::to_string(label) + " is too small for " + std::to_string(vertices) +
                        " landmarks; use a template with fewer, or another label");
  Boundary boundary;
  boundary.surface = std::move(*mesh);
  boundary.scan_edges = edges_of(*region, mask.geometry);
  if (!boundary.scan_edges.empty())
    boundary.warnings.push_back("label " + std::to_string(label) +
                                " is cut off by the edge of the label map; what lies beyond follows the template");
  if (!region->body.islands.empty() &&
      static_cast<double>(region->body.islands.front()) > 0.5 * static_cast<double>(region->body.body))
    boundary.warnings.push_back("label " + std::to_string(label) +
                                " has several parts of about one size; the largest was taken");
  return boundary;
}

Boundary mesh_boundary(const Mesh& mesh) {
  Boundary boundary;
  const Topology& topology = *mesh.topology;
  if (topology.components() == 1) {
    boundary.surface = mesh;
    return boundary;
  }
  std::vector<double> area(static_cast<std::size_t>(topology.components()), 0);
  const Triangles& triangles = topology.triangles();
  const auto part_of = [&](Eigen::Index f) {
    return static_cast<std::size_t>(topology.component()[static_cast<std::size_t>(triangles(f, 0))]);
  };
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    const Vec3 a = mesh.points.row(triangles(f, 0)), b = mesh.points.row(triangles(f, 1)),
               c = mesh.points.row(triangles(f, 2));
    area[part_of(f)] += (b - a).cross(c - a).norm() / 2;
  }
  const auto largest = static_cast<std::size_t>(std::max_element(area.begin(), area.end()) - area.begin());
  std::vector<std::int32_t> index(static_cast<std::size_t>(mesh.points.rows()), -1);
  std::int32_t kept = 0;
  for (std::size_t v = 0; v < index.size(); ++v)
    if (topology.component()[v] == static_cast<std::int32_t>(largest)) index[v] = kept++;
  Points points(kept, 3);
  for (std::size_t v = 0; v < index.size(); ++v)
    if (index[v] >= 0) points.row(index[v]) = mesh.points.row(static_cast<Eigen::Index>(v));
  Triangles faces(triangles.rows(), 3);
  Eigen::Index count = 0;
  for (Eigen::Index f = 0; f < triangles.rows(); ++f)
    if (part_of(f) == largest)
      faces.row(count++) =
          triangles.row(f).unaryExpr([&](std::int32_t v) { return index[static_cast<std::size_t>(v)]; });
  faces.conservativeResize(count, 3);
  boundary.surface = {Topology::make(kept, std::move(faces)).value(), std::move(points)};
  boundary.warnings.push_back("has " + std::to_string(topology.components()) + " parts; the largest was taken");
  return boundary;
}

}  // namespace homolog
