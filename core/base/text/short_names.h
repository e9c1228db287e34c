#pragma once

#include <functional>
#include <string>
#include <vector>

namespace homolog {

/// Whether a text fits into the room that there is.
using TextFits = std::function<bool(const std::string& text)>;

/// The text with its middle left out where it does not fit; nothing where not even the dots fit.
std::string shortened(const std::string& text, const TextFits& fits);

/// As shortened() for one of several names, so that it is not taken for another: its words are cut short ("body ant.
/// sup.") where each is still known among the others; else what it shares with them is left out. Numbers stay whole
/// where there is room for them.
std::string shortened_among(const std::string& name, const std::vector<std::string>& names, const TextFits& fits);

}  // namespace homolog
