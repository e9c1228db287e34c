#include "core/structures/variants.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/text/listed.h"
#include "core/structures/fitting/neighbours_say.h"
#include "core/structures/naming/level_names.h"

namespace homolog {

namespace {

/// Two structures that are fitted and next to each other in the set, but for those between them that the map lacks.
struct NextToEachOther {
  std::size_t a = 0, b = 0;
  std::vector<std::size_t> absent;
};

std::vector<std::size_t> neighbours_of(const SetOfTemplates& set, std::size_t k) {
  std::vector<std::size_t> near;
  for (const std::string& name : set.set.structures[k].neighbours)
    if (const TemplateOfSet* one = set.set.find(name); one != nullptr)
      near.push_back(static_cast<std::size_t>(one - set.set.structures.data()));
  return near;
}

std::vector<NextToEachOther> next_to_each_other(const SetOfTemplates& set, const SetInMap& subject,
                                                const FittedSet& fitted) {
  const std::size_t count = set.templates.size();
  const auto is_absent = [&](std::size_t k) {
    const StructureInMap& one = subject.structures[k];
    return set.templates[k] != nullptr && !one.is_there() && one.why_left_out.empty();
  };
  std::vector<NextToEachOther> pairs;
  std::vector<char> seen(count);
  for (std::size_t k = 0; k < count; ++k) {
    if (!is_absent(k) || seen[k] != 0) continue;
    std::vector<std::size_t> absent{k}, ends;
    seen[k] = 1;
    for (std::size_t at = 0; at < absent.size(); ++at)
      for (const std::size_t n : neighbours_of(set, absent[at])) {
        if (is_absent(n) && seen[n] == 0) absent.push_back(n);
        if (is_absent(n)) seen[n] = 1;
        if (fitted.structures[n].fit && std::ranges::find(ends, n) == ends.end()) ends.push_back(n);
      }
    std::ranges::sort(absent);
    std::ranges::sort(ends);
    for (std::size_t a = 0; a < ends.size(); ++a)
      for (std::size_t b = a + 1; b < ends.size(); ++b) pairs.push_back({ends[a], ends[b], absent});
  }
  for (std::size_t a = 0; a < count; ++a)
    for (const std::size_t b : neighbours_of(set, a))
      if (a < b && fitted.structures[a].fit && fitted.structures[b].fit) pairs.push_back({a, b, {}});
  return pairs;
}

/// The labels without template that lie between two places, and do not reach beyond both.
std::vector<const LabelOfMap*> labels_between(const SetInMap& subject, const Vec3& a, const Vec3& b) {
  constexpr double from = 0.1, off_line = 0.5;
  const Vec3 way = b - a;
  std::vector<const LabelOfMap*> between;
  for (const LabelOfMap& one : subject.others) {
    const Vec3 middle = one.box_mm.center() - a;
    const double share = middle.dot(way) / way.squaredNorm();
    const double extent_mm = one.box_mm.sizes().dot(way.cwiseAbs()) / way.norm();
    if (share < from || share > 1 - from || extent_mm > way.norm()) continue;
    if ((middle - share * way).norm() < off_line * way.norm()) between.push_back(&one);
  }
  return between;
}

}  // namespace

std::vector<Variant> find_variants(const SetOfTemplates& set, const SetInMap& subject, const FittedSet& fitted) {
  constexpr double farther = 1.25, nearer = 0.8;  // than in the set
  std::vector<Variant> variants;
  if (subject.others.empty()) return variants;
  const auto says_level = [&](std::size_t k) { return level_in_name(set.set.structures[k].name).has_value(); };
  for (NextToEachOther& pair : next_to_each_other(set, subject, fitted)) {
    const FitResult &a = *fitted.structures[pair.a].fit, &b = *fitted.structures[pair.b].fit;
    const Vec3 from = middle_of(a.mesh.points), to = middle_of(b.mesh.points);
    const double in_set_mm =
        (middle_of(set.templates[pair.a]->points) - middle_of(set.templates[pair.b]->points)).norm() *
        std::sqrt(a.placement.scale * b.placement.scale);
    const double ratio = (from - to).norm() / in_set_mm;
    if (ratio < farther && (ratio > nearer || pair.absent.empty())) continue;
    Variant variant{pair.a, pair.b, {}, std::move(pair.absent)};
    bool has_level = std::ranges::any_of(variant.absent, says_level);
    for (const LabelOfMap* one : labels_between(subject, from, to)) {
      variant.more.push_back(one->segment);
      has_level = has_level || level_in_name(one->segment.name);
    }
    if (variant.more.empty() || !has_level) continue;
    // Two vertebrae and the discs beside them are next to each other in several ways.
    const auto same = std::ranges::find_if(variants, [&](const Variant& known) {
      return std::ranges::any_of(known.more, [&](const Segment& segment) {
        return std::ranges::any_of(variant.more, [&](const Segment& other) {
          return segment.value == other.value && segment.layer == other.layer;
        });
      });
    });
    if (same == variants.end()) {
      variants.push_back(std::move(variant));
      continue;
    }
    for (Segment& segment : variant.more)
      if (std::ranges::none_of(same->more, [&](const Segment& known) {
            return known.value == segment.value && known.layer == segment.layer;
          }))
        same->more.push_back(std::move(segment));
    for (const std::size_t k : variant.absent)
      if (std::ranges::find(same->absent, k) == same->absent.end()) same->absent.push_back(k);
  }
  return variants;
}

bool is_absent(const std::vector<Variant>& variants, std::size_t structure) {
  return std::ranges::any_of(
      variants, [&](const Variant& one) { return std::ranges::find(one.absent, structure) != one.absent.end(); });
}

std::string sentence_of(const Variant& variant, const SetOfTemplates& set) {
  std::vector<std::string> more, absent;
  for (const Segment& segment : variant.more)
    more.push_back(segment.name.empty() ? "label " + std::to_string(segment.value) : segment.name);
  for (const std::size_t k : variant.absent) absent.push_back(set.set.structures[k].name);
  return "has " + listed(more, " and ") + " between " + set.set.structures[variant.from].name + " and " +
         set.set.structures[variant.to].name + (absent.empty() ? "" : ", and so no " + listed(absent, " and ")) +
         "; this is a variant, which is left as it is";
}

}  // namespace homolog
