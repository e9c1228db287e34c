#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/editor/state/open_request.h"
#include "app/editor/state/state.h"
#include "app/editor/update/commands/logged.h"
#include "app/editor/update/commands/looks/setting.h"
#include "app/editor/update/results/imports.h"
#include "core/phantom/phantom.h"

namespace homolog {

class Fields;
struct Editing;

// Files that are opened, read into the case, and written.

/// Opens cases, volumes and templates, told apart by their content.
struct OpenFiles {
  static constexpr const char* key = "open files";
  static constexpr Logged logged = Logged::never;  ///< OpenRequested is
  std::vector<std::filesystem::path> paths;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
/// The command that the commands to open something come down to.
struct OpenRequested {
  static constexpr const char* key = "open";
  static constexpr Logged logged = Logged::when_done;
  OpenRequest request;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
OpenRequested open_case_file(const std::filesystem::path& file);
/// A path, or the name of a built-in template.
OpenRequested open_template(const std::string& source);
OpenRequested open_labels(const std::filesystem::path& file);
OpenRequested open_phantom(Organ organ, int subject);

void close_labels(Editing& editing);
using CloseLabels = PlainEditingCall<"close labels", close_labels>;
/// Shows another layer of the label map, counted from 0.
struct ShowLabelsLayer {
  static constexpr const char* key = "show label layer";
  std::size_t layer = 0;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
/// The label map, which holds one frame, belongs to another frame of the cine.
void set_labels_frame(Editing& editing, int frame);
using SetLabelsFrame = EditingCall<"set labels frame", "frame", set_labels_frame>;
void cancel_opening(Editing& editing);
using CancelOpening = PlainEditingCallLogged<Logged::never, "cancel opening", cancel_opening>;
/// Gives up the reading of files for the case.
void cancel_reading(Editing& editing);
using CancelReading = PlainEditingCallLogged<Logged::never, "cancel reading", cancel_reading>;
void cancel_writing(Editing& editing, const std::filesystem::path& path);
using CancelWriting = EditingCallLogged<Logged::never, "cancel writing", "path", cancel_writing>;
/// Says where the case is kept; where it has no name yet, or another is wanted, asks for one.
struct SaveCase {
  static constexpr const char* key = "save case";
  static constexpr Logged logged = Logged::never;
  bool as = false;
  void spell(Fields& line);
  void run(Editing& editing) const;
};

/// A command whose only member is a file.
struct FileCommand {
  std::filesystem::path path;
  void spell(Fields& line);
};
struct SaveCaseAs : FileCommand {
  static constexpr const char* key = "save case as";
  void run(Editing& editing) const;
};
/// Places the landmarks of a file whose names are the template's.
using ImportLandmarks = EditingCallLogged<Logged::when_done, "import landmarks", "path", import_landmarks>;
/// Reads the shape model that fits may keep to.
using OpenFitModel = EditingCallLogged<Logged::when_done, "open fit model", "path", open_fit_model>;
/// Reads the model that the shown mesh is scored against.
using OpenScoreModel = EditingCallLogged<Logged::when_done, "open score model", "path", open_score_model>;
/// Takes every vertex's stiffness factor from a mesh file with the same vertices.
using ImportStiffness = EditingCallLogged<Logged::when_done, "import stiffness", "path", import_stiffness>;
/// Names points of the template after a landmark file in the template's own frame.
using ImportTemplateLandmarks =
    EditingCallLogged<Logged::when_done, "import template landmarks", "path", import_template_landmarks>;

}  // namespace homolog
