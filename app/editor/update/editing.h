#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "app/editor/state/figures/quality.h"
#include "app/editor/update/command_log.h"
#include "app/editor/update/commands.h"
#include "app/editor/update/controls.h"
#include "app/editor/update/models.h"
#include "app/editor/update/shown_case.h"
#include "app/editor/work/contours/contour_fits.h"
#include "app/editor/work/exports.h"
#include "app/editor/work/fitter.h"
#include "app/editor/work/label_surfaces.h"
#include "app/editor/work/models/model_help.h"
#include "app/editor/work/models/study_appearance.h"
#include "app/editor/work/models/study_optimiser.h"
#include "app/editor/work/opening/opener.h"
#include "app/editor/work/opening/recovery.h"
#include "app/editor/work/propagator.h"
#include "app/editor/work/set_fitter.h"
#include "app/editor/work/shape_monitor.h"
#include "app/editor/work/snaps.h"
#include "app/editor/work/template_maker.h"
#include "app/editor/work/worklist.h"
#include "app/editor_options.h"
#include "core/base/pictures/picture_io.h"

namespace homolog {

struct Editing;

/// How cases that were never saved are offered: at a start without files, with some, and when somebody asks.
enum class RecoveryOffer { dialog, notice, asked };

/// All that goes on beside the window, and what is remembered of it until it is done. Belongs to the window's thread.
struct Work {
  /// `wake` may be called from any thread when there is something new.
  explicit Work(const std::function<void()>& wake);
  bool busy() const;

  /// The work to do here when a file was read.
  using Then = std::function<void(Editing&)>;

  Opener opener;
  Exports exports;
  Worker<Then> imports;
  Worker<ObserverComparison> observers;
  Fitter fitter;
  SetFitter set_fitter;
  Propagator propagator;
  Snaps snaps;
  ContourFits contour_fits;
  TemplateMaker template_maker;
  LabelSurfaces label_surfaces;
  StudyAppearance study_appearance;
  StudyOptimiser study_optimiser;
  ModelHelp model_help;
  Models models;
  Worklist worklist;
  std::uint64_t study_of_worklist = 0;  ///< StudyKept::number when scans or fits were asked for
  ShapeMonitor<QualityFigures> quality;
  ShapeMonitor<ShapeMeasurements> measurements;
  ShapeMonitor<ScoredShape> scores;
  Worker<ShapeModel> score_model;  ///< makes the model of a study's other cases
  Recovery recovery;
  WriteReport write_report;  ///< empty: this program cannot

  RecoveryOffer recovery_offer = RecoveryOffer::dialog;
  std::shared_ptr<const Recipe> measured_by;          ///< the recipe of `measurements`; null: none
  std::shared_ptr<const ShapeModel> scored_by;        ///< the model of `scores`; null: none
  bool scored_flipped = false;                        ///< it takes the shape left for right
  bool fit_seen = false;                              ///< a step of the fit that goes on was shown
  std::optional<StartFit> started_fit;                ///< the fit that goes on; none while it is a refinement
  std::optional<double> looks_due;                    ///< when they are written, by the window's clock
  bool set_enters = false;                            ///< the structures of a set that was fitted come into the case
  std::optional<BlendModel> blend_wanted;             ///< the blend to do as soon as the model's part is computed
  std::shared_ptr<const TemplateMaking> seen_making;  ///< the template maker's making when it was looked at last
};

/// Who can draw what a file is to show.
class PictureSource {
 public:
  virtual ~PictureSource() = default;
  /// The window or one view in another size.
  virtual Result<Picture> picture(const PictureOptions& options) = 0;
  /// The plots of the model's measures, 3 side by side.
  virtual Result<Picture> plots(const PictureOptions& options) = 0;
  /// Lets go of what was uploaded for the case before.
  virtual void forget() = 0;
};

/// The things that a command acts on: the whole editor but its window.
struct Editing {
  EditorState& state;
  const Layout& layout;
  ShownCase& shown;
  Work& work;
  PictureSource& pictures;
  Outbox& out;  ///< takes further commands
  CommandLog& log;

  ControlsContext controls() const {
    return {.layout = layout,
            .document = shown.document(),
            .mesh = shown.mesh(),
            .can_undo = shown.snapshot().can_undo,
            .can_redo = shown.snapshot().can_redo,
            .file = shown.snapshot().file,
            .fits = work.fitter.busy() || work.propagator.busy() || work.set_fitter.busy() || work.contour_fits.busy(),
            .structure = state.look.structure};
  }
  /// Does an edit of the case, or of the structure that is worked on. `joined`: see EditStep.
  void apply(Action action, bool joined = false) const;
  /// Whether the structure that is worked on is locked; says so then.
  bool refuses_edits() const;
  /// The structure that is worked on, as it is shown; null: the case has none.
  const Structure* structure() const { return active_structure(state, shown.document()); }
  /// Its mesh at the shown frame.
  std::optional<ShapeView> shape() const { return active_shape(state, shown.document()); }
};

/// Does one command. Errors end in a notice.
void run(const Command& command, Editing& editing);

/// Stops a cine, and commits the frame that is shown.
void stop_playing(Editing& editing);

/// Says so where the case has no template.
bool lacks_template(Editing& editing);

}  // namespace homolog
