#pragma once

#include <array>
#include <string>

#include "app/editor/panels/ui_context.h"
#include "app/editor/picking/picking.h"

namespace homolog {

/// A place on the screen.
inline ImVec2 on_screen(const Eigen::Vector2d& p) {
  return {static_cast<float>(p.x()), static_cast<float>(p.y())};
}

/// The letters of a direction at the view's edge.
struct Letters {
  std::string text;
  ImVec2 at, size;
};
std::array<Letters, 4> letters_of(const UiContext& ui, const ViewMap& map);

/// Dots where landmarks were placed, filled where the mesh is held there; rings where the mesh has those that it does
/// not meet. Each is named once; what lies behind the surface is faint and has no name.
void draw_landmarks(const UiContext& ui, const ViewMap& map, ImDrawList& draw);

}  // namespace homolog
