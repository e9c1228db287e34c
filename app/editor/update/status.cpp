#include "app/editor/update/status.h"

#include "app/editor/update/tools/tool.h"
#include "core/base/text/in_quotes.h"
#include "core/base/text/lengths.h"
#include "core/case/held_landmarks.h"

namespace homolog {

namespace {

/// Of the placed landmark under the pointer: whether strokes move the mesh there. Empty where there is none.
std::string hold_hint(const EditorState& state, const Document& shown) {
  const auto active = active_shape(state, shown);
  if (!state.pointer.hover || state.pointer.hover->landmark.empty() || !active) return {};
  const Template& the_template = active->the_template();
  for (std::size_t l = 0; l < the_template.landmarks.size(); ++l) {
    const std::string& name = the_template.landmarks[l].name;
    if (name != state.pointer.hover->landmark) continue;
    const LandmarkHold hold = landmark_hold(the_template, l, active->shape);
    if (!hold.placed) return {};
    if (hold.held) return in_quotes(name) + " is held: strokes leave the mesh here. The lock in Place releases it.";
    if (hold.met) return in_quotes(name) + " is free: strokes may move the mesh here. The lock in Place holds it.";
    return "The mesh is " + in_mm(hold.distance_mm, 1) + " off " + in_quotes(name) +
           ". Bring it there with Grab or Slide.";
  }
  return {};
}

/// Of another structure under the pointer. Empty where there is none, or something is in hand.
std::string choose_hint(const EditorState& state, const Document& shown) {
  const bool over_other = state.pointer.hover && !state.pointer.hover->structure.empty() && !state.pointer.drag;
  const Structure* other = over_other ? shown.structure(state.pointer.hover->structure) : nullptr;
  return other != nullptr ? "Click to work on " + in_quotes(structure_name(*other)) + "." : std::string();
}

std::string hint(const EditorState& state, const Document& shown, bool making_shown) {
  if (state.unsaved_found > 0 && !state.pointer.drag)
    return state.unsaved_found == 1
               ? "1 case was not saved. Unsaved cases (Case) recovers it."
               : std::to_string(state.unsaved_found) + " cases were not saved. Unsaved cases (Case) recovers them.";
  const bool has_shape = active_shape(state, shown).has_value();
  if (!shown.scan.image && !has_shape) return "Open an image, or drop one on the window.";
  if (making_shown) return "You see the template that is being made. Close it (Template) to see the case's mesh again.";
  if (!has_shape) return why_no_mesh(state, shown);
  if (const std::string other = choose_hint(state, shown); !other.empty()) return other;
  if (const std::string hold = hold_hint(state, shown); !hold.empty() && !state.pointer.drag) return hold;
  const bool several = shown.structures.size() > 1;  // which one is worked on
  return (several ? structure_name(*active_structure(state, shown)) + ": " : std::string()) +
         kind_of(state.hand.tool).hint(state, shown);
}

/// Why the frame that is shown has to be looked at; empty where it need not, or while something is in hand.
std::string doubt_of(const EditorState& state, const Document& shown) {
  const auto& frames = state.found.volume_curve.frames;
  const auto here = frames.find(shown.frame);
  if (here == frames.end() || here->second.doubt.empty() || state.pointer.drag || state.look.playing) return {};
  return "Frame " + std::to_string(shown.frame) + " " + here->second.doubt + ".";
}

/// That an edit took a wall of the mesh through another one; empty where none did, and when a person
/// has gone on to something else.
std::string through_itself(const EditorState& state, const Document& shown) {
  const bool news = state.found.intersecting_before && state.said_in == situation_of(state, shown);
  if (!news || state.pointer.drag || state.look.playing) return {};
  return "The surface passes through itself (" + std::to_string(state.found.intersecting_at_rest) +
         (state.found.intersecting_at_rest == 1 ? " pair" : " pairs") +
         " of triangles). J leads there, Ctrl+Z takes it back.";
}

}  // namespace

std::string why_no_mesh(const EditorState& state, const Document& shown) {
  const Structure* structure = active_structure(state, shown);
  if (active_shape(state, shown)) return {};
  if (structure == nullptr)
    return "There is no mesh yet. Load a template (Template), or fit a set to a label map (Structures).";
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
