#include "app/editor/state/figures/scoring.h"

#include <utility>

#include "app/editor/state/structure_looks.h"
#include "core/adapt/judge_fit.h"
#include "core/base/text/text.h"

namespace homolog {

namespace {

std::string other_vertices(const std::string& mesh, Eigen::Index own, Eigen::Index of_model) {
  return mesh + " has " + std::to_string(own) + " vertices and the model " + std::to_string(of_model) +
         ". Choose a model of this template.";
}

/// The structures of a joint model, one below the other. `first`: where the rows of `worked_on` begin; −1: it is none
/// of them. Errors: a sentence.
Result<Points> joined_points(const ShapeModel& model, const Document& document, const Structure& worked_on,
                             Eigen::Index& first) {
  Points points(model.mean.size() / 3, 3);
  first = -1;
  for (const StructurePart& part : model.parts) {
    const Structure* found = nullptr;
    for (const auto& one : document.structures) {
      if (lower_case(structure_name(*one)) != lower_case(part.name)) continue;
      if (found != nullptr) return fail("", "The case has two structures " + part.name + ". Rename one of them.");
      found = one.get();
    }
    const Shape* shape = found != nullptr ? found->shape(document.frame) : nullptr;
    if (found == &worked_on) first = part.first_vertex;
    if (shape == nullptr) return fail("", "The case has no mesh of " + part.name + ", which the model has.");
    if (shape->points->rows() != part.vertices)
      return fail("", other_vertices(part.name, shape->points->rows(), part.vertices));
    points.middleRows(part.first_vertex, part.vertices) = *shape->points;
  }
  return points;
}

}  // namespace

ScoredShape scored_shape(const std::shared_ptr<const ShapeModel>& model, const Document& document,
                         const std::string& structure, bool flipped) {
  const ShapeView shown = *document.view(structure);
  const Points& own = *shown.shape.points;
  ScoredShape scored{.model = model, .structure = structure, .frame = shown.frame, .points = shown.shape.points};
  const auto refuse = [&](std::string sentence) {
    scored.refusal = std::move(sentence);
    return scored;
  };
  Points points = own;
  VertexScalars doubt_mm;
  Eigen::Index first = 0;
  if (model->parts.empty()) {
    doubt_mm = doubt_left_mm(shown.shape);
  } else {
    auto joined = joined_points(*model, document, shown.structure, first);
    if (!joined) return refuse(joined.error().what);
    points = std::move(*joined);
  }
  if (3 * points.rows() != model->mean.size())
    return refuse(other_vertices("The mesh", points.rows(), model->mean.size() / 3));
  if (flipped) points.col(0) *= -1;
  auto score = score_shape(*model, points, doubt_mm);
  if (!score) return refuse("The model " + score.error().what + ".");
  if (first >= 0) scored.z = std::make_shared<const VertexScalars>(score->z.segment(first, own.rows()));
  scored.score = std::make_shared<const ShapeScore>(std::move(*score));
  return scored;
}

}  // namespace homolog
