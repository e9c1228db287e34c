#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "core/volume/labels/segmentation.h"

namespace homolog {

// Things that the readers of label_tables.h share.

using LabelColour = std::array<std::uint8_t, 3>;

/// A whole number of at least 0, with blanks around it or not.
std::optional<int> label_in(std::string_view text);

/// Adds a label's name; 0 is the background. Errors: another name is known of it.
Result<void> add_name(int value, std::string_view text, std::optional<LabelColour> colour, Segmentation& labels);

/// Red, green and blue as numbers of 0 to 255, or where all are at most 1 and one has a point as shares.
std::optional<LabelColour> colour_in(std::span<const std::string_view> channels);

}  // namespace homolog
