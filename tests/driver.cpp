#include "tests/driver.h"

#include <backends/imgui_impl_opengl3.h>
#include <doctest/doctest.h>
#include <imgui.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <utility>

#include "core/session/case_file.h"
#include "render/offscreen.h"
#include "tests/must.h"
#include "tests/wait.h"

namespace homolog {

namespace {

constexpr double frame_seconds = 1.0 / 60;
/// Between two things that a person does: long enough that two clicks are no double click.
constexpr double pause_seconds = 1;

/// Whether `path` ends in `name`, from one of its parts on.
bool ends_in(const std::string& path, std::string_view name) {
  if (!path.ends_with(name)) return false;
  return path.size() == name.size() || path[path.size() - name.size() - 1] == '/';
}

std::string first_part(const std::string& path) {
  return path.substr(0, path.find('/'));
}

bool is_seen(const DrawnItem& item) {
  return item.seen.width >= std::min(item.rect.width, 4.0f) && item.seen.height >= std::min(item.rect.height, 4.0f) &&
         item.seen.height >= 0.5f * item.rect.height;
}

}  // namespace

Driver::Driver(Document document) : Driver(std::move(document), Size()) {}

Driver::Driver(Document document, const Size& size) : size_(size) {
  app_.start_without_pictures(size.scale);
  app_.start_session(test::must(create_case(document, folder() / "case.homolog")));
  state().preferences.hints = {true, true, true};
  frames(3);
}

Driver::~Driver() {
  if (has_pictures_) ImGui_ImplOpenGL3_Shutdown();
}

Picture Driver::picture() {
  if (!std::exchange(has_pictures_, true)) {
    ImGui_ImplOpenGL3_Init("#version 330 core");
    REQUIRE(app_.start_drawing(size_.scale));
  }
  const auto framebuffer = test::must(Framebuffer::make(size_.width_px, size_.height_px, 1));
  // A list or a text that appears has its size in the second frame.
  for (int k = 0; k < 2 || app_.draws_on(); ++k) {
    framebuffer->bind();
    frame();
  }
  return framebuffer->read();
}

std::vector<const DrawnItem*> Driver::found(std::string_view name) const {
  std::vector<const DrawnItem*> all;
  for (const DrawnItem& item : items())
    if (item.is_control() && ends_in(item.path, name)) all.push_back(&item);
  return all;
}

const DrawnItem& Driver::control(std::string_view name) const {
  const auto all = found(name);
  if (all.size() == 1) return *all.front();
  std::string others;
  for (const DrawnItem& item : items())
    if (item.is_control() && (all.empty() || ends_in(item.path, name))) others += "\n  " + item.path;
  FAIL((all.empty() ? "no control is called \"" : "several controls are called \"")
       << name << "\"; there are:" << others);
  return *all.front();
}

bool Driver::shows(std::string_view words) const {
  return std::any_of(items().begin(), items().end(), [&](const DrawnItem& item) {
    return item.seen.width > 0 && item.name.find(words) != std::string::npos;
  });
}

void Driver::pause() {
  next_frame_seconds_ = pause_seconds;
  frame();
}

void Driver::frame() {
  const double passed = next_frame_seconds_ > 0 ? std::exchange(next_frame_seconds_, 0) : frame_seconds;
  seconds_ += passed;
  app_.update(seconds_);
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = {static_cast<float>(size_.width_px), static_cast<float>(size_.height_px)};
  io.DeltaTime = static_cast<float>(passed);
  input_.feed(io, held_, seconds_);
  drawn_.clear();
  app_.draw(size_.width_px, size_.height_px, 0);
}

void Driver::frames(int count) {
  // Until the input is taken in, and then as many.
  for (int waited = 0; input_.busy() && waited < 1000; ++waited) frame();
  for (int k = 0; k < count; ++k) frame();
}

void Driver::resize(const Size& size) {
  if (size.scale != size_.scale) app_.set_scale(size.scale);
  size_ = size;
  frames(2);
}

void Driver::settle() {
  wait_until("the program is at rest", [&] { return app_.at_rest() && !input_.busy(); });
}

void Driver::wait_until(const char* what, const std::function<bool()>& done) {
  const bool reached = test::wait_until([&] {
    if (done()) return true;
    frame();
    return false;
  });
  if (!reached) {
    std::string notices;
    for (const Notice& notice : state().notices) notices += "\n  " + notice.text;
    FAIL("still not: " << std::string(what) << "; the program says:" << notices);
  }
  frames(3);
}

void Driver::move(double x_px, double y_px) {
  x_px_ = x_px;
  y_px_ = y_px;
  input_.move(x_px, y_px, held_, seconds_);
  frames(2);
}

void Driver::button(MouseButton button, bool down) {
  input_.button(button, down, held_, seconds_);
  frames(2);
}

void Driver::wheel(double steps) {
  input_.wheel(steps, held_, seconds_);
  frames(2);
}

void Driver::scroll_to(std::string_view name) {
  constexpr int most_turns = 200;
  for (int turn = 0; turn < most_turns; ++turn) {
    const DrawnItem wanted = control(name);
    if (is_seen(wanted)) return;
    // The wheel turns what is under the pointer: something else of the same part of the window.
    const auto beside = std::find_if(items().begin(), items().end(), [&](const DrawnItem& item) {
      return item.is_control() && is_seen(item) && first_part(item.path) == first_part(wanted.path) &&
             std::abs(item.rect.x - wanted.rect.x) < wanted.rect.width + item.rect.width;
    });
    if (beside == items().end()) FAIL(wanted.path << " is out of sight, and nothing beside it can be scrolled");
    const RectPx at = beside->seen;
    const bool below = wanted.rect.y > at.y;
    move(at.x + at.width / 2, at.y + at.height / 2);
    wheel(below ? -1 : 1);
  }
  FAIL(name << " could not be scrolled into view");
}

void Driver::point_at(std::string_view name) {
  pause();
  if (!in_a_hurry_) settle();
  scroll_to(name);
  const DrawnItem& wanted = control(name);
  move(wanted.seen.x + wanted.seen.width / 2, wanted.seen.y + wanted.seen.height / 2);
  if (!control(name).hovered) FAIL(control(name).path << " is covered by something else");
}

void Driver::press_and_let_go() {
  button(MouseButton::left, true);
  button(MouseButton::left, false);
}

void Driver::click(std::string_view name) {
  point_at(name);
  if (const DrawnItem& wanted = control(name); !wanted.enabled)
    FAIL(wanted.path << " cannot be clicked: " << wanted.tip);
  press_and_let_go();
  frames(3);
}

void Driver::double_click(std::string_view name) {
  point_at(name);
  press_and_let_go();
  press_and_let_go();
  frames(3);
}

void Driver::hold_and_move(std::string_view name, double right_px, double down_px) {
  point_at(name);
  button(MouseButton::left, true);
  constexpr int steps = 8;
  const double x_px = x_px_, y_px = y_px_;
  for (int k = 1; k <= steps; ++k) move(x_px + right_px * k / steps, y_px + down_px * k / steps);
}

void Driver::let_go() {
  button(MouseButton::left, false);
  frames(3);
}

void Driver::press(int key, const InputRouter::Held& held) {
  held_ = held;
  input_.press({key, held.shift, held.ctrl, held.alt}, seconds_);
  frames(3);
  held_ = {};
  input_.let_go(held_, seconds_);
  frames(3);
}

void Driver::type(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t length = lead < 0x80 ? 1 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
    unsigned int character = length == 1 ? lead : lead & (0xFFU >> (length + 1));
    for (std::size_t k = 1; k < length; ++k)
      character = (character << 6U) | (static_cast<unsigned char>(text[i + k]) & 0x3FU);
    input_.type(character);
    i += length;
  }
  frames(3);
}

const DrawnItem* Driver::at_keys() const {
  const auto found = std::find_if(items().begin(), items().end(), [](const DrawnItem& item) { return item.at_keys; });
  return found == items().end() ? nullptr : &*found;
}

void Driver::go_to(std::string_view name) {
  pause();
  settle();
  constexpr int most_parts = 12, most_controls = 150;
  const auto there = [&] { return at_keys() != nullptr && ends_in(at_keys()->path, name); };
  for (int part = 0; part < most_parts; ++part) {
    const std::string first = at_keys() != nullptr ? at_keys()->path : std::string();
    for (int k = 0; k < most_controls && !first.empty(); ++k) {
      if (there()) {
        if (!is_seen(*at_keys())) FAIL(at_keys()->path << " is reached by the keys, but is out of sight");
        return;
      }
      press(key::tab);
      if (at_keys() == nullptr || at_keys()->path == first) break;
    }
    if (!there()) press(key::f6);
  }
  FAIL("no key leads to " << std::string(name));
}

void Driver::type_into(std::string_view name, std::string_view text) {
  click(name);
  if (!ImGui::GetIO().WantTextInput) FAIL(control(name).path << " takes no text");
  press('A', {false, true, false});
  type(text);
}

int Driver::lines_with(std::string_view text) const {
  std::ifstream file(case_file());
  int count = 0;
  for (std::string line; std::getline(file, line);) count += line.find(text) != std::string::npos;
  return count;
}

}  // namespace homolog
