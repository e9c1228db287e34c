#include "core/measure/recipe/measured_lines.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "core/measure/recipe/step_kinds.h"
#include "core/measure/surface_path.h"

namespace homolog {

namespace {

using DrawnLine = std::vector<Vec3>;

/// Draws one measurement after what its step was given.
class LinesOfStep {
 public:
  LinesOfStep(Measuring& measuring, const Recipe& recipe) : measuring_(measuring), recipe_(recipe) {
    const Points& points = measuring.surface(0).mesh().points;
    constexpr double share = 0.25;
    if (points.rows() > 0) reach_mm_ = share * bounds_of(points).diagonal().norm() / 2;
  }

  MeasuredLines lines(std::size_t number) {
    const RecipeStep& step = recipe_.steps[number];
    MeasuredLines drawn;
    switch (step.kind->draws) {
      case Draws::nothing:
        break;
      case Draws::distance:
        add_distance(drawn, measuring_.of(step, "from"), measuring_.of(step, "to"));
        break;
      case Draws::along: {
        const Vec3 from = measuring_.point(step, "from"), along = measuring_.axis(step, "along").direction;
        add_distance(drawn, from, Vec3(from + (measuring_.point(step, "to") - from).dot(along) * along));
        break;
      }
      case Draws::angle:
        add_angle(drawn, step);
        break;
      case Draws::value:
        drawn.at = add_value(drawn, measuring_.of(step, "of"));
        break;
      case Draws::way:
        add_way(drawn, step);
        break;
      case Draws::extent:
        add_extent(drawn, step);
        break;
      case Draws::area:
        add_area(drawn, step);
        break;
      case Draws::parts:
        add_parts(drawn, step);
        break;
    }
    return drawn;
  }

 private:
  Vec3 add_axis(MeasuredLines& drawn, const LineValue& axis) const {
    drawn.lines.push_back({axis.at - reach_mm_ * axis.direction, axis.at + reach_mm_ * axis.direction});
    return axis.at;
  }
  static void add_circle(MeasuredLines& drawn, const Vec3& centre, const Vec3& normal, double radius_mm) {
    const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
    constexpr int steps = 48;
    DrawnLine circle;
    for (int k = 0; k <= steps; ++k) {
      const double turn = 2 * std::numbers::pi * k / steps;
      circle.push_back(centre + radius_mm * (std::cos(turn) * u + std::sin(turn) * v));
    }
    drawn.lines.push_back(std::move(circle));
  }
  /// Gives its middle.
  Vec3 add_value(MeasuredLines& drawn, const StepValue& value) const {
    if (const auto* sphere = std::get_if<FittedSphere>(&value)) {
      for (const Vec3& normal : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
        add_circle(drawn, sphere->centre, normal, sphere->radius_mm);
      return sphere->centre;
    }
    if (const auto* cylinder = std::get_if<CylinderValue>(&value)) {
      add_circle(drawn, cylinder->axis.at, cylinder->axis.direction, cylinder->radius_mm);
      return add_axis(drawn, cylinder->axis);
    }
    if (const auto* plane = std::get_if<FittedPlane>(&value)) {
      add_circle(drawn, plane->at, plane->normal, reach_mm_);
      return plane->at;
    }
    if (const auto* section = std::get_if<SectionValue>(&value)) {
      for (const SectionLine& line : section->lines) {
        drawn.lines.push_back(line.points);
        if (line.closed) drawn.lines.back().push_back(line.points.front());
      }
      return drawn.lines.empty() ? Vec3::Zero() : drawn.lines.back().front();
    }
    if (const auto* line = std::get_if<LineValue>(&value)) return add_axis(drawn, *line);
    return Vec3::Zero();
  }

  static LineValue axis_of(const StepValue& value) {
    if (const auto* cylinder = std::get_if<CylinderValue>(&value)) return cylinder->axis;
    return std::get<LineValue>(value);
  }
  /// The place of a point, line or plane that is nearest to a point.
  static Vec3 nearest_on(const StepValue& value, const Vec3& p) {
    if (const auto* point = std::get_if<Vec3>(&value)) return *point;
    if (const auto* plane = std::get_if<FittedPlane>(&value))
      return p - (p - plane->at).dot(plane->normal) * plane->normal;
    const LineValue axis = axis_of(value);
    return axis.at + (p - axis.at).dot(axis.direction) * axis.direction;
  }
  static void add_distance(MeasuredLines& drawn, const StepValue& from, const StepValue& to) {
    Vec3 a, b;
    if (const auto* p = std::get_if<Vec3>(&from)) {
      a = *p;
      b = nearest_on(to, a);
    } else if (const auto* q = std::get_if<Vec3>(&to)) {
      b = *q;
      a = nearest_on(from, b);
    } else {
      const LineValue one = axis_of(from), other = axis_of(to);
      const double along = one.direction.dot(other.direction), apart = 1 - along * along;
      const Vec3 off = other.at - one.at;
      constexpr double parallel = 1e-9;
      a = apart < parallel
              ? one.at
              : one.at + (off.dot(one.direction) - along * off.dot(other.direction)) / apart * one.direction;
      b = nearest_on(to, a);
    }
    drawn.lines.push_back({a, b});
    drawn.at = (a + b) / 2;
  }

  void add_angle(MeasuredLines& drawn, const RecipeStep& step) {
    if (measuring_.has(step, "at")) {
      drawn.at = measuring_.point(step, "at");
      drawn.lines.push_back({measuring_.point(step, "from"), drawn.at, measuring_.point(step, "to")});
      return;
    }
    for (std::size_t k = 0; k < 2; ++k) {
      const StepValue& one = measuring_.of(step, "between", k);
      // A cylinder stands for its axis.
      const bool is_plane = std::holds_alternative<FittedPlane>(one);
      drawn.at += (is_plane ? add_value(drawn, one) : add_axis(drawn, axis_of(one))) / 2;
    }
  }

  void add_way(MeasuredLines& drawn, const RecipeStep& step) {
    const auto there = measuring_.faces(step);
    if (!there) return;
    MeasuredSurface& surface = measuring_.surface(*there);
    const std::size_t count = measuring_.given(step, "through").steps.size();
    const bool closed = measuring_.has(step, "closed") && measuring_.given(step, "closed").flag;
    for (std::size_t k = 1; k < count + (closed ? 1 : 0); ++k) {
      const auto from = surface.search().nearest(measuring_.point(step, "through", k - 1)).at;
      const auto to = surface.search().nearest(measuring_.point(step, "through", k % count)).at;
      if (auto path = shortest_path(surface.mesh(), from, to)) drawn.lines.push_back(std::move(path->points));
    }
    if (!drawn.lines.empty()) drawn.at = drawn.lines.front()[drawn.lines.front().size() / 2];
  }

  /// Through the middle of the shape.
  void add_extent(MeasuredLines& drawn, const RecipeStep& step) {
    const auto extent = extent_along(measuring_, step);
    if (!extent) return;
    const Vec3 along = measuring_.axis(step, "along").direction;
    const Vec3 on_axis = extent->middle - extent->middle.dot(along) * along;
    drawn.lines.push_back({on_axis + extent->low_mm * along, on_axis + extent->high_mm * along});
    drawn.at = (drawn.lines.front().front() + drawn.lines.front().back()) / 2;
  }

  void add_area(MeasuredLines& drawn, const RecipeStep& step) const {
    if (!measuring_.has(step, "of")) return;
    const StepValue& of = measuring_.of(step, "of");
    if (std::holds_alternative<SectionValue>(of)) drawn.at = add_value(drawn, of);
  }

  /// A number made of several measurements has their lines.
  void add_parts(MeasuredLines& drawn, const RecipeStep& step) {
    Vec3 sum = Vec3::Zero();
    int count = 0;
    for (const std::size_t one : measuring_.given(step, "of").steps) {
      MeasuredLines of = lines(one);
      if (of.lines.empty()) continue;
      sum += of.at;
      ++count;
      for (DrawnLine& line : of.lines) drawn.lines.push_back(std::move(line));
    }
    if (count > 0) drawn.at = sum / count;
  }

  Measuring& measuring_;
  const Recipe& recipe_;
  double reach_mm_ = 0;  ///< to either side of an axis' middle
};

}  // namespace

MeasuredLines lines_of_measurement(Measuring& measuring, const Recipe& recipe, std::size_t step) {
  return LinesOfStep(measuring, recipe).lines(step);
}

}  // namespace homolog
