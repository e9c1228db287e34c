#include "app/editor/update/commands/contour_commands.h"

#include <algorithm>

#include "app/editor/update/commands/spelling.h"
#include "app/editor/update/editing.h"

namespace homolog {

void AddContours::spell(Fields& line) {
  line.member("number", number);
}
void AddContours::run(Editing& editing) const {
  const auto read = editing.state.automatic.offered.read;
  if (!read || editing.structure() == nullptr) return;
  for (const ContourRoi& roi : read->rois)
    if (roi.number == number) add_contours(editing, roi, *editing.structure(), false);
}

void ShowContours::spell(Fields& line) {
  line.member("ids", ids);
  line.member("shown", shown);
}
void ShowContours::run(EditorState& state) const {
  for (const std::string& id : ids)
    if (shown)
      state.look.hidden_contours.erase(id);
    else
      state.look.hidden_contours.insert(id);
}

void FitContours::spell(Fields& line) {
  line.member("joined", joined);
}
void FitContours::run(Editing& editing) const {
  if (editing.refuses_edits()) return;
  if (!editing.shape()) return;
  stop_playing(editing);
  const EditorState& state = editing.state;
  ContourFitJob job{.between = state.automatic.between_contours,
                    .labels = editing.shown.labels_here(),
                    .known = segmentation_of(editing.shown.labels()),
                    .fit = state.automatic.fit_settings,
                    .snap = state.automatic.snap,
                    .goes_on = joined};
  if (job.labels && !job.fit.all_labels)
    job.fit.label = label_in_hand(job.fit, editing.shown.labels().values, *job.labels, editing.shape());
  // While one draws, the shape alone answers at once.
  if (joined || (job.between == BetweenCurves::label && !job.labels)) job.between = BetweenCurves::shape;
  editing.work.contour_fits.start(editing.shown.session(), job, joined, state.look.structure);
  if (!joined) let_shared_follow(editing.shown.document(), state.look.structure, editing.out);
}

void CancelContourFit::run(Editing& editing) const {
  if (!editing.work.contour_fits.busy()) return;
  editing.work.contour_fits.cancel();
  editing.log.is_done(*this);
}

}  // namespace homolog
