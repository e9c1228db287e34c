#include "app/editor/window/key_pointer.h"

#include <algorithm>

#include "app/editor/state/models/gallery.h"
#include "app/editor/update/controls.h"

namespace homolog {

namespace {

using Acts = std::vector<KeyPointer::Act>;

/// Where the pointer may be: the views of the case, or the gallery and the model; those that are not shown are empty.
std::vector<RectPx> places(const EditorApp& app) {
  const Layout& layout = app.layout();
  if (app.state().models.shown) {
    const ModelsLayout models = models_layout(layout);
    return {models.gallery, models.model};
  }
  return {layout.images.begin(), layout.images.end()};
}

/// Where it begins in a view: at the cross-hair.
Eigen::Vector2d start_in(const EditorApp& app, std::size_t place, const RectPx& rect) {
  const Eigen::Vector2d middle(rect.x + rect.width / 2, rect.y + rect.height / 2);
  if (app.state().models.shown) return middle;
  const ViewMap map = view_map(app.state(), app.layout(), *app.snapshot().document, all_views[place]);
  const auto at = map.to_px(app.state().look.crosshair_mm);
  return at && rect.contains(at->x(), at->y()) ? *at : middle;
}

}  // namespace

std::optional<Acts> KeyPointer::press(const KeyStroke& stroke, const EditorApp& app) {
  const bool plain = !stroke.ctrl && !stroke.alt;
  if (stroke.key == 'V' && plain && !stroke.shift && !down_) return to_next_view(app);
  if (!view_) return std::nullopt;
  switch (stroke.key) {
    case ' ':
      return press_button(stroke.shift ? MouseButton::right : stroke.ctrl ? MouseButton::middle : MouseButton::left);
    case key::enter:
    case key::keypad_enter:
      return click();
    case key::escape:
      if (down_) return std::nullopt;  // the program's own Escape gives up the drag
      hide();
      return Acts{};
    case key::page_up:
      return Acts{Wheel{1}};
    case key::page_down:
      return Acts{Wheel{-1}};
    default:
      return move(stroke, app);
  }
}

Acts KeyPointer::to_next_view(const EditorApp& app) {
  const std::vector<RectPx> all = places(app);
  const std::size_t first = view_ ? *view_ + 1 : 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const std::size_t next = (first + k) % all.size();
    if (all[next].width < 1 || all[next].height < 1) continue;
    view_ = next;
    const Eigen::Vector2d at = start_in(app, next, all[next]);
    x_px_ = at.x();
    y_px_ = at.y();
    return {Move{x_px_, y_px_}};
  }
  return {};
}

/// Presses a button, or lets go the one that is held.
Acts KeyPointer::press_button(MouseButton button) {
  if (const auto held = let_go()) return {Button{*held, false}};
  down_ = button;
  return {Button{button, true}};
}

Acts KeyPointer::click() {
  if (down_) return press_button(*down_);
  return {Button{MouseButton::left, true}, Button{MouseButton::left, false}};
}

std::optional<Acts> KeyPointer::move(const KeyStroke& stroke, const EditorApp& app) {
  const bool left = stroke.key == key::left, right = stroke.key == key::right, up = stroke.key == key::up,
             down = stroke.key == key::down;
  if (!left && !right && !up && !down) return std::nullopt;
  constexpr double units = 8, fine_units = 1;
  const double step_px = (stroke.ctrl ? fine_units : units) * static_cast<double>(app.layout().scale);
  const RectPx rect = places(app)[std::min(*view_, places(app).size() - 1)];
  const auto along = [&](bool back, bool on, double at, float low, float size) {
    const double first = static_cast<double>(low) + 1, last = static_cast<double>(low + size) - 1;
    const double to = at + (on ? step_px : back ? -step_px : 0);
    return std::clamp(to, first, std::max(first, last));  // a view that is hidden has no size
  };
  x_px_ = along(left, right, x_px_, rect.x, rect.width);
  y_px_ = along(up, down, y_px_, rect.y, rect.height);
  return Acts{Move{x_px_, y_px_}};
}

}  // namespace homolog
