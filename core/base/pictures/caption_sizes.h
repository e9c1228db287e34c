#pragma once

namespace homolog {

// How large is what is written on pictures.

/// A round length (1, 2 or 5 times a power of ten, mm) that is at most `longest_px` long on the screen.
double scale_bar_mm(double mm_per_px, double longest_px);

/// The height of letters on pictures at the scale 1, px.
inline constexpr float letters_px = 16;
/// The room kept free of the shape in a cell, in heights of letters: above for its name, below for a scale bar.
inline constexpr float room_of_name = 1.75f, room_of_bar = 1.5f;

/// The scale of the letters on a picture of cells: they grow with the picture, as far as names have room in the cells.
float caption_scale(float picture_width_px, float cell_width_px);

}  // namespace homolog
