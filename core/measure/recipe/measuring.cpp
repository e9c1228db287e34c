#include "core/measure/recipe/measuring.h"

#include <cmath>
#include <limits>

#include "core/base/text/text.h"
#include "core/measure/recipe/step_kinds.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

const VertexScalars& MeasuredSurface::areas() {
  if (!areas_)
    areas_ = mesh().topology == nullptr ? VertexScalars(VertexScalars::Ones(mesh().points.rows()))
                                        : vertex_areas_mm2(mesh());
  return *areas_;
}

const Points& MeasuredSurface::normals() {
  if (!normals_) normals_ = vertex_normals(mesh());
  return *normals_;
}

const SurfaceSearch& MeasuredSurface::search() {
  if (!search_) search_ = std::make_unique<SurfaceSearch>(mesh());
  return *search_;
}

Measuring::Measuring(const Recipe& recipe, const MeasuredShape& shape)
    : recipe_(recipe), shape_(shape), values_(recipe.steps.size()) {
  for (const MeasuredStructure& structure : shape.structures) surfaces_.emplace_back(structure);
}

const Result<StepValue>& Measuring::value(std::size_t step) {
  std::optional<Result<StepValue>>& known = values_[step];
  if (known) return *known;
  const RecipeStep& one = recipe_.steps[step];
  for (const auto& [key, given] : one.given)
    for (const std::size_t needed : given.steps)
      if (const auto& before = value(needed); !before) return known.emplace(fail(before.error()));
  auto made = one.kind->measure(*this, one);
  if (!made && made.error().subject.empty())
    made = fail("shape", '"' + one.name + "\" " + made.error().what);
  else if (made && std::holds_alternative<PartValue>(*made) && std::get<PartValue>(*made).vertices.empty())
    made = fail("shape", '"' + one.name + "\" holds no vertex of it");
  return known.emplace(std::move(made));
}

const StepValue& Measuring::of(const RecipeStep& step, const char* key, std::size_t number) const {
  return **values_[given(step, key).steps[number]];
}

LineValue Measuring::axis(const RecipeStep& step, const char* key, std::size_t number) const {
  const StepValue& value = of(step, key, number);
  if (const auto* cylinder = std::get_if<CylinderValue>(&value)) return cylinder->axis;
  return std::get<LineValue>(value);
}

double Measuring::number(const RecipeStep& step, const char* key, double otherwise) const {
  if (!has(step, key)) return otherwise;
  const StepGiven& there = given(step, key);
  return there.numbers.front() * (there.steps.empty() ? 1 : as<double>(step, key));
}

Result<std::size_t> Measuring::structure(const RecipeStep& step) const {
  if (step.structure.empty() && shape_.lacks_first.empty()) return 0;
  const std::string& wanted = step.structure.empty() ? shape_.lacks_first : step.structure;
  for (std::size_t k = 0; k < shape_.structures.size(); ++k)
    if (lower_case(shape_.structures[k].name) == lower_case(wanted)) return k;
  return lacks("has no structure \"" + excerpt(wanted) + '"');
}

Result<void> Measuring::check_faces(std::size_t structure) const {
  if (shape_.structures[structure].mesh.topology != nullptr) return {};
  return lacks("is points alone, without a surface");
}

Result<std::size_t> Measuring::faces(const RecipeStep& step) const {
  const auto there = structure(step);
  if (!there) return there;
  if (auto sound = check_faces(*there); !sound) return fail(sound.error());
  return there;
}

Result<PartValue> Measuring::part(const RecipeStep& step, const char* key) const {
  if (has(step, key)) return as<PartValue>(step, key);
  const auto there = structure(step);
  if (!there) return fail(there.error());
  PartValue whole{*there, {}};
  const auto count = static_cast<std::int32_t>(shape_.structures[*there].mesh.points.rows());
  for (std::int32_t v = 0; v < count; ++v) whole.vertices.push_back(v);
  return whole;
}

MeasuredNumber measured_number(Measuring& measuring, const Recipe& recipe, std::size_t step) {
  const auto& value = measuring.value(step);
  if (!value) return {std::nullopt, value.error().what};
  if (const double number = std::get<double>(*value); std::isfinite(number)) return {number, {}};
  return {std::nullopt, '"' + recipe.steps[step].name + "\" is no number here"};
}

std::vector<MeasuredNumber> measure(const Recipe& recipe, const MeasuredShape& shape) {
  Measuring measuring(recipe, shape);
  std::vector<MeasuredNumber> all;
  for (const std::size_t step : recipe.measurements) all.push_back(measured_number(measuring, recipe, step));
  return all;
}

VertexScalars NormalProfile::mean() const {
  VertexScalars means(values.rows());
  for (Eigen::Index v = 0; v < means.size(); ++v) {
    double sum = 0;
    int count = 0;
    for (Eigen::Index k = 0; k < values.cols(); ++k)
      if (std::isfinite(values(v, k))) sum += values(v, k), ++count;
    means[v] = count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
  }
  return means;
}

NormalProfile profile_along_normals(const Mesh& mesh, const Volume& image, int frame, double from_mm, double to_mm,
                                    int steps) {
  NormalProfile profile;
  for (int k = 0; k < steps; ++k)
    profile.offsets_mm.push_back(steps == 1 ? (from_mm + to_mm) / 2 : from_mm + (to_mm - from_mm) * k / (steps - 1));
  const Points normals = vertex_normals(mesh);
  profile.values.resize(mesh.points.rows(), steps);
  for (Eigen::Index v = 0; v < mesh.points.rows(); ++v)
    for (int k = 0; k < steps; ++k) {
      const double offset_mm = profile.offsets_mm[k];
      profile.values(v, k) = image.sample((mesh.points.row(v) + offset_mm * normals.row(v)).transpose(),
                                          std::numeric_limits<double>::quiet_NaN(), frame);
    }
  return profile;
}

}  // namespace homolog
