#include "core/structures/name_levels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "core/adapt/boundary/find_placement.h"
#include "core/adapt/choose_closing.h"
#include "core/base/parallel.h"
#include "core/base/statistics.h"
#include "core/structures/defects.h"

namespace homolog {

namespace {

/// A template on a label, placed at its best.
struct OnLabel {
  double distance_mm = 0;  ///< root mean square
  double scale = 0;        ///< 0: there is no such template
  double radius_mm = 0;    ///< root mean square distance of the label's surface from its middle
};

/// The templates of the level before a vertebra's, of its own and of the next.
using LevelTries = std::array<OnLabel, 3>;

OnLabel placed_on(const Template& the_template, const Boundary& boundary) {
  const Placed placed = find_placement(the_template, boundary);
  const Points& points = boundary.surface.points;
  const Points middle = points.colwise().mean();
  const double radius_mm = std::sqrt((points.rowwise() - middle.row(0)).rowwise().squaredNorm().mean());
  return {placed.distance_mm, placed.placement.scale, radius_mm};
}

/// How far a template lies off where it has the size that the others of its set have: by its form and by its size.
double cost_of(const OnLabel& there, double usual_scale) {
  return std::hypot(there.distance_mm, there.radius_mm * std::log(there.scale / usual_scale));
}

}  // namespace

std::optional<LevelEvidence> level_evidence(const SetOfTemplates& set, const SetInMap& subject,
                                            const std::vector<char>& sound) {
  std::map<int, std::size_t> levels;
  for (std::size_t k = 0; k < set.templates.size(); ++k)
    if (const auto level = level_of_name(set.set.structures[k].name); level && set.templates[k] != nullptr)
      levels.emplace(*level, k);
  std::vector<std::pair<int, std::size_t>> chain(levels.begin(), levels.end());
  std::vector<LevelTries> tries(chain.size());
  for_each_in_parallel(chain.size(), [&](std::size_t c) {
    const auto [level, k] = chain[c];
    const StructureInMap& there = subject.structures[k];
    if (sound[k] == 0) return;
    const auto boundary =
        label_boundary(*there.mask, there.segment.value, 0, usual_closing_mm(*there.mask, there.segment.value, 0),
                       set.templates[k]->points.rows());
    if (!boundary) return;
    for (int by = -1; by <= 1; ++by)
      if (const auto other = levels.find(level + by); other != levels.end())
        tries[c][static_cast<std::size_t>(by + 1)] = placed_on(*set.templates[other->second], *boundary);
  });
  // If all names are a level off, the others' sizes are those of the levels that they really are.
  const auto usual_scale = [&](int by) {
    std::vector<double> scales;
    for (const LevelTries& one : tries)
      if (const double scale = one[static_cast<std::size_t>(by + 1)].scale; scale > 0) scales.push_back(scale);
    return scales.empty() ? 1 : median_of(scales);
  };
  LevelEvidence evidence;
  double least = std::numeric_limits<double>::infinity();
  bool any = false;
  for (const int by : {-1, 1}) {
    double sum = 0, squares = 0;
    int count = 0;
    for (const LevelTries& one : tries) {
      const OnLabel &own = one[1], &other = one[static_cast<std::size_t>(by + 1)];
      if (!(own.scale > 0 && other.scale > 0)) continue;
      const double own_cost = cost_of(own, usual_scale(0)), more = cost_of(other, usual_scale(by)) - own_cost;
      // A vertebra that is ill, or a template of one, has no larger say than others.
      constexpr double most = 0.25;
      const double relative = std::clamp(more / own_cost, -most, most);
      sum += relative;
      squares += relative * relative;
      ++count;
    }
    if (count < 3) continue;
    any = true;
    const double mean = sum / count, deviation = std::sqrt(std::max(1e-6, squares / count - mean * mean));
    const double t = mean / (deviation / std::sqrt(count));
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
