#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/editor/state/open_request.h"
#include "app/editor/state/state.h"
#include "app/editor/update/commands/logged.h"
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

struct CloseLabels {
  static constexpr const char* key = "close labels";
  void run(Editing& editing) const;
};
/// Shows another layer of the label map, counted from 0.
struct ShowLabelsLayer {
  static constexpr const char* key = "show label layer";
  std::size_t layer = 0;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
/// The label map, which holds one frame, belongs to another frame of the cine.
struct SetLabelsFrame {
  static constexpr const char* key = "set labels frame";
  int frame = 0;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
struct CancelOpening {
  static constexpr const char* key = "cancel opening";
  static constexpr bool cancels = true;
  static constexpr Logged logged = Logged::never;
  void run(Editing& editing) const;
};
/// Gives up the reading of files for the case.
struct CancelReading {
  static constexpr const char* key = "cancel reading";
  static constexpr bool cancels = true;
  static constexpr Logged logged = Logged::never;
  void run(Editing& editing) const;
};
struct CancelWriting {
  static constexpr const char* key = "cancel writing";
  static constexpr bool cancels = true;
  static constexpr Logged logged = Logged::never;
  std::filesystem::path path;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
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
struct ImportLandmarks : FileCommand {
  static constexpr const char* key = "import landmarks";
  static constexpr Logged logged = Logged::when_done;
  void run(Editing& editing) const;
};
/// Reads the shape model that fits may keep to.
struct OpenFitModel : FileCommand {
  static constexpr const char* key = "open fit model";
  static constexpr Logged logged = Logged::when_done;
  void run(Editing& editing) const;
};
/// Reads the model that the shown mesh is scored against.
struct OpenScoreModel : FileCommand {
  static constexpr const char* key = "open score model";
  static constexpr Logged logged = Logged::when_done;
  void run(Editing& editing) const;
};
/// Takes every vertex's stiffness factor from a mesh file with the same vertices.
struct ImportStiffness : FileCommand {
  static constexpr const char* key = "import stiffness";
  static constexpr Logged logged = Logged::when_done;
  void run(Editing& editing) const;
};
/// Names points of the template after a landmark file in the template's own frame.
struct ImportTemplateLandmarks : FileCommand {
  static constexpr const char* key = "import template landmarks";
  static constexpr Logged logged = Logged::when_done;
  void run(Editing& editing) const;
};

}  // namespace homolog
