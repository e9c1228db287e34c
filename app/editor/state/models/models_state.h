#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/editor/state/models/study_optimisation.h"
#include "app/editor/state/view_geometry.h"
#include "core/model/measures/evaluation.h"
#include "core/model/measures/observers.h"

namespace homolog {

enum class CaseColumn { study, name, group, state, distance };

/// A vertex of one of the gallery's shapes.
struct GalleryVertex {
  std::size_t shape = 0;  ///< the shape's number in the model
  Eigen::Index vertex = 0;
  bool operator==(const GalleryVertex&) const = default;
};

/// A case that is to be shown at a vertex as soon as it is open.
struct RepairPlace {
  std::filesystem::path file;
  std::optional<int> frame;
  std::optional<Eigen::Index> vertex;
  std::string structure;  ///< empty: the first
};

/// A text of a case that is being typed.
struct CaseTextEdit {
  std::string field;
  std::string text;
};

/// The place where the study in hand is kept, and the counts that tell what has to follow it.
struct StudyKept {
  std::filesystem::path file;         ///< written at every change; empty before the first case
  std::uint64_t number = 0;           ///< counts the studies that were opened
  std::uint64_t shapes_revision = 0;  ///< counts what the model has to be made again for
  std::uint64_t revision = 0;         ///< counts what the study's file has to be written again for
};

/// How the cases and their sizes are listed, and which one is selected.
struct CaseList {
  std::string filter;
  CaseColumn sorted_by = CaseColumn::study;
  bool descending = false;
  std::string selected;  ///< name of a case; empty: none
  std::optional<CaseTextEdit> text_edit;
  std::size_t distance_shown = 0;  ///< the number of the shown pair of landmarks in the list of sizes
};

/// The shapes of the cases, as they were read and as they are shown.
struct StudyShapes {
  ReadFiles files;       ///< the cases' files as they were read
  ShapesOfStudy fitted;  ///< the shapes of those files
  /// The shapes that are shown, measured and written: the fitted shapes, or the optimised ones in place of those.
  std::map<std::string, std::shared_ptr<const MeshFile>> shown;
  std::map<std::string, ShapeSizes> sizes;
  std::vector<std::string> mirrored;  ///< cases that are mirror images of most others
};

/// Another observer's study of the same cases, which this one is compared with.
struct OtherObserver {
  std::optional<ObserverComparison> comparison;  ///< none: nobody asked for one
  std::filesystem::path study;
  std::map<std::string, std::shared_ptr<const MeshFile>> compared_shapes;  ///< this study's, which it is compared by
  bool outdated = false;  ///< shapes have changed since, so that the comparison was dropped
};

/// The model of the shapes, how it is made, and what is found on it.
struct StudyMade {
  Alignment alignment = Alignment::similarity;
  std::shared_ptr<const StudyModel> model;       ///< the model of the shapes that are shown
  std::shared_ptr<const Suspicions> suspicions;  ///< the suspicions on `model`; null while they are looked for
  StudyOptimisation optimisation;
  std::string error;
  std::shared_ptr<const Evaluation> evaluation;
};

/// How the gallery is looked at.
struct GalleryLook {
  std::size_t page = 0;  ///< the page's number, from 0; see gallery_pages
  Camera3D camera;       ///< linked: of all cells and of the model; its target stands off each shape's centre
  bool turning = false;
  bool glyphs = true;
  double glyph_spacing_mm = 12;
  std::optional<GalleryVertex> hover;
  std::optional<Eigen::Index> pinned;  ///< vertex that is marked in all shapes
  bool focused = false;                ///< every cell looks at the pinned vertex
};

/// The content of the model's view.
struct ModelView {
  std::vector<double> deviations;  ///< coefficients of the shape that is shown, in standard deviations
  bool all_modes = false;          ///< a slider for each, not the first few alone
  std::optional<std::size_t> animated_mode;
  double animation_started = -1;  ///< seconds; below 0 with the next move
  std::uint64_t samples_drawn = 0;
  bool show_difference = false;
  std::array<std::string, 2> compared;  ///< groups: from, to
};

/// The work that runs for the study, and how far it is.
struct StudyRuns {
  bool modelling = false;
  double modelling_fraction = 0;
  bool evaluating = false;
  double evaluating_fraction = 0;
  bool exporting = false;
  double exporting_fraction = 0;
  bool listing = false;  ///< scans are read or fitted
  std::string listing_what;
  double listing_fraction = 0;
};

/// The state of the Models mode. Changed by the functions below; drawing reads it as const.
struct ModelsState {
  bool shown = false;  ///< instead of the case's views
  Study study;
  StudyKept kept;
  CaseList list;
  StudyShapes shapes;
  OtherObserver observer;
  StudyMade made;
  GalleryLook gallery;
  ModelView view;
  StudyRuns runs;

  std::string export_extension;  ///< the extension of exported shapes; empty: each as it was imported
  std::optional<RepairPlace> repair;
};

/// The cases to list, as indices into the study: those whose name, group or notes hold the filter, sorted.
std::vector<std::size_t> listed_cases(const ModelsState& state);
/// The sizes of the study's cases in its order, those that are known.
struct ListedSizes {
  std::vector<std::string> names;
  std::vector<ShapeSizes> sizes;
  std::vector<std::string> groups;  ///< empty where no case has one
};
ListedSizes listed_sizes(const ModelsState& state);
/// RMS distance to the mean shape; nothing for a case that is not in the model.
std::optional<double> distance_mm(const ModelsState& state, const StudyCase& one);
void sort_by(ModelsState& state, CaseColumn column);
/// Selects a case, and shows the gallery's page that has it.
void select_case(ModelsState& state, const std::string& name);

/// Cases that wait for a fit to their label map.
std::size_t waiting_cases(const ModelsState& state);
/// How many cases have a label map.
std::size_t cases_with_labels(const ModelsState& state);
/// Cases with label maps, from which on a template of all of them is the better one (docs/templates.md).
inline constexpr std::size_t enough_for_consensus = 5;
/// Adds files as cases, named after them (with -2, -3, … where a name is taken); a file that is a case already is left.
/// Gives the number of cases added.
std::size_t add_cases(ModelsState& state, const std::vector<std::filesystem::path>& files);
void remove_case(ModelsState& state, const std::string& name);
/// The study's case of a file's frame; null where it is none.
const StudyCase* find_case(const ModelsState& state, const std::filesystem::path& file, const Document& document,
                           std::string_view structure);
/// Null where there is none of that name. For many names see CasesByName.
StudyCase* find_case(Study& study, const std::string& name);
const StudyCase* find_case(const Study& study, const std::string& name);
/// Takes cases left for right from now on, or as they lie where they were flipped.
void flip_cases(ModelsState& state, const std::vector<std::string>& names);
/// Frames of the case's cine that were edited and are no cases yet.
std::vector<int> other_frames(const ModelsState& state, const StudyCase& one);
/// Makes every frame of the case's cine that was edited a case, named "NAME frame K".
void add_frames(ModelsState& state, const std::string& name);
void cycle_case_state(ModelsState& state, const std::string& name);
void set_case_state(ModelsState& state, const std::string& name, CaseState to);
/// "group" or "notes" of a case.
void set_case_text(ModelsState& state, const std::string& name, const std::string& field, std::string text);
/// The mesh whose faces stand for those of shapes that are points alone.
void set_study_template(ModelsState& state, const std::filesystem::path& file);
/// Selects the next case that is not done, in the study's order.
void select_next_case(ModelsState& state);

/// Takes another study in hand: nothing of the one before stays.
void show_study(ModelsState& state, Study study, std::filesystem::path file);
/// Takes a model in: keeps the camera where one was shown, the coefficients where they fit.
void show_model(ModelsState& state, std::shared_ptr<const StudyModel> model);

/// Takes in the study's shapes as they were read, and their model. An optimisation of other shapes is over; gives the
/// sentence that says so and why.
std::string take_fitted(ModelsState& state, ShapesOfStudy fitted);
/// Why the shapes cannot be optimised now; empty where they can.
std::string why_not_optimise(const ModelsState& state);
/// Takes in what came of the optimisation that runs, and shows it.
void take_optimised(ModelsState& state, OptimisedStudy optimised);
/// Shows the optimised shapes and their model, where there are some, or again those that were fitted.
void show_optimised(ModelsState& state, bool shown);
/// Gives up an optimisation or its result. The fitted shapes are shown.
void discard_optimised(ModelsState& state);

/// The gallery shows so many shapes at a time: as many as are turned without a jerk by a processor alone.
inline constexpr std::size_t shapes_a_page = 20;
std::size_t gallery_pages(const ModelsState& state);
/// The nearest page that there is.
void show_gallery_page(ModelsState& state, std::size_t page);

/// Looks at all shapes, from the front.
void show_all_shapes(ModelsState& state);
/// Marks a vertex in all shapes; `focus` turns it to the viewer, in the middle of every cell.
void pin_vertex(ModelsState& state, const GalleryVertex& place, bool focus);
void unpin(ModelsState& state);

/// b of the model's shape that is shown: deviations · √λ.
Eigen::VectorXd shown_coefficients(const ModelsState& state);
void set_to_mean(ModelsState& state);
/// A random shape of the model, every coefficient within ±3.
void set_to_sample(ModelsState& state);
/// The coefficients of a case that is in the model, clamped to ±3.
void set_to_case(ModelsState& state, const std::string& name);
/// Moves the animated mode: a sine of ±3 standard deviations in four seconds.
void animate(ModelsState& state, double seconds);

/// "kidneys" of kidneys.study.json; empty where there is none.
std::string study_name(const std::filesystem::path& file);

}  // namespace homolog
