#pragma once

#include <string>

namespace homolog {

/// Which side of the body a structure is of.
enum class Side { none, left, right };

/// The side that a name says: "kidney_left", "Left kidney", "L_hip", "hip.r". In the name of a level of the spine, such
/// as "L 4", only whole words say one.
Side side_in(const std::string& name);
/// The name that the same structure of the other side has: left and right exchanged. Empty where it names no side.
std::string name_of_other_side(const std::string& name);

}  // namespace homolog
