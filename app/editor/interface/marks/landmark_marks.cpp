#include "app/editor/interface/marks/landmark_marks.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "app/editor/state/views.h"
#include "app/editor/update/tools/tool.h"
#include "app/editor/widgets/widgets.h"
#include "core/case/held_landmarks.h"

namespace homolog {

namespace {

/// Names beside their points, each at the first side that has room in the view and where it covers no other and none of
/// the letters; none where all sides are taken.
class NameTags {
 public:
  NameTags(const Theme& theme, const RectPx& view, ImDrawList& draw) : theme_(theme), draw_(draw), view_(view) {}
  /// Keeps names off a text.
  void block(const Letters& letters) {
    taken_.push_back({letters.at, {letters.at.x + letters.size.x, letters.at.y + letters.size.y}});
  }
  /// Keeps names off a point.
  void block(ImVec2 at) {
    const float reach = theme_.px(5);
    taken_.push_back({{at.x - reach, at.y - reach}, {at.x + reach, at.y + reach}});
  }
  void put(ImVec2 at, const std::string& name, float alpha) {
    const ImVec2 size = text_size(theme_.small, name);
    const float aside = theme_.px(9), middle = size.y / 2;
    // Above and below a name may stand off its point's middle, where the view ends.
    // Clear of the frame of the view: beside it an "l" is read as a part of it.
    const float edge = theme_.px(6);
    const auto low = static_cast<float>(view_.x) + edge;
    const float high = static_cast<float>(view_.x + view_.width) - edge - size.x;
    const float x = std::max(low, std::min(at.x - size.x / 2, high));
    for (const ImVec2 corner : {ImVec2{at.x + aside, at.y - middle}, ImVec2{at.x - aside - size.x, at.y - middle},
                                ImVec2{x, at.y - aside - size.y}, ImVec2{x, at.y + aside}}) {
      const Rect tag{corner, {corner.x + size.x, corner.y + size.y}};
      const bool beyond =
          corner.x < low || corner.x > high || corner.y < view_.y || corner.y + size.y > view_.y + view_.height;
      if (beyond) continue;
      if (std::any_of(taken_.begin(), taken_.end(), [&](const Rect& other) { return tag.meets(other); })) continue;
      taken_.push_back(tag);
      // Its point tells how far away it is; the name has to be read, over white bone too.
      constexpr float least_alpha = 0.7f;
      shadowed_text(draw_, theme_.small, corner, with_alpha(palette::mark, std::max(alpha, least_alpha)), name);
      return;
    }
  }

 private:
  struct Rect {
    ImVec2 low, high;
    bool meets(const Rect& o) const {
      return low.x < o.high.x && o.low.x < high.x && low.y < o.high.y && o.low.y < high.y;
    }
  };
  const Theme& theme_;
  ImDrawList& draw_;
  RectPx view_;
  std::vector<Rect> taken_;
};

/// How clearly a landmark is shown: fading with its distance from a slice, faint behind the planes of the 3D view.
float landmark_alpha(const UiContext& ui, const ViewMap& map, const Vec3& p_mm, const Eigen::Vector2d& px) {
  const VolumeGeometry geometry = geometry_of(ui.document());
  if (!map.is_slice()) {
    constexpr float behind = 0.25f;
    return hidden_by_planes(shown_planes(ui.state, ui.document()), geometry, map.ray(px.x(), px.y()), p_mm) ? behind
                                                                                                            : 1;
  }
  const double reach_mm = 4 * slice_step_mm(geometry, map.into_screen());
  const double off_mm = std::abs(map.into_screen().dot(p_mm - map.slice().centre));
  return off_mm > reach_mm ? 0.0f : static_cast<float>(1 - 0.7 * off_mm / reach_mm);
}

/// A landmark in one view: where it was placed, and where the mesh has it.
struct ShownLandmark {
  std::string name;
  std::optional<ImVec2> placed, carried;  ///< in px; none where that is not in the view
  float alpha = 1, carried_alpha = 1;
  bool met = false, held = false, lit = false;
};

/// Whether a landmark lies on the far side of the mesh, as the 3D view looks at it.
bool faces_away(const UiContext& ui, std::size_t landmark, const Points& points) {
  const Template& the_template = *ui.structure()->the_template;
  const auto t = the_template.topology->triangles().row(the_template.landmark_points[landmark].face);
  const Vec3 a = points.row(t[0]), b = points.row(t[1]), c = points.row(t[2]);
  return (b - a).cross(c - a).dot(ui.state.look.camera.to_eye) < 0;
}

std::vector<ShownLandmark> shown_landmarks(const UiContext& ui, const ViewMap& map) {
  constexpr float behind = 0.25f;
  const Template& the_template = *ui.structure()->the_template;
  const Shape& shape = ui.shown().shape;
  std::vector<ShownLandmark> all;
  for (std::size_t l = 0; l < the_template.landmarks.size(); ++l) {
    const LandmarkHold hold = landmark_hold(the_template, l, shape);
    ShownLandmark one{the_template.landmarks[l].name};
    one.met = hold.met;
    one.held = hold.held;
    one.lit = hold.placed && ui.state.pointer.hover && ui.state.pointer.hover->landmark == one.name;
    const float side = !map.is_slice() && faces_away(ui, l, *shape.points) ? behind : 1;
    const auto look_at = [&](const Vec3& p_mm, std::optional<ImVec2>& at, float& alpha) {
      const auto px = map.to_px(p_mm);
      if (!px) return;
      alpha = side * landmark_alpha(ui, map, p_mm, *px);
      if (alpha > 0) at = on_screen(*px);
    };
    if (hold.placed) look_at(shape.landmarks.at(one.name), one.placed, one.alpha);
    if (!hold.met) look_at(carried_landmark(the_template, l, *shape.points), one.carried, one.carried_alpha);
    if (one.placed || one.carried) all.push_back(std::move(one));
  }
  for (const auto& [name, p_mm] : shape.landmarks) {  // of a template that named more
    const auto is_it = [&called = name](const Landmark& landmark) { return landmark.name == called; };
    if (std::any_of(the_template.landmarks.begin(), the_template.landmarks.end(), is_it)) continue;
    const auto px = map.to_px(p_mm);
    const float alpha = px ? landmark_alpha(ui, map, p_mm, *px) : 0;
    if (alpha > 0) all.push_back({name, on_screen(*px), std::nullopt, alpha});
  }
  return all;
}

}  // namespace

std::array<Letters, 4> letters_of(const UiContext& ui, const ViewMap& map) {
  const RectPx& rect = map.rect();
  ImFont* font = ui.theme.strong;
  const float inset = ui.theme.px(8);
  const Vec3 right = map.right();
  const Vec3 down = map.is_slice() ? map.slice().down : Vec3(-ui.state.look.camera.up);
  const auto put = [&](const Vec3& direction, float share_x, float share_y) {
    const std::string letters = direction_letters(direction);
    const ImVec2 size = text_size(font, letters);
    const ImVec2 at{std::round(rect.x + inset + (rect.width - 2 * inset - size.x) * share_x),
                    std::round(rect.y + inset + (rect.height - 2 * inset - size.y) * share_y)};
    return Letters{letters, at, size};
  };
  return {put(-right, 0, 0.5f), put(right, 1, 0.5f), put(-down, 0.5f, 0), put(down, 0.5f, 1)};
}

void draw_landmarks(const UiContext& ui, const ViewMap& map, ImDrawList& draw) {
  if (ui.making_shown()) return;
  auto shown = shown_landmarks(ui, map);
  NameTags tags(ui.theme, map.rect(), draw);
  if (ui.state.preferences.show.letters)
    for (const Letters& one : letters_of(ui, map)) tags.block(one);
  for (const ShownLandmark& one : shown) {
    if (one.placed) tags.block(*one.placed);
    if (one.carried) tags.block(*one.carried);
  }
  // What is pointed at is named first, then what was placed, then what is nearest.
  std::stable_sort(shown.begin(), shown.end(), [](const ShownLandmark& a, const ShownLandmark& b) {
    if (a.lit != b.lit) return a.lit;
    if (a.placed.has_value() != b.placed.has_value()) return a.placed.has_value();
    return a.alpha > b.alpha;
  });
  const bool named = kind_of(ui.state.hand.tool).names_landmarks;
  constexpr float faint = 0.3f;
  for (const ShownLandmark& one : shown) {
    if (one.carried) {
      const float alpha = 0.8f * one.carried_alpha;
      if (one.placed)
        draw.AddLine(*one.carried, *one.placed, with_alpha(palette::amber, std::min(alpha, one.alpha)),
                     1.5f * ui.theme.scale);
      draw.AddCircle(*one.carried, ui.theme.px(4), with_alpha(palette::mark, alpha), 0, ui.theme.px(1.5f));
      if (!one.placed && named && alpha > faint) tags.put(*one.carried, one.name, alpha);
    }
    if (!one.placed) continue;
    const float radius = ui.theme.px(one.lit ? 5 : 4);
    draw.AddCircleFilled(*one.placed, radius, with_alpha(palette::accent, one.alpha));
    if (!one.held) draw.AddCircleFilled(*one.placed, radius / 2, with_alpha(palette::window, one.alpha));
    draw.AddCircle(*one.placed, radius + ui.theme.px(1), with_alpha(IM_COL32_BLACK, 0.6f * one.alpha));
    if (one.alpha > faint || one.lit) tags.put(*one.placed, one.name, one.alpha);
  }
}

}  // namespace homolog
