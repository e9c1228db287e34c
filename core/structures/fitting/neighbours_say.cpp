#include "core/structures/fitting/neighbours_say.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/numbers/statistics.h"
#include "core/placement/similarity_fit.h"

namespace homolog {

namespace {

/// Structures and how far off they are.
using NearStructures = std::vector<std::pair<double, std::size_t>>;

/// The nearest of them that agree on how the body lies.
std::vector<std::size_t> in_agreement(const SetOfTemplates& set, const std::vector<FittedStructure>& fitted,
                                      NearStructures near) {
  constexpr std::size_t most = 4, enough = 3;
  constexpr double far_off = 2;  // times the middle distance of all
  std::ranges::sort(near);
  std::vector<std::size_t> which;
  for (std::size_t k = 0; k < std::min(most, near.size()); ++k) which.push_back(near[k].second);
  while (which.size() >= enough) {
    const Similarity said = similarity_of_fits(set, fitted, which);
    std::vector<double> off_mm;
    for (const std::size_t k : which) {
      const Points there = said.apply(set.templates[k]->points);
      off_mm.push_back(std::sqrt((there - fitted[k].fit->mesh.points).rowwise().squaredNorm().mean()));
    }
    const auto worst = std::ranges::max_element(off_mm);
    if (*worst <= far_off * median_of(off_mm)) break;
    which.erase(which.begin() + (worst - off_mm.begin()));
  }
  return which;
}

std::optional<Similarity> said_by(const SetOfTemplates& set, const std::vector<FittedStructure>& fitted,
                                  const std::vector<std::size_t>& which) {
  if (which.empty()) return std::nullopt;
  return similarity_of_fits(set, fitted, which);
}

}  // namespace

Similarity similarity_of_fits(const SetOfTemplates& set, const std::vector<FittedStructure>& fitted,
                              const std::vector<std::size_t>& which) {
  Eigen::Index rows = 0;
  for (const std::size_t k : which) rows += set.templates[k]->points.rows();
  Points from(rows, 3), to(rows, 3);
  rows = 0;
  for (const std::size_t k : which) {
    const Points& own = set.templates[k]->points;
    from.middleRows(rows, own.rows()) = own;
    to.middleRows(rows, own.rows()) = fitted[k].fit->mesh.points;
    rows += own.rows();
  }
  return nearest_similarity(from, to, {});
}

std::vector<std::size_t> near_structures(const SetOfTemplates& set, const std::vector<FittedStructure>& fitted,
                                         std::size_t of) {
  NearStructures near;
  if (set.templates[of] == nullptr) return {};
  const Vec3 middle = middle_of(set.templates[of]->points);
  for (std::size_t k = 0; k < fitted.size(); ++k)
    if (k != of && has_a_say(fitted[k])) near.emplace_back((middle_of(set.templates[k]->points) - middle).norm(), k);
  return in_agreement(set, fitted, std::move(near));
}

std::optional<Similarity> said_by_neighbours(const SetOfTemplates& set, const std::vector<FittedStructure>& fitted,
                                             std::size_t of) {
  return said_by(set, fitted, near_structures(set, fitted, of));
}

std::optional<Similarity> said_by_neighbours_at(const SetOfTemplates& set, const std::vector<FittedStructure>& fitted,
                                                const Vec3& place_mm) {
  NearStructures near;
  for (std::size_t k = 0; k < fitted.size(); ++k)
    if (has_a_say(fitted[k])) near.emplace_back((middle_of(fitted[k].fit->mesh.points) - place_mm).norm(), k);
  return said_by(set, fitted, in_agreement(set, fitted, std::move(near)));
}

}  // namespace homolog
