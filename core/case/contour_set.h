#pragma once

#include <string>
#include <vector>

#include "core/volume/contours.h"

namespace homolog {

/// Curves that somebody drew of an organ in one frame: one that was drawn in the window, or all of a file's structure.
struct ContourSet {
  std::string id;               ///< lines of the case file name it by this
  std::string name;             ///< may be empty
  int frame = 0;                ///< the image's frame that they were drawn in
  double off_mm = 0;            ///< how far they may lie off the boundary, standard deviation
  bool outside = false;         ///< they are not the boundary: the organ lies inside of them, somewhere
  std::vector<Contour> curves;  ///< LPS mm; never none
  bool operator==(const ContourSet&) const = default;
};

}  // namespace homolog
