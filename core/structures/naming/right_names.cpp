#include "core/structures/naming/right_names.h"
#include "core/structures/fitting/neighbours_say.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "core/base/numbers/statistics.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/mesh_quality.h"
#include "core/structures/fitting/structure_confidence.h"
#include "core/structures/naming/level_names.h"
#include "core/structures/naming/name_levels.h"

namespace homolog {

namespace {

void find_exchanged_sides(const SetOfTemplates& set, const FittedSet& fitted, std::vector<NameFound>& names) {
  constexpr double hardly = 0.05;
  const auto x_of = [](const Points& points) { return points.col(0).mean(); };
  for (std::size_t left = 0; left < names.size(); ++left) {
    const TemplateOfSet& one = set.set.structures[left];
    if (one.side != Side::left || !fitted.structures[left].fit) continue;
    for (std::size_t right = 0; right < names.size(); ++right) {
      if (set.set.structures[right].name != one.partner || !fitted.structures[right].fit) continue;
      // x grows to the patient's left, in the set as in the map.
      const double in_set = x_of(set.templates[left]->points) - x_of(set.templates[right]->points);
      const double in_map =
          x_of(fitted.structures[left].fit->mesh.points) - x_of(fitted.structures[right].fit->mesh.points);
      if (in_set * in_map >= 0) continue;
      const auto exchange = [&](std::size_t k, std::size_t other) {
        const std::string& name = set.set.structures[other].name;
        names[k] = {name, hardly, {{DefectKind::sides_exchanged, name}}};
      };
      exchange(left, right);
      exchange(right, left);
    }
  }
}

/// The volume of each fit by that of its template, as a share of what is usual in the map; 1 where there is no fit.
std::vector<double> sizes_of(const SetOfTemplates& set, const FittedSet& fitted) {
  std::vector<double> sizes(set.templates.size(), 1), all;
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    const auto& fit = fitted.structures[k].fit;
    if (!fit) continue;
    const Mesh own{set.templates[k]->topology, set.templates[k]->points};
    sizes[k] = std::abs(enclosed_volume_ml(fit->mesh) / enclosed_volume_ml(own));
    all.push_back(sizes[k]);
  }
  const double usual = all.empty() ? 1 : median_of(all);
  for (std::size_t k = 0; k < sizes.size(); ++k)
    if (fitted.structures[k].fit) sizes[k] /= usual;
  return sizes;
}

void find_shifted_levels(const SetOfTemplates& set, const SetInMap& subject, const FittedSet& fitted,
                         const std::vector<StructureSigns>& signs, const std::vector<double>& sizes,
                         const Progress* progress, std::vector<NameFound>& names) {
  constexpr double much_smaller = 0.2, a_part = 0.7, cut = 0.002, touched = 0.03, much_else = 0.1, hardly_dice = 0.9,
                   part_lost = 0.06, body_lost = 0.4;
  std::vector<char> placed(names.size()), sound(names.size());
  for (std::size_t k = 0; k < names.size(); ++k) {
    const FittedStructure& one = fitted.structures[k];
    const StructureSigns& own = signs[k];
    // A neighbour that has more than a part of it has its name.
    const auto has_part = [](const auto& lost) { return lost.second >= part_lost && lost.second < body_lost; };
    const bool is_whole = own.at_border <= touched && own.bridges < much_else && own.holes < much_else &&
                          own.islands < much_else && one.judgement.inside_scan.dice >= hardly_dice &&
                          std::ranges::none_of(own.lost_to, has_part);
    // The middle of a part is not that of the whole. Where it lies is known of one that has another level's form, too.
    const bool is_placed = one.fit && (!one.judgement.doubtful || one.fit->template_cuts.empty());
    placed[k] = is_placed && is_whole && sizes[k] > a_part ? 1 : 0;
    sound[k] = placed[k] != 0 && own.at_border <= cut && !one.judgement.doubtful && std::abs(own.volume) < much_smaller
                   ? 1
                   : 0;
  }
  const auto levels = find_levels(set, subject, fitted, placed, sound, progress);
  for (std::size_t k = 0; k < levels.size(); ++k) {
    names[k].p_named = std::min(names[k].p_named, levels[k].p_named);
    if (levels[k].maybe != 0) {
      const std::string maybe = name_at_level(names[k].proposed, *level_of_name(names[k].proposed) + levels[k].maybe);
      // Beyond the set's last level there may be no such structure.
      names[k].defects.push_back({DefectKind::level_shifted, set.set.find(maybe) != nullptr ? maybe : std::string()});
    }
    if (levels[k].shift == 0) continue;
    // The proposed name is of the other side, where the sides are exchanged too.
    names[k].proposed = name_at_level(names[k].proposed, *level_of_name(names[k].proposed) + levels[k].shift);
    names[k].defects.push_back({DefectKind::level_shifted, names[k].proposed});
  }
}

/// The value of the label with a name, a new one where the map has no such label. None: the map gives no names.
std::optional<int> value_of_name(const SetOfTemplates& set, const SetInMap& subject, const std::string& name,
                                 VolumeRead& map, int frame) {
  for (std::size_t k = 0; k < subject.structures.size(); ++k)
    if (set.set.structures[k].name == name) return subject.structures[k].segment.value;
  if (map.segmentation.segments.empty()) return std::nullopt;
  for (const Segment& segment : map.segmentation.segments)
    if (segment.name == name || is_same_vertebra(segment.name, name)) return segment.value;
  const Segment segment{name, free_value(map, frame, subject), 0, colour_by_name(name), {}};
  map.segmentation.add(segment);
  return segment.value;
}

/// The new name of a label that the set lacks: it is as many levels off as the nearest structure of its kind. Empty: it
/// keeps its own.
std::string name_of_other(const SetOfTemplates& set, const SetInMap& subject, const std::vector<NameFound>& names,
                          const std::string& name) {
  const auto own = level_in_name(name);
  if (!own || own->sacral) return {};
  int nearest = std::numeric_limits<int>::max(), by = 0;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto level = level_in_name(set.set.structures[k].name);
    if (!subject.structures[k].is_there() || !level || level->sacral || level->family != own->family) continue;
    const int away = std::abs(level->level - own->level);
    if (away >= nearest) continue;
    nearest = away;
    by = level_of_name(names[k].proposed).value_or(level->level) - level->level;
  }
  if (by == 0) return {};
  std::string moved = name_at_level(name, own->level + by);
  // T13 and L1 share their number: no two labels may come to one name.
  for (std::size_t k = 0; k < names.size(); ++k)
    if (subject.structures[k].is_there() && names[k].proposed == moved) return {};
  return set.set.find(moved) != nullptr ? moved : std::string();
}

}  // namespace

std::vector<NameFound> find_names(const SetOfTemplates& set, const SetInMap& subject, const FittedSet& fitted,
                                  const std::vector<StructureSigns>& signs, const Progress* progress) {
  std::vector<NameFound> names(set.templates.size());
  for (std::size_t k = 0; k < names.size(); ++k) {
    names[k].proposed = set.set.structures[k].name;
    // The values of a built-in set are nobody else's.
    constexpr double by_chance = 0.5;
    if (subject.structures[k].by_value && is_built_in(set.set.structures[k].file.string()))
      names[k].p_named = by_chance;
  }
  find_exchanged_sides(set, fitted, names);
  const std::vector<double> sizes = sizes_of(set, fitted);
  find_shifted_levels(set, subject, fitted, signs, sizes, progress, names);
  settle_clashes(set, subject, names, sizes);
  return names;
}

void doubt_names(const SetOfTemplates& set, const VolumeRead& map, int frame, const SetInMap& subject,
                 FittedSet& fitted) {
  constexpr double likely = 0.5;
  const auto expected = expected_shapes(set, subject, fitted);
  const auto names = find_names(set, subject, fitted, structure_signs(set, map, frame, subject, fitted, expected));
  for (std::size_t k = 0; k < names.size(); ++k) {
    FittedStructure& one = fitted.structures[k];
    if (!one.fit) continue;
    one.p_named = names[k].p_named;
    one.confidence = std::min(one.confidence, structure_confidence(one));
    if (one.p_named >= likely) continue;
    const bool is_known = names[k].proposed != set.set.structures[k].name;
    one.judgement.doubtful = true;
    one.judgement.warnings.push_back(
        "its name is likely wrong" +
        (is_known ? ": it lies where " + names[k].proposed + " belongs; run repair, which renames labels"
                  : "; compare it with its neighbours and rename its label"));
  }
}

void settle_clashes(const SetOfTemplates& set, const SetInMap& subject, std::vector<NameFound>& names,
                    const std::vector<double>& sizes) {
  constexpr double a_part = 0.8, least = 0.6, most = 1.5;
  const auto are_parts_of_one = [&](std::size_t a, std::size_t b) {
    if (sizes.empty() || !level_of_name(set.set.structures[a].name)) return false;
    const double both = sizes[a] + sizes[b];
    return sizes[a] < a_part && sizes[b] < a_part && both > least && both < most;
  };
  for (bool again = true; again;) {
    again = false;
    for (std::size_t k = 0; k < names.size(); ++k) {
      const std::string& own = set.set.structures[k].name;
      if (names[k].proposed == own || !subject.structures[k].is_there()) continue;
      for (std::size_t other = 0; other < names.size(); ++other) {
        if (other == k || !subject.structures[other].is_there() || names[other].proposed != names[k].proposed) continue;
        if (are_parts_of_one(k, other)) continue;
        constexpr double nobody_knows = 0.5;
        names[k] = {own, nobody_knows, {}};
        again = true;
        break;
      }
    }
  }
}

bool any_renamed(const SetOfTemplates& set, const std::vector<NameFound>& names) {
  for (std::size_t k = 0; k < names.size(); ++k)
    if (names[k].proposed != set.set.structures[k].name) return true;
  return false;
}

RenamedLabels rename_labels(const SetOfTemplates& set, const SetInMap& subject, const std::vector<NameFound>& names,
                            VolumeRead& map, int frame) {
  RenamedLabels renamed{std::vector<std::size_t>(names.size()), {}};
  struct To {
    int value = 0;
    std::optional<std::size_t> k;  ///< none: the set lacks it
  };
  std::map<std::size_t, std::map<int, To>> layers;  // all are known before one is changed: two may exchange their names
  for (std::size_t k = 0; k < names.size(); ++k) {
    const StructureInMap& one = subject.structures[k];
    if (names[k].proposed == set.set.structures[k].name || !one.is_there()) continue;
    if (const auto value = value_of_name(set, subject, names[k].proposed, map, frame))
      layers[one.segment.layer][one.segment.value] = {*value, k};
  }
  for (const LabelOfMap& other : subject.others) {
    const std::string name = name_of_other(set, subject, names, other.segment.name);
    if (name.empty()) continue;
    const auto is_taken = [&, &now = name](const auto& one) { return one.second == now; };
    if (std::ranges::any_of(renamed.without, is_taken)) continue;
    const auto value = value_of_name(set, subject, name, map, frame);
    if (!value) continue;
    layers[other.segment.layer][other.segment.value] = {*value, {}};
    renamed.without.emplace_back(other.segment.name, name);
  }
  for (const auto& [layer, values] : layers) {
    Volume& volume = map.layer(layer);
    const std::size_t voxels = volume.geometry.voxels();
    const std::size_t first = map.other_layers.empty() ? voxels * static_cast<std::size_t>(frame) : 0;
    std::visit(
        [&, &to = values](auto& data) {
          using Voxel = typename std::decay_t<decltype(data)>::value_type;
          for (std::size_t v = first; v < first + voxels; ++v) {
            const auto found = to.find(rounded_label(data[v]));
            if (found == to.end()) continue;
            data[v] = static_cast<Voxel>(found->second.value);
            if (found->second.k) ++renamed.voxels[*found->second.k];
          }
        },
        volume.data);
    for (const auto& [value, to] : values) volume.range_max = std::max(volume.range_max, static_cast<double>(to.value));
  }
  return renamed;
}

}  // namespace homolog
