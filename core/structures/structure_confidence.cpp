#include "core/structures/structure_confidence.h"

#include <algorithm>
#include <cmath>

namespace homolog {

namespace {

/// A value as a share of what is much, at most `most` of it.
double part(double value, double much, double most) {
  return std::clamp(value / much, 0.0, most);
}

/// Whether a defect changes a large part of a structure.
bool is_large(DefectKind kind) {
  switch (kind) {
    case DefectKind::half_missing:
    case DefectKind::given_to_neighbour:
    case DefectKind::taken_from_neighbour:
    case DefectKind::doubled:
    case DefectKind::sides_exchanged:
    case DefectKind::other:
      return true;
    default:
      return false;
  }
}

}  // namespace

double structure_confidence(const FittedStructure& one, const StructureSigns& signs, const RepairedStructure& found) {
  if (!one.fit) return 0;
  double lost = 0;
  for (const auto& [other, share] : signs.lost_to) lost = std::max(lost, share);
  const bool any_large = std::ranges::any_of(found.defects, [](const Defect& defect) { return is_large(defect.kind); });
  const double named = std::clamp(found.p_named, 0.02, 0.98);
  // A logistic regression on 697 right and wrong structures of four subjects [docs/measurements/repair.md].
  const double x = 3.95 - 1.76 * part(one.judgement.doubt_share, most_doubt_share, 3) -
                   3.49 * part(one.off_place, 0.25, 2) - 0.77 * part(lost, 0.05, 2) -
                   2.01 * part(signs.holes + signs.bridges, 0.1, 2) + 1.4 * std::log(named / (1 - named)) -
                   (any_large ? 3.06 : 0);
  return 1 / (1 + std::exp(-x));
}

double structure_confidence(const FittedStructure& one) {
  RepairedStructure unknown;
  unknown.p_named = std::min(0.9, one.p_named);  // of most nobody looked
  return structure_confidence(one, {}, unknown);
}

}  // namespace homolog
