#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/mesh/geometry/curvature.h"
#include "core/mesh/topology.h"

namespace homolog {

using Rgb = std::array<float, 3>;  ///< 0…1, sRGB

/// Position of every vertex in a breadth-first search from `first`, components one after the other [Erdt 2009, §3.1].
std::vector<std::int32_t> breadth_first_rank(const Topology& topology, std::int32_t first = 0);

/// The same shape renumbered breadth-first from `first`.
Mesh renumbered(const Mesh& mesh, Eigen::Index first);

/// Whether neighbouring vertices have near indices already, so that hue may follow the index itself: the median over
/// edges of |i − j| is not larger than twice that of the breadth-first rank, or the mesh is a ring × sector grid.
bool indices_are_local(const Topology& topology);

/// Hue of every vertex, 0…1: its index / n where indices are local, else its breadth-first rank / n.
std::vector<float> vertex_hues(const Topology& topology);

/// HSV to RGB; surfaces use saturation 0.4, glyphs 1.0, both value 1.0 [Erdt 2009, §3.1].
Rgb hsv_to_rgb(float hue, float saturation, float value);

// Scales that differ in lightness as well as in hue, so that they are read without colour vision: every other step of
// nine is told apart by all eyes (tests/app/editor/colour_vision_test.cpp). The colours are evenly spaced.

/// From one side of a middle to the other.
const std::vector<Rgb>& diverging_scale();
/// From little to much.
const std::vector<Rgb>& rising_scale();
/// From doubtful to sure.
const std::vector<Rgb>& confidence_scale();
/// From sure to doubtful: the confidence, read from its other end.
const std::vector<Rgb>& doubt_scale();

/// Vertices to show as glyphs: by decreasing Gaussian curvature of `mesh`, each farther than `spacing_mm` from all
/// chosen before [Erdt 2009, §3.1].
std::vector<std::int32_t> glyph_vertices(const Mesh& mesh, double spacing_mm);

}  // namespace homolog
