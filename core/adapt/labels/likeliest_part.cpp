#include "core/adapt/labels/likeliest_part.h"

#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/adapt/judge_fit.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

constexpr std::size_t most_parts = 4;
constexpr double clearly_less = 0.9;  ///< times the doubt of another part; above, nobody can tell

/// Whether the mirror image fits better, and the doubt as a share of the part's size.
using Unlikeness = std::pair<bool, double>;
constexpr Unlikeness unfitted{true, std::numeric_limits<double>::infinity()};

}  // namespace

Result<Boundary> likeliest_part(const Template& the_template, Boundary largest,
                                const std::function<Result<Boundary>(std::size_t rank)>& part,
                                const FitOptions& options) {
  if (largest.parts_alike < 2) return largest;
  FitOptions trying = options;
  trying.progress = nullptr;
  trying.show = {};
  Unlikeness least = unfitted, second = unfitted;
  std::size_t chosen = 0;
  Boundary taken = std::move(largest);
  const std::size_t parts = std::min(taken.parts_alike, most_parts);
  for (std::size_t rank = 0; rank < parts; ++rank) {
    if (options.progress != nullptr && options.progress->cancelled()) return fail("", "the fit was cancelled");
    auto boundary = rank == 0 ? Result<Boundary>(taken) : part(rank);
    if (!boundary) continue;
    const auto fit = fit_to_boundary(the_template, *boundary, trying);
    if (!fit) continue;
    const Unlikeness unlike{fit->mirrored, share_of_doubt(*fit)};
    if (unlike < least) {
      second = std::exchange(least, unlike);
      taken = std::move(*boundary);
      chosen = rank;
    } else if (unlike < second) {
      second = unlike;
    }
  }
  const bool sure = least < unfitted && (second.first != least.first || least.second < clearly_less * second.second);
  taken.warnings.push_back(
      "of its parts of about one size the " +
      std::string(chosen == 0 ? "largest" : "one of rank " + std::to_string(chosen + 1) + " in size") +
      " is most like the template and was taken" +
      (sure ? "" : ", but another is nearly as like; check it, or give the parts labels of their own"));
  return taken;
}

}  // namespace homolog
