#include "app/editor/update/commands/models_commands.h"

#include <utility>

#include "app/editor/state/models/gallery.h"
#include "app/editor/update/commands/spelling.h"

namespace homolog {

void TurnGallery::spell(Fields& line) {
  line.member("right_px", right_px);
  line.member("down_px", down_px);
}
void TurnGallery::run(EditorState& state) const {
  state.models.gallery.turning = true;
  state.models.gallery.hover.reset();
  state.models.gallery.camera = turned(state.models.gallery.camera, right_px, down_px);
}

void PanGallery::spell(Fields& line) {
  line.member("right_px", right_px);
  line.member("down_px", down_px);
  line.member("side_px", side_px);
}
void PanGallery::run(EditorState& state) const {
  state.models.gallery.turning = true;
  state.models.gallery.hover.reset();
  pan_gallery(state.models, right_px, down_px, side_px);
}

void PinVertex::spell(Fields& line) {
  spell_value(line, "", place);
  line.member("focus", focus);
}
void PinVertex::run(EditorState& state) const {
  if (place)
    pin_vertex(state.models, *place, focus);
  else
    unpin(state.models);
}

void ShowSelectedShape::run(EditorState& state) const {
  set_to_case(state.models, state.models.list.selected);
}

void SetMode::spell(Fields& line) {
  line.member("mode", mode);
  line.member("deviations", deviations);
}
void SetMode::run(EditorState& state) const {
  if (mode < state.models.view.deviations.size()) state.models.view.deviations[mode] = deviations;
  state.models.view.animated_mode.reset();
  state.models.view.show_difference = false;
}

void AnimateMode::spell(Fields& line) {
  line.or_null("mode", mode);
}
void AnimateMode::run(EditorState& state) const {
  state.models.view.animated_mode = mode;
  state.models.view.show_difference = false;
  state.models.view.animation_started = -1;
}

void ShowDifference::spell(Fields& line) {
  line.member("shown", shown);
}
void ShowDifference::run(EditorState& state) const {
  state.models.view.show_difference = shown;
  state.models.view.animated_mode.reset();
}

void CompareGroup::spell(Fields& line) {
  line.member("which", which);
  line.member("group", group);
}
void CompareGroup::run(EditorState& state) const {
  if (which < state.models.view.compared.size()) state.models.view.compared[which] = group;
}

void CancelOptimisation::run(EditorState& state) const {
  if (state.models.made.optimisation.runs()) discard_optimised(state.models);
}

}  // namespace homolog
