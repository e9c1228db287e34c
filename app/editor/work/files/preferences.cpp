#include "app/editor/work/files/preferences.h"

#include <algorithm>
#include <cstdlib>

#include "core/base/encoding/json.h"
#include "core/base/files/files.h"

namespace homolog {

namespace {

using nlohmann::json;

/// Visits every entry by its name, for reading and for writing alike; but not the files and folders. It names all
/// members: a new one does not compile before it is kept too.
template <class Value, class Visit>
void each_entry(Value& preferences, Visit visit) {
  auto& [window_width, window_height, panel_open, sections_open, radiological, linear, linked_zoom, light, show, hints,
         told_unsaved, guide_done, recent, recent_studies, folder] = preferences;
  auto& [outline, surface, planes, glyphs, wireframe, crosshair, letters, label_surface, plane_look] = show;
  auto& [dragged, scrolled, turned_camera] = hints;
  visit("window_width", window_width);
  visit("window_height", window_height);
  visit("panel_open", panel_open);
  visit("sections_open", sections_open);
  visit("radiological", radiological);
  visit("linear", linear);
  visit("show_outline", outline);
  visit("show_surface", surface);
  visit("show_planes", planes);
  visit("plane_look", plane_look);
  visit("show_label_surface", label_surface);
  visit("linked_zoom", linked_zoom);
  visit("light", light);
  visit("show_glyphs", glyphs);
  visit("show_wireframe", wireframe);
  visit("show_crosshair", crosshair);
  visit("show_letters", letters);
  visit("hint_dragged", dragged);
  visit("hint_scrolled", scrolled);
  visit("hint_turned", turned_camera);
  visit("guide_done", guide_done);
  visit("told_unsaved", told_unsaved);
}

}  // namespace

std::filesystem::path preferences_file() {
  std::filesystem::path folder;
  if (const char* config = std::getenv("XDG_CONFIG_HOME"); config != nullptr && config[0] != 0)
    folder = config;
  else
    folder = home_folder() / ".config";
  return folder / "homolog" / "editor.json";
}

Preferences read_preferences(const std::filesystem::path& path) {
  Preferences preferences;
  const auto text = read_whole_file(path, 1 << 20);
  const json kept = text ? read_json<json>(*text).value_or(json()) : json();
  if (!kept.is_object()) return preferences;
  // An entry of another kind (an older or newer version wrote it) is left at its default.
  each_entry(preferences, [&](const char* name, auto& value) {
    using Value = std::remove_reference_t<decltype(value)>;
    const auto found = kept.find(name);
    if (found == kept.end()) return;
    const json now = value;
    if (found->type() == now.type() || (found->is_number() && now.is_number())) {
      if (now.is_array() && found->size() != now.size()) return;
      try {
        value = found->get<Value>();
      } catch (const json::exception&) {
      }
    }
  });
  preferences.window_width = std::clamp(preferences.window_width, smallest_window_width, 16384);
  preferences.window_height = std::clamp(preferences.window_height, smallest_window_height, 16384);
  const int look = static_cast<int>(preferences.show.plane_look);
  if (look < 0 || look > static_cast<int>(PlaneLook::solid)) preferences.show.plane_look = PlaneLook::translucent;
  if (const auto folder = kept.find("folder"); folder != kept.end() && folder->is_string())
    preferences.folder = folder->get<std::string>();
  const auto read_list = [&](const char* name, std::vector<std::filesystem::path>& files) {
    const auto list = kept.find(name);
    if (list == kept.end() || !list->is_array()) return;
    for (const auto& entry : *list)
      if (entry.is_string()) files.emplace_back(entry.get<std::string>());
  };
  read_list("recent", preferences.recent);
  read_list("recent_studies", preferences.recent_studies);
  return preferences;
}

Result<void> write_preferences(const Preferences& preferences, const std::filesystem::path& path) {
  json kept;
  each_entry(preferences, [&](const char* name, const auto& value) { kept[name] = value; });
  kept["folder"] = preferences.folder.string();
  for (const auto& [name, files] :
       {std::pair("recent", &preferences.recent), std::pair("recent_studies", &preferences.recent_studies)}) {
    kept[name] = json::array();
    for (const auto& file : *files) kept[name].push_back(file.string());
  }
  // The names of the files last opened may be those of patients.
  if (auto made = make_folder(path.parent_path(), Readers::user_alone); !made) return made;
  // A path need not be UTF-8; what is not is replaced.
  return write_whole_file(path, kept.dump(2, ' ', false, json::error_handler_t::replace) + '\n', Readers::user_alone);
}

}  // namespace homolog
