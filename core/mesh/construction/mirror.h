#pragma once

#include "core/mesh/mesh_io.h"

namespace homolog {

enum class AnatomicalPlane { sagittal, coronal, axial };

/// The shape of the other side: coordinates across the plane (sagittal: x) are negated about 0, faces are turned so
/// that they stay outward, numbering, stiffness and landmarks are kept.
MeshFile mirrored(const MeshFile& mesh, AnatomicalPlane plane = AnatomicalPlane::sagittal);

/// Whether the faces are the same in their order; each may begin at another of its corners.
bool same_faces(const Triangles& faces, const Triangles& other);

/// Whether the faces are the same, each turned the other way round: those of a shape and of its mirrored one.
bool turned_faces(const Triangles& faces, const Triangles& other);

}  // namespace homolog
