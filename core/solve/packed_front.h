#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "core/solve/dense_front.h"

/// A factorised front as it is read when solving, in one run of numbers. Its pivots come in blocks of up to eight. Each
/// block has first the inverse of its triangle at L's diagonal, row by row, then L's rows below, row by row: those of
/// the later pivots and those below all pivots. An entry of L is one number; nothing is filled up.
namespace homolog {

/// Pivots are solved for in blocks of at most so many, whose x, y and z stay in registers.
constexpr int block_pivots = 8;

/// Lanes at any address.
typedef double LooseLanes __attribute__((vector_size(32), aligned(8), may_alias));

/// Writes the inverse of the triangle of `width` columns, from row 0 of `columns` on, and returns where it ends.
/// Reciprocals are on the triangle's diagonal. Eight rows are done whatever the width, which keeps them in registers;
/// up to seven columns after those of the triangle are read for nothing.
inline double* pack_triangle(const double* columns, Eigen::Index height, int width, double* to) {
  constexpr Lanes unit[4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
  Lanes left[block_pivots], right[block_pivots];  // the inverse's rows
  double rows[block_pivots * (block_pivots + 1) / 2];
#pragma GCC unroll 8
  for (int r = 0; r < block_pivots; ++r) {
    left[r] = r < 4 ? unit[r] : Lanes{};
    right[r] = r < 4 ? Lanes{} : unit[r - 4];
#pragma GCC unroll 8
    for (int k = 0; k < r; ++k) {
      left[r] -= columns[k * height + r] * left[k];
      if (k >= 4) right[r] -= columns[k * height + r] * right[k];
    }
    left[r] *= columns[r * height + r];
    right[r] *= columns[r * height + r];
    // The surplus belongs to the next row, which overwrites it.
    double* const row = rows + r * (r + 1) / 2;
    *reinterpret_cast<LooseLanes*>(row) = left[r];
    if (r >= 4) *reinterpret_cast<LooseLanes*>(row + 4) = right[r];
  }
  return std::copy_n(rows, width * (width + 1) / 2, to);
}

/// Rows become columns.
inline void transpose(Lanes (&v)[4]) {
  const Lanes low_even = __builtin_shufflevector(v[0], v[1], 0, 4, 2, 6);
  const Lanes low_odd = __builtin_shufflevector(v[0], v[1], 1, 5, 3, 7);
  const Lanes high_even = __builtin_shufflevector(v[2], v[3], 0, 4, 2, 6);
  const Lanes high_odd = __builtin_shufflevector(v[2], v[3], 1, 5, 3, 7);
  v[0] = __builtin_shufflevector(low_even, high_even, 0, 1, 4, 5);
  v[1] = __builtin_shufflevector(low_odd, high_odd, 0, 1, 4, 5);
  v[2] = __builtin_shufflevector(low_even, high_even, 2, 3, 6, 7);
  v[3] = __builtin_shufflevector(low_odd, high_odd, 2, 3, 6, 7);
}

/// Writes `rows` rows of `width` columns, which are `fours` apart, and returns where they end. Up to seven columns
/// after them are read.
inline double* pack_rows(const Lanes* columns, Eigen::Index fours, int rows, int width, double* to) {
  int row = 0;
  // Four numbers are written at a time; what they overwrite of the next row is written after them.
  for (; width >= 4 && row + 4 < rows; row += 4, ++columns) {
    Lanes left[4], right[4];
    for (int k = 0; k < 4; ++k) left[k] = columns[k * fours];
    for (int k = 0; k < 4; ++k) right[k] = columns[(k + 4) * fours];
    transpose(left);
    transpose(right);
    for (int k = 0; k < 4; ++k, to += width) {
      *reinterpret_cast<LooseLanes*>(to) = left[k];
      if (width > 4) *reinterpret_cast<LooseLanes*>(to + 4) = right[k];
    }
  }
  const double* const numbers = reinterpret_cast<const double*>(columns);
  for (int r = 0; row < rows; ++row, ++r) {
    for (int k = 0; k < width; ++k) *to++ = numbers[4 * fours * k + r];
  }
  return to;
}

/// Packs a panel that was factorised [dense_front.h]; `rows`: those below the pivots.
inline void pack_front(const Lanes* panel, int pivots, int rows, Eigen::Index fours, double* to) {
  const Lanes* const below = panel + (pivots + 3) / 4;
  for (int first = 0; first < pivots; first += block_pivots) {
    const int width = std::min(block_pivots, pivots - first), next = first + width;
    const Lanes* const columns = panel + first * fours;
    to = pack_triangle(reinterpret_cast<const double*>(columns) + first, 4 * fours, width, to);
    to = pack_rows(columns + next / 4, fours, pivots - next, width, to);
    to = pack_rows(below + first * fours, fours, rows, width, to);
  }
}

/// Numbers of L are fetched so many bytes before they are needed. A front is short, so that no processor foresees by
/// itself where the reading goes on, and waiting for memory took most of the time of large meshes.
constexpr int fetched_ahead = 4096;

template <int Count>
inline void fetch(const double* numbers, int bytes) {
#pragma GCC unroll 8
  for (int k = 0; k < Count; k += 8) __builtin_prefetch(reinterpret_cast<const char*>(numbers + k) + bytes);
}

/// x = T x for a triangle T.
template <int Width>
inline void multiply_triangle(const double* t, Lanes (&x)[Width]) {
#pragma GCC unroll 8
  for (int r = Width - 1; r >= 0; --r) {
    const double* const row = t + r * (r + 1) / 2;
    Lanes sum = row[0] * x[0];
#pragma GCC unroll 8
    for (int k = 1; k <= r; ++k) sum += row[k] * x[k];
    x[r] = sum;
  }
}

/// x = Tᵀ x.
template <int Width>
inline void multiply_triangle_transposed(const double* t, Lanes (&x)[Width]) {
#pragma GCC unroll 8
  for (int c = 0; c < Width; ++c) {
    Lanes sum = t[c * (c + 3) / 2] * x[c];
#pragma GCC unroll 8
    for (int r = c + 1; r < Width; ++r) sum += t[r * (r + 1) / 2 + c] * x[r];
    x[c] = sum;
  }
}

template <int Width>
inline void copy(const Lanes* from, Lanes* to) {
#pragma GCC unroll 8
  for (int k = 0; k < Width; ++k) to[k] = from[k];
}

/// How many numbers a block of `width` pivots with `rows` rows below has.
constexpr Eigen::Index block_numbers(int width, int rows) {
  return width * (width + 1) / 2 + Eigen::Index{width} * rows;
}

/// L y = x for a block of pivots whose numbers are at `l` and whose x, y and z are at `own`. The part that they take
/// from the `rows` rows below is subtracted there: row i is at x[place[i]].
template <int Width>
inline void forward(const double* l, const int* place, int rows, Lanes* own, Lanes* x) {
  Lanes pivots[Width];
  copy<Width>(own, pivots);
  fetch<block_numbers(Width, 0)>(l, fetched_ahead);
  multiply_triangle(l, pivots);
  copy<Width>(pivots, own);
  l += block_numbers(Width, 0);
  for (int i = 0; i < rows; ++i, l += Width) {
    fetch<Width>(l, fetched_ahead);
    Lanes rest = x[place[i]];
#pragma GCC unroll 8
    for (int k = 0; k < Width; ++k) rest -= l[k] * pivots[k];
    x[place[i]] = rest;
  }
}

/// Lᵀ y = x for the same block; the rows below are the solution already.
template <int Width>
inline void backward(const double* l, const int* place, int rows, Lanes* own, const Lanes* x) {
  const double* const triangle = l;
  Lanes pivots[Width];
  copy<Width>(own, pivots);
  fetch<block_numbers(Width, 0)>(l, -fetched_ahead);
  l += block_numbers(Width, 0);
  for (int i = 0; i < rows; ++i, l += Width) {
    fetch<Width>(l, -fetched_ahead);
    const Lanes row = x[place[i]];
#pragma GCC unroll 8
    for (int k = 0; k < Width; ++k) pivots[k] -= l[k] * row;
  }
  multiply_triangle_transposed(triangle, pivots);
  copy<Width>(pivots, own);
}

}  // namespace homolog
