#include "core/volume/labels/named_labels.h"

#include <cmath>

#include "core/base/text/text.h"

namespace homolog {

std::optional<int> label_in(std::string_view text) {
  const auto value = as_number<int>(trimmed(text));
  return value && *value >= 0 ? value : std::nullopt;
}

Result<void> add_name(int value, std::string_view text, std::optional<LabelColour> colour, Segmentation& labels) {
  const std::string name = segment_name(text);
  if (value <= 0 || name.empty()) return {};
  const Segment* known = labels.find(value, 0);
  if (known != nullptr && known->name != name)
    return fail("", "gives label " + std::to_string(value) + " two names (" + excerpt(known->name) + " and " +
                        excerpt(name) + ")");
  labels.add({.name = name, .value = value, .layer = 0, .colour = colour});
  return {};
}

std::optional<LabelColour> colour_in(std::span<const std::string_view> channels) {
  std::array<double, 3> numbers{};
  bool shares = true, point = false;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto number = as_number<double>(trimmed(channels[c]));
    if (!number || !(*number >= 0 && *number <= 255)) return {};
    numbers[c] = *number;
    shares = shares && *number <= 1;
    point = point || channels[c].find('.') != std::string_view::npos;
  }
  LabelColour colour{};
  for (std::size_t c = 0; c < 3; ++c)
    colour[c] = static_cast<std::uint8_t>(std::lround(shares && point ? 255 * numbers[c] : numbers[c]));
  return colour;
}

}  // namespace homolog
