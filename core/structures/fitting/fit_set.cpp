#include "core/structures/fitting/fit_set.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <utility>

#include "core/adapt/labels/label_fit.h"
#include "core/base/processes/parallel.h"
#include "core/deform/fold_guard.h"
#include "core/mesh/mesh_quality.h"
#include "core/structures/fitting/keep_apart.h"
#include "core/structures/fitting/neighbours_say.h"
#include "core/structures/fitting/share_vertices.h"
#include "core/structures/fitting/structure_confidence.h"
#include "core/structures/naming/level_names.h"

namespace homolog {

namespace {

constexpr double much_off_place = 0.25;  ///< share of the size: then its neighbours have a say in where it starts

/// What has a level lies in the middle of the body, and is about its own mirror image.
bool has_side(const TemplateOfSet& structure) {
  return structure.side != Side::none || !structure.partner.empty() || !level_in_name(structure.name);
}

/// `structure`: by its place in the set. `chosen_mm`: a closing that was chosen; none: the usual one, and wider ones
/// where they may help.
Result<LabelFit> try_fit(const Template& the_template, const SetInMap& subject, std::size_t structure,
                         const FitOptions& options, const std::optional<double>& chosen_mm = std::nullopt) {
  const StructureInMap& there = subject.structures[structure];
  // What a part of a label faces are the other labels.
  if (there.soft && !the_template.faced)
    return fit_to_label(the_template, {.map = *there.soft, .label = 1}, {.closing_mm = chosen_mm, .largest_part = true},
                        options);
  const MapLabel label{.map = *there.mask, .label = there.segment.value, .known = subject.known[there.segment.layer]};
  return fit_to_label(the_template, label, {.closing_mm = chosen_mm, .largest_part = true}, options);
}

/// How far two placements of a template lie apart, by its size.
double apart(const Template& the_template, const Similarity& a, const Similarity& b) {
  const Points there = a.apply(the_template.points);
  const Points difference = there - b.apply(the_template.points);
  return std::sqrt(difference.rowwise().squaredNorm().mean()) / bounds_of(there).diagonal().norm();
}

void take(LabelFit&& found, FittedStructure& into, std::optional<Boundary>& boundary) {
  boundary = std::move(found.boundary);
  into.why_whole = boundary->why_whole;
  into.fit = std::move(found.fit);
  into.judgement = std::move(found.judgement);
  into.closing_mm = found.closing_mm;
}

/// Whether a fit is better than another of the same structure.
bool better(const FitJudgement& a, const FitJudgement& b) {
  if (a.doubtful != b.doubtful) return !a.doubtful;
  if (a.rim && b.rim) return a.inside_scan.assd_mm < b.inside_scan.assd_mm;  // Dice would compare caps
  return a.inside_scan.dice > b.inside_scan.dice;
}

/// Once more, from where its neighbours say; the better of both fits is kept. What closing helps has been tried, where
/// `tried_wider`.
void fit_by_neighbours(const Template& the_template, const SetInMap& subject, std::size_t structure,
                       const Similarity& place, bool tried_wider, FitOptions options, FittedStructure& fitted,
                       std::optional<Boundary>& boundary) {
  options.placement = place;
  auto found =
      try_fit(the_template, subject, structure, options, tried_wider ? std::optional(fitted.closing_mm) : std::nullopt);
  if (!found || (fitted.fit && !better(found->judgement, fitted.judgement))) return;
  take(std::move(*found), fitted, boundary);
  fitted.by_neighbours = true;
  fitted.why_not.clear();
}

/// The pairs that have to be kept apart: all whose labels do not overlap, whatever their layers.
std::vector<MeshPair> pairs_to_keep_apart(const SetInMap& subject, const std::vector<std::size_t>& fitted) {
  std::vector<MeshPair> pairs;
  for (std::size_t a = 0; a < fitted.size(); ++a)
    for (std::size_t b = a + 1; b < fitted.size(); ++b)
      if (subject.lie_apart(fitted[a], fitted[b])) pairs.push_back({a, b});
  return pairs;
}

/// Judges a structure anew whose mesh was moved: what is told is of the mesh as it is now.
void judge_moved(const Template& the_template, const Boundary& boundary, Mesh mesh, FittedStructure& one) {
  FitResult& fit = *one.fit;
  if (fit.doubt_mm.size() > 0)
    fit.doubt_mm =
        (fit.doubt_mm.array().square() + (mesh.points - fit.mesh.points).rowwise().squaredNorm().array()).sqrt();
  fit.mesh = std::move(mesh);
  fit.landmarks = carried_landmarks(the_template, fit.mesh.points);
  fit.turned_triangles =
      turned_triangles(*fit.mesh.topology, fit.placement.apply(the_template.points), fit.mesh.points).size();
  fit.self_intersections = self_intersections(fit.mesh).size();
  one.judgement = judge_fit(the_template, boundary, {}, fit);
}

/// Why somebody has to look at a structure that another one is too near to.
std::string too_near(const std::string& other, const KeptApart& pair) {
  char text[160];
  if (pair.mm < 0)
    std::snprintf(text, sizeof text, "it lies up to %.1f mm within %s, since it could not move farther without folds",
                  -pair.mm, other.c_str());
  else
    std::snprintf(text, sizeof text,
                  "it came only %.1f mm apart from %s, since it could not move farther without folds", pair.mm,
                  other.c_str());
  return text;
}

/// Structures that are too near to each other are doubtful; where one of two was already, it is that one.
void doubt_near(const SetOfTemplates& set, FittedSet& result) {
  constexpr double hardly = 0.5;
  std::vector<char> doubtful;
  for (const FittedStructure& one : result.structures) doubtful.push_back(one.judgement.doubtful ? 1 : 0);
  for (const KeptApart& pair : result.apart) {
    if (!pair.too_near) continue;
    for (const auto& [own, other] : {std::pair{pair.a, pair.b}, std::pair{pair.b, pair.a}}) {
      if (doubtful[own] == 0 && doubtful[other] != 0) continue;
      FittedStructure& one = result.structures[own];
      one.judgement.doubtful = true;
      one.judgement.warnings.push_back(too_near(set.set.structures[other].name, pair));
      one.confidence = std::min(one.confidence, hardly);
    }
  }
}

/// Keeps the fitted meshes apart, and brings vertices that are shared to one place.
void settle(const SetOfTemplates& set, const SetInMap& subject, double gap_mm,
            const std::vector<std::optional<Boundary>>& boundaries, FittedSet& result) {
  constexpr double touching_mm = 0.1;
  std::vector<std::size_t> fitted;
  std::vector<Mesh> meshes;
  std::vector<char> doubtful;
  std::vector<std::string> names;
  for (std::size_t k = 0; k < result.structures.size(); ++k) {
    const FittedStructure& one = result.structures[k];
    if (!one.fit) continue;
    fitted.push_back(k);
    meshes.push_back(one.fit->mesh);
    doubtful.push_back(one.judgement.doubtful ? 1 : 0);
    names.push_back(set.set.structures[k].name);
  }
  const auto pairs = pairs_to_keep_apart(subject, fitted);
  const auto left_mm = keep_apart(meshes, pairs, gap_mm, doubtful);
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    result.apart.push_back({fitted[pairs[p][0]], fitted[pairs[p][1]], gap_mm - left_mm[p], left_mm[p] > touching_mm});
    result.depth_mm = std::max(result.depth_mm, left_mm[p] - gap_mm);
  }
  join_shared(set.set.shared, names, meshes);
  for_each_in_parallel(fitted.size(), [&](std::size_t f) {
    FittedStructure& one = result.structures[fitted[f]];
    if (meshes[f].points == one.fit->mesh.points) return;
    judge_moved(*set.templates[fitted[f]], *boundaries[fitted[f]], std::move(meshes[f]), one);
  });
}

}  // namespace

Result<FittedSet> fit_set(const SetOfTemplates& set, const SetInMap& subject, const FitSetOptions& options) {
  const std::size_t count = set.templates.size();
  FittedSet result;
  result.structures.resize(count);
  Progress unseen;
  Progress& progress = options.progress != nullptr ? *options.progress : unseen;
  const auto tell = [&](std::size_t k, SetFitStep step) {
    if (options.tell) options.tell(k, step);
  };
  const auto tell_result = [&](std::size_t k) {
    tell(k, result.structures[k].fit ? SetFitStep::fitted : SetFitStep::failed);
  };
  const auto fit_some = [&](const std::vector<std::size_t>& which, double share, const auto& work) {
    for_each_in_parallel(which.size(), [&](std::size_t k) {
      Progress own(progress, share / static_cast<double>(which.size()));
      FitOptions fitting;
      fitting.progress = &own;
      fitting.has_side = has_side(set.set.structures[which[k]]);
      if (!own.cancelled()) work(which[k], fitting);
      own.part(0, 1);
      own.report(1);
    });
  };
  std::vector<std::optional<Boundary>> boundaries(count);
  std::vector<std::size_t> there;
  std::vector<char> tried_wider(count);
  for (std::size_t k = 0; k < count; ++k) result.structures[k].why_not = subject.structures[k].why_left_out;
  for (std::size_t k = 0; k < count; ++k)
    if (subject.structures[k].is_there() && set.templates[k] != nullptr) there.push_back(k);
  fit_some(there, 0.7, [&](std::size_t k, const FitOptions& fitting) {
    tell(k, SetFitStep::runs);
    auto found = try_fit(*set.templates[k], subject, k, fitting);
    if (found) tried_wider[k] = found->tried.empty() ? 0 : 1;
    if (found)
      take(std::move(*found), result.structures[k], boundaries[k]);
    else
      result.structures[k].why_not = found.error().what;
    tell_result(k);
  });
  std::vector<std::size_t> again;
  std::vector<std::optional<Similarity>> said(count);
  for (const std::size_t k : there) {
    FittedStructure& one = result.structures[k];
    said[k] = said_by_neighbours(set, result.structures, k);
    if (!said[k]) continue;
    if (one.fit) one.off_place = apart(*set.templates[k], *said[k], one.fit->placement);
    if (!one.fit || one.judgement.doubtful || one.off_place > much_off_place) again.push_back(k);
  }
  if (again.empty()) Progress(progress, 0.3).report(1);
  fit_some(again, 0.3, [&](std::size_t k, const FitOptions& fitting) {
    tell(k, SetFitStep::runs_again);
    fit_by_neighbours(*set.templates[k], subject, k, *said[k], tried_wider[k] != 0, fitting, result.structures[k],
                      boundaries[k]);
    tell_result(k);
  });
  if (progress.cancelled()) return fail("", "the fit was cancelled");
  settle(set, subject, options.gap_mm, boundaries, result);
  for (const std::size_t k : there) {
    FittedStructure& one = result.structures[k];
    if (!one.fit) continue;
    if (said[k]) one.off_place = apart(*set.templates[k], *said[k], one.fit->placement);
    one.confidence = structure_confidence(one);
  }
  doubt_near(set, result);
  return result;
}

}  // namespace homolog
