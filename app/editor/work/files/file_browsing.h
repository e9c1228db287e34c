#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "app/editor/state/files/file_browser.h"

namespace homolog {

// The file dialog on the disk: it reads folders, and makes some.

/// Whether a person would look for files in a folder: it is there, and none of those in which the program keeps its
/// own.
bool is_for_people(const std::filesystem::path& folder);

FileBrowser browse(FileKind kind, const std::filesystem::path& folder, std::string name = {});
/// Goes to another folder and reads it.
void enter_folder(FileBrowser& browser, const std::filesystem::path& folder);
void refresh(FileBrowser& browser);
/// Takes a name as it is typed: filters the list when opening. If a path is typed, its folder is listed, if there is
/// such a one.
void type_name(FileBrowser& browser, const std::string& name);
/// Makes the folder whose name was typed in the one that is shown, and goes there; says in `error` where that fails.
void make_typed_folder(FileBrowser& browser);

/// `extends`: the selection grows by the files on the way.
void press_key(FileBrowser& browser, BrowserKey key, bool extends = false);

/// The result of accepting: a chosen path, or nothing where a folder was entered instead (or nothing is chosen).
/// When saving, only the typed name counts (choosing a file copies its name), and the kind's extension is added
/// where it has none that fits.
std::optional<std::filesystem::path> accept(FileBrowser& browser);

}  // namespace homolog
