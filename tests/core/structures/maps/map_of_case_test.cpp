#include "core/structures/maps/map_of_case.h"

#include <doctest/doctest.h>

#include "core/case/actions/history_marks.h"
#include "core/mesh/voxels/voxelise.h"
#include "tests/stones.h"

// A label map as a case has it after a repair and a hand.

namespace homolog {

namespace {

std::vector<std::uint8_t>& voxels_of(VolumeRead& map) {
  return std::get<std::vector<std::uint8_t>>(map.volume.data);
}
const std::vector<std::uint8_t>& voxels_of(const VolumeRead& map) {
  return std::get<std::vector<std::uint8_t>>(map.volume.data);
}

Mesh grown(int k) {
  return stone_at(1.04 * place_of(k), radius_of(k), 1.05);
}

/// The five stones as a case, each fitted exactly, as the map has them.
struct StonesInCase {
  VolumeRead map = stone_map();
  Document document;
  KeptMapFit fit;

  StonesInCase() {
    const SetOfTemplates set = stone_set();
    for (int k = 0; k < stones; ++k) {
      Structure one = new_structure(set.templates[static_cast<std::size_t>(k)], {});
      one.id = "s" + std::to_string(k + 1);
      one.name = one.label = name_of_stone(k);
      document.structures.push_back(std::make_shared<const Structure>(std::move(one)));
      move(k, grown(k).points);
      InFittedMap in;
      in.name = name_of_stone(k);
      in.value = k + 1;
      in.mesh = mesh_hash(grown(k).points);
      fit.structures["s" + std::to_string(k + 1)] = in;
    }
  }
  InFittedMap& in(int k) { return fit.structures["s" + std::to_string(k + 1)]; }
  void move(int k, const Points& points) {
    document.change("s" + std::to_string(k + 1), [&](Structure& one) {
      Shape shape = *one.shape(0);
      shape.points = std::make_shared<const Points>(points);
      one.set_shape(0, std::move(shape));
    });
  }
  Result<VolumeRead> written() const {
    Progress progress;
    return map_of_case(document, map, fit, progress);
  }
};

/// Takes the stones' voxels below a height away: how many.
std::size_t cut_below(VolumeRead& map, int label, double below_mm) {
  std::size_t count = 0, v = 0;
  const auto& dims = map.volume.geometry.dims;
  for (int k = 0; k < dims[2]; ++k)
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i, ++v)
        if (voxels_of(map)[v] == label && map.volume.geometry.to_mm(Vec3(i, j, k)).z() < below_mm) {
          voxels_of(map)[v] = 0;
          ++count;
        }
  return count;
}

std::size_t different(const VolumeRead& a, const VolumeRead& b) {
  std::size_t count = 0;
  for (std::size_t v = 0; v < voxels_of(a).size(); ++v) count += voxels_of(a)[v] != voxels_of(b)[v] ? 1 : 0;
  return count;
}

}  // namespace

TEST_CASE("a map whose structures nobody changed is written as it was read, to the voxel") {
  StonesInCase stones_in_case;
  // Voxels that no structure of the case has stay too, and a label that differs from its mesh.
  voxels_of(stones_in_case.map)[5] = 77;
  cut_below(stones_in_case.map, 2, 1.04 * place_of(1).z() - 10);
  const auto written = stones_in_case.written();
  REQUIRE(written);
  CHECK(different(*written, stones_in_case.map) == 0);
  CHECK(written->segmentation.segments.size() == stones_in_case.map.segmentation.segments.size());
}

TEST_CASE("what a repair proposes is written to the voxel, and what was taken back is not") {
  StonesInCase stones_in_case;
  const VolumeRead whole = stones_in_case.map;
  const std::size_t third = cut_below(stones_in_case.map, 3, 1.04 * place_of(2).z());
  const VolumeRead cut_once = stones_in_case.map;
  const std::size_t fourth = cut_below(stones_in_case.map, 4, 1.04 * place_of(3).z());
  REQUIRE(third > 1000);
  REQUIRE(fourth > 1000);
  stones_in_case.fit.changes = voxel_changes(stones_in_case.map, whole);
  auto written = stones_in_case.written();
  REQUIRE(written);
  CHECK(different(*written, whole) == 0);

  const Points before = grown(3).points.rowwise() + Eigen::RowVector3d(0, 0, 3);
  stones_in_case.in(3).as_read.assign(before.data(), before.data() + before.size());
  stones_in_case.move(3, before);
  written = stones_in_case.written();
  REQUIRE(written);
  CHECK(different(*written, whole) == fourth);
  CHECK(different(*written, stones_in_case.map) == third);

  // One that the repair filled in and that somebody took away again.
  stones_in_case.in(2).was_missing = true;
  std::erase_if(stones_in_case.document.structures, [](const auto& one) { return one->id == "s3"; });
  written = stones_in_case.written();
  REQUIRE(written);
  CHECK(different(*written, stones_in_case.map) == 0);

  // Another map than the one that was repaired.
  voxels_of(stones_in_case.map) = voxels_of(whole);
  const auto refused = stones_in_case.written();
  REQUIRE_FALSE(refused);
  CHECK(refused.error().what == "is not the label map that was repaired; fit the set to it again");
}

TEST_CASE("a structure that was changed has the voxels within its mesh and its neighbours keep theirs") {
  StonesInCase stones_in_case;
  const Points moved = grown(2).points.rowwise() + Eigen::RowVector3d(0, 0, 9);
  stones_in_case.move(2, moved);
  const auto written = stones_in_case.written();
  REQUIRE(written);
  const auto third = voxelise({grown(2).topology, moved}, stones_in_case.map.volume.geometry);
  const auto fourth = voxelise(grown(3), stones_in_case.map.volume.geometry);
  std::size_t meeting = 0;
  for (std::size_t v = 0; v < third.size(); ++v) {
    const int label = voxels_of(*written)[v], before = voxels_of(stones_in_case.map)[v];
    if (third[v] != 0 && fourth[v] != 0) ++meeting;
    CHECK_MESSAGE(label == (third[v] != 0 && fourth[v] == 0 ? 3 : before == 3 ? 0 : before), "voxel ", v);
    if (label != (third[v] != 0 && fourth[v] == 0 ? 3 : before == 3 ? 0 : before)) break;
  }
  CHECK(meeting > 100);
}

TEST_CASE("levels that were renamed have the values of their new names, and a name is given once") {
  StonesInCase stones_in_case;
  const auto rename = [&](const char* id, const std::string& name) {
    stones_in_case.document.change(id, [&](Structure& one) { one.name = one.label = name; });
  };
  rename("s5", "vertebrae_L6");
  rename("s4", "vertebrae_L5");
  const auto written = stones_in_case.written();
  REQUIRE(written);
  std::size_t wrong = 0;
  for (std::size_t v = 0; v < voxels_of(*written).size(); ++v) {
    const int before = voxels_of(stones_in_case.map)[v];
    wrong += voxels_of(*written)[v] != (before == 4 ? 5 : before == 5 ? 6 : before) ? 1 : 0;
  }
  CHECK(wrong == 0);
  REQUIRE(written->segmentation.find(6) != nullptr);
  CHECK(written->segmentation.find(6)->name == "vertebrae_L6");
  CHECK(written->segmentation.find(5)->name == "vertebrae_L5");

  rename("s5", "vertebrae_L5");
  rename("s4", "vertebrae_L5");
  const auto refused = stones_in_case.written();
  REQUIRE_FALSE(refused);
  CHECK(refused.error().sentence() ==
        "vertebrae_L5: would be the name of two labels of the map; rename the structure, or fit the other label too");
}

TEST_CASE("a structure that the map lacks is added with a name and a value of its own") {
  StonesInCase stones_in_case;
  cut_below(stones_in_case.map, 5, 1000);
  std::erase_if(stones_in_case.map.segmentation.segments, [](const Segment& one) { return one.value == 5; });
  stones_in_case.fit.structures.erase("s5");
  stones_in_case.document.change("s5", [](Structure& one) {
    one.name = one.label = "mine";
    one.colour = {{1, 2, 3}};
  });
  const auto written = stones_in_case.written();
  REQUIRE(written);
  REQUIRE(written->segmentation.find(5) != nullptr);
  CHECK(written->segmentation.find(5)->name == "mine");
  CHECK(written->segmentation.find(5)->colour == std::array<std::uint8_t, 3>{1, 2, 3});
  CHECK(different(*written, stone_map()) == 0);
}

}  // namespace homolog
