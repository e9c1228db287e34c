#include "core/structures/naming/name_levels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/adapt/boundary/find_placement.h"
#include "core/adapt/labels/choose_closing.h"
#include "core/base/numbers/statistics.h"
#include "core/base/processes/parallel.h"
#include "core/structures/naming/level_names.h"
#include "core/structures/naming/level_places.h"

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

/// How each structure of a chain lies on the templates of its level and those beside it.
std::vector<LevelTries> tries_of(const SetOfTemplates& set, const SetInMap& subject, const std::vector<char>& sound,
                                 const LevelChain& chain, const Progress* progress) {
  const std::vector<std::pair<std::size_t, int>> members(chain.apart.begin(), chain.apart.end());
  std::vector<LevelTries> tries(members.size());
  for_each_in_parallel(members.size(), [&](std::size_t c) {
    const auto [k, apart] = members[c];
    if (sound[k] == 0 || (progress != nullptr && progress->cancelled())) return;
    const StructureInMap& there = subject.structures[k];
    const auto boundary =
        label_boundary(*there.mask, there.segment.value, 0, usual_closing_mm(*there.mask, there.segment.value, 0),
                       set.templates[k]->points.rows());
    if (!boundary) return;
    const int level = *level_of_name(set.set.structures[k].name) + apart;
    for (int by = -1; by <= 1; ++by)
      if (const auto other = chain.by_level.find(level + by); other != chain.by_level.end())
        tries[c][by + 1] = placed_on(*set.templates[other->second], *boundary);
  });
  return tries;
}

/// How much likelier the shapes of a chain are if it is moved. None where fewer than three structures tell. Two levels
/// away only what the level on the way there tells: each more that is tried may be likelier by chance.
LevelEvidence level_evidence_of_shapes(const SetOfTemplates& set, const SetInMap& subject,
                                       const std::vector<char>& sound, const LevelChain& chain,
                                       const Progress* progress) {
  const std::vector<LevelTries> tries = tries_of(set, subject, sound, chain, progress);
  // If all names are a level off, the others' sizes are those of the levels that they really are.
  const auto usual_scale = [&](int by) {
    std::vector<double> scales;
    for (const LevelTries& one : tries)
      if (const double scale = one[by + 1].scale; scale > 0) scales.push_back(scale);
    return scales.empty() ? 1 : median_of(scales);
  };
  LevelEvidence evidence;
  for (const int by : {-1, 1}) {
    double sum = 0, squares = 0;
    int count = 0;
    for (const LevelTries& one : tries) {
      const OnLabel &own = one[1], &other = one[by + 1];
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
    const double mean = sum / count, deviation = std::sqrt(std::max(1e-6, squares / count - mean * mean));
    for (std::size_t s = 0; s < level_shifts.size(); ++s)
      if (by * level_shifts[s] > 0) evidence[s] = -mean / (deviation / std::sqrt(count));
  }
  return evidence;
}

/// So many names are wrong where nothing tells, as the logarithm of their odds.
const double unknown_odds = std::log(0.03 / 0.97);

/// Which level a chain is likeliest of, beside what the most of its names say.
struct ChainShift {
  int by = 0;
  double evidence = unknown_odds;  ///< the logarithm of its odds
  bool some_say_so = false;        ///< by their names and places
};

const double clearly = std::log(4.0);  ///< from here on names are moved: they may be right

ChainShift likeliest_shift(const SetInMap& subject, const FittedSet& fitted, const LevelChain& chain,
                           const LevelEvidence& shapes, const LevelEvidence& others) {
  const double one_error = std::log(10.0), one_more_level = std::log(3.0);
  ChainShift likeliest;
  likeliest.evidence = -std::numeric_limits<double>::infinity();
  bool all_known = true;
  for (std::size_t s = 0; s < level_shifts.size(); ++s) {
    const int by = level_shifts[s];
    const bool some = chain.share(-by) > 0, is_next = std::abs(by) == 1;
    // Form alone does not tell that all are two levels off.
    const bool is_known = chain.share(0) > 0 && (some || others[s] || (is_next && shapes[s]));
    all_known = all_known && (is_known || !is_next);
    if (!is_known) continue;
    double evidence = shapes[s].value_or(0) + others[s].value_or(0);
    // Of names that agree their places and ends tell nothing.
    if (some)
      evidence += one_error * (chain.errors(0) + errors_at_ends(subject, fitted, chain, 0) - chain.errors(by) -
                               errors_at_ends(subject, fitted, chain, by));
    else if (!is_next)
      evidence -= one_more_level;
    if (evidence > likeliest.evidence) likeliest = {by, evidence, some};
  }
  return all_known || likeliest.evidence > unknown_odds ? likeliest : ChainShift();
}

/// The shift by the one that is nearest by its name.
int shift_of_nearest(const SetOfTemplates& set, const LevelChain& chain, int level) {
  int shift = 0, nearest = std::numeric_limits<int>::max();
  for (const auto& [k, apart] : chain.apart) {
    const int away = std::abs(*level_of_name(set.set.structures[k].name) - level);
    if (away < nearest) nearest = away, shift = apart;
  }
  return shift;
}

/// The finding for one structure, whose chain has been moved or not.
LevelFound found_of(const SetOfTemplates& set, const LevelChain& chain, const ChainShift& shift, bool moved,
                    std::size_t k) {
  const double p_shift = 1 / (1 + std::exp(-shift.evidence));
  const auto own = chain.apart.find(k);
  const int apart =
      own != chain.apart.end() ? own->second : shift_of_nearest(set, chain, *level_of_name(set.set.structures[k].name));
  if (moved) return {apart, 0, apart == 0 ? p_shift : 1 - p_shift};
  if (!shift.some_say_so || shift.evidence < -clearly) {
    const int maybe = apart == 0 && shift.evidence > 0 ? shift.by : 0;
    return {apart, maybe, apart == 0 ? 1 - p_shift : chain.share(apart)};
  }
  // Some are off, and nothing tells which.
  if (apart == 0) return {0, shift.by, 1 - p_shift};
  return {0, apart, apart == -shift.by ? p_shift : chain.share(apart)};
}

}  // namespace

std::vector<LevelFound> find_levels(const SetOfTemplates& set, const SetInMap& subject, const FittedSet& fitted,
                                    const std::vector<char>& placed, const std::vector<char>& sound,
                                    const Progress* progress) {
  std::vector<LevelChain> chains = level_chains(set, fitted, placed);
  std::vector<LevelEvidence> shapes;
  for (const LevelChain& chain : chains)
    shapes.push_back(level_evidence_of_shapes(set, subject, sound, chain, progress));
  std::vector<ChainShift> shifts(chains.size());
  std::vector<char> moved(chains.size());
  // One after the other, that with the most against its names first: two of which one is wrong accuse each other.
  for (;;) {
    std::size_t worst = chains.size();
    double most = clearly;
    for (std::size_t c = 0; c < chains.size(); ++c) {
      if (moved[c] != 0) continue;
      shifts[c] = likeliest_shift(subject, fitted, chains[c], shapes[c],
                                  level_evidence_of_others(set, fitted, placed, chains, c));
      if (shifts[c].evidence > most) worst = c, most = shifts[c].evidence;
    }
    if (worst == chains.size()) break;
    moved[worst] = 1;
    for (auto& [k, apart] : chains[worst].apart) apart += shifts[worst].by;
  }
  std::vector<LevelFound> found(set.templates.size());
  for (std::size_t c = 0; c < chains.size(); ++c)
    for (const auto& [level, k] : chains[c].by_level)
      if (subject.structures[k].is_there()) found[k] = found_of(set, chains[c], shifts[c], moved[c] != 0, k);
  return found;
}

}  // namespace homolog
