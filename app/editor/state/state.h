#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/editor/state/dialogs.h"
#include "app/editor/state/drag.h"
#include "app/editor/state/figures/findings.h"
#include "app/editor/state/figures/measurements.h"
#include "app/editor/state/figures/scoring.h"
#include "app/editor/state/guide.h"
#include "app/editor/state/layout.h"
#include "app/editor/state/models/models_state.h"
#include "app/editor/state/outcomes.h"
#include "app/editor/state/settings.h"
#include "app/editor/state/structure_looks.h"
#include "app/editor/state/view_geometry.h"
#include "core/assist/cine.h"
#include "core/case/action.h"
#include "core/deform/sigma_presets.h"
#include "core/structures/maps/structures_in_map.h"

namespace homolog {

/// The tool of the left mouse button in a view. Each has a row in app/editor/update/tools/.
enum class MouseTool {
  pull,
  grab,
  slide,
  relax,
  place,
  landmark,
  stiffness,
  confirm,
  ruler,
  contour,
  template_landmark
};

/// The meaning of the mesh's colours. Each has a row in app/editor/scene/mesh_colouring.cpp.
enum class Colouring {
  vertex_hue,
  structure,
  edge_stretch,
  moved,
  stiffness,
  regions,
  quality,
  known,
  doubt,
  score,
  confidence
};

/// The place that a slice view looks at within its plane; the plane itself goes through the cross-hair.
struct SlicePan {
  Vec3 centre_mm = Vec3::Zero();
  double mm_per_px = 0.5;
  float side_px = 0;  ///< shorter side of the view that this is for
  bool operator==(const SlicePan&) const = default;
};

/// How the slices look in the 3D view: seen through, behind the surface wherever they lie, or as they cut it.
enum class PlaneLook { translucent, behind, solid };

struct ShownParts {
  bool outline = true, surface = true, planes = true, glyphs = false, wireframe = false, crosshair = true,
       letters = true;
  bool label_surface = false;  ///< the surface of the label in hand, smooth and seen through, in the 3D view
  PlaneLook plane_look = PlaneLook::translucent;
  bool operator==(const ShownParts&) const = default;
};

/// The effect of a touch of the stiffness brush.
enum class BrushPaints { factor, region, smooth, fill };

struct BrushSettings {
  double radius_mm = 10;  ///< the radius for an organ as large as a kidney; see follow_organ()
  BrushPaints paints = BrushPaints::factor;
  std::string region;   ///< the region that is painted or filled; the first one where there is none of that name
  bool erases = false;  ///< takes vertices out of their region instead
  FillRegion::By fill_by = FillRegion::By::region;
  double fill_tolerance_per_mm = FillRegion{}.tolerance_per_mm;
  double stiffness_factor = 0.2;  ///< painted by the stiffness brush, relative to the base
  double soft = 0.5;              ///< share of the radius over which it blends
  bool hold = true;               ///< the confirm brush holds, else it frees
};

/// A region whose name is being typed.
struct RegionNaming {
  RenameRegion rename;
  bool focused = false;  ///< the field has been given the keyboard
};

/// The thing that the pointer is over; nothing while it is outside the views.
struct Hover {
  ViewKind view = ViewKind::axial;
  double x_px = 0, y_px = 0;         ///< distance from the window's upper left corner
  std::optional<Vec3> p_mm;          ///< the place on the slice, or on the surface in the 3D view
  std::optional<Vec3> on_mesh;       ///< the surface point that a press would take hold of
  std::string landmark;              ///< name of the placed landmark under the pointer
  std::string structure;             ///< id of another structure than the active one, that a click would choose
  PlacePart part = PlacePart::none;  ///< the placement handle under the pointer
};

struct Ruler {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  double length_mm() const { return (to - from).norm(); }
};

/// For double clicks: the last press of the left button in a view, and what a double click brings back.
struct LastPress {
  double x_px = 0, y_px = 0, seconds = -1;
  int clicks = 0;  ///< clicks that follow each other at one place
  std::optional<Ruler> ruler;
  Camera3D camera;
  bool played = false;
};

/// A number of the case that is being changed in the panel: what it is now, whatever the screen shows yet.
struct PanelEdit {
  std::string control;
  double value = 0;
};

/// The things that a person has in hand: an edit's sentence is news until this changes.
struct Situation {
  MouseTool tool = MouseTool::pull;
  BrushPaints paints = BrushPaints::factor;
  std::string region, landmark, template_landmark;
  int frame = 0;
  std::string structure;  ///< that is worked on, by its id
  bool operator==(const Situation&) const = default;
};

/// The work done on the case on the screen, until it is written into the study.
struct WorkCount {
  std::uint64_t case_number = 0;  ///< which case it is of
  double seconds = 0;
  double active_at = -1;  ///< when something was done last, by the window's clock; below 0: nothing yet
};

struct Notice {
  std::string text;  ///< one sentence
  bool error = true;
  std::optional<double> until;  ///< when it goes by itself, in seconds of the window's clock
  bool unwritten = false;       ///< something could not be written to the case's file
  bool over = false;            ///< what it says holds no more: it goes soon
  std::filesystem::path kept;   ///< a case or study that is offered to be opened again; empty: none
};

/// Whether the window closes: now, or as soon as what is being written is written, the study's file too or not.
/// `asked`: the case's file is looked after first, and a question may follow.
enum class Quitting { no, asked, when_written, when_written_without_study, now };

/// Things a newcomer has to do once; each hint goes away when done, all when dismissed.
struct Hints {
  bool dragged = false, scrolled = false, turned_camera = false;
  bool operator==(const Hints&) const = default;
};

/// The title of the section that lists the structures.
inline constexpr const char* structures_section = "Structures";
/// The title of the section that the tools of placing unfold.
inline constexpr const char* place_section = "Place";
/// The title of the section that lists the contours.
inline constexpr const char* contours_section = "Contours";
/// The title of the section that holds the settings of the brushes.
inline constexpr const char* deform_section = "Deform";

/// The preferences that are kept between runs.
struct Preferences {
  int window_width = 1280, window_height = 800;
  bool panel_open = true;
  std::map<std::string, bool> sections_open;  ///< by title; those never folded or unfolded are not in it
  bool radiological = true;
  bool linear = true;
  bool linked_zoom = false;  ///< the slice views zoom together
  bool light = false;        ///< the light theme
  ShownParts show;
  Hints hints;
  double told_unsaved = 0;                    ///< when cases that were never saved were offered, seconds since 1970
  bool guide_done = false;                    ///< the guide to the first case was followed or closed
  std::vector<std::filesystem::path> recent;  ///< images and cases, newest first
  std::vector<std::filesystem::path> recent_studies;
  std::filesystem::path folder;  ///< last used in the file dialog
  bool operator==(const Preferences&) const = default;
};

/// The things that are looked at, and how.
struct Look {
  std::string structure;  ///< the one that is worked on, by its id; empty: the case's first
  StructureLooks structures;
  std::set<std::string> hidden_contours;  ///< whose eye is shut, by their ids

  Vec3 crosshair_mm = Vec3::Zero();
  double scrolled = 0;  ///< slices, less than one: what the wheel has turned towards the next
  std::array<SlicePan, 3> slices;
  Camera3D camera;
  bool own_planes = false;
  std::optional<ViewKind> maximised;
  bool show_all_wanted = true;  ///< shows all in the views, once it is known how large they are

  double window_low = 0, window_high = 1;
  double label_opacity = 0.4;
  std::shared_ptr<const std::set<int>> hidden_labels;  ///< labels of the label map whose eye is shut; null: none
  Colouring colouring = Colouring::vertex_hue;         ///< the chosen one; never confidence
  bool shows_confidence = true;                        ///< instead of it, while there is one
  double organ_mm = 125;  ///< the diagonal of the organ that sizes in mm were last chosen for
  double glyph_spacing_mm = 10.5;

  std::optional<int> shown_frame;  ///< the frame of a cine while it plays or its slider is dragged; else the document's
  bool playing = false;
  double next_frame_seconds = 0;           ///< the time of the next frame of a cine that plays, by the window's clock
  std::optional<std::size_t> shown_stage;  ///< the stage of the template that is being made; else the last one
  bool making_shown = false;               ///< the template that is being made stands in for the case's mesh
};

/// A person's hand: the tool, and what it works with.
struct Hand {
  MouseTool tool = MouseTool::pull;
  MouseTool tool_before_naming = MouseTool::pull;  ///< taken up again when a landmark of the template has its place
  std::array<double, 3> sigma_presets_mm{4, 10, 25};
  std::size_t sigma_preset = 1;
  std::optional<double> wheel_sigma_mm;  ///< it counts in place of the preset, until one is chosen or changed
  double relax_strength = 0.5;
  bool through_space = false;
  BrushSettings brush;
  std::string landmark;           ///< the one that the next click places
  std::string template_landmark;  ///< the one that the next click names on the template
  std::string new_region;         ///< the name that is being typed
  std::optional<RegionNaming> renaming;
  std::optional<Ruler> ruler;
  std::optional<PanelEdit> panel_edit;

  double sigma_mm() const { return wheel_sigma_mm.value_or(sigma_presets_mm[sigma_preset]); }
};

/// The place of the pointer, and what its buttons do there.
struct Pointer {
  std::optional<Hover> hover;
  LastPress last_press;
  std::string pressed_structure;  ///< another one that the left button was pressed on; a release there chooses it
  std::optional<Drag> drag;
  MouseTool begun_with = MouseTool::pull;  ///< the tool that `drag` or `held_click` is of
  std::optional<HeldClick> held_click;
  MouseButton drag_button = MouseButton::left;  ///< whose release ends the drag
};

/// The requests to the automatic work.
struct Automatic {
  TemplateSettings template_settings;
  FitSettings fit_settings;
  std::shared_ptr<const ShapeModel> fit_model;  ///< the model that was read from a file; null: none was
  std::filesystem::path fit_model_file;
  std::string set_source;                     ///< the source of the template set that was chosen; empty: none was
  std::shared_ptr<const SetOfTemplates> set;  ///< it, once it is read
  SnapSettings snap;
  BetweenCurves between_contours = BetweenCurves::shape;
  OfferedContours offered;  ///< the contours of a file, to choose from
  double model_help = 0;    ///< 0…1: how far the study's model completes every stroke
  bool keep_apart = true;   ///< moves the structure out of its neighbours at the end of a stroke
  double gap_mm = 0;        ///< the gap that a fit of the set and the end of a stroke leave between neighbours
};

/// The findings on the structure that is worked on. Another structure begins with nothing.
struct Found {
  VolumeCurve volume_curve;                         ///< the volumes of the cine as it is shown
  std::optional<Fitted> last_fit;                   ///< spoken of for as long as its mesh is the case's
  std::optional<Fitted> last_refinement;            ///< likewise
  std::optional<SnapFound> snapped;                 ///< the last snap
  std::optional<ContoursFitted> fitted_contours;    ///< the last fit to contours
  std::shared_ptr<const VertexScalars> confidence;  ///< the snap's, while the mesh is as it left it; else null
  std::vector<Finding> unclear_edges;               ///< the places where `confidence` is low
  std::optional<ShownFinding> finding;              ///< the one that is looked at
  static constexpr auto not_known = std::numeric_limits<std::size_t>::max();
  std::size_t intersecting_at_rest = not_known;  ///< pairs of faces, before a drag
  /// How many there were before an edit took the surface through itself; none where there are no more than that.
  std::optional<std::size_t> intersecting_before;
};

/// How and where files are saved.
struct Saving {
  std::filesystem::path saved_folder;  ///< the folder that a file of what is open was saved in last; empty: none was
  PictureOptions picture;
  bool export_all_frames = true;  ///< all frames of a cine with several meshes; else the frame that is shown
};

/// Everything the editor remembers that is not part of the case. Changed by the free functions below and in
/// controls.h; drawing reads it as const.
struct EditorState {
  Preferences preferences;
  Look look;
  Hand hand;
  Pointer pointer;
  Automatic automatic;
  Found found;
  Saving saving;
  Measurements measurements;
  Scoring scoring;
  ModelsState models;

  std::optional<Guide> guide;  ///< the guide to the first case, while that is open
  std::optional<Dialog> dialog;
  std::vector<Notice> notices;
  std::optional<Situation> said_in;   ///< when the session said its last sentence
  std::optional<double> hints_until;  ///< when the hints go by themselves, seconds of the window's clock
  bool hints_over = false;
  std::string wanted_section;        ///< the section of the side panel that a tool has asked for
  std::uint64_t section_wanted = 0;  ///< counts how often
  std::size_t unsaved_found = 0;     ///< cases that were never saved and that nobody was told of before
  bool active = false;               ///< something was done by hand since the work was counted last
  WorkCount work_count;
  Quitting quitting = Quitting::no;
};

/// The structure that is worked on; null: the case has none.
const Structure* active_structure(const EditorState& state, const Document& document);
/// Its mesh at the document's frame, where it has one.
std::optional<ShapeView> active_shape(const EditorState& state, const Document& document);

/// Works on another structure from now on; the empty id is the first one's. The findings on the one before are over.
void show_structure(EditorState& state, const Document& document, const std::string& id);
/// Ends the findings and the work in hand of another structure; sizes follow the one that is worked on now.
void begin_on_structure(EditorState& state, const Document& document);

/// Whether edits of the structure that is worked on are refused, since it is locked.
bool active_is_locked(const EditorState& state, const Document& document);
/// Whether the structure that is worked on is drawn: its eye is open.
bool active_is_shown(const EditorState& state, const Document& document);
/// With several structures each has its own colour, where no other colouring was chosen.
void follow_structures(EditorState& state, const Document& document);
/// Opens the eyes of contours that are gone: a new one may get such an id.
void follow_contours(EditorState& state, const Document& document);

/// Whether the brush in hand paints regions, or fills them.
bool paints_regions(const EditorState& state);
/// The colouring that is shown. While a brush is in hand: what it paints, or the doubt if that was chosen and the
/// brush confirms. After a snap: its confidence, until the user chooses another. The hue for a score that is not known.
Colouring shown_colouring(const EditorState& state);

/// Shows a case from the start: cross-hair in the middle of the mesh (or volume), everything in view, σ presets from
/// the size of the placed reference; window from the volume, or as it was on the same image.
void show_document(EditorState& state, const Document& document, const Layout& layout, bool same_image = false);
/// Glyphs and the brush get sizes for an organ of another size than they had; for one that is about as large they keep
/// what a person chose. `diagonal_mm`: of its bounding box.
void follow_organ(EditorState& state, double diagonal_mm);
/// Changes the chosen preset.
void set_sigma(EditorState& state, double sigma_mm);
/// Takes another σ for now; the presets stay.
void turn_sigma(EditorState& state, double sigma_mm);

/// The name of a case and of files written from it: its file's, else its image's.
std::string case_name(const std::filesystem::path& file, const Document& document);
/// Those whose names are the template's.
std::vector<Landmark> landmarks_of_template(const std::vector<Landmark>& landmarks, const Template& the_template);
/// The next landmark of the template that the shape has no place for; empty where all are placed.
std::string next_unplaced_landmark(const ShapeView& shown, const std::string& after = {});

/// The landmark that the next click places: the one that was chosen, where the template has it, else the next one that
/// has no place; empty where all are placed.
std::string landmark_in_hand(const EditorState& state, const Document& document);
Situation situation_of(const EditorState& state, const Document& shown);

void add_notice(EditorState& state, Notice notice);
void add_notice(EditorState& state, std::string text, bool error = true);
/// Puts a file at the head of a list of those used last.
void remember_recent(std::vector<std::filesystem::path>& recent, const std::filesystem::path& path);

/// The case's frame, or the one that is shown while a cine plays.
int shown_frame(const EditorState& state, const Document& document);

}  // namespace homolog
