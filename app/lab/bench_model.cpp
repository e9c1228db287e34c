#include "app/lab/bench_model.h"

#include "app/lab/median.h"
#include "core/base/processes/memory.h"
#include "core/base/processes/parallel.h"
#include "core/mesh/construction/icosphere.h"
#include "core/model/measures/measures.h"

namespace homolog {

namespace {

using Clock = std::chrono::steady_clock;

/// Balls of 10,242 vertices bent by smooth waves of falling strength, and some noise: M shapes whose variance falls off
/// about as an organ's does.
ShapeMatrix made_shapes(int shapes) {
  const Mesh ball = icosphere(5, 50);
  constexpr int waves = 40;
  const Eigen::MatrixXd strengths =
      sampled_coefficients(Eigen::VectorXd::LinSpaced(waves, 1, waves).cwiseInverse() * 6, shapes, 1);
  const Eigen::MatrixXd directions = sampled_coefficients(Eigen::VectorXd::Ones(7), waves, 2);
  ShapeMatrix made(ball.points.size(), shapes);
  made.colwise() = Eigen::Map<const Eigen::VectorXd>(ball.points.data(), ball.points.size());
  Eigen::VectorXd wave(made.rows());
  for (int w = 0; w < waves; ++w) {
    const Vec3 along = 0.03 * directions.col(w).head<3>(), push = directions.col(w).segment<3>(3);
    for (Eigen::Index v = 0; v < ball.points.rows(); ++v)
      wave.segment<3>(3 * v) = std::sin(ball.points.row(v).dot(along) + directions(6, w)) * push;
    made.noalias() += wave * strengths.row(w);
  }
  std::uint32_t noise = 1;
  for (double& x : made.reshaped()) {
    noise = noise * 1664525U + 1013904223U;
    x += 0x1p-32 * 0.1 * noise;
  }
  return made;
}

/// Loops in parallel use one thread while it lives.
class OneThread {
 public:
  OneThread() { set_thread_limit(1); }
  ~OneThread() { set_thread_limit(before_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int before_ = thread_limit();
};

Json hundred_shapes() {
  const OneThread one_thread;
  ShapeMatrix shapes = made_shapes(100);
  const auto start = Clock::now();
  align(shapes, Alignment::similarity);
  const auto aligned = Clock::now();
  const PrincipalComponents components = principal_components(std::move(shapes));
  const auto analysed = Clock::now();
  (void)compactness(components);
  (void)generalisation_rms(components);
  const auto generalised = Clock::now();
  (void)specificity_rms(components, 1000, 1);
  const auto rms = Clock::now();
  const std::vector<int> modes{static_cast<int>(modes_holding(components.variances(), 0.95))};
  (void)generalisation(components, nullptr, modes);
  (void)specificity_mean(components, modes, 1000, 1);
  const auto mean = Clock::now();
  return {{"shapes", 100},
          {"vertices", components.vertices()},
          {"modes", modes.front()},
          {"align_ms", milliseconds(aligned - start)},
          {"components_ms", milliseconds(analysed - aligned)},
          {"generalization_rms_ms", milliseconds(generalised - analysed)},
          {"specificity_rms_ms", milliseconds(rms - generalised)},
          {"align_to_rms_measures_ms", milliseconds(rms - start)},
          {"mean_euclidean_measures_ms", milliseconds(mean - rms)}};
}

Json thousand_shapes() {
  const double before_mb = resident_memory_mb();
  ShapeMatrix shapes = made_shapes(1000);
  const double data_mb = static_cast<double>(shapes.size() * sizeof(double)) / 1e6;
  forget_peak_memory();
  const auto start = Clock::now();
  align(shapes, Alignment::similarity);
  const PrincipalComponents components = principal_components(std::move(shapes));
  const ShapeModel model = make_model(components, 0.95, nullptr, {});
  return {{"shapes", 1000},         {"vertices", components.vertices()},
          {"modes", model.modes()}, {"model_ms", milliseconds(Clock::now() - start)},
          {"data_mb", data_mb},     {"peak_mb", peak_memory_mb() - before_mb}};
}

}  // namespace

Json model_figures() {
  return {{"one_core", hundred_shapes()}, {"large", thousand_shapes()}};
}

}  // namespace homolog
