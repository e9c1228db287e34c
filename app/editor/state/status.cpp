#include "app/editor/state/status.h"

#include <algorithm>
#include <cstdio>

#include "core/case/held_landmarks.h"

namespace homolog {

namespace {

std::string quoted(const std::string& name) {
  return "\"" + name + "\"";
}

std::string landmark_hint(const EditorState& state, const Document& shown) {
  const std::size_t landmarks = shown.structure()->the_template->landmarks.size();
  if (landmarks == 0) return "This template has no landmarks yet. Name some of its points first (Template).";
  const std::string wanted = landmark_in_hand(state, shown);
  if (wanted.empty())
    return landmarks == 1 ? "The landmark is placed; drag it to move it."
                          : "All " + std::to_string(landmarks) + " landmarks are placed; drag one to move it.";
  return shown.view()->shape.landmarks.contains(wanted) ? "Click where " + quoted(wanted) + " is now, or drag it there."
                                                        : "Click where " + quoted(wanted) + " is.";
}

/// Of the placed landmark under the pointer: whether strokes move the mesh there. Empty where there is none.
std::string hold_hint(const EditorState& state, const Document& shown) {
  if (!state.hover || state.hover->landmark.empty() || !shown.view()) return {};
  const Template& the_template = *shown.structure()->the_template;
  for (std::size_t l = 0; l < the_template.landmarks.size(); ++l) {
    const std::string& name = the_template.landmarks[l].name;
    if (name != state.hover->landmark) continue;
    const LandmarkHold hold = landmark_hold(the_template, l, shown.view()->shape);
    if (!hold.placed) return {};
    if (hold.held) return quoted(name) + " is held: strokes leave the mesh here. The lock in Place releases it.";
    if (hold.met) return quoted(name) + " is free: strokes may move the mesh here. The lock in Place holds it.";
    char off[32];
    std::snprintf(off, sizeof off, "%.1f mm", hold.distance_mm);
    return "The mesh is " + std::string(off) + " off " + quoted(name) + ". Bring it there with Grab or Slide.";
  }
  return {};
}

std::string brush_hint(const EditorState& state, const Document& shown) {
  const bool regions = state.brush.paints == BrushPaints::region || state.brush.paints == BrushPaints::fill;
  if (state.tool == MouseTool::stiffness && regions) {
    if (shown.structure()->paint.regions->list.empty())
      return "There is no region to paint yet. Add one first (Template, Regions).";
    if (state.brush.erases) return "The brush takes vertices out of their region.";
    // As the brush does: the first one where none of that name is there.
    const auto& list = shown.structure()->paint.regions->list;
    const bool known =
        std::any_of(list.begin(), list.end(), [&](const Region& one) { return one.name == state.brush.region; });
    const std::string region = quoted(known ? state.brush.region : list.front().name);
    return state.brush.paints == BrushPaints::fill ? "Click to fill " + region + "; Alt empties."
                                                   : "Paint " + region + "; Alt erases.";
  }
  if (state.tool == MouseTool::confirm && !state.brush.hold) return "Paint what strokes may move again.";
  return "Paint on the outline or on the surface.";
}

std::string hint(const EditorState& state, const Document& shown, bool making_shown) {
  if (state.unsaved_found > 0 && !state.drag)
    return std::to_string(state.unsaved_found) + (state.unsaved_found == 1 ? " case was" : " cases were") +
           " not saved. Unsaved cases (Case) recovers them.";
  if (!shown.scan.image && !shown.view()) return "Open an image, or drop one on the window.";
  if (making_shown) return "You see the template that is being made. Close it (Template) to see the case's mesh again.";
  if (!shown.view()) return why_no_mesh(shown);
  if (const std::string hold = hold_hint(state, shown); !hold.empty() && !state.drag) return hold;
  switch (state.tool) {
    case MouseTool::place:
      return "Drag the mesh to move it, the ring to turn it, the knob to scale it.";
    case MouseTool::landmark:
      return landmark_hint(state, shown);
    case MouseTool::ruler:
      return state.ruler ? "Drag again to measure something else. Escape removes the ruler."
                         : "Drag from one point to another.";
    case MouseTool::template_landmark:
      return state.template_landmark.empty()
                 ? "Type a landmark's name, or choose one in the list to move it (Template)."
                 : "Click the point of the mesh that is " + quoted(state.template_landmark) + ".";
    case MouseTool::stiffness:
    case MouseTool::confirm:
      return brush_hint(state, shown);
    default:
      return "Drag the outline. Wheel: slices; while dragging: \xcf\x83.";
  }
}

/// Why the frame that is shown has to be looked at; empty where it need not, or while something is in hand.
std::string doubt_of(const EditorState& state, const Document& shown) {
  const auto& frames = state.volume_curve.frames;
  const auto here = frames.find(shown.frame);
  if (here == frames.end() || here->second.doubt.empty() || state.drag || state.playing) return {};
  return "Frame " + std::to_string(shown.frame) + " " + here->second.doubt + ".";
}

/// That an edit took a wall of the mesh through another one; empty where none did, and when a person
/// has gone on to something else.
std::string through_itself(const EditorState& state, const Document& shown) {
  const bool news = state.intersecting_before && state.said_in == situation_of(state, shown);
  if (!news || state.drag || state.playing) return {};
  return "The surface passes through itself (" + std::to_string(state.intersecting_at_rest) +
         (state.intersecting_at_rest == 1 ? " pair" : " pairs") +
         " of triangles). J leads there, Ctrl+Z takes it back.";
}

}  // namespace

std::string why_no_mesh(const Document& shown) {
  const Structure* structure = shown.structure();
  if (shown.view()) return {};
  if (structure == nullptr) return "There is no mesh yet. Load a template first (Template).";
  const bool any_before = structure->shapes.lower_bound(shown.frame) != structure->shapes.begin();
  return any_before ? "This frame has no mesh yet. Start from previous (Cine) copies one."
                    : "This frame has no mesh yet. Go to a frame that has one, and propagate it (Cine).";
}

Status status_of(const EditorState& state, const Snapshot& snapshot, const Document& shown, bool making_shown) {
  if (snapshot.preview) {
    if (snapshot.preview->stopped_by_guard) return {"Stopped: the surface would fold if you dragged farther.", true};
    if (!snapshot.preview->message.empty()) return {snapshot.preview->message};
  } else if (std::string through = making_shown ? "" : through_itself(state, shown); !through.empty()) {
    return {std::move(through), true};
  } else if (!snapshot.message.empty() && state.said_in == situation_of(state, shown)) {
    return {snapshot.message};
  }
  // The panel says both too, but perhaps out of sight.
  if (std::string doubt = making_shown ? "" : doubt_of(state, shown); !doubt.empty()) return {std::move(doubt), true};
  return {hint(state, shown, making_shown)};
}

}  // namespace homolog
