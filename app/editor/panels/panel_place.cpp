#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/editor/panels/sections.h"
#include "app/editor/panels/ui_context.h"
#include "app/editor/state/icons.h"
#include "app/editor/update/controls.h"
#include "app/editor/widgets/widgets.h"
#include "core/case/held_landmarks.h"

namespace homolog {

namespace {

constexpr double degrees_per_radian = 180 / std::numbers::pi;

/// R = Rz · Ry · Rx: the turns about the patient's axes, that about x first.
Vec3 angles_deg(const Eigen::Quaterniond& rotation) {
  const Mat3 r = rotation.toRotationMatrix();
  const Vec3 angles(std::atan2(r(2, 1), r(2, 2)), std::atan2(-r(2, 0), std::hypot(r(2, 1), r(2, 2))),
                    std::atan2(r(1, 0), r(0, 0)));
  return degrees_per_radian * angles.array() + 0.0;  // no negative zero
}
Eigen::Quaterniond from_angles(const Vec3& angles_deg) {
  const Vec3 angles = angles_deg / degrees_per_radian;
  return Eigen::AngleAxisd(angles.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(angles.y(), Vec3::UnitY()) *
         Eigen::AngleAxisd(angles.x(), Vec3::UnitX());
}

/// The placement in numbers. Turning and scaling keep the mesh's centre where it is.
class PlacementNumbers {
 public:
  PlacementNumbers(const UiContext& ui, Outbox& out)
      : ui_(ui),
        out_(out),
        placement_(ui.committed_shape().placement),
        centre_(bounds_of(*ui.committed_shape().points).center()),
        angles_(angles_deg(placement_.rotation)) {}

  void draw() {
    const Theme& theme = ui_.theme;
    static constexpr std::array<const char*, 3> towards{"left", "back", "head"};
    caption(theme, "Centre (L, P, S)");
    row(
        "centre", centre_, 0.1, "mm", {Vec3::Constant(1e5), "The centre"},
        [](int axis) { return std::string("mm towards the patient's ") + towards[axis]; },
        [this](int axis, double value) {
          Similarity change;
          change.translation[axis] = value - centre_[axis];
          return change.after(placement_);
        });
    caption(theme, "Turn about L, P, S");
    // The middle one of three angles goes half as far: beyond, others would be shown for the same turn.
    row(
        "angle", angles_, 0.25, "\xc2\xb0", {Vec3(180, 90, 180), "The angle"},
        [](int) { return "Degrees about the patient's axes, in this order"; },
        [this](int axis, double value) {
          Vec3 angles = angles_;
          angles[axis] = value;
          Similarity change;
          change.rotation = from_angles(angles) * from_angles(angles_).conjugate();
          return about_centre(change);
        });
    CaseNumber scale(ui_, "scale", placement_.scale);
    bool released = false;
    const bool changed =
        slider(theme, "Scale", scale.value, {0.5, 2, "%.3f", "", true}, "1 is the template's own size", released);
    scale.settle(
        changed, released,
        [this](double value) {
          Similarity change;
          change.scale = value / placement_.scale;
          return SetPlacement{about_centre(change)};
        },
        out_);
  }

 private:
  struct Reach {
    Vec3 high;  ///< to both sides of 0
    const char* name;
  };
  template <class Tip, class Placement>
  void row(const char* name, const Vec3& committed, double per_px, const char* unit, const Reach& reach, Tip tip,
           Placement placement_for) {
    const Theme& theme = ui_.theme;
    const float width = std::floor((ImGui::GetContentRegionAvail().x - 2 * theme.px(4)) / 3);
    for (int axis = 0; axis < 3; ++axis) {
      if (axis > 0) ImGui::SameLine(0, theme.px(4));
      const std::string id = format("%s %d", name, axis);
      CaseNumber number(ui_, id, committed[axis]);
      bool released = false;
      const bool changed =
          number_field(theme, id.c_str(), number.value, released,
                       {.per_px = per_px,
                        .unit = unit,
                        .width_px = width,
                        .tip = tip(axis),
                        .limits = {.low = -reach.high[axis], .high = reach.high[axis], .name = reach.name}});
      number.settle(
          changed, released, [&](double value) { return SetPlacement{placement_for(axis, value)}; }, out_);
    }
  }
  Similarity about_centre(Similarity change) const {
    change.translation = centre_ - change.scale * (change.rotation * centre_);
    return change.after(placement_);
  }

  const UiContext& ui_;
  Outbox& out_;
  const Similarity& placement_;
  Vec3 centre_, angles_;
};

/// The buttons of a placed landmark.
void draw_hold(const UiContext& ui, const Landmark& landmark, const Vec3& place, const LandmarkHold& hold,
               Outbox& out) {
  const Theme& theme = ui.theme;
  const bool can_hold = ui.structure()->landmarks.hold && (hold.met || hold.held);
  const std::string refusal =
      can_hold ? "" : format("The mesh is %.1f mm off. Bring it there with Grab or Slide.", hold.distance_mm);
  if (icon_button(theme, hold.held ? icon::confirm : icon::unlocked, hold.held ? "release" : "hold",
                  hold.held ? "Held: strokes leave the mesh here. Click to release it"
                            : "Free: strokes may move the mesh here. Click to hold it",
                  refusal, hold.held, 24))
    out.apply(PlaceLandmark{landmark.name, place, !hold.held});
  ImGui::SameLine(0, 0);
  if (icon_button(theme, icon::crosshair, "go there", "Shows the place of the landmark in all views", {}, false, 24))
    out.send(LookAt{place});
  ImGui::SameLine(0, 0);
  if (icon_button(theme, icon::close, "remove", "Removes this landmark from the image", {}, false, 24))
    out.apply(PlaceLandmark{landmark.name, std::nullopt});
}

/// Why the mesh is not where a landmark was placed, and what helps.
std::string off_tip(const UiContext& ui, double distance_mm) {
  const auto& snapped = ui.state.found.snapped;
  const bool by_snap = snapped && ui.has_shape() && snapped->is_of(*ui.shown().shape.points);
  return by_snap ? format(
                       "The snap moved the mesh here, so that it is %.1f mm from your click: it goes by the image's "
                       "edge, which is mostly more exact. To keep your place, undo the snap, confirm the mesh here "
                       "(C), and snap again",
                       distance_mm)
                 : format(
                       "The mesh is %.1f mm from the place that you clicked. Bring it there with Grab or Slide. "
                       "Confirm it there (C) to keep it when you snap",
                       distance_mm);
}

/// Whether a name is too long to stand beside its distance and its buttons: then every row has a second line for the
/// distance, whether it is there yet or not, so that no row moves.
bool need_two_lines(const Theme& theme, const std::vector<Landmark>& landmarks) {
  const float room = ImGui::GetContentRegionAvail().x - theme.px(72 + 32 + 10) - ImGui::CalcTextSize("88.8 mm off").x;
  return std::any_of(landmarks.begin(), landmarks.end(),
                     [&](const Landmark& one) { return ImGui::CalcTextSize(one.name.c_str()).x > room; });
}

void draw_landmark_list(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const Template& the_template = *ui.structure()->the_template;
  const auto& placed = ui.shown().shape.landmarks;
  const std::string wanted = landmark_in_hand(ui.state, ui.document());
  const bool two_lines = need_two_lines(theme, the_template.landmarks);
  std::vector<std::string> names;
  for (const Landmark& landmark : the_template.landmarks) names.push_back(landmark.name);
  for (std::size_t l = 0; l < the_template.landmarks.size(); ++l) {
    const Landmark& landmark = the_template.landmarks[l];
    const Part part(landmark.name, "landmark");
    const auto place = placed.find(landmark.name);
    const bool done = place != placed.end();
    const bool next = landmark.name == wanted, in_hand = next && ui.state.hand.tool == MouseTool::landmark;
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x, height = theme.px(two_lines ? 40 : 24);
    const float buttons = done ? theme.px(72) : 0.0f;
    const LandmarkHold hold = landmark_hold(the_template, l, ui.shown().shape);
    const std::string off = done && !hold.met ? format("%.1f mm off", hold.distance_mm) : next && !done ? "next" : "";
    const float off_width = off.empty() || two_lines ? 0 : ImGui::CalcTextSize(off.c_str()).x + theme.px(10);
    const std::string shown = shortened_among(landmark.name, names, width - buttons - off_width - theme.px(32));
    std::string tip =
        done ? "To place it again, click here, then click in a slice" : "Click here, then click its place in a slice";
    if (done && !hold.met) tip = off_tip(ui, hold.distance_mm) + ".\n" + tip;
    const auto row = area(theme, "row", {width - buttons, height},
                          shown == landmark.name ? tip : landmark.name + "\n" + tip, {in_hand});
    if (row.clicked) out.send(ChooseLandmark{landmark.name, std::nullopt});
    ImDrawList& draw = *ImGui::GetWindowDrawList();
    if (in_hand || row.hovered)
      draw.AddRectFilled(at, {at.x + width, at.y + height},
                         in_hand ? with_alpha(palette::accent, 0.18f) : palette::raised, theme.px(4));
    const float line_height = two_lines ? height / 2 : height;
    const float text_y = std::floor(at.y + (line_height - ImGui::GetFontSize()) / 2);
    text_at(draw, {at.x + theme.px(6), text_y},
            done   ? (hold.met ? palette::good : palette::dim)
            : next ? palette::accent
                   : palette::faint,
            done   ? icon::check
            : next ? icon::right_angle
                   : icon::outline);
    text_at(draw, {at.x + theme.px(28), text_y}, palette::text, shown);
    const float off_x = two_lines ? theme.px(28) : theme.px(36) + ImGui::CalcTextSize(shown.c_str()).x;
    text_at(draw, {at.x + off_x, two_lines ? text_y + height / 2 : text_y}, done ? palette::dim : palette::accent, off);
    if (!done) continue;
    ImGui::SameLine(0, 0);
    ImGui::SetCursorPosY(ImGui::GetCursorPosY() + (height - theme.px(24)) / 2);
    draw_hold(ui, landmark, place->second, hold, out);
  }
}

void draw_landmarks(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const auto& landmarks = ui.structure()->the_template->landmarks;
  if (landmarks.empty()) {
    explanation(theme, "This template has no landmarks. Place it with the tool Place (M).");
    return;
  }
  caption(theme, format("Landmarks placed: %zu of %zu", ui.shown().shape.landmarks.size(), landmarks.size()).c_str());
  if (ui.state.hand.tool == MouseTool::template_landmark)
    explanation(theme,
                "You are naming landmarks of the template (Template). Take the tool Landmark (L) to place them.");
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {theme.px(8), theme.px(2)});
  if (ui.state.hand.tool != MouseTool::template_landmark) draw_landmark_list(ui, out);
  ImGui::PopStyleVar();
  gap(theme, 2);
  const float half = (ImGui::GetContentRegionAvail().x - theme.px(4)) / 2;
  const auto ask = [&](FilePurpose purpose, const std::string& name) { out.send(ShowFileDialog{purpose, name}); };
  if (button(theme, "Import…",
             "Places the landmarks of a 3D Slicer (.mrk.json) or scalismo (.json) file by their names", {}, half))
    ask(FilePurpose::open_landmarks, "");
  ImGui::SameLine(0, theme.px(4));
  if (button(theme, "Export…", "Saves the placed landmarks for 3D Slicer (.mrk.json) or scalismo (.json)",
             ui.shown().shape.landmarks.empty() ? "No landmark is placed yet." : "", half))
    ask(FilePurpose::export_landmarks, case_name(ui.snapshot().file, ui.document()) + "-landmarks.mrk.json");
  caption(theme, "How landmarks move the template");
  int pull = static_cast<int>(ui.structure()->landmarks.pull);
  if (choice(theme, "landmark fit", {"Off", "Similarity", "Warp"}, pull,
             {.tips = {"Landmarks do not move the template", "Landmarks move, turn and scale the template",
                       "As Similarity. With four landmarks or more, the template is also warped smoothly to them"}}))
    out.apply(SetLandmarkPull{static_cast<LandmarkPull>(pull)});
}

}  // namespace

std::string placed_in_words(const UiContext& ui) {
  if (!ui.has_shape()) return {};
  const std::size_t all = ui.structure()->the_template->landmarks.size();
  return all == 0 ? "" : format("%zu of %zu landmarks", ui.shown().shape.landmarks.size(), all);
}

void draw_place_section(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  if (!ui.has_shape()) {
    explanation(theme, ui.structure() != nullptr
                           ? ui.needs_shape()
                           : "Load a template first (Template). Then place it on the organ here.");
    return;
  }
  PlacementNumbers(ui, out).draw();
  gap(theme, 4);
  draw_landmarks(ui, out);
  draw_fit(ui, out);
}

}  // namespace homolog
