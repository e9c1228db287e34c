#include "core/mesh/construction/tube_mesh.h"

namespace homolog {

Triangles tube_triangles(int rings, int sectors, bool capped) {
  Triangles triangles(2 * (rings - 1) * sectors + (capped ? 2 : 1) * sectors, 3);
  const int apex = rings * sectors, middle = apex + 1;
  const auto vertex = [&](int ring, int sector) { return ring * sectors + sector % sectors; };
  Eigen::Index face = 0;
  for (int ring = 0; ring + 1 < rings; ++ring)
    for (int sector = 0; sector < sectors; ++sector) {
      const int a = vertex(ring, sector), b = vertex(ring, sector + 1);
      const int c = vertex(ring + 1, sector), d = vertex(ring + 1, sector + 1);
      triangles.row(face++) << a, c, b;
      triangles.row(face++) << b, c, d;
    }
  for (int sector = 0; sector < sectors; ++sector)
    triangles.row(face++) << vertex(rings - 1, sector), apex, vertex(rings - 1, sector + 1);
  for (int sector = 0; capped && sector < sectors; ++sector)
    triangles.row(face++) << middle, vertex(0, sector), vertex(0, sector + 1);
  return triangles;
}

}  // namespace homolog
