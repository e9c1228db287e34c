#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "render/scene.h"

namespace homolog {

// Shapes that are compared, in the window and in pictures of the command line: each vertex has its hue in all of them,
// and they are seen without perspective [Erdt 2009, §3.1].

/// How far from its target a camera without perspective [Camera3D] just shows a sphere of `radius_mm` around it.
double distance_that_shows(double radius_mm);
/// The radius of the sphere that such a camera just shows.
double shown_radius_mm(const Camera3D& camera);

/// The colours of a surface: each vertex in its hue, faint.
std::shared_ptr<const std::vector<Rgb>> hued_surface(const std::vector<float>& hues);
/// Adds a sphere at each of some vertices, in that vertex' full hue. `points`: n×3, mm; `hues`: one a vertex.
void add_hued_glyphs(GlyphLayer& layer, const Points& points, const std::vector<std::int32_t>& vertices,
                     const std::vector<float>& hues, double radius_mm);

}  // namespace homolog
