#pragma once

#include <Eigen/Core>
#include <cmath>
#include <type_traits>

/// The dense arithmetic of SparseCholesky. A panel holds the columns of L of one front: `pivots` columns of `fours`
/// times four rows each, first the rows of the pivots themselves, then those below. An update is a lower triangle in
/// blocks of four columns, each block from its diagonal down.
namespace homolog {

/// Four rows of a column; or one row of x, y and z. Wider than the registers of an old processor, which takes two.
typedef double Lanes __attribute__((vector_size(32)));

/// Runs `work`, compiled for AVX2 and FMA beside the baseline, as the processor has them: half the time in the whole.
/// Results then differ in rounding between processors of the two kinds, never between runs on one.
#if defined(__x86_64__)
template <class Work>
[[gnu::target("avx2,fma"), gnu::flatten]] auto run_wide(const Work& work) {
  return work();
}
#endif
template <class Work>
auto run_widest(const Work& work) {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return run_wide(work);
#endif
  return work();
}

/// Columns are worked on in blocks of four, which stay in registers: `work` gets min(columns, 4) as a constant.
template <class Work>
auto with_width(int columns, const Work& work) {
  switch (columns) {
    case 1:
      return work(std::integral_constant<int, 1>());
    case 2:
      return work(std::integral_constant<int, 2>());
    case 3:
      return work(std::integral_constant<int, 3>());
    default:
      return work(std::integral_constant<int, 4>());
  }
}

/// Where in an update of `fours` times four rows row 0 of `column` would be.
inline Eigen::Index triangle_column(Eigen::Index column, Eigen::Index fours) {
  const Eigen::Index block = column / 4;
  return 4 * block * fours - 2 * block * (block - 1) + column % 4 * (fours - block) - block;
}

/// block −= Σ_k rows_k columns_kᵀ over `depth` columns of a panel that lie `stride` apart: an outer product of four
/// rows of each and as many others as the block has columns.
template <int Columns>
inline void subtract_products(Lanes (&block)[Columns], const Lanes* rows, const Lanes* columns, Eigen::Index stride,
                              int depth) {
  for (int k = 0; k < depth; ++k, rows += stride, columns += stride) {
    const double* l = reinterpret_cast<const double*>(columns);
#pragma GCC unroll 4
    for (int c = 0; c < Columns; ++c) block[c] -= *rows * l[c];
  }
}

/// Factorises a block of columns from `first` on; those to its left are done. False where a pivot is not positive.
template <int Columns>
inline bool factorise_columns(Lanes* panel, Eigen::Index fours, int first) {
  const Eigen::Index diagonal = first / 4;
  Lanes* const columns = panel + first * fours;
  double l[4][4] = {}, reciprocal[4] = {};  // of the diagonal block, column by column
  for (Eigen::Index row = diagonal; row < fours; ++row) {
    Lanes block[Columns];
#pragma GCC unroll 4
    for (int c = 0; c < Columns; ++c) block[c] = columns[c * fours + row];
    subtract_products(block, panel + row, panel + diagonal, fours, first);
#pragma GCC unroll 4
    for (int c = 0; c < Columns; ++c) {
#pragma GCC unroll 4
      for (int k = 0; k < c; ++k) block[c] -= block[k] * l[k][c];
      if (row == diagonal) {
        const double pivot = block[c][c];
        if (!(pivot > 0) || !std::isfinite(pivot)) return false;
        reciprocal[c] = 1 / std::sqrt(pivot);
        for (int r = c; r < Columns; ++r) l[c][r] = block[c][r] * reciprocal[c];
      }
      block[c] *= reciprocal[c];
    }
#pragma GCC unroll 4
    for (int c = 0; c < Columns; ++c) columns[c * fours + row] = block[c];
  }
  for (int c = 0; c < Columns; ++c) columns[c * fours + diagonal][c] = reciprocal[c];
  return true;
}

/// Factorises a panel in place, leaving the reciprocals of L's diagonal on it, and subtracts from `update` what its
/// pivots take from the rows below. False where a pivot is not positive.
inline bool factorise_panel(Lanes* panel, int pivots, Eigen::Index fours, Lanes* update) {
  for (int first = 0; first < pivots; first += 4) {
    const auto block = [&](auto width) { return factorise_columns<width>(panel, fours, first); };
    if (!with_width(pivots - first, block)) return false;
  }
  const Eigen::Index row_fours = fours - (pivots + 3) / 4;
  const Lanes* const below = panel + (fours - row_fours);
  for (Eigen::Index column = 0; column < row_fours; ++column) {
    Lanes* const at = update + triangle_column(4 * column, row_fours);
    const Eigen::Index stride = row_fours - column;
    for (Eigen::Index row = column; row < row_fours; ++row) {
      Lanes block[4] = {at[row], at[stride + row], at[2 * stride + row], at[3 * stride + row]};
      subtract_products(block, below + row, below + column, fours, pivots);
      for (int c = 0; c < 4; ++c) at[c * stride + row] = block[c];
    }
  }
  return true;
}

// Substitution. A right-hand side alone (Value is double) meets four rows of L at a time; three (Value is Lanes, one in
// each lane) meet one row at a time. In both, lanes x[i] meet l[i].
template <class Value>
using RowsOfL = std::conditional_t<std::is_same_v<Value, double>, Lanes, double>;

inline double sum_of(const Lanes& sum, double) {
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}
inline const Lanes& sum_of(const Lanes& sum, const Lanes&) {
  return sum;
}

template <int Columns, class Value>
inline void forward_columns(const Lanes* columns, Eigen::Index fours, int first, Value* x) {
  const double* diagonal = reinterpret_cast<const double*>(columns) + first;
  Value y[Columns];
  for (int c = 0; c < Columns; ++c) {
    y[c] = x[first + c];
    for (int k = 0; k < c; ++k) y[c] -= y[k] * diagonal[4 * k * fours + c];
    y[c] *= diagonal[4 * c * fours + c];
    x[first + c] = y[c];
  }
  constexpr Eigen::Index step = sizeof(Lanes) / sizeof(RowsOfL<Value>);
  const auto* l = reinterpret_cast<const RowsOfL<Value>*>(columns);
  Lanes* const rows = reinterpret_cast<Lanes*>(x);
  for (Eigen::Index i = step * (first / 4 + 1); i < step * fours; ++i) {
    Lanes row = rows[i];
#pragma GCC unroll 4
    for (int c = 0; c < Columns; ++c) row -= l[c * step * fours + i] * y[c];
    rows[i] = row;
  }
}

template <int Columns, class Value>
inline void backward_columns(const Lanes* columns, Eigen::Index fours, int first, Value* x) {
  constexpr Eigen::Index step = sizeof(Lanes) / sizeof(RowsOfL<Value>);
  const auto* l = reinterpret_cast<const RowsOfL<Value>*>(columns);
  const Lanes* const rows = reinterpret_cast<const Lanes*>(x);
  Lanes sum[Columns] = {};
  for (Eigen::Index i = step * (first / 4 + 1); i < step * fours; ++i) {
#pragma GCC unroll 4
    for (int c = 0; c < Columns; ++c) sum[c] += l[c * step * fours + i] * rows[i];
  }
  const double* diagonal = reinterpret_cast<const double*>(columns) + first;
  for (int c = Columns - 1; c >= 0; --c) {
    Value y = x[first + c] - sum_of(sum[c], x[first + c]);
    for (int k = c + 1; k < Columns; ++k) y -= x[first + k] * diagonal[4 * c * fours + k];
    x[first + c] = y * diagonal[4 * c * fours + c];
  }
}

/// L y = x for the pivots' rows of x, in place; the rows below are left with what y takes from them. `x` is laid out as
/// a column of the panel, its padding zero.
template <class Value>
inline void substitute_forward(const Lanes* panel, int pivots, Eigen::Index fours, Value* x) {
  for (int first = 0; first < pivots; first += 4) {
    with_width(pivots - first, [&](auto width) { forward_columns<width>(panel + first * fours, fours, first, x); });
  }
}

/// Lᵀ y = x for the pivots' rows of x, in place; the rows below are the solution already.
template <class Value>
inline void substitute_backward(const Lanes* panel, int pivots, Eigen::Index fours, Value* x) {
  for (int first = (pivots - 1) / 4 * 4; first >= 0; first -= 4) {
    with_width(pivots - first, [&](auto width) { backward_columns<width>(panel + first * fours, fours, first, x); });
  }
}

}  // namespace homolog
