#include "core/groupwise/cohort_doubt.h"

#include <algorithm>
#include <optional>

#include "core/adapt/judge_fit.h"
#include "core/base/numbers/statistics.h"
#include "core/base/processes/parallel.h"
#include "core/template/template.h"

namespace homolog {

namespace {

constexpr double counted_ways = 0.7;  ///< the quantile of the ways that is taken
/// As squares: what is left of the fit's own doubt, and how much the ways' spread counts. Subjects differ from each
/// other in what they share against the template, too, so ways go less far apart than they are off.
constexpr double own_left = 0.6, spread_counts = 3;

}  // namespace

std::vector<std::size_t> third_subjects(const std::vector<const FitResult*>& fits, std::size_t count) {
  std::vector<std::pair<double, std::size_t>> by_doubt;
  for (std::size_t k = 0; k < fits.size(); ++k)
    if (fits[k] != nullptr && !fits[k]->mirrored && !fits[k]->half_turned)
      by_doubt.emplace_back(share_of_doubt(*fits[k]), k);
  std::sort(by_doubt.begin(), by_doubt.end());
  std::vector<std::size_t> chosen;
  for (std::size_t k = 0; k < std::min(count, by_doubt.size()); ++k) chosen.push_back(by_doubt[k].second);
  return chosen;
}

Result<VertexScalars> spread_by_others_mm2(const Template& the_template, const std::vector<const Points*>& others,
                                           const Boundary& boundary, const FitOptions& options, const FitResult& fit) {
  FitOptions going = options;
  going.landmarks.clear();
  going.placement.reset();
  going.show = {};
  std::vector<std::optional<Points>> ways(others.size());
  for_each_in_parallel(others.size(), [&](std::size_t k) {
    std::optional<Progress> own;
    if (options.progress != nullptr) own.emplace(*options.progress, 1.0 / static_cast<double>(others.size()));
    FitOptions fitting = going;
    fitting.progress = own ? &*own : nullptr;
    const auto other = make_template({*others[k], the_template.topology->triangles()}, "third subject");
    if (!other) return;
    if (auto way = fit_to_boundary(**other, boundary, fitting)) ways[k] = std::move(way->mesh.points);
  });
  if (options.progress != nullptr && options.progress->cancelled()) return fail("", "the fit was cancelled");
  std::vector<const Points*> reached;
  for (const auto& way : ways)
    if (way) reached.push_back(&*way);
  if (reached.size() < 2) return VertexScalars();
  VertexScalars spread_mm2(fit.mesh.points.rows());
  std::vector<double> apart_mm2(reached.size());
  for (Eigen::Index i = 0; i < spread_mm2.size(); ++i) {
    for (std::size_t k = 0; k < reached.size(); ++k)
      apart_mm2[k] = (reached[k]->row(i) - fit.mesh.points.row(i)).squaredNorm();
    spread_mm2[i] = quantile(apart_mm2, counted_ways);
  }
  return spread_mm2;
}

VertexScalars doubt_among_others_mm(const VertexScalars& doubt_mm, const VertexScalars& spread_mm2) {
  if (spread_mm2.size() != doubt_mm.size()) return doubt_mm;
  return (own_left * doubt_mm.array().square() + spread_counts * spread_mm2.array()).sqrt();
}

}  // namespace homolog
