#include "core/volume/redrawn_contour.h"

#include <algorithm>
#include <utility>

#include "core/base/numbers/nearest_on_segment.h"

namespace homolog {

namespace {

/// Moves a stroke's ends to two places. What lies farther along than `reach_mm` stays.
std::vector<Vec3> led_to(std::vector<Vec3> stroke, const Vec3& begin, const Vec3& end, double reach_mm) {
  std::vector<double> along_mm{0};
  for (std::size_t k = 1; k < stroke.size(); ++k)
    along_mm.push_back(along_mm.back() + (stroke[k] - stroke[k - 1]).norm());
  const double all_mm = along_mm.back(), reach = std::min(reach_mm, all_mm / 2);
  if (reach <= 0) return stroke;
  const Vec3 at_begin = begin - stroke.front(), at_end = end - stroke.back();
  for (std::size_t k = 0; k < stroke.size(); ++k)
    stroke[k] +=
        std::max(0.0, 1 - along_mm[k] / reach) * at_begin + std::max(0.0, 1 - (all_mm - along_mm[k]) / reach) * at_end;
  return stroke;
}

/// A closed curve of a stroke and of the points of `curve` on the way from where the stroke ends to where it begins.
Contour closed_by(const Contour& curve, std::vector<Vec3> stroke, const PlaceOnContour& end,
                  const PlaceOnContour& begin) {
  const std::size_t n = curve.points.size();
  std::size_t stay = (begin.piece + n - end.piece) % n;
  if (stay == 0 && begin.share < end.share) stay = n;
  for (std::size_t k = 1; k <= stay; ++k) stroke.push_back(curve.points[(end.piece + k) % n]);
  return {std::move(stroke), true, curve.cuts_out};
}

double area_of(const Contour& curve) {
  const auto& p = curve.points;
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < p.size(); ++k) sum += (p[k] - p[0]).cross(p[(k + 1) % p.size()] - p[0]);
  return sum.norm() / 2;
}

/// Without points that lie on the one before.
Contour without_repeats(Contour curve) {
  constexpr double same_mm = 1e-6;
  auto& p = curve.points;
  const auto same = [](const Vec3& a, const Vec3& b) { return (a - b).norm() < same_mm; };
  p.erase(std::unique(p.begin(), p.end(), same), p.end());
  while (curve.closed && p.size() > 1 && same(p.front(), p.back())) p.pop_back();
  return curve;
}

}  // namespace

PlaceOnContour nearest_place(const Contour& curve, const Vec3& p) {
  const std::size_t n = curve.points.size(), pieces = curve.closed ? n : n - 1;
  PlaceOnContour nearest{.at = curve.points.front()};
  for (std::size_t k = 0; k < pieces; ++k) {
    const Vec3 &a = curve.points[k], &b = curve.points[(k + 1) % n];
    const double share = nearest_on_segment(p, a, b);
    const Vec3 at = a + share * (b - a);
    if ((at - p).squaredNorm() < (nearest.at - p).squaredNorm()) nearest = {k, share, at};
  }
  return nearest;
}

std::optional<Contour> redrawn_contour(const Contour& curve, const std::vector<Vec3>& stroke, double near_mm) {
  if (stroke.size() < 2 || curve.points.size() < 2) return std::nullopt;
  constexpr double reach = 2;  // times near_mm: the bend towards the curve is no sharper than that
  const auto near = [&](const Vec3& a, const Vec3& b) { return (a - b).norm() <= near_mm; };
  PlaceOnContour begin = nearest_place(curve, stroke.front()), end = nearest_place(curve, stroke.back());
  if (!near(begin.at, stroke.front()) || !near(end.at, stroke.back())) return std::nullopt;
  if (curve.closed) {
    const auto drawn = led_to(stroke, begin.at, end.at, reach * near_mm);
    Contour one = closed_by(curve, drawn, end, begin);
    Contour other = closed_by(curve, {drawn.rbegin(), drawn.rend()}, begin, end);
    return without_repeats(area_of(one) >= area_of(other) ? std::move(one) : std::move(other));
  }
  std::vector<Vec3> drawn = stroke;
  if (std::pair(begin.piece, begin.share) > std::pair(end.piece, end.share)) {
    std::reverse(drawn.begin(), drawn.end());
    std::swap(begin, end);
  }
  const Vec3 &first = curve.points.front(), &last = curve.points.back();
  Contour result = curve;
  if (near(drawn.front(), first) && near(drawn.back(), last)) {
    std::reverse(drawn.begin(), drawn.end());
    drawn = led_to(std::move(drawn), last, first, reach * near_mm);
    result.points.insert(result.points.end(), drawn.begin(), drawn.end());
    result.closed = true;
    return without_repeats(std::move(result));
  }
  drawn = led_to(std::move(drawn), begin.at, end.at, reach * near_mm);
  const auto at = [&](std::size_t k) { return result.points.begin() + static_cast<std::ptrdiff_t>(k); };
  result.points.erase(at(begin.piece + 1), at(end.piece + 1));
  result.points.insert(at(begin.piece + 1), drawn.begin(), drawn.end());
  return without_repeats(std::move(result));
}

}  // namespace homolog
