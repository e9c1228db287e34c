#include "core/adapt/contours/contour_warp.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "core/base/numbers/statistics.h"
#include "core/mesh/mesh_quality.h"
#include "core/placement/landmark_warp.h"

namespace homolog {

namespace {

/// Pieces that lie farther off than this many times the median are believed less: the mesh there may be another part of
/// the organ.
constexpr double far_off = 4;
constexpr int warp_rounds = 10;
/// The boundary may be off by these shares of the diagonal, at first and in the end.
constexpr double first_noise = 0.02, last_noise = 0.004;

/// How an organ differs from its template under a similarity, as shares of its diagonal: the covariance of each
/// coordinate of the displacement at two places.
struct Differences {
  Eigen::RowVector3d centre;
  double diagonal_mm;
  static constexpr double shift = 0.05, stretch = 0.08, bend = 0.1;
  static constexpr double wide_reach = 0.3, wide_bump = 0.05, fine_reach = 0.1, fine_bump = 0.03;

  Eigen::MatrixXd operator()(const Points& a, const Points& b) const {
    const Eigen::ArrayX3d from = (a.rowwise() - centre).array() / diagonal_mm;
    Eigen::MatrixXd covariance(a.rows(), b.rows());
    for (Eigen::Index j = 0; j < b.rows(); ++j) {
      const Eigen::RowVector3d to = (b.row(j) - centre) / diagonal_mm;
      const auto apart2 =
          (from.col(0) - to[0]).square() + (from.col(1) - to[1]).square() + (from.col(2) - to[2]).square();
      const auto product = from.col(0) * to[0] + from.col(1) * to[1] + from.col(2) * to[2];
      covariance.col(j).array() = diagonal_mm * diagonal_mm *
                                  (shift * shift + (stretch * stretch + bend * bend * product) * product +
                                   wide_bump * wide_bump * (-0.5 / (wide_reach * wide_reach) * apart2).exp() +
                                   fine_bump * fine_bump * (-0.5 / (fine_reach * fine_reach) * apart2).exp());
    }
    return covariance;
  }
};

/// The knowledge of a displacement: at places, along directions, by how much, and how surely.
struct Knowledge {
  Points places, along;
  Eigen::VectorXd offset_mm, noise_mm;

  explicit Knowledge(Eigen::Index count) : places(count, 3), along(count, 3), offset_mm(count), noise_mm(count) {}
  void set(Eigen::Index k, const Eigen::RowVector3d& place, const Eigen::RowVector3d& direction, double by_mm,
           double noise) {
    places.row(k) = place;
    along.row(k) = direction;
    offset_mm[k] = by_mm;
    noise_mm[k] = noise;
  }
};

}  // namespace

ContourWarp warp_to_contours(const std::shared_ptr<const Topology>& topology, const Points& placed,
                             const ContourTarget& target, const Points& landmarks_from, const Points& landmarks_to,
                             double landmark_mm) {
  const double diagonal_mm = bounds_of(placed).diagonal().norm();
  const Differences kernel{placed.colwise().mean(), diagonal_mm};
  ContourWarp warp{placed, VertexScalars::Zero(placed.rows())};
  const Eigen::Index landmarks = 3 * landmarks_from.rows();
  for (int round = 0; round < warp_rounds; ++round) {
    const Mesh mesh{topology, warp.points};
    const auto meetings = target.meetings(mesh);
    const auto beyond = target.beyond(mesh);
    Knowledge known(landmarks + std::ssize(meetings) + std::ssize(beyond));
    Eigen::Index row = 0;
    for (; row < landmarks; ++row)
      known.set(row, landmarks_from.row(row / 3), Eigen::RowVector3d::Unit(row % 3),
                landmarks_to(row / 3, row % 3) - landmarks_from(row / 3, row % 3), landmark_mm);
    const double share = static_cast<double>(round) / (warp_rounds - 1);
    const double noise_mm = first_noise * std::pow(last_noise / first_noise, share) * diagonal_mm;
    std::vector<double> away;
    for (const ContourMeeting& met : meetings)
      away.push_back((target.contours().samples[met.sample].likely - met.position).norm());
    const double outlying_mm = far_off * std::max(quantile(away, 0.5), noise_mm);
    for (const ContourMeeting& met : meetings) {
      const ContourSample& sample = target.contours().samples[met.sample];
      const Eigen::RowVector3d place = met.on.interpolate(*topology, placed);
      known.set(
          row++, place, met.normal.transpose(), (sample.likely.transpose() - place).dot(met.normal),
          std::hypot(noise_mm, sample.off_mm) * (1 + std::pow((sample.likely - met.position).norm() / outlying_mm, 2)));
    }
    for (const BeyondLimit& one : beyond) {
      const Eigen::RowVector3d place = one.on.interpolate(*topology, placed),
                               way = (one.limit - one.position).normalized();
      known.set(row++, place, way, (one.limit.transpose() - place).dot(way), noise_mm);
    }
    Eigen::MatrixXd covariance = kernel(known.places, known.places).cwiseProduct(known.along * known.along.transpose());
    covariance.diagonal() += known.noise_mm.cwiseAbs2();
    const Eigen::LLT<Eigen::MatrixXd> solver(covariance);
    const Eigen::VectorXd weights = solver.solve(known.offset_mm);
    const Eigen::MatrixXd towards = kernel(placed, known.places);
    warp.points = placed + towards * (weights.asDiagonal() * known.along);
    if (round + 1 < warp_rounds) continue;
    const Points normals = vertex_normals({topology, warp.points});
    const Eigen::MatrixXd seen = towards.cwiseProduct(normals * known.along.transpose());
    const Eigen::MatrixXd halves = solver.matrixL().solve(seen.transpose());
    for (Eigen::Index i = 0; i < placed.rows(); ++i)
      warp.deviation[i] = std::sqrt(
          std::max(0.0, kernel(placed.middleRows(i, 1), placed.middleRows(i, 1))(0, 0) - halves.col(i).squaredNorm()));
  }
  warp.points = without_folds(*topology, placed, warp.points - placed).points;
  return warp;
}

}  // namespace homolog
