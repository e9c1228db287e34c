#include "core/groupwise/consensus.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "core/adapt/fit.h"
#include "core/adapt/judge_fit.h"
#include "core/base/processes/parallel.h"
#include "core/groupwise/other_organs.h"
#include "core/mesh/construction/mirror.h"
#include "core/mesh/construction/remesh.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/mesh_quality.h"
#include "core/model/alignment/procrustes.h"
#include "core/placement/similarity_fit.h"

namespace homolog {

namespace {

constexpr int coarse_vertices = 800;  ///< enough to tell left from right

/// The subjects by size, equal ones by their points: an order that no list of files decides.
std::vector<std::size_t> by_size(const std::vector<const Boundary*>& subjects) {
  std::vector<double> areas;
  for (const Boundary* subject : subjects) areas.push_back(surface_area_mm2(subject->surface));
  std::vector<std::size_t> order(subjects.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (areas[a] != areas[b]) return areas[a] < areas[b];
    const Points &p = subjects[a]->surface.points, &q = subjects[b]->surface.points;
    return std::lexicographical_compare(p.data(), p.data() + p.size(), q.data(), q.data() + q.size());
  });
  return order;
}

Result<std::shared_ptr<const Template>> template_of(const Mesh& mesh) {
  return make_template({mesh.points, mesh.topology->triangles()}, "consensus");
}

/// The mean of fits (3n×M), centred on 0, upright as the fits are on average.
Points mean_of(const ShapeMatrix& fits) {
  Points upright = Points::Zero(fits.rows() / 3, 3);
  for (Eigen::Index k = 0; k < fits.cols(); ++k) {
    const Points fit = points_of(fits, k);
    upright += (fit.rowwise() - fit.colwise().mean()) / static_cast<double>(fits.cols());
  }
  ShapeMatrix aligned = fits;
  align(aligned, Alignment::similarity);
  const Eigen::VectorXd mean = aligned.rowwise().mean();
  const Points points = points_of(mean);
  const Similarity turn{nearest_similarity(points, upright, {}).rotation, 1, Vec3::Zero()};
  return turn.apply(points);
}

/// Those among `fitted` that are likely of another organ. `doubt`: of all; `fits`: of those fitted, in their order.
std::vector<std::size_t> unlike_among(const std::vector<std::size_t>& fitted, const std::vector<double>& doubt,
                                      const ShapeMatrix& fits) {
  const auto shapes = shape_shares(fits);
  std::vector<FitSigns> signs;
  for (std::size_t n = 0; n < fitted.size(); ++n) signs.push_back({doubt[fitted[n]], shapes[n]});
  std::vector<std::size_t> unlike;
  for (const std::size_t n : unlike_the_others(signs)) unlike.push_back(fitted[n]);
  return unlike;
}

/// How far points lie from a surface, root mean square, mm.
double apart_mm(const Points& points, const Mesh& surface) {
  const SurfaceSearch search(surface);
  double sum_mm2 = 0;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const double mm = search.nearest(points.row(i)).distance_mm;
    sum_mm2 += mm * mm;
  }
  return std::sqrt(sum_mm2 / static_cast<double>(points.rows()));
}

}  // namespace

Result<MeshTemplate> own_template(const Boundary& subject, int vertices, Progress* progress) {
  return make_mesh_template({subject.surface.points, subject.surface.topology->triangles()}, {.vertices = vertices},
                            progress);
}

std::vector<std::size_t> subjects_by_size(const std::vector<Boundary>& subjects) {
  std::vector<const Boundary*> all;
  for (const Boundary& subject : subjects) all.push_back(&subject);
  return by_size(all);
}

Boundary mirrored_boundary(const Boundary& subject) {
  const MeshFile file = mirrored({subject.surface.points, subject.surface.topology->triangles()});
  Boundary other = subject;
  other.surface = {Topology::make(file.points.rows(), file.triangles).value(), file.points};
  for (ScanBorder& border : other.scan_borders) border.outward.x() *= -1;
  return other;
}

std::vector<std::size_t> mirrored_subjects(const std::vector<const Boundary*>& subjects, const Progress* progress) {
  std::vector<std::size_t> like, unlike;
  if (subjects.size() < 2) return like;
  const auto own = own_template(*subjects[by_size(subjects)[subjects.size() / 2]], coarse_vertices);
  const auto start = own ? template_of(own->mesh) : tl::make_unexpected(own.error());
  if (!start) return like;
  const auto cancelled = [progress] { return progress != nullptr && progress->cancelled(); };
  std::vector<char> mirrored(subjects.size());
  for_each_in_parallel(subjects.size(), [&](std::size_t k) {
    if (cancelled()) return;
    const auto other = other_lie(**start, *subjects[k]);
    mirrored[k] = other && !other->half_turned;
  });
  if (cancelled()) return like;
  for (std::size_t k = 0; k < subjects.size(); ++k) (mirrored[k] ? unlike : like).push_back(k);
  return unlike.size() > like.size() ? like : unlike;
}

Result<Consensus> consensus_template(const std::vector<Boundary>& subjects, const ConsensusOptions& options) {
  if (subjects.size() < 2) return fail("", "one subject alone has no consensus; give at least two");
  std::vector<const Boundary*> all;
  for (const Boundary& subject : subjects) all.push_back(&subject);
  const auto order = by_size(all);
  Consensus consensus;
  consensus.start = options.start.value_or(order[order.size() / 2]);
  std::optional<Progress> making;  // next to no time, but it can be cancelled
  if (options.progress != nullptr) making.emplace(*options.progress, 0);
  if (options.first) {
    consensus.mesh = *options.first;
  } else {
    auto first = own_template(subjects[consensus.start], options.vertices, making ? &*making : nullptr);
    if (!first) return fail(first.error());
    consensus.mesh = std::move(first->mesh);
    consensus.warnings = std::move(first->warnings);
  }
  bool rough = true;  // until that rests: what the start has of its own is gone by then
  while (!consensus.rests && consensus.rounds < options.most_rounds) {
    const auto the_template = template_of(consensus.mesh);
    if (!the_template) return fail(the_template.error());
    std::vector<std::optional<Points>> fits(order.size());
    std::vector<double> doubt(order.size());  // 0 where it looks mirrored, which is another matter
    const double share = 1.0 / options.most_rounds / static_cast<double>(order.size());
    for_each_in_parallel(order.size(), [&](std::size_t k) {
      FitOptions fitting;
      fitting.rough = rough;
      std::optional<Progress> own;
      if (options.progress != nullptr) fitting.progress = &own.emplace(*options.progress, share);
      if (auto fit = fit_to_boundary(**the_template, subjects[order[k]], fitting)) {
        doubt[k] = fit->mirrored || rough ? 0 : share_of_doubt(*fit);
        fits[k] = std::move(fit->mesh.points);
      }
      if (own) own->report(1);
    });
    if (options.progress != nullptr && options.progress->cancelled())
      return fail("", "the making of the template was cancelled");
    consensus.left_out.clear();
    consensus.doubtful.clear();
    std::vector<std::size_t> fitted;
    for (std::size_t k = 0; k < fits.size(); ++k)
      if (fits[k])
        fitted.push_back(k);
      else
        consensus.left_out.push_back(order[k]);
    const ShapeMatrix shapes = as_columns(fits, consensus.mesh.points.rows());
    if (shapes.cols() < 2) return fail("", "fewer than two subjects could be fitted; check that they are one organ");
    for (const std::size_t k : unlike_among(fitted, doubt, shapes)) consensus.doubtful.push_back(order[k]);
    const Points mean = mean_of(shapes);
    consensus.moved_mm =
        apart_mm(mean, {consensus.mesh.topology, aligned_to(consensus.mesh.points, mean, Alignment::similarity)});
    consensus.mesh.points = mean;
    const double area_mm2 = surface_area_mm2(consensus.mesh);
    ++consensus.rounds;
    const bool rests = consensus.moved_mm < std::max(options.rests_share * std::sqrt(area_mm2),
                                                     options.rests_edges * spread_edge_mm(area_mm2, options.vertices));
    consensus.rests = rests && !rough;
    rough = rough && !rests && consensus.rounds < options.most_rounds / 2;
    consensus.mesh = spread_over(consensus.mesh, options.vertices);
  }
  return consensus;
}

}  // namespace homolog
