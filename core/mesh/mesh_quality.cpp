#include "core/mesh/mesh_quality.h"
namespace homolog {
Points vertex_normals(const Mesh& m) {
  Points n = Points::Zero(m.points.rows(), 3);
  for (Eigen::Index f = 0; f < m.topology->triangles().rows(); ++f) {
    auto t = m.topology->triangles().row(f);
    Vec3 a = m.points.row(t[0]), b = m.points.row(t[1]), c = m.points.row(t[2]);
    Vec3 k = (b - a).cross(c - a);
    for (int i = 0; i < 3; ++i) n.row(t[i]) += k.transpose();
  }
  n.rowwise().normalize();
  return n;
}
double mean_edge_mm(const Topology& t, const Points& p) {
  double s = 0;
  for (auto [a, b] : t.edges()) s += (p.row(a) - p.row(b)).norm();
  return s / double(t.edges().size());
}
double triangle_quality(const Vec3& a, const Vec3& b, const Vec3& c) {
  double l = (b - a).squaredNorm() + (c - a).squaredNorm() + (c - b).squaredNorm();
  return l > 0 ? 2 * std::sqrt(3.0) * (b - a).cross(c - a).norm() / l : 0;
}
}  // namespace homolog
