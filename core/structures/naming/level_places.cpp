#include "core/structures/naming/level_places.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/numbers/statistics.h"
#include "core/structures/fitting/neighbours_say.h"
#include "core/structures/naming/level_names.h"

namespace homolog {

namespace {

/// A structure of a chain that a map has.
struct Link {
  std::size_t k = 0;  ///< in the set
  int level = 0;      ///< by its name
  Vec3 in_set, in_map;
};

/// Those of a chain that have a say, in the order in which they lie, from above.
std::vector<Link> links_of(const LevelChain& chain, const SetOfTemplates& set, const FittedSet& fitted,
                           const std::vector<char>& placed) {
  std::vector<Link> links;
  for (const auto& [level, k] : chain.by_level)
    if (placed[k] != 0)
      links.push_back(
          {k, level, middle_of(set.templates[k]->points), middle_of(fitted.structures[k].fit->mesh.points)});
  if (links.size() < 2) return links;
  // By the direction in which most of them follow on each other, which a few wrong names do not change.
  Vec3 along = Vec3::Zero();
  for (std::size_t a = 0; a < links.size(); ++a)
    for (std::size_t b = a + 1; b < links.size(); ++b) along += (links[b].in_map - links[a].in_map).normalized();
  std::ranges::stable_sort(links, {}, [&](const Link& link) { return link.in_map.dot(along); });
  return links;
}

/// By how much a template set's space is enlarged in a map.
double usual_scale(const FittedSet& fitted, const std::vector<char>& placed) {
  std::vector<double> scales;
  for (std::size_t k = 0; k < placed.size(); ++k)
    if (placed[k] != 0) scales.push_back(fitted.structures[k].fit->placement.scale);
  return scales.empty() ? 1 : median_of(scales);
}

/// How far two neighbouring levels of a chain lie apart in a map, in the middle.
double usual_step(const std::vector<Link>& links, double scale) {
  std::vector<double> steps;
  for (std::size_t a = 0; a + 1 < links.size(); ++a)
    if (const int levels = std::abs(links[a + 1].level - links[a].level); levels != 0)
      steps.push_back(scale * (links[a + 1].in_set - links[a].in_set).norm() / levels);
  return steps.empty() ? 0 : median_of(steps);
}

constexpr int last_of_chest = 18, first_of_loin = 19;

/// By how many levels the second one lies below the first. `lacks_t12`: the map has no T12.
int levels_between(const Link& above, const Link& below, double scale, double usual, bool lacks_t12) {
  constexpr double unsure = 0.3;
  const int named = below.level - above.level;
  const double one = named != 0 ? scale * (below.in_set - above.in_set).norm() / std::abs(named) : usual;
  const double levels = (below.in_map - above.in_map).norm() / one;
  const int whole = static_cast<int>(std::lround(levels));
  if (whole < 1 || std::abs(levels - whole) > unsure) return std::max(1, named);
  // Who has 11 ribs has no T12; T13 and L1 count the same.
  const bool is_variant =
      below.level == first_of_loin && ((lacks_t12 && above.level == last_of_chest - 1) || named == 0);
  return is_variant && whole == 1 ? named : whole;
}

void find_contradictions(LevelChain& chain, const std::vector<Link>& links, double scale) {
  if (links.size() < 3) return;
  const double usual = usual_step(links, scale);
  const bool lacks_t12 = std::ranges::none_of(links, [](const Link& link) { return link.level == last_of_chest; });
  std::map<int, std::vector<std::size_t>> groups;  // by what the names are off
  int place = links.front().level;
  for (std::size_t a = 0; a < links.size(); ++a) {
    if (a > 0) place += levels_between(links[a - 1], links[a], scale, usual, lacks_t12);
    groups[place - links[a].level].push_back(links[a].k);
  }
  const auto most = std::ranges::max_element(groups, {}, [](const auto& group) { return group.second.size(); });
  for (const auto& [off, members] : groups)
    for (const std::size_t k : members) chain.apart[k] = off - most->first;
}

/// How far a structure of a chain lies from where another structure says, if it is of its own level and of each of
/// level_shifts: by how far such things usually err. None where the set does not have that level.
struct LevelErrors {
  double own = 0;
  LevelEvidence moved;
};
std::optional<LevelErrors> level_errors(const SetOfTemplates& set, const LevelChain& chain, int level,
                                        const Vec3& other_in_set, const Vec3& offset, const Similarity& body) {
  constexpr double usual_error = 0.25, least_error_mm = 5, most_errors = 3;
  if (!chain.by_level.contains(level)) return std::nullopt;
  const auto error_at = [&](std::size_t there) {
    const Vec3 said = body.scale * (body.rotation * (middle_of(set.templates[there]->points) - other_in_set));
    return std::min(most_errors, (said - offset).norm() / std::max(least_error_mm, usual_error * said.norm()));
  };
  LevelErrors errors{error_at(chain.by_level.at(level)), {}};
  for (std::size_t s = 0; s < level_shifts.size(); ++s)
    if (const auto there = chain.by_level.find(level + level_shifts[s]); there != chain.by_level.end())
      errors.moved[s] = error_at(there->second);
  return errors;
}

/// Which structure of the set one really is, if its chain is right. None where the set does not have that one.
std::optional<std::size_t> really_of(const SetOfTemplates& set, const std::vector<LevelChain>& chains, std::size_t k) {
  for (const LevelChain& chain : chains) {
    const auto one = chain.apart.find(k);
    if (one == chain.apart.end() || one->second == 0) continue;
    const auto there = chain.by_level.find(*level_of_name(set.set.structures[k].name) + one->second);
    return there == chain.by_level.end() ? std::nullopt : std::optional(there->second);
  }
  return k;
}

}  // namespace

double LevelChain::share(int by) const {
  const auto count = std::ranges::count_if(apart, [&](const auto& one) { return one.second == by; });
  return apart.empty() ? 0 : static_cast<double>(count) / static_cast<double>(apart.size());
}

int LevelChain::errors(int by) const {
  int sum = 0, before = 0;
  for (const std::size_t k : from_above) {
    const int off = apart.at(k) + by;
    if (off != before) sum += std::abs(off);
    before = off;
  }
  return sum;
}

int errors_at_ends(const SetInMap& subject, const FittedSet& fitted, const LevelChain& chain, int by) {
  constexpr int last_of_loin = 23;
  constexpr double steps_of_one = 1.5;  // from the middle of the last one to the end of one below it
  const auto& links = chain.from_above;
  if (links.size() < 2) return 0;
  const auto level_of = [&](std::size_t k) {
    const auto is_it = [&](const auto& one) { return one.second == k; };
    return std::ranges::find_if(chain.by_level, is_it)->first + chain.apart.at(k) + by;
  };
  const auto in_map = [&](std::size_t k) { return middle_of(fitted.structures[k].fit->mesh.points); };
  if (level_of(links.front()) < 0) return 1;
  const std::size_t above = links[links.size() - 2];
  const Vec3 last = in_map(links.back());
  const Vec3 step = (last - in_map(above)) / std::max(1, level_of(links.back()) - level_of(above));
  int lowest = level_of(links.back());
  bool has_room = true;
  for (const LabelOfMap& other : subject.others) {
    if ((other.box_mm.center() - last).dot(step) <= 0 || !other.box_mm.contains(last + step)) continue;
    has_room = false;
    if (level_in_name(other.segment.name)) ++lowest;
  }
  const Vec3 below = subject.grid.to_voxel(last + steps_of_one * step);
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    has_room = has_room && below[axis] >= 0 && below[axis] <= subject.grid.dims[a] - 1;
  }
  return lowest > last_of_loin || (lowest < last_of_loin && has_room) ? 1 : 0;
}

std::vector<LevelChain> level_chains(const SetOfTemplates& set, const FittedSet& fitted,
                                     const std::vector<char>& placed) {
  std::map<std::string, LevelChain> families;
  for (std::size_t k = 0; k < set.templates.size(); ++k) {
    const auto name = level_in_name(set.set.structures[k].name);
    // A sacrum is known by its form.
    if (!name || name->sacral || set.templates[k] == nullptr) continue;
    families[name->family].by_level.emplace(name->level, k);
  }
  std::vector<LevelChain> chains;
  const double scale = usual_scale(fitted, placed);
  for (auto& [family, chain] : families) {
    const auto links = links_of(chain, set, fitted, placed);
    for (const Link& link : links) {
      chain.apart[link.k] = 0;
      chain.from_above.push_back(link.k);
    }
    find_contradictions(chain, links, scale);
    chains.push_back(std::move(chain));
  }
  return chains;
}

LevelEvidence level_evidence_of_others(const SetOfTemplates& set, const FittedSet& fitted,
                                       const std::vector<char>& placed, const std::vector<LevelChain>& chains,
                                       std::size_t of) {
  const LevelChain& chain = chains[of];
  if (chain.apart.empty()) return {};
  const auto in_map = [&](std::size_t k) { return middle_of(fitted.structures[k].fit->mesh.points); };
  std::vector<std::size_t> all;
  for (std::size_t k = 0; k < placed.size(); ++k)
    if (placed[k] != 0) all.push_back(k);
  const Similarity body = similarity_of_fits(set, fitted.structures, all);
  std::array<double, level_shifts.size()> sums{};
  std::array<std::size_t, level_shifts.size()> counts{};
  for (std::size_t other = 0; other < placed.size(); ++other) {
    if (placed[other] == 0 || chain.apart.contains(other)) continue;
    const auto really = really_of(set, chains, other);
    if (!really) continue;
    // It speaks of the one that lies nearest.
    std::optional<LevelErrors> nearest;
    double nearest_mm = std::numeric_limits<double>::infinity();
    for (const auto& [k, apart] : chain.apart) {
      const Vec3 offset = in_map(k) - in_map(other);
      if (offset.norm() >= nearest_mm) continue;
      const auto errors = level_errors(set, chain, *level_of_name(set.set.structures[k].name) + apart,
                                       middle_of(set.templates[*really]->points), offset, body);
      if (!errors) continue;
      nearest = errors;
      nearest_mm = offset.norm();
    }
    if (!nearest) continue;
    for (std::size_t s = 0; s < level_shifts.size(); ++s) {
      const auto moved = nearest->moved[s];
      if (!moved) continue;
      sums[s] += (nearest->own * nearest->own - *moved * *moved) / 2;
      ++counts[s];
    }
  }
  LevelEvidence evidence;
  for (std::size_t s = 0; s < level_shifts.size(); ++s)  // errors of one side go together
    if (counts[s] > 0) evidence[s] = sums[s] / std::sqrt(static_cast<double>(counts[s]));
  return evidence;
}

}  // namespace homolog
