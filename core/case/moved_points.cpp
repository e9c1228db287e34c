#include "core/case/moved_points.h"

#include <cstdint>

namespace homolog {

namespace {

constexpr double farthest_steps = 1 << 29;  // so that a move has 32 bits

// A move of a coordinate by d steps is kept as 1 + 2·z + p: z = 2d for d ≥ 0 and −2d − 1 below, so that short moves are
// small numbers; p is the parity of the grid's number that the coordinate was rounded to before, so that a coordinate
// half-way between two of them cannot be rounded to the other one by a replay that differs in the last bit. 0 stays.

std::uint32_t move_of(std::int64_t from, std::int64_t to) {
  const std::int64_t d = to - from;
  return static_cast<std::uint32_t>(1 + 2 * (d >= 0 ? 2 * d : -2 * d - 1) + (from & 1));
}

double moved(double before, std::uint32_t move) {
  const std::int64_t rest = std::int64_t{move} - 1, parity = rest & 1, z = rest >> 1;
  const std::int64_t d = (z & 1) == 0 ? z / 2 : -(z + 1) / 2;
  const auto pairs =
      static_cast<std::int64_t>(std::nearbyint((before * steps_per_mm - static_cast<double>(parity)) / 2));
  return static_cast<double>(2 * pairs + parity + d) / steps_per_mm;
}

}  // namespace

std::optional<MovePoints> moves_of(const Points& before, const SetPoints& edit) {
  if (!edit.points || edit.points->rows() != before.rows()) return std::nullopt;
  std::vector<std::uint32_t> moves(static_cast<std::size_t>(before.size()), 0);
  for (Eigen::Index k = 0; k < before.size(); ++k) {
    const double from = before.data()[k] * steps_per_mm, to = edit.points->data()[k] * steps_per_mm;
    if (from == to) continue;
    if (!(std::abs(from) < farthest_steps) || !(std::abs(to) < farthest_steps) || std::nearbyint(to) != to)
      return std::nullopt;
    moves[k] = move_of(static_cast<std::int64_t>(std::nearbyint(from)), static_cast<std::int64_t>(to));
  }
  return MovePoints{.by = edit.by,
                    .placement = edit.placement,
                    .moves = std::make_shared<const std::vector<std::uint32_t>>(std::move(moves)),
                    .of_frame = edit.of_frame,
                    .doubt = edit.doubt,
                    .doubt_mm = edit.doubt_mm,
                    .outlier = edit.outlier};
}

Result<SetPoints> points_of(const Points& before, const MovePoints& edit) {
  if (!edit.moves || edit.moves->size() != static_cast<std::size_t>(before.size())) {
    return fail("points", std::to_string(edit.moves ? edit.moves->size() / 3 : 0) + " were given for " +
                              std::to_string(before.rows()) + " vertices");
  }
  Points points = before;
  for (Eigen::Index k = 0; k < points.size(); ++k)
    if (const std::uint32_t move = (*edit.moves)[k]; move != 0) points.data()[k] = moved(points.data()[k], move);
  return SetPoints{.by = edit.by,
                   .placement = edit.placement,
                   .points = std::make_shared<const Points>(std::move(points)),
                   .of_frame = edit.of_frame,
                   .doubt = edit.doubt,
                   .doubt_mm = edit.doubt_mm,
                   .outlier = edit.outlier};
}

}  // namespace homolog
