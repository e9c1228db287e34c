#pragma once

#include <doctest/doctest.h>

#include "app/editor/update/controls.h"
#include "app/editor/update/editing.h"
#include "core/experiment/demo_case.h"
#include "tests/must.h"

namespace homolog {

inline const Document& demo() {
  static const Document document = test::must(demo_document(Organ::kidney, 1));
  return document;
}

/// The demo case as the editor shows it at 1280 × 800, with the events a user would send.
struct Desk {
  Document document = demo();
  EditorState state;
  Layout layout = make_layout(1280, 800, 1, {});
  mutable ShownMesh mesh;
  Outbox out;
  double seconds = 0;

  Desk() { show_document(state, document, layout); }
  ControlsContext context() const { return {layout, document, mesh, true, false}; }

  template <class What>
  void send(What what, double x, double y, bool shift = false, bool ctrl = false) {
    InputEvent event{what, x, y, shift, ctrl, false, seconds += 1, !layout.view_at(x, y).has_value()};
    handle_event(state, event, context(), out);
    run_on_state();
  }
  /// Does the commands that need nothing but the state; the others stay in `out`.
  void run_on_state() {
    for (Command& command : out.take()) {
      Outbox further;
      if (!command.run_on_state(state, context(), further)) out.send(std::move(command));
      for (Command& next : further.take()) out.send(std::move(next));
    }
  }
  void give(Command command) {
    out.send(std::move(command));
    run_on_state();
  }
  void press(int key, bool ctrl = false) { send(KeyPress{key}, 300, 250, false, ctrl); }
  Eigen::Vector2d middle_of(ViewKind kind) const {
    const RectPx& rect = layout.image(kind);
    return {rect.x + rect.width / 2, rect.y + rect.height / 2};
  }
  /// A px on the outline in a slice view: sideways from the cross-hair.
  Eigen::Vector2d on_outline(ViewKind kind) {
    const ViewMap map = view_map(state, layout, document, kind);
    const Eigen::Vector2d start = *map.to_px(state.look.crosshair_mm);
    for (double x = start.x(); x > layout.image(kind).x; x -= 1) {
      update_hover(state, context(), x, start.y());
      if (state.pointer.hover && state.pointer.hover->on_mesh) return *map.to_px(*state.pointer.hover->on_mesh);
    }
    FAIL("the cross-hair's row does not meet the outline");
    return start;
  }
  template <class Kind>
  std::vector<Kind> sent() {
    std::vector<Kind> found;
    for (const Command& command : out.take())
      if (const auto* one = command.as<Kind>()) found.push_back(*one);
    return found;
  }
};

}  // namespace homolog
