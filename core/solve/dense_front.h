#pragma once

#include <Eigen/Core>
#include <algorithm>
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
  double l[4][4] = {}, reciprocal[4] = {};  // of the diagonal block, column by column
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
    if (!with_width(pivots - first, block)) return false;
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

/// Pivots are solved for in blocks of at most so many.
constexpr int block_pivots = 16;

/// The inverse of a triangle of up to four rows, by columns. `at(r, c)`: the triangle, reciprocals on its diagonal.
template <class At>
inline void invert_small(const At& at, int rows, Lanes (&inverse)[4]) {
  double t[4][4] = {};
  for (int c = 0; c < rows; ++c) {
    t[c][c] = at(c, c);
    for (int r = c + 1; r < rows; ++r) {
      for (int k = c; k < r; ++k) t[c][r] -= at(r, k) * t[c][k];
      t[c][r] *= at(r, r);
    }
  }
  for (int c = 0; c < 4; ++c) inverse[c] = Lanes{t[c][0], t[c][1], t[c][2], t[c][3]};
}

/// Puts the inverse in place of the triangle of each block of pivots of a factorised panel, zero above the diagonal: so
/// solving for a block is a product, in which no number waits for the one before.
inline void invert_blocks(Lanes* panel, int pivots, Eigen::Index fours) {
  const auto at = [&](Eigen::Index row, Eigen::Index column) {
    return reinterpret_cast<const double*>(panel + column * fours)[row];
  };
  for (int first = 0; first < pivots; first += 4) {
    const Eigen::Index four = first / 4;
    const int rows = std::min(4, pivots - first);
    Lanes own[4];
    invert_small([&](int r, int c) { return at(first + r, first + c); }, rows, own);
    for (int left = first / block_pivots * block_pivots; left < first; left += 4) {
      Lanes sum[4] = {};
      for (int k = left; k < first; ++k) {
        const Lanes l = panel[k * fours + four];
#pragma GCC unroll 4
        for (int c = 0; c < 4; ++c) sum[c] -= l * at(k, left + c);
      }
#pragma GCC unroll 4
      for (int c = 0; c < 4; ++c)
        panel[(left + c) * fours + four] =
            own[0] * sum[c][0] + own[1] * sum[c][1] + own[2] * sum[c][2] + own[3] * sum[c][3];
    }
    for (int c = 0; c < rows; ++c) panel[(first + c) * fours + four] = own[c];
  }
}

}  // namespace homolog
