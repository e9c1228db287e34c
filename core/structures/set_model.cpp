#include "core/structures/set_model.h"

#include <algorithm>
#include <utility>

#include "core/model/joint_models/complete_structures.h"
#include "core/model/model_prior.h"
#include "core/structures/fitting/neighbours_say.h"

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

std::optional<Points> said_by_model(const SetModel& model, const SetOfTemplates& set,
                                    const std::vector<FittedStructure>& fitted, std::size_t of) {
  const std::vector<std::size_t> near = near_structures(set, fitted, of);
  // The structure that is asked for, then those that say where it is.
  std::vector<std::size_t> which{of};
  which.insert(which.end(), near.begin(), near.end());
  std::vector<StructurePart> parts;
  IncompleteShape shape;
  ShapeMatrix complete(0, model.shapes.cols());
  for (const std::size_t k : which) {
    const auto part = std::ranges::find(model.place, std::optional<std::size_t>(k)) - model.place.begin();
    if (part == std::ssize(model.place)) {
      if (k == of) return std::nullopt;
      continue;
    }
    const StructurePart& own = model.parts[part];
    const Eigen::Index first = complete.rows() / 3, rows = 3 * own.vertices;
    parts.push_back({own.name, first, own.vertices, 0, 0});
    shape.has.push_back(k != of);
    complete.conservativeResize(3 * first + rows, Eigen::NoChange);
    complete.bottomRows(rows) = rows_of(own, model.shapes);
    shape.points.conservativeResize(3 * first + rows);
    if (k == of)
      shape.points.tail(rows).setZero();
    else
      shape.points.tail(rows) = Eigen::Map<const Eigen::VectorXd>(fitted[k].fit->mesh.points.data(), rows);
  }
  if (parts.size() < 2) return std::nullopt;
  return points_of(completed_shape(complete, parts, shape, model.alignment).points).topRows(parts.front().vertices);
}

}  // namespace homolog
