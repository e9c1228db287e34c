#pragma once

#include <array>
#include <cstdint>

#include "app/editor/state/view_geometry.h"

namespace homolog {

/// Hues of the axial, sagittal, coronal and 3D views: their frames, lines of the cross-hair, plane outlines. 0…1, sRGB.
inline constexpr std::array<std::array<float, 3>, 4> view_colours{
    {{0.925f, 0.498f, 0.478f}, {0.851f, 0.812f, 0.384f}, {0.435f, 0.788f, 0.514f}, {0.561f, 0.651f, 0.769f}}};

inline const std::array<float, 3>& view_colour(ViewKind kind) {
  return view_colours[index_of(kind)];
}

}  // namespace homolog
