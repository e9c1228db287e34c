#pragma once

#include <optional>
#include <string>

namespace homolog {

/// The level of the spine that a name says.
struct LevelName {
  std::string family;  ///< the name with '#' for each level that it says: "vertebrae_#", "disc_#_#"
  int level = 0;       ///< the first one, counted from C1 = 0
  bool sacral = false;
};

/// Reads "vertebrae_L3", "T12", "disc_L2_L3", "l5 body"; the ribs are of their vertebra's level: "rib_left_12". None
/// where a name says no level. L6 and T13 are variants: they count on, and share their number with what is below.
std::optional<LevelName> level_in_name(const std::string& name);
/// The level alone.
std::optional<int> level_of_name(const std::string& name);
/// Whether two names call one vertebra: "L3" and "vertebrae_L3". A level alone is its vertebra, not a disc or a rib.
bool is_same_vertebra(const std::string& a, const std::string& b);
/// A name with another level: "vertebrae_L4" of "vertebrae_L3", "disc_L3_L4" of "disc_L2_L3".
std::string name_at_level(const std::string& name, int level);

}  // namespace homolog
