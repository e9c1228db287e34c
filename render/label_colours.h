#pragma once

#include <map>

#include "core/mesh/colours.h"

namespace homolog {

/// The colour of a label in overlays and legends: the same for a label in every picture, far apart for labels that
/// follow each other. Repeats after label_colour_count labels; label 0 is the background and has none (black).
Rgb label_colour(int label);
/// The label's colour: the one that the label map itself gives, where it gives one (`own` may be null).
Rgb label_colour(int label, const std::map<int, Rgb>* own);

inline constexpr int label_colour_count = 255;

}  // namespace homolog
