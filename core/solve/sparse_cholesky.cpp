#include "core/solve/sparse_cholesky.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "core/solve/dense_front.h"
#include "core/solve/substitution.h"

namespace homolog {

namespace {

using Eigen::Index;
using Front = EliminationPlan::Front;

constexpr double unknown_value = std::numeric_limits<double>::quiet_NaN();  // which differs from every value

/// Of fours of L, 8 MB in double precision: from about here on it does not stay in a processor's caches.
constexpr Index large = Index{1} << 18;
/// Half the range of B/s up to which a factor in single precision is exact enough.
constexpr double most_short = 80;

}  // namespace

/// Where the numbers of a front lie apart while it is solved for: its pivots, a block of them, the rows below.
struct SparseCholesky::Rooms {
  Apart own, below, block;
};

/// Solving reads up to three columns more than a front has.
Index SparseCholesky::beyond() const {
  return 3 * plan_->most_fours();
}

SparseCholesky::SparseCholesky(std::shared_ptr<const EliminationPlan> plan)
    : plan_(std::move(plan)),
      entries_(plan_->entries().size(), unknown_value),
      factor_(std::make_unique_for_overwrite<FourRows[]>(plan_->panel_fours() + beyond())),
      updates_(std::make_unique_for_overwrite<FourRows[]>(plan_->update_fours())) {
  std::fill_n(factor_.get() + plan_->panel_fours(), beyond(), FourRows{});
  if (plan_->panel_fours() <= large) return;
  short_factor_ = std::make_unique_for_overwrite<FourShortRows[]>(plan_->panel_fours() + beyond());
  std::fill_n(short_factor_.get() + plan_->panel_fours(), beyond(), FourShortRows{});
  corrections_.assign(plan_->places(), 1.0);
}

/// Takes over the front's entries of A; whether any differs.
bool SparseCholesky::take_entries(int f, const VertexScalars& diagonal, const VertexScalars& weights) {
  const Front& front = plan_->fronts()[f];
  const std::vector<int>& start = plan_->entry_start();
  bool changed = false;
  for (int column = front.first; column < front.first + front.pivots; ++column) {
    for (int k = start[column]; k < start[column + 1]; ++k) {
      const double entry = k == start[column] ? diagonal[column] : -weights[plan_->entries()[k].value];
      changed |= entry != entries_[k];
      entries_[k] = entry;
    }
  }
  return changed;
}

/// Writes the front's entries of A and its children's updates where it is going to be factorised.
void SparseCholesky::assemble(int f) {
  const Front& front = plan_->fronts()[f];
  const Index fours = front.fours(), row_fours = front.row_fours(), below = 4 * front.pivot_fours();
  double* const panel = reinterpret_cast<double*>(factor_.get() + front.panel);
  double* const update = reinterpret_cast<double*>(updates_.get() + front.update);
  std::fill_n(panel, 4 * fours * front.pivots, 0.0);
  std::fill_n(update, 8 * row_fours * (row_fours + 1), 0.0);
  const std::vector<int>& start = plan_->entry_start();
  for (int column = 0; column < front.pivots; ++column) {
    for (int k = start[front.first + column]; k < start[front.first + column + 1]; ++k)
      panel[4 * fours * column + plan_->entries()[k].place] = entries_[k];
  }
  for (const int c : plan_->children(f)) {
    const Front& child = plan_->fronts()[c];
    const auto* const taken = reinterpret_cast<const double*>(updates_.get() + child.update);
    const auto to = plan_->places_in_parent(c);
    const Index child_fours = child.row_fours();
    for (std::size_t column = 0; column < to.size(); ++column) {
      const double* const from = taken + 4 * triangle_column(static_cast<Index>(column), child_fours);
      double* const into = to[column] < below ? panel + 4 * fours * to[column]
                                              : update + 4 * triangle_column(to[column] - below, row_fours) - below;
      for (std::size_t row = column; row < to.size(); ++row) into[to[row]] += from[row];
    }
  }
}

/// Keeps a front in single precision. The rounding of the diagonal would weigh most; it is made good for when solving.
void SparseCholesky::shorten(int f) {
  const Front& front = plan_->fronts()[f];
  const Index fours = front.fours();
  const auto* const panel = reinterpret_cast<const Lanes*>(factor_.get() + front.panel);
  auto* const to = reinterpret_cast<FourFloats*>(short_factor_.get() + front.panel);
  constexpr double least = 1e-30;  // what is smaller counts for nothing and is slow
  for (Index i = 0; i < fours * front.pivots; ++i) {
    const Lanes value = panel[i];
    to[i] = __builtin_convertvector((value > least || value < -least) ? value : Lanes{}, FourFloats);
  }
  for (Index k = 0; k < front.pivots; ++k) {
    const double diagonal = reinterpret_cast<const double*>(panel + k * fours)[k];
    corrections_[front.first + k] = diagonal / static_cast<double>(static_cast<float>(diagonal));
  }
}

bool SparseCholesky::factorise_stale(const VertexScalars& diagonal, const VertexScalars& weights) {
  fronts_factorised_ = 0;
  std::vector<char> stale(plan_->fronts().size());
  for (int f = 0; f < static_cast<int>(stale.size()); ++f) {
    const Front& front = plan_->fronts()[f];
    if (!take_entries(f, diagonal, weights) && !stale[f]) continue;
    assemble(f);
    auto* const panel = reinterpret_cast<Lanes*>(factor_.get() + front.panel);
    auto* const update = reinterpret_cast<Lanes*>(updates_.get() + front.update);
    if (!run_widest([&] { return factorise_panel(panel, front.pivots, front.fours(), update); })) return false;
    run_widest([&] { invert_blocks(panel, front.pivots, front.fours()); });
    if (short_factor_) run_widest([&] { shorten(f); });
    ++fronts_factorised_;
    if (front.parent >= 0) stale[front.parent] = true;
  }
  return true;
}

bool SparseCholesky::factorise(const VertexScalars& s, const VertexScalars& weights) {
  assert(s.size() == plan_->unknowns() && weights.size() == plan_->edges());
  VertexScalars diagonal = VertexScalars::Zero(plan_->places());  // in the order of elimination
  const std::vector<int>& start = plan_->entry_start();
  for (int column = 0; column < plan_->places(); ++column) {
    if (start[column] == start[column + 1]) continue;  // no unknown's
    diagonal[column] += s[plan_->entries()[start[column]].value];
    for (int k = start[column] + 1; k < start[column + 1]; ++k) {
      const EliminationPlan::Entry& entry = plan_->entries()[k];
      diagonal[column] += weights[entry.value];
      diagonal[entry.row] += weights[entry.value];
    }
  }
  const bool usable = (s.array() > 0).all() && (weights.array() >= 0).all() && diagonal.allFinite();
  const bool done = usable && factorise_stale(diagonal, weights);
  if (!done) std::fill(entries_.begin(), entries_.end(), unknown_value);
  s_ = s;
  return done;
}

/// L y = x for a front's pivots; what they take from the rows below is subtracted there.
template <int Components, class Number, class Value>
void SparseCholesky::forward(const Number* a, const double* corrections, int f, const Rooms& rooms, Value* x) const {
  const Front& front = plan_->fronts()[f];
  const int own_fours = front.pivot_fours(), row_fours = front.row_fours();
  const Index height = 4 * front.fours();
  Value* const own = x + front.first;
  take_apart([&](int i) -> const Value& { return own[i]; }, own_fours, rooms.own);
  for (int first = 0; first < front.pivots; first += block_pivots, a += block_pivots * height) {
    const int pivots = std::min(block_pivots, front.pivots - first), fours = (pivots + 3) / 4;
    const Apart block = rooms.own.from(first);
    multiply<Components, Into::set>(a + first, height, fours, pivots, block, rooms.block);
    copy<Components>(rooms.block, fours, corrections == nullptr ? nullptr : corrections + first, block);
    const int next = first + block_pivots;
    multiply<Components, Into::subtract>(a + next, height, own_fours - next / 4, pivots, block, rooms.own.from(next));
    if (first == 0) {
      multiply<Components, Into::set>(a + 4 * own_fours, height, row_fours, pivots, block, rooms.below);
    } else {
      multiply<Components, Into::add>(a + 4 * own_fours, height, row_fours, pivots, block, rooms.below);
    }
  }
  put_together<Value>(rooms.own, own_fours, [&](int i, const Value& y) { own[i] = y; });
  const int* const row = plan_->rows(f).data();
  put_together<Value>(rooms.below, row_fours, [&](int i, const Value& taken) { x[row[i]] -= taken; });
}

/// Lᵀ y = x for a front's pivots; the rows below are the solution already.
template <int Components, class Number, class Value>
void SparseCholesky::backward(const Number* a, const double* corrections, int f, const Rooms& rooms, Value* x) const {
  const Front& front = plan_->fronts()[f];
  const int own_fours = front.pivot_fours(), row_fours = front.row_fours();
  const Index height = 4 * front.fours();
  Value* const own = x + front.first;
  const int* const row = plan_->rows(f).data();
  take_apart([&](int i) -> const Value& { return own[i]; }, own_fours, rooms.own);
  take_apart([&](int i) -> const Value& { return x[row[i]]; }, row_fours, rooms.below);
  const int last = (front.pivots - 1) / block_pivots * block_pivots;
  a += last * height;
  for (int first = last; first >= 0; first -= block_pivots, a -= block_pivots * height) {
    const int pivots = std::min(block_pivots, front.pivots - first), next = first + block_pivots;
    const Apart block = rooms.own.from(first);
    multiply_transposed<Components, Into::subtract>(a + next, height, own_fours - next / 4, pivots,
                                                    rooms.own.from(next), block);
    multiply_transposed<Components, Into::subtract>(a + 4 * own_fours, height, row_fours, pivots, rooms.below, block);
    const int fours = (pivots + 3) / 4;
    copy<Components>(block, fours, corrections == nullptr ? nullptr : corrections + first, rooms.block);
    multiply_transposed<Components, Into::set>(a + first, height, fours, pivots, rooms.block, block);
  }
  put_together<Value>(rooms.own, own_fours, [&](int i, const Value& z) { own[i] = z; });
}

/// L y = x, then Lᵀ z = y, in place and in the order of elimination.
template <class Number, class Value>
void SparseCholesky::substitute(const Number* factor, const double* corrections, Value* x) const {
  constexpr int components = std::is_same_v<Value, double> ? 1 : 3;
  const Index room = 4 * plan_->most_fours() + 4, all = 2 * room + block_pivots;
  const auto numbers = std::make_unique_for_overwrite<double[]>(components * all);
  const Rooms rooms{{numbers.get(), all}, {numbers.get() + room, all}, {numbers.get() + 2 * room, all}};
  const std::vector<Front>& fronts = plan_->fronts();
  const auto corrections_of = [&](const Front& front) {
    return corrections == nullptr ? nullptr : corrections + front.first;
  };
  for (int f = 0; f < static_cast<int>(fronts.size()); ++f)
    forward<components>(factor + 4 * fronts[f].panel, corrections_of(fronts[f]), f, rooms, x);
  for (int f = static_cast<int>(fronts.size()); f-- > 0;)
    backward<components>(factor + 4 * fronts[f].panel, corrections_of(fronts[f]), f, rooms, x);
}

template <class Value>
void SparseCholesky::solve_in_order(Value* x, bool in_short) const {
  run_widest([&] {
    if (in_short) {
      substitute(reinterpret_cast<const float*>(short_factor_.get()), corrections_.data(), x);
    } else {
      substitute(reinterpret_cast<const double*>(factor_.get()), nullptr, x);
    }
  });
}

VertexScalars SparseCholesky::solve(const VertexScalars& b) const {
  const std::vector<int>& position = plan_->position();
  VertexScalars ordered = VertexScalars::Zero(plan_->places()), x(b.size());
  for (Index i = 0; i < b.size(); ++i) ordered[position[i]] = b[i];
  solve_in_order(ordered.data(), short_factor_ && b.cwiseQuotient(s_).cwiseAbs().maxCoeff() <= most_short);
  for (Index i = 0; i < b.size(); ++i) x[i] = ordered[position[i]];
  return x;
}

/// The middle of the range of B/s; nothing where the range is too large, or B not finite, for single precision.
std::optional<Vec3> SparseCholesky::middle_for_short(const Points& b) const {
  if (!short_factor_) return std::nullopt;
  Vec3 low = b.row(0) / s_[0], high = low;
  for (Index i = 1; i < b.rows(); ++i) {
    const Vec3 share = b.row(i) / s_[i];
    low = low.cwiseMin(share);
    high = high.cwiseMax(share);
  }
  if (!b.allFinite() || (high - low).maxCoeff() > 2 * most_short) return std::nullopt;
  return (low + high) / 2;
}

Points SparseCholesky::solve(const Points& b) const {
  const std::optional<Vec3> middle = middle_for_short(b);
  return middle ? solve_xyz(b, *middle, true) : solve_in_double(b);
}

Points SparseCholesky::solve_in_double(const Points& b) const {
  return solve_xyz(b, Vec3::Zero(), false);
}

/// A 1 = s: what a constant solves for is known, so `known` is taken off beforehand.
Points SparseCholesky::solve_xyz(const Points& b, const Vec3& known, bool in_short) const {
  const std::vector<int>& position = plan_->position();
  std::vector<FourRows> ordered(plan_->places());
  for (Index i = 0; i < b.rows(); ++i) {
    const Vec3 rest = b.row(i).transpose() - s_[i] * known;
    ordered[position[i]] = {rest[0], rest[1], rest[2], 0};
  }
  solve_in_order(reinterpret_cast<Lanes*>(ordered.data()), in_short);
  Points x(b.rows(), 3);
  for (Index i = 0; i < b.rows(); ++i)
    x.row(i) = Eigen::Map<const Eigen::RowVector3d>(ordered[position[i]].rows) + known.transpose();
  return x;
}

}  // namespace homolog
