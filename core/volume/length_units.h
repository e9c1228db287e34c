#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace homolog {

/// Millimetres in a unit of length as headers name it ("mm", "cm", "m", "um", "µm", "micron", "inch", "millimeters", …,
/// in any case); nothing where the name is none or unknown.
std::optional<double> mm_per_unit(const std::string& name);

/// The same where a volume says nothing or something else: 1, and `warnings` names what it says.
double mm_or_warn(const std::filesystem::path& path, const std::string& name, std::vector<std::string>& warnings);

/// Seconds in a unit of time ("s", "ms", "us", "min", …, in any case); nothing where the name is none or unknown.
std::optional<double> seconds_per_unit(const std::string& name);

}  // namespace homolog
