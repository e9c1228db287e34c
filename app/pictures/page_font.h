#pragma once

#include <Eigen/Core>
#include <set>
#include <string>
#include <vector>

namespace homolog {

/// A piece of a letter's outline, in thousandths of its size, y upwards: to where, with the control points on the way.
struct GlyphStep {
  enum class Kind { move, line, curve } kind = Kind::move;
  Eigen::Vector2d control_1 = Eigen::Vector2d::Zero(), control_2 = Eigen::Vector2d::Zero(),
                  to = Eigen::Vector2d::Zero();
};

/// A letter as a font draws it.
struct PageGlyph {
  unsigned glyph = 0;   ///< its number in Inter; 0 where Inter does not have it
  char32_t letter = 0;  ///< Unicode
  double advance = 0;   ///< thousandths of its size
  bool inter = true;    ///< else it is of the system's East Asian font, or of none
};

/// The letters of a text (UTF-8). Bytes that are no UTF-8 give U+FFFD.
std::vector<PageGlyph> glyphs_of(const std::string& text);
/// The outline of a letter, closed; empty of a blank.
std::vector<GlyphStep> outline_of(const PageGlyph& glyph);
/// The outlines of Inter as PDF embeds them (CFF), those that are not in `kept` emptied; numbers stay.
std::string font_program(const std::set<unsigned>& kept);

}  // namespace homolog
