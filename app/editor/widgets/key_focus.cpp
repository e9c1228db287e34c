#include "app/editor/widgets/key_focus.h"

#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "app/editor/widgets/imgui_context.h"
#include "app/editor/widgets/theme.h"

namespace homolog {

namespace {

using Way = KeyFocus::Way;

/// How far the way from one control to another is; none where the other does not lie that way.
std::optional<float> distance(const RectPx& from, const RectPx& to, Way way) {
  const bool along_x = way == Way::left || way == Way::right;
  const bool back = way == Way::left || way == Way::up;
  const auto low = [along_x](const RectPx& r) { return along_x ? r.x : r.y; };
  const auto size = [along_x](const RectPx& r) { return along_x ? r.width : r.height; };
  const auto side_low = [along_x](const RectPx& r) { return along_x ? r.y : r.x; };
  const auto side_size = [along_x](const RectPx& r) { return along_x ? r.height : r.width; };
  const float gap = back ? low(from) - (low(to) + size(to)) : low(to) - (low(from) + size(from));
  // Neighbours may overlap a little.
  if (gap < -0.5f * std::min(size(from), size(to))) return std::nullopt;
  const float beside = std::max(
      {side_low(to) - (side_low(from) + side_size(from)), side_low(from) - (side_low(to) + side_size(to)), 0.0f});
  // To the left and right only what lies in the same row.
  if (along_x && beside > 0) return std::nullopt;
  const float middles = std::abs(side_low(to) + side_size(to) / 2 - side_low(from) - side_size(from) / 2);
  return std::max(gap, 0.0f) + 2 * beside + 0.01f * middles;
}

void draw_mark(const ImRect& box, const ImRect& clip) {
  ImDrawList& draw = *ImGui::GetForegroundDrawList();
  constexpr float around = 4;
  draw.PushClipRect({clip.Min.x - around, clip.Min.y - around}, {clip.Max.x + around, clip.Max.y + around});
  const float rounding = ImGui::GetStyle().FrameRounding;
  // A line of the ground between the control and the mark: it is seen around a lit button too.
  for (const auto& [away, colour] : {std::pair(1.0f, palette::dialog), std::pair(3.0f, palette::accent)})
    draw.AddRect({box.Min.x - away, box.Min.y - away}, {box.Max.x + away, box.Max.y + away}, colour, rounding + away, 0,
                 2);
  draw.PopClipRect();
}

}  // namespace

KeyFocus& key_focus() {
  return controls_memory().keys;
}

KeyGroup::KeyGroup(const char* name) {
  key_focus().set_group(ImHashStr(name));
}

unsigned KeyFocus::layer() const {
  const auto& popups = ImGui::GetCurrentContext()->OpenPopupStack;
  if (!popups.empty()) return popups.back().Window != nullptr ? popups.back().Window->ID : 0;
  return dialog_ != 0 ? dialog_ : group_;
}

unsigned KeyFocus::focused() const {
  const auto found = at_.find(layer());
  return found == at_.end() ? 0 : found->second;
}

std::vector<KeyFocus::Stop> KeyFocus::stops() const {
  std::vector<Stop> all;
  std::ranges::copy_if(last_, std::back_inserter(all), [this](const Stop& one) { return one.group == layer(); });
  return all;
}

std::optional<KeyFocus::Stop> KeyFocus::stop() const {
  const auto found = std::ranges::find_if(last_, [this](const Stop& one) { return one.id == focused(); });
  return found == last_.end() || focused() == 0 ? std::nullopt : std::optional(*found);
}

void KeyFocus::go_to(const Stop& stop) {
  at_[layer()] = stop.id;
  place_ = stop.rect;
  speaks_ = scrolls_ = explains_ = true;
}

void KeyFocus::go_to_group(bool next) {
  if (in_front()) return;
  // From above to below, then from left to right; and the program's own keys.
  std::vector<Stop> groups;
  for (const Stop& one : last_)
    if (std::ranges::none_of(groups, [&](const Stop& other) { return other.group == one.group; }))
      groups.push_back(one);
  std::ranges::stable_sort(groups, [](const Stop& a, const Stop& b) {
    return std::pair(a.rect.y, a.rect.x) < std::pair(b.rect.y, b.rect.x);
  });
  const auto now = std::ranges::find_if(groups, [this](const Stop& one) { return one.group == group_; });
  const auto count = static_cast<std::ptrdiff_t>(groups.size()) + 1;
  const std::ptrdiff_t at = (now - groups.begin()) % count;  // the last is none of them
  const std::ptrdiff_t to = (at + (next ? 1 : -1) + count) % count;
  if (to == count - 1) return leave();
  group_ = groups[to].group;
  if (const auto before = stop())
    go_to(*before);
  else
    go_to(groups[to]);
}

void KeyFocus::go(Way way) {
  const std::vector<Stop> all = stops();
  if (all.empty()) return;
  const auto now = std::ranges::find_if(all, [this](const Stop& one) { return one.id == focused(); });
  if (now == all.end()) return go_to(way == Way::previous || way == Way::last ? all.back() : first_of(all));
  const auto index = now - all.begin(), count = static_cast<std::ptrdiff_t>(all.size());
  if (way == Way::first) return go_to(all.front());
  if (way == Way::last) return go_to(all.back());
  if (way == Way::next) return go_to(all[(index + 1) % count]);
  if (way == Way::previous) return go_to(all[(index + count - 1) % count]);
  const Stop* nearest = nullptr;
  float least = 0;
  for (const bool same_window : {true, false}) {
    for (const Stop& one : all) {
      if (one.id == now->id || (one.window == now->window) != same_window) continue;
      const auto far = distance(now->rect, one.rect, way);
      if (!far || (nearest != nullptr && *far >= least)) continue;
      nearest = &one;
      least = *far;
    }
    if (nearest != nullptr) return go_to(*nearest);
    // The rest of a long list is not drawn until it scrolls there.
    if (same_window && !again_) scroll_on(*now, way);
    if (again_) return;
  }
}

void KeyFocus::scroll_on(const Stop& from, Way way) {
  ImGuiWindow* window = ImGui::FindWindowByID(from.window);
  if (window == nullptr || (way != Way::up && way != Way::down)) return;
  const float to = std::clamp(window->Scroll.y + (way == Way::down ? from.rect.height : -from.rect.height), 0.0f,
                              window->ScrollMax.y);
  if (to == window->Scroll.y) return;
  ImGui::SetScrollY(window, to);
  again_ = way;
}

void KeyFocus::activate() {
  const auto now = stop();
  if (!now || !now->enabled) return;
  ImGui::ActivateItem(now->id);
  if (now->traits.typed) ImGui::GetCurrentContext()->NavNextActivateFlags = ImGuiActivateFlags_PreferInput;
}

bool KeyFocus::at_number() const {
  const auto now = stop();
  return now && now->traits.number;
}

void KeyFocus::leave_field(Way way) {
  const unsigned field = ImGui::GetActiveID();
  const auto found = std::ranges::find_if(last_, [field](const Stop& one) { return one.id == field; });
  leaves_field_ = true;
  if (found == last_.end()) return;
  if (!in_front()) group_ = found->group;
  at_[layer()] = field;
  go(way);
  const auto now = stop();
  types_next_ = now && now->traits.typed;
}

void KeyFocus::leave() {
  group_ = 0;
  at_.erase(layer());
  speaks_ = false;
}

void KeyFocus::begin_frame() {
  dialog_ = std::exchange(drawn_dialog_, 0U);
  text_ = std::exchange(drawn_text_, {});
  last_ = std::exchange(drawn_, {});
  if (std::exchange(leaves_field_, false)) {
    ImGui::ClearActiveID();
  } else if (std::exchange(types_next_, false)) {
    activate();
  }
  if (const auto way = std::exchange(again_, std::nullopt)) {
    again_ = way;  // not a second time
    go(*way);
    again_.reset();
  }
  find_lost();
}

/// Of a dialog the button that goes on with it, else what comes after the cross that closes it.
const KeyFocus::Stop& KeyFocus::first_of(const std::vector<Stop>& all) const {
  const auto preferred = std::ranges::find_if(all, [](const Stop& one) { return one.traits.preferred; });
  if (preferred != all.end()) return *preferred;
  return layer() == dialog_ && all.size() > 1 ? all[1] : all.front();
}

/// Where the reached control has gone, the nearest one takes its place; where the keys opened a menu or a dialog, they
/// reach what it is for.
void KeyFocus::find_lost() {
  if (layer() == 0 || stop() || !speaks_) return;
  const std::vector<Stop> all = stops();
  if (all.empty()) {
    if (!in_front()) leave();
    return;
  }
  if (in_front() && focused() == 0) {
    // A field has the keys already, or there is no choice; what was searched for is there to be chosen.
    if (ImGui::GetIO().WantTextInput || (all.size() == 1 && controls_memory().searched.empty())) return;
    go_to(first_of(all));
    explains_ = false;
    return;
  }
  const auto far = [this](const Stop& one) { return std::hypot(one.rect.x - place_.x, one.rect.y - place_.y); };
  go_to(*std::ranges::min_element(all, {}, far));
}

void KeyFocus::offer(const Traits& traits) {
  const ImRect& box = ImGui::GetCurrentContext()->LastItemData.Rect;
  offer(ImGui::GetItemID(), {box.Min.x, box.Min.y, box.GetWidth(), box.GetHeight()}, traits);
}

void KeyFocus::offer(unsigned id, const RectPx& rect, const Traits& traits) {
  const ImGuiContext& imgui = *ImGui::GetCurrentContext();
  ImGuiWindow* window = imgui.CurrentWindow;
  if (out_of_reach_ || window->SkipItems || id == 0) return;
  Stop stop;
  stop.id = id;
  stop.group = drawn_group_ != 0 ? drawn_group_ : window->RootWindow->ID;
  stop.window = window->ID;
  stop.rect = rect;
  stop.enabled = (imgui.CurrentItemFlags & ImGuiItemFlags_Disabled) == 0;
  stop.traits = traits;
  drawn_.push_back(stop);
  if (!marks(id)) return;
  place_ = rect;
  const ImRect box({rect.x, rect.y}, {rect.x + rect.width, rect.y + rect.height});
  if (std::exchange(scrolls_, false))
    ImGui::ScrollToRect(window, box, ImGuiScrollFlags_KeepVisibleEdgeX | ImGuiScrollFlags_KeepVisibleEdgeY);
  draw_mark(box, window->ClipRect);
}

void KeyFocus::prefer_last() {
  if (!drawn_.empty()) drawn_.back().traits.preferred = true;
}

bool KeyFocus::at_last_control() const {
  return marks(ImGui::GetItemID());
}

bool KeyFocus::marks(unsigned id) const {
  const bool typed_elsewhere = ImGui::GetIO().WantTextInput && ImGui::GetActiveID() != id;
  return speaks_ && id != 0 && id == focused() && !typed_elsewhere;
}

float KeyFocus::moved_px(float at_px) const {
  const ImGuiWindow& window = *ImGui::GetCurrentContext()->CurrentWindow;
  float nearest_px = FLT_MAX, moved = 0;
  for (const Stop& before : last_) {
    const float low = before.rect.y, high = low + before.rect.height;
    if (before.window != window.ID || high < window.InnerRect.Min.y || low > window.InnerRect.Max.y) continue;
    const float away_px = std::max({low - at_px, at_px - high, 0.0f});
    if (away_px >= nearest_px) continue;
    const auto now = std::ranges::find_if(drawn_, [&](const Stop& one) { return one.id == before.id; });
    if (now == drawn_.end()) continue;
    nearest_px = away_px;
    moved = now->rect.y - low;
  }
  return moved;
}

int KeyFocus::take_steps() {
  return at_last_control() ? std::exchange(steps_, 0) : 0;
}

void KeyFocus::mark_dialog() {
  drawn_dialog_ = ImGui::GetCurrentContext()->CurrentWindow->RootWindow->ID;
}

void KeyFocus::mark_text(float line_px) {
  drawn_text_ = {ImGui::GetCurrentContext()->CurrentWindow->ID, line_px};
}

bool KeyFocus::scroll_text(float lines, float pages) {
  ImGuiWindow* window = text_.window != 0 ? ImGui::FindWindowByID(text_.window) : nullptr;
  if (window == nullptr) return false;
  // Two keys may come before the next frame.
  const float from = window->ScrollTarget.y < FLT_MAX ? window->ScrollTarget.y : window->Scroll.y;
  const float by = lines * text_.line_px + pages * (window->InnerRect.GetHeight() - text_.line_px);
  ImGui::SetScrollY(window, std::clamp(from + by, 0.0f, window->ScrollMax.y));
  return true;
}

}  // namespace homolog
