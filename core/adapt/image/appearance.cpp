#include "core/adapt/image/appearance.h"

#include <algorithm>
#include <cmath>

#include "core/base/processes/parallel.h"

namespace homolog {

namespace {

constexpr double compared_mm = 10;
constexpr float least_learned_contrast = 0.5f;  ///< share of the learned one that a profile needs for full likeness

/// `column` at `t_mm` from its middle, linear between samples.
float profile_value(const Eigen::Ref<const Eigen::VectorXf>& column, double step_mm, double t_mm) {
  const double place =
      std::clamp(t_mm / step_mm + static_cast<double>(column.size() / 2), 0.0, static_cast<double>(column.size() - 1));
  const auto low = std::min(static_cast<Eigen::Index>(place), column.size() - 2);
  const auto part = static_cast<float>(place - static_cast<double>(low));
  return (1 - part) * column[low] + part * column[low + 1];
}

}  // namespace

double Appearance::reach_mm() {
  return compared_mm;
}

Result<void> Appearance::learn(const Volume& image, int frame, const Mesh& mesh) {
  const double step_mm = empty() ? profile_step_mm(image) : step_mm_;
  const Profiles profiles =
      smoothed_over_surface(*mesh.topology, sample_profiles(image, frame, mesh, compared_mm, step_mm));
  const Eigen::MatrixXf& values = profiles.values;
  if (empty()) {
    mean_ = count_ = Eigen::MatrixXf::Zero(values.rows(), values.cols());
    step_mm_ = step_mm;
  } else if (values.cols() != mean_.cols()) {
    return fail("", "has " + std::to_string(values.cols()) + " vertices, but the cases learned before have " +
                        std::to_string(mean_.cols()) + "; learn from meshes of one template");
  }
  const auto known = values.array().isFinite().eval();
  count_ += known.cast<float>().matrix();
  mean_ = known.select(mean_.array() + (values.array() - mean_.array()) / count_.array().max(1), mean_.array());
  ++cases_;
  return {};
}

Eigen::MatrixXf Appearance::likeness(const Profiles& profiles) const {
  const Eigen::MatrixXf& values = profiles.values;
  Eigen::MatrixXf result = Eigen::MatrixXf::Constant(values.rows(), values.cols(), not_shown);
  const auto half = static_cast<Eigen::Index>(std::floor(compared_mm / profiles.step_mm));
  const Eigen::Index window = 2 * half + 1;
  in_parallel(values.cols(), [&](Eigen::Index from, Eigen::Index to) {
    Eigen::VectorXf learned(window), own(window);
    for (Eigen::Index i = from; i < to; ++i) {
      if (count_.col(i).minCoeff() < 1) continue;
      for (Eigen::Index k = 0; k < window; ++k)
        learned[k] = profile_value(mean_.col(i), step_mm_, static_cast<double>(k - half) * profiles.step_mm);
      learned.array() -= learned.mean();
      const float contrast = learned.norm();
      if (!(contrast > 0)) continue;
      for (Eigen::Index k = half; k + half < values.rows(); ++k) {
        own = values.col(i).segment(k - half, window);
        own.array() -= own.mean();
        result(k, i) = learned.dot(own) / (contrast * std::max(own.norm(), least_learned_contrast * contrast));
      }
    }
  });
  return result;
}

}  // namespace homolog
