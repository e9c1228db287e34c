#include "core/measure/plane_section.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/numbers/nearest_on_segment.h"

namespace homolog {

namespace {

/// The plane's way through one face: it comes in through the edge where the corners go below the plane, and leaves
/// through the one where they come up. The face across the latter has it as the former.
struct SectionFace {
  int in = -1, out = -1;  ///< edge k is from corner k to corner k + 1; −1: the plane misses the face
};

class PlaneCut {
 public:
  PlaneCut(const Mesh& mesh, const Vec3& at, const Vec3& normal)
      : mesh_(mesh), height_mm_((mesh.points.rowwise() - at.transpose()) * normal) {
    const Triangles& triangles = mesh.topology->triangles();
    faces_.resize(static_cast<std::size_t>(triangles.rows()));
    for (Eigen::Index f = 0; f < triangles.rows(); ++f)
      for (int k = 0; k < 3; ++k) {
        const bool from = above(f, k), to = above(f, (k + 1) % 3);
        if (from && !to) faces_[f].in = k;
        if (!from && to) faces_[f].out = k;
      }
  }

  std::vector<SectionLine> lines() {
    std::vector<SectionLine> lines;
    std::vector<char> seen(faces_.size(), 0);
    // Open lines begin where no face comes before; what is left then is closed.
    for (const bool open : {true, false})
      for (Eigen::Index f = 0; f < std::ssize(faces_); ++f) {
        const SectionFace& face = faces_[f];
        if (face.in < 0 || seen[f]) continue;
        if (open && across(f, face.in) >= 0) continue;
        SectionLine line;
        line.closed = !open;
        if (open) line.points.push_back(crossing(f, face.in));
        for (Eigen::Index at = f; at >= 0 && !seen[at];) {
          seen[at] = 1;
          const int out = faces_[at].out;
          line.points.push_back(crossing(at, out));
          at = across(at, out);
        }
        lines.push_back(std::move(line));
      }
    return lines;
  }

 private:
  bool above(Eigen::Index face, int corner) const { return height_mm_[mesh_.topology->triangles()(face, corner)] >= 0; }
  Eigen::Index across(Eigen::Index face, int edge) const { return mesh_.topology->neighbours(face)[edge]; }
  Vec3 crossing(Eigen::Index face, int edge) const {
    std::int32_t a = mesh_.topology->triangles()(face, edge), b = mesh_.topology->triangles()(face, (edge + 1) % 3);
    if (a > b) std::swap(a, b);  // both faces of an edge find the same point, to the last bit
    const double share = height_mm_[a] / (height_mm_[a] - height_mm_[b]);
    return mesh_.points.row(a) + share * (mesh_.points.row(b) - mesh_.points.row(a));
  }

  const Mesh& mesh_;
  VertexScalars height_mm_;
  std::vector<SectionFace> faces_;
};

}  // namespace

std::vector<SectionLine> plane_section(const Mesh& mesh, const Vec3& at, const Vec3& normal) {
  return PlaneCut(mesh, at, normal).lines();
}

double length_mm(const SectionLine& line) {
  double sum = 0;
  for (std::size_t k = 1; k < line.points.size(); ++k) sum += (line.points[k] - line.points[k - 1]).norm();
  if (line.closed && !line.points.empty()) sum += (line.points.front() - line.points.back()).norm();
  return sum;
}

double area_within_mm2(const std::vector<SectionLine>& lines, const Vec3& normal) {
  double twice = 0;
  for (const SectionLine& line : lines) {
    if (line.points.empty()) continue;
    const Vec3& first = line.points.front();
    for (std::size_t k = 2; k < line.points.size(); ++k)
      twice += (line.points[k - 1] - first).cross(line.points[k] - first).dot(normal);
  }
  return std::abs(twice) / 2;
}

double distance_to_line_mm(const SectionLine& line, const Vec3& p) {
  double nearest = std::numeric_limits<double>::infinity();
  const std::size_t count = line.points.size();
  for (std::size_t k = 0; k < count; ++k) {
    if (k + 1 == count && !line.closed) break;
    const Vec3 &a = line.points[k], &b = line.points[(k + 1) % count];
    nearest = std::min(nearest, (a + nearest_on_segment(p, a, b) * (b - a) - p).norm());
  }
  return nearest;
}

}  // namespace homolog
