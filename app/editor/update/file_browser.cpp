#include "app/editor/update/file_browser.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <system_error>

#include "core/base/text.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

bool has_extension(const std::string& name, const std::string& extension) {
  const std::string low = lower_case(name);
  return low.size() > extension.size() && low.ends_with(extension);
}

bool fits(const std::string& name, FilePurpose purpose) {
  const auto& extensions = purpose_extensions(purpose);
  if (std::any_of(extensions.begin(), extensions.end(), [&](const auto& e) { return has_extension(name, e); }))
    return true;
  // DICOM files often have no extension at all, or end in a number of their UID.
  const bool opens_volumes = purpose == FilePurpose::open || purpose == FilePurpose::open_labels;
  const std::string last = fs::path(name).extension().string();
  return opens_volumes && (last.empty() || (last.size() > 1 && std::isdigit(static_cast<unsigned char>(last[1]))));
}

std::vector<FileBrowser::Place> find_places() {
  std::vector<FileBrowser::Place> places;
  const auto add = [&](std::string name, const fs::path& path) {
    std::error_code error;
    if (!path.empty() && fs::is_directory(path, error)) places.push_back({std::move(name), path});
  };
  if (const char* home = std::getenv("HOME")) {
    add("Home", home);
    for (const char* folder : {"Desktop", "Documents", "Downloads"}) add(folder, fs::path(home) / folder);
  }
  std::error_code error;
  add("Working folder", fs::current_path(error));
  for (const char* mounts : {"/media", "/mnt"}) {
    fs::directory_iterator entry(mounts, fs::directory_options::skip_permission_denied, error);
    for (; !error && entry != fs::directory_iterator(); entry.increment(error))
      add(entry->path().filename().string(), entry->path());
  }
  add("Computer", "/");
  return places;
}

}  // namespace

bool saves(FilePurpose purpose) {
  return purpose >= FilePurpose::save_case;  // those that open come first
}

const char* purpose_title(FilePurpose purpose) {
  switch (purpose) {
    case FilePurpose::open:
      return "Open an image, a case or a template";
    case FilePurpose::open_template:
      return "Load a template mesh";
    case FilePurpose::open_labels:
      return "Load a label map as overlay";
    case FilePurpose::save_case:
      return "Save the case";
    case FilePurpose::open_landmarks:
      return "Import placed landmarks";
    case FilePurpose::export_landmarks:
      return "Export the placed landmarks";
    case FilePurpose::open_stiffness:
      return "Take stiffness factors from a mesh";
    case FilePurpose::open_template_landmarks:
      return "Import the template's landmarks";
    case FilePurpose::export_template_landmarks:
      return "Export the template's landmarks";
    case FilePurpose::export_template:
      return "Save the template";
    case FilePurpose::use_made_template:
      return "Save the new template";
    case FilePurpose::export_mesh:
      return "Export the mesh";
    case FilePurpose::export_label_map:
      return "Export the label map";
    case FilePurpose::export_picture:
      return "Save a picture";
    case FilePurpose::open_study:
      return "Open a study";
    case FilePurpose::add_shapes:
      return "Add shapes to the study";
    case FilePurpose::new_study:
      return "New study";
    case FilePurpose::save_study:
      return "Save the study as";
    case FilePurpose::export_model:
      return "Export the model";
    case FilePurpose::export_measures:
      return "Export the measures";
    case FilePurpose::export_plots:
      return "Save the plots";
    case FilePurpose::open_study_template:
      return "Set the study's template";
    case FilePurpose::export_shapes:
      return "Export the shapes into a new folder";
  }
  return "";
}

const std::vector<std::string>& purpose_extensions(FilePurpose purpose) {
  static const std::vector<std::string> meshes{".ply", ".vtk", ".vtp", ".obj", ".stl"};
  static const std::vector<std::string> volumes{".nii.gz", ".nii", ".hdr", ".img", ".nrrd", ".nhdr", ".mha",
                                                ".mhd",    ".dcm", ".ima", ".png", ".tif",  ".tiff"};
  static const std::vector<std::string> openable = [] {
    std::vector<std::string> all{".homolog"};
    all.insert(all.end(), volumes.begin(), volumes.end());
    all.insert(all.end(), meshes.begin(), meshes.end());
    return all;
  }();
  static const std::vector<std::string> cases{".homolog"};
  static const std::vector<std::string> exported_meshes{".ply", ".vtk", ".vtp", ".obj", ".stl", ".particles"};
  static const std::vector<std::string> label_maps{".nii.gz", ".nii", ".nrrd", ".mha"};
  static const std::vector<std::string> landmarks{".mrk.json", ".json"};
  static const std::vector<std::string> templates{".ply"};
  static const std::vector<std::string> pictures{".png"};
  static const std::vector<std::string> studies{".study.json"};
  static const std::vector<std::string> shapes{".ply", ".vtk", ".vtp", ".obj", ".particles", ".homolog"};
  static const std::vector<std::string> models{".h5.json", ".h5"};
  static const std::vector<std::string> tables{".csv", ".json"};
  static const std::vector<std::string> none;
  switch (purpose) {
    case FilePurpose::open:
      return openable;
    case FilePurpose::open_template:
    case FilePurpose::open_study_template:
      return meshes;
    case FilePurpose::open_labels:
      return volumes;
    case FilePurpose::save_case:
      return cases;
    case FilePurpose::open_landmarks:
    case FilePurpose::export_landmarks:
    case FilePurpose::open_template_landmarks:
    case FilePurpose::export_template_landmarks:
      return landmarks;
    case FilePurpose::open_stiffness:
    case FilePurpose::export_template:
    case FilePurpose::use_made_template:
      return templates;
    case FilePurpose::export_mesh:
      return exported_meshes;
    case FilePurpose::export_label_map:
      return label_maps;
    case FilePurpose::export_picture:
    case FilePurpose::export_plots:
      return pictures;
    case FilePurpose::open_study:
    case FilePurpose::new_study:
    case FilePurpose::save_study:
      return studies;
    case FilePurpose::add_shapes:
      return shapes;
    case FilePurpose::export_model:
      return models;
    case FilePurpose::export_measures:
      return tables;
    case FilePurpose::export_shapes:
      return none;
  }
  return cases;
}

std::vector<int> FileBrowser::visible() const {
  const std::string wanted = saves(purpose) ? std::string() : lower_case(name);
  std::vector<int> result;
  for (std::size_t i = 0; i < entries.size(); ++i)
    if (wanted.empty() || lower_case(entries[i].name).find(wanted) != std::string::npos)
      result.push_back(static_cast<int>(i));
  return result;
}

std::vector<fs::path> visible_files(const FileBrowser& browser) {
  std::vector<fs::path> files;
  for (const int index : browser.visible()) {
    const auto& entry = browser.entries[static_cast<std::size_t>(index)];
    if (!entry.folder) files.push_back(browser.folder / entry.name);
  }
  return files;
}

FileBrowser browse(FilePurpose purpose, const fs::path& folder, std::string name) {
  FileBrowser browser;
  browser.purpose = purpose;
  browser.places = find_places();
  browser.name = std::move(name);
  std::error_code error;
  fs::path start = folder;
  while (!start.empty() && !fs::is_directory(start, error) && start.has_relative_path()) start = start.parent_path();
  browser.folder = start.empty() ? fs::current_path(error) : start;
  refresh(browser);
  return browser;
}

void enter_folder(FileBrowser& browser, const fs::path& folder) {
  browser.folder = folder;
  if (!saves(browser.purpose)) browser.name.clear();
  refresh(browser);
}

void refresh(FileBrowser& browser) {
  browser.entries.clear();
  browser.selected = -1;
  browser.error.clear();
  std::error_code error;
  fs::directory_iterator entry(browser.folder, error);
  if (error) {
    browser.error = "This folder cannot be read (" + error.message() + "); choose another one.";
    return;
  }
  for (; entry != fs::directory_iterator(); entry.increment(error)) {
    if (error) break;
    FileBrowser::Entry item;
    item.name = entry->path().filename().string();
    std::error_code ignored;
    item.folder = entry->is_directory(ignored);
    if (!browser.show_all && (item.name.starts_with('.') || (!item.folder && !fits(item.name, browser.purpose))))
      continue;
    if (!item.folder) item.bytes = entry->file_size(ignored);
    item.changed = entry->last_write_time(ignored);
    browser.entries.push_back(std::move(item));
  }
  std::sort(browser.entries.begin(), browser.entries.end(), [](const auto& a, const auto& b) {
    return a.folder != b.folder ? a.folder : lower_case(a.name) < lower_case(b.name);
  });
}

void select_entry(FileBrowser& browser, int index) {
  browser.selected = index;
  const auto& entry = browser.entries[static_cast<std::size_t>(browser.visible()[static_cast<std::size_t>(index)])];
  if (saves(browser.purpose) && !entry.folder) browser.name = entry.name;
}

void press_key(FileBrowser& browser, BrowserKey key) {
  constexpr int page = 10;
  browser.scroll_to_selected = true;
  const int count = static_cast<int>(browser.visible().size());
  const auto select = [&](int index) {
    if (count > 0) select_entry(browser, std::clamp(index, 0, count - 1));
  };
  switch (key) {
    case BrowserKey::up:
      return select(browser.selected - 1);
    case BrowserKey::down:
      return select(browser.selected + 1);
    case BrowserKey::page_up:
      return select(browser.selected - page);
    case BrowserKey::page_down:
      return select(browser.selected + page);
    case BrowserKey::parent:
      if (browser.folder.has_relative_path()) enter_folder(browser, browser.folder.parent_path());
      return;
  }
}

std::optional<fs::path> accept(FileBrowser& browser) {
  const auto shown = browser.visible();
  const bool chosen = browser.selected >= 0 && browser.selected < static_cast<int>(shown.size());
  if (chosen) {
    const auto& entry = browser.entries[static_cast<std::size_t>(shown[static_cast<std::size_t>(browser.selected)])];
    if (entry.folder) {
      enter_folder(browser, browser.folder / entry.name);
      return std::nullopt;
    }
    if (!saves(browser.purpose)) return browser.folder / entry.name;
  }
  if (browser.name.empty()) return std::nullopt;
  const fs::path typed = fs::path(browser.name).is_absolute() ? fs::path(browser.name) : browser.folder / browser.name;
  std::error_code error;
  if (fs::is_directory(typed, error)) {
    if (saves(browser.purpose)) browser.name.clear();
    enter_folder(browser, typed.lexically_normal());
    return std::nullopt;
  }
  if (!saves(browser.purpose)) return fs::exists(typed, error) ? std::optional(typed) : std::nullopt;
  const auto& extensions = purpose_extensions(browser.purpose);
  const bool complete = std::any_of(extensions.begin(), extensions.end(),
                                    [&](const auto& e) { return has_extension(typed.string(), e); });
  return complete || extensions.empty() ? typed : fs::path(typed.string() + extensions.front());
}

}  // namespace homolog
