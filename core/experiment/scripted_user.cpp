#include "core/experiment/scripted_user.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "core/adapt/boundary/find_placement.h"
#include "core/base/numbers/random.h"
#include "core/deform/sigma_presets.h"
#include "core/mesh/mesh_quality.h"
#include "core/solve/shape_solver.h"

namespace homolog {

namespace {

/// The width that the solve adds to a σ, about, as a share of the stiffness length: enough to choose a place by.
constexpr double widening_share = 0.8;
constexpr std::size_t most_places = 60, most_tries = 24, most_compared = 4;
constexpr double farthest_drag = 3;  // times the deviation, where the surface lags behind the cursor
constexpr double helps = 0.998;      // share of the mean square deviation: less is not seen

constexpr double turn_deviation = 3 * std::numbers::pi / 180, shift_fraction = 0.015, size_deviation = 0.015;
constexpr int feature_rounds = 3;
constexpr double hold_fraction = 0.05;

double widening_mm(const Document& document) {
  if (document.scheme == Scheme::raw) return 0;
  const double edge_mm = mean_edge_mm(*document.structure()->the_template->topology, *document.view()->shape.points);
  return widening_share *
         stiffness_length_mm(document.structure()->paint.base * document.structure()->paint.stiffness->mean(), edge_mm);
}

double diagonal_mm(const EditSession& session) {
  return bounds_of(*session.document().view()->shape.placed).diagonal().norm();
}

/// The part of a deviation that slices of the three views show: the in-plane one. The plane is the one that shows
/// most of it, so the component along the smallest axis stays out of sight.
Vec3 in_slice(const Deviation& deviation) {
  Vec3 d = deviation.to - deviation.from;
  Eigen::Index across = 0;
  d.cwiseAbs().minCoeff(&across);
  d[across] = 0;
  return d;
}

/// A deviation along the mesh's normal.
struct Offset {
  Vec3 normal = Vec3::Zero();
  double signed_mm = 0;
};

std::vector<Offset> offsets_of(const Mesh& mesh, const std::vector<Deviation>& seen) {
  const Points normals = vertex_normals(mesh);
  std::vector<Offset> offsets;
  offsets.reserve(seen.size());
  for (const Deviation& d : seen) {
    const Vec3 normal = normals.row(d.vertex);
    offsets.push_back({normal, std::copysign(d.distance_mm, normal.dot(d.to - d.from))});
  }
  return offsets;
}

/// The multiple of a movement that fits all offsets best in the least-squares sense, and by how much the sum of their
/// squares falls then.
struct BestFit {
  double times = 0, gain_mm2 = 0;
};
/// `moved(k)`: how far offset k's place goes along its normal.
template <class Moved>
BestFit best_fit(const std::vector<Offset>& offsets, const Moved& moved) {
  double off = 0, square = 1e-12;
  for (std::size_t k = 0; k < offsets.size(); ++k) {
    const double m = moved(k);
    off += m * offsets[k].signed_mm;
    square += m * m;
  }
  return {off / square, off * off / square};
}

/// A place to pull, with the σ that fits it.
struct Choice {
  const Deviation* deviation = nullptr;
  double sigma_mm = 0, gain_mm2 = 0;
};

/// Visible deviations at least `apart_mm` from each other, the largest first.
std::vector<const Deviation*> distinct_places(const std::vector<Deviation>& seen, double visible_mm, double apart_mm) {
  std::vector<const Deviation*> visible, places;
  for (const Deviation& d : seen)
    if (d.distance_mm >= visible_mm) visible.push_back(&d);
  std::stable_sort(visible.begin(), visible.end(),
                   [](const Deviation* a, const Deviation* b) { return a->distance_mm > b->distance_mm; });
  for (const Deviation* d : visible) {
    if (places.size() == most_places) break;
    const bool near_another = std::any_of(places.begin(), places.end(), [&](const Deviation* other) {
      return (other->from - d->from).norm() < apart_mm;
    });
    if (!near_another) places.push_back(d);
  }
  return places;
}

/// The places and σ to try, most to gain first.
std::vector<Choice> choices(const EditSession& session, const std::vector<Deviation>& seen,
                            const std::vector<Offset>& offsets, double visible_mm) {
  const auto sigmas_mm = default_sigmas_mm(*session.document().view()->shape.reference);
  const double widening2 = std::pow(widening_mm(session.document()), 2);
  std::vector<Choice> found;
  for (const Deviation* place : distinct_places(seen, visible_mm, sigmas_mm.front())) {
    const Vec3 direction = in_slice(*place).normalized();
    for (const double sigma_mm : sigmas_mm) {
      const double reach2 = sigma_mm * sigma_mm + widening2;
      const BestFit fit = best_fit(offsets, [&](std::size_t k) {
        const double d2 = (seen[k].from - place->from).squaredNorm();
        return d2 > 9 * reach2 ? 0 : std::exp(-d2 / (2 * reach2)) * direction.dot(offsets[k].normal);
      });
      if (fit.times > 0) found.push_back({place, sigma_mm, fit.gain_mm2});
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Choice& a, const Choice& b) { return a.gain_mm2 > b.gain_mm2; });
  return found;
}

/// The stroke of a choice, dragged as far as fits; nothing where it cannot be done or fits nowhere.
std::optional<Stroke> fitting_stroke(EditSession& session, const Choice& choice, const std::vector<Deviation>& seen,
                                     const std::vector<Offset>& offsets) {
  Stroke stroke;
  stroke.tool = Tool::pull;
  stroke.at = choice.deviation->from;
  stroke.to = stroke.at + in_slice(*choice.deviation);
  stroke.sigma_mm = choice.sigma_mm;
  const auto shown = session.preview(stroke);
  if (!shown) return std::nullopt;
  const Points moved = *shown->document.view()->shape.points - *session.document().view()->shape.points;
  const BestFit fit =
      best_fit(offsets, [&](std::size_t k) { return moved.row(seen[k].vertex).dot(offsets[k].normal); });
  if (fit.times <= 0) return std::nullopt;
  stroke.to = stroke.at + std::min(fit.times, farthest_drag) * in_slice(*choice.deviation);
  return stroke;
}

/// Tries the first few pulls that help, as a person does who moves the mouse and switches σ before letting go, and
/// makes the best of them.
Result<bool> pull_once(EditSession& session, Sight& sight, const std::vector<Deviation>& seen, double visible_mm) {
  const double enough = mean_square_mm2(seen) * helps;
  const std::vector<Offset> offsets = offsets_of(session.document().view()->mesh(), seen);
  std::size_t tries = 0, compared = 0;
  std::optional<Stroke> best;
  double least = std::numeric_limits<double>::infinity();
  for (const Choice& choice : choices(session, seen, offsets, visible_mm)) {
    if (++tries > most_tries || compared == most_compared) break;
    const auto stroke = fitting_stroke(session, choice, seen, offsets);
    if (!stroke) continue;
    const auto shown = session.preview(*stroke);
    if (!shown) continue;
    const double left = mean_square_mm2(sight.look(*shown->document.view()->shape.points));
    if (left > enough) continue;
    ++compared;
    if (left >= least) continue;
    least = left;
    best = stroke;
  }
  if (!best) return false;
  if (auto done = session.apply(*best); !done) return fail(done.error());
  return true;
}

/// The place of a template's landmark on the mesh as it is.
std::optional<Vec3> on_mesh(const Document& document, const std::string& name) {
  const Template& the_template = *document.structure()->the_template;
  for (std::size_t k = 0; k < the_template.landmarks.size(); ++k)
    if (the_template.landmarks[k].name == name)
      return carried_landmark(the_template, k, *document.view()->shape.points);
  return std::nullopt;
}

}  // namespace

Result<void> place_on(EditSession& session, const Mesh& target) {
  const auto found = find_placement(*session.document().structure()->the_template, mesh_boundary(target));
  auto done = session.apply(SetPlacement{found.placement});
  return done ? Result<void>{} : fail(done.error());
}

Result<void> disturb_placement(EditSession& session, std::uint64_t seed) {
  Random random(seed);
  std::array<double, 7> normal{};
  for (double& number : normal) number = random.normal();
  const Vec3 turn = turn_deviation * Vec3(normal[0], normal[1], normal[2]);
  const Vec3 shift = shift_fraction * diagonal_mm(session) * Vec3(normal[3], normal[4], normal[5]);
  const Vec3 centre = session.document().view()->shape.placed->colwise().mean();
  Similarity off;
  off.rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized());
  off.scale = std::exp(size_deviation * normal[6]);
  off.translation = centre + shift - off.scale * (off.rotation * centre);
  auto done = session.apply(SetPlacement{off.after(session.document().view()->shape.placement)});
  return done ? Result<void>{} : fail(done.error());
}

Result<int> grab_landmarks(EditSession& session, const std::vector<Landmark>& features) {
  int strokes = 0;
  for (int round = 0; round < feature_rounds; ++round) {
    for (const Landmark& feature : features) {
      const auto at = on_mesh(session.document(), feature.name);
      if (!at) continue;
      Stroke stroke;
      stroke.tool = Tool::grab;
      stroke.at = *at;
      stroke.to = feature.position;
      stroke.sigma_mm = default_sigmas_mm(*session.document().view()->shape.reference).back();
      if (auto done = session.apply(stroke); !done) return fail(done.error());
      ++strokes;
    }
  }
  return strokes;
}

Result<int> click_landmarks(EditSession& session, const std::vector<Landmark>& features) {
  for (const Landmark& feature : features)
    if (auto done = session.apply(PlaceLandmark{feature.name, feature.position}); !done) return fail(done.error());
  return static_cast<int>(features.size());
}

Result<void> confirm_landmarks(EditSession& session, const std::vector<Landmark>& features) {
  const double radius_mm = hold_fraction * diagonal_mm(session);
  for (const Landmark& feature : features)
    if (auto done = session.apply(Confirm{feature.position, radius_mm, true}); !done) return fail(done.error());
  return {};
}

Result<PullingResult> pull_to_target(EditSession& session, const Mesh& target, const PullingOptions& options) {
  Sight sight(target, session.document().structure()->the_template->topology);
  PullingResult result;
  std::vector<Deviation> seen = sight.look(*session.document().view()->shape.points);
  while (result.pulls < options.most_pulls) {
    if (options.progress != nullptr) {
      options.progress->report(static_cast<double>(result.pulls) / options.most_pulls);
      if (options.progress->cancelled()) return fail("", "the study was cancelled");
    }
    const auto pulled = pull_once(session, sight, seen, options.visible_mm);
    if (!pulled) return fail(pulled.error());
    if (!*pulled) break;
    ++result.pulls;
    seen = sight.look(*session.document().view()->shape.points);
    if (options.watch) options.watch(result.pulls, seen);
  }
  for (const Deviation& deviation : seen)
    result.largest_deviation_mm = std::max(result.largest_deviation_mm, deviation.distance_mm);
  return result;
}

}  // namespace homolog
