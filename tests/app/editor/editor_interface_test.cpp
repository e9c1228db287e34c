#include <doctest/doctest.h>
#include <imgui.h>

#include <string>
#include <vector>

#include "app/editor/update/controls.h"
#include "app/editor/widgets/imgui_context.h"
#include "app/editor/widgets/plots.h"
#include "app/editor/widgets/widgets.h"
#include "app/editor/window/input_queue.h"

namespace homolog {

TEST_CASE("keys and characters reach a field in the order they were typed and none is lost") {
  ImGuiIO io;
  InputQueue queue;
  std::vector<int> pressed;
  const auto frame = [&] {
    io.InputQueueCharacters.resize(0);
    queue.feed(io, [&](const KeyStroke& stroke) {
      pressed.push_back(stroke.key);
      return true;
    });
    std::string characters;
    for (const ImWchar c : io.InputQueueCharacters) characters += static_cast<char>(c);
    return characters;
  };
  queue.wait_for_field();
  queue.press({'A', false, true, false});
  for (const char c : {'a', 'b'}) queue.type(static_cast<unsigned char>(c));
  for (int i = 0; i < 2; ++i) queue.press({key::enter});
  queue.type('c');
  while (pressed.empty()) CHECK(frame().empty());
  CHECK(io.KeysDown['A']);
  CHECK(io.KeyCtrl);
  CHECK(frame() == "ab");
  CHECK_FALSE(io.KeysDown['A']);
  CHECK(io.KeysDown[key::enter]);
  CHECK(frame().empty());
  CHECK_FALSE(io.KeysDown[key::enter]);
  CHECK(frame().empty());
  CHECK(io.KeysDown[key::enter]);
  CHECK(frame() == "c");
  CHECK(pressed == std::vector<int>{'A', key::enter, key::enter});
  CHECK_FALSE(queue.busy());
}

TEST_CASE("a press counts where it was and a drag is let go after its last move however fast they come") {
  ImGuiIO io;
  InputQueue queue;
  const auto feed = [&] { queue.feed(io, [](const KeyStroke&) { return false; }); };
  queue.move(5, 5);
  queue.move(10, 10);
  queue.button(MouseButton::left, true);
  queue.move(20, 20);
  queue.move(40, 40);
  queue.button(MouseButton::left, false);
  queue.wheel(2);
  queue.move(60, 60);
  feed();
  CHECK(io.MousePos.x == 10);
  CHECK(io.MouseDown[0]);
  feed();
  CHECK(io.MousePos.x == 40);
  CHECK(io.MouseDown[0]);
  feed();
  CHECK_FALSE(io.MouseDown[0]);
  CHECK(io.MousePos.x == 40);
  feed();
  CHECK(io.MouseWheel == 2);
  CHECK(io.MousePos.x == 40);
  CHECK(queue.busy());
  feed();
  CHECK(io.MousePos.x == 60);
  CHECK_FALSE(queue.busy());
}

TEST_CASE("a text is shortened to any room") {
  const ImGuiAlone imgui;
  make_theme(1);
  ImGui::GetIO().DisplaySize = {800, 600};
  ImGui::NewFrame();
  const std::string not_utf8 = "\x80\x81", dots = "\xe2\x80\xa6";
  CHECK(shortened("", -5) == "");
  CHECK(shortened(not_utf8, -5) == "");
  CHECK(shortened("kidney", -5) == "");
  CHECK(shortened("kidney", 500) == "kidney");
  const std::string some = shortened("left kidney", 60);
  CHECK(some.starts_with("l"));
  CHECK(some.ends_with("y"));
  CHECK(some.find(dots) != std::string::npos);
  CHECK(shortened_among("left kidney of a horse", {"left kidney of a horse"}, 60) ==
        shortened("left kidney of a horse", 60));
  ImGui::EndFrame();
}

TEST_CASE("the marks of an axis are round and reach its end") {
  CHECK(axis_marks(0.93, 5) == std::vector<double>{0, 0.2, 0.4, 0.2 * 3, 0.8, 1});
  CHECK(axis_marks(100, 5) == std::vector<double>{0, 20, 40, 60, 80, 100});
  CHECK(axis_marks(0, 3).back() >= 1);
}

}  // namespace homolog
