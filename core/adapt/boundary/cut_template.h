#pragma once

#include <cstdint>
#include <vector>

#include "core/adapt/boundary/boundary.h"
#include "core/template/template.h"

namespace homolog {

/// The planes at which a template is cut off, where its vertices lie at `points` (n×3, LPS mm): one for each patch of
/// its region cut_region with at least one in a hundred vertices. Everything beyond them, and the flat faces
/// themselves, are no target and do not count. Empty for a template of a whole organ.
std::vector<ScanBorder> cut_borders(const Template& the_template, const Points& points);

/// The boundary as such a template shows it: cut off there too.
Boundary cut_as_template(const Boundary& boundary, const std::vector<ScanBorder>& template_cuts);

}  // namespace homolog
