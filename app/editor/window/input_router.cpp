#include "app/editor/window/input_router.h"

#include <imgui.h>

#include "app/editor/widgets/imgui_context.h"

namespace homolog {

void InputRouter::send(decltype(InputEvent::what) what, const Held& held, double seconds) {
  InputEvent event;
  event.what = what;
  event.x_px = x_px_;
  event.y_px = y_px_;
  event.shift = held.shift;
  event.ctrl = held.ctrl;
  event.alt = held.alt;
  event.seconds = seconds;
  event.over_panel = !app_.layout().view_at(x_px_, y_px_) || interface_at(x_px_, y_px_);
  app_.handle(event);
  // A click may have gone to a field of the interface.
  const bool click = std::holds_alternative<MousePress>(what) || std::holds_alternative<MouseRelease>(what);
  if (event.over_panel && click) queue_.wait_for_field();
}

void InputRouter::move(double x_px, double y_px, const Held& held, double seconds) {
  x_px_ = x_px;
  y_px_ = y_px;
  queue_.move(static_cast<float>(x_px), static_cast<float>(y_px));
  send(MouseMove{}, held, seconds);
}

void InputRouter::button(MouseButton button, bool down, const Held& held, double seconds) {
  queue_.button(button, down);
  if (down) close_menus_beside(x_px_, y_px_);
  if (down)
    send(MousePress{button}, held, seconds);
  else
    send(MouseRelease{button}, held, seconds);
}

void InputRouter::wheel(double steps, const Held& held, double seconds) {
  queue_.wheel(static_cast<float>(steps));
  send(Wheel{steps}, held, seconds);
}

void InputRouter::press(const KeyStroke& stroke, double seconds) {
  // At once where nothing is typed into: a key keeps its place among the mouse's events.
  if (queue_.keys_wait() || ImGui::GetIO().WantTextInput)
    queue_.press(stroke);
  else
    do_key(stroke, seconds);
}

void InputRouter::let_go(const Held& held, double seconds) {
  send(MouseMove{}, held, seconds);
}

void InputRouter::type(unsigned int character) {
  if (queue_.keys_wait() || ImGui::GetIO().WantTextInput) queue_.type(character);
}

bool InputRouter::do_key(const KeyStroke& stroke, double seconds) {
  const bool in_field = ImGui::GetIO().WantTextInput, in_dialog = app_.state().dialog.has_value();
  const bool enter = stroke.key == key::enter || stroke.key == key::keypad_enter;
  const bool printable = stroke.key < key::escape && !stroke.ctrl;
  if (stroke.key == key::escape && !in_field && close_menus()) return false;
  // A field that is typed into keeps its keys; a dialog's list is moved through all the same.
  if (!in_field || (in_dialog && !printable && !enter)) {
    send(KeyPress{stroke.key}, {stroke.shift, stroke.ctrl, stroke.alt}, seconds);
    app_.update(seconds);
  }
  const bool leaves = in_field && (enter || stroke.key == key::escape || stroke.key == key::tab);
  if (leaves || app_.state().dialog.has_value() != in_dialog) queue_.wait_for_field();
  return in_field && !printable;
}

void InputRouter::feed(ImGuiIO& io, const Held& held, double seconds) {
  io.KeyShift = held.shift;
  io.KeyCtrl = held.ctrl;
  io.KeyAlt = held.alt;
  queue_.feed(io, [&](const KeyStroke& stroke) { return do_key(stroke, seconds); });
}

}  // namespace homolog
