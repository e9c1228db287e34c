#pragma once

#include <vector>

#include "core/mesh/topology.h"

namespace homolog {

/// A line in which a plane cuts a surface.
struct SectionLine {
  std::vector<Vec3> points;  ///< mm; the last is joined to the first where it is closed
  bool closed = true;        ///< else it ends at openings of the surface
};

/// All lines in which a plane (through `at`, with the unit `normal`) cuts a surface, each with the inside on its left
/// seen against the normal, in the order of their first faces. None: the plane misses it.
std::vector<SectionLine> plane_section(const Mesh& mesh, const Vec3& at, const Vec3& normal);

/// mm; of an open line without the gap.
double length_mm(const SectionLine& line);
/// Area within lines of one plane, mm²: what lies in a hole is taken off. An open line counts as closed straight.
double area_within_mm2(const std::vector<SectionLine>& lines, const Vec3& normal);
/// Distance of a point to a line of a section, mm.
double distance_to_line_mm(const SectionLine& line, const Vec3& p);

}  // namespace homolog
