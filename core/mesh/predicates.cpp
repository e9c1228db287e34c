#include "core/mesh/predicates.h"

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace homolog {
namespace {

constexpr double half_ulp = std::numeric_limits<double>::epsilon() / 2;

/// An exact sum of doubles that do not overlap, by increasing magnitude.
using Expansion = std::vector<double>;

int sign_of(double x) {
  return (x > 0) - (x < 0);
}

/// x + y as rounded sum and its error, exactly (Two-Sum).
std::pair<double, double> two_sum(double x, double y) {
  const double sum = x + y, part = sum - x;
  return {sum, (x - (sum - part)) + (y - part)};
}

Expansion operator+(Expansion sum, const Expansion& terms) {
  for (double carry : terms) {  // Grow-Expansion, once a term
    for (double& component : sum) {
      const auto [high, low] = two_sum(carry, component);
      component = low;
      carry = high;
    }
    sum.push_back(carry);
  }
  return sum;
}

Expansion operator*(const Expansion& a, const Expansion& b) {
  Expansion product;
  for (const double x : a)
    for (const double y : b) product = std::move(product) + Expansion{std::fma(x, y, -(x * y)), x * y};
  return product;
}

Expansion operator-(Expansion a) {
  for (double& component : a) component = -component;
  return a;
}

Expansion difference(double x, double y) {
  const auto [high, low] = two_sum(x, -y);
  return {low, high};
}

int sign_of(const Expansion& e) {
  for (auto component = e.rbegin(); component != e.rend(); ++component)
    if (*component != 0) return sign_of(*component);
  return 0;
}

int exact_orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  Expansion rows[3][3];
  for (int k = 0; k < 3; ++k) {
    rows[0][k] = difference(b[k], a[k]);
    rows[1][k] = difference(c[k], a[k]);
    rows[2][k] = difference(d[k], a[k]);
  }
  Expansion determinant;
  for (int k = 0; k < 3; ++k) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    const Expansion minor = rows[1][l] * rows[2][m] + -(rows[1][m] * rows[2][l]);
    determinant = std::move(determinant) + rows[0][k] * minor;
  }
  return sign_of(determinant);
}

}  // namespace

int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = c - a, w = d - a;
  double determinant = 0, permanent = 0;
  for (int k = 0; k < 3; ++k) {
    const double p = v[(k + 1) % 3] * w[(k + 2) % 3], q = v[(k + 2) % 3] * w[(k + 1) % 3];
    determinant += u[k] * (p - q);
    permanent += std::abs(u[k]) * (std::abs(p) + std::abs(q));
  }
  constexpr double bound = (7 + 56 * half_ulp) * half_ulp;
  if (std::abs(determinant) > bound * permanent) return sign_of(determinant);
  return exact_orientation(a, b, c, d);
}

int orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const Eigen::Vector2d u = b - a, v = c - a;
  const double p = u.x() * v.y(), q = u.y() * v.x();
  constexpr double bound = (3 + 16 * half_ulp) * half_ulp;
  if (std::abs(p - q) > bound * (std::abs(p) + std::abs(q))) return sign_of(p - q);
  return sign_of(difference(b.x(), a.x()) * difference(c.y(), a.y()) +
                 -(difference(b.y(), a.y()) * difference(c.x(), a.x())));
}

}  // namespace homolog
