#pragma once

#include "core/adapt/boundary/boundary.h"
#include "core/template_making/label_body.h"

namespace homolog {

/// Parts of a label cut out of a label map with a margin around it, cavities filled.
struct CutOutParts {
  LabelBody region;
  PartsLeftOut left_out;  ///< none where all parts were asked for, but `alike`
};

/// See label_body. Errors: the label does not occur, or has no such part.
Result<CutOutParts> label_parts(const Volume& mask, int label, int frame, const LabelExtent& extent, double spacing_mm,
                                double margin_mm, const LabelParts& parts);

}  // namespace homolog
