#pragma once

#include <array>

#include "core/base/enumerators.h"
#include "core/deform/gesture.h"

namespace homolog {

// The effect of a stroke is a row: all that the program knows of it, but for the tool of the mouse that makes it.

/// Everything about a kind of strokes.
struct StrokeKind {
  Tool tool;
  const char* name;             ///< in a line of a case, and what Undo calls it
  bool follows_cursor = false;  ///< the point that is held follows the cursor over the surface; its line says where to
  bool along_surface = false;   ///< vertices move along the surface, which stays
  /// The surface is elsewhere afterwards. What keeps to it, as a snap or a model's help, may follow.
  bool moves_boundary = false;
  /// A mesh that follows less of a drag than this share is held by something. A pull along the surface moves it little
  /// by itself.
  double followed_share = 0.5;
  bool sets_places = false;  ///< it puts vertices somewhere; else it carries them by a distance
  /// What one dab at Stroke::at makes, by Stroke::strength. Null: the stroke is a drag to Stroke::to [Gesture].
  StrokeOutcome (*dab)(const StrokeStart& start, const ShapeSolver& solver, const Stroke& stroke) = nullptr;

  constexpr bool is_dab() const { return dab != nullptr; }
};

// In the order of Tool.
inline constexpr std::array stroke_kinds{
    StrokeKind{
        .tool = Tool::pull, .name = "pull", .follows_cursor = true, .moves_boundary = true, .followed_share = 0.25},
    StrokeKind{.tool = Tool::grab, .name = "grab", .moves_boundary = true},
    StrokeKind{.tool = Tool::slide, .name = "slide", .along_surface = true},
    StrokeKind{.tool = Tool::relax, .name = "relax", .sets_places = true, .dab = relax},
};
static_assert(has_row_of_each<Tool>(stroke_kinds, &StrokeKind::tool), "a row for each Tool, in their order");

constexpr bool move_alike(const StrokeKind& a, const StrokeKind& b) {
  return a.follows_cursor == b.follows_cursor && a.along_surface == b.along_surface && a.dab == b.dab;
}
static_assert(
    [] {
      for (std::size_t k = 0; k < stroke_kinds.size(); ++k)
        for (std::size_t other = 0; other < k; ++other)
          if (move_alike(stroke_kinds[k], stroke_kinds[other])) return false;
      return true;
    }(),
    "two kinds of strokes move the mesh alike: say in the row how this one does");

/// The row of a tool.
constexpr const StrokeKind& kind_of_stroke(Tool tool) {
  return stroke_kinds[static_cast<std::size_t>(tool)];
}

}  // namespace homolog
