#include "core/case/actions/stiffness.h"

#include <cmath>
#include <utility>

#include "core/case/actions/brush.h"
#include "core/case/actions/fields.h"

namespace homolog {

namespace {

void spell_stiffness(Fields& line, PaintStiffness& action) {
  Fields dab = line.object("stiffness");
  dab.member("at", action.at);
  dab.member("radius_mm", action.radius_mm);
  dab.member("value", action.value);
  dab.optional("soft", action.soft);
}

Result<EditReport> apply_stiffness(const PaintStiffness& action, StructureEdit& edit) {
  if (auto usable = check_brush(action.at, action.radius_mm, action.soft); !usable) return fail(usable.error());
  if (!(action.value > 0) || !std::isfinite(action.value)) return fail("stiffness", "must be a positive number");
  auto factors = std::make_shared<VertexScalars>(*edit.before.paint.stiffness);
  const double factor = action.value / edit.before.paint.base;
  const int touched = brush(*edit.shape().points, action.at, action.radius_mm, action.soft,
                            [&](Eigen::Index i, double b) { (*factors)[i] += b * (factor - (*factors)[i]); });
  edit.after.paint.stiffness = std::move(factors);
  return painted(touched);
}

void spell_smoothing(Fields& line, SmoothStiffness& action) {
  Fields dab = line.object("smooth_stiffness");
  dab.member("at", action.at);
  dab.member("radius_mm", action.radius_mm);
  dab.optional("strength", action.strength);
}

Result<EditReport> apply_smoothing(const SmoothStiffness& action, StructureEdit& edit) {
  if (auto usable = check_brush(action.at, action.radius_mm, 0); !usable) return fail(usable.error());
  if (!(action.strength >= 0 && action.strength <= 1)) return fail("strength", "must be between 0 and 1");
  const VertexScalars& before = *edit.before.paint.stiffness;
  const Topology& topology = *edit.before.the_template->topology;
  auto factors = std::make_shared<VertexScalars>(before);
  const int touched = brush(*edit.shape().points, action.at, action.radius_mm, 0.5, [&](Eigen::Index i, double b) {
    double sum = 0;
    const auto ring = topology.one_ring(i);
    for (const std::int32_t n : ring) sum += before[n];
    (*factors)[i] += b * action.strength * (sum / static_cast<double>(ring.size()) - before[i]);
  });
  edit.after.paint.stiffness = std::move(factors);
  return painted(touched);
}

void spell_factors(Fields& line, SetStiffnessFactors& action) {
  std::vector<double> factors;
  if (action.factors) factors.assign(action.factors->begin(), action.factors->end());
  line.member("stiffness_factors", factors);
  if (line.reads())
    action.factors = std::make_shared<const VertexScalars>(
        Eigen::Map<const VertexScalars>(factors.data(), static_cast<Eigen::Index>(factors.size())));
}

Result<EditReport> apply_factors(const SetStiffnessFactors& action, StructureEdit& edit) {
  const auto vertices = edit.before.paint.stiffness->size();
  if (!action.factors || action.factors->size() != vertices)
    return fail("stiffness", "needs one factor for each of the " + std::to_string(vertices) +
                                 " vertices; take an array of a mesh with the same vertices");
  if (!action.factors->allFinite() || !(action.factors->minCoeff() > 0))
    return fail("stiffness", "needs positive factors; rescale the array");
  edit.after.paint.stiffness = action.factors;
  return painted(vertices);
}

}  // namespace

const ActionKind<PaintStiffness>& action_kind(const PaintStiffness&) {
  static constexpr ActionKind<PaintStiffness> kind{
      .key = "stiffness",
      .example = R"({"stiffness":{"at":[-21,20,-9],"radius_mm":10,"value":50,"soft":0}})",
      .meaning = "sets the stiffness w within a radius; over the outer share `soft` it blends",
      .name = [](const PaintStiffness&) -> std::string { return "stiffness brush"; },
      .spell = spell_stiffness,
      .apply = apply_stiffness};
  return kind;
}

const ActionKind<SmoothStiffness>& action_kind(const SmoothStiffness&) {
  static constexpr ActionKind<SmoothStiffness> kind{
      .key = "smooth_stiffness",
      .example = R"({"smooth_stiffness":{"at":[-21,20,-9],"radius_mm":10,"strength":0.5}})",
      .meaning = "draws factors towards the mean of their neighbours",
      .name = [](const SmoothStiffness&) -> std::string { return "smoothing of the stiffness"; },
      .spell = spell_smoothing,
      .apply = apply_smoothing};
  return kind;
}

const ActionKind<SetStiffnessFactors>& action_kind(const SetStiffnessFactors&) {
  static constexpr ActionKind<SetStiffnessFactors> kind{
      .key = "stiffness_factors",
      .example = R"({"stiffness_factors":[1,1,5]})",
      .meaning = "a factor for every vertex",
      .name = [](const SetStiffnessFactors&) -> std::string { return "imported stiffness"; },
      .spell = spell_factors,
      .apply = apply_factors};
  return kind;
}

const ActionKind<SetStiffnessBase>& action_kind(const SetStiffnessBase&) {
  static constexpr ActionKind<SetStiffnessBase> kind{
      .key = "stiffness_base",
      .example = R"({"stiffness_base":10})",
      .meaning = "w = base × factor for every vertex",
      .needs_mesh = false,
      .name = [](const SetStiffnessBase&) -> std::string { return "stiffness"; },
      .spell = [](Fields& line, SetStiffnessBase& action) { line.member("stiffness_base", action.base); },
      .apply = [](const SetStiffnessBase& action, StructureEdit& edit) -> Result<EditReport> {
        if (!(action.base > 0) || !std::isfinite(action.base)) return fail("stiffness", "must be positive");
        edit.after.paint.base = action.base;
        return EditReport{};
      }};
  return kind;
}

}  // namespace homolog
