#include "core/structures/set_model.h"

#include <algorithm>
#include <utility>

#include "core/model/complete_structures.h"
#include "core/model/model_prior.h"
#include "core/structures/neighbours_say.h"

namespace homolog {

Result<SetModel> set_model(const ShapeModel& model, const SetOfTemplates& set) {
  constexpr Eigen::Index enough_shapes = 3;
  if (model.parts.empty()) return fail("", "is no joint model; `homolog model --structures` makes one");
  if (model.poses && model.poses->apart)
    return fail("", "does not say where structures lie to each other; make it with `--alignment common`");
  if (model.scores.cols() < enough_shapes)
    return fail("", "holds fewer than three training shapes, which is too few to expect anything");
  SetModel result;
  result.alignment = model.alignment.value_or(Alignment::similarity);
  result.shapes = (model.basis * model.scores).colwise() + model.mean;
  result.parts = model.parts;
  result.place.resize(result.parts.size());
  result.allowed.resize(set.templates.size());
  for (std::size_t part = 0; part < result.parts.size(); ++part) {
    const TemplateOfSet* one = set.set.find(result.parts[part].name);
    if (one == nullptr) continue;
    const auto k = static_cast<std::size_t>(one - set.set.structures.data());
    if (set.templates[k] == nullptr) continue;
    auto allowed = allowed_by(part_of(model, result.parts[part]), *set.templates[k]);
    if (!allowed) return fail("", one->name + " " + allowed.error().what);
    result.allowed[k] = std::make_shared<const AllowedShapes>(std::move(*allowed));
    result.place[part] = k;
  }
  if (std::ranges::none_of(result.place, [](const auto& place) { return place.has_value(); }))
    return fail("", "has none of the set's structures, which are " + names_in_set(set.set));
  return result;
}

std::optional<Points> said_by_model(const SetModel& model, const std::vector<FittedStructure>& fitted, std::size_t of) {
  IncompleteShape shape{Eigen::VectorXd::Zero(model.shapes.rows()), std::vector<bool>(model.parts.size())};
  const StructurePart* asked = nullptr;
  for (std::size_t part = 0; part < model.parts.size(); ++part) {
    if (!model.place[part]) continue;
    const std::size_t k = *model.place[part];
    const StructurePart& own = model.parts[part];
    if (k == of) asked = &own;
    if (k == of || !has_a_say(fitted[k])) continue;
    shape.has[part] = true;
    const Points& points = fitted[k].fit->mesh.points;
    shape.points.segment(3 * own.first_vertex, points.size()) =
        Eigen::Map<const Eigen::VectorXd>(points.data(), points.size());
  }
  if (asked == nullptr || std::ranges::none_of(shape.has, [](bool has) { return has; })) return std::nullopt;
  const CompletedShape whole = completed_shape(model.shapes, model.parts, shape, model.alignment);
  return points_of(whole.points).middleRows(asked->first_vertex, asked->vertices);
}

}  // namespace homolog
