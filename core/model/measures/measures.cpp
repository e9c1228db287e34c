#include "core/model/measures/measures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/demand.h"
#include "core/base/numbers/index.h"
#include "core/base/processes/parallel.h"
#include "core/measure/compare.h"
#include "core/model/measures/leave_one_out.h"

namespace homolog {

namespace {

constexpr Eigen::Index block_vertices = 512, block_samples = 32;

Eigen::Index mode_counts(const PrincipalComponents& components) {
  demand(components.beyond == 0, "needs all components of the shapes; compute them with principal_components");
  return std::max<Eigen::Index>(0, components.shapes() - 2);
}

/// One row a mode count, one column a shape or sample.
Measures measured_rows(const Eigen::MatrixXd& values) {
  Measures measures;
  for (Eigen::Index m = 0; m < values.rows(); ++m) measures.push_back(measured(values.row(m).transpose()));
  return measures;
}

Error stopped() {
  return {"", "was stopped before the measures were complete"};
}

/// Vertices in groups of neighbours in the mean shape, none larger than `largest`: halved along the longest side.
std::vector<std::vector<Eigen::Index>> neighbourhoods(const Points& mean, std::size_t largest) {
  std::vector<std::vector<Eigen::Index>> groups(1), done;
  groups.front().resize(index(mean.rows()));
  std::iota(groups.front().begin(), groups.front().end(), Eigen::Index{0});
  while (!groups.empty()) {
    auto group = std::move(groups.back());
    groups.pop_back();
    if (group.size() <= largest) {
      done.push_back(std::move(group));
      continue;
    }
    Box box;
    for (const Eigen::Index v : group) box.extend(Vec3(mean.row(v)));
    Eigen::Index axis = 0;
    box.sizes().maxCoeff(&axis);
    const auto middle = group.begin() + static_cast<std::ptrdiff_t>(group.size() / 2);
    std::nth_element(group.begin(), middle, group.end(),
                     [&](Eigen::Index a, Eigen::Index b) { return mean(a, axis) < mean(b, axis); });
    groups.emplace_back(middle, group.end());
    group.erase(middle, group.end());
    groups.push_back(std::move(group));
  }
  return done;
}

/// Finds the nearest training shape by mean Euclidean vertex distance, exactly. For a group of vertices
/// Σ ‖d_v‖ ≥ ‖Σ d_v‖, so sums over neighbourhoods, a sixteenth of the data, bound every distance from below, closely
/// because shapes differ smoothly; only what may still be nearest is looked at in full.
class NearestShape {
 public:
  explicit NearestShape(const PrincipalComponents& components)
      : components_(components), weights_(components.weights()) {
    const auto groups = neighbourhoods(points_of(components.mean), 16);
    sums_.setZero(3 * std::ssize(groups), components.shapes());
    for (std::size_t g = 0; g < groups.size(); ++g)
      for (const Eigen::Index v : groups[g])
        sums_.middleRows<3>(3 * static_cast<Eigen::Index>(g)) += components.centred.middleRows<3>(3 * v);
  }

  /// For each column of coefficients b (any number of leading modes) the distance to the nearest training shape, mm.
  Eigen::VectorXd distances_mm(const Eigen::MatrixXd& b) const {
    Eigen::VectorXd nearest(b.cols());
    in_parallel(
        b.cols(),
        [&](Eigen::Index first, Eigen::Index last) {
          for (Eigen::Index k = first; k < last; k += block_samples) {
            const Eigen::Index count = std::min(block_samples, last - k);
            const Eigen::MatrixXd combinations = weights_.leftCols(b.rows()) * b.middleCols(k, count);
            const Eigen::MatrixXd samples = components_.centred * combinations, sums = sums_ * combinations;
            for (Eigen::Index s = 0; s < count; ++s)
              nearest[k + s] = distance_mm(samples.col(s).data(), sums.col(s).data());
          }
        },
        block_samples);
    return nearest;
  }

 private:
  static double sum_of_norms(const double* a, const double* b, Eigen::Index points) {
    double sum = 0;
    for (const double* end = a + 3 * points; a < end; a += 3, b += 3) {
      const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
      sum += std::sqrt(x * x + y * y + z * z);
    }
    return sum;
  }

  double distance_mm(const double* sample, const double* sample_sums) const {
    std::vector<std::pair<double, Eigen::Index>> bounds;
    for (Eigen::Index j = 0; j < components_.shapes(); ++j)
      bounds.emplace_back(sum_of_norms(sample_sums, sums_.col(j).data(), sums_.rows() / 3), j);
    std::sort(bounds.begin(), bounds.end());
    double best = std::numeric_limits<double>::infinity();
    for (const auto& [bound, j] : bounds) {
      if (bound > best) break;
      best = std::min(best, sum_of_norms(sample, components_.centred.col(j).data(), components_.vertices()));
    }
    return best / static_cast<double>(components_.vertices());
  }

  const PrincipalComponents& components_;
  Eigen::MatrixXd weights_, sums_;
};

/// The mean distance of each shape's vertices to its reconstruction, mm. `combinations`: left_out_errors.
Eigen::VectorXd mean_distances_mm(const PrincipalComponents& components, const Eigen::MatrixXd& combinations) {
  const Eigen::Index vertices = components.vertices();
  Eigen::VectorXd distances(components.shapes());
  in_parallel(components.shapes(), [&](Eigen::Index first, Eigen::Index last) {
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(last - first);
    Eigen::MatrixXd errors;
    for (Eigen::Index v = 0; v < vertices; v += block_vertices) {
      const Eigen::Index rows = 3 * std::min(block_vertices, vertices - v);
      errors.noalias() = components.centred.middleRows(3 * v, rows) * combinations.middleCols(first, last - first);
      for (Eigen::Index i = 0; i < errors.cols(); ++i)
        sums[i] += errors.col(i).reshaped(3, rows / 3).colwise().norm().sum();
    }
    distances.segment(first, last - first) = sums / static_cast<double>(vertices);
  });
  return distances;
}

/// The surface distance of each shape to its reconstruction, mm. `report`: is told how much is done, 0…1.
template <class Report>
Eigen::VectorXd surface_distances_mm(const PrincipalComponents& components,
                                     const std::shared_ptr<const Topology>& topology,
                                     const Eigen::MatrixXd& combinations, const Progress* progress,
                                     const Report& report) {
  Eigen::VectorXd distances(components.shapes());
  in_parallel(components.shapes(), [&](Eigen::Index first, Eigen::Index last) {
    for (Eigen::Index i = first; i < last; ++i) {
      if (progress != nullptr && progress->cancelled()) return;
      const Eigen::VectorXd shape = components.mean + components.centred.col(i);
      const Eigen::VectorXd rebuilt = shape - components.centred * combinations.col(i);
      distances[i] = mean_surface_distance_mm({topology, points_of(shape)}, {topology, points_of(rebuilt)});
      if (first == 0) report(static_cast<double>(i + 1) / static_cast<double>(last));
    }
  });
  return distances;
}

}  // namespace

Measured measured(const Eigen::VectorXd& values) {
  const auto n = static_cast<double>(values.size());
  if (values.size() == 0) return {};
  const double mean = values.mean();
  if (values.size() == 1) return {mean, 0};
  return {mean, std::sqrt((values.array() - mean).square().sum() / (n - 1) / n)};
}

Measures compactness(const PrincipalComponents& components) {
  const Eigen::VectorXd variances = components.variances();
  const double total = variances.sum(), squares = variances.squaredNorm();
  const double relative = std::sqrt(2.0 / static_cast<double>(components.shapes()));
  Measures measures;
  double held = 0, held_squares = 0;
  for (Eigen::Index m = 0; m < mode_counts(components); ++m) {
    held += variances[m];
    held_squares += variances[m] * variances[m];
    const double share = total > 0 ? held / total : 1;
    // The share and the rest are of one sum: by the delta method each variance counts with its own derivative.
    const double deviation =
        std::sqrt((1 - share) * (1 - share) * held_squares + share * share * std::max(0.0, squares - held_squares));
    measures.push_back({share, total > 0 ? relative * deviation / total : 0});
  }
  return measures;
}

Measures generalisation_rms(const PrincipalComponents& components) {
  const Eigen::Index counts = mode_counts(components);
  Eigen::MatrixXd distances(counts, components.shapes());
  in_parallel(components.shapes(), [&](Eigen::Index first, Eigen::Index last) {
    for (Eigen::Index i = first; i < last; ++i) {
      const Eigen::VectorXd squares = LeaveOneOut(components, i).squared_errors(counts);
      distances.col(i) = (squares.tail(counts) / static_cast<double>(components.vertices())).cwiseSqrt();
    }
  });
  return measured_rows(distances);
}

Measures specificity_rms(const PrincipalComponents& components, Eigen::Index samples, std::uint64_t seed) {
  const Eigen::Index counts = mode_counts(components), known = std::min(counts, components.scatter.size());
  const Eigen::MatrixXd b = sampled_coefficients(components.variances().head(known), samples, seed);
  const Eigen::MatrixXd scores = components.scores().transpose();  // a shape a row: its columns are contiguous
  // squared_rest.col(m): what of each training shape lies beyond the first m modes.
  Eigen::MatrixXd squared_rest = Eigen::MatrixXd::Zero(scores.rows(), known + 1);
  squared_rest.col(known) = scores.rightCols(scores.cols() - known).rowwise().squaredNorm();
  for (Eigen::Index m = known; m-- > 0;) squared_rest.col(m) = squared_rest.col(m + 1) + scores.col(m).cwiseAbs2();
  Eigen::MatrixXd distances(counts, samples);
  in_parallel(samples, [&](Eigen::Index first, Eigen::Index last) {
    Eigen::VectorXd along(scores.rows());
    for (Eigen::Index k = first; k < last; ++k) {
      along.setZero();
      for (Eigen::Index m = 0; m < counts; ++m) {
        if (m < known) along += (scores.col(m).array() - b(m, k)).square().matrix();
        const double nearest = (along + squared_rest.col(std::min(m + 1, known))).minCoeff();
        distances(m, k) = std::sqrt(nearest / static_cast<double>(components.vertices()));
      }
    }
  });
  return measured_rows(distances);
}

Result<Generalisation> generalisation(const PrincipalComponents& components,
                                      const std::shared_ptr<const Topology>& topology, const std::vector<int>& modes,
                                      Progress* progress) {
  Generalisation measures;
  const auto report = [&](double of_this_count) {
    if (progress != nullptr)
      progress->report((static_cast<double>(measures.mean.size()) - 1 + of_this_count) /
                       static_cast<double>(modes.size()));
  };
  for (const int m : modes) {
    if (progress != nullptr && progress->cancelled()) return fail(stopped());
    const Eigen::MatrixXd combinations = left_out_errors(components, m);
    measures.mean.push_back(measured(mean_distances_mm(components, combinations)));
    if (topology) {
      const Eigen::VectorXd distances = surface_distances_mm(components, topology, combinations, progress, report);
      if (progress != nullptr && progress->cancelled()) return fail(stopped());
      measures.surface.push_back(measured(distances));
    }
    report(1);
  }
  return measures;
}

Result<Measures> specificity_mean(const PrincipalComponents& components, const std::vector<int>& modes,
                                  Eigen::Index samples, std::uint64_t seed, bool singular_values_as_variances,
                                  Progress* progress) {
  const NearestShape nearest(components);
  Eigen::VectorXd variances = components.variances().head(components.scatter.size());
  if (singular_values_as_variances) variances = components.scatter.cwiseSqrt();
  const Eigen::MatrixXd b = sampled_coefficients(variances, samples, seed);
  Measures measures;
  for (const int m : modes) {
    if (progress != nullptr && progress->cancelled()) return fail(stopped());
    measures.push_back(measured(nearest.distances_mm(b.topRows(std::min<Eigen::Index>(m, b.rows())))));
    if (progress != nullptr) progress->report(static_cast<double>(measures.size()) / static_cast<double>(modes.size()));
  }
  return measures;
}

}  // namespace homolog
