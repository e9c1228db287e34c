#include "core/adapt/contours/contour_target.h"

#include <algorithm>
#include <limits>

#include "core/base/numbers/nearest_on_segment.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

constexpr double facing_alike = -0.5;  ///< cosine between directions of places that may belong together
/// A distance of this share of the curves' diagonal counts as much as a right angle between directions.
constexpr double turned_share = 0.05;
constexpr double little = 0.05;  ///< the pull of a curve that lies outside to where the boundary is likeliest

/// A straight piece of a mesh's section with a plane.
struct SectionPiece {
  std::int32_t face;
  Vec3 from_weights, to_weights;  ///< weights of the face's corners
  Vec3 from, to, outward;         ///< mm; outward in the plane, unit
};

std::vector<SectionPiece> section_of(const Mesh& mesh, const ContourPlane& plane) {
  std::vector<SectionPiece> pieces;
  const Triangles& triangles = mesh.topology->triangles();
  const VertexScalars height = (mesh.points.rowwise() - plane.at.transpose()) * plane.normal;
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    std::array<Vec3, 2> weights;
    std::size_t ends = 0;
    for (int k = 0; k < 3; ++k) {
      const double a = height[triangles(f, k)], b = height[triangles(f, (k + 1) % 3)];
      if ((a >= 0) == (b >= 0)) continue;
      const double share = a / (a - b);
      weights[ends] = Vec3::Zero();
      weights[ends][k] = 1 - share;
      weights[ends][(k + 1) % 3] = share;
      ++ends;
    }
    if (ends != 2) continue;
    SectionPiece piece{static_cast<std::int32_t>(f), weights[0], weights[1], {}, {}, {}};
    piece.from = SurfacePoint{piece.face, weights[0]}.interpolate(*mesh.topology, mesh.points).transpose();
    piece.to = SurfacePoint{piece.face, weights[1]}.interpolate(*mesh.topology, mesh.points).transpose();
    const Vec3 normal = area_normal(mesh, f);
    piece.outward = (normal - normal.dot(plane.normal) * plane.normal).stableNormalized();
    pieces.push_back(piece);
  }
  return pieces;
}

/// Sums what pulls at vertices.
class VertexPulls {
 public:
  explicit VertexPulls(const Mesh& mesh)
      : mesh_(mesh), sum_(Points::Zero(mesh.points.rows(), 3)), weights_(VertexScalars::Zero(mesh.points.rows())) {}

  void add(const SurfacePoint& on, const Vec3& way, double weight) {
    const auto corners = mesh_.topology->triangles().row(on.face);
    for (int c = 0; c < 3; ++c) {
      sum_.row(corners[c]) += on.weights[c] * weight * way.transpose();
      weights_[corners[c]] += on.weights[c] * weight;
    }
  }

  TargetPull pull() const {
    TargetPull pull{mesh_.points, weights_.cwiseMin(1), {}};
    for (Eigen::Index i = 0; i < sum_.rows(); ++i)
      if (weights_[i] > 0) pull.targets.row(i) += sum_.row(i) / weights_[i];
    return pull;
  }

 private:
  const Mesh& mesh_;
  Points sum_;
  VertexScalars weights_;
};

}  // namespace

ContourTarget::ContourTarget(ContourSamples contours) : contours_(std::move(contours)) {}

std::vector<ContourMeeting> ContourTarget::meetings(const Mesh& mesh) const {
  std::vector<std::vector<SectionPiece>> sections;
  for (const ContourPlane& plane : contours_.planes) sections.push_back(section_of(mesh, plane));
  const Points normals = vertex_normals(mesh);
  const SurfaceSearch search(mesh);
  const double turned_mm = turned_share * size_mm();
  std::vector<ContourMeeting> meetings;
  for (std::size_t k = 0; k < contours_.samples.size(); ++k) {
    const ContourSample& sample = contours_.samples[k];
    ContourMeeting met{k, {}, Vec3::Zero(), Vec3::Zero()};
    double least = std::numeric_limits<double>::infinity();
    if (sample.plane >= 0)
      for (const SectionPiece& piece : sections[sample.plane]) {
        const double facing = sample.outward.isZero() ? 1 : piece.outward.dot(sample.outward);
        if (facing < facing_alike) continue;
        const double along = nearest_on_segment(sample.likely, piece.from, piece.to);
        const Vec3 place = piece.from + along * (piece.to - piece.from);
        const double cost = (place - sample.likely).squaredNorm() + (1 - facing) * turned_mm * turned_mm;
        if (cost >= least) continue;
        least = cost;
        met.on = {piece.face, (1 - along) * piece.from_weights + along * piece.to_weights};
        met.position = place;
      }
    if (!(least < std::numeric_limits<double>::infinity())) {
      const auto nearest = search.nearest(sample.likely);
      met.on = nearest.at;
      met.position = nearest.position;
    }
    met.normal = met.on.interpolate(*mesh.topology, normals).transpose().stableNormalized();
    meetings.push_back(met);
  }
  return meetings;
}

std::vector<BeyondLimit> ContourTarget::beyond(const Mesh& mesh) const {
  std::vector<BeyondLimit> beyond;
  for (std::size_t p = 0; p < contours_.planes.size(); ++p) {
    std::vector<const ContourSample*> limits;
    for (const ContourSample& sample : contours_.samples)
      if (sample.outside && sample.plane == static_cast<int>(p) && !sample.outward.isZero()) limits.push_back(&sample);
    if (limits.empty()) continue;
    for (const SectionPiece& piece : section_of(mesh, contours_.planes[p])) {
      const Vec3 middle = (piece.from + piece.to) / 2;
      const ContourSample* nearest = *std::min_element(limits.begin(), limits.end(), [&](auto* a, auto* b) {
        return (a->at - middle).squaredNorm() < (b->at - middle).squaredNorm();
      });
      const double out_mm = (middle - nearest->at).dot(nearest->outward);
      if (out_mm > 0)
        beyond.push_back({{piece.face, (piece.from_weights + piece.to_weights) / 2},
                          middle,
                          middle - out_mm * nearest->outward,
                          (piece.to - piece.from).norm()});
    }
  }
  return beyond;
}

TargetPull ContourTarget::pull(const Mesh& mesh, double /*share*/) {
  VertexPulls pulls(mesh);
  const double edge_mm = mean_edge_mm(*mesh.topology, mesh.points);
  for (const ContourMeeting& met : meetings(mesh)) {
    const ContourSample& sample = contours_.samples[met.sample];
    // What a tilted surface must move by to meet the curve is less than the way in the plane.
    const Vec3 way = sample.likely - met.position;
    const double counts = edge_mm * edge_mm / (edge_mm * edge_mm + sample.off_mm * sample.off_mm);
    pulls.add(met.on, way.dot(met.normal) * met.normal,
              (sample.outside ? little : 1) * counts * sample.length_mm / edge_mm);
  }
  for (const BeyondLimit& one : beyond(mesh)) pulls.add(one.on, one.limit - one.position, one.length_mm / edge_mm);
  return pulls.pull();
}

VertexScalars ContourTarget::off_pieces_mm(const Mesh& mesh) const {
  const SurfaceSearch search(mesh);
  VertexScalars off_mm(std::ssize(contours_.samples));
  for (Eigen::Index k = 0; k < off_mm.size(); ++k) {
    const ContourSample& sample = contours_.samples[k];
    const auto nearest = search.nearest(sample.at);
    const bool within = sample.outside && (sample.at - nearest.position).dot(area_normal(mesh, nearest.at.face)) > 0;
    off_mm[k] = within ? 0 : nearest.distance_mm;
  }
  return off_mm;
}

}  // namespace homolog
