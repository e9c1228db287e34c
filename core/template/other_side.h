#pragma once

#include "core/mesh/construction/mirror.h"
#include "core/template/template.h"

namespace homolog {

/// The neighbours of the same structure of the other side: left and right exchanged in each name [side_of_name.h].
FacedNames names_of_other_side(const FacedNames& faced);

/// A template or a fit of one, mirrored [mirror.h], which faces the neighbours of the other side. That holds across any
/// plane: it gives the shape of the other side.
MeshFile mirrored_with_names(const MeshFile& mesh, AnatomicalPlane plane = AnatomicalPlane::sagittal);

}  // namespace homolog
