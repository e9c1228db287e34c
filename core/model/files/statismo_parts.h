#pragma once

#include "core/model/files/hdf_tree.h"
#include "core/model/shape_model.h"

namespace homolog::statismo {

/// Adds the structures of a joint model, and where they lie, as groups below /homolog (docs/models.md), which other
/// programs pass over. Adds nothing of any other model.
void add_structures(const ShapeModel& model, HdfTree& tree);

/// Reads them into a model whose mean, faces and names are read. A part that does not fit the model is left out, since
/// the model is whole without it.
void read_structures(const HdfTree& tree, ShapeModel& model);

/// Adds what read_structures needs of a file to `parts`.
void add_structure_parts(HdfParts& parts);

}  // namespace homolog::statismo
