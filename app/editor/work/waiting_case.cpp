#include "app/editor/work/waiting_case.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "core/base/text/listed.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/volume/labels/read_labels.h"
#include "core/volume/volume_io.h"

namespace homolog {

bool was_worked_on(EditSession& session) {
  const auto steps = session.undo_names(2);
  return steps.size() > 1 || (steps.size() == 1 && steps.front() != action_name(MirrorTemplate{}));
}

Result<CaseLabels> read_case_labels(const StudyCase& one, const FitSettings& settings, Progress& progress) {
  VolumeReadOptions options;
  options.progress = &progress;
  auto read = read_volume(one.labels, options);
  if (!read) return fail(read.error());
  int wanted = settings.all_labels ? 0 : settings.label;
  bool all = settings.all_labels;
  std::string asked = wanted == 0 ? "" : std::to_string(wanted);
  if (const auto& own = one.label; !own.is_null()) {
    asked = own.is_string() ? own.get<std::string>() : std::to_string(static_cast<int>(own.get<double>()));
    all = false;  // as the study was made with
  }
  const auto chosen = choose_segments(one.labels, asked, *read);
  if (!chosen) return fail(chosen.error());
  wanted = chosen->empty() ? 0 : unite_segments(read->volume, *chosen, 0);
  CaseLabels labels;
  warn_of_soft_labels(one.labels.filename(), read->volume, 0, labels.warnings);
  labels.map = {std::make_shared<const Volume>(std::move(read->volume)), one.labels.filename().string(),
                read->segmentation};
  for (const auto& [value, voxels] : labels_of(*labels.map.volume, 0))
    if (value != 0) labels.held.push_back(value);
  const auto& held = labels.held;
  for (const int value : held) {
    const Segment* known = read->segmentation.find(value);
    labels.segments.push_back(known != nullptr ? *known : Segment{{}, value});
  }
  if (held.empty())
    return fail(labels.map.name, "holds no label; segment the organ in it, or take the case off the study");
  if (held.size() == 1 || all) {
    labels.label = held.size() == 1 ? held.front() : every_label;
    return labels;
  }
  if (wanted != 0 && std::find(held.begin(), held.end(), wanted) == held.end()) {
    std::vector<std::string> names;
    for (const int value : held) names.push_back(std::to_string(value));
    return fail(labels.map.name, "holds the labels " + listed(names, " and ") + ", but no label " +
                                     std::to_string(wanted) + "; fit this case by itself, with another label");
  }
  labels.label = wanted;
  return labels;
}

}  // namespace homolog
