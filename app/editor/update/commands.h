#pragma once

#include <any>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "app/editor/update/commands/case_commands.h"
#include "app/editor/update/commands/dialog_commands.h"
#include "app/editor/update/commands/file_commands.h"
#include "app/editor/update/commands/models_commands.h"
#include "app/editor/update/commands/optimise_commands.h"
#include "app/editor/update/commands/study_commands.h"
#include "app/editor/update/commands/template_commands.h"
#include "app/editor/update/commands/tool_commands.h"
#include "app/editor/update/commands/view_commands.h"

namespace homolog {

/// What the interface asks the editor to do: the list of all commands. Nothing is done while it draws. Each command is
/// written in app/editor/update/commands/: its data, the key of its line in the log, its members there, and what it
/// does.
using Command = std::variant<
    // edits of the case
    PreviewEdit, ApplyEdit, GoInHistory, SnapMesh, CancelSnap, StartFit, RefineAlongSurface, CancelFit, BlendModel,
    CompleteByModel, ShowFrame, PlayFrames, PropagateFrames, CancelPropagation,
    // files
    OpenFiles, OpenRequested, CloseLabels, CancelOpening, CancelReading, CancelWriting, SaveCase, SaveCaseAs,
    ExportMesh, ExportLabelMap, ExportLandmarks, ExportTemplate, ExportTemplateLandmarks, ExportPicture, ExportVolumes,
    ImportLandmarks, OpenFitModel, ImportStiffness, ImportTemplateLandmarks,
    // the making of a template
    MakeTemplate, CancelTemplate, UndoTemplate, CloseTemplateMaking, UseMadeTemplate, ShowTemplateStage,
    // tools
    ChooseTool, ChooseSigma, SetSigma, SetRelaxStrength, MoveThroughSpace, SetBrush, BrushRegion, ChooseLandmark,
    NameTemplateLandmark, TypeRegion, NameRegion, ChangeNumber, SetSnap, SnapWithStrokes, SetFit, SetTemplate, Escape,
    // what is seen
    LookFromSide, MaximiseView, ShowParts, ShowPanel, ScrollSlices, OpenSection, ShowAll, SetWindow, InterpolateImage,
    ShowRadiological, ShowOwnPlanes, LinkZoom, UseLightTheme, SetLabelOpacity, ChooseColouring, SpaceGlyphs, SeekFrame,
    LookAt, ShowFinding, MoveInGuide, ShowGuide, ShowModels, SetPicture,
    // dialogs
    ShowFileDialog, ShowKeys, CloseDialog, DismissNotice, EnterFolder, MoveInFiles, SelectFile, TypeFileName,
    ShowAllFiles, NameFolder, MakeFolder, AcceptFile, AcceptReplacement, ChooseOtherName, SetStackSpacing, AskToDiscard,
    ShowRecovery, DiscardCase, Quit,
    // the study and its model
    OpenStudy, NewStudy, SaveStudyAs, SetStudyTemplate, OpenPhantomStudy, CancelStudyFile, ExportModel,
    ExportEvaluation, ExportPlots, ExportSizes, ExportLandmarkTable, ShowDistance, CompareObservers, CancelObservers,
    ExportObservers, ChooseShapesFolder, ExportShapes, StartEvaluation, CancelEvaluation, AddCases, AddScans,
    FitWaiting, CancelWorklist, OpenNextCase, OpenCaseOfStudy, SelectCase, SelectNextCase, RemoveCase, SetCaseState,
    CycleCaseState, TypeCaseText, SetCaseText, FlipCases, AddFrames, FilterCases, SortCases, LookFromSideInGallery,
    ShowAllShapes, TurnGallery, PanGallery, LetGoOfGallery, ZoomGallery, PointAtVertex, PinVertex, ShowGalleryGlyphs,
    SpaceGalleryGlyphs, ShowMean, ShowSample, ShowSelectedShape, SetMode, AnimateMode, ShowAllModes, ShowDifference,
    CompareGroup, ChooseAlignment, StartOptimisation, CancelOptimisation, ShowOptimised, DiscardOptimised>;

/// Whether a type stands in the list.
template <class One, class List>
constexpr bool stands_in = false;
template <class One, class... Listed>
constexpr bool stands_in<One, std::variant<Listed...>> = (std::is_same_v<One, Listed> || ...);

/// Commands in the order they were given. What knows the whole list is in outbox.cpp alone: a panel that sends a few
/// commands would take three times as long to compile.
class Outbox {
 public:
  /// Takes a command, or a Command that holds one.
  template <class One>
  void send(One command) {
    static_assert(stands_in<One, Command> || std::is_same_v<One, Command>);
    if constexpr (std::is_same_v<One, Command>)
      add(std::move(command));
    else
      add_one(std::move(command));
  }
  void apply(Action action, bool joined = false);
  void preview(std::optional<Action> action);
  bool empty() const;
  std::vector<Command> take();

 private:
  void add(Command command);
  void add_one(std::any command);
  std::vector<Command> commands_;
};

}  // namespace homolog
