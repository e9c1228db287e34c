#pragma once

#include <optional>
#include <string>

#include "core/adapt/boundary/boundary.h"
#include "core/template_making/label_body.h"

namespace homolog {

/// Parts of a label cut out of a label map with a margin around it, cavities filled.
struct CutOutParts {
  LabelBody region;
  std::size_t left_out = 0;   ///< parts
  double share_left_out = 0;  ///< of the label's voxels, in these
  std::size_t alike = 1;      ///< the largest, and those more than half as large
  bool one = true;            ///< one part alone was asked for

  /// That parts are left out, how many and how much; none where it is less than a hundredth of the label.
  std::optional<std::string> warning(int label) const;
};

/// See label_body. Errors: the label does not occur, or has no such part.
Result<CutOutParts> label_parts(const Volume& mask, int label, int frame, const LabelExtent& extent, double spacing_mm,
                                double margin_mm, const LabelParts& parts);

}  // namespace homolog
