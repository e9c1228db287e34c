#include "core/structures/structure_confidence.h"

#include <algorithm>
#include <cmath>

namespace homolog {

double structure_confidence(const FittedStructure& one) {
  if (!one.fit) return 0;
  const double doubt = one.judgement.doubt_share / most_doubt_share;
  const double disagreement = (1 - one.judgement.inside_scan.dice) / 0.1;
  const double off = std::max(0.0, one.off_place) / 0.25;
  const double x = 4 - 1.5 * doubt - 1.5 * disagreement - 1.5 * off;
  return 1 / (1 + std::exp(-x));
}

double structure_confidence(const FittedStructure& one, const StructureSigns& signs, const RepairedStructure& found) {
  if (!one.fit) return 0;
  double confidence = structure_confidence(one) * found.p_named;
  for (const Defect& defect : found.defects) {
    const bool is_large = defect.kind != DefectKind::island && defect.kind != DefectKind::hole &&
                          defect.kind != DefectKind::bridge && defect.kind != DefectKind::cut_by_scan;
    confidence *= is_large ? 0.2 : 0.9;
  }
  return confidence * std::clamp(1 - signs.lacking, 0.0, 1.0);
}

}  // namespace homolog
