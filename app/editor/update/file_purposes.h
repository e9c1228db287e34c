#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/editor/state/files/file_browser.h"
#include "app/editor/update/commands.h"

namespace homolog {

/// All that the program knows of a purpose of files.
struct FilePurposeKind {
  FilePurpose purpose;
  const char* name;   ///< its name in the log
  const char* title;  ///< the dialog's title
  FileKind files;
  Command (*command)(const std::filesystem::path& chosen, const EditorState& state);
  /// For several files at once; null where one is wanted.
  Command (*command_of_several)(const std::vector<std::filesystem::path>& chosen) = nullptr;
};

const FilePurposeKind& file_purpose(FilePurpose purpose);
/// By its name in the log; none where there is none of that name.
std::optional<FilePurpose> purpose_of(const std::string& name);

/// Whether an export can write the meshes of several frames.
bool has_several_meshes(const Structure* structure);
/// "heart-frame-07.ply": what the file of one frame is called where `chosen` is "heart.ply". `last`: the last frame.
std::filesystem::path file_of_frame(FilePurpose purpose, const std::filesystem::path& chosen, int frame, int last);
/// The files written where `chosen` is accepted for a purpose: itself, or a file for each frame.
std::vector<std::filesystem::path> files_written(FilePurpose purpose, const std::filesystem::path& chosen,
                                                 const EditorState& state, const Document& document);

}  // namespace homolog
