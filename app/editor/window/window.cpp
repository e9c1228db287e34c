#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <epoxy/gl.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <thread>
#include <utility>

#include "app/editor/widgets/imgui_context.h"
#include "app/editor/window/editor.h"
#include "app/editor/window/editor_app.h"
#include "app/editor/window/frame_rate.h"
#include "app/editor/window/input_router.h"
#include "app/editor/work/files/preferences.h"

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
  InputRouter* input = nullptr;
  Preferences kept;   ///< as the file has them
  std::string title;  ///< as the system shows it
  int frames_due = frames_per_event;

  static Window& of(GLFWwindow* handle) { return *static_cast<Window*>(glfwGetWindowUserPointer(handle)); }

  /// Events carry framebuffer px; the window system may count in larger units.
  std::pair<double, double> px(double x, double y) const {
    int width = 1, height = 1, pixels_x = 1, pixels_y = 1;
    glfwGetWindowSize(handle, &width, &height);
    glfwGetFramebufferSize(handle, &pixels_x, &pixels_y);
    return {x * pixels_x / std::max(width, 1), y * pixels_y / std::max(height, 1)};
  }
  InputRouter::Held held() const {
    const auto down = [&](int a, int b) {
      return glfwGetKey(handle, a) == GLFW_PRESS || glfwGetKey(handle, b) == GLFW_PRESS;
    };
    return {down(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT), down(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL),
            down(GLFW_KEY_LEFT_ALT, GLFW_KEY_RIGHT_ALT)};
  }
};

/// The window's input, with frames due to show what comes of it. No exception may pass GLFW, which is C.
template <class Give>
void give_input(GLFWwindow* handle, const Give& give) {
  Window& window = Window::of(handle);
  window.frames_due = frames_per_event;
  const auto given = guarded("", [&]() -> Result<void> {
    give(*window.input);
    return {};
  });
  if (!given) add_notice(window.app->state(), given.error().sentence());
}

InputRouter::Held held_in(int mods) {
  return {(mods & GLFW_MOD_SHIFT) != 0, (mods & GLFW_MOD_CONTROL) != 0, (mods & GLFW_MOD_ALT) != 0};
}

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

void install_mouse_callbacks(GLFWwindow* handle) {
  glfwSetCursorPosCallback(handle, [](GLFWwindow* w, double x, double y) {
    give_input(w, [&](InputRouter& input) {
      const auto [x_px, y_px] = Window::of(w).px(x, y);
      input.move(x_px, y_px, Window::of(w).held(), glfwGetTime());
    });
  });
  glfwSetCursorEnterCallback(handle, [](GLFWwindow* w, int entered) {
    if (entered == GLFW_FALSE) give_input(w, [](InputRouter& input) { input.leave(); });
  });
  glfwSetMouseButtonCallback(handle, [](GLFWwindow* w, int button, int action, int mods) {
    const auto known = button_of(button);
    if (!known) return;
    give_input(w,
               [&](InputRouter& input) { input.button(*known, action == GLFW_PRESS, held_in(mods), glfwGetTime()); });
  });
  glfwSetScrollCallback(handle, [](GLFWwindow* w, double, double steps) {
    give_input(w, [&](InputRouter& input) { input.wheel(steps, Window::of(w).held(), glfwGetTime()); });
  });
}

void install_key_callbacks(GLFWwindow* handle) {
  glfwSetKeyCallback(handle, [](GLFWwindow* w, int key, int, int action, int mods) {
    if (key == GLFW_KEY_UNKNOWN) return;
    give_input(w, [&](InputRouter& input) {
      const InputRouter::Held held = held_in(mods);
      if (action == GLFW_RELEASE)
        input.let_go(held, glfwGetTime());
      else
        input.press({key, held.shift, held.ctrl, held.alt}, glfwGetTime());
    });
  });
  glfwSetCharCallback(handle, [](GLFWwindow* w, unsigned int character) {
    give_input(w, [&](InputRouter& input) { input.type(character); });
  });
}

/// Not smaller than what the panels and bars need.
void limit_size(GLFWwindow* handle, float scale) {
  int width = 0, height = 0, pixels_x = 0, pixels_y = 0;
  glfwGetWindowSize(handle, &width, &height);
  glfwGetFramebufferSize(handle, &pixels_x, &pixels_y);
  if (pixels_x <= 0 || pixels_y <= 0) return;
  const auto in_window_units = [scale](int units, int size, int pixels) {
    return static_cast<int>(
        std::lround(static_cast<float>(units) * scale * static_cast<float>(size) / static_cast<float>(pixels)));
  };
  glfwSetWindowSizeLimits(handle, in_window_units(smallest_window_width, width, pixels_x),
                          in_window_units(smallest_window_height, height, pixels_y), GLFW_DONT_CARE, GLFW_DONT_CARE);
}

void install_window_callbacks(GLFWwindow* handle) {
  glfwSetDropCallback(handle, [](GLFWwindow* w, int count, const char** paths) {
    give_input(w, [&](InputRouter&) { Window::of(w).app->open({paths, paths + count}); });
  });
  glfwSetFramebufferSizeCallback(handle, [](GLFWwindow* w, int, int) { Window::of(w).frames_due = frames_per_event; });
  glfwSetWindowRefreshCallback(handle, [](GLFWwindow* w) { Window::of(w).frames_due = frames_per_event; });
  glfwSetWindowContentScaleCallback(handle, [](GLFWwindow* w, float x, float) {
    give_input(w, [&](InputRouter&) { Window::of(w).app->set_scale(x); });
    limit_size(w, x);
  });
}

void show_title(Window& window) {
  std::string title = window.app->title();
  if (title == window.title) return;
  glfwSetWindowTitle(window.handle, title.c_str());
  window.title = std::move(title);
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

/// One frame. Where drawing fails the window goes on with a sentence; where it fails again and again, the case is on
/// the disk, and the program ends with that sentence.
bool draw_frame(Window& window, int width, int height, double frames_per_second, int& failed_in_a_row) {
  const auto drawn = guarded("", [&]() -> Result<void> {
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    ImGui_ImplGlfw_NewFrame();
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = {static_cast<float>(width), static_cast<float>(height)};
    io.DisplayFramebufferScale = {1, 1};
    // In place of where ImGui's backend found the mouse just now: what it did, in its order.
    window.input->feed(io, window.held(), glfwGetTime());
    window.app->draw(width, height, frames_per_second);
    glfwSwapBuffers(window.handle);
    return {};
  });
  failed_in_a_row = drawn ? 0 : failed_in_a_row + 1;
  if (drawn) return true;
  end_broken_frame();
  constexpr int most = 10;
  if (failed_in_a_row < most) {
    add_notice(window.app->state(), drawn.error().sentence());
    window.frames_due = frames_per_event;
    return true;
  }
  std::fprintf(stderr, "homolog: the window cannot be drawn any more: %s Your edits are on the disk.\n",
               drawn.error().sentence().c_str());
  return false;
}

/// The sooner of a wait and of a time on the window's clock, as a wait in seconds; nothing where neither is given.
std::optional<double> sooner(std::optional<double> wait, std::optional<double> at) {
  if (!at) return wait;
  const double until = std::max(*at - glfwGetTime(), 0.0) + 1e-3;
  return std::min(wait.value_or(until), until);
}

/// Draws when there is something new, at most once in a display's period; sleeps otherwise.
bool run_loop(Window& window) {
  const double period = display_period_seconds();
  double drawn_at = 0;
  FrameRate rate;
  int failed_in_a_row = 0;
  while (!window.app->wants_to_quit()) {
    if (window.frames_due == 0) keep_preferences(window);
    if (window.frames_due > 0)
      glfwPollEvents();
    else if (const auto wait = sooner(window.app->next_move_seconds(glfwGetTime()), rate.ends_at()))
      glfwWaitEventsTimeout(std::max(*wait, period));
    else
      glfwWaitEvents();
    // The rate that the last picture speaks of is over.
    if (window.frames_due == 0 && rate.ends_at() && glfwGetTime() > *rate.ends_at()) window.frames_due = 1;
    if (glfwWindowShouldClose(window.handle)) {
      glfwSetWindowShouldClose(window.handle, GLFW_FALSE);
      window.app->ask_to_quit();
      window.frames_due = frames_per_event;
    }
    const auto& state = window.app->state();
    const std::size_t dialogs = state.notices.size() + (state.dialog ? 100 : 0);
    if (window.app->update(glfwGetTime())) window.frames_due = std::max(window.frames_due, 1);
    // What appears of itself has settled a few frames later too.
    if (dialogs != state.notices.size() + (state.dialog ? 100 : 0)) window.frames_due = frames_per_event;
    if (window.input->busy()) window.frames_due = frames_per_event;
    show_title(window);
    if (window.frames_due == 0) continue;
    const double wait = drawn_at + period - glfwGetTime();
    // What arrives meanwhile is taken in by this frame too.
    if (wait > 0) {
      std::this_thread::sleep_for(std::chrono::duration<double>(wait));
      glfwPollEvents();
      window.app->update(glfwGetTime());
    }
    const double now = glfwGetTime();
    drawn_at = now;
    --window.frames_due;

    int width = 0, height = 0;
    glfwGetFramebufferSize(window.handle, &width, &height);
    if (width == 0 || height == 0) continue;
    if (!draw_frame(window, width, height, rate.drawn(now), failed_in_a_row)) return false;
  }
  return true;
}

int show_window(GLFWwindow* handle, const EditorOptions& options, const Preferences& preferences) {
  glfwMakeContextCurrent(handle);
  glfwSwapInterval(0);
  Window window;
  window.handle = handle;
  glfwSetWindowUserPointer(handle, &window);
  const ImGuiOnOpenGl imgui;
  EditorApp app([] { glfwPostEmptyEvent(); });
  InputRouter input(app);
  window.app = &app;
  window.input = &input;
  app.state().preferences = window.kept = preferences;
  float scale = 1, scale_y = 1;
  glfwGetWindowContentScale(handle, &scale, &scale_y);
  if (auto started = app.start_drawing(scale); !started) {
    std::fprintf(stderr, "homolog: %s\n", started.error().sentence().c_str());
    return 1;
  }
  limit_size(handle, scale);
  ImGui_ImplGlfw_InitForOpenGL(handle, false);  // for the clipboard and the pointer's shapes
  install_mouse_callbacks(handle);
  install_key_callbacks(handle);
  install_window_callbacks(handle);
  app.start(options);
  const bool drawn = run_loop(window);

  keep_preferences(window);
  ImGui_ImplGlfw_Shutdown();
  return drawn ? 0 : 1;
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
    const auto shown = guarded("", [&]() -> Result<int> { return show_window(handle, options, preferences); });
    if (!shown) std::fprintf(stderr, "homolog: %s\n", shown.error().sentence().c_str());
    status = shown.value_or(1);
    glfwDestroyWindow(handle);
  }
  glfwTerminate();
  return status;
}

}  // namespace homolog
