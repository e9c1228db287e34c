#include "core/template_making/tube_template.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "core/mesh/isosurface.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/tube_mesh.h"
#include "core/template_making/level_set.h"

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

/// A body and its wall as a level set.
struct Body {
  LevelSet wall;
  Mesh boundary;  ///< of the voxels
  Vec3 centre = Vec3::Zero(), main_axis = Vec3::UnitZ();
  std::optional<std::string> several;  ///< the warning of other parts
};

/// `label`: the outermost, which warnings name.
Result<Body> body_of(const Volume& united, int label) {
  const Vec3& voxel_mm = united.geometry.spacing_mm;
  const LabelExtent extent = label_extent(united, 1, 0);
  const auto region = label_body(united, 1, 0, extent, voxel_mm.minCoeff(), 4 * voxel_mm.minCoeff());
  if (!region) return fail(region.error());
  Body body;
  // A part of a slice's thickness, in which thick slices would show as rings.
  body.wall = smoothed(resampled(signed_distance(region->inside, region->grid), voxel_mm.minCoeff()),
                       std::max(0.5 * voxel_mm.minCoeff(), 0.2 * voxel_mm.maxCoeff()));
  body.several = several_parts(*region, label);
  auto boundary = boundary_of(*region);
  if (!boundary) return fail(boundary.error());
  body.boundary = std::move(*boundary);

  const VolumeGeometry& grid = body.wall.grid();
  Mat3 spread = Mat3::Zero();
  double count = 0;
  std::size_t v = 0;
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i)
        if (body.wall.values()[v++] < 0) {
          const Vec3 p = grid.to_mm({1.0 * i, 1.0 * j, 1.0 * k});
          body.centre += p;
          spread += p * p.transpose();
          ++count;
        }
  if (count == 0) return fail("", "the label is too thin to be sampled; use a finer label map");
  body.centre /= count;
  spread = spread / count - body.centre * body.centre.transpose();
  body.main_axis = Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvectors().col(2);
  return body;
}

/// The part of the line through `centre` along `axis` that is inside, as distances from `centre`.
std::pair<double, double> inside_along(const LevelSet& wall, const Vec3& centre, const Vec3& axis) {
  const double step = 0.25 * wall.spacing_mm(), reach = wall.grid().bounds_mm().diagonal().norm();
  const auto steps = static_cast<int>(std::min(2 * reach / step, 1e6));
  std::pair<double, double> part{0, 0};
  bool any = false;
  double t = -reach;
  for (int k = 0; k <= steps; ++k, t += step) {
    if (wall.sample(centre + t * axis).value >= 0) continue;
    if (!any) part.first = t;
    part.second = t;
    any = true;
  }
  return part;
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

/// The ring in the plane through `near` perpendicular to the axis, around the middle of the body's section there.
Ring ring_at(const LevelSet& wall, const Frame& frame, int sectors, const Vec3& near) {
  Ring ring{near, {}};
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

/// Whether all of a ring lies on the side wall, none on the flat end of a label map that ends at the base.
bool on_side_wall(const Ring& ring, const LevelSet& wall, const Vec3& axis) {
  return !ring.points.empty() && std::all_of(ring.points.begin(), ring.points.end(), [&](const Vec3& p) {
    return std::abs(wall.sample(p).gradient.normalized().dot(axis)) < 0.75;
  });
}

/// A tube's extent along its axis.
struct Extent {
  Vec3 base, apex;  ///< on the axis
};

Extent extent_of(const LevelSet& wall, const Vec3& centre, const Frame& frame) {
  const auto [start, end] = inside_along(wall, centre, frame.axis);
  double t = start;
  const double step = 0.25 * wall.spacing_mm();
  while (t < start + 0.4 * (end - start) &&
         !on_side_wall(ring_at(wall, frame, 32, centre + t * frame.axis), wall, frame.axis))
    t += step;
  return {centre + t * frame.axis, centre + end * frame.axis};
}

/// Rings at equal steps along the mean wall from the base to the apex.
Result<std::vector<Ring>> even_rings(const LevelSet& wall, const Frame& frame, const Extent& extent, int rings,
                                     int sectors) {
  constexpr int samples = 150;
  const Vec3 way = extent.apex - extent.base;
  std::vector<double> walked{0}, place{0};
  double radius = mean_radius(ring_at(wall, frame, 32, extent.base));
  for (int s = 1; s <= samples; ++s) {
    const double t = static_cast<double>(s) / samples;
    const Ring ring = s < samples ? ring_at(wall, frame, 32, extent.base + t * way) : Ring{};
    if (s < samples && ring.points.empty()) continue;  // the last hair's breadth before the apex
    const double here = mean_radius(ring);
    walked.push_back(walked.back() + std::hypot((t - place.back()) * way.norm(), here - radius));
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
    result.push_back(ring_at(wall, frame, sectors, extent.base + t * way));
    if (result.back().points.empty())
      return fail("", "the organ has no closed outline around the axis at ring " + std::to_string(r) +
                          "; give another --axis, or make the template without --tube");
  }
  return result;
}

/// One sheet's vertices, as tube_triangles() numbers them.
Points sheet_points(const LevelSet& wall, const Frame& frame, const std::vector<Ring>& rings, bool capped) {
  std::vector<Vec3> vertices;
  for (const Ring& ring : rings) vertices.insert(vertices.end(), ring.points.begin(), ring.points.end());
  vertices.push_back(rings.back().middle + wall_distance(wall, rings.back().middle, frame.axis) * frame.axis);
  if (capped) vertices.push_back(rings.front().middle);
  Points points(static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t v = 0; v < vertices.size(); ++v) points.row(static_cast<Eigen::Index>(v)) = vertices[v];
  return points;
}

/// The main axis with the apex, the narrower end, ahead.
Vec3 towards_narrower_end(const Body& body) {
  const Frame frame = frame_of(body.main_axis);
  const auto [start, end] = inside_along(body.wall, body.centre, frame.axis);
  const auto radius_at = [&, from = start, to = end](double share) {
    return mean_radius(ring_at(body.wall, frame, 32, body.centre + (from + share * (to - from)) * frame.axis));
  };
  return radius_at(0.85) <= radius_at(0.15) ? frame.axis : Vec3(-frame.axis);
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

Mesh united(const Mesh& a, const Mesh& b) {
  Points points(a.points.rows() + b.points.rows(), 3);
  points << a.points, b.points;
  Triangles triangles(a.topology->triangles().rows() + b.topology->triangles().rows(), 3);
  triangles << a.topology->triangles(),
      (b.topology->triangles().array() + static_cast<std::int32_t>(a.points.rows())).matrix();
  return {Topology::make(points.rows(), std::move(triangles)).value(), std::move(points)};
}

}  // namespace

Result<TubeTemplate> make_tube_template(const Volume& mask, const TubeTemplateOptions& options) {
  assert(options.rings >= 2 && options.sectors >= 3);
  std::vector<Body> bodies;
  for (const auto& labels : options.outer_label
                                ? std::vector<std::vector<int>>{{options.label}, {options.label, *options.outer_label}}
                                : std::vector<std::vector<int>>{{options.label}}) {
    auto body = body_of(with_labels(mask, labels, options.frame), labels.back());
    if (!body) return fail("", label_name(labels.back()) + " does not occur in the label map; name one that does");
    if (!bodies.empty()) body->wall = around(body->wall, bodies.front().wall, mask.geometry.spacing_mm.minCoeff());
    bodies.push_back(std::move(*body));
  }

  const Body& inner = bodies.front();
  Vec3 centre = inner.centre;
  Frame frame;
  if (options.base_and_apex) {
    centre = options.base_and_apex->first;
    frame = frame_of((options.base_and_apex->second - centre).normalized());
  } else {
    frame = frame_of(options.axis ? options.axis->normalized() : towards_narrower_end(inner));
  }
  TubeTemplate made;
  for (const Body& body : bodies)
    if (body.several) made.warnings.push_back(*body.several);
  made.axis = frame.axis;
  std::optional<Mesh> boundary;
  Vec3 base = options.base_and_apex ? options.base_and_apex->first : extent_of(inner.wall, centre, frame).base;
  for (const Body& body : bodies) {
    Extent extent = extent_of(body.wall, centre, frame);
    extent.base = base;
    const auto rings = even_rings(body.wall, frame, extent, options.rings, options.sectors);
    if (!rings) return fail(rings.error());
    const Points points = sheet_points(body.wall, frame, *rings, options.capped);
    auto topology = Topology::make(points.rows(), tube_triangles(options.rings, options.sectors, options.capped));
    const Mesh sheet{topology.value(), points};
    made.mesh = made.mesh.topology ? united(made.mesh, sheet) : sheet;
    boundary = boundary ? united(*boundary, body.boundary) : body.boundary;
  }
  const Mesh closed = capped(made.mesh);
  made.to_mask = surface_distance(closed, *boundary);
  made.from_mask = surface_distance(*boundary, closed);
  return made;
}

}  // namespace homolog
