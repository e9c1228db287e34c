#pragma once

#include <array>
#include <string>
#include <vector>

#include "app/editor/widgets/theme.h"

namespace homolog {

// The controls of the panels and bars, in Homolog's own look. Each draws at ImGui's cursor over the available width
// unless it says otherwise, and shows `tip` on hover. A control that is not possible gets the reason in `refusal` and
// is then disabled, with the reason as its tip.

void tooltip(const Theme& theme, const std::string& text);

/// A section of the side panel with a title that folds it; true while it is open. `open` is what it is now;
/// `toggled` is set where the user clicked.
bool section(const Theme& theme, const char* title, bool open, bool& toggled);

bool button(const Theme& theme, const std::string& label, const std::string& tip, const std::string& refusal = {},
            float width_px = 0, bool primary = false);
/// A square button of one icon, for bars; lit where `selected`.
bool icon_button(const Theme& theme, const char* glyph, const char* id, const std::string& tip,
                 const std::string& refusal = {}, bool selected = false, float size_units = 32);
/// A switch with its label; true when it was turned (value is then the new one).
bool toggle(const Theme& theme, const char* label, bool& value, const std::string& tip,
            const std::string& refusal = {});
/// One of several choices in a row; true when another was chosen.
bool choice(const Theme& theme, const char* id, const std::vector<std::string>& labels, int& chosen,
            const std::vector<std::string>& tips, const std::string& refusal = {});

struct SliderRange {
  double low = 0, high = 1;
  const char* format = "%.1f";
  const char* unit = "";
  bool logarithmic = false;
};
/// Label, track and value with unit in a row; the value can be typed after a click on it. `released` is set when the
/// change is finished (the mouse let go, Enter pressed).
bool slider(const Theme& theme, const char* label, double& value, const SliderRange& range, const std::string& tip,
            bool& released, const std::string& refusal = {});
/// A right-aligned number that is dragged sideways or typed.
bool number_field(const Theme& theme, const char* id, double& value, double per_px, const char* format,
                  const char* unit, float width_px, const std::string& tip, bool& released);

/// A line of text to type; true while it changes.
bool text_field(const Theme& theme, const char* id, std::string& text, const char* hint, float width_px);
/// Whether Enter ended the typing in the field drawn last.
bool enter_pressed();

/// "Label        12.3 mm" with the value at the right edge.
void figure(const Theme& theme, const char* label, const std::string& value, const std::string& tip = {},
            ImU32 colour = palette::text);
/// A paragraph in dim text.
void explanation(const Theme& theme, const std::string& text);
void caption(const Theme& theme, const char* text);
void rule(const Theme& theme);
void gap(const Theme& theme, float units);
/// A bar that fills as work goes on, as wide as there is room.
void progress_bar(const Theme& theme, double fraction);

ImVec2 text_size(ImFont* font, const std::string& text);

/// The text with its middle left out where it is wider; nothing where not even the dots fit.
std::string shortened(const std::string& text, float width_px);

/// printf into a string.
std::string format(const char* pattern, ...) __attribute__((format(printf, 1, 2)));

}  // namespace homolog
