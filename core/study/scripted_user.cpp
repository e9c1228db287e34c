#include "core/study/scripted_user.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/mesh/mesh_quality.h"
#include "core/mesh/surface_search.h"
#include "core/placement/similarity_fit.h"

namespace homolog {

namespace {

constexpr Eigen::Index looked_at = 2500;
constexpr std::size_t most_tries = 24;
constexpr double helps = 0.998;  // of the mean square deviation: less is not seen
constexpr double largest_tilt = 40 * std::numbers::pi / 180;

/// σ presets as fractions of the placed reference's bounding-box diagonal, large to small: the editor's defaults.
constexpr std::array<double, 3> sigma_fractions{0.16, 0.08, 0.04};

struct Deviation {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();  ///< on the mesh, where the target has it
  double distance_mm = 0;
};

/// Mean point and root-mean-square distance from it, over the surface's vertices.
std::pair<Vec3, double> place_and_size(const Points& points) {
  const Vec3 mean = points.colwise().mean();
  const double size = std::sqrt((points.rowwise() - mean.transpose()).rowwise().squaredNorm().mean());
  return {mean, size};
}

/// What a person sees in slices of the three views: the in-plane part of a deviation. The plane is the one that shows
/// most of it, so the component along the smallest axis stays out of sight.
Vec3 in_slice(const Deviation& deviation) {
  Vec3 d = deviation.to - deviation.from;
  Eigen::Index across = 0;
  d.cwiseAbs().minCoeff(&across);
  d[across] = 0;
  return deviation.from + d;
}

/// Deviations in both directions, largest first: mesh vertices off the target, and target vertices that the mesh does
/// not reach.
std::vector<Deviation> deviations(const Mesh& mesh, const SurfaceSearch& target) {
  std::vector<Deviation> found;
  const SurfaceSearch own(mesh);
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i) {
    const auto nearest = target.nearest(mesh.points.row(i));
    found.push_back({mesh.points.row(i), nearest.position, nearest.distance_mm});
  }
  // A fine mask has far more vertices than a person looks at.
  const Points& there = target.mesh().points;
  const Eigen::Index stride = 1 + there.rows() / looked_at;
  for (Eigen::Index i = 0; i < there.rows(); i += stride) {
    const auto nearest = own.nearest(there.row(i));
    found.push_back({nearest.position, there.row(i), nearest.distance_mm});
  }
  std::sort(found.begin(), found.end(),
            [](const Deviation& a, const Deviation& b) { return a.distance_mm > b.distance_mm; });
  return found;
}

double mean_square(const std::vector<Deviation>& all) {
  double sum = 0;
  for (const Deviation& d : all) sum += d.distance_mm * d.distance_mm;
  return sum / static_cast<double>(all.size());
}

/// Tries the largest deviations until a pull helps; a person takes back a pull that made things worse, too, and goes
/// only half the way where the whole is too much.
Result<bool> pull_once(EditSession& session, const SurfaceSearch& target, const std::vector<Deviation>& seen,
                       double sigma_mm, double visible_mm) {
  const double before = mean_square(seen);
  std::vector<Vec3> tried;
  for (const Deviation& deviation : seen) {
    if (deviation.distance_mm < visible_mm || tried.size() == most_tries) break;
    const bool near_tried = std::any_of(tried.begin(), tried.end(),
                                        [&](const Vec3& p) { return (p - deviation.from).norm() < sigma_mm / 2; });
    if (near_tried) continue;
    tried.push_back(deviation.from);
    for (const double share : {1.0, 0.5}) {
      Stroke stroke;
      stroke.tool = Tool::pull;
      stroke.at = deviation.from;
      stroke.to = deviation.from + share * (in_slice(deviation) - deviation.from);
      stroke.sigma_mm = sigma_mm;
      const auto shown = session.preview(stroke);
      if (!shown || mean_square(deviations(shown->document.mesh(), target)) > before * helps) continue;
      if (auto done = session.apply(stroke); !done) return fail(done.error());
      return true;
    }
  }
  return false;
}

}  // namespace

Result<void> place_on(EditSession& session, const Mesh& target) {
  const Points& points = session.document().reference->points;
  const auto [centre, size] = place_and_size(points);
  const auto [there, size_there] = place_and_size(target.points);
  Similarity placement{Eigen::Quaterniond::Identity(), size_there / size, Vec3::Zero()};
  placement.translation = there - placement.scale * centre;
  const SurfaceSearch surface(target);
  for (int round = 0; round < 60; ++round) {
    // Both directions, so that neither a small template inside the target nor a large one around it looks perfect.
    const Mesh placed{session.document().reference->topology, placement.apply(points)};
    const std::vector<Deviation> all = deviations(placed, surface);
    Points from(static_cast<Eigen::Index>(all.size()), 3), to(from.rows(), 3);
    for (Eigen::Index k = 0; k < from.rows(); ++k) {
      from.row(k) = all[static_cast<std::size_t>(k)].from.transpose();
      to.row(k) = all[static_cast<std::size_t>(k)].to.transpose();
    }
    const Similarity next = fit_similarity(from, to, {}).after(placement);
    const bool settled =
        next.rotation.angularDistance(placement.rotation) < 1e-4 && std::abs(next.scale / placement.scale - 1) < 1e-4;
    if (Eigen::AngleAxisd(next.rotation).angle() > largest_tilt) break;
    placement = next;
    if (settled) break;
  }
  auto done = session.apply(SetPlacement{placement});
  return done ? Result<void>{} : fail(done.error());
}

Result<ScriptedUserResult> pull_to_target(EditSession& session, const Mesh& target,
                                          const ScriptedUserOptions& options) {
  const SurfaceSearch surface(target);
  const double diagonal = bounds_of(*session.document().shape().placed).diagonal().norm();
  ScriptedUserResult result;
  std::vector<Deviation> seen = deviations(session.document().mesh(), surface);
  for (const double fraction : sigma_fractions) {
    // The smaller σ takes over where the larger one no longer helps.
    while (result.pulls < options.most_pulls) {
      if (options.progress != nullptr) {
        options.progress->report(static_cast<double>(result.pulls) / options.most_pulls);
        if (options.progress->cancelled()) return fail("", "The scripted user was stopped");
      }
      const auto pulled = pull_once(session, surface, seen, fraction * diagonal, options.visible_mm);
      if (!pulled) return fail(pulled.error());
      if (!*pulled) break;
      ++result.pulls;
      seen = deviations(session.document().mesh(), surface);
    }
  }
  result.largest_deviation_mm = seen.front().distance_mm;
  return result;
}

}  // namespace homolog
