#include "core/adapt/snap.h"

#include <algorithm>

#include "core/adapt/annealing.h"
#include "core/adapt/image/image_target.h"
#include "core/adapt/untangle.h"
#include "core/base/text/lengths.h"
#include "core/deform/falloff.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

constexpr int snap_steps = 12;
constexpr double softest_edges = 1.5;
constexpr double softest_edges_learned = 3;  ///< a case done before differs less: the shape is trusted more
constexpr double least_seen_share = 0.1;
constexpr double doubtful_snap = 0.55;

constexpr const char* no_edge = "shows no edge around the mesh; place the mesh on the organ, or search farther";
constexpr const char* not_there = "does not reach to the mesh; place the mesh on the organ first";

/// Free vertices that the image does not show.
std::vector<std::int32_t> unseen_vertices(const VolumeGeometry& image, const Points& points,
                                          const VertexScalars& free) {
  std::vector<std::int32_t> unseen;
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    if (free[i] > 0 && !image.holds(points.row(i))) unseen.push_back(static_cast<std::int32_t>(i));
  return unseen;
}

class Snapping {
 public:
  Snapping(const Volume& image, int frame, const SnapStart& start, const SnapOptions& options)
      : grid_(image.geometry),
        start_(start),
        options_(options),
        target_(image, frame, start.mesh, options.edges, start.pins),
        shape_{.mesh = start.mesh,
               .rest = start.rest.size() > 0 ? start.rest : start.mesh.points,
               .placed = start.mesh.points,
               .factors = start.stiffness / start.stiffness.mean(),
               .pins = start.pins} {
    if (start.rest.size() > 0) shape_.place_anew();
    for (Eigen::Index i = 0; i < start.free.size(); ++i)
      if (!(start.free[i] > 0)) shape_.held.push_back(static_cast<std::int32_t>(i));
  }

  Result<SnapResult> run() {
    if (!target_.is_there()) return fail("", no_edge);
    ShapeSolver solver(shape_.mesh.topology);
    const Annealing annealing{snap_steps, target_.is_learned() ? softest_edges_learned : softest_edges};
    const auto force = [this](const Mesh& mesh, double share) { return this->force(mesh, share); };
    const auto after_step = [this](double share) { return report(share); };
    if (auto done = anneal(shape_, solver, annealing, force, after_step); !done) return fail(done.error());
    make_sound();
    return finish();
  }

 private:
  /// The pull of the image, and another one back to P⁰ where the image decides in part only.
  Force force(const Mesh& mesh, double share_of_way) {
    const TargetPull pull = target_.pull(mesh, share_of_way);
    Force force{VertexScalars(pull.weights.size()), Points(pull.weights.size(), 3)};
    for (Eigen::Index i = 0; i < force.weights.size(); ++i) {
      const double share = options_.strength * start_.free[i];
      const double towards = share * pull.weights[i], back = 1 - share;
      force.weights[i] = std::max(towards + back, least_weight);
      force.pulls.row(i) = towards * pull.targets.row(i) + back * start_.mesh.points.row(i) +
                           (force.weights[i] - towards - back) * mesh.points.row(i);
    }
    force.weights /= least_weight;
    force.pulls /= least_weight;
    return force;
  }

  Result<void> report(double share_of_way) const {
    if (options_.progress == nullptr) return {};
    options_.progress->report(0.95 * share_of_way);
    return options_.progress->cancelled() ? Result<void>(fail("", "the snap was cancelled")) : Result<void>{};
  }

  /// Frees faces that meet or turn; where some turn still, other than those that did at the start, the way there is
  /// shortened.
  void make_sound() {
    Mesh& mesh = shape_.mesh;
    untangle(mesh, shape_.placed, shape_.factors);
    if (!shape_.pins.empty()) meet_again();
    for (const std::int32_t i : shape_.held) mesh.points.row(i) = start_.mesh.points.row(i);
    mesh.points = without_turning(*mesh.topology, start_.placed, start_.mesh.points, mesh.points);
  }

  /// Brings back to the pins what untangling moved away, with what lies around.
  void meet_again() {
    Mesh& mesh = shape_.mesh;
    const double edge_mm = mean_edge_mm(*mesh.topology, mesh.points);
    for (const Pin& pin : shape_.pins) {
      const Eigen::RowVector3d off = pin.place.transpose() - pin.on.interpolate(*mesh.topology, mesh.points);
      const VertexScalars around = gaussian_falloff(*mesh.topology, mesh.points, pin.on, 2 * edge_mm, edge_mm, false);
      mesh.points += around * (off / pin.on.interpolate(*mesh.topology, around)[0]);
    }
  }

  /// How far the farthest pin is from being met.
  double off_pins_mm() const {
    double farthest = 0;
    for (const Pin& pin : shape_.pins) {
      const auto there = pin.on.interpolate(*shape_.mesh.topology, shape_.mesh.points);
      farthest = std::max(farthest, (pin.place.transpose() - there).norm());
    }
    return farthest;
  }

  SnapResult finish() {
    constexpr double noticed_mm = 1;
    const Mesh& mesh = shape_.mesh;
    SnapResult result;
    result.points = mesh.points;
    result.confidence = target_.agreement(mesh);
    result.unseen = unseen_vertices(grid_, mesh.points, start_.free);
    VertexScalars seen = start_.free;
    for (const std::int32_t v : result.unseen) seen[v] = 0;
    if (seen.sum() > 0) result.mean_confidence = seen.dot(result.confidence) / seen.sum();
    result.moved_mm = start_.free.dot((mesh.points - start_.mesh.points).rowwise().norm()) / start_.free.sum();
    result.doubtful = result.mean_confidence < doubtful_snap;
    if (result.doubtful)
      result.warnings.emplace_back(
          "the image shows hardly any boundary at the mesh; check that the mesh lies on the right organ");
    if (const double off_mm = off_pins_mm(); off_mm > noticed_mm)
      result.warnings.push_back("its landmarks and contours contradict each other, by up to " + in_mm(off_mm, 1) +
                                "; move or remove one of them, or trust a contour less");
    if (!result.unseen.empty())
      result.warnings.push_back(std::to_string(result.unseen.size()) +
                                (result.unseen.size() == 1 ? " vertex lies beyond the scan and follows the others"
                                                           : " vertices lie beyond the scan and follow the others"));
    return result;
  }

  const VolumeGeometry& grid_;
  const SnapStart& start_;
  const SnapOptions& options_;
  ImageTarget target_;
  Adapting shape_;  ///< its reference is P⁰
};

}  // namespace

Result<AllowedFit> snap_allowed(const Volume& image, int frame, const AllowedShapes& allowed,
                                const std::shared_ptr<const Topology>& topology, const Similarity& placement,
                                const SnapOptions& options) {
  const Mesh start{topology, placement.apply(allowed.mean)};
  const auto n = static_cast<double>(start.points.rows());
  const VertexScalars all = VertexScalars::Ones(start.points.rows());
  if (static_cast<double>(unseen_vertices(image.geometry, start.points, all).size()) > (1 - least_seen_share) * n)
    return fail("", not_there);
  const ImageTarget target(image, frame, start, options.edges);
  if (!target.is_there()) return fail("", no_edge);
  const auto force = [&](const Mesh& mesh, double share) { return force_of(target.likeliest(mesh, share)); };
  const auto after_step = [&](double share) -> Result<void> {
    if (options.progress == nullptr) return {};
    options.progress->report(0.5 * share);
    return options.progress->cancelled() ? Result<void>(fail("", "the snap was cancelled")) : Result<void>{};
  };
  return fit_allowed(allowed, topology, placement, force, after_step);
}

Result<SnapResult> snap(const Volume& image, int frame, const SnapStart& start, const SnapOptions& options) {
  if (options.strength <= 0 || !start.free.any()) {
    SnapResult still;
    still.points = start.mesh.points;
    still.confidence = VertexScalars::Zero(start.mesh.points.rows());
    return still;
  }
  const auto unseen = unseen_vertices(image.geometry, start.mesh.points, start.free);
  const auto free = static_cast<double>((start.free.array() > 0).count());
  if (static_cast<double>(unseen.size()) > (1 - least_seen_share) * free) return fail("", not_there);
  return Snapping(image, frame, start, options).run();
}

}  // namespace homolog
