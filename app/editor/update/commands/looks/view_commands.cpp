#include "app/editor/update/commands/looks/view_commands.h"

#include <algorithm>

#include "app/editor/scene/mesh_colouring.h"
#include "app/editor/state/views.h"
#include "app/editor/update/commands/file_commands.h"
#include "app/editor/update/commands/spelling.h"
#include "app/editor/update/controls.h"
#include "app/editor/update/editing.h"

namespace homolog {

namespace {

constexpr std::array finding_names{"intersecting", "turned", "thin", "unclear", "doubtful", "suspicious"};

}  // namespace

void ScrollSlices::spell(Fields& line) {
  spell_choice(line, "view", view_names, view);
  line.member("steps", steps);
}
void ScrollSlices::run(EditorState& state, const ControlsContext& context, Outbox&) const {
  if (view == ViewKind::space) return;
  scroll_slice(state, view, context.document, steps);
  state.preferences.hints.scrolled = true;
}

void OpenSection::spell(Fields& line) {
  line.member("section", section);
  line.member("open", open);
}
void OpenSection::run(EditorState& state) const {
  state.preferences.sections_open[section] = open;
}

void ShowAll::run(EditorState& state, const ControlsContext& context, Outbox&) const {
  show_all(state, context.document, context.layout);
}

void SetWindow::spell(Fields& line) {
  line.member("low", low);
  line.member("high", high);
}
void SetWindow::run(EditorState& state) const {
  state.look.window_low = low;
  state.look.window_high = high;
}

void ShowOwnPlanes::spell(Fields& line) {
  line.member("own", own);
}
void ShowOwnPlanes::run(EditorState& state, const ControlsContext& context, Outbox&) const {
  const auto slices = state.look.slices;
  const Camera3D camera = state.look.camera;
  const auto fill = [&] {
    show_all(state, context.document, context.layout);
    state.look.camera = camera;
  };
  fill();
  const bool filled = state.look.slices == slices;
  state.look.own_planes = own;
  // Whoever saw the whole image goes on to see it; whoever looked closely stays at the place.
  if (filled)
    fill();
  else
    state.look.slices = slices;
  settle_crosshair(state, context.document);
}

void ChooseColouring::spell(Fields& line) {
  std::array<const char*, colourings> names{};
  const auto& kinds = colouring_kinds();
  std::transform(kinds.begin(), kinds.end(), names.begin(), [](const ColouringKind& kind) { return kind.log_name; });
  spell_choice(line, "colouring", names, colouring);
}
void ChooseColouring::run(EditorState& state) const {
  state.look.shows_confidence = colouring == Colouring::confidence;
  if (!state.look.shows_confidence) state.look.colouring = colouring;
}

void SeekFrame::spell(Fields& line) {
  line.member("frame", frame);
}
void SeekFrame::run(EditorState& state) const {
  state.look.shown_frame = frame;
  state.look.playing = false;
}

void LookAt::spell(Fields& line) {
  line.member("point_mm", point_mm);
}
void LookAt::run(EditorState& state) const {
  state.look.crosshair_mm = state.look.camera.target = point_mm;
}

void ShowFinding::spell(Fields& line) {
  spell_choice_or_null(line, "kind", finding_names, kind);
  line.member("back", back);
}
void ShowFinding::run(Editing& editing) const {
  EditorState& state = editing.state;
  const auto active = editing.shape();
  if (!active) return;
  std::vector<Finding> all;
  const auto& figures = editing.work.quality.latest();
  if (figures) all = figures->findings;
  all.insert(all.end(), state.found.unclear_edges.begin(), state.found.unclear_edges.end());
  if (kind) std::erase_if(all, [&](const Finding& one) { return one.kind != *kind; });
  if (all.empty())
    return add_notice(state,
                      !figures ? "The mesh is not checked yet. Try again in a moment."
                      : kind   ? "Nothing of this kind is left."
                               : "Nothing to look at: no faulty triangle, no unclear edge and no doubt.",
                      false);
  const auto now = state.found.finding ? std::find(all.begin(), all.end(), state.found.finding->finding) : all.end();
  const std::size_t count = all.size(), at = static_cast<std::size_t>(now - all.begin());
  const std::size_t next = now == all.end() ? (back ? count - 1 : 0) : (at + (back ? count - 1 : 1)) % count;
  ShownFinding shown{all[next], 0, 0};
  for (std::size_t k = 0; k < count; ++k) {
    if (all[k].kind != shown.finding.kind) continue;
    ++shown.of;
    if (k <= next) ++shown.number;
  }
  state.found.finding = std::move(shown);
  look_closely(state, active->mesh(), state.found.finding->finding.vertex);
}

void MoveInGuide::spell(Fields& line) {
  line.member("steps", steps);
}
void MoveInGuide::run(EditorState& state) const {
  if (!state.guide) return;
  const auto last = static_cast<int>(state.guide->steps.size());
  const int at = static_cast<int>(state.guide->at);
  state.guide->at = static_cast<std::size_t>(at + std::clamp(steps, -at, last - at));
  look_at_step(state);
}

void ShowGuide::spell(Fields& line) {
  line.member("shown", shown);
}
void ShowGuide::run(Editing& editing) const {
  EditorState& state = editing.state;
  state.preferences.guide_done = !shown;
  if (!state.guide) {
    if (shown) editing.out.send(open_phantom(Organ::kidney, 1));
    return;
  }
  state.guide->shown = shown;
  state.guide->at = 0;
  look_at_step(state);
}

}  // namespace homolog
