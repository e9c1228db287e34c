#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace homolog {

/// Which files a dialog is for.
struct FileKind {
  bool saves = false;                   ///< the name may be new
  std::vector<std::string> extensions;  ///< last parts of names that fit, with dot, the default first
  bool any_volume = false;              ///< DICOM files too, which often have no extension that tells
};

/// A folder as the file dialog shows it. It is read by app/editor/work/files/file_browsing.h.
struct FileBrowser {
  struct Entry {
    std::string name;  ///< UTF-8
    bool folder = false;
    std::uintmax_t bytes = 0;
    std::filesystem::file_time_type changed;
  };
  struct Place {
    std::string name;
    std::filesystem::path path;
  };

  FileKind kind;
  std::filesystem::path folder;           ///< the dialog's folder; a name that is typed is meant from here
  std::filesystem::path typed_folder;     ///< the folder listed instead while a path into it is typed; else empty
  std::vector<Entry> entries;             ///< all that fit: folders first, then by name
  std::vector<Place> places;              ///< home, working folder, roots of mounted media
  std::string name;                       ///< typed: filters when opening, the new file's name when saving
  int selected = -1;                      ///< index into visible(); −1 nothing
  std::set<std::string> together;         ///< names of the files that are chosen together; empty: only `selected` is
  bool scroll_to_selected = false;        ///< the keyboard moved the selection
  bool show_all = false;                  ///< also files of other kinds and hidden ones
  std::string error;                      ///< why the folder cannot be read; empty where it can
  std::optional<std::string> new_folder;  ///< the name that is being typed of a folder to make; else none

  /// The folder whose entries are listed.
  const std::filesystem::path& listed_folder() const { return typed_folder.empty() ? folder : typed_folder; }
  /// The part of the typed name that the entries are filtered by: of a path what is behind its last "/".
  std::string filter() const { return name.substr(name.rfind('/') + 1); }
  /// Indices of the entries that the filter leaves: those that hold it, in any case.
  std::vector<int> visible() const;
  /// Whether the entry at a place in visible() is chosen, alone or with others.
  bool is_chosen(int index) const;
};

enum class BrowserKey { up, down, page_up, page_down, parent };
/// How a click chooses, where several files may be taken: in place of all, one more or one less (Ctrl), or all from the
/// one that was clicked last (Shift).
enum class Choosing { alone, also, up_to };
/// Selects the entry at a place in visible(); when saving, a file's name becomes the name.
void select_entry(FileBrowser& browser, int index, Choosing how = Choosing::alone);

/// The files that are chosen together, in the order of the list; none where one alone is chosen.
std::vector<std::filesystem::path> chosen_files(const FileBrowser& browser);

/// The files that the typed name leaves, for dialogs that take several.
std::vector<std::filesystem::path> visible_files(const FileBrowser& browser);

}  // namespace homolog
