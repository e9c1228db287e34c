#include "core/case/edit_words.h"

#include <array>
#include <cstdio>
#include <limits>
#include <numbers>

#include "core/deform/stroke_kinds.h"
#include "core/template/template.h"

namespace homolog {

namespace {

std::string in_mm(double length_mm) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), length_mm < 10 ? " %.1f mm" : " %.0f mm", length_mm);
  return text.data();
}

/// ", near lower pole" where a landmark of the template is near, else the side of the mesh: ", left". Goes by the
/// placed template, which edits of the mesh do not move.
std::string place_words(const ShapeView& before, const Vec3& at) {
  const Points& placed = *before.shape.placed;
  const Box box = bounds_of(placed);
  constexpr double near_share = 0.12;
  double nearest_mm = near_share * box.diagonal().norm();
  std::string name;
  const auto& landmarks = before.the_template().landmarks;
  for (std::size_t l = 0; l < landmarks.size(); ++l) {
    const double away_mm = (carried_landmark(before.the_template(), l, placed) - at).norm();
    if (away_mm >= nearest_mm) continue;
    nearest_mm = away_mm;
    name = landmarks[l].name;
  }
  if (!name.empty()) return ", near " + name;
  static constexpr std::array<std::array<const char*, 2>, 3> sides{
      {{"right", "left"}, {"anterior", "posterior"}, {"inferior", "superior"}}};
  constexpr double least_mm = 1e-9;
  const Vec3 share = (at - box.center()).cwiseQuotient(box.sizes().cwiseMax(least_mm));
  Eigen::Index axis = 0;
  share.cwiseAbs().maxCoeff(&axis);
  return std::string(", ") + sides[axis][share[axis] > 0 ? 1 : 0];
}

/// How far a placement moves, turns or scales the mesh, whichever it does.
std::string change_words(const Similarity& from, const Similarity& to, const Vec3& centre_mm) {
  const Similarity change = to.after(from.inverse());
  const Vec3 moved = change.scale * (change.rotation * centre_mm) + change.translation - centre_mm;
  constexpr double least_mm = 0.05, least_deg = 0.05, least_share = 5e-4;
  if (moved.norm() >= least_mm) return in_mm(moved.norm());
  const double turned_deg = from.rotation.angularDistance(to.rotation) * 180 / std::numbers::pi;
  std::array<char, 32> text{};
  if (turned_deg >= least_deg)
    std::snprintf(text.data(), text.size(), " %.0f\xc2\xb0", turned_deg);
  else if (std::abs(change.scale - 1) >= least_share)
    std::snprintf(text.data(), text.size(), " \xc3\x97 %.2f", change.scale);
  return text.data();
}

}  // namespace

std::string edit_words(const Action& action, const std::optional<ShapeView>& shown) {
  std::string words = action_name(action);
  if (!shown) return words;
  const ShapeView& before = *shown;
  if (const auto* stroke = std::get_if<Stroke>(&action)) {
    if (!kind_of_stroke(stroke->tool).is_dab()) words += in_mm((stroke->to - stroke->at).norm());
    return words + place_words(before, stroke->at);
  }
  if (const auto* placed = std::get_if<SetPlacement>(&action))
    return words + change_words(before.shape.placement, placed->placement, bounds_of(*before.shape.points).center());
  const auto brush = [&](const auto& dab) {
    const bool whole = dab.radius_mm > bounds_of(*before.shape.points).diagonal().norm() / 2;
    return whole ? words : words + in_mm(dab.radius_mm) + place_words(before, dab.at);
  };
  if (const auto* confirm = std::get_if<Confirm>(&action)) return brush(*confirm);
  if (const auto* paint = std::get_if<PaintStiffness>(&action)) return brush(*paint);
  if (const auto* smooth = std::get_if<SmoothStiffness>(&action)) return brush(*smooth);
  if (const auto* region = std::get_if<PaintRegion>(&action)) return brush(*region);
  if (const auto* fill = std::get_if<FillRegion>(&action)) return words + place_words(before, fill->at);
  return words;
}

}  // namespace homolog
