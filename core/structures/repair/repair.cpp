#include "core/structures/repair/repair.h"
#include "core/structures/fitting/neighbours_say.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/structures/fitting/structure_confidence.h"
#include "core/structures/naming/right_names.h"
#include "core/structures/repair/mend_structures.h"

namespace homolog {

namespace {

/// Errors: somebody cancelled the work.
Result<void> go_on(const MapRepairOptions& options) {
  if (options.progress != nullptr && options.progress->cancelled()) return fail("", "the repair was cancelled");
  return {};
}

/// A map as it is, against its fits and what neighbours expect.
Result<RepairedMap> look_at(const SetOfTemplates& set, const VolumeRead& map, int frame,
                            const MapRepairOptions& options) {
  RepairedMap result;
  result.subject = find_in_map(set.set, map, frame);
  auto fitted = fit_set(set, result.subject, {0, options.progress, options.tell});
  if (!fitted) return fail(fitted.error());
  result.fitted = std::move(*fitted);
  result.variants = find_variants(set, result.subject, result.fitted);
  result.expected = expected_shapes(set, result.subject, result.fitted, options.progress);
  result.signs = structure_signs(set, map, frame, result.subject, result.fitted, result.expected, options.progress);
  if (auto goes = go_on(options); !goes) return fail(goes.error());
  result.structures.resize(set.templates.size());
  for (std::size_t k = 0; k < result.structures.size(); ++k) {
    result.structures[k].proposed_name = set.set.structures[k].name;
    result.structures[k].structure = k;
  }
  return result;
}

/// The place of a name's structure in the set; none: it has no such.
std::optional<std::size_t> place_of(const SetOfTemplates& set, const std::string& name) {
  const TemplateOfSet* one = set.set.find(name);
  if (one == nullptr) return std::nullopt;
  return static_cast<std::size_t>(one - set.set.structures.data());
}

/// Repairs a map of which labels have been renamed, and puts what is found under the names that they had.
Result<void> repair_renamed(const SetOfTemplates& set, VolumeRead& map, int frame, const MapRepairOptions& options,
                            const std::vector<NameFound>& names, RepairedMap& result) {
  auto renamed = look_at(set, map, frame, options);
  if (!renamed) return fail(renamed.error());
  std::vector<std::optional<std::size_t>> came_from(names.size());
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto place = place_of(set, names[k].proposed);
    if (!place || !result.subject.structures[k].is_there()) continue;
    if (came_from[*place]) {  // both are parts of one
      result.fitted.structures[k] = {};
      result.fitted.structures[k].why_not = "its label is a part of " + names[k].proposed;
      renamed->structures[*place].defects.push_back({DefectKind::given_to_neighbour, set.set.structures[k].name});
      continue;
    }
    came_from[*place] = k;
    renamed->structures[*place].p_named = *place == k ? names[k].p_named : 1 - names[k].p_named;
  }
  mend_structures(set, map, frame, options, *renamed);
  result.variants = renamed->variants;
  for (std::size_t place = 0; place < names.size(); ++place) {
    const bool is_free = !result.subject.structures[place].is_there();
    if (!came_from[place] && !is_free) continue;
    const std::size_t k = came_from[place].value_or(place);
    result.structures[k] = renamed->structures[place];
    result.fitted.structures[k] = renamed->fitted.structures[place];
    result.signs[k] = renamed->signs[place];
    result.expected[k] = renamed->expected[place];
  }
  return {};
}

}  // namespace

Result<RepairedMap> repair_map(const SetOfTemplates& set, VolumeRead& map, int frame, const MapRepairOptions& options) {
  constexpr double first_share = 0.5;
  Progress unseen;
  Progress& whole = options.progress != nullptr ? *options.progress : unseen;
  Progress first(whole, first_share), second(whole, 1 - first_share);
  MapRepairOptions looking = options;
  looking.progress = &first;
  auto result = look_at(set, map, frame, looking);
  if (!result) return fail(result.error());
  const auto names = find_names(set, result->subject, result->fitted, result->signs, options.progress);
  if (auto goes = go_on(options); !goes) return fail(goes.error());
  std::vector<std::size_t> changed(names.size());
  if (any_renamed(set, names)) {
    auto renamed = rename_labels(set, result->subject, names, map, frame);
    changed = std::move(renamed.voxels);
    result->renamed_without = std::move(renamed.without);
    MapRepairOptions again = options;
    again.progress = &second;
    if (auto repaired = repair_renamed(set, map, frame, again, names, *result); !repaired)
      return fail(repaired.error());
  } else {
    for (std::size_t k = 0; k < names.size(); ++k) result->structures[k].p_named = names[k].p_named;
    mend_structures(set, map, frame, options, *result);
  }
  if (auto goes = go_on(options); !goes) return fail(goes.error());
  for (std::size_t k = 0; k < names.size(); ++k) {
    RepairedStructure& one = result->structures[k];
    one.p_named = names[k].p_named;
    one.proposed_name = names[k].proposed;
    one.changed_voxels += changed[k];
    one.defects.insert(one.defects.begin(), names[k].defects.begin(), names[k].defects.end());
    one.confidence = structure_confidence(result->fitted.structures[k], result->signs[k], one);
    // The form is that of all parts by now; as the map has it, it was one of them.
    constexpr double hardly = 0.05;
    for (std::size_t other = 0; other < names.size(); ++other)
      if (other != k && names[other].proposed == names[k].proposed && result->subject.structures[other].is_there() &&
          result->subject.structures[k].is_there())
        one.confidence = std::min(one.confidence, hardly);
  }
  return result;
}

}  // namespace homolog
