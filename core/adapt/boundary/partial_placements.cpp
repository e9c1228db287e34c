#include "core/adapt/boundary/partial_placements.h"

#include <array>

namespace homolog {

namespace {

/// `growth` times as large, and moved by `shift` of the diagonal.
struct Change {
  double growth, shift;
};
constexpr std::array<Change, other_placements> changes{{{1.06, 0}, {1.12, 0}, {1, 0.05}}};

}  // namespace

std::vector<Similarity> placements_towards(const Similarity& found, const Points& points,
                                           const VertexScalars& missing) {
  const VertexScalars there = (1 - missing.array()).matrix();
  if (!(missing.sum() > 0) || !(there.sum() > 0)) return {};
  const Vec3 towards = points.transpose() * (missing / missing.sum() - there / there.sum());
  const Vec3 along = towards.stableNormalized();
  Eigen::Index farthest = 0;
  (points * along).minCoeff(&farthest);
  const Vec3 kept = points.row(farthest);
  const double size_mm = bounds_of(points).diagonal().norm();
  std::vector<Similarity> placements;
  for (const auto& [growth, shift] : changes) {
    Similarity other = found;
    other.scale *= growth;
    other.translation = kept + growth * (found.translation - kept) + shift * size_mm * along;
    placements.push_back(other);
  }
  return placements;
}

}  // namespace homolog
