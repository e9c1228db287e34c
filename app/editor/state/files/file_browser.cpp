#include "app/editor/state/files/file_browser.h"

#include <algorithm>

#include "core/base/text/text.h"

namespace homolog {

namespace fs = std::filesystem;

std::vector<int> FileBrowser::visible() const {
  const std::string wanted = kind.saves ? std::string() : lower_case(filter());
  std::vector<int> result;
  for (std::size_t i = 0; i < entries.size(); ++i)
    if (wanted.empty() || lower_case(entries[i].name).find(wanted) != std::string::npos)
      result.push_back(static_cast<int>(i));
  return result;
}

std::vector<fs::path> chosen_files(const FileBrowser& browser) {
  std::vector<fs::path> files;
  for (const int index : browser.visible()) {
    const auto& entry = browser.entries[index];
    if (browser.together.contains(entry.name)) files.push_back(browser.listed_folder() / entry.name);
  }
  return files;
}

std::vector<fs::path> visible_files(const FileBrowser& browser) {
  std::vector<fs::path> files;
  for (const int index : browser.visible()) {
    const auto& entry = browser.entries[index];
    if (!entry.folder) files.push_back(browser.listed_folder() / entry.name);
  }
  return files;
}

bool FileBrowser::is_chosen(int index) const {
  if (together.empty()) return index == selected;
  const auto shown = visible();
  return together.contains(entries[shown[index]].name);
}

void select_entry(FileBrowser& browser, int index, Choosing how) {
  const auto shown = browser.visible();
  const int count = static_cast<int>(shown.size());
  if (index < 0 || index >= count) return;
  const auto at = [&](int k) -> const FileBrowser::Entry& { return browser.entries[shown[k]]; };
  const int before = browser.selected < count ? browser.selected : -1;
  browser.selected = index;
  if (browser.kind.saves && !at(index).folder) {
    browser.folder = browser.listed_folder();
    browser.typed_folder.clear();
    browser.name = at(index).name;
  }
  auto& together = browser.together;
  if (how == Choosing::alone || before < 0) {
    together.clear();
    return;
  }
  if (together.empty() && !at(before).folder) together.insert(at(before).name);
  if (how == Choosing::up_to) {
    for (int k = std::min(before, index); k <= std::max(before, index); ++k)
      if (!at(k).folder) together.insert(at(k).name);
  } else if (!at(index).folder && !together.insert(at(index).name).second) {
    together.erase(at(index).name);
  }
}

}  // namespace homolog
