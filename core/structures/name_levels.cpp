#include "core/structures/name_levels.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <utility>

#include "core/adapt/boundary/find_placement.h"
#include "core/adapt/choose_closing.h"
#include "core/base/parallel.h"
#include "core/mesh/mesh_quality.h"
#include "core/structures/defects.h"

namespace homolog {

namespace {

/// How far a template lies from a label at best, by the root of its area: as it is, and those of the levels about it.
struct LevelCosts {
  bool is_there = false;
  std::array<double, 3> cost{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::quiet_NaN()};  ///< level − 1, level, level + 1
};

double cost_of(const Template& the_template, const Boundary& boundary) {
  const Placed placed = find_placement(the_template, boundary);
  return placed.distance_mm / std::sqrt(surface_area_mm2(boundary.surface));
}

}  // namespace

std::optional<LevelEvidence> level_evidence(const SetOfTemplates& set, const SetInMap& subject,
                                            const std::vector<char>& sound) {
  std::map<int, std::size_t> levels;
  for (std::size_t k = 0; k < set.templates.size(); ++k)
    if (const auto level = level_of_name(set.set.structures[k].name); level && set.templates[k] != nullptr)
      levels.emplace(*level, k);
  std::vector<std::pair<int, std::size_t>> chain(levels.begin(), levels.end());
  std::vector<LevelCosts> costs(chain.size());
  for_each_in_parallel(chain.size(), [&](std::size_t c) {
    const auto [level, k] = chain[c];
    const StructureInMap& there = subject.structures[k];
    if (sound[k] == 0) return;
    const auto boundary =
        label_boundary(*there.mask, there.segment.value, 0, usual_closing_mm(*there.mask, there.segment.value, 0),
                       set.templates[k]->points.rows());
    if (!boundary) return;
    costs[c].is_there = true;
    for (int by = -1; by <= 1; ++by)
      if (const auto other = levels.find(level + by); other != levels.end())
        costs[c].cost[static_cast<std::size_t>(by + 1)] = cost_of(*set.templates[other->second], *boundary);
  });
  LevelEvidence evidence;
  double least = std::numeric_limits<double>::infinity();
  bool any = false;
  for (const int by : {-1, 1}) {
    double sum = 0, squares = 0;
    int count = 0;
    for (const LevelCosts& one : costs) {
      const double more = one.cost[static_cast<std::size_t>(by + 1)] - one.cost[1];
      if (!one.is_there || !std::isfinite(more)) continue;
      const double relative = more / one.cost[1];
      sum += relative;
      squares += relative * relative;
      ++count;
      if (std::getenv("HOMOLOG_LEVELS")) std::fprintf(stderr, "%d %.3f; ", by, relative);
    }
    if (count < 3) continue;
    any = true;
    const double mean = sum / count, deviation = std::sqrt(std::max(1e-6, squares / count - mean * mean));
    const double t = mean / (deviation / std::sqrt(count));
    if (std::getenv("HOMOLOG_LEVELS")) std::fprintf(stderr, "shift %d mean %.4f t %.3f\n", by, mean, t);
    if (t < least) {
      least = t;
      evidence.shift = by;
    }
  }
  if (!any) return std::nullopt;
  evidence.p_as_named = 1 / (1 + std::exp(-least));
  return evidence;
}

}  // namespace homolog
