#include "app/editor/work/files/file_browsing.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <system_error>
#include <utility>

#include "core/base/text/text.h"
#include "core/session/unsaved_cases.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

bool has_extension(const std::string& name, const std::string& extension) {
  const std::string low = lower_case(name);
  return low.size() > extension.size() && low.ends_with(extension);
}

bool has_one_of(const std::string& name, const std::vector<std::string>& extensions) {
  return std::any_of(extensions.begin(), extensions.end(), [&](const auto& e) { return has_extension(name, e); });
}

bool fits(const std::string& name, const FileKind& kind) {
  if (has_one_of(name, kind.extensions)) return true;
  // DICOM files often have no extension at all, or end in a number of their UID.
  const std::string last = fs::path(name).extension().string();
  return kind.any_volume && (last.empty() || (last.size() > 1 && std::isdigit(static_cast<unsigned char>(last[1]))));
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

bool is_for_people(const fs::path& folder) {
  std::error_code ignored;
  if (folder.empty() || !fs::is_directory(folder, ignored)) return false;
  const fs::path hidden = unsaved_folder();
  return std::mismatch(hidden.begin(), hidden.end(), folder.begin(), folder.end()).first != hidden.end();
}

FileBrowser browse(FileKind kind, const fs::path& folder, std::string name) {
  FileBrowser browser;
  browser.kind = std::move(kind);
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
  browser.typed_folder.clear();
  browser.name = browser.kind.saves ? browser.filter() : std::string();
  refresh(browser);
}

void type_name(FileBrowser& browser, const std::string& name) {
  browser.name = name;
  browser.together.clear();
  const fs::path before = browser.listed_folder();
  fs::path typed = (browser.folder / fs::path(name).parent_path()).lexically_normal();
  if (typed.has_relative_path() && !typed.has_filename()) typed = typed.parent_path();  // ends in "/"
  std::error_code error;
  const bool is_path = name.find('/') != std::string::npos;
  browser.typed_folder = is_path && fs::is_directory(typed, error) ? typed : fs::path();
  if (browser.listed_folder() != before) refresh(browser);
  browser.selected = -1;
  const std::string wanted = browser.filter();
  if (browser.kind.saves || wanted.empty()) return;
  // The file of just that name, where there is one; else the first that holds it.
  const auto shown = browser.visible();
  const auto exact =
      std::find_if(shown.begin(), shown.end(), [&](int index) { return browser.entries[index].name == wanted; });
  browser.selected = exact == shown.end() ? 0 : static_cast<int>(exact - shown.begin());
}

void make_typed_folder(FileBrowser& browser) {
  const std::string name = std::exchange(browser.new_folder, std::nullopt).value_or("");
  if (name.empty()) return;
  std::error_code error;
  const fs::path folder = browser.listed_folder() / name;
  fs::create_directory(folder, error);
  if (error)
    browser.error = "The folder " + name + " cannot be made (" + error.message() + "); choose another name or place.";
  else
    enter_folder(browser, folder);
}

void refresh(FileBrowser& browser) {
  browser.entries.clear();
  browser.selected = -1;
  browser.together.clear();
  browser.error.clear();
  std::error_code error;
  fs::directory_iterator entry(browser.listed_folder(), error);
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
    if (!browser.show_all && (item.name.starts_with('.') || (!item.folder && !fits(item.name, browser.kind)))) continue;
    if (!item.folder) item.bytes = entry->file_size(ignored);
    item.changed = entry->last_write_time(ignored);
    browser.entries.push_back(std::move(item));
  }
  std::sort(browser.entries.begin(), browser.entries.end(), [](const auto& a, const auto& b) {
    return a.folder != b.folder ? a.folder : lower_case(a.name) < lower_case(b.name);
  });
}

void press_key(FileBrowser& browser, BrowserKey key, bool extends) {
  constexpr int page = 10;
  browser.scroll_to_selected = true;
  const int count = static_cast<int>(browser.visible().size());
  const auto select = [&](int index) {
    const Choosing how = extends ? Choosing::up_to : Choosing::alone;
    if (count > 0) select_entry(browser, std::clamp(index, 0, count - 1), how);
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
      if (browser.listed_folder().has_relative_path()) enter_folder(browser, browser.listed_folder().parent_path());
      return;
  }
}

std::optional<fs::path> accept(FileBrowser& browser) {
  const auto shown = browser.visible();
  const bool chosen = browser.selected >= 0 && browser.selected < static_cast<int>(shown.size());
  if (chosen) {
    const auto& entry = browser.entries[shown[browser.selected]];
    if (entry.folder) {
      enter_folder(browser, browser.listed_folder() / entry.name);
      return std::nullopt;
    }
    if (!browser.kind.saves) return browser.listed_folder() / entry.name;
  }
  if (browser.name.empty()) return std::nullopt;
  const fs::path typed = fs::path(browser.name).is_absolute() ? fs::path(browser.name) : browser.folder / browser.name;
  std::error_code error;
  if (fs::is_directory(typed, error)) {
    if (browser.kind.saves) browser.name.clear();
    enter_folder(browser, typed.lexically_normal());
    return std::nullopt;
  }
  if (!browser.kind.saves) return fs::exists(typed, error) ? std::optional(typed) : std::nullopt;
  const auto& extensions = browser.kind.extensions;
  return has_one_of(typed.string(), extensions) || extensions.empty() ? typed
                                                                      : fs::path(typed.string() + extensions.front());
}

}  // namespace homolog
