#include "core/structures/maps/structures_in_map.h"

#include <doctest/doctest.h>

#include "core/structures/naming/level_names.h"

namespace homolog {

namespace {

/// A set of structures without templates.
TemplateSet set_of(const std::vector<std::string>& names) {
  TemplateSet set;
  for (const std::string& name : names) {
    TemplateOfSet one;
    one.name = name;
    one.value = static_cast<int>(set.structures.size()) + 1;
    set.structures.push_back(one);
  }
  return set;
}

/// A row of voxels with the labels 11, 12, … of these names.
VolumeRead row_of(const std::vector<std::string>& names) {
  VolumeRead map;
  std::vector<std::uint8_t> voxels;
  for (const std::string& name : names) {
    const int value = 11 + static_cast<int>(voxels.size());
    voxels.push_back(static_cast<std::uint8_t>(value));
    map.segmentation.add({.name = name, .value = value});
  }
  map.volume.geometry.dims = {static_cast<int>(voxels.size()), 1, 1};
  map.volume.data = std::move(voxels);
  return map;
}

/// The values of the labels that the structures of the set are; 0: the map lacks it.
std::vector<int> values_in(const std::vector<std::string>& set, const std::vector<std::string>& map) {
  std::vector<int> values;
  for (const StructureInMap& one : find_in_map(set_of(set), row_of(map)).structures)
    values.push_back(one.is_there() ? one.segment.value : 0);
  return values;
}

}  // namespace

TEST_CASE("a vertebra is found by its level where no label has its name") {
  CHECK(values_in({"vertebrae_L3", "disc_L2_L3", "vertebrae_L4"}, {"L4", "L3"}) == std::vector{12, 0, 11});
  CHECK(values_in({"L3", "L4"}, {"vertebrae_L3", "disc_L3_L4", "Vertebra L4"}) == std::vector{11, 13});
  CHECK(values_in({"vertebrae_L1", "vertebrae_S1"}, {"T13", "L6"}) == std::vector{0, 0});
  // A name that is nearer goes before a level, on both sides.
  CHECK(values_in({"vertebrae_L3"}, {"L3", "L3 vertebrae"}) == std::vector{12});
  CHECK(values_in({"vertebrae_L3", "L3"}, {"l3"}) == std::vector{0, 11});
  const SetInMap doubled = find_in_map(set_of({"vertebrae_L3"}), row_of({"L3", "Wirbel L3"}));
  CHECK_FALSE(doubled.structures[0].is_there());
  CHECK(doubled.structures[0].why_left_out.find("11 and 12 both have its name") != std::string::npos);
  CHECK(find_in_map(set_of({"vertebrae_L3"}), row_of({"L3", "disc_L3_L4"})).without_template ==
        std::vector<std::string>{"disc_L3_L4"});
}

TEST_CASE("what is found by its value alone is told, unless its name is no more than that") {
  VolumeRead map = row_of({"", "", ""});
  TemplateSet set = set_of({"liver", "label 12", "spleen"});
  for (TemplateOfSet& one : set.structures) one.value += 10;
  const SetInMap found = find_in_map(set, map);
  for (const StructureInMap& one : found.structures) CHECK(one.by_value);
  CHECK(found_by_values(set, found) ==
        "gives no names, so labels were taken by the set's values: liver (11), spleen (13); if these are other "
        "structures, put their names beside the map");
  map = row_of({"liver", "label 12", "spleen"});
  CHECK(found_by_values(set, find_in_map(set, map)).empty());
}

TEST_CASE("a level alone is the vertebra's name and no other structure's") {
  CHECK(is_same_vertebra("L3", "vertebrae_L3"));
  CHECK(is_same_vertebra("Vertebra T12", "t12"));
  CHECK_FALSE(is_same_vertebra("L3", "vertebrae_L4"));
  CHECK_FALSE(is_same_vertebra("L3", "disc_L3"));
  CHECK_FALSE(is_same_vertebra("L3_L4", "vertebrae_L3"));
  CHECK_FALSE(is_same_vertebra("vertebrae_L3_arch", "L3"));
  CHECK_FALSE(is_same_vertebra("T13", "L1"));
  CHECK_FALSE(is_same_vertebra("liver", "liver"));
}

}  // namespace homolog
