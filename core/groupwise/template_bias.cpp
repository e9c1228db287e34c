#include "core/groupwise/template_bias.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/adapt/fit.h"
#include "core/adapt/judge_fit.h"
#include "core/base/numbers/statistics.h"
#include "core/base/processes/parallel.h"
#include "core/groupwise/other_organs.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/model/alignment/procrustes.h"

namespace homolog {

namespace {

constexpr Eigen::Index stand_in_places = 40;

/// The result of one start: its template's faces, and the fit to each subject (3n×M).
struct Start {
  std::shared_ptr<const Topology> topology;
  ShapeMatrix fits;
  std::vector<double> doubt;  ///< share_of_doubt of each subject's fit; 0 where it looks mirrored
};

std::vector<Landmark> places_of(const BiasSubject& subject) {
  if (!subject.landmarks.empty()) return subject.landmarks;
  std::vector<Landmark> places;
  const Points& points = subject.boundary.surface.points;
  for (Eigen::Index k = 0; k < stand_in_places; ++k)
    places.push_back({"", points.row(k * points.rows() / stand_in_places).transpose()});
  return places;
}

/// `warnings`: takes those of the start's own template.
Result<std::shared_ptr<const Template>> template_from(std::size_t start, const std::vector<Boundary>& boundaries,
                                                      const BiasOptions& options, Progress* progress,
                                                      std::vector<std::string>& warnings) {
  Mesh mesh;
  if (options.consensus) {
    ConsensusOptions making{.vertices = options.vertices, .start = start, .progress = progress};
    auto consensus = consensus_template(boundaries, making);
    if (!consensus) return fail(consensus.error());
    warnings = std::move(consensus->warnings);
    mesh = std::move(consensus->mesh);
  } else {
    auto own = own_template(boundaries[start], options.vertices, progress);
    if (!own) return fail(own.error());
    warnings = std::move(own->warnings);
    mesh = std::move(own->mesh);
  }
  return make_template({mesh.points, mesh.topology->triangles()}, "start");
}

/// Empty where the template could not be made or fitted.
std::optional<Start> run_start(std::size_t start, const std::vector<Boundary>& boundaries, const BiasOptions& options,
                               std::vector<std::string>& warnings) {
  const double share = 1.0 / static_cast<double>(boundaries.size());
  std::optional<Progress> own;
  if (options.progress != nullptr) own.emplace(*options.progress, options.consensus ? 0.85 * share : 0);
  const auto the_template = template_from(start, boundaries, options, own ? &*own : nullptr, warnings);
  if (!the_template) return std::nullopt;
  Start run{(*the_template)->topology, ShapeMatrix((*the_template)->points.size(), std::ssize(boundaries)),
            std::vector<double>(boundaries.size())};
  std::vector<char> fitted(boundaries.size());
  for_each_in_parallel(boundaries.size(), [&](std::size_t k) {
    std::optional<Progress> of_fit;
    FitOptions fitting;
    if (options.progress != nullptr)
      fitting.progress = &of_fit.emplace(*options.progress, (options.consensus ? 0.15 : 1) * share * share);
    const auto fit = fit_to_boundary(**the_template, boundaries[k], fitting);
    if (of_fit) of_fit->report(1);
    fitted[k] = fit.has_value();
    if (!fit) return;
    run.fits.col(static_cast<Eigen::Index>(k)) = fit->mesh.points.reshaped<Eigen::RowMajor>();
    run.doubt[k] = fit->mirrored ? 0 : share_of_doubt(*fit);
  });
  if (std::find(fitted.begin(), fitted.end(), 0) != fitted.end()) return std::nullopt;
  return run;
}

/// M×M, of the aligned and centred shapes.
Eigen::MatrixXd products_of(ShapeMatrix shapes) {
  align(shapes, Alignment::similarity);
  const Eigen::VectorXd mean = shapes.rowwise().mean();
  shapes.colwise() -= mean;
  return shapes.transpose() * shapes;
}

/// The place on a subject of a place of the template.
Eigen::RowVector3d place_of(const Start& start, Eigen::Index subject, const SurfacePoint& at) {
  const auto corners = start.topology->triangles().row(at.face);
  Eigen::RowVector3d place = Eigen::RowVector3d::Zero();
  for (int c = 0; c < 3; ++c) place += at.weights[c] * start.fits.col(subject).segment<3>(3 * corners[c]).transpose();
  return place;
}

/// How far the answers of the starts lie apart, where the places of one subject lie on all others.
struct Spreads {
  std::vector<std::vector<double>> by_place;  ///< one spread of each place for each other subject, mm
  std::vector<double> of_start;               ///< mean distance of each start's answers to the starts' mean, mm
};

Spreads spreads_of(const std::vector<Landmark>& places, std::size_t from, const std::vector<Start>& starts) {
  const Eigen::Index subjects = starts.front().fits.cols();
  std::vector<std::vector<SurfacePoint>> at(starts.size());
  for (std::size_t s = 0; s < starts.size(); ++s) {
    const SurfaceSearch search({starts[s].topology, points_of(starts[s].fits, static_cast<Eigen::Index>(from))});
    for (const Landmark& place : places) at[s].push_back(search.nearest(place.position).at);
  }
  Spreads spreads{std::vector<std::vector<double>>(places.size()), std::vector<double>(starts.size())};
  const double answers_of_start = static_cast<double>(places.size()) * static_cast<double>(subjects - 1);
  for (std::size_t k = 0; k < places.size(); ++k)
    for (Eigen::Index to = 0; to < subjects; ++to) {
      if (to == static_cast<Eigen::Index>(from)) continue;
      Points answers(std::ssize(starts), 3);
      for (std::size_t s = 0; s < starts.size(); ++s)
        answers.row(static_cast<Eigen::Index>(s)) = place_of(starts[s], to, at[s][k]);
      const Eigen::RowVector3d mean = answers.colwise().mean();
      const Eigen::VectorXd apart_mm = (answers.rowwise() - mean).rowwise().norm();
      spreads.by_place[k].push_back(std::sqrt(apart_mm.squaredNorm() / static_cast<double>(apart_mm.size())));
      for (std::size_t s = 0; s < starts.size(); ++s)
        spreads.of_start[s] += apart_mm[static_cast<Eigen::Index>(s)] / answers_of_start;
    }
  return spreads;
}

}  // namespace

double modified_rv(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  Eigen::MatrixXd p = a, q = b;
  p.diagonal().setZero();
  q.diagonal().setZero();
  const double size = p.norm() * q.norm();
  return size > 0 ? p.cwiseProduct(q).sum() / size : 0;
}

Result<TemplateBias> template_bias(const std::vector<BiasSubject>& subjects, const BiasOptions& options) {
  if (subjects.size() < 3) return fail("", "the study needs at least three subjects");
  std::vector<Boundary> boundaries;
  for (const BiasSubject& subject : subjects) boundaries.push_back(subject.boundary);
  std::vector<std::optional<Start>> runs(subjects.size());
  std::vector<std::vector<std::string>> warnings(subjects.size());
  for_each_in_parallel(subjects.size(), [&](std::size_t s) {
    if (options.progress == nullptr || !options.progress->cancelled())
      runs[s] = run_start(s, boundaries, options, warnings[s]);
  });
  if (options.progress != nullptr && options.progress->cancelled()) return fail("", "the study was cancelled");
  TemplateBias bias;
  std::vector<Start> starts;
  std::vector<std::string> names;  // the starts' names
  for (std::size_t s = 0; s < runs.size(); ++s) {
    for (const std::string& warning : warnings[s])
      bias.warnings.push_back(subjects[s].name + ", as a template: " + warning);
    if (runs[s]) {
      starts.push_back(std::move(*runs[s]));
      names.push_back(subjects[s].name);
    } else {
      bias.failed.push_back(subjects[s].name);
    }
  }
  if (starts.size() < 2) return fail("", "fewer than two subjects gave templates that fit all others; check them");

  std::vector<std::vector<double>> shapes;  // the shape of each start
  for (const Start& start : starts) shapes.push_back(shape_shares(start.fits));
  std::vector<FitSigns> signs;  // the medians over the starts
  for (std::size_t k = 0; k < subjects.size(); ++k) {
    std::vector<double> doubts, distances;
    for (std::size_t s = 0; s < starts.size(); ++s) {
      doubts.push_back(starts[s].doubt[k]);
      distances.push_back(shapes[s][k]);
    }
    signs.push_back({quantile(doubts, 0.5), quantile(distances, 0.5)});
  }
  for (const std::size_t k : unlike_the_others(signs)) bias.doubtful.push_back(subjects[k].name);
  std::vector<double> all;
  std::map<std::string, std::vector<double>> by_name;
  std::vector<Spreads> spreads(subjects.size());
  for_each_in_parallel(subjects.size(),
                       [&](std::size_t from) { spreads[from] = spreads_of(places_of(subjects[from]), from, starts); });
  for (std::size_t from = 0; from < subjects.size(); ++from) {
    const auto places = places_of(subjects[from]);
    for (std::size_t k = 0; k < places.size(); ++k)
      for (const double spread : spreads[from].by_place[k]) {
        all.push_back(spread);
        if (!places[k].name.empty()) by_name[places[k].name].push_back(spread);
      }
  }
  for (std::size_t s = 0; s < starts.size(); ++s) {
    double apart_mm = 0;
    for (const Spreads& of_subject : spreads) apart_mm += of_subject.of_start[s] / static_cast<double>(spreads.size());
    bias.apart_mm_of[names[s]] = apart_mm;
  }
  bias.best_start =
      std::ranges::min_element(bias.apart_mm_of, {}, [](const auto& start) { return start.second; })->first;
  bias.spread_mm = mean_of(all);
  bias.spread_p95_mm = quantile(all, 0.95);
  bias.spread_max_mm = *std::max_element(all.begin(), all.end());
  for (const auto& [name, values] : by_name) bias.spread_of_mm[name] = mean_of(values);

  std::vector<Eigen::MatrixXd> products;
  for (const Start& start : starts) products.push_back(products_of(start.fits));
  bias.rv_least = 1;
  int pairs = 0;
  for (std::size_t a = 0; a < products.size(); ++a)
    for (std::size_t b = a + 1; b < products.size(); ++b, ++pairs) {
      const double rv = modified_rv(products[a], products[b]);
      bias.rv += rv;
      bias.rv_least = std::min(bias.rv_least, rv);
    }
  bias.rv /= pairs;
  return bias;
}

}  // namespace homolog
