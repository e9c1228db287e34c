#pragma once

#include <string>
#include <vector>

#include "app/editor/state/settings.h"
#include "app/editor/work/fitter.h"
#include "core/base/processes/progress.h"
#include "core/model/shapes/study.h"
#include "core/session/session.h"
#include "core/volume/labels/segmentation.h"

namespace homolog {

/// Whether somebody has worked on a case: it holds more than the mirroring that it began with.
bool was_worked_on(EditSession& session);

/// The label map of a case that waits, and which of its labels the template belongs to.
struct CaseLabels {
  NamedLabels map;
  int label = 0;                  ///< 0: one of `held` has to be chosen first; every_label: all together
  std::vector<int> held;          ///< the labels that the map holds
  std::vector<Segment> segments;  ///< the map's description of each of them
  std::vector<std::string> warnings;
};

/// The label is the case's own, else that of the settings, else the only one that the map holds. Errors: the map cannot
/// be read, holds no label, or several without the one that is asked for.
Result<CaseLabels> read_case_labels(const StudyCase& one, const FitSettings& settings, Progress& progress);

}  // namespace homolog
