#include "core/model/shape_model.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "core/base/parallel.h"

namespace homolog {

namespace {

/// Of the largest eigenvalue; below it lies the rounding of the Gram matrix.
constexpr double rank_share = 1e-13;
/// Of the mean's square; below it lies what alignment leaves of equal shapes.
constexpr double still_equal = 1e-18;

/// The lower half of Xᵀ X, tile by tile: the same bits whatever the number of cores.
Eigen::MatrixXd gram_matrix(const ShapeMatrix& x) {
  constexpr Eigen::Index tile = 128;
  std::vector<std::pair<Eigen::Index, Eigen::Index>> corners;
  for (Eigen::Index j = 0; j < x.cols(); j += tile)
    for (Eigen::Index i = j; i < x.cols(); i += tile) corners.emplace_back(i, j);
  Eigen::MatrixXd gram(x.cols(), x.cols());
  in_parallel(corners.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      const auto [i, j] = corners[k];
      const Eigen::Index rows = std::min(tile, x.cols() - i), columns = std::min(tile, x.cols() - j);
      gram.block(i, j, rows, columns).noalias() = x.middleCols(i, rows).transpose() * x.middleCols(j, columns);
    }
  });
  return gram;
}

}  // namespace

Eigen::VectorXd PrincipalComponents::variances() const {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(std::max<Eigen::Index>(0, shapes() - 1));
  if (shapes() > 1) all.head(scatter.size()) = scatter / static_cast<double>(shapes() - 1);
  return all;
}

Eigen::MatrixXd PrincipalComponents::basis(Eigen::Index count) const {
  count = std::clamp<Eigen::Index>(count, 0, scatter.size());
  const Eigen::MatrixXd combinations = weights().leftCols(count);
  Eigen::MatrixXd axes(centred.rows(), count);
  in_parallel(centred.rows(), [&](Eigen::Index first, Eigen::Index last) {
    axes.middleRows(first, last - first).noalias() = centred.middleRows(first, last - first) * combinations;
  });
  return axes;
}

PrincipalComponents principal_components(ShapeMatrix shapes) {
  PrincipalComponents components;
  if (shapes.size() == 0) {
    components.mean = Eigen::VectorXd::Zero(shapes.rows());
    components.centred = std::move(shapes);
    return components;
  }
  components.mean = shapes.rowwise().mean();
  shapes.colwise() -= components.mean;
  components.centred = std::move(shapes);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram_matrix(components.centred));
  const Eigen::VectorXd& ascending = solver.eigenvalues();
  const Eigen::Index m = ascending.size();
  const double floor = std::max(rank_share * ascending[m - 1], still_equal * components.mean.squaredNorm());
  Eigen::Index rank = 0;
  while (rank + 1 < m && ascending[m - 1 - rank] > floor) ++rank;
  components.scatter = ascending.tail(rank).reverse();
  components.vectors = solver.eigenvectors().rightCols(rank).rowwise().reverse();
  return components;
}

Eigen::Index modes_holding(const Eigen::VectorXd& variances, double share) {
  const double total = variances.sum();
  if (!(total > 0)) return 0;
  double held = 0;
  Eigen::Index modes = 0;
  // The share is met up to rounding, so that 1 asks for the rank and not for noise.
  while (modes < variances.size() && (modes == 0 || held < (share - 1e-12) * total)) held += variances[modes++];
  return modes;
}

ShapeModel make_model(const PrincipalComponents& components, double share, std::shared_ptr<const Topology> topology,
                      std::vector<std::string> names) {
  const Eigen::VectorXd variances = components.variances();
  const Eigen::Index modes = modes_holding(variances, share);
  ShapeModel model;
  model.topology = std::move(topology);
  model.mean = components.mean;
  model.basis = components.basis(modes);
  model.variances = variances.head(modes);
  model.scores = components.scores().topRows(modes);
  model.names = std::move(names);
  return model;
}

ShapeModel part_of(const ShapeModel& model, const StructurePart& part) {
  ShapeModel alone;
  if (model.topology)  // a part of a sound mesh is sound
    alone.topology = Topology::make(part.vertices, triangles_of(part, model.topology->triangles())).value();
  alone.mean = rows_of(part, model.mean);
  alone.basis = rows_of(part, model.basis);
  alone.variances = model.variances;
  alone.noise_variance = model.noise_variance;
  alone.scores = model.scores;
  alone.names = model.names;
  return alone;
}

Eigen::VectorXd clamped(const ShapeModel& model, const Eigen::VectorXd& b, double limit) {
  const Eigen::VectorXd reach = limit * model.variances.head(b.size()).cwiseSqrt();
  return b.cwiseMax(-reach).cwiseMin(reach);
}

Points shape_of(const ShapeModel& model, const Eigen::VectorXd& b) {
  const Eigen::Index count = std::min(b.size(), model.modes());
  const Eigen::VectorXd shape = model.mean + model.basis.leftCols(count) * b.head(count);
  return points_of(shape);
}

Points mode_shape(const ShapeModel& model, Eigen::Index mode, double deviations) {
  assert(mode < model.modes());
  const Eigen::VectorXd shape = model.mean + deviations * std::sqrt(model.variances[mode]) * model.basis.col(mode);
  return points_of(shape);
}

Eigen::VectorXd coefficients(const ShapeModel& model, const Points& shape) {
  const Eigen::Map<const Eigen::VectorXd> x(shape.data(), shape.size());
  return model.basis.transpose() * (x - model.mean);
}

Eigen::MatrixXd sampled_coefficients(const Eigen::VectorXd& variances, Eigen::Index count, std::uint64_t seed) {
  std::mt19937_64 bits(seed);
  // Not 0, whose logarithm is infinite.
  const auto uniform = [&] { return (static_cast<double>(bits() >> 11) + 0.5) * 0x1p-53; };
  Eigen::MatrixXd b(variances.size(), count);
  for (Eigen::Index mode = 0; mode < variances.size(); ++mode) {
    const double deviation = std::sqrt(variances[mode]);
    for (Eigen::Index k = 0; k < count; k += 2) {  // two at a time [Box and Muller 1958]
      const double radius = std::sqrt(-2 * std::log(uniform())), angle = 2 * std::numbers::pi * uniform();
      b(mode, k) = deviation * radius * std::cos(angle);
      if (k + 1 < count) b(mode, k + 1) = deviation * radius * std::sin(angle);
    }
  }
  return b;
}

Points sampled_shape(const ShapeModel& model, std::uint64_t seed) {
  return shape_of(model, clamped(model, sampled_coefficients(model.variances, 1, seed)));
}

}  // namespace homolog
