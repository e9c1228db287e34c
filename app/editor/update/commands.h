#pragma once

#include <concepts>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "app/editor/update/commands/case_commands.h"
#include "app/editor/update/commands/contour_commands.h"
#include "app/editor/update/commands/dialog_commands.h"
#include "app/editor/update/commands/export_commands.h"
#include "app/editor/update/commands/file_commands.h"
#include "app/editor/update/commands/looks/setting_commands.h"
#include "app/editor/update/commands/looks/view_commands.h"
#include "app/editor/update/commands/measurement_commands.h"
#include "app/editor/update/commands/models_commands.h"
#include "app/editor/update/commands/structure_commands.h"
#include "app/editor/update/commands/study_commands.h"
#include "app/editor/update/commands/template_commands.h"
#include "app/editor/update/commands/tool_commands.h"

namespace homolog {

/// A list of types.
template <class... Listed>
struct TypeList {
  template <class One>
  static constexpr bool has = (std::same_as<One, Listed> || ...);
};

/// All commands. Each is written in app/editor/update/commands/: its data, the key of its line in the log, its members
/// there, and what it does.
using AllCommands = TypeList<
    // edits of the case
    PreviewEdit, ApplyEdit, GoInHistory, SnapMesh, CancelSnap, StartFit, RefineAlongSurface, CancelFit, CancelFits,
    BlendModel, CompleteByModel, ShowFrame, PlayFrames, PropagateFrames, CancelPropagation,
    // structures
    ChooseStructure, ClickStructure, NextStructure, AcceptStructure, RenameLevels, ShowStructures, ShowOnlyStructures,
    LockStructures, SetStructureOpacity, HideLabels, ChooseSet, FitSet, CancelSetFit, FilterStructures, SortStructures,
    ShowAsRead, TakeBackRepair, FollowShared, KeepApart, KeepApartAfterStrokes, SetStructureGap, SetOthersOpacity,
    // contours
    OpenContours, AddContours, CloseContours, ShowContours, SetBetweenContours, FitContours, CancelContourFit,
    // files
    OpenFiles, OpenRequested, CloseLabels, SetLabelsFrame, ShowLabelsLayer, CancelOpening, CancelReading, CancelWriting,
    SaveCase, SaveCaseAs, ExportMesh, ExportLabelMap, ExportStructuresMap, ExportMendedMap, ExportStructuresMeshes,
    ExportLandmarks, ExportTemplate, ExportTemplateLandmarks, ExportAllFrames, ExportPicture, ExportVolumes,
    ImportLandmarks, OpenFitModel, ImportStiffness, ImportTemplateLandmarks,
    // measurement by a recipe
    ChooseRecipe, DrawMeasurement, ExportMeasurements, OpenScoreModel, ScoreByFile,
    // the making of a template
    MakeTemplate, CancelTemplate, UndoTemplate, CloseTemplateMaking, UseMadeTemplate, ShowTemplateStage,
    // tools
    ChooseTool, ChooseSigma, SetSigma, SetRelaxStrength, MoveThroughSpace, SetBrush, BrushRegion, ChooseLandmark,
    NameTemplateLandmark, TypeRegion, NameRegion, ChangeNumber, SetSnap, SnapWithStrokes, SetFit, SetTemplate, Escape,
    // the views and looks
    LookFromSide, MaximiseView, ShowParts, ShowPanel, ScrollSlices, OpenSection, ShowAll, SetWindow, InterpolateImage,
    ShowRadiological, ShowOwnPlanes, LinkZoom, UseLightTheme, SetLabelOpacity, ChooseColouring, SpaceGlyphs, SeekFrame,
    LookAt, ShowFinding, MoveInGuide, ShowGuide, ShowModels, SetPicture,
    // dialogs
    ShowFileDialog, ShowKeys, CloseDialog, DismissNotice, EnterFolder, MoveInFiles, SelectFile, TypeFileName,
    ShowAllFiles, NameFolder, MakeFolder, AcceptFile, AcceptReplacement, ChooseOtherName, SetStackSpacing, AskToDiscard,
    ShowRecovery, DiscardCase, Quit,
    // the study and its model
    OpenStudy, NewStudy, SaveStudyAs, SetStudyTemplate, OpenPhantomStudy, CancelStudyFile, ExportModel,
    ExportEvaluation, ExportPlots, ExportReport, ExportSizes, ExportLandmarkTable, ShowDistance, CompareObservers,
    CancelObservers, ExportObservers, ChooseShapesFolder, ExportShapes, StartEvaluation, CancelEvaluation, AddCases,
    AddScans, FitWaiting, MakeStudyTemplate, CancelWorklist, OpenNextCase, OpenCaseOfStudy, SelectCase, SelectNextCase,
    RemoveCase, SetCaseState, CycleCaseState, TypeCaseText, SetCaseText, FlipCases, AddFrames, FilterCases, SortCases,
    LookFromSideInGallery, ShowAllShapes, ShowGalleryPage, TurnGallery, PanGallery, LetGoOfGallery, ZoomGallery,
    PointAtVertex, PinVertex, ShowGalleryGlyphs, SpaceGalleryGlyphs, ShowMean, ShowSample, ShowSelectedShape, SetMode,
    AnimateMode, ShowAllModes, ShowDifference, CompareGroup, ChooseAlignment, StartOptimisation, CancelOptimisation,
    ShowOptimised, DiscardOptimised>;

template <class One>
concept ListedCommand = AllCommands::has<One>;

/// A request of the interface to the editor: one of AllCommands, as a value that does not change. Nothing is done while
/// the interface draws.
class Command {
 public:
  /// A control sends what it asks for as it is.
  template <ListedCommand One>
  Command(One one) : held_(new Of<One>(std::move(one))) {}

  /// The word for it in the log.
  const char* key() const { return held_->key(); }
  Logged logged() const { return held_->logged(); }
  /// Whether it gives up what runs.
  bool cancels() const { return held_->cancels(); }
  /// Writes its members to a line of the log.
  void write(Fields& line) const { held_->write(line); }
  /// Does it where the state alone is enough for it; else false, and nothing is done.
  bool run_on_state(EditorState& state, const ControlsContext& context, Outbox& out) const {
    return held_->run_on_state(state, context, out);
  }
  /// Does what needs the editor.
  void run(Editing& editing) const { held_->run(editing); }
  /// Itself where it is a One, else null.
  template <ListedCommand One>
  const One* as() const {
    const auto* held = dynamic_cast<const Of<One>*>(held_.get());
    return held != nullptr ? &held->one : nullptr;
  }

 private:
  struct Any {
    virtual ~Any() = default;
    virtual const char* key() const = 0;
    virtual Logged logged() const = 0;
    virtual bool cancels() const = 0;
    virtual void write(Fields& line) const = 0;
    virtual bool run_on_state(EditorState& state, const ControlsContext& context, Outbox& out) const = 0;
    virtual void run(Editing& editing) const = 0;
  };
  // Not a variant: whoever sends one command would then compile all of them.
  template <class One>
  struct Of;

  std::shared_ptr<const Any> held_;
};

template <class One>
struct Command::Of final : Any {
  static constexpr bool needs_state = requires(const One& one, EditorState& state) { one.run(state); };
  static constexpr bool needs_controls =
      requires(const One& one, EditorState& state, const ControlsContext& context, Outbox& out) {
    one.run(state, context, out);
  };
  static constexpr bool needs_editor = requires(const One& one, Editing& editing) { one.run(editing); };
  static_assert(needs_state || needs_controls || needs_editor,
                "run() takes an Editing, an EditorState, or a state with its controls and outbox");

  explicit Of(One held) : one(std::move(held)) {}
  const char* key() const override { return One::key; }
  Logged logged() const override {
    if constexpr (requires { One::logged; })
      return One::logged;
    else
      return Logged::at_once;
  }
  bool cancels() const override {
    if constexpr (requires { One::cancels; })
      return One::cancels;
    else
      return false;
  }
  void write(Fields& line) const override {
    if constexpr (requires(One copy) { copy.spell(line); }) One(one).spell(line);
  }
  bool run_on_state(EditorState& state, const ControlsContext& context, Outbox& out) const override {
    if constexpr (needs_state)
      one.run(state);
    else if constexpr (needs_controls)
      one.run(state, context, out);
    return needs_state || needs_controls;
  }
  void run(Editing& editing) const override {
    if constexpr (needs_editor) one.run(editing);
  }

  One one;
};

/// Commands in the order they were given.
class Outbox {
 public:
  void send(Command command) { commands_.push_back(std::move(command)); }
  void apply(Action action, bool joined = false);
  void preview(std::optional<Action> action);
  bool empty() const { return commands_.empty(); }
  std::vector<Command> take() { return std::exchange(commands_, {}); }

 private:
  std::vector<Command> commands_;
};

}  // namespace homolog
