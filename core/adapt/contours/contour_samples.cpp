#include "core/adapt/contours/contour_samples.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/measure/plane_section.h"

namespace homolog {

namespace {

constexpr double flat_share = 0.01;  ///< share of a curve's extent: how far its points may lie from its plane
constexpr double same_plane_share = 1e-3;
constexpr double loose_area = 1.5;  ///< area of a stroke that lies outside, over the organ's
constexpr std::size_t fewest_pieces = 8;

/// The plane of a curve; none where it is straight or lies in none.
std::optional<ContourPlane> plane_through(const Contour& curve) {
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : curve.points) centre += p / static_cast<double>(curve.points.size());
  Mat3 spread = Mat3::Zero();
  for (const Vec3& p : curve.points) spread += (p - centre) * (p - centre).transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(spread);
  const Vec3 along = solver.eigenvalues().cwiseMax(0).cwiseSqrt();  // ascending
  if (!(along[1] > flat_share * along[2]) || along[0] > flat_share * along[2]) return std::nullopt;
  return ContourPlane{centre, curve.closed ? plane_of(curve).second : Vec3(solver.eigenvectors().col(0))};
}

int index_of(const ContourPlane& plane, double extent_mm, std::vector<ContourPlane>& planes) {
  for (std::size_t k = 0; k < planes.size(); ++k)
    if (planes[k].normal.cross(plane.normal).norm() < same_plane_share &&
        std::abs((plane.at - planes[k].at).dot(planes[k].normal)) < same_plane_share * extent_mm)
      return static_cast<int>(k);
  planes.push_back(plane);
  return static_cast<int>(planes.size()) - 1;
}

/// Whether a point of a plane lies inside a closed curve there: by the angle that it turns around it.
bool is_inside(const Vec3& p, const Contour& curve, const Vec3& normal) {
  double turned = 0;
  const auto& points = curve.points;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vec3 a = points[k] - p, b = points[(k + 1) % points.size()] - p;
    turned += std::atan2(a.cross(b).dot(normal), a.dot(b));
  }
  return std::abs(turned) > 1;
}

double signed_area_mm2(const Contour& curve, const Vec3& normal) {
  Vec3 twice = Vec3::Zero();
  const auto& p = curve.points;
  for (std::size_t k = 0; k < p.size(); ++k) twice += (p[k] - p[0]).cross(p[(k + 1) % p.size()] - p[0]);
  return twice.dot(normal) / 2;
}

double length_of(const Contour& curve) {
  return length_mm(SectionLine{curve.points, curve.closed});
}

/// The curve's pieces, without what they mean.
std::vector<ContourSample> pieces_of(const Contour& curve, std::size_t count) {
  std::vector<ContourSample> pieces;
  const double step_mm = length_of(curve) / static_cast<double>(count);
  double next_mm = step_mm / 2, passed_mm = 0;
  const std::size_t edges = curve.points.size() - (curve.closed ? 0 : 1);
  for (std::size_t k = 0; k < edges && pieces.size() < count; ++k) {
    const Vec3 &a = curve.points[k], &b = curve.points[(k + 1) % curve.points.size()];
    const double edge_mm = (b - a).norm();
    for (; next_mm <= passed_mm + edge_mm && pieces.size() < count && edge_mm > 0; next_mm += step_mm) {
      ContourSample piece;
      piece.at = piece.likely = a + (next_mm - passed_mm) / edge_mm * (b - a);
      piece.outward = (b - a) / edge_mm;  // along, for now
      piece.length_mm = step_mm;
      pieces.push_back(piece);
    }
    passed_mm += edge_mm;
  }
  return pieces;
}

/// The end of the last edge of a path along which an edge from the path's end runs back, or beside it with a slit
/// between them as some programs leave; 0 where there is none.
std::size_t edge_back(const std::vector<Vec3>& path, const Vec3& to) {
  constexpr double widest_slit_mm = 0.1, widest_share = 0.1;  // share of the edge
  const double width_mm = std::min(widest_slit_mm, widest_share * (to - path.back()).norm());
  const auto near = [&](const Vec3& a, const Vec3& b) { return (a - b).squaredNorm() <= width_mm * width_mm; };
  std::size_t end = path.size() - 1;
  while (end > 0 && !(near(path[end - 1], to) && near(path[end], path.back()))) --end;
  return end;
}

/// The closed curves that are left of one when edges that it runs back the other way are dropped, both passes.
std::vector<Contour> without_channels(const Contour& curve) {
  std::vector<Contour> parts;
  std::vector<Vec3> path{curve.points.front()};
  // Takes away the end of the path, from a point on that is its last one too.
  const auto cut = [&](std::size_t begin) {
    Contour part = curve;
    part.points.assign(path.begin() + static_cast<std::ptrdiff_t>(begin), path.end() - 1);
    path.resize(begin + 1);
    if (part.points.size() > 2) parts.push_back(std::move(part));
  };
  for (std::size_t k = 1; k <= curve.points.size(); ++k) {
    const Vec3& to = curve.points[k % curve.points.size()];
    const std::size_t back = edge_back(path, to);
    if (back == 0) {
      path.push_back(to);
      continue;
    }
    cut(back);
    path.pop_back();
  }
  cut(0);
  return parts;
}

/// A curve that reaches its hole by a channel of no width (a keyhole) as its outline and the rim of its hole; any other
/// as it is.
std::vector<DrawnContour> without_keyhole(const DrawnContour& drawn) {
  if (!drawn.curve.closed || drawn.curve.points.size() < 3) return {drawn};
  std::vector<DrawnContour> result;
  const auto parts = without_channels(drawn.curve);
  bool nested = false;
  for (const Contour& part : parts) {
    result.push_back(drawn);
    result.back().curve = part;
    for (const Contour& other : parts)
      nested = nested || (&other != &part && is_inside(part.points.front(), other, plane_of(drawn.curve).second));
  }
  return nested ? result : std::vector{drawn};
}

}  // namespace

Points ContourSamples::likely() const {
  Points places(std::ssize(samples), 3);
  for (Eigen::Index k = 0; k < places.rows(); ++k) places.row(k) = samples[k].likely.transpose();
  return places;
}

double ContourSamples::diagonal_mm() const {
  Box box;
  for (const ContourSample& one : samples) box.extend(one.at);
  return samples.empty() ? 0 : box.diagonal().norm();
}

ContourSamples sampled_contours(const std::vector<DrawnContour>& drawn, std::size_t count) {
  std::vector<DrawnContour> contours;
  for (const DrawnContour& one : drawn)
    for (DrawnContour& part : without_keyhole(one)) contours.push_back(std::move(part));
  ContourSamples all;
  double length_mm = 0;
  std::vector<int> plane_of_curve;
  for (const DrawnContour& one : contours) {
    length_mm += length_of(one.curve);
    Box box;
    for (const Vec3& p : one.curve.points) box.extend(p);
    const auto plane = plane_through(one.curve);
    plane_of_curve.push_back(plane ? index_of(*plane, box.diagonal().norm(), all.planes) : -1);
  }
  for (std::size_t c = 0; c < contours.size(); ++c) {
    const DrawnContour& one = contours[c];
    const int plane = plane_of_curve[c];
    const Vec3 normal = plane >= 0 ? all.planes[plane].normal : Vec3(Vec3::Zero());
    const bool closed = one.curve.closed && plane >= 0;
    const double area_mm2 = closed ? signed_area_mm2(one.curve, normal) : 0;
    bool hole = false;
    for (std::size_t o = 0; o < contours.size() && closed; ++o)
      if (o != c && plane_of_curve[o] == plane && contours[o].curve.closed && contours[o].outside == one.outside &&
          is_inside(one.curve.points.front(), contours[o].curve, normal))
        hole = !hole;
    const double sense = (area_mm2 < 0) != hole ? -1 : 1;
    // A round organ's boundary lies by this much within a loose stroke.
    const double margin_mm =
        one.outside ? (1 - 1 / std::sqrt(loose_area)) * std::sqrt(std::abs(area_mm2) / std::numbers::pi) : 0;
    const auto pieces =
        std::max(fewest_pieces,
                 static_cast<std::size_t>(std::lround(static_cast<double>(count) * length_of(one.curve) / length_mm)));
    for (ContourSample piece : pieces_of(one.curve, pieces)) {
      piece.plane = plane;
      piece.outside = one.outside;
      piece.hole = hole;
      piece.outward = closed ? Vec3(sense * piece.outward.cross(normal)) : Vec3(Vec3::Zero());
      piece.likely = piece.at - margin_mm * piece.outward;
      piece.off_mm = std::hypot(one.off_mm, margin_mm / 2);
      all.samples.push_back(piece);
    }
  }
  // Very many curves have fewer pieces each: the equations of the warp are dense.
  constexpr std::size_t most_times = 4;
  if (const std::size_t stride = 1 + all.samples.size() / (most_times * count); stride > 1) {
    std::size_t k = 0;
    std::erase_if(all.samples, [&](const ContourSample&) { return k++ % stride != 0; });
    for (ContourSample& one : all.samples) one.length_mm *= static_cast<double>(stride);
  }
  return all;
}

}  // namespace homolog
