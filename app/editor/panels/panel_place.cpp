#include <cmath>
#include <numbers>

#include "app/editor/panels/ui_context.h"
#include "app/editor/update/controls.h"
#include "app/editor/widgets/icons.h"
#include "app/editor/widgets/widgets.h"

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
        "centre", centre_, 0.1, "mm",
        [](int axis) { return std::string("mm towards the patient's ") + towards[static_cast<std::size_t>(axis)]; },
        [this](int axis, double value) {
          Similarity change;
          change.translation[axis] = value - centre_[axis];
          return change.after(placement_);
        });
    caption(theme, "Turn about L, P, S");
    row(
        "angle", angles_, 0.25, "\xc2\xb0", [](int) { return "Degrees about the patient's axes, in this order"; },
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
  template <class Tip, class Placement>
  void row(const char* name, const Vec3& committed, double per_px, const char* unit, Tip tip, Placement placement_for) {
    const Theme& theme = ui_.theme;
    const float width = std::floor((ImGui::GetContentRegionAvail().x - 2 * theme.px(4)) / 3);
    for (int axis = 0; axis < 3; ++axis) {
      if (axis > 0) ImGui::SameLine(0, theme.px(4));
      const std::string id = format("%s %d", name, axis);
      CaseNumber number(ui_, id, committed[axis]);
      bool released = false;
      const bool changed =
          number_field(theme, id.c_str(), number.value, per_px, "%.1f", unit, width, tip(axis), released);
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

void draw_landmark_list(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const auto& landmarks = ui.document().the_template->landmarks;
  const auto& placed = ui.document().shape().landmarks;
  for (const Landmark& landmark : landmarks) {
    const Part part(landmark.name, "landmark");
    const auto place = placed.find(landmark.name);
    const bool done = place != placed.end();
    const bool next = ui.state.tool == MouseTool::landmark && ui.state.landmark == landmark.name;
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x, height = theme.px(24);
    const float remove = done ? theme.px(24) : 0.0f;
    const std::string shown = shortened(landmark.name, width - remove - theme.px(32));
    const std::string tip = done ? "Go there. Drag it in a view to move it" : "Then click where it is in a slice";
    const auto row =
        area(theme, "row", {width - remove, height}, shown == landmark.name ? tip : landmark.name + "\n" + tip, {next});
    if (row.clicked) out.send(ChooseLandmark{landmark.name, done ? std::optional(place->second) : std::nullopt});
    ImDrawList& draw = *ImGui::GetWindowDrawList();
    if (next || row.hovered)
      draw.AddRectFilled(at, {at.x + width, at.y + height}, next ? with_alpha(palette::accent, 0.18f) : palette::raised,
                         theme.px(4));
    const float text_y = std::floor(at.y + (height - ImGui::GetFontSize()) / 2);
    text_at(draw, {at.x + theme.px(6), text_y}, done ? palette::good : palette::faint,
            done ? icon::check : icon::outline);
    text_at(draw, {at.x + theme.px(28), text_y}, palette::text, shown);
    if (done) {
      ImGui::SameLine(0, 0);
      if (icon_button(theme, icon::close, "remove", "Remove this landmark", {}, false, 24))
        out.apply(PlaceLandmark{landmark.name, std::nullopt});
    }
  }
}

void draw_landmarks(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const auto& landmarks = ui.document().the_template->landmarks;
  if (landmarks.empty()) {
    explanation(theme, "This template has no named landmarks; place it with the tool Place (M).");
    return;
  }
  caption(theme,
          format("Landmarks placed: %zu of %zu", ui.document().shape().landmarks.size(), landmarks.size()).c_str());
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {theme.px(8), theme.px(2)});
  draw_landmark_list(ui, out);
  ImGui::PopStyleVar();
  gap(theme, 2);
  const float half = (ImGui::GetContentRegionAvail().x - theme.px(4)) / 2;
  const auto ask = [&](FilePurpose purpose, const std::string& name) { out.send(ShowFileDialog{purpose, name}); };
  if (button(theme, "Import…",
             "Places the landmarks of a 3D Slicer (.mrk.json) or scalismo (.json) file by their names", {}, half))
    ask(FilePurpose::open_landmarks, "");
  ImGui::SameLine(0, theme.px(4));
  if (button(theme, "Export…", "Saves the placed landmarks for 3D Slicer (.mrk.json) or scalismo (.json)",
             ui.document().shape().landmarks.empty() ? "None is placed yet." : "", half))
    ask(FilePurpose::export_landmarks, case_name(ui.snapshot.file, ui.document()) + "-landmarks.mrk.json");
  int fit = static_cast<int>(ui.document().landmark_pull);
  if (choice(theme, "landmark fit", {"Off", "Similarity", "Warp"}, fit,
             {"Landmarks do not move the template", "Landmarks move, turn and scale the template",
              "As Similarity; from the fourth landmark on also a smooth warp"}))
    out.apply(SetLandmarkPull{static_cast<LandmarkPull>(fit)});
}

}  // namespace

void draw_place_section(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  if (!ui.has_shape()) {
    explanation(theme, "Load a template above, then place it on the organ.");
    return;
  }
  PlacementNumbers(ui, out).draw();
  gap(theme, 4);
  draw_landmarks(ui, out);
  draw_fit(ui, out);
}

}  // namespace homolog
