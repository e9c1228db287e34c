#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "core/measure/recipe/step_kinds.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

/// Which vertices of a mesh are in a part.
std::vector<char> in_part(const PartValue& part, const Mesh& mesh) {
  std::vector<char> in(static_cast<std::size_t>(mesh.points.rows()), 0);
  for (const std::int32_t v : part.vertices) in[v] = 1;
  return in;
}

/// The faces all of whose corners are in a part.
std::vector<Eigen::Index> faces_of_part(const PartValue& part, const Mesh& mesh) {
  const std::vector<char> in = in_part(part, mesh);
  const Triangles& triangles = mesh.topology->triangles();
  std::vector<Eigen::Index> faces;
  for (Eigen::Index f = 0; f < triangles.rows(); ++f)
    if (in[triangles(f, 0)] && in[triangles(f, 1)] && in[triangles(f, 2)]) faces.push_back(f);
  return faces;
}

Result<PartValue> part_with_faces(const Measuring& measuring, const RecipeStep& step) {
  auto part = measuring.part(step, "of");
  if (!part) return part;
  if (auto sound = measuring.check_faces(part->structure); !sound) return fail(sound.error());
  return part;
}

Result<StepValue> area(Measuring& measuring, const RecipeStep& step) {
  if (measuring.has(step, "of"))
    if (const auto* section = std::get_if<SectionValue>(&measuring.of(step, "of")))
      return area_within_mm2(section->lines, section->normal);
  const auto part = part_with_faces(measuring, step);
  if (!part) return fail(part.error());
  const Mesh& mesh = measuring.surface(part->structure).mesh();
  double sum = 0;
  for (const Eigen::Index f : faces_of_part(*part, mesh)) sum += area_normal(mesh, f).norm() / 2;
  return sum;
}

/// Six times the volume between a triangle and a point.
double six_volumes(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& from) {
  return (a - from).dot((b - from).cross(c - from));
}

/// The volume within faces, mm³. Each rim that they leave is closed by a fan around its middle.
double volume_within_mm3(const Mesh& mesh, const std::vector<Eigen::Index>& faces) {
  const Triangles& triangles = mesh.topology->triangles();
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;  // edges of faces, without those that come both ways
  const Vec3 middle = bounds_of(mesh.points).center();
  double six = 0;
  for (const Eigen::Index f : faces) {
    six += six_volumes(mesh.points.row(triangles(f, 0)), mesh.points.row(triangles(f, 1)),
                       mesh.points.row(triangles(f, 2)), middle);
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = triangles(f, k), b = triangles(f, (k + 1) % 3);
      if (edges.erase({b, a}) == 0) edges[{a, b}] = 1;
    }
  }
  // Edges of one rim hang together: each of its vertices leads to the rim's first.
  std::map<std::int32_t, std::int32_t> leads;
  const auto root = [&](std::int32_t v) {
    while (leads.at(v) != v) v = leads[v] = leads.at(leads.at(v));
    return v;
  };
  for (const auto& [edge, unused] : edges) {
    leads.try_emplace(edge.first, edge.first);
    leads.try_emplace(edge.second, edge.second);
    const std::int32_t a = root(edge.first), b = root(edge.second);
    leads[std::max(a, b)] = std::min(a, b);
  }
  std::map<std::int32_t, std::pair<Vec3, int>> rims;
  for (const auto& [v, unused] : leads) {
    auto& [sum, count] = rims.try_emplace(root(v), Vec3::Zero(), 0).first->second;
    sum += mesh.points.row(v).transpose();
    ++count;
  }
  for (const auto& [edge, unused] : edges) {
    const auto& [sum, count] = rims.at(root(edge.first));
    six += six_volumes(mesh.points.row(edge.second), mesh.points.row(edge.first), sum / count, middle);
  }
  return six / 6;
}

Result<StepValue> volume(Measuring& measuring, const RecipeStep& step) {
  const auto part = part_with_faces(measuring, step);
  if (!part) return fail(part.error());
  const Mesh& mesh = measuring.surface(part->structure).mesh();
  const auto faces = faces_of_part(*part, mesh);
  if (faces.empty()) return fail("", "is of a part without faces");
  constexpr double mm3_in_ml = 1000;
  if (faces.size() == static_cast<std::size_t>(mesh.topology->triangles().rows())) return enclosed_volume_ml(mesh);
  return volume_within_mm3(mesh, faces) / mm3_in_ml;
}

/// A value of a vertex, and the area that it stands for.
using Weighed = std::pair<double, double>;

double statistic_of(std::vector<Weighed> values, const std::string& statistic) {
  std::ranges::sort(values);
  if (statistic == "min") return values.front().first;
  if (statistic == "max") return values.back().first;
  double area = 0, sum = 0;
  for (const auto& [value, weight] : values) area += weight, sum += value * weight;
  if (statistic == "mean") return sum / area;
  double passed = 0;
  for (const auto& [value, weight] : values)
    if ((passed += weight) >= area / 2) return value;
  return values.back().first;
}

std::string statistic_asked(const Measuring& measuring, const RecipeStep& step) {
  return measuring.has(step, "statistic") ? measuring.given(step, "statistic").texts.front() : "mean";
}

/// The way of a ray from a vertex out of the solid that it goes through; none: it meets no surface, or enters one.
std::optional<double> own_wall_mm(const SurfaceSearch& search, const Vec3& from, const Vec3& direction,
                                  double skip_mm) {
  const auto hit = search.first_hit(from + skip_mm * direction, direction);
  if (!hit || area_normal(search.mesh(), hit->at.face).dot(direction) <= 0) return std::nullopt;
  return (hit->position - from).norm();
}

/// The way of a ray to the first of these faces, whatever lies before; none: it meets none.
std::optional<double> other_wall_mm(const SurfaceSearch& search, const std::vector<char>& faces, const Vec3& from,
                                    const Vec3& direction, double skip_mm) {
  Vec3 at = from;
  for (std::size_t passed = 0; passed <= faces.size(); ++passed) {
    const auto hit = search.first_hit(at + skip_mm * direction, direction);
    if (!hit) return std::nullopt;
    if (faces[hit->at.face] != 0) return (hit->position - from).norm();
    at = hit->position;
  }
  return std::nullopt;
}

Result<StepValue> thickness(Measuring& measuring, const RecipeStep& step) {
  const auto part = part_with_faces(measuring, step);
  if (!part) return fail(part.error());
  const bool to_other = measuring.has(step, "to");
  const std::size_t other = to_other ? measuring.as<PartValue>(step, "to").structure : part->structure;
  if (auto sound = measuring.check_faces(other); !sound) return fail(sound.error());
  std::vector<char> to_faces;
  if (to_other) {
    const Mesh& mesh = measuring.surface(other).mesh();
    to_faces.resize(static_cast<std::size_t>(mesh.topology->triangles().rows()));
    for (const Eigen::Index f : faces_of_part(measuring.as<PartValue>(step, "to"), mesh)) to_faces[f] = 1;
  }
  MeasuredSurface& surface = measuring.surface(part->structure);
  const bool outward =
      measuring.has(step, "direction") && measuring.given(step, "direction").texts.front() == "outward";
  const double most_mm = measuring.number(step, "at_most_mm", std::numeric_limits<double>::infinity());
  // The faces around the vertex itself are passed over.
  const double skip_mm = 1e-3 * mean_edge_mm(*surface.mesh().topology, surface.mesh().points);
  std::vector<Weighed> values;
  double missed = 0, all = 0;
  for (const std::int32_t v : part->vertices) {
    const Vec3 direction = (outward ? 1 : -1) * surface.normals().row(v).transpose();
    const double weight = surface.areas()[v];
    all += weight;
    const SurfaceSearch& search = measuring.surface(other).search();
    const Vec3 from = surface.mesh().points.row(v);
    const auto mm = to_other ? other_wall_mm(search, to_faces, from, direction, skip_mm)
                             : own_wall_mm(search, from, direction, skip_mm);
    if (mm && *mm <= most_mm)
      values.emplace_back(*mm, weight);
    else
      missed += weight;
  }
  if (values.empty() || missed > all / 2) return fail("", "meets no opposite surface along most normals");
  return statistic_of(std::move(values), statistic_asked(measuring, step));
}

Result<StepValue> image_along_normals(Measuring& measuring, const RecipeStep& step) {
  const auto part = part_with_faces(measuring, step);
  if (!part) return fail(part.error());
  const MeasuredShape& shape = measuring.shape();
  if (shape.image == nullptr) return lacks("has no image");
  MeasuredSurface& surface = measuring.surface(part->structure);
  const double from_mm = measuring.number(step, "from_mm", 0), to_mm = measuring.number(step, "to_mm", 0);
  constexpr double step_mm = 0.25;
  const int steps = 1 + static_cast<int>(std::min(1000.0, std::ceil(std::abs(to_mm - from_mm) / step_mm)));
  const VertexScalars means =
      profile_along_normals(surface.mesh(), *shape.image, shape.frame, from_mm, to_mm, steps).mean();
  std::vector<Weighed> values;
  for (const std::int32_t v : part->vertices)
    if (std::isfinite(means[v])) values.emplace_back(means[v], surface.areas()[v]);
  if (values.size() * 2 < part->vertices.size()) return fail("", "lies outside of the image for the most part");
  return statistic_of(std::move(values), statistic_asked(measuring, step));
}

}  // namespace

const std::vector<StepKind>& surface_kinds() {
  constexpr unsigned part = bits(Gives::part);
  const StepMember of_part{"of", Takes::steps, part, 0};
  const StepMember statistic{"statistic", Takes::text, 0, 0, 1, {"mean", "median", "min", "max"}};
  static const std::vector<StepKind> kinds{
      {"area", Gives::number, "mm2", Draws::area, {{"of", Takes::steps, part | bits(Gives::section), 0}}, area},
      {"volume", Gives::number, "ml", Draws::nothing, {of_part}, volume},
      {"thickness",
       Gives::number,
       "mm",
       Draws::nothing,
       {of_part,
        {"to", Takes::steps, part, 0},
        {"direction", Takes::text, 0, 0, 1, {"inward", "outward"}},
        {"at_most_mm", Takes::length, 0, 0},
        statistic},
       thickness},
      {"image_mean",
       Gives::number,
       "image",
       Draws::nothing,
       {of_part, {"from_mm", Takes::length, 0, 0}, {"to_mm", Takes::length, 0, 0}, statistic},
       image_along_normals},
  };
  return kinds;
}

std::vector<const StepKind*> step_kinds() {
  std::vector<const StepKind*> all;
  for (const auto* kinds : {&point_kinds(), &fit_kinds(), &part_kinds(), &length_kinds(), &surface_kinds()})
    for (const StepKind& kind : *kinds) all.push_back(&kind);
  return all;
}

}  // namespace homolog
