#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace homolog {

/// The kinds of defect that a structure of a label map can have.
enum class DefectKind {
  missing,               ///< no voxel of it, where its neighbours say that it is
  half_missing,          ///< a part of it has no label
  given_to_neighbour,    ///< a part of it has a neighbour's label
  taken_from_neighbour,  ///< it has a part of a neighbour
  level_shifted,         ///< it has the name of another level
  doubled,               ///< two structures have its name
  bridge,                ///< thin parts lead away from it
  hole,                  ///< a cavity or a tunnel that it should not have
  island,                ///< voxels apart from it
  sides_exchanged,       ///< left and right have each other's name
  cut_by_scan,           ///< the scan ends within it
  other                  ///< its form is not that of its template
};

/// Their names in reports, in their order.
inline constexpr std::array defect_names{
    "missing", "half_missing", "given_to_neighbour", "taken_from_neighbour", "level_shifted", "doubled", "bridge",
    "hole",    "island",       "sides_exchanged",    "cut_by_scan",          "other"};

inline const char* defect_name(DefectKind kind) {
  return defect_names[static_cast<std::size_t>(kind)];
}

/// The kind of a name; none where there is no such.
std::optional<DefectKind> defect_of_name(const std::string& name);

/// One thing that is wrong with a structure.
struct Defect {
  DefectKind kind = DefectKind::other;
  std::string with;  ///< the other structure's name; empty: none
};

/// The sentence on what was found, for a person: "Found: half missing, bridge." Needs one defect.
std::string sentence_of_defects(const std::vector<Defect>& defects);

}  // namespace homolog
