#include "app/editor/widgets/drawn_items.h"

#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <utility>

#include "app/editor/widgets/imgui_context.h"
#include "app/editor/widgets/noted_box.h"

namespace homolog {

namespace {

DrawnItems* taking_down() {
  return static_cast<DrawnItems*>(ImGui::GetIO().UserData);
}

RectPx rect_of(ImVec2 low, ImVec2 high) {
  return {low.x, low.y, std::max(high.x - low.x, 0.0f), std::max(high.y - low.y, 0.0f)};
}

/// Sets where an item lies, and what is seen of it.
void set_place(DrawnItem& item, ImVec2 low, ImVec2 high, ImVec2 clip_low, ImVec2 clip_high) {
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  const ImVec2 from{std::max(clip_low.x, 0.0f), std::max(clip_low.y, 0.0f)};
  const ImVec2 to{std::min(clip_high.x, display.x), std::min(clip_high.y, display.y)};
  item.rect = rect_of(low, high);
  item.clip = rect_of(from, to);
  item.seen =
      rect_of({std::max(low.x, from.x), std::max(low.y, from.y)}, {std::min(high.x, to.x), std::min(high.y, to.y)});
  if (item.seen.width <= 0 || item.seen.height <= 0) item.seen.width = item.seen.height = 0;
}

/// Whether a window, or one that it lies in, is longer than its room.
bool scrolls_in(const ImGuiWindow* window) {
  while (window != nullptr && window->ScrollMax.y <= 0)
    window = (window->Flags & ImGuiWindowFlags_ChildWindow) != 0 ? window->ParentWindow : nullptr;
  return window != nullptr;
}

/// Tells the tooltips of what they should not cover: of a control in front of which nothing lies.
void note_place(ImRect seen, const ImRect& clip) {
  seen.ClipWith(clip);
  if (ImGui::GetCurrentContext()->CurrentWindow->SkipItems || seen.GetWidth() < 1 || seen.GetHeight() < 1) return;
  controls_memory().controls.push_back({seen.Min.x, seen.Min.y, seen.GetWidth(), seen.GetHeight()});
}

/// Without icons, which are code points of private use, and without spaces at the ends.
std::string without_icons(const std::string& text) {
  std::string kept;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t length = lead < 0x80 ? 1 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
    const bool icon =
        lead == 0xEE || (lead == 0xEF && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xA4);
    if (!icon) kept += text.substr(i, length);
    i += length;
  }
  const auto begin = kept.find_first_not_of(' '), end = kept.find_last_not_of(' ');
  return begin == std::string::npos ? std::string() : kept.substr(begin, end - begin + 1);
}

/// What a person reads of ImGui's label.
std::string readable(const std::string& label) {
  return without_icons(label.substr(0, label.find("##")));
}

std::string joined(const std::vector<std::string>& parts, const std::string& name) {
  std::string path;
  for (const std::string& part : parts) path += part + "/";
  return path + name;
}

}  // namespace

DrawnItems::DrawnItems() {
  ImGui::GetIO().UserData = this;
}

DrawnItems::~DrawnItems() {
  ImGui::GetIO().UserData = nullptr;
}

bool notes_items() {
  return taking_down() != nullptr;
}

void enter_part(const std::string& name, const char* of) {
  DrawnItems* drawn = taking_down();
  if (drawn == nullptr) return;
  drawn->path_.push_back(name);
  drawn->pattern_.push_back(of != nullptr ? "<" + std::string(of) + ">" : name);
}

void leave_part() {
  DrawnItems* drawn = taking_down();
  if (drawn == nullptr || drawn->path_.empty()) return;
  drawn->path_.pop_back();
  drawn->pattern_.pop_back();
}

void note_item(DrawnItem item) {
  DrawnItems* drawn = taking_down();
  if (drawn == nullptr) return;
  const ImGuiWindow* window = ImGui::GetCurrentContext()->CurrentWindow;
  item.layer = window->RootWindow->ID;
  item.scrolls = scrolls_in(window);
  item.path = joined(drawn->path_, item.name);
  item.pattern = joined(drawn->pattern_, item.name);
  drawn->items_.push_back(std::move(item));
}

void note_control(DrawnItem::Kind kind, const std::string& label, const std::string& value, const std::string& tip) {
  const bool field = kind == DrawnItem::Kind::field, number = kind == DrawnItem::Kind::number;
  if (kind != DrawnItem::Kind::area)
    note_place(ImGui::GetCurrentContext()->LastItemData.Rect, ImGui::GetCurrentContext()->CurrentWindow->ClipRect);
  // A track has its number beside it; an area wants to know where it is clicked.
  if (kind != DrawnItem::Kind::track && kind != DrawnItem::Kind::area) key_focus().offer({field || number, number});
  if (!notes_items()) return;
  const ImGuiContext& imgui = *ImGui::GetCurrentContext();
  if (imgui.CurrentWindow->SkipItems) return;  // nothing of that window is drawn
  const ImRect& box = imgui.LastItemData.Rect;
  const ImRect& clip = imgui.CurrentWindow->ClipRect;
  DrawnItem item;
  item.kind = kind;
  item.name = readable(label);
  item.value = value;
  item.tip = tip;
  set_place(item, box.Min, box.Max, clip.Min, clip.Max);
  item.enabled = (imgui.LastItemData.InFlags & ImGuiItemFlags_Disabled) == 0;
  item.hovered = ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled);
  item.at_keys = key_focus().at_last_control();
  note_item(std::move(item));
}

void note_box(const NotedBox& box) {
  note_place({box.low, box.high}, {box.clip_low, box.clip_high});
  if (!notes_items()) return;
  DrawnItem item;
  item.kind = box.kind;
  item.name = readable(box.label);
  item.value = box.value;
  set_place(item, box.low, box.high, box.clip_low, box.clip_high);
  item.hovered = box.hovered;
  item.at_keys = box.at_keys;
  note_item(std::move(item));
}

void note_text(const std::string& text, ImVec2 low, ImVec2 high, ImVec2 clip_low, ImVec2 clip_high,
               DrawnItem::Kind kind) {
  if (!notes_items()) return;
  DrawnItem item;
  item.kind = kind;
  item.name = without_icons(text);
  if (item.name.empty()) return;
  set_place(item, low, high, clip_low, clip_high);
  note_item(std::move(item));
}

}  // namespace homolog
