#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "app/editor/state/layout.h"
#include "app/editor/widgets/theme.h"

namespace homolog {

// The controls and texts of the panels and bars, in Homolog's own look: all of the program's go through here, so that a
// test can find and operate each (see drawn_items.h). Each draws at ImGui's cursor over the available width unless it
// says otherwise, and shows `tip` on hover. A control that is not possible gets the reason in `refusal` and is then
// disabled, with the reason as its tip.

/// A part of the window while it lives. Its name tells its controls from others of the same label; `of` says what the
/// name is of where the case gave it: Part("hilum", "region").
class Part {
 public:
  explicit Part(const std::string& name, const char* of = nullptr);
  ~Part();
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;
};

/// Whether the control that ImGui made last is to be explained: the pointer is over it, or the keys have reached it.
bool is_explained(ImGuiHoveredFlags hovered = 0);
void tooltip(const Theme& theme, const std::string& text);

/// A section of the side panel with a title that folds it; true while it is open. `open` is what it is now;
/// `toggled` is set where the user clicked. While it is folded, `holds` says what is in it.
bool section(const Theme& theme, const char* title, bool open, bool& toggled, const std::string& holds = {});

struct ButtonOptions {
  std::string refusal{};
  float width_px = 0;    ///< 0: as wide as the label asks for
  bool primary = false;  ///< lit: what one does next
};
bool button(const Theme& theme, const std::string& label, const std::string& tip, const ButtonOptions& options);
inline bool button(const Theme& theme, const std::string& label, const std::string& tip,
                   const std::string& refusal = {}, float width_px = 0) {
  return button(theme, label, tip, ButtonOptions{.refusal = refusal, .width_px = width_px});
}
/// A square button of one icon, for bars; lit where `selected`.
bool icon_button(const Theme& theme, const char* glyph, const char* id, const std::string& tip,
                 const std::string& refusal = {}, bool selected = false, float size_units = 32);
/// A switch with its label; true when it was turned (value is then the new one).
bool toggle(const Theme& theme, const char* label, bool& value, const std::string& tip,
            const std::string& refusal = {});
struct ChoiceOptions {
  std::vector<std::string> tips{};      ///< of each
  std::string refusal{};                ///< why none can be chosen
  std::vector<std::string> refusals{};  ///< why each cannot
};
/// One of several choices in a row; true when another was chosen.
bool choice(const Theme& theme, const char* id, const std::vector<std::string>& labels, int& chosen,
            const ChoiceOptions& options);

struct SliderRange {
  double low = 0, high = 1;
  const char* format = "%.1f";
  const char* unit = "";
  bool logarithmic = false;
  bool whole = false;  ///< whole numbers only
};
/// Label, track and value with unit in a row; the value can be typed after a click on it. `released` is set when the
/// change is finished (the mouse let go, Enter pressed).
bool slider(const Theme& theme, const char* label, double& value, const SliderRange& range, const std::string& tip,
            bool& released, const std::string& refusal = {});
/// The limits of a number, and what it is called. A number that is typed beyond them is refused with a sentence; one
/// that is dragged stops there.
struct NumberLimits {
  double low = 0, high = 1;
  std::string name;    ///< "Scale"
  bool whole = false;  ///< whole numbers only
};
struct NumberOptions {
  double per_px = 1;  ///< what a px of a drag adds
  const char* format = "%.1f";
  const char* unit = "";
  float width_px = 0;
  std::string tip{};
  float height_units = 24;
  NumberLimits limits{};
};
/// A right-aligned number that is dragged sideways or typed. A typed value is taken when the typing ends: as it is, or
/// not at all. `released` is set when the change is finished.
bool number_field(const Theme& theme, const char* id, double& value, bool& released, const NumberOptions& options);

/// A line of text to type; true while it changes.
bool text_field(const Theme& theme, const char* name, std::string& text, const char* hint, float width_px,
                float height_units = 28);
/// Whether Enter ended the typing in the field drawn last.
bool enter_pressed();
/// Whether the typing in the field drawn last has ended, and changed its text.
bool field_left();

/// A list that opens to choose from; true when another was chosen. `swatches`: a colour before each option, or none.
bool combo(const Theme& theme, const char* name, const std::vector<std::string>& options, int& chosen,
           const std::vector<ImU32>& swatches = {});

/// The state of a place of the window that takes clicks.
struct AreaState {
  bool clicked = false, doubled = false, hovered = false;
};
struct AreaOptions {
  bool selected = false;
  bool lies_below = false;  ///< other controls lie on it
  bool all_buttons = false;
};
/// A place that takes clicks and is drawn by who asks for it: a row of a list, a surface to turn.
AreaState area(const Theme& theme, const std::string& name, ImVec2 size, const std::string& tip = {},
               const AreaOptions& options = {});
/// A row of a list with its text, `indent_px` from its left; `names` are the texts of all rows [shortened_among].
AreaState list_row(const Theme& theme, const std::string& text, bool selected, ImVec2 size, const std::string& tip = {},
                   float indent_px = 0, const std::vector<std::string>& names = {});

/// A list of commands over the window: open_menu() when its button is pressed, begin_menu() and, where that is true,
/// its items and end_menu().
void open_menu(const char* name);
bool begin_menu(const Theme& theme, const char* name);
bool menu_item(const Theme& theme, const char* label, const char* keys, const std::string& tip = {});
void menu_line();
void end_menu(const Theme& theme);

/// "Label        12.3 mm" with the value at the right edge.
void figure(const Theme& theme, const char* label, const std::string& value, const std::string& tip = {},
            ImU32 colour = palette::text);
/// A figure that leads somewhere: underlined, true where it was clicked.
bool figure_link(const Theme& theme, const char* label, const std::string& value, const std::string& tip, ImU32 colour);
/// A paragraph in dim text.
void explanation(const Theme& theme, const std::string& text);
void caption(const Theme& theme, const char* text);
/// Under a slider: what its two ends mean, in small dim text.
void slider_ends(const Theme& theme, const char* low, const char* high);
/// A square of a colour with a rim, so that white is seen on a light ground and black on a dark one.
void colour_swatch(ImDrawList& draw, const Theme& theme, ImVec2 low, float side_px, ImU32 colour);
void rule(const Theme& theme);
void gap(const Theme& theme, float units);
/// A bar that fills as work goes on, as wide as there is room.
void progress_bar(const Theme& theme, double fraction);

/// A room of two lines, always of the same height: a longer text is shortened and shown whole at the pointer.
void two_lines(const Theme& theme, const std::string& text, ImU32 colour);

/// Work that goes on: "Fitting".
struct WorkShown {
  std::string what;
  double fraction = 0;
  std::string cancel_tip;
};
/// The room below a button that starts work: two lines of text while it rests, else how far it is, with a button that
/// cancels it; true where that was pressed. Always of the same height, so that nothing moves under the pointer.
bool work_area(const Theme& theme, const std::string& at_rest, const std::optional<WorkShown>& running);
/// While it lives, digits of the font that is in use have one width: for numbers that change or stand in columns.
class EvenDigits {
 public:
  explicit EvenDigits(const Theme& theme) { ImGui::PushFont(theme.even_digits(ImGui::GetFont())); }
  ~EvenDigits() { ImGui::PopFont(); }
  EvenDigits(const EvenDigits&) = delete;
  EvenDigits& operator=(const EvenDigits&) = delete;
};

ImVec2 text_size(ImFont* font, const std::string& text);
/// Text at a px of the window in the font that is pushed, or in another; beyond `wrap_px` it goes on in the next line.
void text_at(ImDrawList& draw, ImVec2 at, ImU32 colour, const std::string& text);
void text_at(ImDrawList& draw, ImFont* font, ImVec2 at, ImU32 colour, const std::string& text, float wrap_px = 0);
/// Text that stays readable on any picture.
void shadowed_text(ImDrawList& draw, ImFont* font, ImVec2 at, ImU32 colour, const std::string& text);
/// Text at ImGui's cursor; one of lines that end at `end_px` of the panel (0: its edge).
void text_line(const std::string& text, ImU32 colour = palette::text);
void text_lines(const std::string& text, ImU32 colour = palette::text, float end_px = 0);

/// The text in lines no wider than that, broken at blanks, so that numbers stay whole. A word that is wider than a line
/// is broken behind a "/", and where it has none anywhere.
std::string in_lines(ImFont* font, const std::string& text, float width_px);

/// As in short_names.h, into a width in the font that is in use.
std::string shortened(const std::string& text, float width_px);
std::string shortened_among(const std::string& name, const std::vector<std::string>& names, float width_px);

/// As many whole sentences from the beginning as fit; where not one does, the first without its middle.
std::string whole_sentences(const std::string& text, float width_px);

/// printf into a string.
std::string format(const char* pattern, ...) __attribute__((format(printf, 1, 2)));

/// A borderless ImGui window that fills a rectangle of the layout, a part of the window by its name; end_region()
/// follows.
void begin_region(const char* name, const RectPx& rect, ImU32 colour, float padding_px = 0);
void end_region();

}  // namespace homolog
