#include <algorithm>
#include <cmath>
#include <iterator>

#include "app/editor/panels/sections.h"
#include "app/editor/panels/ui_context.h"
#include "app/editor/state/icons.h"
#include "app/editor/update/controls.h"
#include "app/editor/widgets/plots.h"
#include "app/editor/widgets/widgets.h"

// The section Cine: the frame that is shown, the meshes of all frames from those that a person made, their volumes.

namespace homolog {

namespace {

void show_frame(int frame, Outbox& out) {
  out.send(SeekFrame{frame});
  out.send(ShowFrame{frame});
}

void draw_frame_controls(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const Document& document = ui.document();
  const int frames = document.scan.image->frames, frame = shown_frame(ui.state, document);
  double value = frame;
  bool released = false;
  const SliderRange range{0, static_cast<double>(frames - 1), "%.0f", "", false, true};
  if (slider(theme, "Frame", value, range, "Frame of the cine. Each frame has a mesh of its own", released))
    out.send(SeekFrame{static_cast<int>(std::lround(value))});
  // A number that is typed changes and is released at once.
  const int wanted = static_cast<int>(std::lround(value));
  if (released && !ui.state.look.playing && (ui.state.look.shown_frame || wanted != document.frame))
    out.send(ShowFrame{wanted});
  if (button(theme,
             std::string(ui.state.look.playing ? icon::pause : icon::play) +
                 (ui.state.look.playing ? "  Pause" : "  Play"),
             "Play the frames (Space)"))
    out.send(PlayFrames{!ui.state.look.playing});
  ImGui::SameLine();
  static const decltype(Structure::shapes) none;
  const auto& shapes = ui.structure() != nullptr ? ui.structure()->shapes : none;
  const auto from_here = shapes.lower_bound(frame);
  const bool any_before = from_here != shapes.begin();
  const int before = any_before ? std::prev(from_here)->first : 0;
  const std::string refusal = ui.structure() == nullptr ? ui.needs_shape()
                              : any_before              ? ""
                                                        : "No frame before this one has a mesh.";
  if (button(theme, "Start from previous", format("Give this frame a copy of the mesh of frame %d", before), refusal))
    out.apply(StartFrameFrom{before});
}

/// "frame 0", "frames 0 and 7", "frames 0, 4, 7 and 3 more".
std::string frames_in_words(const std::vector<int>& frames) {
  constexpr std::size_t most = 4;
  std::string words = frames.size() == 1 ? "frame " : "frames ";
  const std::size_t named = frames.size() > most + 1 ? most : frames.size();
  for (std::size_t k = 0; k < named; ++k) {
    if (k > 0) words += k + 1 == frames.size() ? " and " : ", ";
    words += std::to_string(frames[k]);
  }
  if (named < frames.size()) words += " and " + std::to_string(frames.size() - named) + " more";
  return words;
}

void draw_propagate(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const bool busy = ui.work.propagator.busy();
  const std::string needs = ui.work.fitter.busy() ? "Wait for the fit." : ui.needs_shape();
  const std::string from = needs.empty() ? frames_in_words(starting_frames(ui.shown())) : "";
  const Look& look = ui.state.look;
  const std::size_t others =
      needs.empty() ? carried_structures(look.structures, ui.document(), look.structure).size() - 1 : 0;
  if (button(theme, "Propagate",
             "Carries the mesh of " + from + " through the cine" +
                 (others == 0 ? ""
                              : format(", and %zu more %s from their own frames. Locked ones stay", others,
                                       others == 1 ? "structure" : "structures")) +
                 ". Frames that you edited or confirmed stay as they are. One step to undo",
             ButtonOptions{.refusal = busy ? "The mesh is being carried through the cine." : needs,
                           .width_px = ImGui::GetContentRegionAvail().x,
                           .primary = true}))
    out.send(PropagateFrames{});
  std::optional<WorkShown> running;
  if (busy) running = {"Propagating", ui.work.propagator.fraction(), "The meshes stay as they were (Escape)"};
  if (work_area(theme, from.empty() ? "" : "From " + from + ". Correct a frame, and propagate again.", running))
    out.send(CancelPropagation{});
  if (!needs.empty()) return;
  if (const double missing = missing_share_of(ui.shown().the_template(), ui.shown().shape); missing > 0)
    text_lines(
        format("The mesh %s, so volumes are too small. Make the template again.", missing_doubt(missing).c_str()),
        palette::amber);
}

/// Where frames and volumes lie in the plot.
struct CurveField {
  ImVec2 low, high;
  int frames = 1;
  double most_ml = 1;
  float x(int frame) const {
    return low.x + (high.x - low.x) * (static_cast<float>(frame) + 0.5f) / static_cast<float>(frames);
  }
  float y(double volume_ml) const { return high.y - static_cast<float>(volume_ml / most_ml) * (high.y - low.y); }
  int frame_at(float x_px) const {
    return std::clamp(static_cast<int>((x_px - low.x) / (high.x - low.x) * static_cast<float>(frames)), 0, frames - 1);
  }
};

void draw_curve_axes(const Theme& theme, const CurveField& field, const std::vector<double>& marks, ImDrawList& draw) {
  for (const double mark : marks) {
    const float y = std::round(field.y(mark));
    draw.AddLine({field.low.x, y}, {field.high.x, y}, mark == 0 ? palette::faint : palette::line);
    const std::string text = format("%.4g", mark);
    const ImVec2 size = text_size(theme.small, text);
    text_at(draw, theme.small, {std::round(field.low.x - theme.px(5) - size.x), std::round(y - size.y / 2)},
            palette::dim, text);
  }
  for (const int frame : {0, field.frames - 1}) {
    const std::string text = std::to_string(frame);
    text_at(draw, theme.small,
            {std::round(field.x(frame) - text_size(theme.small, text).x / 2), field.high.y + theme.px(3)}, palette::dim,
            text);
  }
}

/// Dots: filled where a person made the mesh, small where it was carried, amber rings where it is in doubt.
void draw_curve(const Theme& theme, const CurveField& field, const VolumeCurve& curve, ImDrawList& draw) {
  const float thick = std::max(theme.scale, 1.0f);
  const ImVec2* before = nullptr;
  ImVec2 last;
  int last_frame = -2;
  for (const auto& [frame, one] : curve.frames) {
    const ImVec2 at{field.x(frame), field.y(one.volume_ml)};
    if (before != nullptr && last_frame + 1 == frame) draw.AddLine(last, at, palette::accent, 1.5f * thick);
    last = at;
    before = &last;
    last_frame = frame;
  }
  for (const auto& [frame, one] : curve.frames) {
    const ImVec2 at{field.x(frame), field.y(one.volume_ml)};
    if (!one.doubt.empty()) {
      draw.AddCircleFilled(at, theme.px(4), palette::surface);
      draw.AddCircle(at, theme.px(4), palette::amber, 0, 1.5f * thick);
    } else {
      draw.AddCircleFilled(at, theme.px(one.known ? 4 : 2), one.known ? IM_COL32_WHITE : palette::accent);
    }
  }
  if (!curve.ejection) return;
  const auto name = [&](const char* text, int frame, bool above) {
    const ImVec2 size = text_size(theme.small, text);
    const float y = field.y(curve.frames.at(frame).volume_ml) + (above ? -size.y - theme.px(5) : theme.px(6));
    const float x = std::clamp(field.x(frame) - size.x / 2, field.low.x, field.high.x - size.x);
    text_at(draw, theme.small, {std::round(x), std::round(y)}, palette::text, text);
  };
  name("ED", curve.ejection->end_diastole, true);
  name("ES", curve.ejection->end_systole,
       curve.frames.at(curve.ejection->end_systole).volume_ml > 0.25 * field.most_ml ? false : true);
}

std::string frame_in_words(const VolumeCurve& curve, int frame) {
  const auto there = curve.frames.find(frame);
  std::string words = format("Frame %d", frame);
  if (there == curve.frames.end()) return words + ": no mesh yet. Click to show it";
  words += format(": %.1f ml", there->second.volume_ml);
  if (there->second.known) words += ", made by hand";
  if (!there->second.doubt.empty()) words += ". It " + there->second.doubt;
  return words + ". Click to show it";
}

void draw_volumes(const UiContext& ui, const VolumeCurve& curve, Outbox& out) {
  const Theme& theme = ui.theme;
  double most_ml = curve.frames.empty() ? 100 : 0;
  for (const auto& [frame, one] : curve.frames) most_ml = std::max(most_ml, one.volume_ml);
  const std::vector<double> marks = axis_marks(1.1 * most_ml, 3);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const ImVec2 size{ImGui::GetContentRegionAvail().x, theme.px(132)};
  const float line = theme.small->FontSize;
  const CurveField field{{at.x + theme.px(32), at.y + line + theme.px(6)},
                         {at.x + size.x - theme.px(2), at.y + size.y - line - theme.px(6)},
                         ui.document().scan.image->frames,
                         marks.back()};
  const int pointed = field.frame_at(ImGui::GetIO().MousePos.x);
  const AreaState state = area(theme, "volume curve", size, frame_in_words(curve, pointed));
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  text_at(draw, theme.small, {at.x, at.y}, palette::dim, "Volume, ml");
  const std::string axis = "frame";
  text_at(draw, theme.small, {at.x, field.high.y + theme.px(3)}, palette::dim, axis);
  draw_curve_axes(theme, field, marks, draw);
  const float shown = field.x(shown_frame(ui.state, ui.document()));
  draw.AddLine({shown, field.low.y}, {shown, field.high.y}, with_alpha(palette::text, 0.5f), theme.px(1));
  if (state.hovered)
    draw.AddLine({field.x(pointed), field.low.y}, {field.x(pointed), field.high.y}, with_alpha(palette::text, 0.2f));
  draw_curve(theme, field, curve, draw);
  if (state.clicked) show_frame(pointed, out);
}

/// The next frame in doubt after the one that is shown; the first where there is none behind it.
int next_in_doubt(const std::vector<int>& doubtful, int shown) {
  const auto next = std::upper_bound(doubtful.begin(), doubtful.end(), shown);
  return next != doubtful.end() ? *next : doubtful.front();
}

void draw_doubts(const UiContext& ui, const VolumeCurve& curve, Outbox& out) {
  const Theme& theme = ui.theme;
  std::vector<int> doubtful;
  for (const auto& [frame, one] : curve.frames)
    if (!one.doubt.empty()) doubtful.push_back(frame);
  figure(theme, "In doubt", doubtful.empty() ? "no frame" : format("%zu of %zu", doubtful.size(), curve.frames.size()),
         "Frames that a person must check. They do not count for the ejection fraction",
         doubtful.empty() ? palette::text : palette::amber);
  const int shown = shown_frame(ui.state, ui.document());
  const float half = std::floor((ImGui::GetContentRegionAvail().x - theme.px(8)) / 2);
  if (button(theme, "Next in doubt", "Shows the next frame in doubt. Correct it, or confirm it as it is",
             doubtful.empty() ? "No frame is in doubt." : "", half))
    show_frame(next_in_doubt(doubtful, shown), out);
  ImGui::SameLine(0, theme.px(8));
  if (button(theme, "Volumes\xe2\x80\xa6", "The volume of every frame as a table: .csv. Openings count as closed flat",
             {}, half))
    out.send(ShowFileDialog{FilePurpose::export_volumes,
                            case_name(ui.snapshot().file, *ui.snapshot().document) + "-volumes.csv"});
  // Below the buttons, which stay under the pointer from frame to frame.
  const auto here = curve.frames.find(shown);
  const bool doubtful_here = here != curve.frames.end() && !here->second.doubt.empty();
  two_lines(theme, doubtful_here ? format("Frame %d ", shown) + here->second.doubt + "." : "", palette::amber);
}

/// Each figure has its place before it is known, so that nothing below moves.
void draw_ejection(const UiContext& ui, const VolumeCurve& curve) {
  const Theme& theme = ui.theme;
  const auto known = [&](const std::string& value) { return curve.ejection ? value : "not known"; };
  const Ejection ejection = curve.ejection.value_or(Ejection{});
  const auto volume = [&](int frame) {
    return curve.ejection ? format("%.1f ml, frame %d", curve.frames.at(frame).volume_ml, frame) : "";
  };
  figure(theme, "End diastole", known(volume(ejection.end_diastole)),
         "ED: the largest volume among the frames that are not in doubt");
  figure(theme, "End systole", known(volume(ejection.end_systole)),
         "ES: the smallest volume among the frames that are not in doubt");
  figure(theme, "Ejection fraction", known(format("%.1f %%", 100 * ejection.fraction)),
         "(largest volume \xe2\x88\x92 smallest volume) / largest volume");
}

/// The wall between a cavity and the structure around it, where the case has both.
void draw_wall(const UiContext& ui, const VolumeCurve& curve) {
  const Structure *inner = ui.document().structure(curve.inner), *outer = ui.document().structure(curve.outer);
  if (curve.inner.empty() || inner == nullptr || outer == nullptr) return;
  const Theme& theme = ui.theme;
  const auto here = curve.frames.find(shown_frame(ui.state, ui.document()));
  const bool known = here != curve.frames.end() && here->second.wall;
  const WallOfFrame wall = known ? *here->second.wall : WallOfFrame{};
  const std::string between = "Between " + structure_name(*inner) + " and " + structure_name(*outer) + ", this frame. ";
  figure(theme, "Wall thickness", known ? format("%.1f mm", wall.thickness_mm) : "not known",
         between + "Half of the inner mesh's points are farther from the outer surface, half are nearer");
  figure(theme, "Wall mass", known ? format("%.0f g (%.1f ml)", wall.mass_g(), wall.volume_ml) : "not known",
         between + "Outer volume \xe2\x88\x92 inner volume, times 1.05 g/ml of heart muscle");
}

}  // namespace

void draw_cine_section(const UiContext& ui, Outbox& out) {
  draw_frame_controls(ui, out);
  gap(ui.theme, 4);
  draw_propagate(ui, out);
  const VolumeCurve& curve = ui.state.found.volume_curve;
  gap(ui.theme, 4);
  draw_volumes(ui, curve, out);
  draw_ejection(ui, curve);
  draw_wall(ui, curve);
  draw_doubts(ui, curve, out);
}

}  // namespace homolog
