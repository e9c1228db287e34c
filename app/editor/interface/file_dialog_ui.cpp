#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>

#include "app/editor/interface/dialog_frame.h"
#include "app/editor/state/icons.h"
#include "app/editor/update/file_purposes.h"
#include "app/editor/widgets/key_focus.h"
#include "app/editor/widgets/widgets.h"
#include "core/base/text/listed.h"

namespace homolog {

namespace {

std::string size_text(std::uintmax_t bytes) {
  const auto value = static_cast<double>(bytes);
  if (value < 1e3) return format("%.0f B", value);
  if (value < 1e6) return format("%.0f kB", value / 1e3);
  if (value < 1e9) return format("%.1f MB", value / 1e6);
  return format("%.2f GB", value / 1e9);
}

std::string date_text(std::filesystem::file_time_type changed) {
  const auto on_system = std::chrono::file_clock::to_sys(changed);
  const std::time_t seconds = std::chrono::system_clock::to_time_t(on_system);
  std::tm local{};
  localtime_r(&seconds, &local);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M", &local);
  return text.data();
}

/// What a row shows, from left to right.
struct RowTexts {
  const char* glyph;
  std::string text, middle, right;
};

AreaState row(const Theme& theme, const RowTexts& texts, bool selected, const std::string& tip = {},
              const std::vector<std::string>& names = {}) {
  const auto& [glyph, text, middle, right] = texts;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const ImVec2 size{ImGui::GetContentRegionAvail().x, theme.px(26)};
  const ImVec2 end{at.x + size.x, at.y + size.y};
  const float right_width = theme.px(92), middle_width = theme.px(140);
  const float text_end = middle.empty() && right.empty() ? end.x : end.x - right_width - middle_width;
  const std::string shown = shortened_among(text, names, text_end - at.x - theme.px(36));
  const AreaState state = area(theme, "row", size, tip.empty() && shown != text ? text : tip, {selected});
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  if (selected || state.hovered)
    draw.AddRectFilled(at, end, selected ? with_alpha(palette::accent, 0.25f) : palette::raised, theme.px(4));
  const float y = at.y + (size.y - ImGui::GetFontSize()) / 2;
  text_at(draw, {at.x + theme.px(8), y}, palette::dim, glyph);
  text_at(draw, {at.x + theme.px(32), y}, palette::text, shown);
  text_at(draw, {end.x - right_width - middle_width + theme.px(8), y}, palette::dim, middle);
  text_at(draw, {end.x - theme.px(8) - ImGui::CalcTextSize(right.c_str()).x, y}, palette::dim, right);
  return state;
}

void draw_places(const UiContext& ui, const FileDialog& dialog, Outbox& out) {
  const Theme& theme = ui.theme;
  const FileBrowser& browser = dialog.browser;
  caption(theme, "Places");
  for (const auto& place : browser.places) {
    const Part part(place.path.string(), "place");
    if (row(theme, {icon::folder, place.name, "", ""}, place.path == browser.listed_folder()).clicked)
      out.send(EnterFolder{place.path});
  }
  const bool studies = dialog.purpose == FilePurpose::open_study || dialog.purpose == FilePurpose::open_observer;
  const auto& recent = studies ? ui.state.preferences.recent_studies : ui.state.preferences.recent;
  if ((dialog.purpose != FilePurpose::open && !studies) || recent.empty()) return;
  gap(theme, 8);
  caption(theme, "Recent");
  std::vector<std::string> names;
  for (const auto& path : recent) names.push_back(studies ? study_name(path) : path.filename().string());
  for (const auto& path : recent) {
    const Part part("recent " + path.string(), "recent file");
    const std::string name = studies ? study_name(path) : path.filename().string();
    if (row(theme, {icon::history, name, "", ""}, false, path.string(), names).clicked) {
      out.send(file_purpose(dialog.purpose).command(path, ui.state));
      out.send(CloseDialog{});
    }
  }
}

/// ": .ply, .vtk or .stl"; empty where anything goes.
std::string endings_of(const FileKind& kind) {
  return kind.extensions.empty() ? std::string() : ": " + listed(kind.extensions, " or ");
}

/// What a click with the keys that are held chooses.
Choosing choosing_now() {
  const ImGuiIO& io = ImGui::GetIO();
  return io.KeyShift ? Choosing::up_to : io.KeyCtrl ? Choosing::also : Choosing::alone;
}

void draw_entries(const UiContext& ui, const FileBrowser& browser, Outbox& out) {
  const Theme& theme = ui.theme;
  const OutOfKeysReach has_the_arrows;
  const auto visible = browser.visible();
  if (!browser.error.empty()) return explanation(theme, browser.error);
  const bool is_path = browser.name.find('/') != std::string::npos;
  if (is_path && browser.typed_folder.empty() && !browser.kind.saves)
    return explanation(theme, "There is no folder " + std::filesystem::path(browser.name).parent_path().string() + ".");
  if (visible.empty())
    return explanation(theme, browser.entries.empty()
                                  ? "No file of the right kind is here" + endings_of(browser.kind) + "."
                                  : "No match.");
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(visible.size()), theme.px(26));
  while (clipper.Step()) {
    for (int shown = clipper.DisplayStart; shown < clipper.DisplayEnd; ++shown) {
      const auto& entry = browser.entries[visible[shown]];
      const Part part(entry.name, "file");
      const auto state = row(theme,
                             {entry.folder ? icon::folder : icon::file, entry.name, date_text(entry.changed),
                              entry.folder ? std::string() : size_text(entry.bytes)},
                             browser.is_chosen(shown));
      if (state.clicked) out.send(SelectFile{shown, choosing_now()});
      if (state.doubled && choosing_now() == Choosing::alone) out.send(AcceptFile{});
    }
  }
  if (browser.selected >= 0 && browser.scroll_to_selected)
    ImGui::SetScrollY(
        std::max(0.0f, theme.px(26) * static_cast<float>(browser.selected) - ImGui::GetWindowHeight() / 2));
}

void draw_path_bar(const UiContext& ui, const FileBrowser& browser, Outbox& out) {
  const Theme& theme = ui.theme;
  if (icon_button(theme, icon::up, "up", "The folder above (Backspace)",
                  browser.listed_folder().has_relative_path() ? "" : "This is the topmost folder.", false, 28))
    out.send(MoveInFiles{BrowserKey::parent});
  ImGui::SameLine(0, theme.px(8));
  const float width = ImGui::GetContentRegionAvail().x, make_width = theme.px(112);
  const float room = width - make_width - theme.px(8), left = ImGui::GetCursorPosX();
  if (browser.new_folder) {
    std::string name = *browser.new_folder;
    if (name.empty()) ImGui::SetKeyboardFocusHere();
    if (text_field(theme, "new folder", name, "Name of the new folder (Enter)", room, 28)) out.send(NameFolder{name});
    if (enter_pressed()) out.send(MakeFolder{});
  } else {
    ImGui::AlignTextToFramePadding();
    text_line(shortened(browser.listed_folder().string(), room), palette::dim);
  }
  ImGui::SameLine(left + room + theme.px(8));
  const bool typed = browser.new_folder && !browser.new_folder->empty();
  if (button(theme, typed ? "Make it" : "New folder", "Makes a folder in this one, and goes there", {}, make_width)) {
    if (typed)
      out.send(MakeFolder{});
    else
      out.send(NameFolder{std::string()});
  }
}

std::string refusal_of(const FileBrowser& browser) {
  if (browser.selected >= 0 || !browser.name.empty()) return {};
  return browser.kind.saves ? "Type a name first." : "Choose a file first.";
}

/// Whether a folder of the list is chosen, so that accepting goes there.
bool enters_folder(const FileBrowser& browser) {
  const auto shown = browser.visible();
  const auto at = static_cast<std::size_t>(browser.selected);
  return browser.selected >= 0 && at < shown.size() && browser.entries[shown[at]].folder;
}

/// The button that opens, saves or adds what is chosen.
void draw_accept(const UiContext& ui, const FileDialog& dialog, Outbox& out) {
  const Theme& theme = ui.theme;
  const FileBrowser& browser = dialog.browser;
  const bool opens_folder = dialog.purpose == FilePurpose::open && browser.selected < 0 && browser.name.empty();
  const std::size_t together = chosen_files(browser).size();
  const char* verb = browser.kind.saves                                                                      ? "Save"
                     : dialog.purpose == FilePurpose::add_shapes || dialog.purpose == FilePurpose::add_scans ? "Add"
                                                                                                             : "Open";
  const std::string label = together > 1             ? format("%s %zu", verb, together)
                            : enters_folder(browser) ? "Open"
                            : opens_folder           ? "Open folder"
                                                     : verb;
  if (button(theme, label,
             opens_folder             ? "Open this folder as a DICOM series"
             : enters_folder(browser) ? "Goes to the chosen folder (Enter)"
                                      : "Enter",
             ButtonOptions{.refusal = opens_folder ? std::string() : refusal_of(browser),
                           .width_px = theme.px(96),
                           .primary = true})) {
    if (opens_folder) {
      out.send(OpenFiles{{browser.folder}});
      out.send(CloseDialog{});
    } else {
      out.send(AcceptFile{});
    }
  }
}

/// The last row: how several are chosen, and which files are listed.
void draw_list_options(const UiContext& ui, const FileDialog& dialog, Outbox& out) {
  const Theme& theme = ui.theme;
  bool all = dialog.browser.show_all;
  const bool takes_several = file_purpose(dialog.purpose).command_of_several != nullptr;
  if (takes_several) {
    const float y = ImGui::GetCursorPosY();
    ImGui::SetCursorPosY(y + std::floor((theme.px(24) - ImGui::GetFontSize()) / 2));
    text_line("Ctrl or Shift with a click chooses several files.", palette::dim);
    ImGui::SameLine(ImGui::GetWindowWidth() - theme.px(260));
    ImGui::SetCursorPosY(y);
  }
  if (toggle(theme, "All files, also hidden ones", all, "Shows files of other kinds too")) out.send(ShowAllFiles{all});
}

}  // namespace

void draw_file_dialog(const UiContext& ui, const FileDialog& dialog, Outbox& out) {
  const Theme& theme = ui.theme;
  const FileBrowser& browser = dialog.browser;
  if (!begin_dialog(ui, file_purpose(dialog.purpose).title, 860, 580)) out.send(CloseDialog{});
  draw_path_bar(ui, browser, out);
  // A gap, two rows, and what ImGui puts between all of them.
  const float footer = theme.px(2) + theme.px(28) + theme.px(24) + 4 * ImGui::GetStyle().ItemSpacing.y + theme.px(8);
  ImGui::BeginChild("places", {theme.px(180), -footer});
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, 0});
  draw_places(ui, dialog, out);
  ImGui::PopStyleVar();
  ImGui::EndChild();
  ImGui::SameLine(0, theme.px(12));
  ImGui::BeginChild("entries", {0, -footer});
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, 0});
  draw_entries(ui, browser, out);
  ImGui::PopStyleVar();
  ImGui::EndChild();
  gap(theme, 2);

  const bool saving = browser.kind.saves;
  const bool adds_all = dialog.purpose == FilePurpose::add_shapes;
  const float buttons = theme.px(96) * 2 + theme.px(8) + (adds_all ? theme.px(132) : 0);
  const float room = ImGui::GetContentRegionAvail().x - buttons - theme.px(12);
  std::string name = browser.name;
  // The field has the keyboard from the start: typing filters (or names) at once.
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  text_field(theme, "name", name, saving ? "Name" : "Type to filter, or a path", room, 28);
  const bool entered = enter_pressed();
  if (entered) ImGui::SetKeyboardFocusHere(-1);
  if (name != browser.name) out.send(TypeFileName{name});
  if (entered) out.send(AcceptFile{});
  ImGui::SameLine(0, theme.px(12));
  if (button(theme, "Cancel", "Escape", {}, theme.px(96))) out.send(CloseDialog{});
  ImGui::SameLine(0, theme.px(8));
  if (adds_all) {
    const auto files = visible_files(browser);
    if (button(theme, format("Add all %zu", files.size()),
               "Adds all files in the list. Type part of a name to list fewer",
               files.empty() ? "The list holds no shape." : "", theme.px(124))) {
      out.send(AddCases{files});
      out.send(CloseDialog{});
    }
    ImGui::SameLine(0, theme.px(8));
  }
  draw_accept(ui, dialog, out);
  draw_list_options(ui, dialog, out);
  end_dialog();
}

}  // namespace homolog
