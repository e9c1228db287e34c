#include "core/structures/repair/mend_structures.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/processes/parallel.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/voxels/voxelise.h"
#include "core/structures/fitting/neighbours_say.h"
#include "core/structures/naming/level_names.h"
#include "core/structures/repair/mending.h"
#include "core/structures/repair/second_body.h"

namespace homolog {

namespace {

// Limits for the signs of a structure [StructureSigns]: shares of its voxels, unless something else is
// said. Sound structures stay below those from which something counts [docs/measurements/repair.md].

constexpr double some_islands = 0.0005;   ///< `islands`: from here on it has some
constexpr double many_specks = 5;         ///< `specks`: from here on they are islands, however small
constexpr double large_island = 0.1;      ///< `islands`: from here on nobody knows which part is the right one
constexpr double some_holes = 0.003;      ///< `holes`: from here on it has some; more where the fit is worse
constexpr double no_hole = 0.1;           ///< `holes`: from here on it is something else
constexpr double some_tunnels = 0.0085;   ///< `tunnels`: from here on it has holes
constexpr double some_bridges = 0.0025;   ///< `bridges`: from here on it has some; more where the fit is worse
constexpr double no_bridge = 0.15;        ///< `bridges`: from here on it is something else
constexpr double bridges_more = 0.004;    ///< `bridges`: from here on, it may have something of a neighbour
constexpr double some_bars = 0.004;       ///< `bars`: from here on it has bridges
constexpr double long_bar = 0.22;         ///< `bar_reach`: from here on it has one, however thin; sound ones reach 0.13
constexpr double much_lost = 0.04;        ///< `lost_to`: from here on the neighbour has what it lost, if it shows it
constexpr double surely_lost = 0.1;       ///< `lost_to`: from here on it has; sound ones reach 0.051
constexpr double much_lacking = 0.15;     ///< `lacking`: from here on a part is missing, if it is much_smaller too
constexpr double some_lacking = 0.05;     ///< `lacking`: from here on a part is missing, if it reaches far
constexpr double lacking_bent = 0.2;      ///< of what is `lacking`: if less lacks of the bent template, no part does
constexpr double far_gap = 0.45;          ///< `gap`: from here on it does, as a spinous process; sound ones reach 0.31
constexpr double surely_lacking = 0.2;    ///< `lacking`: from here on a part is missing
constexpr double much_smaller = 0.2;      ///< `volume`: from here on below 0
constexpr double somewhat_smaller = 0.1;  ///< `volume`: from here on below 0, neighbours may have some of it
constexpr double far_smaller = 0.3;       ///< `volume`: from here on below 0, a part is missing however it is bent
constexpr double much_beyond = 0.05;      ///< `beyond`: above, the end of the map says why it lacks something
constexpr double mostly_beyond = 0.5;     ///< `beyond`: above, it is not said to have lost something to a neighbour
constexpr double some_at_border = 0.002;  ///< `at_border`: above, the scan cuts it
constexpr double usual_dice = 0.98;       ///< Dice of a fit with the map: it is worse by what it is below
constexpr double hardly_dice = 0.85;      ///< Dice of a fit with the map: below, something is wrong

}  // namespace

void Mending::find() {
  for (std::size_t k = 0; k < result_.structures.size(); ++k) {
    if (set_.templates[k] == nullptr) continue;
    if (!result_.subject.structures[k].is_there()) find_missing(k);
  }
  find_shapes();
  for (std::size_t k = 0; k < result_.structures.size(); ++k) find_lost(k);
  for (std::size_t k = 0; k < result_.structures.size(); ++k)
    if (result_.fitted.structures[k].fit) find_in(k);
  name_new();
}

bool Mending::is_beside_cut(std::size_t k) const {
  const auto& fit = result_.fitted.structures[k].fit;
  return !expected_[k] && fit && !fit->template_cuts.empty();
}

bool Mending::has_too_much(std::size_t k) const {
  constexpr double some_islands_more = 0.03, some_volume_more = 0.1;
  const StructureSigns& signs = result_.signs[k];
  if (is_beside_cut(k)) return false;
  // The fit of a template that is cut off itself is doubtful anyway.
  const bool is_unlike = expected_[k] && result_.fitted.structures[k].judgement.doubtful;
  return signs.bars >= some_bars || signs.bridges >= bridges_more || signs.islands >= some_islands_more ||
         signs.volume >= some_volume_more || is_unlike;
}

void Mending::find_in(std::size_t k) {
  const StructureSigns& signs = result_.signs[k];
  if (signs.at_border > some_at_border) add(k, DefectKind::cut_by_scan);
  // What the scan cuts may well lie in several parts, and of two bodies the smaller one may be the right one.
  const bool may_have_parts = has(k, DefectKind::cut_by_scan) || has(k, DefectKind::doubled);
  const double islands = share_left(k, signs.islands, signs.without_islands);
  if (!may_have_parts &&
      (islands >= some_islands || (islands > 0 && static_cast<double>(signs.specks) >= many_specks))) {
    add(k, DefectKind::island);
    // Of two large parts nobody knows here which is the right one.
    if (signs.islands < large_island) change(k, signs.without_islands);
  }
  if (!expected_[k] && result_.fitted.structures[k].judgement.doubtful) return;  // with what to compare it?
  if (has(k, DefectKind::half_missing) || may_have_parts) return;
  // A fit that does not reach everything leaves more outside, and more within.
  const double misfit = std::max(0.0, usual_dice - result_.fitted.structures[k].judgement.inside_scan.dice);
  const double holes_from = some_holes + misfit / 4, bridges_from = some_bridges + misfit / 2;
  const double holes = share_left(k, signs.holes, signs.without_holes),
               bridges = share_left(k, signs.bridges, signs.without_bridges);
  const bool is_pierced = share_left(k, signs.tunnels, signs.without_holes) >= some_tunnels,
             has_bars = share_left(k, signs.bars, signs.without_bars) >= some_bars ||
                        (signs.bar_reach >= long_bar && share_left(k, 1, signs.without_bars) > 0);
  if ((holes >= holes_from || is_pierced) && holes < no_hole) {
    add(k, DefectKind::hole);
    change(k, signs.without_holes);
  }
  if (((bridges >= bridges_from && !is_beside_cut(k)) || has_bars) && bridges < no_bridge) {
    add(k, DefectKind::bridge);
    // What is thin is no part of the shape; of what is not, a fit may have left out some that is.
    change(k, has_bars ? signs.without_bars : signs.without_bridges);
  }
  const bool is_unlike =
      holes >= no_hole || bridges >= no_bridge || result_.fitted.structures[k].judgement.inside_scan.dice < hardly_dice;
  if (is_unlike && result_.structures[k].defects.empty()) add(k, DefectKind::other);
}

bool Mending::is_compared(std::size_t k) const {
  return result_.fitted.structures[k].fit && expected_[k] && result_.signs[k].beyond <= mostly_beyond;
}

std::vector<std::size_t> Mending::takers_of(std::size_t k) const {
  const StructureSigns& signs = result_.signs[k];
  std::vector<std::size_t> takers;
  if (!is_compared(k)) return takers;
  for (const auto& [other, share] : signs.lost_to)
    // What one of two bodies has too much is not this one's.
    if (!has(other, DefectKind::doubled) &&
        ((share >= surely_lost && expected_[other]) || (share >= much_lost && has_too_much(other))))
      takers.push_back(other);
  return takers;
}

bool Mending::is_asked(std::size_t k) const {
  return is_compared(k) && (result_.signs[k].volume <= -somewhat_smaller || !takers_of(k).empty() || lacks_a_part(k));
}

bool Mending::lacks_a_part(std::size_t k) const {
  const StructureSigns& signs = result_.signs[k];
  if (!is_compared(k) || signs.beyond > much_beyond) return false;
  return signs.lacking >= surely_lacking || (signs.lacking >= much_lacking && signs.volume <= -much_smaller) ||
         (signs.lacking >= some_lacking && signs.gap >= far_gap);
}

void Mending::find_lost(std::size_t k) {
  // Of two bodies nobody knows yet which lacks what.
  if (!is_asked(k) || has(k, DefectKind::doubled)) return;
  auto takers = takers_of(k);
  if (takers.empty()) takers = takers_of_bent(k);
  for (const std::size_t other : takers) {
    add(k, DefectKind::given_to_neighbour, name(other));
    add(other, DefectKind::taken_from_neighbour, name(k));
    take_back(k, other);
  }
  if (!takers.empty() || !lacks_a_part(k)) return;
  // A rib that is bent otherwise, or a vertebra that leans, lies beside its expected shape and lacks nothing. The
  // template bent to what is there tells so, but not of one much too small: half of a smooth organ has the form of a
  // whole one.
  const auto lack = lack_of(k);
  const bool is_far_smaller = result_.signs[k].volume <= -far_smaller;
  if (!lack || (!is_far_smaller && lack->share < lacking_bent * result_.signs[k].lacking)) return;
  add(k, DefectKind::half_missing);
  // Where a far part points, the template of another one does not tell well enough: filled in, it may be worse.
  const bool is_told = options_.image != nullptr || options_.model != nullptr;
  // Of two large parts, nobody knows here how they lie to each other.
  const bool is_broken = result_.signs[k].islands >= large_island;
  if (!is_broken && (result_.signs[k].lacking >= much_lacking || is_told))
    fill(k, lack->there, [&](std::size_t v) { return lack->voxels[v] != 0; });
}

bool Mending::is_segmented(std::size_t k) const {
  const auto own = level_in_name(name(k));
  if (!own || own->sacral) return true;
  const auto is_alike = [&](const std::string& other) {
    const auto level = level_in_name(other);
    return level && level->family == own->family;
  };
  std::size_t in_set = 0;
  for (std::size_t other = 0; other < result_.subject.structures.size(); ++other) {
    if (!is_alike(name(other))) continue;
    if (result_.subject.structures[other].is_there()) return true;
    ++in_set;
  }
  return in_set == 1 || std::ranges::any_of(map_.segmentation.segments, is_alike, &Segment::name);
}

void Mending::find_missing(std::size_t k) {
  constexpr double whole = 0.6, much_of_it = 0.25, some_of_it = 0.05, two_bodies = 0.3, much_larger = 0.3,
                   much_beside = 0.15, much_beyond_itself = 0.5, room = 0.4, sound_dice = 0.93;
  if (!result_.subject.structures[k].why_left_out.empty() || is_absent(result_.variants, k) || !is_segmented(k)) return;
  for (std::size_t other = 0; other < result_.structures.size(); ++other) {
    if (result_.signs[other].islands < two_bodies) continue;
    const auto body = second_body(set_, result_.subject, map_, frame_, k, other);
    if (!body) continue;
    add(k, DefectKind::missing);
    add(other, DefectKind::doubled, name(k));
    give(k, other, *body);
    return;
  }
  if (!expected_[k]) return;
  if (options_.model != nullptr)
    if (auto said = said_by_model(*options_.model, set_, result_.fitted.structures, k))
      result_.expected[k]->points = *said;
  const Neighbourhood there = around_now(k, bounds_of(expected_[k]->points), 1);
  const auto inside = voxelise(*expected_[k], there.grid);
  const double all = 1000 * std::abs(enclosed_volume_ml(*expected_[k])) / there.grid.voxel_volume_mm3();
  std::map<int, double> held;
  double voxels = 0;
  for (std::size_t v = 0; v < inside.size(); ++v)
    if (inside[v] != 0) held[there.labels[v]] += 1 / all, voxels += 1;
  if (voxels < whole * all) return;  // it would lie outside of the scan
  std::size_t doubled = k;
  for (std::size_t other = 0; other < result_.structures.size(); ++other) {
    const int label = label_around(result_.subject, k, other);
    const StructureSigns& signs = result_.signs[other];
    const double enough = signs.islands >= two_bodies ? some_of_it : much_of_it;
    if (!result_.subject.structures[other].is_there() || held[label] < enough) continue;
    // A template lies well on one body, however large that is, and on no two.
    const FitJudgement& fit = result_.fitted.structures[other].judgement;
    const bool is_too_large = fit.doubtful || signs.bridges > much_beside ||
                              (signs.volume > much_larger && fit.inside_scan.dice < sound_dice);
    if (!is_too_large && share_beyond(other, label, there, inside) * voxels < much_beyond_itself * all) continue;
    if (doubled == k || held[label] > held[label_around(result_.subject, k, doubled)]) doubled = other;
  }
  if (doubled != k) {
    add(k, DefectKind::missing);
    add(doubled, DefectKind::doubled, name(k));
    // Its own form tells nothing while it has two bodies.
    if (const auto said = said_by_neighbours(set_, result_.fitted.structures, doubled))
      shapes_[doubled] = Mesh{set_.templates[doubled]->topology, said->apply(set_.templates[doubled]->points)};
    shapes_[k] = expected_[k];
    take_back(k, doubled);
    return;
  }
  // Where others are, there is no room: not everybody has it.
  if (held[0] < room) return;
  add(k, DefectKind::missing);
  // At the end of a spine the names may as well be a level off.
  constexpr double sure = 0.45;
  double p_levels = 1;
  for (const RepairedStructure& one : result_.structures) p_levels = std::min(p_levels, one.p_named);
  const auto level = level_of_name(name(k));
  if (level && p_levels < sure && !(has_level(*level - 1) && has_level(*level + 1))) return;
  shapes_[k] = result_.expected[k] = as_the_image_shows(k, *expected_[k]);
  const Neighbourhood seen = around_now(k, bounds_of(shapes_[k]->points), 1);
  const auto body = voxelise(*shapes_[k], seen.grid);
  fill(k, seen, [&](std::size_t v) { return body[v] != 0; });
}

void mend_structures(const SetOfTemplates& set, VolumeRead& map, int frame, const MapRepairOptions& options,
                     RepairedMap& result) {
  Mending(set, map, frame, options, result).find();
}

}  // namespace homolog
