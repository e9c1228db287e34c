#include "core/template_making/tube_template.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/mesh/construction/tube_mesh.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/template_making/tube_body.h"

namespace homolog {
namespace {

/// Three directions of a tube: `axis` from the base to the apex, `first` that of sector 0.
struct Frame {
  Vec3 axis, first, second;
};

Frame frame_of(const Vec3& axis) {
  const Vec3 anterior = -Vec3::UnitY(), superior = Vec3::UnitZ();
  const Vec3 towards = std::abs(axis.dot(anterior)) < 0.9 ? anterior : superior;
  Frame frame;
  frame.axis = axis;
  frame.first = (towards - towards.dot(axis) * axis).normalized();
  frame.second = frame.first.cross(axis);  // counter-clockwise seen from beyond the base
  return frame;
}

Volume with_labels(const Volume& mask, const std::vector<int>& labels, int frame) {
  Volume united;
  united.geometry = mask.geometry;
  std::vector<std::uint8_t> voxels(mask.geometry.voxels(), 0);
  std::visit(
      [&](const auto& data) {
        const std::size_t start = static_cast<std::size_t>(frame) * voxels.size();
        for (std::size_t v = 0; v < voxels.size(); ++v)
          voxels[v] = std::any_of(labels.begin(), labels.end(), [&](int l) { return has_label(data[start + v], l); });
      },
      mask.data);
  united.data = std::move(voxels);
  return united;
}

/// How far the wall is from `centre` in a direction; 0 where the centre is outside.
double wall_distance(const LevelSet& wall, const Vec3& centre, const Vec3& direction) {
  const double step = 0.5 * wall.spacing_mm(), reach = wall.grid().bounds_mm().diagonal().norm();
  double inner = 0;
  if (wall.sample(centre).value >= 0) return 0;
  while (inner < reach && wall.sample(centre + (inner + step) * direction).value < 0) inner += step;
  double outer = inner + step;
  for (int round = 0; round < 30; ++round) {
    const double middle = 0.5 * (inner + outer);
    (wall.sample(centre + middle * direction).value < 0 ? inner : outer) = middle;
  }
  return 0.5 * (inner + outer);
}

struct Ring {
  Vec3 middle = Vec3::Zero();
  std::vector<Vec3> points;  ///< one a sector; empty where the plane finds no wall
};

/// A point inside in the plane through `near` perpendicular to the axis: `near`, or what lies towards the inside.
Vec3 inside_near(const LevelSet& wall, const Vec3& axis, Vec3 near) {
  constexpr int rounds = 40;
  for (int round = 0; round < rounds; ++round) {
    const auto [value, gradient] = wall.sample(near);
    if (value < 0) break;
    const Vec3 across = gradient - gradient.dot(axis) * axis;
    if (across.norm() < 1e-6) break;
    near -= (value + 0.5 * wall.spacing_mm()) * across.normalized();
  }
  return near;
}

/// The ring in the plane through `near` perpendicular to the axis, around the middle of the body's section there.
Ring ring_at(const LevelSet& wall, const Frame& frame, int sectors, const Vec3& near) {
  Ring ring{inside_near(wall, frame.axis, near), {}};
  for (int round = 0; round < 6; ++round) {
    ring.points.clear();
    Vec3 sum = Vec3::Zero();
    double weight = 0;
    for (int sector = 0; sector < sectors; ++sector) {
      const double angle = 2 * std::numbers::pi * sector / sectors;
      const Vec3 direction = std::cos(angle) * frame.first + std::sin(angle) * frame.second;
      const double distance = wall_distance(wall, ring.middle, direction);
      if (distance <= 0) return {near, {}};
      ring.points.emplace_back(ring.middle + distance * direction);
      sum += distance * distance * (ring.middle + 2.0 / 3.0 * distance * direction);  // a wedge and its centroid
      weight += distance * distance;
    }
    if (round < 5) ring.middle = sum / weight;
  }
  return ring;
}

double mean_radius(const Ring& ring) {
  double sum = 0;
  for (const Vec3& p : ring.points) sum += (p - ring.middle).norm();
  return ring.points.empty() ? 0 : sum / static_cast<double>(ring.points.size());
}

double area_of(const Ring& ring, const Vec3& axis) {
  double twice = 0;
  for (std::size_t s = 0; s < ring.points.size(); ++s)
    twice += (ring.points[s] - ring.middle).cross(ring.points[(s + 1) % ring.points.size()] - ring.middle).dot(axis);
  return 0.5 * std::abs(twice);
}

/// Whether all of a ring lies on the side wall, none on the flat end of a label map that ends at the base.
bool on_side_wall(const Ring& ring, const LevelSet& wall, const Vec3& axis) {
  return !ring.points.empty() && std::all_of(ring.points.begin(), ring.points.end(), [&](const Vec3& p) {
    return std::abs(wall.sample(p).gradient.normalized().dot(axis)) < 0.75;
  });
}

/// The rings of one sheet are cut from this.
class Sheet {
 public:
  Sheet(const TubeBody& body, TubeWall wall, const Frame& frame)
      : wall_(std::move(wall)), frame_(frame), line_(body.region, frame.axis), side_mm_(wall_.base_mm) {
    if (!wall_.flat_base) find_side(body.region);
  }

  /// The begin of the tube by default: at the label's end. If that is slanted, half of it lies on either side.
  double base_mm() const { return base_mm_.value_or(wall_.base_mm); }
  double apex_mm() const { return wall_.apex_mm; }
  const Vec3& axis() const { return frame_.axis; }
  const LevelSet& wall() const { return wall_.wall; }

  /// The ring at a height; before the side wall begins, as there.
  Ring ring(double height_mm, int sectors) const {
    const double within = std::max(height_mm, side_mm_);
    Ring ring = ring_at(wall_.wall, frame_, sectors, line_.at(within));
    const Vec3 back = (height_mm - within) * frame_.axis;
    ring.middle += back;
    for (Vec3& p : ring.points) p += back;
    return ring;
  }

  Vec3 apex(const Ring& last) const {
    const double ahead = wall_.flat_base ? wall_.apex_mm - last.middle.dot(frame_.axis)
                                         : wall_distance(wall_.wall, last.middle, frame_.axis);
    return last.middle + ahead * frame_.axis;
  }

 private:
  /// Finds where the side wall begins behind the label's end, and where to begin so that as much lies before it.
  void find_side(const LabelBody& region) {
    const double step = 0.25 * wall_.wall.spacing_mm();
    const double farthest = wall_.base_mm + 0.4 * (wall_.apex_mm - wall_.base_mm);
    double height = wall_.base_mm;
    Ring here;
    for (; height < farthest; height += step) {
      here = ring_at(wall_.wall, frame_, 32, line_.at(height));
      if (on_side_wall(here, wall_.wall, frame_.axis)) break;
    }
    side_mm_ = height;
    if (const double area = area_of(here, frame_.axis); area > 0)
      base_mm_ = std::max(wall_.base_mm, height - volume_below(region, frame_.axis, height) / area);
  }

  TubeWall wall_;
  const Frame& frame_;
  CentreLine line_;
  double side_mm_;
  std::optional<double> base_mm_;
};

/// A ring on the cone from it to the apex, for ends that are flat.
void narrow(Ring& ring, const Vec3& apex, double share) {
  for (Vec3& p : ring.points) p += share * (apex - p);
  ring.middle += share * (apex - ring.middle);
}

/// Rings at equal steps along the mean wall from `base_mm` to the apex.
Result<std::vector<Ring>> even_rings(const Sheet& sheet, double base_mm, int rings, int sectors) {
  constexpr int samples = 150;
  const double way = sheet.apex_mm() - base_mm;
  std::vector<double> walked{0}, place{0};
  double radius = mean_radius(sheet.ring(base_mm, 32));
  for (int s = 1; s <= samples; ++s) {
    const double t = static_cast<double>(s) / samples;
    const Ring ring = s < samples ? sheet.ring(base_mm + t * way, 32) : Ring{};
    if (s < samples && ring.points.empty()) continue;  // the last hair's breadth before the apex
    const double here = mean_radius(ring);
    walked.push_back(walked.back() + std::hypot((t - place.back()) * way, here - radius));
    place.push_back(t);
    radius = here;
  }
  std::vector<Ring> result;
  std::size_t next = 1;
  for (int r = 0; r < rings; ++r) {
    const double wanted = walked.back() * r / rings;
    while (next + 1 < walked.size() && walked[next] < wanted) ++next;
    const double share = (wanted - walked[next - 1]) / std::max(1e-12, walked[next] - walked[next - 1]);
    const double t = place[next - 1] + share * (place[next] - place[next - 1]);
    const bool closing = next + 1 == walked.size();
    result.push_back(sheet.ring(base_mm + (closing ? place[next - 1] : t) * way, sectors));
    if (closing) narrow(result.back(), sheet.apex(result.back()), share);
    if (result.back().points.empty())
      return fail("", "the organ has no closed outline around the axis at ring " + std::to_string(r) +
                          "; give another --axis, or make the template without --tube");
  }
  return result;
}

/// One sheet's vertices, as tube_triangles() numbers them.
/// `lift_mm`: how far the cap's middle lies beyond the base.
Points sheet_points(const Sheet& sheet, const std::vector<Ring>& rings, bool capped, double lift_mm) {
  std::vector<Vec3> vertices;
  for (const Ring& ring : rings) vertices.insert(vertices.end(), ring.points.begin(), ring.points.end());
  vertices.push_back(sheet.apex(rings.back()));
  if (capped) vertices.push_back(rings.front().middle - lift_mm * sheet.axis());
  Points points(static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t v = 0; v < vertices.size(); ++v) points.row(static_cast<Eigen::Index>(v)) = vertices[v];
  return points;
}

/// `outer`, at least `wall_mm` around `inner`: label maps often end at the apex with the cavity bare.
LevelSet around(const LevelSet& outer, const LevelSet& inner, double wall_mm) {
  const VolumeGeometry& grid = outer.grid();
  std::vector<float> values = outer.values();
  std::size_t v = 0;
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i, ++v) {
        const double beside = inner.sample(grid.to_mm({1.0 * i, 1.0 * j, 1.0 * k})).value - wall_mm;
        values[v] = std::min(values[v], static_cast<float>(beside));
      }
  return {grid, std::move(values)};
}

LevelSet moved_out(const LevelSet& wall, double mm) {
  std::vector<float> values = wall.values();
  for (float& value : values) value -= static_cast<float>(mm);
  return {wall.grid(), std::move(values)};
}

Mesh united(const Mesh& a, const Mesh& b) {
  Points points(a.points.rows() + b.points.rows(), 3);
  points << a.points, b.points;
  Triangles triangles(a.topology->triangles().rows() + b.topology->triangles().rows(), 3);
  triangles << a.topology->triangles(),
      (b.topology->triangles().array() + static_cast<std::int32_t>(a.points.rows())).matrix();
  return {Topology::make(points.rows(), std::move(triangles)).value(), std::move(points)};
}

/// A tube along one axis.
struct Tube {
  Frame frame;
  Mesh mesh, inner;  ///< all sheets; the inner one
  Overlap overlap;   ///< the inner one's overlap with its label
};

/// One sheet as a mesh, from `base_mm` on.
Result<Mesh> sheet_mesh(const Sheet& sheet, double base_mm, const TubeTemplateOptions& options, double lift_mm = 0) {
  const auto rings = even_rings(sheet, base_mm, options.rings, options.sectors);
  if (!rings) return fail(rings.error());
  const Points points = sheet_points(sheet, *rings, options.capped, lift_mm);
  return Mesh{Topology::make(points.rows(), tube_triangles(options.rings, options.sectors, options.capped)).value(),
              points};
}

/// The wall moved by less than half of a voxel, so that the sheet holds as much as the label has from `base_mm` on:
/// smoothing and the steps between thick slices cost some of it.
Result<TubeWall> evened_out(const TubeBody& body, TubeWall wall, const Frame& frame, double base_mm, double voxel_mm,
                            const TubeTemplateOptions& options) {
  const auto sheet = sheet_mesh(Sheet(body, wall, frame), base_mm, options);
  if (!sheet) return fail(sheet.error());
  const double wanted_mm3 = body.volume_mm3() - volume_below(body.region, frame.axis, base_mm);
  const double lacks_mm = (wanted_mm3 - 1000 * enclosed_volume_ml(*sheet)) / surface_area_mm2(*sheet);
  wall.wall = moved_out(wall.wall, std::clamp(lacks_mm, -0.5 * voxel_mm, 0.5 * voxel_mm));
  return wall;
}

/// `bodies`: the inner one, then that around both. `wall_mm`: between the sheets at least.
Result<Tube> tube_along(const std::vector<TubeBody>& bodies, const Vec3& axis, double wall_mm,
                        const TubeTemplateOptions& options) {
  Tube tube;
  tube.frame = frame_of(axis);
  std::vector<Sheet> sheets;
  double base_mm = 0;
  for (const TubeBody& body : bodies) {
    TubeWall wall = tube_wall(body, axis);
    if (sheets.empty()) {
      base_mm = Sheet(body, wall, tube.frame).base_mm();
      if (options.base_and_apex) base_mm = std::max(base_mm, options.base_and_apex->first.dot(axis));
      if (base_mm >= wall.apex_mm)
        return fail("", "the label ends before the base that was given; give a point on it, and one towards the apex");
      auto evened = evened_out(body, std::move(wall), tube.frame, base_mm, wall_mm, options);
      if (!evened) return fail(evened.error());
      wall = std::move(*evened);
    } else {
      wall.wall = around(wall.wall, sheets.front().wall(), wall_mm);
      wall.apex_mm = std::max(wall.apex_mm, sheets.front().apex_mm() + wall_mm);
    }
    sheets.emplace_back(body, std::move(wall), tube.frame);
  }
  for (const Sheet& sheet : sheets) {
    // Caps in one plane would cut each other: the outer one is a hair's breadth higher in the middle.
    auto made = sheet_mesh(sheet, base_mm, options, tube.mesh.topology ? 0.01 * wall_mm : 0);
    if (!made) return fail(made.error());
    if (!tube.mesh.topology) tube.inner = *made;
    tube.mesh = tube.mesh.topology ? united(tube.mesh, *made) : *made;
  }
  tube.overlap = overlap_of(bodies.front().region, tube.inner);
  return tube;
}

/// Along the axis that was given, or along the best one. A likelier axis stays where another is hardly better.
Result<Tube> best_tube(const std::vector<TubeBody>& bodies, double wall_mm, const TubeTemplateOptions& options) {
  constexpr double clearly_better = 0.01;
  if (options.base_and_apex) {
    const auto& [base, apex] = *options.base_and_apex;
    return tube_along(bodies, (apex - base).normalized(), wall_mm, options);
  }
  if (options.axis) return tube_along(bodies, options.axis->normalized(), wall_mm, options);
  std::optional<Result<Tube>> best;
  for (const Vec3& axis : likely_axes(bodies.front())) {
    auto tube = tube_along(bodies, towards_smaller_end(bodies.front().region, axis), wall_mm, options);
    if (!best || (tube && (!*best || tube->overlap.dice() > (*best)->overlap.dice() + clearly_better)))
      best = std::move(tube);
  }
  return std::move(*best);
}

}  // namespace

std::string missing_from(const TubeTemplate& made, int label) {
  if (made.missing_share <= most_missing_share) return {};
  return std::to_string(std::lround(100 * made.missing_share)) + " % of " + label_name(label) +
         " is not in the template";
}

Result<TubeTemplate> make_tube_template(const Volume& mask, const TubeTemplateOptions& options) {
  if (options.rings < 2 || options.sectors < 3)
    return fail("", "a tube has at least 2 rings and 3 sectors; give as many or more");
  std::vector<TubeBody> bodies;
  for (const auto& labels : options.outer_label
                                ? std::vector<std::vector<int>>{{options.label}, {options.label, *options.outer_label}}
                                : std::vector<std::vector<int>>{{options.label}}) {
    auto body = tube_body(with_labels(mask, labels, options.frame), labels.back());
    if (!body) return fail("", label_name(labels.back()) + " does not occur in the label map; name one that does");
    bodies.push_back(std::move(*body));
  }
  auto tube = best_tube(bodies, mask.geometry.spacing_mm.minCoeff(), options);
  if (!tube) return fail(tube.error());

  TubeTemplate made;
  std::optional<Mesh> boundary;
  for (const TubeBody& body : bodies) {
    if (body.several) made.warnings.push_back(*body.several);
    boundary = boundary ? united(*boundary, body.boundary) : body.boundary;
  }
  made.mesh = std::move(tube->mesh);
  made.axis = tube->frame.axis;
  made.volume_ml = enclosed_volume_ml(tube->inner);
  made.label_ml = bodies.front().volume_mm3() / 1000;
  made.missing_share = tube->overlap.missing;
  const Mesh closed = capped(made.mesh);
  made.to_mask = surface_distance(closed, *boundary);
  made.from_mask = surface_distance(*boundary, closed);
  return made;
}

}  // namespace homolog
