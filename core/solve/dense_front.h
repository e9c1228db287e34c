#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <type_traits>

/// The dense arithmetic of factorising in SparseCholesky. A panel holds the columns of L of one front: `pivots` columns
/// of `fours` times four rows each, first the rows of the pivots themselves, then those below. An update is a lower
/// triangle in blocks of four columns, each block from its diagonal down.
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

/// Columns are worked on in blocks of up to `Most`, which stay in registers: `work` gets min(columns, Most) as a
/// constant.
template <int Most, class Work>
auto with_width(int columns, const Work& work) {
  static_assert(Most <= 8);
  switch (std::min(columns, Most)) {
    case 1:
      return work(std::integral_constant<int, 1>());
    case 2:
      return work(std::integral_constant<int, 2>());
    case 3:
      return work(std::integral_constant<int, 3>());
    case 4:
      return work(std::integral_constant<int, 4>());
    case 5:
      return work(std::integral_constant<int, std::min(5, Most)>());
    case 6:
      return work(std::integral_constant<int, std::min(6, Most)>());
    case 7:
      return work(std::integral_constant<int, std::min(7, Most)>());
    default:
      return work(std::integral_constant<int, Most>());
  }
}

/// The place where row 0 of `column` would be in an update of `fours` times four rows.
inline Eigen::Index triangle_column(Eigen::Index column, Eigen::Index fours) {
  const Eigen::Index block = column / 4;
  return 4 * block * fours - 2 * block * (block - 1) + column % 4 * (fours - block) - block;
}

/// block −= Σ_k rows_k columns_kᵀ over `depth` columns of a panel that lie `stride` apart: an outer product of `Fours`
/// times four rows of each and as many others as the block has columns.
template <int Fours, int Columns>
inline void subtract_products(Lanes (&block)[Fours][Columns], const Lanes* rows, const Lanes* columns,
                              Eigen::Index stride, int depth) {
  for (int k = 0; k < depth; ++k, rows += stride, columns += stride) {
    const double* l = reinterpret_cast<const double*>(columns);
#pragma GCC unroll 4
    for (int c = 0; c < Columns; ++c) {
#pragma GCC unroll 2
      for (int f = 0; f < Fours; ++f) block[f][c] -= rows[f] * l[c];
    }
  }
}

/// Factorises a block of columns from `first` on; those to its left are done. False where a pivot is not positive.
template <int Columns>
inline bool factorise_columns(Lanes* panel, Eigen::Index fours, int first) {
  const Eigen::Index diagonal = first / 4;
  Lanes* const columns = panel + first * fours;
  double l[4][4] = {}, reciprocal[4] = {};  // the diagonal block, column by column
  for (Eigen::Index row = diagonal; row < fours; ++row) {
    Lanes rest[1][Columns];
    Lanes(&block)[Columns] = rest[0];
#pragma GCC unroll 4
    for (int c = 0; c < Columns; ++c) block[c] = columns[c * fours + row];
    subtract_products(rest, panel + row, panel + diagonal, fours, first);
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

/// `Fours` fours of rows of an update, from `at` on, in a block of four columns that are `stride` apart.
template <int Fours>
inline void subtract_from_update(Lanes* at, Eigen::Index stride, const Lanes* rows, const Lanes* columns,
                                 Eigen::Index fours, int pivots) {
  Lanes block[Fours][4];
#pragma GCC unroll 4
  for (int c = 0; c < 4; ++c) {
#pragma GCC unroll 2
    for (int f = 0; f < Fours; ++f) block[f][c] = at[c * stride + f];
  }
  subtract_products(block, rows, columns, fours, pivots);
#pragma GCC unroll 4
  for (int c = 0; c < 4; ++c) {
#pragma GCC unroll 2
    for (int f = 0; f < Fours; ++f) at[c * stride + f] = block[f][c];
  }
}

/// Factorises a panel in place, leaving the reciprocals of L's diagonal on it, and subtracts from `update` what its
/// pivots take from the rows below. False where a pivot is not positive.
inline bool factorise_panel(Lanes* panel, int pivots, Eigen::Index fours, Lanes* update) {
  for (int first = 0; first < pivots; first += 4) {
    const auto block = [&](auto width) { return factorise_columns<width>(panel, fours, first); };
    if (!with_width<4>(pivots - first, block)) return false;
  }
  const Eigen::Index row_fours = fours - (pivots + 3) / 4;
  const Lanes* const below = panel + (fours - row_fours);
  for (Eigen::Index column = 0; column < row_fours; ++column) {
    Lanes* const at = update + triangle_column(4 * column, row_fours);
    const Eigen::Index stride = row_fours - column;
    Eigen::Index row = column;
    for (; row + 1 < row_fours; row += 2)
      subtract_from_update<2>(at + row, stride, below + row, below + column, fours, pivots);
    if (row < row_fours) subtract_from_update<1>(at + row, stride, below + row, below + column, fours, pivots);
  }
  return true;
}

}  // namespace homolog
