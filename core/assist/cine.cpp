#include "core/assist/cine.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "core/base/numbers/statistics.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

std::vector<int> starting_frames(const ShapeView& shown) {
  std::vector<int> frames;
  for (const auto& [frame, shape] : shown.structure.shapes)
    if (frame_is_known(*shape)) frames.push_back(frame);
  if (frames.empty()) frames.push_back(shown.frame);
  return frames;
}

Result<CineEdit> propagate_shape(const Scan& scan, const ShapeView& shown, const PropagateOptions& options) {
  if (!scan.image) return fail("", "There is no cine to propagate through; open one first.");
  const std::vector<int> start = starting_frames(shown);
  PropagateOptions from = options;
  from.known.clear();
  for (const int frame : start) {
    const Shape& shape = *shown.structure.shape(frame);
    from.known[frame] = *shape.points;
    from.missing_share = std::max(from.missing_share, missing_share_of(shown.the_template(), shape));
  }
  const Mesh mesh{shown.the_template().topology, from.known.at(start.front())};
  auto done = propagate(*scan.image, start.front(), mesh, *shown.paint().stiffness, from);
  if (!done) return fail(done.error());
  CineEdit edit;
  const auto add = [&](int frame, const Points& points, FoundBy by) -> SetPoints& {
    return edit.actions.emplace_back(points_edit(shown, frame, points, by));
  };
  // The mesh that all come from is a person's choice from now on.
  if (!frame_is_known(*shown.structure.shape(start.front()))) add(start.front(), mesh.points, FoundBy::start_of_cine);
  for (std::size_t f = 0; f < done->frames.size(); ++f) {
    if (from.known.contains(static_cast<int>(f))) continue;
    SetPoints& carried = add(static_cast<int>(f), done->frames[f].points, FoundBy::propagation);
    carried.doubt = done->frames[f].doubt;
    done->frames[f].points = *carried.points;
  }
  edit.result = std::move(*done);
  return edit;
}

namespace {

constexpr double within_mm = 0.5, beyond_share = 0.02, least_cavity = 0.2;

/// The part of `inner`'s vertices that lies outside of `outer` by more than a rim needs.
double share_outside(const Points& inner, const Mesh& outer) {
  const SurfaceSearch search(outer);
  Eigen::Index outside = 0;
  for (Eigen::Index v = 0; v < inner.rows(); ++v) {
    const Vec3 p = inner.row(v);
    const auto nearest = search.nearest(p);
    const bool beyond = (p - nearest.position).dot(area_normal(outer, nearest.at.face)) > 0;
    if (beyond && nearest.distance_mm > within_mm) ++outside;
  }
  return static_cast<double>(outside) / static_cast<double>(inner.rows());
}

bool lies_around(const Mesh& outer, const Mesh& inner) {
  const double cavity = enclosed_volume_ml(inner), whole = enclosed_volume_ml(outer);
  return cavity < whole && cavity >= least_cavity * whole &&
         bounds_of(outer.points).intersects(bounds_of(inner.points)) &&
         share_outside(inner.points, outer) <= beyond_share;
}

WallOfFrame wall_between(const Mesh& inner, const Mesh& outer) {
  const SurfaceSearch search(outer);
  std::vector<double> away;
  for (Eigen::Index v = 0; v < inner.points.rows(); ++v)
    away.push_back(search.nearest(Vec3(inner.points.row(v))).distance_mm);
  return {enclosed_volume_ml(outer) - enclosed_volume_ml(inner), quantile(std::move(away), 0.5)};
}

/// A structure and the cavity in it.
struct WallPair {
  const Structure *inner = nullptr, *outer = nullptr;
};

/// The wall in a frame, or as it was known before.
void put_wall(const WallPair& pair, int frame, const VolumeCurve& before, VolumeCurve::Frame& one) {
  const Shape *inner = pair.inner->shape(frame), *outer = pair.outer->shape(frame);
  if (inner == nullptr || outer == nullptr || inner->strokes == 0 || outer->strokes == 0) return;
  one.inner = inner->points;
  one.outer = outer->points;
  const auto known = before.frames.find(frame);
  const bool same =
      known != before.frames.end() && known->second.inner == one.inner && known->second.outer == one.outer;
  one.wall = same ? known->second.wall
                  : wall_between({pair.inner->the_template->topology, *one.inner},
                                 {pair.outer->the_template->topology, *one.outer});
}

/// The meshes that a wall is looked for among: the structure's own in the first frame that was edited, then the
/// others'.
struct WallMeshes {
  int frame = 0;
  std::vector<const Structure*> structures;
  std::vector<std::shared_ptr<const Points>> points;  ///< one for each structure
};

WallMeshes wall_meshes(const Document& document, const Structure& structure) {
  WallMeshes meshes;
  for (const auto& [frame, shape] : structure.shapes) {
    if (shape->strokes == 0) continue;
    meshes = {frame, {&structure}, {shape->points}};
    for (const auto& other : document.structures) {
      const Shape* there = other.get() == &structure ? nullptr : other->shape(frame);
      if (there == nullptr || there->strokes == 0) continue;
      meshes.structures.push_back(other.get());
      meshes.points.push_back(there->points);
    }
    break;
  }
  return meshes;
}

/// The nearest of the others that lies around the structure, or that the structure lies around.
std::optional<WallPair> nearest_wall(const WallMeshes& meshes) {
  std::optional<WallPair> found;
  const auto mesh_of = [&](std::size_t k) {
    return Mesh{meshes.structures[k]->the_template->topology, *meshes.points[k]};
  };
  double thinnest_ml = std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; k < meshes.structures.size(); ++k) {
    const Mesh own = mesh_of(0), other = mesh_of(k);
    const double between_ml = std::abs(enclosed_volume_ml(other) - enclosed_volume_ml(own));
    if (between_ml >= thinnest_ml) continue;
    if (lies_around(other, own))
      found = WallPair{meshes.structures[0], meshes.structures[k]};
    else if (lies_around(own, other))
      found = WallPair{meshes.structures[k], meshes.structures[0]};
    else
      continue;
    thinnest_ml = between_ml;
  }
  return found;
}

/// The wall that a structure has a part in. Once known it stays, as long as both are there. `curve` keeps where none
/// was found, so that it is looked for again only when a mesh has changed.
std::optional<WallPair> wall_of(const Document& document, const Structure& structure, const VolumeCurve& before,
                                VolumeCurve& curve) {
  if (before.inner == structure.id || before.outer == structure.id) {
    const Structure *inner = document.structure(before.inner), *outer = document.structure(before.outer);
    if (!before.inner.empty() && inner != nullptr && outer != nullptr) return WallPair{inner, outer};
  }
  WallMeshes meshes = wall_meshes(document, structure);
  const bool same = !before.looked_at.empty() && meshes.points == before.looked_at;
  const auto found = same ? std::nullopt : nearest_wall(meshes);
  if (!found) curve.looked_at = std::move(meshes.points);
  return found;
}

}  // namespace

VolumeCurve volume_curve(const Document& document, const Structure& structure, const VolumeCurve& before) {
  VolumeCurve curve;
  const auto wall = wall_of(document, structure, before, curve);
  if (wall) curve.inner = wall->inner->id, curve.outer = wall->outer->id;
  std::map<int, double> trusted;
  for (const auto& [frame, shared] : structure.shapes) {
    const Shape& shape = *shared;
    if (shape.strokes == 0) continue;
    VolumeCurve::Frame& one = curve.frames[frame];
    one.points = shape.points;
    one.known = frame_is_known(shape);
    if (!one.known)
      one.doubt = shape.doubt;
    else if (const double missing = missing_share_of(*structure.the_template, shape); missing > 0)
      one.doubt = missing_doubt(missing);
    const auto known = before.frames.find(frame);
    one.volume_ml = known != before.frames.end() && known->second.points == shape.points
                        ? known->second.volume_ml
                        : enclosed_volume_ml({structure.the_template->topology, *shape.points});
    if (wall) put_wall(*wall, frame, before, one);
    if (one.doubt.empty()) trusted[frame] = one.volume_ml;
  }
  if (trusted.size() >= 2) curve.ejection = ejection_of(trusted);
  return curve;
}

std::string volume_table(const VolumeCurve& curve, double frame_seconds) {
  const bool walls = std::any_of(curve.frames.begin(), curve.frames.end(),
                                 [](const auto& one) { return one.second.wall.has_value(); });
  std::string table = "frame,seconds,volume_ml,known,doubt";
  table += walls ? ",wall_ml,wall_mm,mass_g\n" : "\n";
  for (const auto& [frame, one] : curve.frames) {
    char line[96];
    std::snprintf(line, sizeof line, "%d,%.4f,%.3f,%d,", frame, frame * frame_seconds, one.volume_ml,
                  one.known ? 1 : 0);
    table += line + (one.doubt.empty() ? "" : '"' + one.doubt + '"');
    if (one.wall) {
      std::snprintf(line, sizeof line, ",%.3f,%.3f,%.3f", one.wall->volume_ml, one.wall->thickness_mm,
                    one.wall->mass_g());
      table += line;
    } else if (walls) {
      table += ",,,";
    }
    table += '\n';
  }
  return table;
}

}  // namespace homolog
