#pragma once

#include <utility>
#include <variant>
#include <vector>

#include "app/editor/update/commands/case_commands.h"
#include "app/editor/update/commands/dialog_commands.h"
#include "app/editor/update/commands/file_commands.h"
#include "app/editor/update/commands/models_commands.h"
#include "app/editor/update/commands/optimise_commands.h"
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

/// Commands in the order they were given.
class Outbox {
 public:
  void send(Command command) { commands_.push_back(std::move(command)); }
  void apply(Action action, bool joined = false) { send(ApplyEdit{std::move(action), joined}); }
  void preview(std::optional<Action> action) { send(PreviewEdit{std::move(action)}); }
  bool empty() const { return commands_.empty(); }
  std::vector<Command> take() { return std::exchange(commands_, {}); }

 private:
  std::vector<Command> commands_;
};

}  // namespace homolog
