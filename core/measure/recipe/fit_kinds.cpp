#include <algorithm>

#include "core/measure/recipe/step_kinds.h"

namespace homolog {

namespace {

/// The vertices of a part, and the area that each stands for.
struct WeighedPoints {
  Points points;
  VertexScalars weights;
};

WeighedPoints weighed(Measuring& measuring, const PartValue& part) {
  MeasuredSurface& surface = measuring.surface(part.structure);
  WeighedPoints all{Points(std::ssize(part.vertices), 3), VertexScalars(std::ssize(part.vertices))};
  for (Eigen::Index k = 0; k < all.points.rows(); ++k) {
    const std::int32_t v = part.vertices[k];
    all.points.row(k) = surface.mesh().points.row(v);
    all.weights[k] = surface.areas()[v];
  }
  return all;
}

WeighedPoints points_through(const Measuring& measuring, const RecipeStep& step) {
  const auto count = std::ssize(measuring.given(step, "through").steps);
  WeighedPoints all{Points(count, 3), VertexScalars::Ones(count)};
  for (Eigen::Index k = 0; k < count; ++k)
    all.points.row(k) = measuring.point(step, "through", static_cast<std::size_t>(k));
  return all;
}

/// Turns a fitted axis to the point that it goes towards, where one is given.
LineValue pointed(const Measuring& measuring, const RecipeStep& step, LineValue line) {
  if (!measuring.has(step, "towards")) return line;
  if ((measuring.point(step, "towards") - line.at).dot(line.direction) < 0) line.direction *= -1;
  line.directed = true;
  return line;
}

Result<StepValue> line_through(Measuring& measuring, const RecipeStep& step) {
  const Vec3 from = measuring.point(step, "through", 0), to = measuring.point(step, "through", 1);
  if (!((to - from).norm() > 0)) return fail("", "goes through one point twice");
  return LineValue{from, (to - from).normalized(), true};
}

Result<StepValue> line_of_part(Measuring& measuring, const RecipeStep& step) {
  const WeighedPoints all = weighed(measuring, measuring.as<PartValue>(step, "of"));
  const auto fit = fit_line(all.points, all.weights);
  if (!fit) return fail(fit.error());
  return pointed(measuring, step, {fit->at, fit->direction, false, fit->rms_mm});
}

Result<StepValue> normal_of_plane(Measuring& measuring, const RecipeStep& step) {
  const auto& plane = measuring.as<FittedPlane>(step, "of");
  return pointed(measuring, step, {plane.at, plane.normal, false, plane.rms_mm});
}

Result<StepValue> plane_of_points(Measuring& measuring, const RecipeStep& step) {
  const WeighedPoints all = points_through(measuring, step);
  const auto fit = fit_plane(all.points, all.weights);
  if (!fit) return fail(fit.error());
  return *fit;
}

Result<StepValue> plane_of_part(Measuring& measuring, const RecipeStep& step) {
  const WeighedPoints all = weighed(measuring, measuring.as<PartValue>(step, "of"));
  const auto fit = fit_plane(all.points, all.weights);
  if (!fit) return fail(fit.error());
  return *fit;
}

Result<StepValue> plane_across(Measuring& measuring, const RecipeStep& step) {
  return FittedPlane{measuring.point(step, "at"), measuring.axis(step, "across").direction, 0};
}

Result<StepValue> sphere_of_points(Measuring& measuring, const RecipeStep& step) {
  const WeighedPoints all = points_through(measuring, step);
  const auto fit = fit_sphere(all.points, all.weights);
  if (!fit) return fail(fit.error());
  return *fit;
}

Result<StepValue> sphere_of_part(Measuring& measuring, const RecipeStep& step) {
  const WeighedPoints all = weighed(measuring, measuring.as<PartValue>(step, "of"));
  const auto fit = fit_sphere(all.points, all.weights);
  if (!fit) return fail(fit.error());
  return *fit;
}

Result<StepValue> cylinder_of_part(Measuring& measuring, const RecipeStep& step) {
  const WeighedPoints all = weighed(measuring, measuring.as<PartValue>(step, "of"));
  const auto fit = fit_cylinder(all.points, all.weights);
  if (!fit) return fail(fit.error());
  return CylinderValue{pointed(measuring, step, {fit->at, fit->direction, false, fit->rms_mm}), fit->radius_mm};
}

Result<StepValue> section_of_mesh(Measuring& measuring, const RecipeStep& step) {
  const auto there = measuring.faces(step);
  if (!there) return fail(there.error());
  const auto& plane = measuring.as<FittedPlane>(step, "plane");
  SectionValue section{plane_section(measuring.surface(*there).mesh(), plane.at, plane.normal), plane.normal};
  if (section.lines.empty()) return fail("", "misses the surface");
  if (!measuring.has(step, "near")) return section;
  const Vec3 near = measuring.point(step, "near");
  const auto nearest = std::ranges::min_element(
      section.lines, {}, [&](const SectionLine& line) { return distance_to_line_mm(line, near); });
  section.lines = {*nearest};
  return section;
}

}  // namespace

const std::vector<StepKind>& fit_kinds() {
  constexpr unsigned point = bits(Gives::point), plane = bits(Gives::plane), part = bits(Gives::part);
  const StepMember of_part{"of", Takes::steps, part}, towards{"towards", Takes::steps, point, 0};
  static const std::vector<StepKind> kinds{
      {"line", Gives::line, "", Draws::nothing, {{"through", Takes::steps, point, 2, 2}}, line_through},
      {"line", Gives::line, "", Draws::nothing, {of_part, towards}, line_of_part},
      {"normal", Gives::line, "", Draws::nothing, {{"of", Takes::steps, plane}, towards}, normal_of_plane},
      {"plane", Gives::plane, "", Draws::nothing, {{"through", Takes::steps, point, 3, many}}, plane_of_points},
      {"plane", Gives::plane, "", Draws::nothing, {of_part}, plane_of_part},
      {"plane",
       Gives::plane,
       "",
       Draws::nothing,
       {{"at", Takes::steps, point}, {"across", Takes::steps, any_axis}},
       plane_across},
      {"sphere", Gives::sphere, "", Draws::nothing, {of_part}, sphere_of_part},
      {"sphere", Gives::sphere, "", Draws::nothing, {{"through", Takes::steps, point, 4, many}}, sphere_of_points},
      {"cylinder", Gives::cylinder, "", Draws::nothing, {of_part, towards}, cylinder_of_part},
      {"section",
       Gives::section,
       "",
       Draws::nothing,
       {{"plane", Takes::steps, plane}, {"near", Takes::steps, point, 0}},
       section_of_mesh},
  };
  return kinds;
}

}  // namespace homolog
