#include "core/model/shape_model.h"

#include <Spectra/MatOp/DenseSymMatProd.h>
#include <Spectra/SymEigsSolver.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "core/base/demand.h"
#include "core/base/processes/parallel.h"
#include "core/mesh/check_mesh.h"

namespace homolog {

namespace {

/// Share of the largest eigenvalue; below it lies the rounding of the Gram matrix.
constexpr double rank_share = 1e-13;
/// Share of the mean's square; below it lies what alignment leaves of equal shapes.
constexpr double still_equal = 1e-18;

/// Sides of a Gram matrix up to which all of its eigenvectors are found soon enough, and how many of them Lanczos'
/// method must not pass to be the faster way.
constexpr Eigen::Index small_side = 600, leading_part = 8;

/// The lower half of `product(i, j, rows, columns)`, a square of `side`, tile by tile: the same bits whatever the
/// number of cores.
template <class Product>
Eigen::MatrixXd in_tiles(Eigen::Index side, const Product& product) {
  constexpr Eigen::Index tile = 128;
  std::vector<std::pair<Eigen::Index, Eigen::Index>> corners;
  for (Eigen::Index j = 0; j < side; j += tile)
    for (Eigen::Index i = j; i < side; i += tile) corners.emplace_back(i, j);
  Eigen::MatrixXd gram(side, side);
  in_parallel(corners.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      const auto [i, j] = corners[k];
      const Eigen::Index rows = std::min(tile, side - i), columns = std::min(tile, side - j);
      gram.block(i, j, rows, columns).noalias() = product(i, j, rows, columns);
    }
  });
  return gram;
}

/// Shapes lie on more axes than they have coordinates only if there are more of them; the smaller square is made.
bool by_coordinates(const ShapeMatrix& x) {
  return x.cols() > x.rows();
}

/// The lower half of Xᵀ X or X Xᵀ, whichever is smaller.
Eigen::MatrixXd gram_matrix(const ShapeMatrix& x) {
  using Index = Eigen::Index;
  if (by_coordinates(x))
    return in_tiles(x.rows(), [&](Index i, Index j, Index rows, Index columns) {
      return x.middleRows(i, rows) * x.middleRows(j, columns).transpose();
    });
  return in_tiles(x.cols(), [&](Index i, Index j, Index rows, Index columns) {
    return x.middleCols(i, rows).transpose() * x.middleCols(j, columns);
  });
}

/// Takes eigenvalues of the Gram matrix, descending, and its eigenvectors as components, as far as they are above
/// rounding.
void take_axes(Eigen::VectorXd scatter, Eigen::MatrixXd axes, PrincipalComponents& components) {
  const Eigen::Index most = std::min(scatter.size(), components.shapes() - 1);
  const double floor = std::max(rank_share * scatter[0], still_equal * components.mean.squaredNorm());
  Eigen::Index rank = 0;
  while (rank < most && scatter[rank] > floor) ++rank;
  components.scatter = scatter.head(rank);
  if (!by_coordinates(components.centred)) {
    components.vectors = axes.leftCols(rank);
    return;
  }
  const Eigen::MatrixXd scaled = axes.leftCols(rank) * components.scatter.cwiseSqrt().cwiseInverse().asDiagonal();
  components.vectors.resize(components.shapes(), rank);
  in_parallel(components.shapes(), [&](Eigen::Index first, Eigen::Index last) {
    components.vectors.middleRows(first, last - first).noalias() =
        components.centred.middleCols(first, last - first).transpose() * scaled;
  });
}

PrincipalComponents centred_on_mean(ShapeMatrix shapes) {
  demand(shapes.allFinite(), "shapes have a coordinate that is no finite number; correct or leave out that shape");
  PrincipalComponents components;
  components.mean = Eigen::VectorXd::Zero(shapes.rows());
  if (shapes.cols() > 0) components.mean = shapes.rowwise().mean();
  shapes.colwise() -= components.mean;
  components.centred = std::move(shapes);
  return components;
}

void all_axes(const Eigen::MatrixXd& gram, PrincipalComponents& components) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram);
  take_axes(solver.eigenvalues().reverse(), solver.eigenvectors().rowwise().reverse(), components);
}

}  // namespace

Eigen::VectorXd PrincipalComponents::variances() const {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(std::max<Eigen::Index>(0, shapes() - 1));
  if (shapes() > 1) all.head(scatter.size()) = scatter / static_cast<double>(shapes() - 1);
  return beyond > 0 ? all.head(scatter.size()).eval() : all;
}

double PrincipalComponents::total_variance() const {
  return shapes() > 1 ? (scatter.sum() + beyond) / static_cast<double>(shapes() - 1) : 0;
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
  PrincipalComponents components = centred_on_mean(std::move(shapes));
  if (components.centred.size() > 0) all_axes(gram_matrix(components.centred), components);
  return components;
}

PrincipalComponents leading_components(ShapeMatrix shapes, Eigen::Index count) {
  PrincipalComponents components = centred_on_mean(std::move(shapes));
  if (components.centred.size() == 0) return components;
  const Eigen::MatrixXd gram = gram_matrix(components.centred);
  const Eigen::Index side = gram.rows();
  bool found = false;
  if (side > small_side && count < side / leading_part) {
    constexpr double exact_to = 1e-12;
    constexpr int most_restarts = 100;
    Spectra::DenseSymMatProd<double> product(gram);
    Spectra::SymEigsSolver<Spectra::DenseSymMatProd<double>> solver(
        product, count, std::min(side, std::max<Eigen::Index>(2 * count, 40)));
    solver.init();
    solver.compute(Spectra::SortRule::LargestAlge, most_restarts, exact_to);
    found = solver.info() == Spectra::CompInfo::Successful;
    if (found) take_axes(solver.eigenvalues(), solver.eigenvectors(), components);
  }
  if (found) {
    components.beyond = std::max(0.0, gram.trace() - components.scatter.sum());
    components.beyond_squares = std::max(0.0, gram.squaredNorm() - components.scatter.squaredNorm());
  }
  if (!found) all_axes(gram, components);
  return components;
}

Eigen::Index modes_holding(const Eigen::VectorXd& variances, double share) {
  const double total = variances.sum();
  if (!(total > 0)) return 0;
  double held = 0;
  Eigen::Index modes = 0;
  // The share is met up to rounding, so that 1 asks for the rank and not for noise: files keep numbers in single
  // precision.
  constexpr double rounding = 1e-7;
  while (modes < variances.size() && (modes == 0 || held < (share - rounding) * total)) held += variances[modes++];
  return modes;
}

ShapeModel make_model(const PrincipalComponents& components, double share, std::shared_ptr<const Topology> topology,
                      std::vector<std::string> names) {
  demand(share > 0 && share <= 1, "a model holds a share of the variance above 0 and up to 1; give one of these");
  return model_of_modes(components, modes_holding(components.variances(), share), std::move(topology),
                        std::move(names));
}

ShapeModel model_of_modes(const PrincipalComponents& components, Eigen::Index modes,
                          std::shared_ptr<const Topology> topology, std::vector<std::string> names) {
  demand(modes >= 0, "a model has no negative number of modes; give 0 or more");
  if (topology) demand(check_count(components.vertices(), topology->vertices(), "a shape of the model"));
  modes = std::min(modes, components.scatter.size());
  const Eigen::VectorXd variances = components.variances();
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
  demand(b.size() <= model.modes(), "there are more coefficients than the model has modes; give as many or fewer");
  const Eigen::VectorXd reach = limit * model.variances.head(b.size()).cwiseSqrt();
  return b.cwiseMax(-reach).cwiseMin(reach);
}

Points shape_of(const ShapeModel& model, const Eigen::VectorXd& b) {
  const Eigen::Index count = std::min(b.size(), model.modes());
  const Eigen::VectorXd shape = model.mean + model.basis.leftCols(count) * b.head(count);
  return points_of(shape);
}

Points mode_shape(const ShapeModel& model, Eigen::Index mode, double deviations) {
  demand(mode >= 0 && mode < model.modes(), "the model has no such mode; modes are counted from 0");
  const Eigen::VectorXd shape = model.mean + deviations * std::sqrt(model.variances[mode]) * model.basis.col(mode);
  return points_of(shape);
}

Eigen::VectorXd coefficients(const ShapeModel& model, const Points& shape) {
  demand(shape.size() == model.mean.size(), "the shape has other vertices than the model; give one of its numbering");
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
