#include <cmath>

#include "app/editor/interface/interface.h"
#include "app/editor/panels/models/models_panel.h"
#include "app/editor/state/icons.h"
#include "app/editor/state/views.h"
#include "app/editor/update/tools/tool.h"
#include "app/editor/update/window_title.h"
#include "app/editor/widgets/key_focus.h"
#include "app/editor/widgets/widgets.h"

namespace homolog {

namespace {

void same_line(const UiContext& ui, float units) {
  ImGui::SameLine(0, ui.theme.px(units));
}

void draw_show_toggles(const UiContext& ui, Outbox& out) {
  struct Item {
    const char* glyph;
    const char* tip;
    bool ShownParts::*part;
  };
  static constexpr std::array<Item, 6> items{{
      {icon::outline, "Outlines of the mesh in the slices (O)", &ShownParts::outline},
      {icon::surface, "Surface in the 3D view", &ShownParts::surface},
      {icon::wireframe, "Triangles on the surface", &ShownParts::wireframe},
      {icon::glyphs, "Glyphs: balls on some vertices, in the vertex's hue", &ShownParts::glyphs},
      {icon::planes, "Slices in the 3D view (T): seen through, behind the surface, cutting it, off",
       &ShownParts::planes},
      {icon::crosshair, "Cross-hair (X); Shift with the mouse moves it", &ShownParts::crosshair},
  }};
  for (const Item& item : items) {
    const bool shown = ui.state.preferences.show.*item.part;
    if (icon_button(ui.theme, item.glyph, item.tip, item.tip, {}, shown, 28)) {
      ShownParts parts = ui.state.preferences.show;
      const bool planes = item.part == &ShownParts::planes;
      parts.*item.part = !(parts.*item.part);
      out.send(ShowParts{planes ? with_next_planes(ui.state.preferences.show) : parts});
    }
    same_line(ui, 2);
  }
}

/// The steps that can be done again, the last of them first, and those that can be taken back: a click goes there.
void draw_history_menu(const UiContext& ui, Outbox& out) {
  if (!begin_menu(ui.theme, "history")) return;
  const auto& undo = ui.snapshot().undo_names;
  const auto& redo = ui.snapshot().redo_names;
  const int back = static_cast<int>(undo.size()), on = static_cast<int>(redo.size());
  const auto item = [&](const std::string& text, int steps, const char* tip) {
    ImGui::PushID(steps);
    if (menu_item(ui.theme, text.c_str(), nullptr, tip)) out.send(GoInHistory{steps});
    ImGui::PopID();
  };
  for (int k = on; k > 0; --k)
    item("Redo: " + redo[static_cast<std::size_t>(k) - 1], k, "Does this step again, and all before it");
  if (on > 0 && back > 0) menu_line();
  for (int k = 1; k <= back; ++k)
    item("Undo: " + undo[static_cast<std::size_t>(k) - 1], -k, "Takes back this step, and all after it");
  end_menu(ui.theme);
}

void draw_history_buttons(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const auto& undo = ui.snapshot().undo_names;
  const auto& redo = ui.snapshot().redo_names;
  const bool fits = ui.work.fitter.busy() || ui.work.propagator.busy();
  if (icon_button(theme, icon::undo, "undo",
                  fits           ? "Stop the fit (Ctrl+Z)"
                  : undo.empty() ? "Undo (Ctrl+Z)"
                                 : "Undo: " + undo.front() + " (Ctrl+Z)",
                  undo.empty() && !fits ? "Nothing to undo." : "", false, 28)) {
    if (fits)
      out.send(CancelFits{});
    else
      out.apply(Undo{});
  }
  same_line(ui, 2);
  if (icon_button(theme, icon::redo, "redo",
                  redo.empty() ? "Redo (Ctrl+Shift+Z)" : "Redo: " + redo.front() + " (Ctrl+Shift+Z)",
                  redo.empty() ? "Nothing to redo." : "", false, 28))
    out.apply(Redo{});
  same_line(ui, 2);
  if (icon_button(theme, icon::down_angle, "history", "The last steps: choose the one to go back to",
                  undo.empty() && redo.empty() ? "Nothing was done yet." : "", false, 28))
    open_menu("history");
  ImGui::SetNextWindowPos({ImGui::GetItemRectMin().x, ImGui::GetItemRectMax().y + theme.px(4)});
  draw_history_menu(ui, out);
}

}  // namespace

void draw_top_bar(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  begin_region("top bar", ui.layout.top_bar, palette::surface, theme.px(8));
  draw_mode_switch(ui, out);
  same_line(ui, 12);
  if (icon_button(theme, icon::open, "open", "Open an image, a case, a template or a template set (Ctrl+O)", {}, false,
                  28))
    out.send(ShowFileDialog{FilePurpose::open, {}});
  same_line(ui, 2);
  if (icon_button(theme, icon::save, "save", "Save the case (Ctrl+S)", {}, false, 28)) out.send(SaveCase{});
  same_line(ui, 12);
  draw_history_buttons(ui, out);

  const RectPx& bar = ui.layout.top_bar;
  const float toggles = 6 * theme.px(30) + 3 * theme.px(30) + theme.px(16);
  const float beside = std::max(toggles, theme.px(320));  // the switch and the file buttons
  ImGui::PushFont(theme.strong);
  const std::string whole = case_title(ui.snapshot());
  const std::string title = shortened(whole, bar.width - 2 * (beside + theme.px(16)));
  const ImVec2 size = ImGui::CalcTextSize(title.c_str());
  const ImVec2 title_at{std::floor((bar.width - size.x) / 2), std::floor((bar.height - size.y) / 2)};
  text_at(*ImGui::GetWindowDrawList(), title_at, palette::text, title);
  ImGui::PopFont();
  if (title != whole && size.x > 0) {
    const OutOfKeysReach nothing_to_press;
    ImGui::SetCursorScreenPos(title_at);
    area(theme, "title", size, whole);
  }

  ImGui::SetCursorPos({bar.width - toggles - theme.px(8), theme.px(8)});
  draw_show_toggles(ui, out);
  same_line(ui, 12);
  if (icon_button(theme, icon::everything, "fit", "Everything in view (F)", {}, false, 28)) out.send(ShowAll{});
  same_line(ui, 2);
  if (icon_button(theme, icon::keys, "keys", "Keys and mouse (F1)", {}, false, 28)) out.send(ShowKeys{});
  same_line(ui, 2);
  if (icon_button(theme, icon::panel, "panel", "Side panel", {}, ui.state.preferences.panel_open, 28))
    out.send(ShowPanel{!ui.state.preferences.panel_open});
  end_region();
}

void draw_tool_strip(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  begin_region("tool strip", ui.layout.tool_strip, palette::surface, theme.px(4));
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, theme.px(4)});
  for (const ToolKind* kind : tool_kinds) {
    if (kind->glyph[0] == '\0') continue;
    const std::string refusal = kind->needs_image ? ui.needs_volume() : ui.needs_shape();
    if (icon_button(theme, kind->glyph, kind->name, kind->tip, refusal, ui.state.hand.tool == kind->tool, 40))
      out.send(ChooseTool{kind->tool});
    if (kind->ends_group) gap(theme, 4);
  }
  ImGui::PopStyleVar();
  end_region();
}

}  // namespace homolog
