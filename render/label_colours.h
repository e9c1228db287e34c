#pragma once

#include "core/correspondence/colours.h"

namespace homolog {

/// The colour of a label in overlays and legends: the same for a label in every picture, far apart for labels that
/// follow each other. Repeats after kLabelColours labels; label 0 is the background and has none (black).
Rgb label_colour(int label);

inline constexpr int kLabelColours = 255;

}  // namespace homolog
