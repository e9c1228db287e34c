#include "core/groupwise/suited_template.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "core/adapt/fit.h"
#include "core/adapt/judge_fit.h"
#include "core/base/processes/parallel.h"
#include "core/groupwise/consensus.h"
#include "core/groupwise/other_organs.h"

namespace homolog {

namespace {

constexpr const char* cancelled_words = "the making of the template was cancelled";

bool is_cancelled(const Progress* progress) {
  return progress != nullptr && progress->cancelled();
}

/// Evenly taken from those in `order`, the first and the last among them.
std::vector<std::size_t> some_of(const std::vector<std::size_t>& order, std::size_t most) {
  if (order.size() <= most) return order;
  std::vector<std::size_t> some;
  for (std::size_t k = 0; k < most; ++k) some.push_back(order[k * (order.size() - 1) / (most - 1)]);
  return some;
}

}  // namespace

Result<std::vector<std::size_t>> nearest_to_mean(const std::vector<Boundary>& subjects, std::size_t most, int vertices,
                                                 Progress* progress) {
  const auto order = subjects_by_size(subjects);
  const auto own = own_template(subjects[order[order.size() / 2]], vertices);
  if (!own) return fail(own.error());
  const auto start = make_template({own->mesh.points, own->mesh.topology->triangles()}, "start");
  if (!start) return fail(start.error());
  std::vector<std::optional<Points>> fits(order.size());
  for_each_in_parallel(order.size(), [&](std::size_t k) {
    FitOptions fitting;
    std::optional<Progress> of_fit;
    if (progress != nullptr) fitting.progress = &of_fit.emplace(*progress, 1 / static_cast<double>(order.size()));
    if (auto fit = fit_to_boundary(**start, subjects[order[k]], fitting)) fits[k] = std::move(fit->mesh.points);
    if (of_fit) of_fit->report(1);
  });
  if (is_cancelled(progress)) return fail("", cancelled_words);
  const auto distances = shape_shares(as_columns(fits, own->mesh.points.rows()));
  std::vector<std::pair<double, std::size_t>> ranked;  // distance from the mean, position in `order`
  for (std::size_t k = 0, fitted = 0; k < order.size(); ++k)
    ranked.emplace_back(fits[k] ? distances[fitted++] : std::numeric_limits<double>::infinity(), k);
  std::sort(ranked.begin(), ranked.end());
  std::vector<std::size_t> nearest;
  for (const auto& [distance, k] : ranked)
    if (nearest.size() < most) nearest.push_back(order[k]);
  return nearest;
}

bool Suitability::better_than(const Suitability& other) const {
  const auto ours = doubtful * other.fits, theirs = other.doubtful * fits;
  return ours != theirs ? ours < theirs : assd_mm < other.assd_mm;
}

Result<Suitability> suitability(const Template& the_template, std::size_t own, const std::vector<Boundary>& subjects,
                                std::size_t most_others, Progress* progress) {
  auto others = subjects_by_size(subjects);
  std::erase(others, own);
  others = some_of(others, most_others);
  std::vector<std::optional<FitJudgement>> judged(others.size());
  for_each_in_parallel(others.size(), [&](std::size_t k) {
    FitOptions fitting;
    std::optional<Progress> of_fit;
    if (progress != nullptr) fitting.progress = &of_fit.emplace(*progress, 1 / static_cast<double>(others.size()));
    const Boundary& boundary = subjects[others[k]];
    if (const auto fit = fit_to_boundary(the_template, boundary, fitting))
      judged[k] = judge_fit(the_template, boundary, fitting, *fit);
    if (of_fit) of_fit->report(1);
  });
  if (is_cancelled(progress)) return fail("", cancelled_words);
  Suitability suits{.fits = others.size()};
  std::size_t fitted = 0;
  for (const auto& one : judged) {
    suits.doubtful += !one || one->doubtful ? 1 : 0;
    if (!one) continue;
    ++fitted;
    suits.assd_mm += one->inside_scan.assd_mm;
    suits.doubt_share += one->doubt_share;
  }
  const double count = fitted > 0 ? static_cast<double>(fitted) : 1;
  suits.assd_mm /= count;
  suits.doubt_share /= count;
  return suits;
}

}  // namespace homolog
