#include "core/template_making/mesh_template.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "core/mesh/mesh_quality.h"
#include "core/mesh/remesh.h"
#include "core/mesh/surface_search.h"
#include "core/template_making/mask_template.h"

namespace homolog {
namespace {

/// Number of each vertex once those within a millionth of the surface's size are one.
std::vector<std::int32_t> welded(const Points& points, Eigen::Index& count) {
  const Box box = bounds_of(points);
  const double cell_mm = std::max(1e-6 * box.diagonal().norm(), 1e-12);
  std::map<std::array<std::int64_t, 3>, std::int32_t> places;
  std::vector<std::int32_t> number;
  for (Eigen::Index v = 0; v < points.rows(); ++v) {
    const Vec3 at = (Vec3(points.row(v)) - box.min()) / cell_mm;
    const std::array<std::int64_t, 3> cell{std::llround(at[0]), std::llround(at[1]), std::llround(at[2])};
    number.push_back(places.try_emplace(cell, static_cast<std::int32_t>(places.size())).first->second);
  }
  count = static_cast<Eigen::Index>(places.size());
  return number;
}

Result<Mesh> cleaned(const MeshFile& surface, std::vector<std::string>& warnings) {
  Eigen::Index count = 0;
  const auto number = welded(surface.points, count);
  std::vector<std::int32_t> corners, used(static_cast<std::size_t>(count), -1);
  std::int32_t vertices = 0;
  for (Eigen::Index f = 0; f < surface.triangles.rows(); ++f) {
    std::array<std::int32_t, 3> face{};
    for (int k = 0; k < 3; ++k)
      face[static_cast<std::size_t>(k)] = number[static_cast<std::size_t>(surface.triangles(f, k))];
    if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) continue;
    for (const std::int32_t v : face) {
      auto& index = used[static_cast<std::size_t>(v)];
      if (index < 0) index = vertices++;
      corners.push_back(index);
    }
  }
  Points points(vertices, 3);
  for (Eigen::Index v = 0; v < surface.points.rows(); ++v)
    if (const auto index = used[static_cast<std::size_t>(number[static_cast<std::size_t>(v)])]; index >= 0)
      points.row(index) = surface.points.row(v);
  if (vertices < surface.points.rows())
    warnings.push_back(std::to_string(surface.points.rows() - vertices) +
                       " vertices that coincide or belong to no face were left out");
  Triangles triangles = Eigen::Map<const Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
  auto topology = Topology::make(points.rows(), std::move(triangles));
  if (!topology) return fail(topology.error());
  if (const auto parts = (*topology)->components(); parts > 1)
    warnings.push_back("the surface has " + std::to_string(parts) + " parts; the largest was taken");
  Mesh mesh = largest_part({*topology, std::move(points)});
  if (!mesh.topology->closed()) {
    warnings.push_back(
        "the surface has " + std::to_string(mesh.topology->rims().size()) +
        (mesh.topology->rims().size() == 1 ? " hole; it was closed flat" : " holes; they were closed flat"));
    mesh = capped(mesh);
  }
  if (enclosed_volume_ml(mesh) < 0) {
    Triangles turned = mesh.topology->triangles();
    turned.col(1).swap(turned.col(2));
    mesh.topology = Topology::make(mesh.points.rows(), std::move(turned)).value();
    warnings.push_back("the surface looked inward; its faces were turned");
  }
  return mesh;
}

}  // namespace

Result<MeshTemplate> make_mesh_template(const MeshFile& surface, int vertices, Progress* progress) {
  MeshTemplate made;
  made.warnings = surface.warnings;
  const auto clean = cleaned(surface, made.warnings);
  if (!clean) return fail(clean.error());
  const SurfaceSearch search(*clean);
  const auto project = [&search, hint = std::int32_t{0}](const Vec3& p) mutable {
    const auto nearest = search.nearest(p, hint);
    hint = nearest.at.face;
    return nearest.position;
  };
  made.mesh = renumbered_from_top(remesh_to_count(*clean, vertices, project, progress));
  if (progress && progress->cancelled()) return fail("", "making the template was cancelled");
  made.to_mesh = surface_distance(made.mesh, *clean);
  made.from_mesh = surface_distance(*clean, made.mesh);
  return made;
}

}  // namespace homolog
