#pragma once

#include "core/mesh/mesh_io.h"

namespace homolog {

enum class AnatomicalPlane { sagittal, coronal, axial };

/// The shape of the other side: coordinates across the plane (sagittal: x) are negated about 0, faces are turned so
/// that they stay outward, numbering, stiffness and landmarks are kept.
MeshFile mirrored(const MeshFile& mesh, AnatomicalPlane plane = AnatomicalPlane::sagittal);

}  // namespace homolog
