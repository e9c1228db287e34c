#include "app/editor/widgets/theme.h"

#include <imgui_freetype.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "app/fonts/fonts.h"

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

/// A copy of a font, on the same texture, whose digits have one width. The atlas owns it.
ImFont* with_digits_of_one_width(const ImFont& proportional) {
  ImFont& font = *IM_NEW(ImFont)(proportional);
  ImGui::GetIO().Fonts->Fonts.push_back(&font);
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
  return &font;
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
  set(ImGuiCol_TextDisabled, palette::dim);  // hints in empty fields, keys in menus: they are read, too
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

ImU32 title_hue(ViewKind kind) {
  const ImU32 hue = view_hue(kind);
  const bool on_light = (palette::surface & 0xFFU) > 0x80U;
  if (!on_light) return hue;
  ImVec4 dark = ImGui::ColorConvertU32ToFloat4(hue);
  for (float* channel : {&dark.x, &dark.y, &dark.z}) *channel *= 0.55f;
  return ImGui::ColorConvertFloat4ToU32(dark);
}

void use_palette(bool light, bool light_marks) {
  struct Colours {
    ImU32 window, surface, raised, hovered, pressed, line, text, dim, faint, accent, on_accent, amber, bad, good,
        dialog;
  };
  constexpr auto rgb = [](unsigned hex) { return IM_COL32(hex >> 16U & 0xFFU, hex >> 8U & 0xFFU, hex & 0xFFU, 255); };
  static constexpr Colours dark{rgb(0x0E0F11), rgb(0x1A1C1F), rgb(0x26292E), rgb(0x33373E), rgb(0x3C424B),
                                rgb(0x2C2F35), rgb(0xE6E8EB), rgb(0xA0A7B1), rgb(0x6C737D), rgb(0x5BAEFF),
                                rgb(0x081626), rgb(0xFFA93F), rgb(0xFF7A73), rgb(0x67CF96), rgb(0x1F2226)};
  static constexpr Colours bright{rgb(0xE9EBEE), rgb(0xF5F6F8), rgb(0xE2E5EA), rgb(0xD4D9E0), rgb(0xC5CCD5),
                                  rgb(0xD3D7DC), rgb(0x1B1E22), rgb(0x505862), rgb(0x8A929C), rgb(0x1667BF),
                                  rgb(0xFFFFFF), rgb(0x9A5800), rgb(0xB8261D), rgb(0x16733F), rgb(0xFCFCFD)};
  const Colours& now = light ? bright : dark;
  palette::window = now.window;
  palette::surface = now.surface;
  palette::raised = now.raised;
  palette::hovered = now.hovered;
  palette::pressed = now.pressed;
  palette::line = now.line;
  palette::text = now.text;
  palette::dim = now.dim;
  palette::faint = now.faint;
  palette::accent = now.accent;
  palette::on_accent = now.on_accent;
  palette::amber = now.amber;
  palette::bad = now.bad;
  palette::good = now.good;
  palette::dialog = now.dialog;
  palette::mark = light_marks ? bright.text : dark.text;
  palette::mark_dim = light_marks ? bright.dim : dark.dim;
  palette::mark_shadow = light_marks ? IM_COL32(255, 255, 255, 220) : IM_COL32(0, 0, 0, 200);
}

Theme make_theme(float scale, const std::set<unsigned>& letters, bool light) {
  use_palette(light);
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  atlas.Clear();
  atlas.FontBuilderIO = ImGuiFreeType::GetBuilderForFreeType();
  Theme theme;
  theme.scale = scale;
  // Both are read until the atlas is built.
  std::vector<ImWchar> letter_ranges;
  for (const unsigned letter : letters) letter_ranges.insert(letter_ranges.end(), 2, static_cast<ImWchar>(letter));
  letter_ranges.push_back(0);
  const std::string further = letters.empty() ? std::string() : east_asian_font();
  const auto with_icons = [&](const unsigned char* bytes, std::size_t size, float units) {
    ImFont* font = add_font(bytes, size, theme.px(units), text_ranges);
    add_font(homolog_font_fork_awesome, homolog_font_fork_awesome_size, theme.px(units - 1), icon_ranges, true, scale);
    if (letters.empty()) return font;
    add_font(bytes, size, theme.px(units), letter_ranges.data(), true);
    if (!further.empty())
      add_font(reinterpret_cast<const unsigned char*>(further.data()), further.size(), theme.px(units),
               letter_ranges.data(), true);
    return font;
  };
  theme.body = with_icons(homolog_font_inter_regular, homolog_font_inter_regular_size, 16);
  theme.strong = with_icons(homolog_font_inter_semibold, homolog_font_inter_semibold_size, 16);
  theme.small = with_icons(homolog_font_inter_regular, homolog_font_inter_regular_size, 14);
  theme.icons = add_font(homolog_font_fork_awesome, homolog_font_fork_awesome_size, theme.px(20), icon_ranges);
  atlas.Build();
  std::size_t k = 0;
  for (const ImFont* font : {theme.body, theme.strong, theme.small})
    theme.with_even_digits[k++] = with_digits_of_one_width(*font);
  set_style(scale);
  return theme;
}

}  // namespace homolog
