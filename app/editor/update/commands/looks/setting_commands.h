#pragma once

#include "app/editor/state/models/gallery.h"
#include "app/editor/state/views.h"
#include "app/editor/update/commands/looks/setting.h"

namespace homolog {

// Commands that are rows. The first word is the command's in the log, the second one its value's; that is empty where
// the value is written as several members.

// The choice of what is seen, and from where.

/// Turns the 3D view.
using LookFromSide = Call<"look from side", "side", look_from, &EditorState::look, &Look::camera>;
/// One view fills the window; all four where none is named.
using MaximiseView = Setting<"maximise view", "view", &EditorState::look, &Look::maximised>;
/// The slice views zoom together, or each by itself.
using LinkZoom = Call<"link zoom", "linked", link_zoom>;
/// Outline, surface, planes and so on.
using ShowParts = Setting<"show parts", "", &EditorState::preferences, &Preferences::show>;
using ShowPanel = Setting<"show panel", "shown", &EditorState::preferences, &Preferences::panel_open>;
using InterpolateImage = Setting<"interpolate image", "linear", &EditorState::preferences, &Preferences::linear>;
using ShowRadiological =
    Setting<"show radiological", "radiological", &EditorState::preferences, &Preferences::radiological>;
/// The light theme, or the dark one.
using UseLightTheme = Setting<"use light theme", "light", &EditorState::preferences, &Preferences::light>;
/// 0…1.
using SetLabelOpacity = Setting<"set label opacity", "opacity", &EditorState::look, &Look::label_opacity>;
using SpaceGlyphs = Setting<"space glyphs", "spacing_mm", &EditorState::look, &Look::glyph_spacing_mm>;
/// Shows the study and its model, or the case.
using ShowModels = Setting<"show models", "shown", &EditorState::models, &ModelsState::shown>;

// The tool in hand, and its settings.

/// Changes the chosen preset.
using SetSigma = Call<"set sigma", "sigma_mm", set_sigma>;
/// 0…1.
using SetRelaxStrength = Setting<"set relax strength", "strength", &EditorState::hand, &Hand::relax_strength>;
/// Whether a stroke also moves sheets that lie near.
using MoveThroughSpace = Setting<"move through space", "through", &EditorState::hand, &Hand::through_space>;
using SetBrush = Setting<"set brush", "", &EditorState::hand, &Hand::brush>;
/// The name that the next click gives a point of the template.
using NameTemplateLandmark = Setting<"name template landmark", "name", &EditorState::hand, &Hand::template_landmark>;
/// The name of a new region, while it is typed.
using TypeRegion = Setting<"type region", "name", &EditorState::hand, &Hand::new_region>;
/// The new name of a region while it is typed; none: the field closes.
using NameRegion = Setting<"name region", "", &EditorState::hand, &Hand::renaming>;
/// A number of the case while it is changed in the panel; none: it was let go.
using ChangeNumber = Setting<"change number", "", &EditorState::hand, &Hand::panel_edit>;
using SetFit = Setting<"set fit", "", &EditorState::automatic, &Automatic::fit_settings>;
using SetTemplate = Setting<"set template", "", &EditorState::automatic, &Automatic::template_settings>;
/// A stage of a template's making; none: the last one.
using ShowTemplateStage = Setting<"show stage", "stage", &EditorState::look, &Look::shown_stage>;

/// The source that says where the boundary lies between the contours.
using SetBetweenContours =
    Setting<"set between contours", "between", &EditorState::automatic, &Automatic::between_contours>;
/// Offers no file of contours any more.
using CloseContours = Clearing<"close contours", &EditorState::automatic, &Automatic::offered>;

/// Whether the mesh is scored against a model's file, or against the open study.
using ScoreByFile = Setting<"score by file", "file", &EditorState::scoring, &Scoring::by_file>;

// Files.

/// Which frames of a cine the next exports write: all that have a mesh, or the one that is shown.
using ExportAllFrames = Setting<"export all frames", "all", &EditorState::saving, &Saving::export_all_frames>;
/// The content of a picture that is saved.
using SetPicture = Setting<"set picture", "", &EditorState::saving, &Saving::picture>;

// Dialogs.

/// The list of keys.
using ShowKeys = DialogOpening<"show keys", KeysDialog>;
/// Closes whichever dialog is open.
using CloseDialog = ClearingLogged<Logged::never, "close dialog", &EditorState::dialog>;
/// Types the name of a folder to make; no name ends that.
using NameFolder = DialogSetting<"name folder", "name", &FileDialog::browser, &FileBrowser::new_folder>;
/// The voxel size of a stack of pictures, mm.
using SetStackSpacing = DialogSetting<"set stack spacing", "spacing_mm", &SpacingDialog::spacing_mm>;
/// Asks a second time before a case is deleted; an empty path takes the question back.
using AskToDiscard = DialogSetting<"ask to discard", "journal", &RecoverDialog::to_discard>;

// The study and its cases.

/// The mesh whose faces stand for those of shapes that are points alone.
using SetStudyTemplate = Call<"set study template", "path", set_study_template, &EditorState::models>;
using SelectCase = Call<"select case", "name", select_case, &EditorState::models>;
/// The next one that is not done.
using SelectNextCase = PlainCall<"select next case", select_next_case, &EditorState::models>;
using RemoveCase = Call<"remove case", "name", remove_case, &EditorState::models>;
/// To do, in work, done, to do.
using CycleCaseState = Call<"cycle case state", "name", cycle_case_state, &EditorState::models>;
/// A text of the selected case while it is typed.
using TypeCaseText = Setting<"type case text", "", &EditorState::models, &ModelsState::list, &CaseList::text_edit>;
/// Takes cases left for right, or as they lie where they were flipped.
using FlipCases = Call<"flip cases", "names", flip_cases, &EditorState::models>;
/// Every edited frame of a case's cine becomes a case.
using AddFrames = Call<"add frames", "name", add_frames, &EditorState::models>;
using FilterCases = Setting<"filter cases", "filter", &EditorState::models, &ModelsState::list, &CaseList::filter>;
using SortCases = Call<"sort cases", "column", sort_by, &EditorState::models>;
/// Which two landmarks the list of sizes shows the distance of: a row of landmark_pairs.
using ShowDistance =
    Setting<"show distance", "pair", &EditorState::models, &ModelsState::list, &CaseList::distance_shown>;

// The gallery and the model.

using LookFromSideInGallery = Call<"look from side in gallery", "side", look_from, &EditorState::models,
                                   &ModelsState::gallery, &GalleryLook::camera>;
using ShowAllShapes = PlainCall<"fit gallery", show_all_shapes, &EditorState::models>;
/// From 0.
using ShowGalleryPage = Call<"show gallery page", "page", show_gallery_page, &EditorState::models>;
/// A turn or a pan ends.
using LetGoOfGallery =
    Clearing<"let go of gallery", &EditorState::models, &ModelsState::gallery, &GalleryLook::turning>;
using ZoomGallery = Call<"zoom gallery", "steps", zoom_gallery, &EditorState::models>;
/// The vertex that the pointer is over.
using PointAtVertex = SettingLogged<Logged::never, "point at vertex", "", &EditorState::models, &ModelsState::gallery,
                                    &GalleryLook::hover>;
using ShowGalleryGlyphs =
    Setting<"show gallery glyphs", "shown", &EditorState::models, &ModelsState::gallery, &GalleryLook::glyphs>;
using SpaceGalleryGlyphs = Setting<"space gallery glyphs", "spacing_mm", &EditorState::models, &ModelsState::gallery,
                                   &GalleryLook::glyph_spacing_mm>;
using ShowMean = PlainCall<"show mean", set_to_mean, &EditorState::models>;
using ShowSample = PlainCall<"show sample", set_to_sample, &EditorState::models>;
using ShowAllModes = Setting<"show all modes", "all", &EditorState::models, &ModelsState::view, &ModelView::all_modes>;
using ChooseAlignment =
    Setting<"choose alignment", "alignment", &EditorState::models, &ModelsState::made, &StudyMade::alignment>;
/// Shows the optimised shapes and their model, or those that were fitted.
using ShowOptimised = Call<"show optimised", "shown", show_optimised, &EditorState::models>;
using DiscardOptimised = PlainCall<"discard optimised", discard_optimised, &EditorState::models>;

}  // namespace homolog
