#include "core/deform/volume_energy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/processes/parallel.h"

namespace homolog {
namespace {

constexpr double volume_share = 0.5;  ///< λ
constexpr Eigen::Index elements_at_a_time = 256;

/// The energy of one element and its derivative by F.
double of_element(const Eigen::Matrix3d& f, double epsilon, Eigen::Matrix3d* derivative) {
  const double j = f.determinant(), root = std::hypot(j, epsilon), chi = 0.5 * (j + root);
  const double squared = f.squaredNorm(), cube_root = std::cbrt(chi), power = 1 / (3 * cube_root * cube_root);
  const double shape = squared * power, volume = 0.5 * volume_share * (j * j + 1) / chi;
  if (derivative != nullptr) {
    Eigen::Matrix3d cofactors;
    cofactors.col(0) = f.col(1).cross(f.col(2));
    cofactors.col(1) = f.col(2).cross(f.col(0));
    cofactors.col(2) = f.col(0).cross(f.col(1));
    const double chi_slope = root > 0 ? chi / root : 1;
    const double shape_by_j = -2.0 / 3 * shape * chi_slope / chi;
    const double volume_by_j = volume_share * j / chi - volume * chi_slope / chi;
    *derivative = 4 * shape * power * f + (2 * shape * shape_by_j + volume_by_j) * cofactors;
  }
  return shape * shape + volume;
}

}  // namespace

VolumeEnergy::VolumeEnergy(const Tetrahedra& tetrahedra, const Points& rest)
    : tetrahedra_(tetrahedra), start_(static_cast<std::size_t>(rest.rows()) + 1, 0) {
  inverse_rest_.reserve(static_cast<std::size_t>(tetrahedra.rows()));
  for (Eigen::Index t = 0; t < tetrahedra.rows(); ++t) inverse_rest_.push_back(edges(t, rest).inverse());
  for (const std::int32_t v : tetrahedra.reshaped<Eigen::RowMajor>()) ++start_[static_cast<std::size_t>(v) + 1];
  for (std::size_t i = 1; i < start_.size(); ++i) start_[i] += start_[i - 1];
  std::vector<Eigen::Index> next(start_.begin(), start_.end() - 1);
  uses_.resize(static_cast<std::size_t>(tetrahedra.size()));
  for (Eigen::Index k = 0; k < tetrahedra.size(); ++k) uses_[next[tetrahedra(k / 4, k % 4)]++] = k;
}

void VolumeEnergy::rest_regular(Eigen::Index t) {
  Eigen::Matrix3d regular;  // edges of length 1, six times the volume of which is 1/√2
  regular << 1, 0.5, 0.5, 0, std::sqrt(0.75), std::sqrt(1.0 / 12), 0, 0, std::sqrt(2.0 / 3);
  Eigen::Matrix3d& inverse = inverse_rest_[t];
  const double scale = std::cbrt(std::numbers::sqrt2 / std::abs(inverse.determinant()));
  inverse = (scale * regular).inverse();
}

Eigen::Matrix3d VolumeEnergy::edges(Eigen::Index t, const Points& points) const {
  Eigen::Matrix3d columns;
  const auto first = points.row(tetrahedra_(t, 0));
  for (int k = 0; k < 3; ++k) columns.col(k) = (points.row(tetrahedra_(t, k + 1)) - first).transpose();
  return columns;
}

double VolumeEnergy::least_determinant(const Points& points) const {
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index t = 0; t < tetrahedra_.rows(); ++t)
    least = std::min(least, (edges(t, points) * inverse_rest_[t]).determinant());
  return least;
}

double VolumeEnergy::epsilon_for(const Points& points) const {
  constexpr double nothing = 1e-6;
  const double least = std::min(least_determinant(points), 0.0);
  return std::sqrt(nothing * nothing + 0.04 * least * least);
}

double VolumeEnergy::value(const Points& points, double epsilon, Points* gradient) const {
  VertexScalars energies(tetrahedra_.rows());
  Points forces(gradient != nullptr ? tetrahedra_.size() : 0, 3);  // forces on each corner of each element
  in_parallel(
      tetrahedra_.rows(),
      [&](Eigen::Index from, Eigen::Index to) {
        Eigen::Matrix3d by_f;
        for (Eigen::Index t = from; t < to; ++t) {
          const Eigen::Matrix3d& inverse = inverse_rest_[t];
          energies[t] = of_element(edges(t, points) * inverse, epsilon, gradient != nullptr ? &by_f : nullptr);
          if (gradient == nullptr) continue;
          const Eigen::Matrix3d of_corners = by_f * inverse.transpose();
          for (int k = 0; k < 3; ++k) forces.row(4 * t + k + 1) = of_corners.col(k).transpose();
          forces.row(4 * t) = -of_corners.rowwise().sum().transpose();
        }
      },
      elements_at_a_time);
  if (gradient == nullptr) return energies.sum();
  gradient->resize(points.rows(), 3);
  in_parallel(
      points.rows(),
      [&](Eigen::Index from, Eigen::Index to) {
        for (Eigen::Index i = from; i < to; ++i) {
          Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
          for (Eigen::Index u = start_[i]; u < start_[static_cast<std::size_t>(i) + 1]; ++u)
            sum += forces.row(uses_[u]);
          gradient->row(i) = sum;
        }
      },
      elements_at_a_time);
  return energies.sum();
}

}  // namespace homolog
