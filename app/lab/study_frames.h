#pragma once

#include <filesystem>

#include "core/base/result.h"

namespace homolog {

/// The costs of opening a study in the Models mode and of looking at it, in a window of 1280×800 whose pictures are
/// drawn.
struct StudyCost {
  double open_ms = 0;             ///< until its model and the gallery are on the screen
  double at_rest_ms = 0;          ///< until nothing goes on beside the window either
  double slowest_frame_ms = 0;    ///< until then
  double turned_frame_ms = 0;     ///< median, while all shapes are turned
  double next_page_frame_ms = 0;  ///< median of the frames that show another page first
  double peak_mb = 0;             ///< the whole process's memory at its peak
};
/// Errors: no OpenGL; no model can be made of the study.
Result<StudyCost> study_cost(const std::filesystem::path& study);

}  // namespace homolog
