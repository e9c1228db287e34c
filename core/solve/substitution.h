#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>

#include "core/solve/dense_front.h"

/// The products that solving with a factorised front consists of: a dense matrix, stored column by column, times one
/// vector or three (x, y and z). A lane holds a row of the matrix; x, y and z lie apart, each in an array of its own,
/// which makes use of every lane.
namespace homolog {

/// Four numbers that lie side by side, at any address. (None is returned by value: how that is done depends on the
/// processor that a function is compiled for.)
typedef double FourDoubles __attribute__((vector_size(32), aligned(8), may_alias));
typedef float FourFloats __attribute__((vector_size(16), aligned(4), may_alias));

inline FourDoubles& four_at(double* at) {
  return *reinterpret_cast<FourDoubles*>(at);
}
inline void read_four(const double* at, FourDoubles& four) {
  four = *reinterpret_cast<const FourDoubles*>(at);
}
inline void read_four(const float* at, FourDoubles& four) {
  four = __builtin_convertvector(*reinterpret_cast<const FourFloats*>(at), FourDoubles);
}

/// Arrays of x, or of x, y and z, `stride` numbers apart.
struct Apart {
  double* first;
  Eigen::Index stride;
  double* of(int component) const { return first + component * stride; }
  Apart from(Eigen::Index i) const { return {first + i, stride}; }
};

enum class Into { set, add, subtract };

template <Into into>
inline void put(const FourDoubles& four, FourDoubles& to) {
  to = into == Into::set ? four : into == Into::add ? to + four : to - four;
}

/// A in for A of four times `fours` rows, whose columns are `stride` apart, is set, added or subtracted. Two fours are
/// done at a time: what may follow the last one in `out` is overwritten.
template <int Components, Into into, class Number>
inline void multiply(const Number* a, Eigen::Index stride, int fours, int columns, const Apart& in, const Apart& out) {
  for (int four = 0; four < fours; four += 2) {
    const Number* rows = a + 4 * four;
    FourDoubles sum[Components][2] = {};
    for (int k = 0; k < columns; ++k, rows += stride) {
      FourDoubles low, high;
      read_four(rows, low);
      read_four(rows + 4, high);
#pragma GCC unroll 3
      for (int c = 0; c < Components; ++c) {
        sum[c][0] += low * in.of(c)[k];
        sum[c][1] += high * in.of(c)[k];
      }
    }
#pragma GCC unroll 3
    for (int c = 0; c < Components; ++c) {
      put<into>(sum[c][0], four_at(out.of(c) + 4 * four));
      put<into>(sum[c][1], four_at(out.of(c) + 4 * four + 4));
    }
  }
}

/// The sums of four, side by side.
inline void add_up(const FourDoubles (&v)[4], FourDoubles& sums) {
  const FourDoubles low =
      __builtin_shufflevector(v[0], v[1], 0, 4, 2, 6) + __builtin_shufflevector(v[0], v[1], 1, 5, 3, 7);
  const FourDoubles high =
      __builtin_shufflevector(v[2], v[3], 0, 4, 2, 6) + __builtin_shufflevector(v[2], v[3], 1, 5, 3, 7);
  sums = __builtin_shufflevector(low, high, 0, 1, 4, 5) + __builtin_shufflevector(low, high, 2, 3, 6, 7);
}

/// Aᵀ in for A of four times `fours` rows is set or subtracted. Columns too are done in fours: what follows the last of
/// `columns` gives what fills up `out`.
template <int Components, Into into, class Number>
inline void multiply_transposed(const Number* a, Eigen::Index stride, int fours, int columns, const Apart& in,
                                const Apart& out) {
  for (int column = 0; column < columns; column += 4) {
    const Number* const rows = a + column * stride;
    FourDoubles sum[Components][4] = {};
    for (int four = 0; four < fours; ++four) {
#pragma GCC unroll 4
      for (int k = 0; k < 4; ++k) {
        FourDoubles l;
        read_four(rows + k * stride + 4 * four, l);
#pragma GCC unroll 3
        for (int c = 0; c < Components; ++c) sum[c][k] += l * four_at(in.of(c) + 4 * four);
      }
    }
#pragma GCC unroll 3
    for (int c = 0; c < Components; ++c) {
      FourDoubles sums;
      add_up(sum[c], sums);
      put<into>(sums, four_at(out.of(c) + column));
    }
  }
}

/// out = in, each number times its factor where there are any.
template <int Components>
inline void copy(const Apart& in, int fours, const double* factors, const Apart& out) {
  for (int four = 0; four < fours; ++four) {
    FourDoubles factor{1, 1, 1, 1};
    if (factors != nullptr) read_four(factors + 4 * four, factor);
#pragma GCC unroll 3
    for (int c = 0; c < Components; ++c) four_at(out.of(c) + 4 * four) = factor * four_at(in.of(c) + 4 * four);
  }
}

/// Takes values apart. `at(i)`: the ith, one number or the lanes x y z 0.
template <class At>
inline void take_apart(const At& at, int fours, const Apart& to) {
  for (int i = 0; i < 4 * fours; i += 4) {
    if constexpr (std::is_same_v<std::decay_t<decltype(at(0))>, double>) {
      four_at(to.first + i) = FourDoubles{at(i), at(i + 1), at(i + 2), at(i + 3)};
    } else {
      const Lanes &a = at(i), &b = at(i + 1), &c = at(i + 2), &d = at(i + 3);
      const Lanes xz_ab = __builtin_shufflevector(a, b, 0, 4, 2, 6), xz_cd = __builtin_shufflevector(c, d, 0, 4, 2, 6);
      const Lanes y_ab = __builtin_shufflevector(a, b, 1, 5, 3, 7), y_cd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
      four_at(to.of(0) + i) = __builtin_shufflevector(xz_ab, xz_cd, 0, 1, 4, 5);
      four_at(to.of(1) + i) = __builtin_shufflevector(y_ab, y_cd, 0, 1, 4, 5);
      four_at(to.of(2) + i) = __builtin_shufflevector(xz_ab, xz_cd, 2, 3, 6, 7);
    }
  }
}

/// Puts x, y and z together again: calls `take(i, value)` for each.
template <class Value, class Take>
inline void put_together(const Apart& from, int fours, const Take& take) {
  for (int i = 0; i < 4 * fours; i += 4) {
    if constexpr (std::is_same_v<Value, double>) {
      for (int k = 0; k < 4; ++k) take(i + k, from.first[i + k]);
    } else {
      const FourDoubles &x = four_at(from.of(0) + i), &y = four_at(from.of(1) + i), &z = four_at(from.of(2) + i);
      const FourDoubles none = {};
      const FourDoubles xy_even = __builtin_shufflevector(x, y, 0, 4, 2, 6);
      const FourDoubles xy_odd = __builtin_shufflevector(x, y, 1, 5, 3, 7);
      const FourDoubles z_even = __builtin_shufflevector(z, none, 0, 4, 2, 6);
      const FourDoubles z_odd = __builtin_shufflevector(z, none, 1, 5, 3, 7);
      take(i, __builtin_shufflevector(xy_even, z_even, 0, 1, 4, 5));
      take(i + 1, __builtin_shufflevector(xy_odd, z_odd, 0, 1, 4, 5));
      take(i + 2, __builtin_shufflevector(xy_even, z_even, 2, 3, 6, 7));
      take(i + 3, __builtin_shufflevector(xy_odd, z_odd, 2, 3, 6, 7));
    }
  }
}

}  // namespace homolog
