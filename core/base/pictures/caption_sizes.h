#pragma once

namespace homolog {

// How large is what is written on pictures.

/// A round length (1, 2 or 5 times a power of ten, mm) that is at most `longest_px` long on the screen.
double scale_bar_mm(double mm_per_px, double longest_px);

/// The scale of the letters on a picture of cells: they grow with the picture, as far as names have room in the cells.
float caption_scale(float picture_width_px, float cell_width_px);

}  // namespace homolog
