#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "app/editor/state/state.h"
#include "core/case/action.h"
#include "core/phantom/phantom.h"

namespace homolog {

// What the interface asks the editor to do; nothing is done while it draws.

/// A change of what the editor remembers.
struct ChangeState {
  std::function<void(EditorState&)> change;
};
/// Shows what an action would give; nullopt ends the preview.
struct PreviewEdit {
  std::optional<Action> action;
};
struct ApplyEdit {
  Action action;
  bool joined = false;  ///< undone together with the edit before it
};
/// Snaps the mesh, or a part of it, to the image, as the settings say.
struct SnapMesh {
  std::optional<SnapRegion> region;
  bool joined = false;  ///< undone together with the edit before it
};
struct CancelSnap {};
/// Opens cases, volumes and templates, told apart by their content.
struct OpenFiles {
  std::vector<std::filesystem::path> paths;
};
/// A request that lacked something, completed.
struct OpenRequested {
  OpenRequest request;
};
struct OpenPhantom {
  Organ organ = Organ::kidney;
  int subject = 1;
};
/// A path, or "built-in:kidney".
struct OpenTemplate {
  std::string source;
};
struct OpenLabels {
  std::filesystem::path path;
};
struct CloseLabels {};
struct CancelOpening {};
/// Of files that are read for the case.
struct CancelReading {};
/// Of a study that is read, or of a case that is made for it.
struct CancelStudyFile {
  std::string subject;
};
struct CancelWriting {
  std::filesystem::path path;
};
/// Says where the case is kept; where it has no name yet, or another is wanted, asks for one.
struct SaveCase {
  bool as = false;
};
struct SaveCaseAs {
  std::filesystem::path path;
};
struct ExportMesh {
  std::filesystem::path path;
};
struct ExportLabelMap {
  std::filesystem::path path;
};
/// Places the landmarks of a file whose names are the template's.
struct ImportLandmarks {
  std::filesystem::path path;
};
struct ExportLandmarks {
  std::filesystem::path path;
};
/// The template as it is painted, with its regions and landmarks.
struct ExportTemplate {
  std::filesystem::path path;
};
/// Takes every vertex's stiffness factor from a mesh file with the same vertices.
struct ImportStiffness {
  std::filesystem::path path;
};
/// Names points of the template after a landmark file in the template's own frame.
struct ImportTemplateLandmarks {
  std::filesystem::path path;
};
struct ExportTemplateLandmarks {
  std::filesystem::path path;
};
/// Makes a template of the label map that is shown, as the settings say.
struct MakeTemplate {};
struct CancelTemplate {};
struct UndoTemplate {};         ///< goes back to the one made before
struct CloseTemplateMaking {};  ///< shows the case's mesh again
struct UseMadeTemplate {        ///< writes it and starts anew with it
  std::filesystem::path path;
};
/// Fits the shown frame's template to the label map that is shown, as the settings say.
struct StartFit {};
/// Moves vertices along the mesh's own surface; see refine.
struct RefineLandmarks {};
/// Of a fit or a refinement.
struct CancelFit {};
/// Blends what the study's model expects into the shape, 0…1: now and after every stroke; as a preview, or as an edit.
struct BlendModel {
  double strength = 0;
  bool commit = false;
};
/// Lets the study's model complete what the edit before it left open. Undone together with that edit.
struct CompleteByModel {};
struct ExportPicture {
  std::filesystem::path path;
  PictureOptions options;
};
struct RecoverCase {
  std::filesystem::path path;
};
/// Lists the cases that were never saved.
struct ShowRecovery {};
struct DiscardCase {
  std::filesystem::path path;
};
/// Does what the file dialog's choice is for.
struct AcceptFileDialog {};
struct AcceptReplacement {};
/// Commits the frame that a slider went to.
struct ShowFrame {
  int frame = 0;
};
/// Plays a cine, or stops and commits the frame that is shown.
struct PlayFrames {
  bool play = true;
};
struct FitViews {};
struct Quit {
  bool sure = false;           ///< an unsaved case is not asked about again
  bool without_study = false;  ///< nor a study that could not be written
};

using Command =
    std::variant<ChangeState, PreviewEdit, ApplyEdit, SnapMesh, CancelSnap, OpenFiles, OpenRequested, OpenPhantom,
                 OpenTemplate, OpenLabels, CloseLabels, CancelOpening, CancelReading, CancelStudyFile, CancelWriting,
                 SaveCase, SaveCaseAs, ExportMesh, ExportLabelMap, ImportLandmarks, ExportLandmarks, ExportTemplate,
                 ImportStiffness, ImportTemplateLandmarks, ExportTemplateLandmarks, MakeTemplate, CancelTemplate,
                 UndoTemplate, CloseTemplateMaking, UseMadeTemplate, StartFit, RefineLandmarks, CancelFit, BlendModel,
                 CompleteByModel, ExportPicture, ShowRecovery, RecoverCase, DiscardCase, AcceptFileDialog,
                 AcceptReplacement, ShowFrame, PlayFrames, FitViews, Quit, ModelsCommand>;

/// Commands in the order they were given.
class Outbox {
 public:
  void send(Command command) { commands_.push_back(std::move(command)); }
  void change(std::function<void(EditorState&)> change) { send(ChangeState{std::move(change)}); }
  void apply(Action action, bool joined = false) { send(ApplyEdit{std::move(action), joined}); }
  void preview(std::optional<Action> action) { send(PreviewEdit{std::move(action)}); }
  bool empty() const { return commands_.empty(); }
  std::vector<Command> take() { return std::exchange(commands_, {}); }

 private:
  std::vector<Command> commands_;
};

}  // namespace homolog
