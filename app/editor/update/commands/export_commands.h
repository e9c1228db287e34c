#pragma once

#include "app/editor/update/commands/file_commands.h"

namespace homolog {

// The files that the case on the screen gives.

/// The mesh of the frame that is shown, or numbered files of all frames.
struct ExportMesh : FileCommand {
  static constexpr const char* key = "export mesh";
  bool all_frames = false;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
struct ExportLabelMap : FileCommand {
  static constexpr const char* key = "export label map";
  bool all_frames = false;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
/// One label map of all structures at the shown frame, with their names and colours.
struct ExportStructuresMap : FileCommand {
  static constexpr const char* key = "export map of structures";
  void run(Editing& editing) const;
};
/// The label map that is shown as the case's structures are now, with all else that it holds [map_of_case].
struct ExportMendedMap : FileCommand {
  static constexpr const char* key = "export mended map";
  void run(Editing& editing) const;
};
/// The meshes of all structures at the shown frame into a folder, each in a PLY of its name.
struct ExportStructuresMeshes : FileCommand {
  static constexpr const char* key = "export meshes of structures";
  void run(Editing& editing) const;
};
struct ExportLandmarks : FileCommand {
  static constexpr const char* key = "export landmarks";
  void run(Editing& editing) const;
};
/// The template as it is painted, with its regions and landmarks.
using ExportTemplate = EditingCall<"export template", "path", save_template>;
struct ExportTemplateLandmarks : FileCommand {
  static constexpr const char* key = "export template landmarks";
  void run(Editing& editing) const;
};
/// A picture, as the panel's options say.
struct ExportPicture : FileCommand {
  static constexpr const char* key = "export picture";
  void run(Editing& editing) const;
};
/// The volume of the mesh in every frame of the cine, as a table.
struct ExportVolumes : FileCommand {
  static constexpr const char* key = "export volumes";
  void run(Editing& editing) const;
};
/// Writes the measurements of the shown mesh as a table of one row, as `measure` does.
struct ExportMeasurements : FileCommand {
  static constexpr const char* key = "export measurements";
  void run(Editing& editing) const;
};

}  // namespace homolog
