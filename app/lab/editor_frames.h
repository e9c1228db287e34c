#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace homolog {

/// The cost of a frame of the editor for the window's thread while a person drags or paints, ms of processor time.
struct FrameCost {
  std::string tool;
  int structures = 1;                         ///< the case's structures
  double frame_ms = 0, slowest_frame_ms = 0;  ///< median and slowest, without OpenGL
  std::optional<double> drawn_frame_ms;       ///< median with it; none where it is not to be had
};
/// Events of the pointer in a frame: about 1,000 a second.
inline constexpr int events_a_frame = 16;

/// Drags and paints on the demo kidney with every tool of a stroke, and pulls one of sixty structures. Errors: the
/// temporary folder cannot be written.
Result<std::vector<FrameCost>> frame_costs();

}  // namespace homolog
