#include "core/adapt/match/coherent_match.h"

#include <array>
#include <cmath>
#include <limits>

#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

using Eigen::Index;

constexpr Index nodes = 200;
constexpr std::array<Index, 2> moved_samples{800, 1600};
constexpr Index still_for_moved = 2;  ///< at most: samples that stay, for each that is displaced
constexpr int matching_rounds = 16, turning_rounds = 6;
/// Shares of the root of the surface's area that count as near. Fine samples are taken from the last of these on.
constexpr double first_near = 0.06, last_near = 0.016, near_of_fine = 0.0226;
constexpr double bend_length = 1, fine_length = 0.2;      ///< reach of the displacement's two scales, of the radius
constexpr double fine_share = 0.12, stretch_share = 0.1;  ///< shares of the radius: fine displacement; stretch or turn

}  // namespace

CoherentMatch::Sides CoherentMatch::sides_of(const Mesh& mesh, const Points& spread_as) {
  const Points normals = vertex_normals(mesh);
  const std::vector<Index> spread = spread_vertices(spread_as, moved_samples.back());
  Sides sides;
  for (const Index count : moved_samples) {
    const auto moved = std::min(count, std::ssize(spread));
    sides.push_back({samples_of(mesh, normals, {spread.begin(), spread.begin() + moved}),
                     samples_of(mesh, normals, stepped_vertices(mesh.points.rows(), still_for_moved * count))});
  }
  return sides;
}

CoherentMatch::CoherentMatch(const Points& template_points, const Mesh& placed, const Mesh& surface)
    : placed_(placed.points),
      nodes_(placed.points(spread_vertices(template_points, nodes), Eigen::all)),
      own_(sides_of(placed, template_points)),
      there_(sides_of(surface, surface.points)),
      centre_(placed.points.colwise().mean()),
      radius_mm_(std::sqrt((placed.points.rowwise() - centre_).rowwise().squaredNorm().mean())),
      size_mm_(std::sqrt(surface_area_mm2(surface))) {}

/// Coefficients of the displacement that matches `own` with `there`; not finite where none can be solved for.
SmoothDisplacement::Coefficients CoherentMatch::matching(const Sides& own, const Sides& there,
                                                         const SmoothDisplacement& displacement,
                                                         const MatchFreedom& freedom, const KnownMatches& known) const {
  const Eigen::MatrixXd at_known = displacement.basis(known.from).value;
  const VertexScalars sure = known.noise_mm.cwiseAbs2().cwiseInverse();
  const Eigen::MatrixXd known_information = at_known.transpose() * sure.asDiagonal() * at_known,
                        known_pull = at_known.transpose() * (sure.asDiagonal() * (known.to - known.from));
  SmoothDisplacement::Coefficients found = SmoothDisplacement::Coefficients::Zero(displacement.nodes(), 3);
  std::size_t level = 0;
  SmoothDisplacement::Basis basis = displacement.basis(own.front().moved.points);
  for (int round = 0; round < matching_rounds; ++round) {
    const double share = static_cast<double>(round) / (matching_rounds - 1),
                 near = first_near * std::pow(last_near / first_near, share), near_mm = near * size_mm_;
    if (level == 0 && near < near_of_fine) basis = displacement.basis(own[++level].moved.points);
    SurfaceSamples moved = own[level].moved;
    const Points at_first = moved.points;
    moved.points += basis.value * found;
    moved.normals = displacement.turned_normals(basis, moved.normals, found);
    const auto [targets, weights] = drawn(moved, there[level].still, near_mm, freedom.facing);
    const double a_sample = static_cast<double>(at_first.rows()) / (2 * size_mm_ * size_mm_ * freedom.together);
    const VertexScalars believed = a_sample / (near_mm * near_mm) * weights;
    // Half the sum in half the precision: it takes most of the time.
    const Eigen::MatrixXf believed_basis = (believed.cwiseSqrt().asDiagonal() * basis.value).cast<float>();
    Eigen::MatrixXf from_samples = Eigen::MatrixXf::Zero(displacement.nodes(), displacement.nodes());
    from_samples.selfadjointView<Eigen::Lower>().rankUpdate(believed_basis.transpose());
    Eigen::MatrixXd information = from_samples.cast<double>() + known_information;
    information.diagonal().array() += 1;
    const Eigen::MatrixXd pull = basis.value.transpose() * (believed.asDiagonal() * (targets - at_first)) + known_pull;
    const Eigen::LLT<Eigen::MatrixXd> solved(information);
    if (solved.info() != Eigen::Success) return found.setConstant(std::numeric_limits<double>::quiet_NaN());
    found = solved.solve(pull);
  }
  return found;
}

CoherentMatch::Ways CoherentMatch::match(const MatchFreedom& freedom, const KnownMatches& known) const {
  const SmoothDisplacement displacement(nodes_, centre_,
                                        {freedom.bend_share * radius_mm_, bend_length * radius_mm_,
                                         fine_share * radius_mm_, fine_length * radius_mm_, stretch_share});
  const auto to_surface = matching(own_, there_, displacement, freedom, known),
             to_shape = matching(there_, own_, displacement, freedom, {known.to, known.from, known.noise_mm});
  const Points forth = placed_ + displacement.at(placed_, to_surface);
  // Where the displacement is not steep, each round comes nearer to what `to_shape` takes to the placed shape.
  Points back = forth;
  for (int round = 0; round < turning_rounds; ++round) back = placed_ - displacement.at(back, to_shape);
  return {forth, back};
}

}  // namespace homolog
