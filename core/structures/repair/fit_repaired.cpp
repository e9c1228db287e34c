#include "core/structures/repair/fit_repaired.h"

#include <algorithm>
#include <utility>

namespace homolog {

Result<RepairedFit> fit_repaired(const SetOfTemplates& set, VolumeRead& map, int frame, const MapRepairOptions& options,
                                 double gap_mm) {
  constexpr double repair_share = 0.7;
  Progress unseen;
  Progress& whole = options.progress != nullptr ? *options.progress : unseen;
  Progress repairing(whole, repair_share), fitting(whole, 1 - repair_share);
  MapRepairOptions of_repair = options;
  of_repair.progress = &repairing;
  auto repaired = repair_map(set, map, frame, of_repair);
  if (!repaired) return fail(repaired.error());
  RepairedFit result;
  result.subject = find_in_map(set.set, map, frame);
  const bool is_changed =
      std::ranges::any_of(repaired->structures, [](const RepairedStructure& one) { return one.changed_voxels > 0; });
  if (is_changed || gap_mm > 0) {
    auto fitted = fit_set(set, result.subject, {gap_mm, &fitting, options.tell});
    if (!fitted) return fail(fitted.error());
    result.fitted = std::move(*fitted);
  } else {
    result.fitted = repaired->fitted;
  }
  result.found.resize(set.templates.size());
  result.as_read.resize(set.templates.size());
  for (std::size_t k = 0; k < repaired->structures.size(); ++k) {
    const RepairedStructure& one = repaired->structures[k];
    const auto& fit = repaired->fitted.structures[k].fit;
    // A structure that is missing keeps its own place in the set, also where another one gave up its name.
    if (!fit && !result.found[one.structure].empty()) continue;
    if (fit) result.as_read[one.structure] = fit->mesh.points;
    result.found[one.structure] = one.defects.empty() ? std::string() : sentence_of_defects(one.defects);
    result.fitted.structures[one.structure].confidence = one.confidence;
    result.fitted.structures[one.structure].p_named = one.p_named;
  }
  return result;
}

}  // namespace homolog
