#include "core/structures/fitting/neighbours_say.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/adapt/boundary/cut_template.h"
#include "core/adapt/boundary/find_placement.h"
#include "core/adapt/labels/choose_closing.h"
#include "core/base/numbers/statistics.h"
#include "core/base/processes/parallel.h"
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

std::vector<std::optional<Mesh>> expected_shapes(const SetOfTemplates& set, const SetInMap& subject,
                                                 const FittedSet& fitted, const Progress* progress) {
  constexpr double usual_deviation =
      0.04;  // of sizes beside their neighbours'; a half must not shrink what is expected
  std::vector<std::optional<Mesh>> expected(set.templates.size());
  for_each_in_parallel(expected.size(), [&](std::size_t k) {
    if (set.templates[k] == nullptr || (progress != nullptr && progress->cancelled())) return;
    const Template& own = *set.templates[k];
    // One that is cut off itself says where a structure is missing, but nothing of the form of one that is there.
    const bool is_there = subject.structures[k].is_there();
    if (is_there && !cut_borders(own, own.points).empty()) return;
    auto said = said_by_neighbours(set, fitted.structures, k);
    if (!said) return;
    if (is_there) {
      const StructureInMap& there = subject.structures[k];
      const int value = there.segment.value;
      const auto boundary = label_boundary(*there.mask, value, 0, usual_closing_mm(*there.mask, value, 0),
                                           own.points.rows(), {.all = true});
      if (boundary)
        said = find_placement(own, *boundary, {.start = said, .partial = true, .size_deviation = usual_deviation})
                   .placement;
    }
    expected[k] = Mesh{own.topology, said->apply(own.points)};
  });
  return expected;
}

}  // namespace homolog
