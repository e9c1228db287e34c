#include "core/model/joint_models/complete_structures.h"

#include <array>
#include <cmath>
#include <limits>

#include "core/base/demand.h"
#include "core/base/processes/parallel.h"
#include "core/model/conditional.h"
#include "core/model/joint_models/joint_alignment.h"

namespace homolog {

namespace {

constexpr std::array noises_mm{1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0};
constexpr double deaf_mm = 1e9;  ///< a noise with which what is known tells nothing: the mean

std::vector<Eigen::Index> vertices_of(const std::vector<StructurePart>& parts, const std::vector<bool>& has) {
  std::vector<Eigen::Index> vertices;
  for (std::size_t k = 0; k < parts.size(); ++k)
    for (Eigen::Index v = 0; has[k] && v < parts[k].vertices; ++v) vertices.push_back(parts[k].first_vertex + v);
  return vertices;
}

/// A joint model of complete shapes, made to complete others.
class Completer {
 public:
  Completer(ShapeMatrix complete, Alignment alignment) : alignment_(alignment) {
    align(complete, alignment);
    model_ = with_pose(make_model(principal_components(std::move(complete)), 1, nullptr, {}));
  }

  /// The whole shape as the model expects it, where the shape lies. `known`: the vertices that are.
  Points expected(const Points& shape, const std::vector<Eigen::Index>& known, double noise_mm) const {
    const Points mean = points_of(model_.mean);
    Points seen(std::ssize(known), 3), mean_seen(std::ssize(known), 3);
    for (Eigen::Index k = 0; k < seen.rows(); ++k) {
      seen.row(k) = shape.row(known[k]);
      mean_seen.row(k) = mean.row(known[k]);
    }
    const Similarity pose = pose_onto(mean_seen, seen, alignment_);
    return pose.apply(predict(model_, known, pose.inverse().apply(seen), noise_mm / pose.scale).points);
  }

 private:
  Alignment alignment_;
  ShapeModel model_;
};

ShapeMatrix without(const ShapeMatrix& shapes, Eigen::Index left_out) {
  ShapeMatrix rest(shapes.rows(), shapes.cols() - 1);
  rest << shapes.leftCols(left_out), shapes.rightCols(shapes.cols() - 1 - left_out);
  return rest;
}

/// Mean square distance of the vertices of a structure.
double square_mm2(const StructurePart& part, const Points& a, const Points& b) {
  return (a - b).middleRows(part.first_vertex, part.vertices).rowwise().squaredNorm().mean();
}

}  // namespace

CompletedShape completed_shape(const ShapeMatrix& complete, const std::vector<StructurePart>& parts,
                               const IncompleteShape& shape, Alignment alignment) {
  demand(complete.cols() >= 3, "a joint model that completes others needs three complete shapes; give more");
  demand(shape.has.size() == parts.size(),
         "the shape has other structures than the joint model; say of each structure whether the shape has it");
  const std::vector<Eigen::Index> known = vertices_of(parts, shape.has);
  // Squares by noise and structure, for each shape that is left out; in the last row those of the mean.
  const auto tries = std::ssize(noises_mm);
  std::vector<Eigen::MatrixXd> squares(static_cast<std::size_t>(complete.cols()));
  for_each_in_parallel(squares.size(), [&](std::size_t s) {
    const auto left_out = static_cast<Eigen::Index>(s);
    const Completer others(without(complete, left_out), alignment);
    const Points truth = points_of(complete, left_out);
    squares[s].setZero(tries + 1, std::ssize(parts));
    for (Eigen::Index j = 0; j <= tries; ++j) {
      const double noise_mm = j < tries ? noises_mm[j] : deaf_mm;
      const Points found = others.expected(truth, known, noise_mm);
      for (std::size_t k = 0; k < parts.size(); ++k)
        if (!shape.has[k]) squares[s](j, static_cast<Eigen::Index>(k)) = square_mm2(parts[k], found, truth);
    }
  });
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(tries + 1, std::ssize(parts));
  for (const Eigen::MatrixXd& one : squares) mean += one / static_cast<double>(squares.size());
  Eigen::Index best = 0;
  mean.topRows(tries).rowwise().sum().minCoeff(&best);
  CompletedShape result;
  result.noise_mm = noises_mm[best];
  result.points = shape.points;
  const Points found = Completer(complete, alignment).expected(points_of(shape.points), known, result.noise_mm);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    result.expected_error_mm.push_back(std::sqrt(mean(best, static_cast<Eigen::Index>(k))));
    result.mean_error_mm.push_back(std::sqrt(mean(tries, static_cast<Eigen::Index>(k))));
    if (shape.has[k]) continue;
    const Points missing = found.middleRows(parts[k].first_vertex, parts[k].vertices);
    result.points.segment(3 * parts[k].first_vertex, 3 * parts[k].vertices) =
        Eigen::Map<const Eigen::VectorXd>(missing.data(), missing.size());
  }
  return result;
}

}  // namespace homolog
