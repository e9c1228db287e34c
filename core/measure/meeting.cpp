#include "core/measure/meeting.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/mesh_io.h"

namespace homolog {

namespace {

/// Factors between lengths in other units; metres are the most frequent.
constexpr std::array unit_factors{1e3, 1e-3, 10.0, 0.1, 100.0, 0.01, 1e6, 1e-6};
constexpr double least_apart = 50;  ///< times: no two organs of one kind differ so much
constexpr double close_share = 0.02, near_share = 0.05, clearly = 0.25;
constexpr double least_organ_mm = 2, largest_organ_mm = 3000;

double size_of_box(const Box& box) {
  return box.isEmpty() ? 0 : box.diagonal().norm();
}

/// The mean distance of two surfaces, one of which is moved, by a sample of their vertices.
class Apart {
 public:
  Apart(const Mesh& a, const Mesh& b) : a_(a), b_(b), near_a_(a), near_b_(b) {}

  double mm(const Misfit& by) const {
    const Vec3 there = by.factor * turn(by);
    return (mean_mm(a_.points, there, near_b_) + by.factor * mean_mm(b_.points, there.cwiseInverse(), near_a_)) / 2;
  }

 private:
  static Vec3 turn(const Misfit& by) { return by.half_turn ? Vec3(-1, -1, 1) : Vec3(1, 1, 1); }
  static double mean_mm(const Points& points, const Vec3& times, const SurfaceSearch& surface) {
    constexpr Eigen::Index enough = 200;
    const Eigen::Index step = std::max<Eigen::Index>(1, points.rows() / enough);
    double sum = 0;
    int count = 0;
    for (Eigen::Index i = 0; i < points.rows(); i += step, ++count)
      sum += surface.nearest(Vec3(points.row(i)).cwiseProduct(times)).distance_mm;
    return sum / count;
  }

  const Mesh &a_, &b_;
  SurfaceSearch near_a_, near_b_;
};

/// The share of a box that lies in another one; a flat one counts too.
double share_within(const Box& box, const Box& other) {
  double share = 1;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double low = std::max(box.min()[k], other.min()[k]), high = std::min(box.max()[k], other.max()[k]);
    const double side = box.sizes()[k];
    share *= high < low ? 0 : side > 0 ? (high - low) / side : 1;
  }
  return share;
}

Box moved(const Box& box, const Misfit& by) {
  const Vec3 times = by.factor * (by.half_turn ? Vec3(-1, -1, 1) : Vec3(1, 1, 1));
  Box there(Vec3(box.min().cwiseProduct(times)));
  there.extend(Vec3(box.max().cwiseProduct(times)));
  return there;
}

/// The unit in which lengths are too small by `factor`, or too large.
const char* unit_of(double factor) {
  const double power = std::round(std::log10(factor));
  return power == 3 ? "metres" : power == 1 ? "centimetres" : power == -3 ? "micrometres" : nullptr;
}

bool is_unit_factor(double factor) {
  return std::any_of(unit_factors.begin(), unit_factors.end(),
                     [&](double unit) { return std::abs(factor / unit - 1) < 1e-6; });
}

std::string plain_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f", value);
  std::string digits = text;
  for (std::ptrdiff_t at = std::ssize(digits) - 3; at > 0; at -= 3) digits.insert(static_cast<std::size_t>(at), ",");
  return digits;
}

}  // namespace

std::optional<Misfit> misfit_in_scan(const Mesh& mesh, const Mesh& other) {
  const double size = size_of_box(bounds_of(mesh.points)), there = size_of_box(bounds_of(other.points));
  if (!(size > 0) || !(there > 0) || !std::isfinite(size + there)) return std::nullopt;
  const Apart apart(mesh, other);
  const double as_they_are = apart.mm({});
  if (as_they_are <= close_share * there) return std::nullopt;
  std::optional<Misfit> best;
  double best_mm = std::min(near_share * there, clearly * as_they_are);
  const auto look_at = [&](const Misfit& by) {
    const double ratio = by.factor * size / there;
    if (ratio < 0.6 || ratio > 1.7) return;
    if (const double mm = apart.mm(by); mm < best_mm) {
      best_mm = mm;
      best = by;
    }
  };
  look_at({1, true});
  for (const double factor : unit_factors)
    for (const bool half_turn : {false, true}) look_at({factor, half_turn});
  return best ? best : misfit_of_size(size, there);
}

std::optional<Misfit> misfit_of_size(double size_mm, double other_mm) {
  if (!(size_mm > 0) || !(other_mm > 0) || !std::isfinite(size_mm + other_mm)) return std::nullopt;
  const double factor = other_mm / size_mm;
  if (std::max(factor, 1 / factor) < least_apart) return std::nullopt;
  for (const double unit : unit_factors)
    if (std::abs(std::log10(factor / unit)) < 0.35) return Misfit{unit, false};
  return Misfit{factor, false};
}

std::optional<Misfit> misfit_in_image(const Box& box, const VolumeGeometry& grid) {
  const Box image = grid.bounds_mm();
  const double size = size_of_box(box), there = size_of_box(image), voxel = grid.spacing_mm.minCoeff();
  if (!(size > 0) || !(there > 0) || !std::isfinite(size + there)) return std::nullopt;
  const bool too_small = size<2 * voxel, too_large = size> 20 * there;
  const auto fits = [&](double factor) {
    return (factor > 1 ? !too_large : !too_small) && factor * size >= 5 * voxel && factor * size <= 1.2 * there;
  };
  if (!too_small && !too_large) {
    if (share_within(box, image) >= 0.1) return std::nullopt;
    if (share_within(moved(box, {1, true}), image) > 0.25) return Misfit{1, true};
  }
  for (const bool half_turn : {false, true})
    for (const double factor : unit_factors)
      if (fits(factor) && share_within(moved(box, {factor, half_turn}), image) > 0.9) return Misfit{factor, half_turn};
  if (!too_small && !too_large) return std::nullopt;
  for (const double factor : unit_factors)
    if (fits(factor)) return Misfit{factor, false};
  return std::nullopt;
}

std::string misfit_sentence(const Misfit& misfit, const Meeting& mesh, const Meeting& other) {
  if (misfit.factor == 1)
    return mesh.name + ": would lie in " + other.name +
           " if its coordinates were RAS; if they are, turn it by convert --from-ras";
  // Whose size is no organ's?
  double factor = misfit.factor;
  const Meeting *wrong = &mesh, *right = &other;
  const auto possible = [](double mm) { return mm >= least_organ_mm && mm <= largest_organ_mm; };
  if (possible(mesh.size_mm) && !possible(other.size_mm)) {
    std::swap(wrong, right);
    factor = 1 / factor;
  }
  const bool known = is_unit_factor(factor);
  std::string text = wrong->name + ": is " + (known ? "" : "about ") + plain_number(std::max(factor, 1 / factor)) +
                     " times " + (factor > 1 ? "smaller" : "larger") + " than " + right->name;
  const char* unit = known ? unit_of(factor) : nullptr;
  text += unit != nullptr ? std::string("; are its lengths in ") + unit + "?"
                          : "; are its lengths in another unit than mm?";
  const std::string turn = misfit.half_turn ? " and its coordinates RAS" : "";
  if (is_mesh_name(wrong->name) && known) {
    char number[32];
    std::snprintf(number, sizeof number, "%g", factor);
    return text + " If they are" + turn + ", convert it by convert --times " + number +
           (misfit.half_turn ? " --from-ras" : "");
  }
  return text + " If they are, give it in mm, or correct the voxel size in its header";
}

std::vector<std::string> misfits_among(const std::vector<Meeting>& all, const std::string& kind) {
  std::vector<std::string> sentences;
  std::vector<double> sizes;
  for (const Meeting& one : all)
    if (one.size_mm > 0) sizes.push_back(one.size_mm);
  if (sizes.size() < 2) return sentences;
  // The usual size: of two, the one that an organ may have; of more, what most have.
  std::sort(sizes.begin(), sizes.end());
  const Meeting usual{kind, sizes.size() == 2 && sizes[0] < least_organ_mm ? sizes[1] : sizes[(sizes.size() - 1) / 2]};
  for (const Meeting& one : all)
    if (const auto misfit = misfit_of_size(one.size_mm, usual.size_mm))
      sentences.push_back(misfit_sentence(*misfit, one, usual));
  return sentences;
}

}  // namespace homolog
