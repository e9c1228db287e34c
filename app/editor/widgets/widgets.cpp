#include "app/editor/widgets/widgets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "app/editor/state/icons.h"
#include "app/editor/widgets/drawn_items.h"
#include "app/editor/widgets/imgui_context.h"
#include "app/editor/widgets/room.h"

// ImGui's building blocks of controls (SliderBehavior, TempInputScalar) are declared here only.
#include <imgui_internal.h>
#include <imgui_stdlib.h>

namespace homolog {

namespace {

using Kind = DrawnItem::Kind;

constexpr float row_units = 28, label_units = 108, value_units = 76;

/// Makes what follows disabled where there is a refusal; afterwards takes it down and gives the tip.
class Control {
 public:
  Control(const Theme& theme, const std::string& tip, const std::string& refusal)
      : theme_(theme), text_(refusal.empty() ? tip : refusal), disabled_(!refusal.empty()) {
    ImGui::BeginDisabled(disabled_);
  }
  ~Control() { ImGui::EndDisabled(); }
  Control(const Control&) = delete;
  Control& operator=(const Control&) = delete;
  /// `whole` is the label where it had to be shortened.
  void done(Kind kind, const std::string& label, const std::string& value = {}, const std::string& whole = {}) const {
    note_control(kind, label, value, text_);
    const std::string text = whole.empty() || text_.empty() ? whole + text_ : whole + "\n" + text_;
    if (!text.empty() && is_explained(ImGuiHoveredFlags_AllowWhenDisabled)) tooltip(theme_, text);
  }
  bool disabled() const { return disabled_; }

 private:
  const Theme& theme_;
  std::string text_;
  bool disabled_;
};

/// Takes down the label of the control that ImGui made last; `align` 0 at its left end, 0.5 in the middle.
void note_label(const std::string& text, float align, float inset_px = 0) {
  if (!notes_items()) return;
  const ImGuiContext& imgui = *ImGui::GetCurrentContext();
  if (imgui.CurrentWindow->SkipItems) return;
  const ImRect& box = imgui.LastItemData.Rect;
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  const ImVec2 low{box.Min.x + inset_px + (box.GetWidth() - 2 * inset_px - size.x) * align,
                   box.Min.y + (box.GetHeight() - size.y) / 2};
  ImRect clip = imgui.CurrentWindow->ClipRect;
  clip.Min.x = std::max(clip.Min.x, box.Min.x);
  clip.Max.x = std::min(clip.Max.x, box.Max.x);
  note_text(text, low, {low.x + size.x, low.y + size.y}, clip.Min, clip.Max);
}

const char* on_off(bool on) {
  return on ? "on" : "off";
}

ImU32 fill_of_item(ImU32 resting) {
  if (ImGui::IsItemActive()) return palette::pressed;
  return ImGui::IsItemHovered() ? palette::hovered : resting;
}

}  // namespace

Part::Part(const std::string& name, const char* of) {
  ImGui::PushID(name.c_str());
  enter_part(name, of);
}

Part::~Part() {
  leave_part();
  ImGui::PopID();
}

bool work_area(const Theme& theme, const std::string& at_rest, const std::optional<WorkShown>& running) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = available(), height = theme.px(36), cancel_width = theme.px(72);
  bool cancelled = false;
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {theme.px(8), theme.px(4)});
  ImGui::BeginGroup();
  if (running) {
    const float bar_width = width - cancel_width - theme.px(8);
    ImGui::PushFont(theme.small);
    text_line(shortened(format("%s: %.0f %%", running->what.c_str(), 100 * running->fraction), bar_width),
              palette::dim);
    ImGui::PopFont();
    ImGui::GetWindowDrawList()->PushClipRect({at.x, at.y}, {at.x + bar_width, at.y + height}, true);
    progress_bar(theme, running->fraction * static_cast<double>(bar_width / width));
    ImGui::GetWindowDrawList()->PopClipRect();
    ImGui::SetCursorScreenPos({at.x + width - cancel_width, at.y});
    cancelled = button(theme, "Cancel", running->cancel_tip, {}, cancel_width);
  } else {
    two_lines(theme, at_rest, palette::dim);
  }
  ImGui::EndGroup();
  ImGui::PopStyleVar();
  ImGui::SetCursorScreenPos(at);
  ImGui::Dummy({width, height});
  return cancelled;
}

bool section(const Theme& theme, const char* title, bool open, bool& toggled, const std::string& holds) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const ImVec2 size{available(), theme.px(36)};
  toggled = ImGui::InvisibleButton(title, size);
  note_control(Kind::section, title, on_off(open), {});
  const ImVec2 end{at.x + size.x, at.y + size.y};
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  draw.AddLine({at.x - theme.px(12), at.y}, {end.x + theme.px(12), at.y}, palette::line);
  const ImU32 colour = ImGui::IsItemHovered() ? palette::accent : palette::text;
  ImGui::PushFont(theme.strong);
  text_in(at, end, colour, title, 0);
  const float taken = ImGui::CalcTextSize(title).x + theme.px(16), chevron = theme.px(18);
  ImGui::PopFont();
  if (!open && !holds.empty()) {
    ImGui::PushFont(theme.small);
    text_in(at, {end.x - chevron, end.y}, palette::dim, shortened(holds, size.x - taken - chevron), 1);
    ImGui::PopFont();
  }
  text_in(at, end, palette::dim, open ? icon::down_angle : icon::right_angle, 1);
  return open;
}

bool button(const Theme& theme, const std::string& label, const std::string& tip, const ButtonOptions& options) {
  const Control control(theme, tip, options.refusal);
  const float width_px = options.width_px;
  const bool lit = options.primary && !control.disabled();
  if (lit) {
    ImGui::PushStyleColor(ImGuiCol_Button, palette::accent);
    ImGui::PushStyleColor(ImGuiCol_ButtonHovered, IM_COL32(0x7D, 0xC0, 0xFF, 255));
    ImGui::PushStyleColor(ImGuiCol_ButtonActive, IM_COL32(0x9A, 0xCF, 0xFF, 255));
    ImGui::PushStyleColor(ImGuiCol_Text, palette::on_accent);
  }
  const float side = theme.px(4);
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {width_px > 0 ? side : ImGui::GetStyle().FramePadding.x, 0});
  const std::string whole = label.substr(0, label.find("##"));
  const std::string shown = width_px > 0 ? shortened(whole, width_px - 2 * side) : whole;
  look_for_letters(whole);
  const bool pressed =
      ImGui::Button((shown == whole ? label : shown + "###" + label).c_str(), {width_px, theme.px(row_units)});
  ImGui::PopStyleVar();
  if (lit) ImGui::PopStyleColor(4);
  note_label(shown, 0.5f);
  control.done(Kind::button, label, {}, shown == whole ? std::string() : whole);
  if (lit) key_focus().prefer_last();
  return pressed;
}

bool icon_button(const Theme& theme, const char* glyph, const char* id, const std::string& tip,
                 const std::string& refusal, bool selected, float size_units) {
  const Control control(theme, tip, refusal);
  const float side = theme.px(size_units);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const bool pressed = ImGui::InvisibleButton(id, {side, side});
  const ImVec2 end{at.x + side, at.y + side};
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const ImU32 fill = selected ? with_alpha(palette::accent, 0.18f) : fill_of_item(IM_COL32_BLACK_TRANS);
  if (fill != IM_COL32_BLACK_TRANS) draw.AddRectFilled(at, end, fill, theme.px(4));
  ImFont* font = size_units >= 36 ? theme.icons : theme.body;
  ImGui::PushFont(font);
  const ImU32 colour = control.disabled() ? palette::faint : selected ? palette::accent : palette::text;
  text_in(at, end, colour, glyph, 0.5f);
  ImGui::PopFont();
  control.done(Kind::button, id, on_off(selected));
  return pressed;
}

bool toggle(const Theme& theme, const char* label, bool& value, const std::string& tip, const std::string& refusal) {
  const Control control(theme, tip, refusal);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const ImVec2 size{available(), theme.px(24)};
  const bool turned = ImGui::InvisibleButton(label, size);
  if (turned) value = !value;
  const ImVec2 end{at.x + size.x, at.y + size.y};
  const float width = theme.px(28), height = theme.px(16), middle = at.y + size.y / 2;
  const ImVec2 low{end.x - width, middle - height / 2}, high{end.x, middle + height / 2};
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const ImU32 track = value ? palette::accent : palette::pressed;
  draw.AddRectFilled(low, high, control.disabled() ? with_alpha(track, 0.35f) : track, height / 2);
  const float knob = height / 2 - theme.px(3);
  draw.AddCircleFilled({value ? high.x - height / 2 : low.x + height / 2, middle}, knob,
                       value ? palette::on_accent : palette::dim);
  const ImU32 colour = control.disabled() ? palette::faint : ImGui::IsItemHovered() ? palette::accent : palette::text;
  text_in(at, end, colour, label, 0);
  control.done(Kind::toggle, label, on_off(value));
  return turned;
}

bool choice(const Theme& theme, const char* id, const std::vector<std::string>& labels, int& chosen,
            const ChoiceOptions& options) {
  const int before = chosen;
  const Part part(id);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = available(), height = theme.px(row_units);
  // In as many rows as the longest label asks for.
  float widest = 1;
  for (const std::string& label : labels) widest = std::max(widest, ImGui::CalcTextSize(label.c_str()).x + theme.px(8));
  const auto fitting = std::max<std::size_t>(1, static_cast<std::size_t>(width / widest));
  const std::size_t rows = (labels.size() + fitting - 1) / fitting, columns = (labels.size() + rows - 1) / rows;
  const float column_width = width / static_cast<float>(columns);
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  draw.AddRectFilled(at, {at.x + width, at.y + height * static_cast<float>(rows)}, palette::raised, theme.px(4));
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, ImGui::GetStyle().ItemSpacing.y});
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const auto index = static_cast<int>(i);
    const auto& [tips, refusal, refusals] = options;
    const bool refused = refusal.empty() && i < refusals.size();
    const Control control(theme, i < tips.size() ? tips[i] : std::string(), refused ? refusals[i] : refusal);
    const auto column = static_cast<float>(i % columns);
    const ImVec2 low{std::round(at.x + column_width * column), at.y + height * static_cast<float>(i / columns)};
    const ImVec2 high{std::round(at.x + column_width * (column + 1)), low.y + height};
    ImGui::SetCursorScreenPos(low);
    if (ImGui::InvisibleButton(labels[i].c_str(), {high.x - low.x, height})) chosen = index;
    const bool lit = index == before;
    if (lit) draw.AddRectFilled(low, high, with_alpha(palette::accent, 0.22f), theme.px(4));
    if (lit) draw.AddRect(low, high, with_alpha(palette::accent, 0.7f), theme.px(4));
    const ImU32 colour = control.disabled()       ? palette::faint
                         : lit                    ? palette::text
                         : ImGui::IsItemHovered() ? palette::text
                                                  : palette::dim;
    const std::string shown = shortened(labels[i], high.x - low.x - theme.px(4));
    text_in(low, high, colour, shown, 0.5f);
    control.done(Kind::choice, labels[i], on_off(lit), shown == labels[i] ? std::string() : labels[i]);
  }
  ImGui::PopStyleVar();
  return chosen != before;
}

bool slider(const Theme& theme, const char* label, double& value, const SliderRange& range, const std::string& tip,
            bool& released, const std::string& refusal) {
  const Control control(theme, tip, refusal);
  const Part part(label);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = available(), height = theme.px(24);
  const float value_width = theme.px(value_units);
  const float label_width = std::min(static_cast<float>(theme.px(label_units)), std::floor(0.4f * width));
  text_in(at, {at.x + label_width, at.y + height}, control.disabled() ? palette::faint : palette::text,
          shortened(label, label_width - theme.px(4)), 0);

  const ImRect track({at.x + label_width, at.y}, {at.x + width - value_width - theme.px(8), at.y + height});
  ImGui::SetCursorScreenPos(track.Min);
  ImGui::InvisibleButton("track", track.GetSize());
  const ImGuiID id = ImGui::GetItemID();
  ImRect grab;
  const ImGuiSliderFlags flags = range.logarithmic ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None;
  double slid = std::clamp(value, range.low, range.high);
  bool changed = !control.disabled() && ImGui::SliderBehavior(track, id, ImGuiDataType_Double, &slid, &range.low,
                                                              &range.high, range.format, flags, &grab);
  if (changed) value = slid;
  released = ImGui::IsItemDeactivated();
  control.done(Kind::track, "track");
  const float middle = track.GetCenter().y, knob_x = grab.GetCenter().x, radius = theme.px(6);
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const bool live = !control.disabled();
  const float half = theme.px(3) / 2;
  draw.AddRectFilled({track.Min.x, middle - half}, {track.Max.x, middle + half}, palette::pressed, half);
  if (live) {
    draw.AddRectFilled({track.Min.x, middle - half}, {knob_x, middle + half}, palette::accent, half);
    const bool lit = ImGui::IsItemActive() || ImGui::IsItemHovered();
    draw.AddCircleFilled({knob_x, middle}, radius, lit ? IM_COL32_WHITE : palette::text);
  }
  ImGui::SetCursorScreenPos({at.x + width - value_width, at.y});
  bool typed = false;
  const double per_px = (range.high - range.low) / 400;
  if (number_field(theme, "value", value, typed,
                   {.per_px = per_px,
                    .format = range.format,
                    .unit = range.unit,
                    .width_px = value_width,
                    .tip = tip,
                    .limits = {.low = range.low, .high = range.high, .name = label, .whole = range.whole}}))
    changed = true;
  released = released || typed;
  return changed;
}

bool text_field(const Theme& theme, const char* name, std::string& text, const char* hint, float width_px,
                float height_units) {
  const float side = theme.px(height_units > 24 ? 8 : 6);
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {side, (theme.px(height_units) - ImGui::GetFontSize()) / 2});
  ImGui::SetNextItemWidth(width_px);
  ImGui::PushID(name);
  const std::string shown = shortened(hint, width_px - 2 * side);
  look_for_letters(text);
  const bool changed = ImGui::InputTextWithHint("##field", shown.c_str(), &text);
  ImGui::PopID();
  ImGui::PopStyleVar();
  if (text.empty()) note_label(shown, 0, side);
  note_control(Kind::field, name, text, hint);
  return changed;
}

bool enter_pressed() {
  // IsKeyPressed() counts keys as the window system does.
  const auto pressed = [](ImGuiKey key) { return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key)); };
  return ImGui::IsItemDeactivated() && (pressed(ImGuiKey_Enter) || pressed(ImGuiKey_KeyPadEnter));
}

bool field_left() {
  return ImGui::IsItemDeactivatedAfterEdit();
}

void slider_ends(const Theme& theme, const char* low, const char* high) {
  // As slider() lies: between its label and its number.
  ImGui::PushFont(theme.small);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = available(), height = ImGui::GetFontSize() + theme.px(2);
  const float left = std::min(static_cast<float>(theme.px(label_units)), std::floor(0.4f * width));
  const float right = width - theme.px(value_units) - theme.px(8);
  const float y = at.y - theme.px(6);
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  text_at(draw, {at.x + left, y}, palette::dim, low);
  text_at(draw, {at.x + right - ImGui::CalcTextSize(high).x, y}, palette::dim, high);
  ImGui::PopFont();
  ImGui::Dummy({width, height - theme.px(6)});
}

}  // namespace homolog
