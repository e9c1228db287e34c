#pragma once

#include <imgui.h>

#include <array>
#include <cstddef>
#include <set>

#include "app/editor/state/view_colours.h"

namespace homolog {

/// Fonts and colours of the interface at one content scale.
struct Theme {
  float scale = 1;
  ImFont* body = nullptr;    ///< Inter Regular with the icons merged in
  ImFont* strong = nullptr;  ///< Inter SemiBold
  ImFont* small = nullptr;   ///< Inter Regular, for captions
  ImFont* icons = nullptr;   ///< Fork Awesome, for the tool strip
  /// The first three with digits of one width, so that numbers that change do not jitter and columns align. Names are
  /// written without: a "1" would stand apart.
  std::array<ImFont*, 3> with_even_digits{};

  /// The one of `font` that has digits of one width; `font` itself where there is none.
  ImFont* even_digits(ImFont* font) const {
    for (std::size_t k = 0; k < 3; ++k)
      if (font == std::array{body, strong, small}[k] && with_even_digits[k] != nullptr) return with_even_digits[k];
    return font;
  }

  /// Layout units (a grid of 4) to px.
  float px(float units) const { return static_cast<float>(static_cast<int>(units * scale + 0.5f)); }
};

/// The colours of the theme that make_theme() or use_palette() chose last, as ImGui's own style is one for all.
namespace palette {
inline ImU32 window = IM_COL32(0x0E, 0x0F, 0x11, 255);   ///< behind the views
inline ImU32 surface = IM_COL32(0x1A, 0x1C, 0x1F, 255);  ///< bars and panels
inline ImU32 raised = IM_COL32(0x26, 0x29, 0x2E, 255);   ///< buttons and fields
inline ImU32 hovered = IM_COL32(0x33, 0x37, 0x3E, 255);
inline ImU32 pressed = IM_COL32(0x3C, 0x42, 0x4B, 255);
inline ImU32 line = IM_COL32(0x2C, 0x2F, 0x35, 255);
inline ImU32 text = IM_COL32(0xE6, 0xE8, 0xEB, 255);
inline ImU32 dim = IM_COL32(0xA0, 0xA7, 0xB1, 255);
inline ImU32 faint = IM_COL32(0x6C, 0x73, 0x7D, 255);  ///< the colour of what is disabled
inline ImU32 accent = IM_COL32(0x5B, 0xAE, 0xFF, 255);
inline ImU32 on_accent = IM_COL32(0x08, 0x16, 0x26, 255);
inline ImU32 amber = IM_COL32(0xFF, 0xA9, 0x3F, 255);  ///< the fold guard, warnings
inline ImU32 bad = IM_COL32(0xFF, 0x7A, 0x73, 255);
inline ImU32 good = IM_COL32(0x67, 0xCF, 0x96, 255);
inline constexpr ImU32 contour = IM_COL32(0xFF, 0xE0, 0x66, 255);  ///< curves that were drawn, over the views
inline ImU32 mark = text;                                          ///< over the views: on images, in both themes
inline ImU32 mark_dim = dim;                                       ///< the same, of lesser weight
inline ImU32 mark_shadow = IM_COL32(0, 0, 0, 200);                 ///< around what is written there
inline ImU32 dialog = IM_COL32(0x1F, 0x22, 0x26, 255);             ///< the ground of what covers the window
}  // namespace palette

/// A view's hue as text: in the title of its header.
ImU32 title_hue(ViewKind kind);
inline ImU32 view_hue(ViewKind kind) {
  const auto& [r, g, b] = view_colour(kind);
  return ImGui::ColorConvertFloat4ToU32({r, g, b, 1});
}
ImU32 with_alpha(ImU32 colour, float alpha);

/// Builds the fonts for a content scale and sets ImGui's style; call again when the scale changes, between frames.
/// `letters` are code points beside those that most names are written in: they come from a font of the system that has
/// Chinese, Japanese and Korean, where there is one.
Theme make_theme(float scale, const std::set<unsigned>& letters = {}, bool light = false);
/// Takes the dark or the light colours; fonts and sizes stay. `light_marks`: marks over the views are for a light
/// ground.
void use_palette(bool light, bool light_marks = false);

}  // namespace homolog
