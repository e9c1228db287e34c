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

}  // namespace homolog
