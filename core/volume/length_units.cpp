#include "core/volume/length_units.h"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>
#include <utility>

#include "core/base/files/files.h"
#include "core/base/text/text.h"

namespace homolog {
namespace {

using Unit = std::pair<std::string_view, double>;

/// In lower case; names of several letters also with an s at the end.
constexpr std::array length_units{Unit{"mm", 1},
                                  Unit{"millimeter", 1},
                                  Unit{"millimetre", 1},
                                  Unit{"cm", 10},
                                  Unit{"centimeter", 10},
                                  Unit{"centimetre", 10},
                                  Unit{"dm", 100},
                                  Unit{"m", 1000},
                                  Unit{"meter", 1000},
                                  Unit{"metre", 1000},
                                  Unit{"um", 1e-3},
                                  Unit{"\xc2\xb5m", 1e-3},
                                  Unit{"\xce\xbcm", 1e-3},
                                  Unit{"\xb5m", 1e-3},
                                  Unit{"micron", 1e-3},
                                  Unit{"micrometer", 1e-3},
                                  Unit{"micrometre", 1e-3},
                                  Unit{"nm", 1e-6},
                                  Unit{"nanometer", 1e-6},
                                  Unit{"nanometre", 1e-6},
                                  Unit{"in", 25.4},
                                  Unit{"inch", 25.4},
                                  Unit{"inche", 25.4}};
constexpr std::array time_units{Unit{"s", 1},     Unit{"sec", 1},     Unit{"second", 1},
                                Unit{"ms", 1e-3}, Unit{"msec", 1e-3}, Unit{"millisecond", 1e-3},
                                Unit{"us", 1e-6}, Unit{"usec", 1e-6}, Unit{"microsecond", 1e-6},
                                Unit{"min", 60},  Unit{"minute", 60}};

std::optional<double> unit_value(std::span<const Unit> units, const std::string& name) {
  std::string wanted = lower_case(name);
  for (int attempt = 0; attempt < 2; ++attempt) {
    for (const auto& [unit, value] : units)
      if (unit == wanted) return value;
    constexpr std::size_t shortest_plural = 4;
    if (wanted.size() < shortest_plural || wanted.back() != 's') return {};
    wanted.pop_back();
  }
  return {};
}

}  // namespace

std::optional<double> mm_per_unit(const std::string& name) {
  return unit_value(length_units, name);
}

double mm_or_warn(const std::filesystem::path& path, const std::string& name, std::vector<std::string>& warnings) {
  if (const auto mm = mm_per_unit(name)) return *mm;
  if (name.find_first_not_of("? ") != std::string::npos) {
    const std::string warning =
        path.string() + ": gives lengths in " + excerpt(name) + ", which is no known unit; mm are assumed";
    if (std::find(warnings.begin(), warnings.end(), warning) == warnings.end()) warnings.push_back(warning);
  }
  return 1;
}

std::optional<double> seconds_per_unit(const std::string& name) {
  return unit_value(time_units, name);
}

}  // namespace homolog
