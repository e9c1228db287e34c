#include "core/mesh/repair/mesh_repair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "core/base/numbers/index.h"
#include "core/base/text/listed.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/repair/face_sheets.h"

namespace homolog {
namespace {

constexpr double one_place_share = 1e-6;  ///< share of the size: vertices nearer to each other are one
constexpr double crumb_share = 0.01;      ///< share of the largest part's area
constexpr double flat_share = 1e-6;       ///< height of a face against its longest edge: below, it has no area
constexpr int flip_rounds = 5;

/// Leaves out vertices that are no numbers and the faces that name them.
void leave_out_unfinite(Soup& soup, MendedFaults& mended) {
  std::vector<char> finite(index(soup.points.rows()));
  for (Eigen::Index v = 0; v < soup.points.rows(); ++v) finite[v] = soup.points.row(v).allFinite();
  mended.not_finite = static_cast<std::size_t>(std::count(finite.begin(), finite.end(), 0));
  if (mended.not_finite == 0) return;
  std::erase_if(soup.faces, [&](const Corners3& face) {
    return std::any_of(face.begin(), face.end(), [&](std::int32_t v) { return finite[v] == 0; });
  });
  for (Eigen::Index v = 0; v < soup.points.rows(); ++v)
    if (finite[v] == 0) soup.points.row(v).setZero();  // it belongs to no face now
}

/// Calls `meet(v, w)` for these vertices of a surface of `size_mm` that lie at one place: for so many pairs that they
/// link all that do.
template <class Meet>
void at_one_place(const Points& points, const std::vector<std::int32_t>& vertices, double size_mm, const Meet& meet) {
  const double near_mm = one_place_share * size_mm;
  // Along a direction in which no surface is flat few vertices are level.
  const Vec3 along = Vec3(0.5377, 0.6261, 0.5648).normalized();
  std::vector<std::pair<double, std::int32_t>> sorted;
  for (const std::int32_t v : vertices) sorted.emplace_back(points.row(v).dot(along), v);
  std::sort(sorted.begin(), sorted.end());
  std::vector<char> met(sorted.size(), 0);  // a vertex at the very place of one before meets the same others
  for (std::size_t k = 0; k < sorted.size(); ++k)
    for (std::size_t l = k + 1; met[k] == 0 && l < sorted.size() && sorted[l].first - sorted[k].first <= near_mm; ++l) {
      const double away_mm = (points.row(sorted[k].second) - points.row(sorted[l].second)).norm();
      if (away_mm > near_mm) continue;
      meet(sorted[k].second, sorted[l].second);
      met[l] |= static_cast<char>(away_mm == 0);
    }
}

/// Makes one of the vertices at one place: the first of them.
void weld(Soup& soup, MendedFaults& mended) {
  std::vector<std::int32_t> used, first(index(soup.points.rows()));
  for (const Corners3& face : soup.faces) used.insert(used.end(), face.begin(), face.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  std::iota(first.begin(), first.end(), 0);
  const auto first_of = [&](std::int32_t v) {
    while (first[v] != v) v = first[v] = first[first[v]];
    return v;
  };
  Box box;
  for (const std::int32_t v : used) box.extend(Vec3(soup.points.row(v)));
  at_one_place(soup.points, used, box.diagonal().norm(), [&](std::int32_t v, std::int32_t w) {
    const std::int32_t a = first_of(v), b = first_of(w);
    first[std::max(a, b)] = std::min(a, b);
  });
  for (const std::int32_t v : used) mended.duplicate_vertices += first_of(v) != v;
  for (Corners3& face : soup.faces)
    for (std::int32_t& v : face) v = first_of(v);
}

/// Which of the two ways round a face names its corners.
bool turns_up(const Corners3& face) {
  return (face[0] < face[1]) + (face[1] < face[2]) + (face[2] < face[0]) == 2;
}

void leave_out_broken_faces(Soup& soup, MendedFaults& mended) {
  const std::size_t all = soup.faces.size();
  std::erase_if(soup.faces, [](const Corners3& f) { return f[0] == f[1] || f[1] == f[2] || f[2] == f[0]; });
  mended.degenerate_faces = all - soup.faces.size();

  std::vector<std::pair<Corners3, std::size_t>> sorted;
  for (std::size_t f = 0; f < soup.faces.size(); ++f) {
    sorted.emplace_back(soup.faces[f], f);
    std::sort(sorted.back().first.begin(), sorted.back().first.end());
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<char> twin(soup.faces.size(), 0);
  for (std::size_t i = 0; i < sorted.size();) {
    // Faces that look against each other are a wall between two solids: both go. Of others the first stays.
    std::size_t end = i;
    std::ptrdiff_t looks = 0;
    for (; end < sorted.size() && sorted[end].first == sorted[i].first; ++end) {
      twin[sorted[end].second] = end - i > 0;
      looks += turns_up(soup.faces[sorted[end].second]) ? 1 : -1;
    }
    twin[sorted[i].second] = looks == 0;
    i = end;
  }
  std::size_t f = 0;
  mended.duplicate_faces = std::erase_if(soup.faces, [&](const Corners3&) { return twin[f++] != 0; });
}

Result<Mesh> to_mesh(const Soup& soup) {
  Triangles triangles(std::ssize(soup.faces), 3);
  for (std::size_t f = 0; f < soup.faces.size(); ++f)
    triangles.row(static_cast<Eigen::Index>(f)) << soup.faces[f][0], soup.faces[f][1], soup.faces[f][2];
  auto topology = Topology::make(soup.points.rows(), std::move(triangles));
  if (!topology) return fail(topology.error());
  return Mesh{*topology, soup.points};
}

Mesh turned(const Mesh& mesh) {
  Triangles triangles = mesh.topology->triangles();
  triangles.col(1).swap(triangles.col(2));
  return {Topology::make(mesh.points.rows(), std::move(triangles)).value(), mesh.points};
}

/// Whether the point lies on the inner side of what is nearest of a part.
bool is_within(const Vec3& p, const SurfaceSearch& part, const Points& normals) {
  const auto nearest = part.nearest(p);
  const Vec3 normal = nearest.at.interpolate(*part.mesh().topology, normals).transpose();
  return (p - nearest.position).dot(normal) < 0;
}

/// Without crumbs and cavities; every other part looks outward.
std::vector<Mesh> sound_parts(std::vector<Mesh> parts, MendedFaults& mended) {
  std::vector<double> area, volume;
  for (const Mesh& part : parts) {
    area.push_back(surface_area_mm2(part));
    volume.push_back(enclosed_volume_ml(part));
  }
  const auto largest = index(std::max_element(area.begin(), area.end()) - area.begin());
  // Where the largest part is inside out, so is the surface as a whole: what looks outward now is a cavity then.
  const bool inside_out = volume[largest] < 0;
  if (inside_out) {
    for (double& one : volume) one = -one;
    mended.turned_faces += static_cast<std::size_t>(parts[largest].topology->triangles().rows());
    parts[largest] = turned(parts[largest]);
  }
  const SurfaceSearch outer(parts[largest]);
  const Points normals = vertex_normals(parts[largest]);
  std::vector<Mesh> kept;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const bool crumb = p != largest && area[p] < crumb_share * area[largest];
    const bool inward = p != largest && volume[p] < 0;
    const bool cavity =
        !crumb && inward && parts[p].topology->closed() && is_within(parts[p].points.row(0), outer, normals);
    mended.crumbs += crumb;
    mended.cavities += cavity;
    if (crumb || cavity) continue;
    // Two bones of which one was exported inside out: each has to look outward, whichever is the larger.
    if (p != largest && inward != inside_out) {
      mended.turned_faces += static_cast<std::size_t>(parts[p].topology->triangles().rows());
      parts[p] = turned(parts[p]);
    }
    kept.push_back(std::move(parts[p]));
  }
  return kept;
}

/// The corner of a face without area that lies within its longest edge, so that flipping this edge helps; −1 for
/// others.
int flat_corner(const Mesh& mesh, Eigen::Index face) {
  const auto t = mesh.topology->triangles().row(face);
  for (int k = 0; k < 3; ++k) {
    const Vec3 p = mesh.points.row(t[k]), a = mesh.points.row(t[(k + 1) % 3]), b = mesh.points.row(t[(k + 2) % 3]);
    const Vec3 edge = b - a;
    const double length2 = edge.squaredNorm(), share = length2 > 0 ? (p - a).dot(edge) / length2 : -1;
    if (share > 1e-3 && share < 1 - 1e-3 && edge.cross(p - a).norm() < flat_share * length2) return k;
  }
  return -1;
}

/// Flips the longest edges of faces without area.
Mesh without_flat_faces(Mesh mesh, MendedFaults& mended) {
  for (int round = 0; round < flip_rounds; ++round) {
    Triangles triangles = mesh.topology->triangles();
    std::vector<char> touched(index(triangles.rows()), 0);
    std::set<std::pair<std::int32_t, std::int32_t>> made;  // edges
    for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
      const int k = flat_corner(mesh, f);
      const std::int32_t g = k < 0 ? -1 : mesh.topology->neighbours(f)[(k + 1) % 3];
      if (g < 0 || touched[f] != 0 || touched[g] != 0) continue;
      const std::int32_t p = triangles(f, k), a = triangles(f, (k + 1) % 3), b = triangles(f, (k + 2) % 3);
      std::int32_t d = -1;
      for (int c = 0; c < 3; ++c)
        if (triangles(g, c) != a && triangles(g, c) != b) d = triangles(g, c);
      const auto around = mesh.topology->one_ring(p);
      if (d < 0 || std::binary_search(around.begin(), around.end(), d) || !made.insert(std::minmax(p, d)).second)
        continue;
      triangles.row(f) << p, a, d;
      triangles.row(g) << p, d, b;
      touched[f] = touched[g] = 1;
    }
    if (made.empty()) break;
    auto topology = Topology::make(mesh.points.rows(), std::move(triangles));
    if (!topology) break;
    mended.degenerate_faces += made.size();
    mesh.topology = std::move(*topology);
  }
  return mesh;
}

/// The mesh of a file that has nothing to be parted, or none.
std::optional<Mesh> as_it_is(const MeshFile& surface) {
  if (!surface.points.allFinite()) return std::nullopt;
  auto mesh = sound_mesh(surface);
  if (!mesh) return std::nullopt;
  // Rims that lie on each other are a seam that was never closed.
  std::vector<std::int32_t> rims;
  for (const auto& rim : mesh->topology->rims()) rims.insert(rims.end(), rim.begin(), rim.end());
  bool torn = false;
  at_one_place(mesh->points, rims, bounds_of(mesh->points).diagonal().norm(),
               [&](std::int32_t, std::int32_t) { torn = true; });
  return torn ? std::nullopt : std::optional(std::move(*mesh));
}

Result<Mesh> parted(const MeshFile& surface, MendedFaults& mended) {
  Soup soup{surface.points, {}};
  for (Eigen::Index f = 0; f < surface.triangles.rows(); ++f)
    soup.faces.push_back({surface.triangles(f, 0), surface.triangles(f, 1), surface.triangles(f, 2)});
  std::vector<char> named(index(soup.points.rows()), 0);
  for (const std::int32_t v : surface.triangles->reshaped()) named[v] = 1;
  for (Eigen::Index v = 0; v < soup.points.rows(); ++v)
    mended.unused_vertices += named[v] == 0 && soup.points.row(v).allFinite();
  leave_out_unfinite(soup, mended);
  weld(soup, mended);
  leave_out_broken_faces(soup, mended);
  if (soup.faces.empty()) return fail("", "has no face left once broken ones are left out; export the surface again");
  return to_mesh(parted_sheets(std::move(soup), mended));
}

}  // namespace

std::vector<Mesh> parts_of(const Mesh& mesh) {
  if (mesh.topology->components() == 1) return {mesh};
  const auto& part = mesh.topology->component();
  std::vector<std::vector<std::int32_t>> vertices(index(mesh.topology->components()));
  std::vector<std::int32_t> number(part.size());
  for (std::size_t v = 0; v < part.size(); ++v) {
    auto& own = vertices[part[v]];
    number[v] = static_cast<std::int32_t>(own.size());
    own.push_back(static_cast<std::int32_t>(v));
  }
  std::vector<Soup> soups(vertices.size());
  for (Eigen::Index f = 0; f < mesh.topology->triangles().rows(); ++f) {
    const auto t = mesh.topology->triangles().row(f);
    soups[part[t[0]]].faces.push_back({number[t[0]], number[t[1]], number[t[2]]});
  }
  std::vector<Mesh> parts;
  for (std::size_t p = 0; p < soups.size(); ++p) {
    soups[p].points = mesh.points(vertices[p], Eigen::all);
    parts.push_back(to_mesh(soups[p]).value());
  }
  return parts;
}

Mesh joined(const std::vector<Mesh>& parts) {
  if (parts.size() == 1) return parts.front();
  Soup all;
  Eigen::Index vertices = 0;
  for (const Mesh& part : parts) vertices += part.points.rows();
  all.points.resize(vertices, 3);
  vertices = 0;
  for (const Mesh& part : parts) {
    all.points.middleRows(vertices, part.points.rows()) = part.points;
    for (Eigen::Index f = 0; f < part.topology->triangles().rows(); ++f) {
      const auto t = part.topology->triangles().row(f).array() + static_cast<std::int32_t>(vertices);
      all.faces.push_back({t[0], t[1], t[2]});
    }
    vertices += part.points.rows();
  }
  return to_mesh(all).value();
}

std::vector<Mesh> neighbouring_parts(const Mesh& mesh) {
  std::vector<Mesh> parts = parts_of(mesh);
  std::vector<double> area;
  std::vector<Box> boxes;
  for (const Mesh& part : parts) {
    area.push_back(surface_area_mm2(part));
    boxes.push_back(bounds_of(part.points));
  }
  std::vector<std::size_t> left(parts.size());  // in no group yet, in their order
  std::iota(left.begin(), left.end(), std::size_t{0});
  std::vector<std::size_t> by_area = left;
  std::ranges::stable_sort(by_area, std::greater(), [&](std::size_t p) { return area[p]; });
  std::vector<char> taken(parts.size(), 0);
  std::vector<Mesh> groups;
  for (const std::size_t largest : by_area) {
    if (taken[largest] != 0) continue;
    std::vector<Mesh> group;
    std::erase_if(left, [&](std::size_t p) {
      if (!boxes[p].intersects(boxes[largest])) return false;
      taken[p] = 1;
      group.push_back(std::move(parts[p]));
      return true;
    });
    groups.push_back(joined(group));
  }
  return groups;
}

bool MendedFaults::any() const {
  return not_finite + duplicate_vertices + unused_vertices + degenerate_faces + duplicate_faces + non_manifold_edges +
             non_manifold_vertices + turned_faces + crumbs + cavities + holes >
         0;
}

std::string MendedFaults::words() const {
  std::vector<std::string> parts;
  const auto add = [&](std::size_t count, const std::string& one, const std::string& many) {
    if (count > 0) parts.push_back(count == 1 ? "one " + one : std::to_string(count) + " " + many);
  };
  add(not_finite, "vertex that is no number left out", "vertices that are no numbers left out");
  add(duplicate_vertices, "vertex at the place of another merged", "vertices at the places of others merged");
  add(unused_vertices, "vertex of no face left out", "vertices of no face left out");
  add(degenerate_faces, "face without area mended", "faces without area mended");
  add(duplicate_faces, "face that was there twice left out", "faces that were there twice left out");
  add(non_manifold_edges, "edge of more than two faces split", "edges of more than two faces split");
  add(non_manifold_vertices, "vertex where sheets met split", "vertices where sheets met split");
  add(turned_faces, "face turned outward", "faces turned outward");
  add(crumbs, "crumb left out", "crumbs left out");
  add(cavities, "cavity filled", "cavities filled");
  add(holes, "hole closed flat", "holes closed flat");
  return listed(parts, " and ");
}

Result<MeshRepair> mended_if_broken(const MeshFile& surface, double longest_rim_share) {
  if (auto sound = as_it_is(surface)) return MeshRepair{std::move(*sound), {}};
  return repaired(surface, {longest_rim_share});
}

Result<MeshRepair> repaired(const MeshFile& surface, const RepairOptions& options) {
  MeshRepair repair;
  if (auto sound = as_it_is(surface)) {
    repair.mesh = std::move(*sound);
  } else {
    auto mesh = parted(surface, repair.mended);
    if (!mesh) return fail(mesh.error());
    repair.mesh = std::move(*mesh);
  }
  if (!(bounds_of(repair.mesh.points).diagonal().norm() > 0))
    return fail("", "has no extent: all its vertices lie at one place; export it again");
  const std::vector<Mesh> parts = sound_parts(parts_of(repair.mesh), repair.mended);
  if (std::ssize(parts) < repair.mesh.topology->components() || repair.mended.turned_faces > 0)
    repair.mesh = joined(parts);
  const double longest_mm = options.longest_rim_share * bounds_of(repair.mesh.points).diagonal().norm();
  const std::size_t rims = repair.mesh.topology->rims().size();
  repair.mesh = capped(repair.mesh, longest_mm);
  repair.mended.holes = rims - repair.mesh.topology->rims().size();
  repair.mesh = without_flat_faces(std::move(repair.mesh), repair.mended);
  return repair;
}

}  // namespace homolog
