#include <imgui_internal.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "app/editor/widgets/drawn_items.h"
#include "app/editor/widgets/imgui_context.h"
#include "app/editor/widgets/widgets.h"

// Where a control is explained.

namespace homolog {

namespace {

/// Of all places at which a tip of that size covers no control of the last frame, the one nearest to `wanted`; where
/// there is none near, `wanted` itself.
ImVec2 free_place(ImVec2 size, ImVec2 wanted, const ImRect& control, float aside) {
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  const auto is_free = [&](ImVec2 at) {
    if (at.x < 0 || at.y < 0 || at.x + size.x > display.x || at.y + size.y > display.y) return false;
    const ImRect box({at.x - 1, at.y - 1}, {at.x + size.x + 1, at.y + size.y + 1});
    if (box.Overlaps(control)) return false;
    return std::ranges::none_of(controls_memory().last_controls, [&](const RectPx& other) {
      return box.Overlaps({{other.x, other.y}, {other.x + other.width, other.y + other.height}});
    });
  };
  if (is_free(wanted)) return wanted;
  // In growing rings around it.
  constexpr int rings = 40;
  for (int ring = 1; ring <= rings; ++ring) {
    const float far = aside * static_cast<float>(ring);
    for (int k = -ring; k <= ring; ++k) {
      const float along = aside * static_cast<float>(k);
      for (const ImVec2 way : {ImVec2{along, far}, ImVec2{far, along}, ImVec2{-far, along}, ImVec2{along, -far}})
        if (const ImVec2 at{wanted.x + way.x, wanted.y + way.y}; is_free(at)) return at;
    }
  }
  return wanted;
}

/// Where a tip of that size lies: beside the part of the window that its control is in; where there is no room, below
/// or above the control. There, or near there, it covers no control. Always within the window.
ImVec2 tip_place(ImVec2 size, const ImRect& control, const ImRect& part, float aside) {
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  const float x = std::clamp(control.Min.x, 0.0f, std::max(display.x - size.x, 0.0f));
  const float y = std::clamp(control.Min.y, 0.0f, std::max(display.y - size.y, 0.0f));
  const ImVec2 left{part.Min.x - aside - size.x, y}, right{part.Max.x + aside, y};
  const ImVec2 below{x, part.Max.y + aside}, above{x, part.Min.y - aside - size.y};
  const bool is_bar = part.GetWidth() > part.GetHeight();
  for (const ImVec2 at : is_bar ? std::array{below, above, left, right} : std::array{left, right, below, above}) {
    const bool fits = at.x >= 0 && at.y >= 0 && at.x + size.x <= display.x && at.y + size.y <= display.y;
    if (fits) return free_place(size, at, control, aside);
  }
  const float under = control.Max.y + aside, over = control.Min.y - aside - size.y;
  const ImVec2 at{x,
                  under + size.y <= display.y || over < 0 ? std::min(under, std::max(display.y - size.y, 0.0f)) : over};
  return free_place(size, at, control, aside);
}

}  // namespace

bool is_explained(ImGuiHoveredFlags hovered) {
  return key_focus().explains() ? key_focus().at_last_control() : ImGui::IsItemHovered(hovered);
}

void tooltip(const Theme& theme, const std::string& text) {
  const ImGuiContext& imgui = *ImGui::GetCurrentContext();
  const ImRect control = imgui.LastItemData.Rect, part = imgui.CurrentWindow->RootWindow->Rect();
  const ImVec2 pad{theme.px(8), theme.px(6)};
  const float wrap = theme.px(280);
  const std::string lines = in_lines(theme.small, text, wrap);
  const ImVec2 inner = text_size(theme.small, lines);
  const ImVec2 size{std::ceil(inner.x) + 2 * pad.x + 1, std::ceil(inner.y) + 2 * pad.y};
  look_for_letters(text);
  ImGui::SetNextWindowPos(tip_place(size, control, part, theme.px(6)));
  ImGui::SetNextWindowSize(size);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, pad);
  ImGui::PushStyleVar(ImGuiStyleVar_Alpha, 1);  // also where the control is disabled
  ImGui::BeginTooltip();
  ImGui::PushFont(theme.small);
  ImGui::TextUnformatted(lines.c_str());
  note_text(text, ImGui::GetItemRectMin(), ImGui::GetItemRectMax(), {0, 0}, ImGui::GetIO().DisplaySize,
            DrawnItem::Kind::tip);
  ImGui::PopFont();
  ImGui::EndTooltip();
  ImGui::PopStyleVar(2);
}

}  // namespace homolog
