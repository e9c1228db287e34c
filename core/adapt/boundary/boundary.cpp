#include "core/adapt/boundary/boundary.h"

#include <algorithm>
#include <cmath>

#include "core/mesh/mesh_quality.h"
#include "core/mesh/remesh.h"
#include "core/template_making/label_body.h"
#include "core/template_making/level_set.h"
#include "core/template_making/voxel_components.h"

namespace homolog {

namespace {

/// Where the label's largest part lies at the first or last plane of the label map in an axis.
std::vector<ScanEdge> edges_of(const LabelBody& region, const VolumeGeometry& whole) {
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
  const double edge_mm = spread_edge_mm(extent.area_mm2, vertices), margin_mm = closing_mm + edge_mm;
  const double spacing_mm = worked_spacing_mm(mask, extent, edge_mm, margin_mm);
  const auto region = label_body(mask, label, frame, extent, spacing_mm, margin_mm);
  if (!region) return fail(region.error());

  LevelSet surface = resampled(signed_distance(region->inside, region->grid), spacing_mm);
  surface = closed_from_outside(surface, closing_mm);
  make_one_body(surface);
  auto mesh = surface_of(surface);
  if (!mesh)
    return fail("", "label " + std::to_string(label) + " is too small for " + std::to_string(vertices) +
                        " vertices; use a template with fewer vertices, or another label");
  Boundary boundary;
  boundary.surface = std::move(*mesh);
  boundary.scan_edges = edges_of(*region, mask.geometry);
  if (!boundary.scan_edges.empty())
    boundary.warnings.push_back(
        "label " + std::to_string(label) +
        " is cut off by the edge of the label map; the mesh beyond the edge follows the template");
  if (auto several = several_parts(*region, label)) boundary.warnings.push_back(std::move(*several));
  return boundary;
}

Boundary mesh_boundary(const Mesh& mesh) {
  Boundary boundary;
  boundary.surface = largest_part(mesh);
  if (const auto parts = mesh.topology->components(); parts > 1)
    boundary.warnings.push_back("has " + std::to_string(parts) + " parts; the largest was taken");
  return boundary;
}

}  // namespace homolog
