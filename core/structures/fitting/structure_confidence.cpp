#include "core/structures/fitting/structure_confidence.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace homolog {

namespace {

/// A value as a share of what is much, at most `most` of it.
double part(double value, double much, double most) {
  return std::clamp(value / much, 0.0, most);
}

double has(const RepairedStructure& found, std::initializer_list<DefectKind> kinds) {
  const auto is_one = [&](const Defect& defect) { return std::ranges::find(kinds, defect.kind) != kinds.end(); };
  return std::ranges::any_of(found.defects, is_one) ? 1 : 0;
}

/// The probability that the form is right.
double form_confidence(const FittedStructure& one, const StructureSigns& signs, const RepairedStructure& found) {
  using enum DefectKind;
  // The fit of a template that is cut off says nothing where it does not match: so many are right of all.
  constexpr double usual = 0.85;
  if (one.judgement.doubtful && !one.fit->template_cuts.empty()) return usual;
  constexpr double most_doubts = 6;  // then nothing of the form is sure
  double lost = 0;
  for (const auto& [other, share] : signs.lost_to) lost = std::max(lost, share);
  // A logistic regression on right and wrong structures of two people [docs/measurements/repair.md].
  const double x = 7.0 - 1.8 * part(one.judgement.doubt_share, most_doubt_share, most_doubts) -
                   2 * part(one.off_place, 0.25, 2) - 0.6 * part(lost, 0.05, 4) -
                   3.9 * has(found, {given_to_neighbour}) - 0.6 * has(found, {taken_from_neighbour}) -
                   2.1 * has(found, {half_missing, doubled, sides_exchanged, other}) -
                   1.3 * part(signs.lacking, 0.15, 3) - 1.5 * part(signs.tunnels + signs.bars, 0.02, 3);
  const double confidence = 1 / (1 + std::exp(-x));
  // Without a neighbour that says where it belongs a half that is missing is not seen.
  return one.off_place < 0 ? std::min(usual, confidence) : confidence;
}

}  // namespace

double structure_confidence(const FittedStructure& one, const StructureSigns& signs, const RepairedStructure& found) {
  if (!one.fit) return 0;
  return std::clamp(found.p_named, 0.0, 1.0) * form_confidence(one, signs, found);
}

double structure_confidence(const FittedStructure& one) {
  RepairedStructure unknown;
  unknown.p_named = std::min(0.97, one.p_named);  // so many names are right where nobody looked
  return structure_confidence(one, {}, unknown);
}

}  // namespace homolog
