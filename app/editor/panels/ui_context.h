#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/editor/drawing/case_thumbnails.h"
#include "app/editor/update/editing.h"
#include "app/editor/update/results/results.h"
#include "app/editor/update/status.h"
#include "app/editor/widgets/theme.h"

namespace homolog {

struct Legend;

/// Work beside the window that takes longer than a moment, and is shown with a progress bar.
struct RunningWork {
  const char* kind = "";  ///< "opening"
  std::string what;       ///< "Opening ct.nii.gz"
  const char* cancel_tip = "";
  Command cancel;
  double fraction = 0;
  const char* no_cancel = "";  ///< why it cannot be given up; empty where it can
};

/// Everything that the interface is drawn from, at one moment. Drawing changes nothing in it; what the user asks for
/// goes to an Outbox.
struct UiContext {
  const Theme& theme;
  const Layout& layout;
  const EditorState& state;    ///< the things that are looked at and in hand
  const ShownCase& on_screen;  ///< the case
  const Work& work;            ///< the work that runs
  const CaseThumbnails& thumbnails;
  std::vector<RunningWork> running;  ///< the part of it that is shown with a progress bar
  double frames_per_second = 0;

  const Snapshot& snapshot() const { return on_screen.snapshot(); }
  /// The document that is shown: the preview, at the frame that plays.
  const Document& document() const { return on_screen.document(); }
  /// As on the disk, at the frame that is shown: what a change in the panel starts from.
  const Shape& committed_shape() const {
    return *active_structure(state, *snapshot().document)->shape(document().frame);
  }
  /// The structure that is worked on; null: there is none yet.
  const Structure* structure() const { return active_structure(state, document()); }
  bool has_shape() const { return active_shape(state, document()).has_value(); }
  /// Its mesh on the screen, where it has one.
  ShapeView shown() const { return *active_shape(state, document()); }
  /// Why a control that needs a mesh is disabled; empty where there is one.
  std::string needs_shape() const { return why_no_mesh(state, document()); }
  /// The overlay; its volume is null without one.
  const ShownLabels& labels() const { return on_screen.labels(); }
  /// 0…1: how far the comparison of two observers is; none while none goes on.
  std::optional<double> comparing() const {
    return work.observers.busy() ? std::optional(work.observers.fraction()) : std::nullopt;
  }
  /// A template in the making stands in for the case's mesh.
  bool making_shown() const { return shown_making(state, work) != nullptr; }
  std::string needs_volume() const { return document().scan.image ? std::string() : "Open an image first."; }
};

/// One number of the case in the panel. While it changes, it is shown and previewed; when the control is let go, it
/// becomes one edit. Its value never depends on how far the preview has come.
class CaseNumber {
 public:
  /// `committed` is the case's own value.
  CaseNumber(const UiContext& ui, std::string control, double committed);
  double value = 0;  ///< the number that the control shows and changes
  /// `action_for` makes the edit that gives the case a value; called where the control changed or was let go.
  void settle(bool changed, bool released, const std::function<Action(double)>& action_for, Outbox& out) const;

 private:
  const UiContext& ui_;
  std::string control_;
  double committed_;
};

/// In the section Deform: snapping to the image.
void draw_snap(const UiContext& ui, Outbox& out);

/// In the section Template: regions and landmarks of the template, and the making of one from a label map.
void draw_regions(const UiContext& ui, Outbox& out);
void draw_template_landmarks(const UiContext& ui, Outbox& out);
void draw_template_making(const UiContext& ui, Outbox& out);
/// The labels of the overlay to choose from, and all together; one that it does not hold becomes its first. True where
/// it changed. Below it a button opens a map; `open_tip` says what for.
bool label_choice(const UiContext& ui, int& label, bool& all_labels, const std::string& open_tip, Outbox& out);
/// The radius of a ball; without one the share of the organ's size that is used then is shown. True where it changed.
bool ball_slider(const UiContext& ui, const char* name, std::optional<double>& radius_mm, int label,
                 const std::string& tip);
/// In the section Deform: what the study's model makes of the rest.
void draw_model_help(const UiContext& ui, Outbox& out);
/// In the section Place: the fit to the overlay.
void draw_fit(const UiContext& ui, Outbox& out);
void draw_refinement(const UiContext& ui, Outbox& out);
/// In the section Structures: the fit of a template set to the overlay.
void draw_set_fit(const UiContext& ui, Outbox& out);
/// The labels of the map with their eyes; nothing where it has fewer than two.
void draw_labels(const UiContext& ui, Outbox& out);
/// Why the mesh cannot be scored: a sentence; empty where a model is there.
std::string why_not_scored(const UiContext& ui);
/// The figures of a mesh that a template is judged by. `fans`: it ends in fans of thin triangles, as tubes do.
void draw_quality_report(const Theme& theme, const Mesh& mesh, const MeshQuality& quality, bool fans = false);
/// The overlay's label at a point in mm; 0 where there is none.
int label_there(const UiContext& ui, const Vec3& p_mm);

/// The side panel of the case.
void draw_side_panel(const UiContext& ui, Outbox& out);

/// A part of a panel that folds under its title.
struct PanelSection {
  const char* title;
  void (*draw)(const UiContext&, Outbox&);
  bool open_at_first;                                ///< until the user folds or unfolds it
  bool (*wanted)(const UiContext&) = nullptr;        ///< whether it has anything to show; null: always
  bool (*opens)(const UiContext&) = nullptr;         ///< in place of `open_at_first`, where that depends on the case
  std::string (*holds)(const UiContext&) = nullptr;  ///< words that its title says while it is folded
};
/// A panel of sections in `rect`.
void draw_sections(const UiContext& ui, const char* name, const RectPx& rect, std::span<const PanelSection> sections,
                   Outbox& out);

/// Size, ground and captions of a picture; true where one was changed.
bool draw_picture_options(const Theme& theme, PictureOptions& options);

/// Draws what the overlay's colours mean, as a bar with figures.
void draw_colouring_legend(const UiContext& ui, Colouring colouring);
/// The bar of a legend that has a scale, and under it its figures in `colour`.
void draw_legend_scale(ImDrawList& draw, const Theme& theme, const Legend& legend, ImVec2 at, float width_px,
                       ImU32 colour);

}  // namespace homolog
