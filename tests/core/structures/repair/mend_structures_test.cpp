#include "core/structures/repair/mend_structures.h"
#include "core/structures/fitting/neighbours_say.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "tests/must.h"
#include "tests/stones.h"

// What is done about the signs of a map, with signs that are put in by hand: how little is too little to touch it.

namespace homolog {

namespace {

/// A sound map, its fits, and signs that say nothing yet.
struct Signed {
  VolumeRead map;
  RepairedMap found;

  explicit Signed(VolumeRead read, const SetOfTemplates& of = set()) : map(std::move(read)) {
    found.subject = find_in_map(of.set, map, 0);
    found.fitted = test::must(fit_set(of, found.subject, {}));
    found.expected = expected_shapes(of, found.subject, found.fitted);
    found.signs.resize(stones);
    found.structures.resize(stones);
  }
  static const SetOfTemplates& set() {
    static const SetOfTemplates stones = stone_set();
    return stones;
  }
  bool has(std::size_t k, DefectKind kind) const {
    return std::ranges::any_of(found.structures[k].defects, [&](const Defect& one) { return one.kind == kind; });
  }
  Signed& mend() {
    mend_structures(set(), map, 0, {}, found);
    return *this;
  }
  template <class Change>
  static Signed with(const Change& change) {
    static const Signed sound(stone_map(1));  // the fits take seconds
    Signed made = sound;
    change(made.found);
    return std::move(made.mend());
  }
};

/// Where the voxels of a label lie.
std::vector<std::size_t> voxels_of_label(const VolumeRead& map, int label) {
  std::vector<std::size_t> found;
  std::visit(
      [&](const auto& voxels) {
        for (std::size_t v = 0; v < voxels.size(); ++v)
          if (rounded_label(voxels[v]) == label) found.push_back(v);
      },
      map.volume.data);
  return found;
}

/// The stones, the third one without its lower half.
VolumeRead map_without_a_half() {
  VolumeRead map = stone_map(1);
  const std::vector<std::size_t> voxels = voxels_of_label(map, 3);
  std::visit(
      [&](auto& all) {
        for (std::size_t v = 0; v < voxels.size() / 2; ++v) all[voxels[v]] = 0;
      },
      map.volume.data);
  return map;
}

}  // namespace

TEST_CASE("a little comes back only from a neighbour that shows too much") {
  const auto lost_to_sound = [](RepairedMap& found) { found.signs[2].lost_to[3] = 0.08; };
  const Signed sound = Signed::with(lost_to_sound);
  CHECK_FALSE(sound.has(2, DefectKind::given_to_neighbour));
  CHECK_FALSE(sound.has(3, DefectKind::taken_from_neighbour));
  CHECK(sound.map.volume.data == stone_map(1).volume.data);
  for (const auto& too_much : std::vector<void (*)(StructureSigns&)>{
           [](StructureSigns& signs) { signs.bridges = 0.01; }, [](StructureSigns& signs) { signs.bars = 0.01; },
           [](StructureSigns& signs) { signs.islands = 0.04; }, [](StructureSigns& signs) { signs.volume = 0.12; }}) {
    const Signed swollen = Signed::with([&](RepairedMap& found) {
      lost_to_sound(found);
      too_much(found.signs[3]);
    });
    CHECK(swollen.has(2, DefectKind::given_to_neighbour));
    CHECK(swollen.has(3, DefectKind::taken_from_neighbour));
  }
  CHECK(Signed::with([&](RepairedMap& found) {
          lost_to_sound(found);
          found.fitted.structures[3].judgement.doubtful = true;
        }).has(2, DefectKind::given_to_neighbour));
  // Of a neighbour of which nothing is expected, as its template is cut off, doubt tells nothing.
  const Signed cut = Signed::with([&](RepairedMap& found) {
    lost_to_sound(found);
    found.fitted.structures[3].judgement.doubtful = true;
    found.expected[3].reset();
  });
  CHECK_FALSE(cut.has(2, DefectKind::given_to_neighbour));
  CHECK(cut.map.volume.data == stone_map(1).volume.data);
  // Nor does what its fit leaves out, which may be what the template lacks.
  for (const bool is_cut : {false, true}) {
    CAPTURE(is_cut);
    const Signed left_out = Signed::with([&](RepairedMap& found) {
      lost_to_sound(found);
      found.signs[3].bridges = 0.017;
      found.expected[3].reset();
      if (is_cut) found.fitted.structures[3].fit->template_cuts.emplace_back();
    });
    CHECK(left_out.has(2, DefectKind::given_to_neighbour) == !is_cut);
    CHECK(left_out.has(3, DefectKind::bridge) == !is_cut);
  }
}

TEST_CASE("what a small structure lost shows on it however large its neighbour is") {
  for (const double lost : {0.08, 0.12})
    CHECK(Signed::with([&](RepairedMap& found) {
            found.signs[2].lost_to[3] = lost;
          }).has(2, DefectKind::given_to_neighbour) == (lost > 0.1));
}

TEST_CASE("a part that a neighbour has is found by the template bent to the rest") {
  // The third stone is a small one with a horn, and the outer half of that has the fourth one's name. No sign says that
  // it is lost, as with a rib that is bent otherwise.
  const auto horned = [](Mesh stone, double growth) {
    const Vec3 middle = stone.points.colwise().mean().transpose();
    for (Eigen::Index v = 0; v < stone.points.rows(); ++v) {
      const double along = (stone.points.row(v).transpose() - middle).normalized().y();
      stone.points(v, 1) += growth * 90 * std::max(0.0, along - 0.75);
    }
    return stone;
  };
  SetOfTemplates set = stone_set();
  const Mesh own = horned(stone_at(place_of(2), radius_of(2) / 2, 1), 1);
  set.templates[2] = test::must(make_template({own.points, own.topology->triangles()}, name_of_stone(2)));
  VolumeGeometry grid = stone_map(1).volume.geometry;
  std::vector<MeshOfSegment> meshes;
  for (int k = 0; k < stones; ++k) {
    const Mesh stone = stone_at(1.04 * place_of(k), radius_of(k) / (k == 2 ? 2 : 1), 1.05);
    meshes.push_back({{name_of_stone(k), k + 1, 0, {}, {}}, k == 2 ? horned(stone, 1.05) : stone});
  }
  const VolumeRead truth = map_of_meshes(meshes, grid).map;
  VolumeRead map = truth;
  std::size_t given = 0;
  std::visit(
      [&](auto& all) {
        using Voxel = typename std::decay_t<decltype(all)>::value_type;
        for (const std::size_t v : voxels_of_label(truth, 3))
          if (place_of_voxel(grid, v).y() > bounds_of(own.points).max().y() - 12) all[v] = Voxel{4}, ++given;
      },
      map.volume.data);
  REQUIRE(given > 100);
  const Signed begun(map, set);
  for (const double volume : {-0.05, -0.25}) {
    CAPTURE(volume);
    Signed made = begun;
    made.found.signs[2].volume = volume;
    mend_structures(set, made.map, 0, {}, made.found);
    CHECK(made.has(2, DefectKind::given_to_neighbour) == (volume < -0.1));
    CHECK(made.has(3, DefectKind::taken_from_neighbour) == (volume < -0.1));
    const auto left = voxels_of_label(truth, 3).size() - voxels_of_label(made.map, 3).size();
    CHECK(left <= (volume < -0.1 ? given / 10 : given));
  }
}

TEST_CASE("half is missing where much lacks and the volume is small or where very much lacks") {
  const Signed halved(map_without_a_half());
  const auto half_is_missing = [&](double lacking, double volume, double gap = 0) {
    Signed made = halved;
    made.found.signs[2].lacking = lacking;
    made.found.signs[2].volume = volume;
    made.found.signs[2].gap = gap;
    return made.mend().has(2, DefectKind::half_missing);
  };
  CHECK_FALSE(half_is_missing(0.17, 0));
  CHECK(half_is_missing(0.17, -0.3));
  CHECK(half_is_missing(0.22, 0));  // what is left was swollen by something else
  CHECK_FALSE(half_is_missing(0.1, -0.3));
  // A long part that is thin, as a spinous process.
  CHECK(half_is_missing(0.1, 0, 0.6));
  CHECK_FALSE(half_is_missing(0.1, 0, 0.3));
  CHECK_FALSE(half_is_missing(0.03, 0, 0.6));
}

TEST_CASE("what lies beside its expected shape lacks nothing") {
  // As a rib that is bent otherwise: much of the expected shape is empty, and nothing of the shape itself.
  const Signed bent = Signed::with([](RepairedMap& found) { found.signs[2].lacking = 0.4; });
  CHECK_FALSE(bent.has(2, DefectKind::half_missing));
  CHECK(bent.map.volume.data == stone_map(1).volume.data);
}

TEST_CASE("what lacks is filled in, but not where the rest lies in two large parts") {
  const VolumeRead map = map_without_a_half();
  const Signed halved(map);
  const auto filled = [&](double islands) {
    Signed made = halved;
    made.found.signs[2].lacking = 0.4;
    made.found.signs[2].islands = islands;
    CHECK(made.mend().has(2, DefectKind::half_missing));
    return voxels_of_label(made.map, 3).size() - voxels_of_label(map, 3).size();
  };
  CHECK(filled(0) > voxels_of_label(map, 3).size() / 2);
  CHECK(filled(0.2) == 0);
}

TEST_CASE("a few voxels that lie apart are islands where they are many parts") {
  for (const int specks : {3, 6}) {
    CAPTURE(specks);
    VolumeRead map = stone_map(1);
    std::visit(
        [&](auto& all) {
          using Voxel = typename std::decay_t<decltype(all)>::value_type;
          for (int k = 0; k < specks; ++k) all[map.volume.geometry.index(80, 60, 70 + 4 * k)] = Voxel{3};
        },
        map.volume.data);
    Signed made(map);
    made.found.signs =
        structure_signs(Signed::set(), made.map, 0, made.found.subject, made.found.fitted, made.found.expected);
    CHECK(made.found.signs[2].specks == static_cast<std::size_t>(specks));
    CHECK(made.found.signs[2].islands < 0.0005);
    made.mend();
    CHECK(made.has(2, DefectKind::island) == (specks > 5));
    if (specks > 5) CHECK(made.map.volume.data == stone_map(1).volume.data);
  }
}

TEST_CASE("of a bridge with a thin part only the thin part goes") {
  const std::vector<std::size_t> voxels = voxels_of_label(stone_map(1), 3);
  const VoxelChange thick{voxels.front(), 3, 0}, thin{voxels.back(), 3, 0};
  const auto left = [&](double bars) {
    const Signed mended = Signed::with([&](RepairedMap& found) {
      StructureSigns& signs = found.signs[2];
      signs.bridges = 0.05;
      signs.bars = bars;
      signs.without_bridges = {thick, thin};
      if (bars > 0) signs.without_bars = {thin};
    });
    CHECK(mended.has(2, DefectKind::bridge));
    return voxels.size() - voxels_of_label(mended.map, 3).size();
  };
  CHECK(left(0.01) == 1);
  CHECK(left(0) == 2);
}

TEST_CASE("a structure in two bodies has doubled what a small part of it fills") {
  // A tenth of where the third one is missing has the fourth one's label.
  VolumeRead map = stone_map(1);
  const std::vector<std::size_t> voxels = voxels_of_label(map, 3);
  std::visit(
      [&](auto& all) {
        using Voxel = typename std::decay_t<decltype(all)>::value_type;
        for (std::size_t v = 0; v < voxels.size(); ++v) all[voxels[v]] = Voxel(v < voxels.size() / 10 ? 4 : 0);
      },
      map.volume.data);
  const Signed begun(map);
  for (const double islands : {0.02, 0.35}) {
    CAPTURE(islands);
    Signed made = begun;
    made.found.signs[3].islands = islands;
    made.found.fitted.structures[3].judgement.doubtful = true;
    made.mend();
    CHECK(made.has(2, DefectKind::missing));
    CHECK(made.has(3, DefectKind::doubled) == (islands > 0.3));
  }
}

TEST_CASE("a large one on which its template lies well has no second body") {
  // Two fifths of where the third one is missing have the fourth one's label.
  VolumeRead map = stone_map(1);
  const std::vector<std::size_t> voxels = voxels_of_label(map, 3);
  std::visit(
      [&](auto& all) {
        using Voxel = typename std::decay_t<decltype(all)>::value_type;
        for (std::size_t v = 0; v < voxels.size(); ++v) all[voxels[v]] = Voxel(5 * v < 2 * voxels.size() ? 4 : 0);
      },
      map.volume.data);
  const Signed begun(map);
  for (const double dice : {0.97, 0.8}) {
    CAPTURE(dice);
    Signed made = begun;
    made.found.signs[3].volume = 0.5;
    made.found.fitted.structures[3].judgement.doubtful = false;
    made.found.fitted.structures[3].judgement.inside_scan.dice = dice;
    made.mend();
    CHECK(made.has(3, DefectKind::doubled) == (dice < 0.9));
  }
}

TEST_CASE("an island at the border of the scan does not say that its structure is cut off") {
  const auto at_border = [](int height) {
    VolumeRead map = stone_map(1);
    std::visit(
        [&](auto& all) {
          using Voxel = typename std::decay_t<decltype(all)>::value_type;
          const auto& dims = map.volume.geometry.dims;
          for (int z = 0; z < height; ++z)
            for (int y = 20; y < 40; ++y)
              for (int x = 30; x < 50; ++x) all[static_cast<std::size_t>(x + dims[0] * (y + dims[1] * z))] = Voxel{3};
        },
        map.volume.data);
    const Signed made(map);
    return structure_signs(Signed::set(), made.map, 0, made.found.subject, made.found.fitted, made.found.expected)[2];
  };
  const StructureSigns signs = at_border(4);
  CHECK(signs.islands > 0.03);
  CHECK(signs.at_border == 0);
}

}  // namespace homolog
