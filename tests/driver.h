#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "app/editor/widgets/drawn_items.h"
#include "app/editor/widgets/imgui_context.h"
#include "app/editor/window/editor_app.h"
#include "app/editor/window/input_router.h"
#include "tests/environment_variable.h"
#include "tests/temporary_folder.h"

namespace homolog {

/// The editor as a person uses it, without a window and without pictures: finds each control by what is written on it,
/// points, clicks and types through the same functions as the window's callbacks, and looks at what the program shows.
/// A control is named by the end of its path: "Add", or "hilum/factor" where several are called so; see
/// DrawnItem::path. What cannot be done as asked fails the test with a sentence.
class Driver {
 public:
  struct Size {
    int width_px = 1280, height_px = 800;
    float scale = 1;
  };
  /// With a case of `document`, kept at case_file(). Everything that the program keeps lies in folder().
  explicit Driver(Document document);
  Driver(Document document, const Size& size);
  ~Driver();
  Driver(const Driver&) = delete;
  Driver& operator=(const Driver&) = delete;

  // The screen's content.

  /// Controls and texts of the latest frame.
  const std::vector<DrawnItem>& items() const { return drawn_.items(); }
  const DrawnItem& control(std::string_view name) const;
  bool has(std::string_view name) const { return !found(name).empty(); }
  /// Whether a text that holds these words is on the screen.
  bool shows(std::string_view words) const;
  /// The control that is marked as what the keys operate; null where none is.
  const DrawnItem* at_keys() const;
  /// The window as it is now. Needs an OpenGL context that is current until the driver is gone.
  Picture picture();

  // The hands.

  void click(std::string_view name);
  void double_click(std::string_view name);
  /// Puts the pointer on a control; scrolls it into view first.
  void point_at(std::string_view name);
  /// Takes hold of a control and moves by that much; let_go() ends it.
  void hold_and_move(std::string_view name, double right_px, double down_px);
  void let_go();
  void move(double x_px, double y_px);
  void button(MouseButton button, bool down);
  void wheel(double steps);
  void press(int key, const InputRouter::Held& held = {});
  /// Shift, Ctrl or Alt stay down while the mouse works, until other ones are.
  void hold_keys(const InputRouter::Held& held) { held_ = held; }
  void type(std::string_view text);
  /// Brings the keys to a control by pressing them: F6 to its part of the window, then Tab.
  void go_to(std::string_view name);
  /// Clicks on a field or a number and types a text in place of what it holds; no Enter.
  void type_into(std::string_view name, std::string_view text);

  // Time.

  void frame();
  void frames(int count);
  /// The window gets another size, or goes to a monitor of another scale.
  void resize(const Size& size);
  /// Goes on until all that was asked for is done, and the screen stays as it is. The hands do so before they move,
  /// as a person waits until nothing shifts under the pointer, unless they are in a hurry.
  void settle();
  void hurry(bool in_a_hurry) { in_a_hurry_ = in_a_hurry; }
  /// Goes on until `done`; fails where that takes longer than a healthy machine needs.
  void wait_until(const char* what, const std::function<bool()>& done);

  // The program.

  EditorApp& app() { return app_; }
  EditorState& state() { return app_.state(); }
  const Document& document() const { return *app_.snapshot().document; }
  const std::filesystem::path& folder() const { return home_.folder.path; }
  const std::filesystem::path& case_file() const { return app_.snapshot().file; }
  /// How many lines of the case's file hold `text`.
  int lines_with(std::string_view text) const;

 private:
  /// All that the program keeps goes into a folder of the test's own.
  struct Home {
    TemporaryFolder folder;
    EnvironmentVariable home{"HOME", folder.path}, state{"XDG_STATE_HOME", folder.path},
        config{"XDG_CONFIG_HOME", folder.path}, data{"XDG_DATA_HOME", folder.path};
  };
  std::vector<const DrawnItem*> found(std::string_view name) const;
  void scroll_to(std::string_view name);
  void pause();
  void press_and_let_go();

  Home home_;
  Size size_;
  double seconds_ = 0, next_frame_seconds_ = 0, x_px_ = 0, y_px_ = 0;
  bool in_a_hurry_ = false, has_pictures_ = false;
  InputRouter::Held held_;
  ImGuiAlone imgui_;
  DrawnItems drawn_;
  EditorApp app_{[] {}};
  InputRouter input_{app_};
};

}  // namespace homolog
