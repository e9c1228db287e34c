#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace homolog {

/// What a path is wanted for; decides the title, the kinds of files shown, and whether the name may be new.
enum class FilePurpose {
  open,
  open_template,
  open_labels,
  open_landmarks,
  open_stiffness,
  open_template_landmarks,
  open_study,
  open_study_template,
  add_shapes,
  save_case,
  export_mesh,
  export_label_map,
  export_landmarks,
  export_template,
  export_template_landmarks,
  use_made_template,
  export_picture,
  new_study,
  save_study,
  export_model,
  export_measures,
  export_plots,
  export_shapes  ///< a new folder
};

/// A folder as the file dialog shows it. Free of any interface.
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

  FilePurpose purpose = FilePurpose::open;
  std::filesystem::path folder;
  std::vector<Entry> entries;       ///< all that the purpose shows: folders first, then by name
  std::vector<Place> places;        ///< home, working folder, roots of mounted media
  std::string name;                 ///< typed: filters when opening, the new file's name when saving
  int selected = -1;                ///< index into visible(); −1 nothing
  bool scroll_to_selected = false;  ///< the keyboard moved the selection
  bool show_all = false;            ///< also files of other kinds and hidden ones
  std::string error;                ///< why the folder cannot be read; empty where it can

  /// Indices of the entries that the typed name leaves: those that hold it, in any case.
  std::vector<int> visible() const;
};

FileBrowser browse(FilePurpose purpose, const std::filesystem::path& folder, std::string name = {});
/// Goes to another folder and reads it.
void enter_folder(FileBrowser& browser, const std::filesystem::path& folder);
void refresh(FileBrowser& browser);

enum class BrowserKey { up, down, page_up, page_down, parent };
/// Selects the entry at a place in visible(); when saving, a file's name becomes the name.
void select_entry(FileBrowser& browser, int index);
void press_key(FileBrowser& browser, BrowserKey key);

/// What accepting gives: a chosen path, or nothing where a folder was entered instead (or nothing is chosen).
/// When saving, only the typed name counts (choosing a file copies its name), and the purpose's extension is added
/// where it has none that fits.
std::optional<std::filesystem::path> accept(FileBrowser& browser);

/// The files that the typed name leaves, for a purpose that takes several.
std::vector<std::filesystem::path> visible_files(const FileBrowser& browser);

bool saves(FilePurpose purpose);
const char* purpose_title(FilePurpose purpose);
/// The last parts of names that fit, with dot, the default first.
const std::vector<std::string>& purpose_extensions(FilePurpose purpose);

}  // namespace homolog
