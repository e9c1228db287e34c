#include "core/model/alignment/procrustes.h"

#include <algorithm>
#include <cmath>

#include "core/base/demand.h"
#include "core/base/numbers/rotation.h"
#include "core/base/processes/parallel.h"

namespace homolog {

namespace {

using ShapeMap = Eigen::Map<Points>;

constexpr double mean_rests = 1e-10;  ///< change of the mean in one round, as a share of its size
constexpr int most_mean_rounds = 100;

ShapeMap shape_in(ShapeMatrix& shapes, Eigen::Index i) {
  return {shapes.col(i).data(), shapes.rows() / 3, 3};
}

/// Centres every shape; gives their centroid sizes.
Eigen::VectorXd centre(ShapeMatrix& shapes) {
  Eigen::VectorXd sizes(shapes.cols());
  in_parallel(shapes.cols(), [&](Eigen::Index first, Eigen::Index last) {
    for (Eigen::Index i = first; i < last; ++i) {
      ShapeMap shape = shape_in(shapes, i);
      const Eigen::RowVector3d middle = shape.colwise().mean();
      shape.rowwise() -= middle;
      sizes[i] = shape.norm();
    }
  });
  return sizes;
}

/// Turns every shape to `mean`.
void turn_to(const Points& mean, ShapeMatrix& shapes) {
  in_parallel(shapes.cols(), [&](Eigen::Index first, Eigen::Index last) {
    for (Eigen::Index i = first; i < last; ++i) {
      ShapeMap shape = shape_in(shapes, i);
      const Mat3 turned_back = nearest_rotation(mean.transpose() * shape).transpose();
      for (Eigen::Index v = 0; v < shape.rows(); ++v) shape.row(v) = Eigen::RowVector3d(shape.row(v)) * turned_back;
    }
  });
}

}  // namespace

double centroid_size_mm(const Points& points) {
  return (points.rowwise() - points.colwise().mean()).norm();
}

void align(ShapeMatrix& shapes, Alignment alignment) {
  demand(shapes.rows() % 3 == 0, "shapes have rows that are no multiple of 3; give x, y and z of each vertex");
  if (alignment == Alignment::none || shapes.cols() == 0) return;
  demand(shapes.allFinite(), "shapes have a coordinate that is no finite number; correct or leave out that shape");
  const Eigen::VectorXd sizes = centre(shapes);
  if (alignment == Alignment::similarity) {
    for (Eigen::Index i = 0; i < shapes.cols(); ++i)
      if (sizes[i] > 0) shapes.col(i) *= sizes.mean() / sizes[i];
  }
  Points mean = points_of(shapes, 0);
  for (int round = 0; round < most_mean_rounds; ++round) {
    turn_to(mean, shapes);
    const Eigen::VectorXd next = shapes.rowwise().mean();
    const double change = (points_of(next) - mean).norm();
    mean = points_of(next);
    if (change <= mean_rests * mean.norm()) break;
  }
}

Points aligned_to(const Points& points, const Points& target, Alignment alignment) {
  demand(points.rows() == target.rows(), "two shapes of other numbers of points cannot be aligned; give one numbering");
  if (alignment == Alignment::none) return points;
  const Eigen::RowVector3d to_centre = target.colwise().mean();
  const Points from = points.rowwise() - points.colwise().mean(), to = target.rowwise() - to_centre;
  const double scale = alignment == Alignment::similarity && from.norm() > 0 ? to.norm() / from.norm() : 1;
  return (scale * from * nearest_rotation(to.transpose() * from).transpose()).rowwise() + to_centre;
}

double reflection_gain(const Points& a, const Points& b) {
  const Points from = b.rowwise() - b.colwise().mean(), to = a.rowwise() - a.colwise().mean();
  const double size = from.norm() * to.norm();
  if (!(size > 0)) return 1;
  const Mat3 covariance = to.transpose() * from / size;
  // Of unit-size shapes the squared distance is 1 − tr(Rᵀ covariance)² at the best scale; −R is the best reflection.
  const auto distance = [](const Mat3& c) {
    const double overlap = nearest_rotation(c).cwiseProduct(c).sum();
    return std::sqrt(std::max(1 - overlap * overlap, 1e-24));
  };
  return distance(covariance) / distance(-covariance);
}

}  // namespace homolog
