#include "core/structures/fitting/set_in_case.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "core/base/text/text.h"
#include "core/case/placing.h"
#include "core/structures/fitting/keep_apart.h"
#include "core/structures/fitting/shared_in_case.h"
#include "core/template/template_mark.h"

namespace homolog {

namespace {

/// Whether nobody named a structure or edited it: the template lies somewhere.
bool is_untouched(const Structure& structure) {
  return structure.name.empty() &&
         std::ranges::all_of(structure.shapes, [](const auto& shape) { return shape.second->strokes == 0; });
}

/// Whether points of one template are points of the other.
bool same_template(const Template& a, const Template& b) {
  return a.topology->hash() == b.topology->hash() && check_template_mark(template_mark(a), b);
}

/// The structure of the case that a template of a set is; null: it has none yet.
const Structure* same_structure(const Document& document, const std::string& name, const Template& the_template) {
  for (const auto& one : document.structures)
    if (lower_case(one->name) == lower_case(name) && same_template(*one->the_template, the_template)) return one.get();
  for (const auto& one : document.structures)
    if (is_untouched(*one) && same_template(*one->the_template, the_template)) return one.get();
  return nullptr;
}

SetStructure described(const std::string& id, const std::string& name, const Segment& segment,
                       const FittedStructure& one) {
  SetStructure action{.id = id, .name = name};
  action.label = segment.name.empty() ? std::to_string(segment.value) : segment.name;
  action.layer = static_cast<int>(segment.layer);
  action.colour = segment.colour;
  action.confidence = std::clamp(one.confidence, 0.0, 1.0);
  if (one.judgement.doubtful) action.doubt = reason_of_doubt(one.judgement.warnings);
  return action;
}

/// Takes back how vertices moved that are `shared` (above 0); those around go along.
void put_back(const VertexScalars& shared, const Points& before, Mesh& mesh) {
  if (shared.size() == 0) return;
  Points back = Points::Zero(before.rows(), 3);
  for (Eigen::Index v = 0; v < back.rows(); ++v)
    if (shared[v] > 0) back.row(v) = before.row(v) - mesh.points.row(v);
  if (back.isZero(0)) return;
  spread_movement(*mesh.topology, shared, back);
  mesh.points += back;
  for (Eigen::Index v = 0; v < back.rows(); ++v)
    if (shared[v] > 0) mesh.points.row(v) = before.row(v);
}

/// The relations of a fit's structures: their ids in the case, by their places in the set; empty: not fitted.
class FittedRelations {
 public:
  FittedRelations(const Document& document, const TemplateSet& set, std::vector<std::string> ids)
      : document_(document), set_(set), ids_(std::move(ids)) {}

  /// The news of a structure (its place in the set) for the case, beside what it knows; none: nothing.
  std::optional<SetStructure> told_of(std::size_t k) const {
    const Structure* known = document_.structure(ids_[k]);
    SetStructure action{.id = ids_[k]};
    const std::string* partner = id_of(set_.structures[k].partner);
    if (partner != nullptr && *partner != ids_[k] && (known == nullptr || known->partner != *partner))
      action.partner = *partner;
    auto shared = shared_of(k, known);
    if (shared != (known != nullptr ? known->shared : std::vector<SharedWith>())) action.shared = std::move(shared);
    return action.partner || action.shared ? std::optional(std::move(action)) : std::nullopt;
  }

 private:
  const std::string* id_of(const std::string& name) const {
    const TemplateOfSet* found = name.empty() ? nullptr : set_.find(name);
    const std::string* id = found != nullptr ? &ids_[found - set_.structures.data()] : nullptr;
    return id != nullptr && !id->empty() ? id : nullptr;
  }
  /// As the set says, and what the case knows of structures that were not fitted.
  std::vector<SharedWith> shared_of(std::size_t k, const Structure* known) const {
    std::vector<SharedWith> shared;
    if (known != nullptr)
      for (const SharedWith& one : known->shared)
        if (std::ranges::find(ids_, one.with) == ids_.end()) shared.push_back(one);
    for (const SharedVertices& one : set_.shared) {
      const std::string *a = id_of(one.a), *b = id_of(one.b);
      if (a != nullptr && b != nullptr && *a == ids_[k] && *a != *b)
        shared.push_back({*b, std::make_shared<const std::vector<VertexPair>>(one.vertices)});
    }
    return shared;
  }

  const Document& document_;
  const TemplateSet& set_;
  std::vector<std::string> ids_;
};

/// The mesh as an edit of a structure.
SetPoints fitted_points(const Document& document, const Structure& structure, const FitResult& fit) {
  const Shape shape = shape_of_frame(structure, document.frame, document.frame);
  SetPoints edit = points_edit({structure, shape, document.frame}, fit.mesh.points, FoundBy::set_fit, fit.placement);
  if (fit.doubt_mm.size() > 0) edit.doubt_mm = doubt_on_grid(fit.doubt_mm);
  return edit;
}

}  // namespace

std::string free_structure_id(const Document& document, const std::vector<std::string>& more) {
  for (std::size_t k = 1;; ++k) {
    std::string id = "s" + std::to_string(k);
    if (std::ranges::none_of(document.structures, [&](const auto& one) { return one->id == id; }) &&
        std::ranges::find(more, id) == more.end())
      return id;
  }
}

KeptMapFit map_fit_of(const TemplateSet& set, const SetInMap& subject, const FittedSet& fitted,
                      const std::vector<EditStep>& steps, int frame) {
  KeptMapFit fit;
  fit.frame = frame;
  for (const EditStep& step : steps) {
    if (const auto* points = std::get_if<SetPoints>(&step.action);
        points != nullptr && fit.structures.contains(step.of))
      fit.structures[step.of].mesh = mesh_hash(*points->points);
    const auto* named = std::get_if<SetStructure>(&step.action);
    if (named == nullptr || !named->name) continue;
    const auto k = static_cast<std::size_t>(std::ranges::find(set.structures, *named->name, &TemplateOfSet::name) -
                                            set.structures.begin());
    const Segment& segment = subject.structures[k].segment;
    fit.structures[named->id] = {.name = *named->name,
                                 .layer = segment.layer,
                                 .value = segment.value,
                                 .mesh = {},
                                 .p_named = fitted.structures[k].p_named};
  }
  return fit;
}

std::optional<SetPoints> apart_from_others(const Document& document, const std::string& of, double gap_mm) {
  constexpr double mostly = 0.5;
  const auto shown = document.view(of);
  if (!shown) return std::nullopt;
  const Mesh own{shown->the_template().topology, *shown->shape.points};
  const auto closed = ClosedMesh::of(own);
  if (!closed) return std::nullopt;
  std::vector<Mesh> meshes{own};
  std::vector<MeshPair> pairs;
  Box reach = bounds_of(own.points);
  reach.min().array() -= gap_mm;
  reach.max().array() += gap_mm;
  for (const auto& one : document.structures) {
    const Shape* shape = one->shape(document.frame);
    if (one.get() == document.structure(of) || shape == nullptr) continue;
    if (!reach.intersects(bounds_of(*shape->points))) continue;
    const Mesh other{one->the_template->topology, *shape->points};
    const auto closed_other = ClosedMesh::of(other);
    if (!closed_other || share_within(other, *closed) > mostly || share_within(own, *closed_other) > mostly) continue;
    pairs.push_back({0, meshes.size()});
    meshes.push_back(other);
  }
  if (pairs.empty()) return std::nullopt;
  std::vector<char> yields(meshes.size());
  yields.front() = 1;
  keep_apart(meshes, pairs, gap_mm, yields);
  put_back(shared_vertices_of(document, of), own.points, meshes.front());
  if (meshes.front().points == own.points) return std::nullopt;
  return points_edit(*shown, meshes.front().points, FoundBy::keep_apart);
}

std::vector<EditStep> steps_of_fitted_set(const Document& document, const SetOfTemplates& set, const SetInMap& subject,
                                          const FittedSet& fitted, const std::vector<std::string>& found) {
  std::vector<EditStep> steps;
  std::vector<std::string> used, names, ids(fitted.structures.size());
  for (std::size_t k = 0; k < fitted.structures.size(); ++k) {
    const FittedStructure& one = fitted.structures[k];
    if (!one.fit) continue;
    const auto& the_template = set.templates[k];
    const std::string& name = set.set.structures[k].name;
    const Structure* there = same_structure(document, name, *the_template);
    if (there != nullptr && std::ranges::find(used, there->id) != used.end()) there = nullptr;
    const std::string id = there != nullptr ? there->id : free_structure_id(document, used);
    used.push_back(id);
    ids[k] = id;
    names.push_back(lower_case(name));
    SetStructure action = described(id, name, subject.structures[k].segment, one);
    if (!action.colour) action.colour = set.set.structures[k].colour;
    if (const Side side = set.set.structures[k].side; side != Side::none) action.side = side;
    if (!found.empty() && !found[k].empty()) action.doubt = found[k];
    if (there != nullptr && !action.doubt) action.doubt = "";
    std::optional<Structure> begun;
    if (there == nullptr) {
      action.source = the_template->source;
      action.the_template = the_template;
      action.placement = one.fit->placement;
      begun = new_structure(the_template, one.fit->placement);
    }
    steps.push_back({std::move(action), {}, true});
    steps.push_back({fitted_points(document, begun ? *begun : *there, *one.fit), id, true});
  }
  if (steps.empty()) return steps;
  const FittedRelations relations(document, set.set, ids);
  for (std::size_t k = 0; k < ids.size(); ++k)
    if (auto told = ids[k].empty() ? std::nullopt : relations.told_of(k))
      steps.insert(steps.end() - 1, EditStep{std::move(*told), {}, true});
  for (const auto& one : document.structures) {
    const bool has_name_of_new = std::ranges::find(names, lower_case(one->name)) != names.end();
    if (std::ranges::find(used, one->id) != used.end() || !(is_untouched(*one) || has_name_of_new)) continue;
    steps.insert(steps.end() - 1, EditStep{RemoveStructure{one->id}, {}, true});
  }
  steps.front().joined = false;
  return steps;
}

}  // namespace homolog
