#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/measure/recipe/step_kinds.h"
#include "core/measure/surface_path.h"

namespace homolog {

namespace {

constexpr double deg = 180 / std::numbers::pi;

const Vec3* as_point(const StepValue& value) {
  return std::get_if<Vec3>(&value);
}

double distance_of_lines(const LineValue& a, const LineValue& b) {
  const Vec3 across = a.direction.cross(b.direction), off = b.at - a.at;
  constexpr double parallel = 1e-9;
  if (across.norm() < parallel) return (off - off.dot(a.direction) * a.direction).norm();
  return std::abs(off.dot(across)) / across.norm();
}

Result<StepValue> distance_between(Measuring& measuring, const RecipeStep& step) {
  const char *one = "from", *other = "to";
  if (as_point(measuring.of(step, one)) == nullptr) std::swap(one, other);
  const StepValue& second = measuring.of(step, other);
  if (const Vec3* p = as_point(measuring.of(step, one))) {
    if (const Vec3* q = as_point(second)) return (*q - *p).norm();
    if (const auto* plane = std::get_if<FittedPlane>(&second)) return std::abs((*p - plane->at).dot(plane->normal));
    const LineValue axis = measuring.axis(step, other);
    const Vec3 off = *p - axis.at;
    return (off - off.dot(axis.direction) * axis.direction).norm();
  }
  const auto is_plane = [&](const char* key) { return std::holds_alternative<FittedPlane>(measuring.of(step, key)); };
  if (is_plane("from") || is_plane("to")) return fail("", "goes from a plane to what is no point; give a point");
  return distance_of_lines(measuring.axis(step, "from"), measuring.axis(step, "to"));
}

/// Below 0 where the second point lies behind the first.
Result<StepValue> distance_along(Measuring& measuring, const RecipeStep& step) {
  const LineValue along = measuring.axis(step, "along");
  if (!along.directed) return fail("", "goes along an axis without a direction; give that \"towards\"");
  return (measuring.point(step, "to") - measuring.point(step, "from")).dot(along.direction);
}

double angle_deg(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * deg;
}

/// The angle of lines that both have a direction 0…180°, else 0…90°; of planes that between their normals, of a line
/// and a plane that to the plane itself.
Result<StepValue> angle_between(Measuring& measuring, const RecipeStep& step) {
  std::array<Vec3, 2> directions;
  bool directed = true;
  int planes = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    if (const auto* plane = std::get_if<FittedPlane>(&measuring.of(step, "between", k))) {
      directions[k] = plane->normal;
      directed = false;
      ++planes;
      continue;
    }
    const LineValue axis = measuring.axis(step, "between", k);
    directions[k] = axis.direction;
    directed = directed && axis.directed;
  }
  if (measuring.has(step, "in"))
    for (Vec3& direction : directions) {
      const Vec3 normal = measuring.as<FittedPlane>(step, "in").normal;
      direction -= direction.dot(normal) * normal;
      constexpr double upright = 1e-9;
      if (direction.norm() < upright) return fail("", "is of a line that stands upright on the plane");
    }
  const double angle = angle_deg(directions[0], directions[1]);
  if (directed) return angle;
  const double folded = std::min(angle, 180 - angle);
  return planes == 1 ? 90 - folded : folded;
}

Result<StepValue> angle_at(Measuring& measuring, const RecipeStep& step) {
  const Vec3 at = measuring.point(step, "at");
  const Vec3 from = measuring.point(step, "from") - at, to = measuring.point(step, "to") - at;
  if (!(from.norm() > 0) || !(to.norm() > 0)) return fail("", "has two of its points in one place");
  return angle_deg(from, to);
}

double radius_of(const StepValue& value) {
  if (const auto* sphere = std::get_if<FittedSphere>(&value)) return sphere->radius_mm;
  return std::get<CylinderValue>(value).radius_mm;
}
Result<StepValue> radius(Measuring& measuring, const RecipeStep& step) {
  return radius_of(measuring.of(step, "of"));
}
Result<StepValue> diameter(Measuring& measuring, const RecipeStep& step) {
  return 2 * radius_of(measuring.of(step, "of"));
}

Result<StepValue> rms_of_fit(Measuring& measuring, const RecipeStep& step) {
  const StepValue& of = measuring.of(step, "of");
  if (const auto* sphere = std::get_if<FittedSphere>(&of)) return sphere->rms_mm;
  if (const auto* plane = std::get_if<FittedPlane>(&of)) return plane->rms_mm;
  return measuring.axis(step, "of").rms_mm;
}

/// Over the surface from point to point; each is first brought onto it.
Result<StepValue> length_on_surface(Measuring& measuring, const RecipeStep& step) {
  const auto there = measuring.faces(step);
  if (!there) return fail(there.error());
  MeasuredSurface& surface = measuring.surface(*there);
  std::vector<SurfacePoint> stations;
  for (std::size_t k = 0; k < measuring.given(step, "through").steps.size(); ++k)
    stations.push_back(surface.search().nearest(measuring.point(step, "through", k)).at);
  if (measuring.has(step, "closed") && measuring.given(step, "closed").flag) stations.push_back(stations.front());
  double sum = 0;
  for (std::size_t k = 1; k < stations.size(); ++k) {
    const auto path = shortest_path(surface.mesh(), stations[k - 1], stations[k]);
    if (!path) return fail(path.error());
    sum += path->length_mm;
  }
  return sum;
}

Result<StepValue> girth(Measuring& measuring, const RecipeStep& step) {
  double sum = 0;
  for (const SectionLine& line : measuring.as<SectionValue>(step, "of").lines) {
    if (!line.closed) return fail("", "runs into an opening of the surface");
    sum += length_mm(line);
  }
  return sum;
}

Result<StepValue> extent(Measuring& measuring, const RecipeStep& step) {
  const auto along = extent_along(measuring, step);
  if (!along) return fail(along.error());
  return along->high_mm - along->low_mm;
}

Result<StepValue> ratio(Measuring& measuring, const RecipeStep& step) {
  const double over = measuring.as<double>(step, "of", 1);
  if (over == 0) return fail("", "is a share of 0");
  return measuring.as<double>(step, "of", 0) / over;
}
Result<StepValue> difference(Measuring& measuring, const RecipeStep& step) {
  return measuring.as<double>(step, "of", 0) - measuring.as<double>(step, "of", 1);
}
Result<StepValue> sum_of(Measuring& measuring, const RecipeStep& step) {
  double sum = 0;
  for (std::size_t k = 0; k < measuring.given(step, "of").steps.size(); ++k) sum += measuring.as<double>(step, "of", k);
  return sum;
}
Result<StepValue> asymmetry(Measuring& measuring, const RecipeStep& step) {
  const double a = measuring.as<double>(step, "of", 0), b = measuring.as<double>(step, "of", 1);
  if (a + b == 0) return fail("", "is a share of 0");
  return 200 * (a - b) / (a + b);
}

}  // namespace

Result<ExtentAlong> extent_along(const Measuring& measuring, const RecipeStep& step) {
  const Vec3 along = measuring.axis(step, "along").direction;
  ExtentAlong extent{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  std::size_t count = 0;
  const auto take = [&](const Vec3& p) {
    extent.low_mm = std::min(extent.low_mm, p.dot(along));
    extent.high_mm = std::max(extent.high_mm, p.dot(along));
    extent.middle += p;
    ++count;
  };
  const auto* section = measuring.has(step, "of") ? std::get_if<SectionValue>(&measuring.of(step, "of")) : nullptr;
  if (section != nullptr) {
    for (const SectionLine& line : section->lines)
      for (const Vec3& p : line.points) take(p);
  } else {
    const auto part = measuring.part(step, "of");
    if (!part) return fail(part.error());
    const Points& points = measuring.shape().structures[part->structure].mesh.points;
    for (const std::int32_t v : part->vertices) take(points.row(v));
  }
  if (count > 0) extent.middle /= static_cast<double>(count);
  return extent;
}

const std::vector<StepKind>& length_kinds() {
  constexpr unsigned point = bits(Gives::point), plane = bits(Gives::plane), section = bits(Gives::section);
  constexpr unsigned round = bits(Gives::sphere) | bits(Gives::cylinder);
  const StepMember two{"of", Takes::steps, bits(Gives::number), 2, 2};
  const StepMember from{"from", Takes::steps, point | any_axis | plane},
      to{"to", Takes::steps, point | any_axis | plane};
  static const std::vector<StepKind> kinds{
      {"distance", Gives::number, "mm", Draws::distance, {from, to}, distance_between},
      {"distance",
       Gives::number,
       "mm",
       Draws::along,
       {{"from", Takes::steps, point}, {"to", Takes::steps, point}, {"along", Takes::steps, any_axis}},
       distance_along},
      {"angle",
       Gives::number,
       "deg",
       Draws::angle,
       {{"between", Takes::steps, any_axis | plane, 2, 2}, {"in", Takes::steps, plane, 0}},
       angle_between},
      {"angle",
       Gives::number,
       "deg",
       Draws::angle,
       {{"at", Takes::steps, point}, {"from", Takes::steps, point}, {"to", Takes::steps, point}},
       angle_at},
      {"radius", Gives::number, "mm", Draws::value, {{"of", Takes::steps, round}}, radius},
      {"diameter", Gives::number, "mm", Draws::value, {{"of", Takes::steps, round}}, diameter},
      {"rms", Gives::number, "mm", Draws::value, {{"of", Takes::steps, round | any_axis | plane}}, rms_of_fit},
      {"length",
       Gives::number,
       "mm",
       Draws::way,
       {{"through", Takes::steps, point, 2, many}, {"closed", Takes::flag, 0, 0}},
       length_on_surface},
      {"girth", Gives::number, "mm", Draws::value, {{"of", Takes::steps, section}}, girth},
      {"extent",
       Gives::number,
       "mm",
       Draws::extent,
       {{"of", Takes::steps, bits(Gives::part) | section, 0}, {"along", Takes::steps, any_axis}},
       extent},
      {"ratio", Gives::number, "1", Draws::parts, {two}, ratio},
      {"difference", Gives::number, "", Draws::parts, {two}, difference},
      {"sum", Gives::number, "", Draws::parts, {{"of", Takes::steps, bits(Gives::number), 2, many}}, sum_of},
      {"asymmetry", Gives::number, "%", Draws::parts, {two}, asymmetry},
  };
  return kinds;
}

}  // namespace homolog
