#include "app/pictures/page_font.h"

#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H
#include FT_TRUETYPE_TABLES_H
#include FT_TRUETYPE_TAGS_H

#include <algorithm>
#include <cstdint>
#include <stdexcept>

#include "app/fonts/fonts.h"
#include "app/pictures/page.h"

// The letters of pages: Inter, which is embedded, and where it lacks one a font of the system.

namespace homolog {

namespace {

/// The fonts, for as long as the program runs.
struct PageFonts {
  FT_Library library = nullptr;
  FT_Face inter = nullptr, asian = nullptr;
  std::string asian_bytes;
  bool looked_for_asian = false;

  PageFonts() {
    if (FT_Init_FreeType(&library) != 0 ||
        FT_New_Memory_Face(library, homolog_font_inter_regular, static_cast<FT_Long>(homolog_font_inter_regular_size),
                           0, &inter) != 0)
      throw std::runtime_error("the font of pages cannot be read");
  }
  /// Read when the first letter needs it; null where the system has none.
  FT_Face east_asian() {
    if (!looked_for_asian) {
      looked_for_asian = true;
      asian_bytes = east_asian_font();
      if (!asian_bytes.empty())
        FT_New_Memory_Face(library, reinterpret_cast<const FT_Byte*>(asian_bytes.data()),
                           static_cast<FT_Long>(asian_bytes.size()), 0, &asian);
    }
    return asian;
  }
};

PageFonts& page_fonts() {
  static PageFonts fonts;
  return fonts;
}

/// The letters of UTF-8.
std::u32string letters_of(const std::string& text) {
  std::u32string letters;
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<unsigned char>(text[i]);
    const std::size_t length = first < 0x80 ? 1 : first >> 5 == 6 ? 2 : first >> 4 == 14 ? 3 : first >> 3 == 30 ? 4 : 0;
    char32_t letter = length == 1 ? first : first & (0x7FU >> length);
    bool whole = length > 0 && i + length <= text.size();
    for (std::size_t k = 1; whole && k < length; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      whole = next >> 6 == 2;
      letter = letter << 6 | (next & 0x3FU);
    }
    letters.push_back(!whole ? U'\xFFFD' : letter < 0x20 ? U' ' : letter);
    i += whole ? length : 1;
  }
  return letters;
}

FT_Face face_of(const PageGlyph& glyph) {
  FT_Face asian = glyph.inter ? nullptr : page_fonts().east_asian();
  return asian != nullptr ? asian : page_fonts().inter;
}

unsigned big_endian(const std::string& bytes, std::size_t at, std::size_t count) {
  unsigned value = 0;
  for (std::size_t k = 0; k < count; ++k) value = value << 8 | static_cast<unsigned char>(bytes.at(at + k));
  return value;
}

/// Where an INDEX of a CFF ends [Adobe Technical Note 5176, section 5].
std::size_t end_of_index(const std::string& cff, std::size_t at) {
  const unsigned count = big_endian(cff, at, 2);
  if (count == 0) return at + 2;
  const unsigned size = big_endian(cff, at + 2, 1);
  return at + 2 + (count + 1) * size + big_endian(cff, at + 3 + count * size, size);
}

/// Where the outlines lie, as the dictionary at the top says (operator 17).
std::size_t outlines_at(const std::string& cff, std::size_t at, std::size_t end) {
  std::size_t last = 0;
  while (at < end) {
    const unsigned byte = big_endian(cff, at, 1);
    if (byte == 17) return last;
    if (byte == 30) {  // a real number ends with the half byte 15
      while ((big_endian(cff, ++at, 1) & 15U) != 15U && big_endian(cff, at, 1) >> 4 != 15U) {
      }
      ++at;
    } else if (byte == 29) {
      last = big_endian(cff, at + 1, 4);
      at += 5;
    } else {
      at += byte == 28 ? 3 : byte >= 247 || byte == 12 ? 2 : 1;
    }
  }
  throw std::runtime_error("the font of pages has no outlines");
}

GlyphStep step_to(GlyphStep::Kind kind, const FT_Vector* to, double scale) {
  GlyphStep step;
  step.kind = kind;
  step.to = scale * Eigen::Vector2d(static_cast<double>(to->x), static_cast<double>(to->y));
  return step;
}

/// What FreeType calls for every piece of an outline.
struct Steps {
  std::vector<GlyphStep> list;
  double scale = 1;

  static Eigen::Vector2d at(const FT_Vector* point, double scale) {
    return scale * Eigen::Vector2d(static_cast<double>(point->x), static_cast<double>(point->y));
  }
  static int move(const FT_Vector* to, void* self) {
    auto& steps = *static_cast<Steps*>(self);
    steps.list.push_back(step_to(GlyphStep::Kind::move, to, steps.scale));
    return 0;
  }
  static int line(const FT_Vector* to, void* self) {
    auto& steps = *static_cast<Steps*>(self);
    steps.list.push_back(step_to(GlyphStep::Kind::line, to, steps.scale));
    return 0;
  }
  static int conic(const FT_Vector* control, const FT_Vector* to, void* self) {
    auto& steps = *static_cast<Steps*>(self);
    GlyphStep step = step_to(GlyphStep::Kind::curve, to, steps.scale);
    const Eigen::Vector2d middle = at(control, steps.scale);
    step.control_1 = (steps.list.back().to + 2 * middle) / 3;
    step.control_2 = (step.to + 2 * middle) / 3;
    steps.list.push_back(step);
    return 0;
  }
  static int cubic(const FT_Vector* first, const FT_Vector* second, const FT_Vector* to, void* self) {
    auto& steps = *static_cast<Steps*>(self);
    GlyphStep step = step_to(GlyphStep::Kind::curve, to, steps.scale);
    step.control_1 = at(first, steps.scale);
    step.control_2 = at(second, steps.scale);
    steps.list.push_back(step);
    return 0;
  }
};

}  // namespace

std::vector<PageGlyph> glyphs_of(const std::string& text) {
  std::vector<PageGlyph> glyphs;
  for (const char32_t letter : letters_of(text)) {
    PageGlyph glyph{FT_Get_Char_Index(page_fonts().inter, letter), letter, 0, true};
    if (glyph.glyph == 0 && page_fonts().east_asian() != nullptr) {
      glyph.glyph = FT_Get_Char_Index(page_fonts().asian, letter);
      glyph.inter = glyph.glyph == 0;
    }
    FT_Face face = face_of(glyph);
    if (FT_Load_Glyph(face, glyph.glyph, FT_LOAD_NO_SCALE) == 0)
      glyph.advance = 1000.0 * static_cast<double>(face->glyph->advance.x) / face->units_per_EM;
    glyphs.push_back(glyph);
  }
  return glyphs;
}

std::vector<GlyphStep> outline_of(const PageGlyph& glyph) {
  FT_Face face = face_of(glyph);
  if (FT_Load_Glyph(face, glyph.glyph, FT_LOAD_NO_SCALE) != 0) return {};
  Steps steps{{}, 1000.0 / face->units_per_EM};
  const FT_Outline_Funcs calls{Steps::move, Steps::line, Steps::conic, Steps::cubic, 0, 0};
  FT_Outline_Decompose(&face->glyph->outline, &calls, &steps);
  return std::move(steps.list);
}

double text_width_mm(const std::string& text, double size_pt) {
  double width = 0;
  for (const PageGlyph& glyph : glyphs_of(text)) width += glyph.advance;
  return width / 1000 * size_pt * 25.4 / 72;
}

std::string font_program(const std::set<unsigned>& kept) {
  FT_ULong size = 0;
  FT_Face inter = page_fonts().inter;
  FT_Load_Sfnt_Table(inter, TTAG_CFF, 0, nullptr, &size);
  std::string cff(size, 0);
  FT_Load_Sfnt_Table(inter, TTAG_CFF, 0, reinterpret_cast<FT_Byte*>(cff.data()), &size);
  const std::size_t names = big_endian(cff, 2, 1), top = end_of_index(cff, names);
  const std::size_t outlines = outlines_at(cff, top, end_of_index(cff, top));
  const unsigned count = big_endian(cff, outlines, 2), bytes = big_endian(cff, outlines + 2, 1);
  const std::size_t first = outlines + 2 + (count + 1) * bytes;
  constexpr char end_of_outline = 14;
  for (unsigned glyph = 1; glyph < count; ++glyph) {
    if (kept.contains(glyph)) continue;
    const std::size_t from = first + big_endian(cff, outlines + 3 + glyph * bytes, bytes);
    const std::size_t to = first + big_endian(cff, outlines + 3 + (glyph + 1) * bytes, bytes);
    std::fill(cff.begin() + static_cast<std::ptrdiff_t>(from), cff.begin() + static_cast<std::ptrdiff_t>(to),
              end_of_outline);
  }
  return cff;
}

}  // namespace homolog
