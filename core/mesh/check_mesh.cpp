#include "core/mesh/check_mesh.h"

#include <string>

namespace homolog {

Result<void> check_count(Eigen::Index values, Eigen::Index vertices, const char* what) {
  if (values == vertices) return {};
  return fail("", std::string(what) + " has " + std::to_string(values) + " rows for " + std::to_string(vertices) +
                      " vertices; give one for each vertex");
}

Result<void> check_points(const Points& points, Eigen::Index vertices, const char* what) {
  if (auto counted = check_count(points.rows(), vertices, what); !counted) return counted;
  if (points.allFinite()) return {};
  Eigen::Index i = 0;
  while (points.row(i).allFinite()) ++i;
  return fail("", std::string(what) + " has a coordinate that is no finite number, at vertex " + std::to_string(i) +
                      "; correct it");
}

Result<void> check_mesh(const Mesh& mesh, const char* what) {
  if (!mesh.topology) return fail("", std::string(what) + " has no triangles; give it a topology");
  return check_points(mesh.points, mesh.topology->vertices(), what);
}

}  // namespace homolog
