#include "app/editor/window/input_router.h"

#include <imgui.h>

#include "app/editor/widgets/imgui_context.h"

namespace homolog {

namespace {

/// A text in front, as the list of keys, is scrolled by keys.
bool scrolls_text(int code) {
  constexpr float all = 1000;
  KeyFocus& keys = key_focus();
  switch (code) {
    case key::up:
      return keys.scroll_text(-1, 0);
    case key::down:
      return keys.scroll_text(1, 0);
    case key::page_up:
      return keys.scroll_text(0, -1);
    case key::page_down:
      return keys.scroll_text(0, 1);
    case key::home:
      return keys.scroll_text(0, -all);
    case key::end:
      return keys.scroll_text(0, all);
    default:
      return false;
  }
}

}  // namespace

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
  key_pointer_.hide();
  controls_memory().pointer_by_keys = false;
  key_focus().let_mouse_speak();
  move_to(x_px, y_px, held, seconds);
}

void InputRouter::move_to(double x_px, double y_px, const Held& held, double seconds) {
  x_px_ = x_px;
  y_px_ = y_px;
  queue_.move(static_cast<float>(x_px), static_cast<float>(y_px));
  send(MouseMove{}, held, seconds);
}

void InputRouter::button(MouseButton button, bool down, const Held& held, double seconds) {
  key_focus().leave();
  press_button(button, down, held, seconds);
}

void InputRouter::press_button(MouseButton button, bool down, const Held& held, double seconds) {
  queue_.button(button, down);
  // A click beside an open list closes it, and edits nothing in the view where it was made.
  if (down && close_menus_beside(x_px_, y_px_) && app_.layout().view_at(x_px_, y_px_) && !interface_at(x_px_, y_px_))
    return;
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
  if (queue_.keys_wait() || ImGui::GetIO().WantTextInput || menus_open()) queue_.type(character);
}

bool InputRouter::give_to_controls(const KeyStroke& stroke, bool in_field) {
  using Way = KeyFocus::Way;
  KeyFocus& keys = key_focus();
  keys.let_keys_speak();
  if (stroke.alt) return false;
  if (stroke.key == key::tab && in_field) {
    keys.leave_field(stroke.shift ? Way::previous : Way::next);
    queue_.wait_for_field();
    return true;
  }
  if (in_field) return false;
  if (stroke.key == key::f6 && !keys.in_front()) {
    keys.go_to_group(!stroke.shift);
    return true;
  }
  if (scrolls_text(stroke.key)) return true;
  // The list of files has these keys, wherever the others are.
  const bool lists_files = app_.state().dialog && std::holds_alternative<FileDialog>(*app_.state().dialog);
  if (!keys.takes_keys() || (lists_files && (stroke.key == key::up || stroke.key == key::down))) return false;
  switch (stroke.key) {
    case key::tab:
      keys.go(stroke.shift ? Way::previous : Way::next);
      return true;
    case key::up:
      keys.go(Way::up);
      return true;
    case key::down:
      keys.go(Way::down);
      return true;
    case key::left:
    case key::right:
      if (stroke.ctrl && keys.at_number())
        keys.step(stroke.key == key::right ? 1 : -1);
      else
        keys.go(stroke.key == key::right ? Way::right : Way::left);
      return true;
    case key::home:
      keys.go(Way::first);
      return true;
    case key::end:
      keys.go(Way::last);
      return true;
    case key::enter:
    case key::keypad_enter:
    case ' ':
      // A blank may be a part of what is searched for.
      if (!keys.at_control() || (stroke.key == ' ' && !controls_memory().searched.empty())) return false;
      keys.activate();
      queue_.wait_for_field();
      return true;
    case key::escape:
      if (keys.in_front()) return false;
      keys.leave();
      return true;
    default:
      return false;
  }
}

bool InputRouter::give_to_pointer(const KeyStroke& stroke, double seconds) {
  if (app_.state().dialog) return false;
  const auto acts = key_pointer_.press(stroke, app_);
  controls_memory().pointer_by_keys = key_pointer_.shown();
  if (!acts) return false;
  const Held held{stroke.shift, stroke.ctrl, stroke.alt}, none;
  for (const KeyPointer::Act& act : *acts)
    if (const auto* move = std::get_if<KeyPointer::Move>(&act))
      move_to(move->x_px, move->y_px, {stroke.shift, false, stroke.alt}, seconds);
    else if (const auto* button = std::get_if<KeyPointer::Button>(&act))
      press_button(button->button, button->down, none, seconds);
    else
      wheel(std::get<KeyPointer::Wheel>(act).steps, held, seconds);
  return true;
}

bool InputRouter::do_key(const KeyStroke& stroke, double seconds) {
  const bool in_field = ImGui::GetIO().WantTextInput, in_dialog = app_.state().dialog.has_value();
  const bool enter = stroke.key == key::enter || stroke.key == key::keypad_enter;
  const bool printable = stroke.key < key::escape && !stroke.ctrl;
  if (stroke.key == key::escape && !in_field && close_menus()) return false;
  if (give_to_controls(stroke, in_field)) return false;
  // An open list is searched for what is typed, and no key does anything behind it.
  if (!in_field && menus_open()) {
    if (stroke.key == key::backspace) erase_searched();
    return false;
  }
  if (!in_field && give_to_pointer(stroke, seconds)) return false;
  // A field that is typed into keeps its keys; a dialog's list is moved through all the same.
  if (!in_field || (in_dialog && !printable && !enter)) {
    send(KeyPress{stroke.key}, {stroke.shift, stroke.ctrl, stroke.alt}, seconds);
    app_.update(seconds);
  }
  if (stroke.key == key::escape)
    if (const auto button = key_pointer_.let_go()) press_button(*button, false, {}, seconds);
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
