#pragma once

namespace homolog {

/// Keys by GLFW's codes: printable ones are their capital letter in ASCII.
namespace key {
inline constexpr int escape = 256, enter = 257, tab = 258, backspace = 259, insert = 260, del = 261, right = 262,
                     left = 263, down = 264, up = 265, page_up = 266, page_down = 267, home = 268, end = 269, f1 = 290,
                     f6 = 295, keypad_enter = 335;
}

}  // namespace homolog
