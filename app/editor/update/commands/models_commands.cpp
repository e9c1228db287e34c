#include "app/editor/update/commands/models_commands.h"

#include <utility>

#include "app/editor/state/models/gallery.h"
#include "app/editor/update/commands/spelling.h"
#include "app/editor/update/editing.h"

namespace homolog {

namespace {

constexpr std::array alignment_names{"similarity", "rigid", "none"};

void spell_place(Fields& line, std::optional<GalleryVertex>& place) {
  bool any = place.has_value();
  line.member("any", any);
  if (!any) return;
  if (!place) place.emplace();
  std::int64_t vertex = place->vertex;
  line.member("shape", place->shape);
  line.member("vertex", vertex);
  place->vertex = vertex;
}

}  // namespace

void LookFromSideInGallery::spell(Fields& line) {
  spell_choice(line, "side", side_names, side);
}
void LookFromSideInGallery::run(EditorState& state) const {
  look_from(state.models.camera, side);
}

void ShowAllShapes::run(EditorState& state) const {
  show_all_shapes(state.models);
}

void TurnGallery::spell(Fields& line) {
  line.member("right_px", right_px);
  line.member("down_px", down_px);
}
void TurnGallery::run(EditorState& state) const {
  state.models.turning = true;
  state.models.hover.reset();
  state.models.camera = turned(state.models.camera, right_px, down_px);
}

void PanGallery::spell(Fields& line) {
  line.member("right_px", right_px);
  line.member("down_px", down_px);
  line.member("side_px", side_px);
}
void PanGallery::run(EditorState& state) const {
  state.models.turning = true;
  state.models.hover.reset();
  pan_gallery(state.models, right_px, down_px, side_px);
}

void LetGoOfGallery::run(EditorState& state) const {
  state.models.turning = false;
}

void ZoomGallery::spell(Fields& line) {
  line.member("steps", steps);
}
void ZoomGallery::run(EditorState& state) const {
  zoom_gallery(state.models, steps);
}

void PointAtVertex::spell(Fields& line) {
  spell_place(line, place);
}
void PointAtVertex::run(EditorState& state) const {
  state.models.hover = place;
}

void PinVertex::spell(Fields& line) {
  spell_place(line, place);
  line.member("focus", focus);
}
void PinVertex::run(EditorState& state) const {
  if (place)
    pin_vertex(state.models, *place, focus);
  else
    unpin(state.models);
}

void ShowGalleryGlyphs::spell(Fields& line) {
  line.member("shown", shown);
}
void ShowGalleryGlyphs::run(EditorState& state) const {
  state.models.glyphs = shown;
}

void SpaceGalleryGlyphs::spell(Fields& line) {
  line.member("spacing_mm", spacing_mm);
}
void SpaceGalleryGlyphs::run(EditorState& state) const {
  state.models.glyph_spacing_mm = spacing_mm;
}

void ShowMean::run(EditorState& state) const {
  set_to_mean(state.models);
}

void ShowSample::run(EditorState& state) const {
  set_to_sample(state.models);
}

void ShowSelectedShape::run(EditorState& state) const {
  set_to_case(state.models, state.models.selected);
}

void SetMode::spell(Fields& line) {
  line.member("mode", mode);
  line.member("deviations", deviations);
}
void SetMode::run(EditorState& state) const {
  if (mode < state.models.deviations.size()) state.models.deviations[mode] = deviations;
  state.models.animated_mode.reset();
  state.models.show_difference = false;
}

void AnimateMode::spell(Fields& line) {
  line.or_null("mode", mode);
}
void AnimateMode::run(EditorState& state) const {
  state.models.animated_mode = mode;
  state.models.show_difference = false;
  state.models.animation_started = -1;
}

void ShowAllModes::spell(Fields& line) {
  line.member("all", all);
}
void ShowAllModes::run(EditorState& state) const {
  state.models.all_modes = all;
}

void ShowDifference::spell(Fields& line) {
  line.member("shown", shown);
}
void ShowDifference::run(EditorState& state) const {
  state.models.show_difference = shown;
  state.models.animated_mode.reset();
}

void CompareGroup::spell(Fields& line) {
  line.member("which", which);
  line.member("group", group);
}
void CompareGroup::run(EditorState& state) const {
  if (which < state.models.compared.size()) state.models.compared[which] = group;
}

void ChooseAlignment::spell(Fields& line) {
  spell_choice(line, "alignment", alignment_names, alignment);
}
void ChooseAlignment::run(EditorState& state) const {
  state.models.alignment = alignment;
}

}  // namespace homolog
