#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "core/adapt/allowed_shapes.h"
#include "core/model/shape_model.h"
#include "core/structures/fitting/fit_set.h"

namespace homolog {

/// A joint model that belongs to a template set: what it knows of the set's structures.
struct SetModel {
  Alignment alignment = Alignment::similarity;
  ShapeMatrix shapes;  ///< the model's training shapes, as far as its modes hold them, 3n×M
  std::vector<StructurePart> parts;
  std::vector<std::optional<std::size_t>> place;  ///< each part's structure in the set; none: the set has no such
  /// The shapes that the model allows each structure of the set; null where the model has no such.
  std::vector<std::shared_ptr<const AllowedShapes>> allowed;
};

/// Errors, each without the model's file: no joint model; one whose structures were each aligned on its own, so that it
/// does not say where they lie; fewer than three training shapes; no structure of the set; a structure of another
/// numbering than its template.
Result<SetModel> set_model(const ShapeModel& model, const SetOfTemplates& set);

/// The shape that the model expects of a structure of the set, in the subject (n×3, LPS mm), given the fits of its
/// neighbours [near_structures, completed_shape]. The model of these alone is taken: how the rest of the body lies
/// would say less of it. None where the model lacks it, or where no neighbour is known.
std::optional<Points> said_by_model(const SetModel& model, const SetOfTemplates& set,
                                    const std::vector<FittedStructure>& fitted, std::size_t of);

}  // namespace homolog
