#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>

#include "app/editor/editor.h"
#include "app/editor/editor_app.h"
#include "app/editor/state/preferences.h"
#include "app/editor/widgets/imgui_context.h"
#include "app/editor/window/key_queue.h"

namespace homolog {

namespace {

static_assert(key::escape == GLFW_KEY_ESCAPE && key::enter == GLFW_KEY_ENTER && key::f1 == GLFW_KEY_F1 &&
              key::up == GLFW_KEY_UP && key::page_down == GLFW_KEY_PAGE_DOWN && key::backspace == GLFW_KEY_BACKSPACE &&
              key::keypad_enter == GLFW_KEY_KP_ENTER && GLFW_KEY_A == 'A' && GLFW_KEY_1 == '1');

/// Frames drawn after each event: ImGui reacts to an event in the first and has settled in the third.
constexpr int frames_per_event = 3;

struct Window {
  GLFWwindow* handle = nullptr;
  EditorApp* app = nullptr;
  KeyQueue keys;
  Preferences kept;  ///< as the file has them
  int frames_due = frames_per_event;
  double cursor_x = 0,
         cursor_y = 0;  ///< of the latest event, in units of the window system; it may be elsewhere by now

  static Window& of(GLFWwindow* handle) { return *static_cast<Window*>(glfwGetWindowUserPointer(handle)); }

  /// Events carry framebuffer px; the window system may count in larger units.
  void send(decltype(InputEvent::what) what, int mods) {
    frames_due = frames_per_event;
    InputEvent event;
    event.what = what;
    int width = 1, height = 1, pixels_x = 1, pixels_y = 1;
    glfwGetWindowSize(handle, &width, &height);
    glfwGetFramebufferSize(handle, &pixels_x, &pixels_y);
    event.x_px = cursor_x * pixels_x / std::max(width, 1);
    event.y_px = cursor_y * pixels_y / std::max(height, 1);
    event.shift = (mods & GLFW_MOD_SHIFT) != 0;
    event.ctrl = (mods & GLFW_MOD_CONTROL) != 0;
    event.alt = (mods & GLFW_MOD_ALT) != 0;
    event.seconds = glfwGetTime();
    event.over_panel = !app->layout().view_at(event.x_px, event.y_px) || interface_at(event.x_px, event.y_px);
    app->handle(event);
    // A click may have gone to a field of the interface.
    const bool click = std::holds_alternative<MousePress>(what) || std::holds_alternative<MouseRelease>(what);
    if (event.over_panel && click) keys.wait_for_field();
  }
  /// Does what a key is for; true where a text field is to have it too.
  bool press(const KeyStroke& stroke) {
    const bool in_field = ImGui::GetIO().WantTextInput, in_dialog = app->state().dialog.has_value();
    const bool enter = stroke.key == GLFW_KEY_ENTER || stroke.key == GLFW_KEY_KP_ENTER;
    const bool printable = stroke.key < GLFW_KEY_ESCAPE && !stroke.ctrl;
    // A field that is typed into keeps its keys; a dialog's list is moved through all the same.
    if (!in_field || (in_dialog && !printable && !enter)) {
      send(KeyPress{stroke.key}, (stroke.shift ? GLFW_MOD_SHIFT : 0) | (stroke.ctrl ? GLFW_MOD_CONTROL : 0) |
                                     (stroke.alt ? GLFW_MOD_ALT : 0));
      app->update(glfwGetTime());
    }
    const bool leaves = in_field && (enter || stroke.key == GLFW_KEY_ESCAPE || stroke.key == GLFW_KEY_TAB);
    if (leaves || app->state().dialog.has_value() != in_dialog) keys.wait_for_field();
    return in_field && !printable;
  }
  int held_mods() const {
    const auto held = [&](int a, int b) {
      return glfwGetKey(handle, a) == GLFW_PRESS || glfwGetKey(handle, b) == GLFW_PRESS;
    };
    return (held(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT) ? GLFW_MOD_SHIFT : 0) |
           (held(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL) ? GLFW_MOD_CONTROL : 0) |
           (held(GLFW_KEY_LEFT_ALT, GLFW_KEY_RIGHT_ALT) ? GLFW_MOD_ALT : 0);
  }
};

std::optional<MouseButton> button_of(int button) {
  switch (button) {
    case GLFW_MOUSE_BUTTON_LEFT:
      return MouseButton::left;
    case GLFW_MOUSE_BUTTON_RIGHT:
      return MouseButton::right;
    case GLFW_MOUSE_BUTTON_MIDDLE:
      return MouseButton::middle;
    default:
      return std::nullopt;
  }
}

/// The views' events are taken here, as they come: at slow frame rates ImGui would lose presses. ImGui's own callbacks
/// are installed after these and call them first.
void install_callbacks(GLFWwindow* handle) {
  glfwSetCursorPosCallback(handle, [](GLFWwindow* w, double x, double y) {
    Window& window = Window::of(w);
    window.cursor_x = x;
    window.cursor_y = y;
    window.send(MouseMove{}, window.held_mods());
  });
  glfwSetMouseButtonCallback(handle, [](GLFWwindow* w, int button, int action, int mods) {
    const auto known = button_of(button);
    if (!known) return;
    if (action == GLFW_PRESS)
      Window::of(w).send(MousePress{*known}, mods);
    else
      Window::of(w).send(MouseRelease{*known}, mods);
  });
  glfwSetScrollCallback(handle, [](GLFWwindow* w, double, double steps) {
    Window& window = Window::of(w);
    window.send(Wheel{steps}, window.held_mods());
  });
  glfwSetDropCallback(handle, [](GLFWwindow* w, int count, const char** paths) {
    Window::of(w).app->open({paths, paths + count});
    Window::of(w).frames_due = frames_per_event;
  });
  glfwSetFramebufferSizeCallback(handle, [](GLFWwindow* w, int, int) { Window::of(w).frames_due = frames_per_event; });
  glfwSetWindowRefreshCallback(handle, [](GLFWwindow* w) { Window::of(w).frames_due = frames_per_event; });
  glfwSetWindowContentScaleCallback(handle, [](GLFWwindow* w, float x, float) {
    Window::of(w).app->set_scale(x);
    Window::of(w).frames_due = frames_per_event;
  });
}

/// The keyboard goes to ImGui through the queue; these take the place of ImGui's own callbacks.
void install_key_callbacks(GLFWwindow* handle) {
  glfwSetKeyCallback(handle, [](GLFWwindow* w, int key, int, int action, int mods) {
    Window& window = Window::of(w);
    if (key == GLFW_KEY_UNKNOWN) return;
    if (action == GLFW_RELEASE) return window.send(MouseMove{}, mods);
    const KeyStroke stroke{key, (mods & GLFW_MOD_SHIFT) != 0, (mods & GLFW_MOD_CONTROL) != 0,
                           (mods & GLFW_MOD_ALT) != 0};
    window.frames_due = frames_per_event;
    // At once where nothing is typed into: a key keeps its place among the mouse's events.
    if (window.keys.busy() || ImGui::GetIO().WantTextInput)
      window.keys.press(stroke);
    else
      window.press(stroke);
  });
  glfwSetCharCallback(handle, [](GLFWwindow* w, unsigned int character) {
    Window& window = Window::of(w);
    window.frames_due = frames_per_event;
    if (window.keys.busy() || ImGui::GetIO().WantTextInput) window.keys.type(character);
  });
}

double display_period_seconds() {
  const GLFWvidmode* mode = nullptr;
  if (GLFWmonitor* monitor = glfwGetPrimaryMonitor()) mode = glfwGetVideoMode(monitor);
  const int rate = mode != nullptr && mode->refreshRate > 0 ? mode->refreshRate : 60;
  return 1.0 / rate;
}

/// Writes the preferences where they changed: a program that is killed remembers them too.
void keep_preferences(Window& window) {
  Preferences now = window.app->state().preferences;
  // In layout units: the next start's window is made larger by the monitor's scale again.
  int width = 0, height = 0;
  float scale = 1, scale_y = 1;
  glfwGetFramebufferSize(window.handle, &width, &height);
  glfwGetWindowContentScale(window.handle, &scale, &scale_y);
  if (width > 0 && height > 0) {
    now.window_width = static_cast<int>(std::lround(static_cast<float>(width) / scale));
    now.window_height = static_cast<int>(std::lround(static_cast<float>(height) / scale_y));
  }
  if (now == window.kept) return;
  if (auto written = write_preferences(now, preferences_file()); !written)
    std::fprintf(stderr, "homolog: warning: %s\n", written.error().sentence().c_str());
  window.kept = std::move(now);
}

/// Draws when there is something new, at most once in a display's period; sleeps otherwise.
void run_loop(Window& window) {
  const double period = display_period_seconds();
  double drawn_at = 0, smoothed_period = 0;
  while (!window.app->wants_to_quit()) {
    if (window.frames_due == 0) keep_preferences(window);
    if (window.frames_due > 0)
      glfwPollEvents();
    else if (const auto wait = window.app->next_move_seconds(glfwGetTime()))
      glfwWaitEventsTimeout(std::max(*wait, period));
    else
      glfwWaitEvents();
    if (glfwWindowShouldClose(window.handle)) {
      glfwSetWindowShouldClose(window.handle, GLFW_FALSE);
      window.app->ask_to_quit();
      window.frames_due = frames_per_event;
    }
    if (window.app->update(glfwGetTime())) window.frames_due = std::max(window.frames_due, 1);
    if (window.keys.busy()) window.frames_due = frames_per_event;
    if (window.frames_due == 0) continue;
    const double wait = drawn_at + period - glfwGetTime();
    // What arrives meanwhile is taken in by this frame too.
    if (wait > 0) {
      std::this_thread::sleep_for(std::chrono::duration<double>(wait));
      glfwPollEvents();
      window.app->update(glfwGetTime());
    }
    const double now = glfwGetTime();
    const bool steady = now - drawn_at < 0.25;
    smoothed_period = steady && smoothed_period > 0 ? 0.9 * smoothed_period + 0.1 * (now - drawn_at) : now - drawn_at;
    drawn_at = now;
    --window.frames_due;

    int width = 0, height = 0;
    glfwGetFramebufferSize(window.handle, &width, &height);
    if (width == 0 || height == 0) continue;
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    ImGui_ImplGlfw_NewFrame();
    ImGuiIO& io = ImGui::GetIO();
    const int mods = window.held_mods();
    io.KeyShift = (mods & GLFW_MOD_SHIFT) != 0;
    io.KeyCtrl = (mods & GLFW_MOD_CONTROL) != 0;
    io.KeyAlt = (mods & GLFW_MOD_ALT) != 0;
    window.keys.feed(io, [&](const KeyStroke& stroke) { return window.press(stroke); });
    window.app->draw(width, height, steady ? 1 / smoothed_period : 0);
    glfwSwapBuffers(window.handle);
  }
}

int show_window(GLFWwindow* handle, const EditorOptions& options, const Preferences& preferences) {
  glfwMakeContextCurrent(handle);
  glfwSwapInterval(0);
  Window window;
  window.handle = handle;
  glfwSetWindowUserPointer(handle, &window);
  const ImGuiOnOpenGl imgui;
  EditorApp app([] { glfwPostEmptyEvent(); });
  window.app = &app;
  app.state().preferences = window.kept = preferences;
  float scale = 1, scale_y = 1;
  glfwGetWindowContentScale(handle, &scale, &scale_y);
  if (auto started = app.start_drawing(scale); !started) {
    std::fprintf(stderr, "homolog: %s\n", started.error().sentence().c_str());
    return 1;
  }
  install_callbacks(handle);
  ImGui_ImplGlfw_InitForOpenGL(handle, true);
  install_key_callbacks(handle);
  app.start(options);
  run_loop(window);

  keep_preferences(window);
  ImGui_ImplGlfw_Shutdown();
  return 0;
}

/// The window was last on a larger screen.
void fit_to_monitor(Preferences& preferences) {
  GLFWmonitor* monitor = glfwGetPrimaryMonitor();
  if (monitor == nullptr) return;
  int x = 0, y = 0, width = 0, height = 0;
  float scale = 1, scale_y = 1;
  glfwGetMonitorWorkarea(monitor, &x, &y, &width, &height);
  glfwGetMonitorContentScale(monitor, &scale, &scale_y);
  const auto fitted = [](int wanted, int room, float per_unit) {
    return room > 0 ? std::min(wanted, static_cast<int>(static_cast<float>(room) / per_unit)) : wanted;
  };
  preferences.window_width = fitted(preferences.window_width, width, scale);
  preferences.window_height = fitted(preferences.window_height, height, scale_y);
}

}  // namespace

int run_editor(const EditorOptions& options) {
  if (glfwInit() != GLFW_TRUE) {
    std::fprintf(stderr, "homolog: there is no display; set DISPLAY, or use a verb that needs none (see --help)\n");
    return 1;
  }
  Preferences preferences = read_preferences(preferences_file());
  fit_to_monitor(preferences);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  glfwWindowHintString(GLFW_X11_CLASS_NAME, "homolog");
  GLFWwindow* handle =
      glfwCreateWindow(preferences.window_width, preferences.window_height, "Homolog", nullptr, nullptr);
  int status = 1;
  if (handle == nullptr) {
    std::fprintf(stderr,
                 "homolog: this display offers no OpenGL 3.3; install libgl1-mesa-dri for software rendering\n");
  } else {
    status = show_window(handle, options, preferences);
    glfwDestroyWindow(handle);
  }
  glfwTerminate();
  return status;
}

}  // namespace homolog
