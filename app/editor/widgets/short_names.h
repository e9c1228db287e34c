#pragma once

#include <functional>
#include <string>
#include <vector>

namespace homolog {

// The functions of widgets.h that make texts shorter, for whoever measures texts without ImGui.

/// Whether a text fits.
using TextFits = std::function<bool(const std::string& text)>;
std::string shortened(const std::string& text, const TextFits& fits);
std::string shortened_among(const std::string& name, const std::vector<std::string>& names, const TextFits& fits);

}  // namespace homolog
