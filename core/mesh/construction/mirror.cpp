#include "core/mesh/construction/mirror.h"

namespace homolog {

MeshFile mirrored(const MeshFile& mesh, AnatomicalPlane plane) {
  const Eigen::Index axis = plane == AnatomicalPlane::sagittal ? 0 : plane == AnatomicalPlane::coronal ? 1 : 2;
  MeshFile other = mesh;
  other.points.col(axis) *= -1;
  if (other.triangles.rows() > 0) {
    Triangles& faces = other.triangles.edit();
    faces.col(1).swap(faces.col(2));
  }
  for (Landmark& landmark : other.landmarks) landmark.position[axis] *= -1;
  return other;
}

bool turned_faces(const Triangles& faces, const Triangles& other) {
  return faces.rows() > 0 && faces.rows() == other.rows() && faces.col(0) == other.col(0) &&
         faces.col(1) == other.col(2) && faces.col(2) == other.col(1);
}

}  // namespace homolog
