#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "app/editor/interface/interface.h"
#include "app/editor/state/icons.h"
#include "app/editor/update/status.h"
#include "app/editor/widgets/key_focus.h"
#include "app/editor/widgets/widgets.h"
#include "core/base/text/text.h"

namespace homolog {

namespace {

/// "R 17.6 P 35.3 S 12.1    voxel 120 88 40    124": where the pointer is.
std::string read_out(const UiContext& ui) {
  if (!ui.state.pointer.hover || !ui.state.pointer.hover->p_mm) return {};
  const Vec3& p_mm = *ui.state.pointer.hover->p_mm;
  std::string text = position_text(p_mm);
  const auto& volume = ui.document().scan.image;
  if (!volume) return text;
  const Vec3 voxel = volume->geometry.to_voxel(p_mm).array().round();
  const auto& dims = volume->geometry.dims;
  for (int axis = 0; axis < 3; ++axis)
    if (voxel[axis] < 0 || voxel[axis] >= dims[axis]) return text + "    outside the image";
  const auto i = static_cast<int>(voxel.x()), j = static_cast<int>(voxel.y()), k = static_cast<int>(voxel.z());
  const double value = volume->at(i, j, k, shown_frame(ui.state, ui.document()));
  text += format("    voxel %d %d %d    %.4g", i, j, k, value);
  if (const int label = label_there(ui, p_mm)) {
    const auto name = ui.labels().names.find(label);
    text += format("    label %d", label) + (name == ui.labels().names.end() ? "" : " " + excerpt(name->second));
  }
  return text;
}

}  // namespace

void draw_tall_message(const UiContext& ui, const std::string& message) {
  const Theme& theme = ui.theme;
  const RectPx& bar = ui.layout.status_line;
  const float pad = theme.px(12), wrap = std::min(bar.width - 2 * pad, static_cast<float>(theme.px(720)));
  const float height = text_size(theme.small, in_lines(theme.small, message, wrap)).y + theme.px(12);
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();  // over the views, below cards and dialogs
  draw.AddRectFilled({bar.x, bar.y - height}, {bar.x + wrap + 2 * pad, bar.y}, palette::raised);
  text_at(draw, theme.small, {bar.x + pad, bar.y - height + theme.px(6)}, palette::amber, message, wrap);
}

float begin_status_line(const UiContext& ui) {
  const RectPx& bar = ui.layout.status_line;
  begin_region("status line", bar, palette::surface);
  ImGui::PushFont(ui.theme.small);
  ImGui::GetWindowDrawList()->AddLine({bar.x, bar.y}, {bar.x + bar.width, bar.y}, palette::line);
  return std::floor(bar.y + (bar.height - ImGui::GetFontSize()) / 2);
}

void end_status_line() {
  ImGui::PopFont();
  end_region();
}

void draw_status_line(const UiContext& ui, Outbox&) {
  const Theme& theme = ui.theme;
  const OutOfKeysReach nothing_to_press;
  const RectPx& bar = ui.layout.status_line;
  const float y = begin_status_line(ui);
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const float left = bar.x + theme.px(12), middle = bar.x + std::max(theme.px(300), std::round(bar.width * 0.36f));
  const auto& snapshot = ui.snapshot();
  const Status status = status_of(ui.state, snapshot, ui.document(), ui.making_shown());
  const ImU32 colour = status.warns ? palette::amber : palette::dim;
  const std::string message = status.warns ? std::string(icon::warning) + "  " + status.text : status.text;

  std::string right;
  if (snapshot.solver_ms > 0) right = format("solved in %.2f ms", snapshot.solver_ms);
  // A window at rest, or one that shows how far work is, draws as seldom as it can.
  const bool moves = ui.state.pointer.drag || ui.state.look.playing;
  if (moves && ui.frames_per_second >= 1) right += format("    %.0f frames/s", ui.frames_per_second);
  std::optional<EvenDigits> digits(std::in_place, theme);  // gone before the line ends
  const ImVec2 size = ImGui::CalcTextSize(right.c_str());
  const ImVec2 at{bar.x + bar.width - theme.px(12) - size.x, y};
  const float end = at.x - theme.px(12), wanted = ImGui::CalcTextSize(message.c_str()).x;
  const std::string there = shortened(read_out(ui), middle - left - theme.px(12));
  const float beside = there.empty() ? left : left + ImGui::CalcTextSize(there.c_str()).x + theme.px(24);
  // What is said whole may begin where the read-out ends. A warning is said whole: else over the read-out.
  const bool all_of_it = status.warns && wanted > end - beside;
  const float from = all_of_it               ? std::max(left, end - wanted)
                     : wanted > end - middle ? std::max(std::min(beside, middle), end - wanted)
                                             : middle;
  if (!all_of_it) text_at(draw, {left, y}, palette::text, there);
  if (all_of_it && wanted > end - left) {
    draw_tall_message(ui, message);
  } else {
    const std::string fitting = whole_sentences(message, end - from);
    text_at(draw, {from, y}, colour, fitting);
    if (fitting != message) {
      ImGui::SetCursorScreenPos({from, y});
      area(theme, "message", {end - from, size.y}, message);
    }
  }
  text_at(draw, at, palette::dim, right);
  ImGui::SetCursorScreenPos(at);
  area(theme, "timings", {std::max(size.x, 1.0f), size.y},
       "Time to compute the last edit Â· pictures drawn in the last second, while something moves");
  digits.reset();
  end_status_line();
}

}  // namespace homolog
