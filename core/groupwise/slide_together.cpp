#include "core/groupwise/slide_together.h"

#include <algorithm>
#include <cmath>

#include "core/base/processes/parallel.h"
#include "core/groupwise/description.h"
#include "core/groupwise/sliding_surface.h"
#include "core/mesh/mesh_quality.h"
#include "core/placement/similarity_fit.h"

namespace homolog {

namespace {

constexpr double position_weight = 0.25;  ///< weight of a coordinate in a large set, where each feature counts 1
constexpr double few_shapes = 4;          ///< in so few positions do not count
constexpr double stiffness_share = 0.15;  ///< share of the square root of the area: how far a slide spreads
constexpr double first_precision = 1, last_precision = 0.1;  ///< in units of the set's own deviation
constexpr double step = 0.5;  ///< share of the way to what is expected, since all shapes move at a time

using Row6 = Eigen::Matrix<double, 1, 6>;

/// Mean over the rows of the variance over the columns.
double variance_over_shapes(const ShapeMatrix& shapes) {
  const Eigen::VectorXd mean = shapes.rowwise().mean();
  return (shapes.colwise() - mean).squaredNorm() / static_cast<double>(shapes.rows() * (shapes.cols() - 1));
}

/// The same for each feature.
Row6 feature_variances(const std::vector<SurfaceFeatures>& features) {
  SurfaceFeatures mean = features.front();
  for (std::size_t k = 1; k < features.size(); ++k) mean += features[k];
  mean /= static_cast<double>(features.size());
  Row6 sum = Row6::Zero();
  for (const SurfaceFeatures& one : features) sum += (one - mean).colwise().squaredNorm();
  return sum / static_cast<double>(mean.rows() * (std::ssize(features) - 1));
}

class Sliding {
 public:
  Sliding(const std::shared_ptr<const Topology>& topology, const ShapeMatrix& shapes, const GroupwiseOptions& options)
      : topology_(topology), options_(options), shapes_(shapes) {}

  Result<GroupwiseResult> run() {
    if (auto ready = prepare(); !ready) return fail(ready.error());
    GroupwiseResult result;
    for (int round = 0;; ++round) {
      describe();
      result.rounds.push_back({description_bits(described_, last_precision),
                               description_bits(aligned_ * per_mm_, last_precision), 3 * variance_over_shapes(aligned_),
                               0});
      if (options_.show) options_.show(result.rounds);
      if (round == options_.rounds) break;
      const double share = static_cast<double>(round) / std::max(1, options_.rounds - 1);
      result.rounds.back().way_mm = slide(first_precision * std::pow(last_precision / first_precision, share));
      if (options_.progress == nullptr) continue;
      options_.progress->report(static_cast<double>(round + 1) / options_.rounds);
      if (options_.progress->cancelled()) return fail("", "the optimisation was cancelled");
    }
    for (const SlidingSurface& surface : surfaces_) result.largest_slide_mm.push_back(surface.slides_mm().maxCoeff());
    result.shapes = std::move(shapes_);
    return result;
  }

 private:
  Result<void> prepare() {
    if (shapes_.cols() < 2) return fail("", "one shape alone cannot be optimised; give at least two");
    aligned_ = shapes_;
    align(aligned_, options_.alignment);
    double size_mm = 0, edge_mm = 0;
    const auto count = static_cast<double>(shapes_.cols());
    for (Eigen::Index k = 0; k < shapes_.cols(); ++k) {
      size_mm += std::sqrt(surface_area_mm2({topology_, points_of(aligned_, k)})) / count;
      edge_mm += mean_edge_mm(*topology_, points_of(aligned_, k)) / count;
    }
    const double deviation_mm = std::sqrt(variance_over_shapes(aligned_));
    if (!(size_mm > 0) || !(deviation_mm > 0))
      return fail("", "the shapes are all equal or have no extent, so there is nothing to optimise");
    // Few shapes say little of how positions vary: each would only be drawn to the others.
    per_mm_ = std::sqrt(std::max(position_weight * (1 - few_shapes / count), 1e-6)) / deviation_mm;
    std::vector<SurfaceFeatures> features = surface_features(topology_, aligned_, size_mm);
    const Row6 units = feature_variances(features).cwiseMax(1e-12).cwiseSqrt().cwiseInverse();
    const VertexScalars w =
        VertexScalars::Constant(topology_->vertices(), stiffness_from_length(stiffness_share * size_mm, edge_mm));
    auto free = std::make_shared<ShapeSolver>(topology_);
    if (auto ready = free->factorise(w); !ready) return ready;
    for (std::size_t k = 0; k < features.size(); ++k) {
      std::shared_ptr<ShapeSolver> solver = free;
      VertexScalars held;
      if (!options_.held.empty() && options_.held[k].size() > 0 && options_.held[k].maxCoeff() > 0) {
        held = options_.held[k];
        solver = std::make_shared<ShapeSolver>(topology_);
        if (auto ready = solver->factorise(w, firm_hold(*topology_, w, held)); !ready) return ready;
      }
      features[k] = (features[k].array().rowwise() * units.array()).matrix();
      surfaces_.emplace_back(topology_, points_of(shapes_, static_cast<Eigen::Index>(k)), std::move(features[k]),
                             std::move(held), solver);
    }
    return {};
  }

  /// Aligns the shapes and puts what describes them together: 3n rows of positions, then 6n of features.
  void describe() {
    aligned_ = shapes_;
    align(aligned_, options_.alignment);
    described_.resize(3 * shapes_.rows(), shapes_.cols());
    described_.topRows(shapes_.rows()) = per_mm_ * aligned_;
    for_each_in_parallel(surfaces_.size(), [&](std::size_t k) {
      described_.col(static_cast<Eigen::Index>(k)).tail(2 * shapes_.rows()) =
          surfaces_[k].features().reshaped<Eigen::RowMajor>();
    });
  }

  double slide(double precision) {
    const Descriptions expected = expected_from_others(described_, precision);
    std::vector<double> ways_mm(surfaces_.size());
    for_each_in_parallel(surfaces_.size(), [&](std::size_t k) {
      const auto column = static_cast<Eigen::Index>(k);
      const Eigen::Index n = topology_->vertices();
      const Similarity back = nearest_similarity(points_of(aligned_, column), points_of(shapes_, column), {});
      const Points where = Eigen::Map<const Points>(expected.col(column).data(), n, 3) / per_mm_;
      const ExpectedShape there{back.apply(where),
                                Eigen::Map<const SurfaceFeatures>(expected.col(column).data() + 3 * n, n, 6),
                                per_mm_ / back.scale};
      ways_mm[k] = surfaces_[k].slide(there, step);
    });
    double sum = 0;
    for (std::size_t k = 0; k < surfaces_.size(); ++k) {
      shapes_.col(static_cast<Eigen::Index>(k)) = surfaces_[k].points().reshaped<Eigen::RowMajor>();
      sum += ways_mm[k] * ways_mm[k];
    }
    return std::sqrt(sum / static_cast<double>(surfaces_.size()));
  }

  std::shared_ptr<const Topology> topology_;
  const GroupwiseOptions& options_;
  ShapeMatrix shapes_, aligned_;
  Descriptions described_;
  std::vector<SlidingSurface> surfaces_;
  double per_mm_ = 0;  ///< the weight of a mm where a feature's deviation counts 1
};

}  // namespace

Result<GroupwiseResult> slide_together(const std::shared_ptr<const Topology>& topology, const ShapeMatrix& shapes,
                                       const GroupwiseOptions& options) {
  return Sliding(topology, shapes, options).run();
}

}  // namespace homolog
