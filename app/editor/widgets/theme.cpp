#include "app/editor/widgets/theme.h"

#include <imgui_freetype.h>

#include <algorithm>
#include <cstddef>

extern "C" {
extern const unsigned char font_inter_regular[];
extern const std::size_t font_inter_regular_size;
extern const unsigned char font_inter_semibold[];
extern const std::size_t font_inter_semibold_size;
extern const unsigned char font_fork_awesome[];
extern const std::size_t font_fork_awesome_size;
}

namespace homolog {

namespace {

// Latin, Greek, Cyrillic, punctuation, arrows and mathematical signs that file names and texts hold.
constexpr ImWchar text_ranges[] = {0x20,   0x24F,  0x370,  0x3FF,  0x400,  0x4FF,  0x2010, 0x2044, 0x2070,
                                   0x209C, 0x2190, 0x21FF, 0x2200, 0x22FF, 0x232B, 0x232B, 0};
constexpr ImWchar icon_ranges[] = {0xF000, 0xF330, 0};

ImFont* add_font(const unsigned char* bytes, std::size_t size, float size_px, const ImWchar* ranges, bool merge = false,
                 float down_px = 0) {
  ImFontConfig config;
  config.FontDataOwnedByAtlas = false;
  config.MergeMode = merge;
  config.GlyphOffset.y = down_px;
  config.FontBuilderFlags = ImGuiFreeTypeBuilderFlags_LightHinting;
  // ImGui takes the bytes as writable but does not write them when it does not own them.
  return ImGui::GetIO().Fonts->AddFontFromMemoryTTF(const_cast<unsigned char*>(bytes), static_cast<int>(size), size_px,
                                                    &config, ranges);
}

/// Digits of one width, so that numbers that change do not jitter and columns align.
void make_digits_tabular(ImFont& font) {
  float widest = 0;
  for (ImWchar digit = '0'; digit <= '9'; ++digit) widest = std::max(widest, font.FindGlyph(digit)->AdvanceX);
  for (ImWchar digit = '0'; digit <= '9'; ++digit) {
    auto& glyph = *const_cast<ImFontGlyph*>(font.FindGlyph(digit));
    const float shift = static_cast<float>(static_cast<int>((widest - glyph.AdvanceX) / 2 + 0.5f));
    glyph.X0 += shift;
    glyph.X1 += shift;
    glyph.AdvanceX = widest;
  }
  font.BuildLookupTable();
}

void set_style(float scale) {
  ImGuiStyle style;
  style.WindowPadding = {12, 12};
  style.FramePadding = {8, 6};
  style.ItemSpacing = {8, 8};
  style.ItemInnerSpacing = {8, 4};
  style.WindowRounding = 6;
  style.PopupRounding = 6;
  style.ChildRounding = 4;
  style.FrameRounding = 4;
  style.GrabRounding = 4;
  style.ScrollbarRounding = 4;
  style.ScrollbarSize = 10;
  style.WindowBorderSize = 0;
  style.PopupBorderSize = 1;
  style.FrameBorderSize = 0;
  style.ScaleAllSizes(scale);
  const auto set = [&](ImGuiCol index, ImU32 colour) { style.Colors[index] = ImGui::ColorConvertU32ToFloat4(colour); };
  set(ImGuiCol_Text, palette::text);
  set(ImGuiCol_TextDisabled, palette::faint);
  set(ImGuiCol_WindowBg, palette::surface);
  set(ImGuiCol_ChildBg, IM_COL32_BLACK_TRANS);
  set(ImGuiCol_PopupBg, palette::raised);
  set(ImGuiCol_Border, palette::line);
  set(ImGuiCol_FrameBg, palette::raised);
  set(ImGuiCol_FrameBgHovered, palette::hovered);
  set(ImGuiCol_FrameBgActive, palette::pressed);
  set(ImGuiCol_ScrollbarBg, IM_COL32_BLACK_TRANS);
  set(ImGuiCol_ScrollbarGrab, palette::hovered);
  set(ImGuiCol_ScrollbarGrabHovered, palette::pressed);
  set(ImGuiCol_ScrollbarGrabActive, palette::faint);
  set(ImGuiCol_CheckMark, palette::accent);
  set(ImGuiCol_Button, palette::raised);
  set(ImGuiCol_ButtonHovered, palette::hovered);
  set(ImGuiCol_ButtonActive, palette::pressed);
  set(ImGuiCol_Header, palette::hovered);
  set(ImGuiCol_HeaderHovered, palette::hovered);
  set(ImGuiCol_HeaderActive, palette::pressed);
  set(ImGuiCol_Separator, palette::line);
  set(ImGuiCol_TextSelectedBg, with_alpha(palette::accent, 0.35f));
  set(ImGuiCol_NavHighlight, palette::accent);
  set(ImGuiCol_ModalWindowDimBg, IM_COL32(0, 0, 0, 150));
  ImGui::GetStyle() = style;
}

}  // namespace

ImU32 with_alpha(ImU32 colour, float alpha) {
  const auto byte = static_cast<ImU32>(std::clamp(alpha, 0.0f, 1.0f) * 255 + 0.5f);
  return (colour & ~IM_COL32_A_MASK) | (byte << IM_COL32_A_SHIFT);
}

Theme make_theme(float scale) {
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  atlas.Clear();
  atlas.FontBuilderIO = ImGuiFreeType::GetBuilderForFreeType();
  Theme theme;
  theme.scale = scale;
  const auto with_icons = [&](const unsigned char* bytes, std::size_t size, float units) {
    ImFont* font = add_font(bytes, size, theme.px(units), text_ranges);
    add_font(font_fork_awesome, font_fork_awesome_size, theme.px(units - 1), icon_ranges, true, scale);
    return font;
  };
  theme.body = with_icons(font_inter_regular, font_inter_regular_size, 16);
  theme.strong = with_icons(font_inter_semibold, font_inter_semibold_size, 16);
  theme.small = with_icons(font_inter_regular, font_inter_regular_size, 14);
  theme.icons = add_font(font_fork_awesome, font_fork_awesome_size, theme.px(20), icon_ranges);
  atlas.Build();
  for (ImFont* font : {theme.body, theme.strong, theme.small}) make_digits_tabular(*font);
  set_style(scale);
  return theme;
}

}  // namespace homolog
