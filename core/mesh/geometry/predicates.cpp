#include "core/mesh/geometry/predicates.h"

#include <array>
#include <cmath>
#include <limits>

namespace homolog {
namespace {

constexpr double half_ulp = std::numeric_limits<double>::epsilon() / 2;

int sign_of(double x) {
  return (x > 0) - (x < 0);
}

/// An exact sum of at most `capacity` doubles that do not overlap, none of them zero, by increasing magnitude.
template <std::size_t capacity>
struct Expansion {
  std::array<double, capacity> terms;  // left uninitialised beyond `size`
  std::size_t size = 0;

  /// Adds a number (Grow-Expansion, its sums by Two-Sum).
  void add(double x) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const double sum = x + terms[i], part = sum - x;
      const double error = (x - (sum - part)) + (terms[i] - part);
      if (error != 0) terms[kept++] = error;
      x = sum;
    }
    if (x != 0) terms[kept++] = x;
    size = kept;
  }
  int sign() const { return size == 0 ? 0 : sign_of(terms[size - 1]); }
};

template <std::size_t a_size, std::size_t b_size>
Expansion<a_size + b_size> sum(const Expansion<a_size>& a, const Expansion<b_size>& b, double b_sign = 1) {
  Expansion<a_size + b_size> result;
  for (std::size_t i = 0; i < a.size; ++i) result.terms[i] = a.terms[i];
  result.size = a.size;
  for (std::size_t i = 0; i < b.size; ++i) result.add(b_sign * b.terms[i]);
  return result;
}

template <std::size_t a_size, std::size_t b_size>
Expansion<2 * a_size * b_size> product(const Expansion<a_size>& a, const Expansion<b_size>& b) {
  Expansion<2 * a_size * b_size> result;
  for (std::size_t i = 0; i < a.size; ++i) {
    for (std::size_t j = 0; j < b.size; ++j) {
      const double rounded = a.terms[i] * b.terms[j];
      result.add(std::fma(a.terms[i], b.terms[j], -rounded));
      result.add(rounded);
    }
  }
  return result;
}

Expansion<2> difference(double x, double y) {
  Expansion<2> result;
  result.add(x);
  result.add(-y);
  return result;
}

/// a · d − b · c
Expansion<16> determinant(const Expansion<2>& a, const Expansion<2>& b, const Expansion<2>& c, const Expansion<2>& d) {
  return sum(product(a, d), product(b, c), -1);
}

int exact_orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const auto row = [&a](const Vec3& p) {
    return std::array{difference(p.x(), a.x()), difference(p.y(), a.y()), difference(p.z(), a.z())};
  };
  const auto u = row(b), v = row(c), w = row(d);
  const auto x = product(u[0], determinant(v[1], v[2], w[1], w[2]));
  const auto y = product(u[1], determinant(v[2], v[0], w[2], w[0]));
  const auto z = product(u[2], determinant(v[0], v[1], w[0], w[1]));
  return sum(sum(x, y), z).sign();
}

}  // namespace

int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = c - a, w = d - a;
  double value = 0, permanent = 0;
  for (int k = 0; k < 3; ++k) {
    const double p = v[(k + 1) % 3] * w[(k + 2) % 3], q = v[(k + 2) % 3] * w[(k + 1) % 3];
    value += u[k] * (p - q);
    permanent += std::abs(u[k]) * (std::abs(p) + std::abs(q));
  }
  constexpr double bound = (7 + 56 * half_ulp) * half_ulp;
  if (std::abs(value) > bound * permanent) return sign_of(value);
  return exact_orientation(a, b, c, d);
}

int orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const Eigen::Vector2d u = b - a, v = c - a;
  const double p = u.x() * v.y(), q = u.y() * v.x();
  constexpr double bound = (3 + 16 * half_ulp) * half_ulp;
  if (std::abs(p - q) > bound * (std::abs(p) + std::abs(q))) return sign_of(p - q);
  return determinant(difference(b.x(), a.x()), difference(b.y(), a.y()), difference(c.x(), a.x()),
                     difference(c.y(), a.y()))
      .sign();
}

}  // namespace homolog
