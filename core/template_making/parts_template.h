#pragma once

#include "core/template_making/mask_template.h"

namespace homolog {

/// A template of every part of a label, as of an organ in two pieces: each is made as by make_mask_template, with a
/// share of the vertices by its surface area, and the parts' vertices follow each other from the largest part to the
/// smallest. Crumbs, of less than a hundredth of the label's voxels or fewer than 8, are left out (`islands_ml`).
/// Distances are means over the parts by area. Errors: those of make_mask_template; too few vertices for so many parts.
Result<MaskTemplate> make_parts_template(const Volume& mask, const MaskTemplateOptions& options,
                                         Progress* progress = nullptr);

}  // namespace homolog
