#include <algorithm>
#include <cmath>

#include "core/base/text/nearest_names.h"
#include "core/base/text/text.h"
#include "core/measure/recipe/step_kinds.h"

namespace homolog {

namespace {

Result<StepValue> named_landmark(Measuring& measuring, const RecipeStep& step) {
  const auto there = measuring.structure(step);
  if (!there) return fail(there.error());
  const auto& landmarks = measuring.surface(*there).structure().landmarks;
  const std::vector<std::string> names =
      measuring.has(step, "landmark") ? measuring.given(step, "landmark").texts : std::vector{step.name};
  for (const std::string& name : names)
    for (const Landmark& landmark : landmarks)
      if (landmark.name == name) return landmark.position;
  std::vector<std::string> known;
  for (const Landmark& landmark : landmarks) known.push_back(landmark.name);
  const auto near = nearest_names(names.front(), known, 1);
  return lacks("has no landmark \"" + excerpt(names.front()) + '"' +
               (near.empty() ? "" : " (the nearest name is \"" + excerpt(near.front()) + "\")"));
}

Result<StepValue> vertex_by_number(Measuring& measuring, const RecipeStep& step) {
  const auto there = measuring.structure(step);
  if (!there) return fail(there.error());
  const Points& points = measuring.surface(*there).mesh().points;
  const double vertex = measuring.number(step, "vertex");
  if (vertex < static_cast<double>(points.rows())) return Vec3(points.row(static_cast<Eigen::Index>(vertex)));
  return lacks("has " + std::to_string(points.rows()) + " vertices and none of number " +
               std::to_string(static_cast<long long>(vertex)));
}

Result<StepValue> place_on_face(Measuring& measuring, const RecipeStep& step) {
  const auto there = measuring.faces(step);
  if (!there) return fail(there.error());
  const Mesh& mesh = measuring.surface(*there).mesh();
  const double face = measuring.number(step, "face");
  if (!(face < static_cast<double>(mesh.topology->triangles().rows())))
    return lacks("has no face of number " + std::to_string(static_cast<long long>(face)));
  const std::vector<double>& given = measuring.given(step, "weights").numbers;
  const Vec3 weights(given[0], given[1], given[2]);
  if (!(weights.minCoeff() >= 0) || !(weights.sum() > 0)) return fail("", "has weights that are not above 0");
  const SurfacePoint at{static_cast<std::int32_t>(face), weights / weights.sum()};
  return Vec3(at.interpolate(*mesh.topology, mesh.points).transpose());
}

Result<StepValue> centroid_of_part(Measuring& measuring, const RecipeStep& step) {
  const auto part = measuring.part(step, "of");
  if (!part) return fail(part.error());
  MeasuredSurface& surface = measuring.surface(part->structure);
  Vec3 sum = Vec3::Zero();
  double weight = 0;
  for (const std::int32_t v : part->vertices) {
    sum += surface.areas()[v] * surface.mesh().points.row(v).transpose();
    weight += surface.areas()[v];
  }
  if (!(weight > 0)) return fail("", "lies on faces without area");
  return Vec3(sum / weight);
}

Vec3 centre_of_section(const SectionValue& section) {
  Vec3 sum = Vec3::Zero();
  double length = 0;
  for (const SectionLine& line : section.lines)
    for (std::size_t k = 0; k < line.points.size(); ++k) {
      if (k + 1 == line.points.size() && !line.closed) break;
      const Vec3 &a = line.points[k], &b = line.points[(k + 1) % line.points.size()];
      sum += (b - a).norm() * (a + b) / 2;
      length += (b - a).norm();
    }
  return length > 0 ? Vec3(sum / length) : section.lines.front().points.front();
}

Result<StepValue> centre_of_step(Measuring& measuring, const RecipeStep& step) {
  const StepValue& of = measuring.of(step, "of");
  if (const auto* sphere = std::get_if<FittedSphere>(&of)) return sphere->centre;
  if (const auto* plane = std::get_if<FittedPlane>(&of)) return plane->at;
  if (const auto* section = std::get_if<SectionValue>(&of)) return centre_of_section(*section);
  return measuring.axis(step, "of").at;
}

Result<StepValue> midpoint(Measuring& measuring, const RecipeStep& step) {
  const std::size_t count = measuring.given(step, "of").steps.size();
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < count; ++k) sum += measuring.point(step, "of", k);
  return Vec3(sum / static_cast<double>(count));
}

Result<StepValue> part_way(Measuring& measuring, const RecipeStep& step) {
  const Vec3 from = measuring.point(step, "from"), to = measuring.point(step, "to");
  return Vec3(from + measuring.number(step, "share") * (to - from));
}

Result<StepValue> projection(Measuring& measuring, const RecipeStep& step) {
  const Vec3 p = measuring.point(step, "of");
  if (const auto* plane = std::get_if<FittedPlane>(&measuring.of(step, "onto")))
    return Vec3(p - (p - plane->at).dot(plane->normal) * plane->normal);
  const LineValue axis = measuring.axis(step, "onto");
  return Vec3(axis.at + (p - axis.at).dot(axis.direction) * axis.direction);
}

/// The point of a line that is nearest to another line, or in which it meets a plane.
Result<StepValue> crossing(Measuring& measuring, const RecipeStep& step) {
  constexpr double parallel = 1e-9;
  const LineValue line = measuring.axis(step, "of");
  if (const auto* plane = std::get_if<FittedPlane>(&measuring.of(step, "with"))) {
    const double slope = line.direction.dot(plane->normal);
    if (std::abs(slope) < parallel) return fail("", "is of a line that is parallel to the plane");
    return Vec3(line.at + (plane->at - line.at).dot(plane->normal) / slope * line.direction);
  }
  const LineValue other = measuring.axis(step, "with");
  const double cosine = line.direction.dot(other.direction), between = 1 - cosine * cosine;
  if (between < parallel) return fail("", "is of parallel lines");
  const Vec3 off = other.at - line.at;
  return Vec3(line.at + (off.dot(line.direction) - cosine * off.dot(other.direction)) / between * line.direction);
}

Result<StepValue> nearest_on_mesh(Measuring& measuring, const RecipeStep& step) {
  const auto there = measuring.faces(step);
  if (!there) return fail(there.error());
  return measuring.surface(*there).search().nearest(measuring.point(step, "of")).position;
}

/// The place where a ray first meets the surface.
Result<StepValue> hit(Measuring& measuring, const RecipeStep& step) {
  const auto there = measuring.faces(step);
  if (!there) return fail(there.error());
  const LineValue along = measuring.axis(step, "along");
  if (!along.directed) return fail("", "goes along an axis without a direction; give that \"towards\"");
  const bool back = measuring.has(step, "backward") && measuring.given(step, "backward").flag;
  const auto met =
      measuring.surface(*there).search().first_hit(measuring.point(step, "from"), (back ? -1 : 1) * along.direction);
  if (!met) return fail("", "meets no surface");
  return met->position;
}

Result<StepValue> farthest_along(Measuring& measuring, const RecipeStep& step) {
  const auto part = measuring.part(step, "of");
  if (!part) return fail(part.error());
  const LineValue along = measuring.axis(step, "along");
  if (!along.directed) return fail("", "goes along an axis without a direction; give that \"towards\"");
  const Points& points = measuring.surface(part->structure).mesh().points;
  const auto height = [&](std::int32_t v) { return points.row(v).dot(along.direction); };
  const auto farthest = std::ranges::max_element(part->vertices, {}, height);
  return Vec3(points.row(*farthest));
}

}  // namespace

const std::vector<StepKind>& point_kinds() {
  constexpr unsigned point = bits(Gives::point), plane = bits(Gives::plane), part = bits(Gives::part);
  constexpr unsigned centred = any_axis | plane | bits(Gives::sphere) | bits(Gives::section);
  static const std::vector<StepKind> kinds{
      {"landmark", Gives::point, "", Draws::nothing, {{"landmark", Takes::texts, 0, 0, 20}}, named_landmark},
      {"vertex", Gives::point, "", Draws::nothing, {{"vertex", Takes::whole_numbers}}, vertex_by_number},
      {"place",
       Gives::point,
       "",
       Draws::nothing,
       {{"face", Takes::whole_numbers}, {"weights", Takes::numbers, 0, 3, 3}},
       place_on_face},
      {"centroid", Gives::point, "", Draws::nothing, {{"of", Takes::steps, part, 0}}, centroid_of_part},
      {"centre", Gives::point, "", Draws::nothing, {{"of", Takes::steps, centred}}, centre_of_step},
      {"midpoint", Gives::point, "", Draws::nothing, {{"of", Takes::steps, point, 2, many}}, midpoint},
      {"part_way",
       Gives::point,
       "",
       Draws::nothing,
       {{"from", Takes::steps, point}, {"to", Takes::steps, point}, {"share", Takes::number}},
       part_way},
      {"projection",
       Gives::point,
       "",
       Draws::nothing,
       {{"of", Takes::steps, point}, {"onto", Takes::steps, any_axis | plane}},
       projection},
      {"crossing",
       Gives::point,
       "",
       Draws::nothing,
       {{"of", Takes::steps, any_axis}, {"with", Takes::steps, any_axis | plane}},
       crossing},
      {"on_surface", Gives::point, "", Draws::nothing, {{"of", Takes::steps, point}}, nearest_on_mesh},
      {"hit",
       Gives::point,
       "",
       Draws::nothing,
       {{"from", Takes::steps, point}, {"along", Takes::steps, any_axis}, {"backward", Takes::flag, 0, 0}},
       hit},
      {"farthest",
       Gives::point,
       "",
       Draws::nothing,
       {{"of", Takes::steps, part, 0}, {"along", Takes::steps, any_axis}},
       farthest_along},
  };
  return kinds;
}

}  // namespace homolog
