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

namespace {

/// Whether each triangle has the corners of the other's, in the order `a`, `b`, `c` of them or turned on from there.
bool same_corners(const Triangles& faces, const Triangles& other, int a, int b, int c) {
  if (faces.rows() != other.rows()) return false;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const auto is = [&](int i, int j, int k) {
      return faces(f, 0) == other(f, i) && faces(f, 1) == other(f, j) && faces(f, 2) == other(f, k);
    };
    if (!is(a, b, c) && !is(b, c, a) && !is(c, a, b)) return false;
  }
  return true;
}

}  // namespace

bool same_faces(const Triangles& faces, const Triangles& other) {
  return same_corners(faces, other, 0, 1, 2);
}

bool turned_faces(const Triangles& faces, const Triangles& other) {
  return faces.rows() > 0 && same_corners(faces, other, 0, 2, 1);
}

}  // namespace homolog
