#include "core/structures/repair/repair.h"
#include "core/structures/fitting/neighbours_say.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <map>

#include "core/adapt/judge_fit.h"
#include "core/experiment/corrupt_labels.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/structures/fitting/structure_confidence.h"
#include "core/structures/naming/level_names.h"
#include "core/structures/naming/right_names.h"
#include "core/structures/repair/voxel_body.h"
#include "core/structures/set_model.h"
#include "tests/must.h"
#include "tests/refusal.h"
#include "tests/stones.h"

namespace homolog {

namespace {

const SetOfTemplates& the_set() {
  static const SetOfTemplates set = stone_set();
  return set;
}

std::vector<std::string> kinds_of(const RepairedStructure& one) {
  std::vector<std::string> kinds;
  for (const Defect& defect : one.defects) kinds.emplace_back(defect_name(defect.kind));
  return kinds;
}

bool has_kind(const RepairedStructure& one, DefectKind kind) {
  return std::ranges::any_of(one.defects, [&](const Defect& defect) { return defect.kind == kind; });
}

/// Dice of a label in two maps of one grid.
double dice_of(const VolumeRead& a, const VolumeRead& b, int value) {
  const auto voxels = [](const VolumeRead& map) {
    return std::visit([](const auto& all) { return std::vector<int>(all.begin(), all.end()); }, map.volume.data);
  };
  const auto first = voxels(a), second = voxels(b);
  double both = 0, sum = 0;
  for (std::size_t v = 0; v < first.size(); ++v) {
    both += first[v] == value && second[v] == value ? 2 : 0;
    sum += (first[v] == value) + (second[v] == value);
  }
  return both / sum;
}

/// The first of some seeds that changes something.
CorruptedLabels made_wrong(DefectKind kind, std::uint64_t first_seed, double voxel_mm = 1.5) {
  constexpr std::uint64_t most_seeds = 50;
  for (std::uint64_t seed = first_seed; seed < first_seed + most_seeds; ++seed)
    if (auto made = corrupt_labels(stone_map(voxel_mm), 3, kind, seed)) return std::move(*made);
  REQUIRE_MESSAGE(false, "no seed makes the map wrong: ", std::string(defect_name(kind)));
  return {};
}

/// What repair makes of a map in which one thing is wrong with the third stone.
struct Mended {
  CorruptedLabels wrong;
  VolumeRead map;
  RepairedMap found;

  Mended(DefectKind kind, std::uint64_t seed, double voxel_mm = 1.5) : wrong(made_wrong(kind, seed, voxel_mm)) {
    map = wrong.map;
    found = test::must(repair_map(the_set(), map, 0));
  }
};

void must_find_missing(const RepairedMap& found) {
  CHECK(has_kind(found.structures[2], DefectKind::missing));
}

}  // namespace

TEST_CASE("a map that is right has no defect and keeps every voxel") {
  const VolumeRead truth = stone_map();
  VolumeRead map = truth;
  const RepairedMap found = test::must(repair_map(the_set(), map, 0));
  CHECK(map.volume.data == truth.volume.data);
  for (const RepairedStructure& one : found.structures) {
    CHECK(kinds_of(one) == std::vector<std::string>{});
    CHECK(one.changed_voxels == 0);
    CHECK(one.confidence > 0.6);
    CHECK(one.p_named > 0.6);
  }
}

TEST_CASE("what is planted is found, by its name, and the map comes nearer to the truth") {
  struct Kind {
    DefectKind kind;
    double least_dice;  ///< after the repair
    double voxel_mm = 1.5;
  };
  for (const auto& [kind, least_dice, voxel_mm] :
       {Kind{DefectKind::missing, 0.85}, Kind{DefectKind::half_missing, 0.88, 1},
        Kind{DefectKind::given_to_neighbour, 0.95}, Kind{DefectKind::island, 0.999}, Kind{DefectKind::bridge, 0.98},
        Kind{DefectKind::hole, 0.99}}) {
    const VolumeRead truth = stone_map(voxel_mm);
    const Mended mended(kind, 3, voxel_mm);
    CAPTURE(std::string(defect_name(kind)));
    const StructureSigns& signs = mended.found.signs[2];
    CAPTURE(signs.lacking);
    CAPTURE(signs.volume);
    CAPTURE(signs.bridges);
    CHECK(has_kind(mended.found.structures[2], kind));
    const double before = dice_of(mended.wrong.map, truth, 3), after = dice_of(mended.map, truth, 3);
    CHECK(after > before);
    CHECK(after >= least_dice);
    // The others are as they were but for the neighbour that took a part.
    for (const int other : {1, 2, 4, 5})
      CHECK(dice_of(mended.map, truth, other) >= dice_of(mended.wrong.map, truth, other) - 1e-12);
    // One that is wrong in small things is right all the same.
    if (before < 0.9) CHECK(mended.found.structures[2].confidence < 0.96);
  }
}

TEST_CASE("half of a smooth organ is missing although a smaller one of its form fits what is left") {
  const Mended mended(DefectKind::half_missing, 3);
  CHECK(mended.found.signs[2].volume < -0.3);
  CHECK(has_kind(mended.found.structures[2], DefectKind::half_missing));
  CHECK(mended.found.structures[2].confidence < 0.7);
}

TEST_CASE("a tunnel that the fit follows is seen against the expected shape, and a bar outside of both") {
  const Mesh whole = test::must(mask_surface(stone_map().volume, 3, 0));
  const auto signs_of = [&](const VolumeRead& map, const Mesh& fit) {
    const SetInMap subject = find_in_map(the_set().set, map, 0);
    FittedSet fitted = test::must(fit_set(the_set(), subject, {}));
    fitted.structures[2].fit->mesh = fit;
    std::vector<std::optional<Mesh>> expected(stones);
    expected[2] = whole;
    return structure_signs(the_set(), map, 0, subject, fitted, expected)[2];
  };
  const StructureSigns sound = signs_of(stone_map(), whole);
  CHECK(sound.tunnels == 0);
  CHECK(sound.bars == 0);
  const VolumeRead with_tunnel = made_wrong(DefectKind::hole, 11).map;
  const StructureSigns pierced = signs_of(with_tunnel, test::must(mask_surface(with_tunnel.volume, 3, 0)));
  CHECK(pierced.holes == 0);  // within the fit there is none
  CHECK(pierced.tunnels > 0.0085);
  const StructureSigns barred = signs_of(made_wrong(DefectKind::bridge, 11).map, whole);
  CHECK(barred.bars > 0.004);
}

TEST_CASE("in coarse voxels a groove a voxel wide is no tunnel, and a few voxels at the surface are not lost") {
  const auto whole = [](int k) { return test::must(mask_surface(stone_map().volume, k, 0)); };
  const Vec3 middle = whole(3).points.colwise().mean().transpose();
  const auto signs_of = [&](int voxel_mm, int label, const auto& is_changed) {
    VolumeRead map = stone_map(voxel_mm);
    const VolumeGeometry& grid = map.volume.geometry;
    std::visit(
        [&](auto& voxels) {
          using Voxel = typename std::decay_t<decltype(voxels)>::value_type;
          for (std::size_t v = 0; v < voxels.size(); ++v)
            if (rounded_label(voxels[v]) == 3 && is_changed(Vec3(place_of_voxel(grid, v) - middle)))
              voxels[v] = static_cast<Voxel>(label);
        },
        map.volume.data);
    const SetInMap subject = find_in_map(the_set().set, map, 0);
    FittedSet fitted = test::must(fit_set(the_set(), subject, {}));
    fitted.structures[2].fit->mesh = test::must(mask_surface(map.volume, 3, 0));
    std::vector<std::optional<Mesh>> expected(stones);
    expected[2] = whole(3);
    expected[3] = whole(4);
    return structure_signs(the_set(), map, 0, subject, fitted, expected)[2];
  };
  const auto groove = [](const Vec3& off) { return std::abs(off.z()) <= 1.5 && off.y() > 11; };
  CHECK(signs_of(3, 0, groove).tunnels == 0);
  const auto through = [](const Vec3& off) { return std::max(std::abs(off.z()), std::abs(off.x())) <= 3; };
  CHECK(signs_of(3, 0, through).tunnels > 0.0085);
  int left = 10;
  CHECK(signs_of(4, 4, [&](const Vec3&) { return left-- > 0; }).lost_to.empty());
  left = 40;
  CHECK(signs_of(4, 4, [&](const Vec3&) { return left-- > 0; }).lost_to.at(3) > 0.04);
}

TEST_CASE("a bay that the fit bridges is no hole, a cavity is one, and a way through is one beside neighbours") {
  const Mesh whole = test::must(mask_surface(stone_map().volume, 3, 0));
  const Vec3 middle = whole.points.colwise().mean().transpose();
  const double size_mm = std::cbrt(1000 * std::abs(enclosed_volume_ml(whole)));
  // The stone with a ball taken out of its middle, and with ways from there to the outside too.
  const auto hollow = [&](int ways) {
    VolumeRead map = stone_map();
    const VolumeGeometry& grid = map.volume.geometry;
    std::visit(
        [&](auto& voxels) {
          for (std::size_t v = 0; v < voxels.size(); ++v) {
            const Vec3 off = place_of_voxel(grid, v) - middle;
            const bool on_the_way = ways > (off.z() > 0 ? 0 : 1) && off.head<2>().norm() < 0.1 * size_mm;
            if (rounded_label(voxels[v]) == 3 && (off.norm() < 0.2 * size_mm || on_the_way)) voxels[v] = 0;
          }
        },
        map.volume.data);
    return map;
  };
  for (const int ways : {0, 1, 2}) {
    CAPTURE(ways);
    const VolumeRead map = hollow(ways);
    const SetInMap subject = find_in_map(the_set().set, map, 0);
    FittedSet fitted = test::must(fit_set(the_set(), subject, {}));
    fitted.structures[2].fit->mesh = whole;
    std::vector<std::optional<Mesh>> expected(stones);
    const double alone = structure_signs(the_set(), map, 0, subject, fitted, expected)[2].holes;
    expected[2] = whole;
    const double beside_others = structure_signs(the_set(), map, 0, subject, fitted, expected)[2].holes;
    CHECK((beside_others > 0.01) == (ways != 1));
    CHECK(alone == doctest::Approx(ways == 0 ? beside_others : 0));
  }
}

TEST_CASE("a line of single voxels is a bridge by how far it juts out, and goes alone") {
  const Mesh whole = test::must(mask_surface(stone_map().volume, 3, 0));
  const Vec3 middle = whole.points.colwise().mean().transpose();
  const VolumeRead truth = stone_map();
  for (const double long_mm : {0.0, 30.0}) {
    CAPTURE(long_mm);
    VolumeRead map = truth;
    const VolumeGeometry& grid = map.volume.geometry;
    std::visit(
        [&](auto& voxels) {
          using Voxel = typename std::decay_t<decltype(voxels)>::value_type;
          for (std::size_t v = 0; v < voxels.size(); ++v) {
            const Vec3 off = place_of_voxel(grid, v) - middle;
            const bool on_line = off.y() > 0 && off.y() < long_mm && std::abs(off.x()) < 0.8 && std::abs(off.z()) < 0.8;
            if (on_line && rounded_label(voxels[v]) == 0) voxels[v] = Voxel(3);
          }
        },
        map.volume.data);
    const double before = dice_of(map, truth, 3);
    const RepairedMap found = test::must(repair_map(the_set(), map, 0));
    CHECK(has_kind(found.structures[2], DefectKind::bridge) == (long_mm > 0));
    CHECK((found.signs[2].bar_reach > 0.22) == (long_mm > 0));
    CHECK(dice_of(map, truth, 3) >= before);
    CHECK((found.structures[2].changed_voxels > 5) == (long_mm > 0));
    CHECK(found.structures[2].changed_voxels < 40);
  }
}

TEST_CASE("two that have each other's name get their own back, though each is unlike its template") {
  VolumeRead map = stone_map();
  std::visit(
      [](auto& all) {
        using Voxel = typename std::decay_t<decltype(all)>::value_type;
        for (auto& voxel : all)
          if (const int label = rounded_label(voxel); label == 2 || label == 3) voxel = static_cast<Voxel>(5 - label);
      },
      map.volume.data);
  const SetInMap subject = find_in_map(the_set().set, map, 0);
  FittedSet fitted = test::must(fit_set(the_set(), subject, {}));
  for (const std::size_t k : {1U, 2U}) fitted.structures[k].judgement.doubtful = true;
  const auto names = find_names(the_set(), subject, fitted, std::vector<StructureSigns>(stones));
  CHECK(names[1].proposed == name_of_stone(2));
  CHECK(names[2].proposed == name_of_stone(1));
  CHECK(names[0].proposed == name_of_stone(0));
}

TEST_CASE("a repair that is cancelled after its fits looks at nothing more") {
  const VolumeRead map = stone_map();
  const SetInMap subject = find_in_map(the_set().set, map, 0);
  const FittedSet fitted = test::must(fit_set(the_set(), subject, {}));
  Progress progress;
  progress.cancel();
  const auto expected = expected_shapes(the_set(), subject, fitted, &progress);
  CHECK(std::ranges::none_of(expected, [](const auto& one) { return one.has_value(); }));
  const std::vector<std::optional<Mesh>> none(stones);
  CHECK(structure_signs(the_set(), map, 0, subject, fitted, none, &progress)[2].volume == 0);
  VolumeRead mended = map;
  MapRepairOptions options;
  options.progress = &progress;
  CHECK_FALSE(repair_map(the_set(), mended, 0, options));
}

TEST_CASE("an island within another structure becomes a part of it") {
  VolumeRead map = stone_map();
  const Mesh host = test::must(mask_surface(map.volume, 4, 0));
  const Vec3 middle = host.points.colwise().mean().transpose();
  std::size_t put_in = 0;
  std::visit(
      [&](auto& voxels) {
        for (std::size_t v = 0; v < voxels.size(); ++v)
          if (rounded_label(voxels[v]) == 4 && (place_of_voxel(map.volume.geometry, v) - middle).norm() < 3)
            voxels[v] = 2, ++put_in;
      },
      map.volume.data);
  REQUIRE(put_in > 3);
  const RepairedMap found = test::must(repair_map(the_set(), map, 0));
  CHECK(has_kind(found.structures[1], DefectKind::island));
  CHECK(map.volume.data == stone_map().volume.data);
}

TEST_CASE("a structure without neighbours that say where it belongs is never quite sure") {
  SetOfTemplates alone;
  alone.set.structures = {the_set().set.structures[2]};
  alone.set.structures[0].neighbours.clear();
  alone.templates = {the_set().templates[2]};
  VolumeRead map = stone_map();
  const RepairedMap found = test::must(repair_map(alone, map, 0));
  CHECK(found.structures[0].confidence > 0.7);
  CHECK(found.structures[0].confidence <= 0.85);
}

TEST_CASE("two bodies in one label that lie to each other as two structures do are those two") {
  // As both kidneys in one label: nothing else is there that says where they belong.
  SetOfTemplates pair;
  for (const std::size_t k : {1U, 3U}) {
    pair.set.structures.push_back(the_set().set.structures[k]);
    pair.set.structures.back().neighbours.clear();
    pair.set.structures.back().name = k == 1 ? "kidney_right" : "kidney_left";
    pair.templates.push_back(the_set().templates[k]);
  }
  const auto with = [](int first, int second) {
    VolumeRead map = stone_map();
    std::visit(
        [&](auto& voxels) {
          using Voxel = typename std::decay_t<decltype(voxels)>::value_type;
          for (auto& voxel : voxels) voxel = static_cast<Voxel>(voxel == 2 ? first : voxel == 4 ? second : 0);
        },
        map.volume.data);
    map.segmentation.segments = {{"kidney_right", 2, 0, {}, {}}, {"kidney_left", 4, 0, {}, {}}};
    return map;
  };
  const VolumeRead truth = with(2, 4);
  for (const int value : {2, 4}) {
    CAPTURE(value);
    VolumeRead map = with(value, value);
    const RepairedMap found = test::must(repair_map(pair, map, 0));
    const std::size_t has_both = value == 2 ? 0 : 1;
    CHECK(kinds_of(found.structures[has_both]) == std::vector<std::string>{"doubled"});
    CHECK(kinds_of(found.structures[1 - has_both]) == std::vector<std::string>{"missing"});
    CHECK(map.volume.data == truth.volume.data);
  }
  // Two parts that lie otherwise are not.
  VolumeRead map = with(2, 2);
  VolumeGeometry& grid = map.volume.geometry;
  grid.direction = Eigen::AngleAxisd(1.57, Vec3::UnitX()).toRotationMatrix() * grid.direction;
  const RepairedMap turned = test::must(repair_map(pair, map, 0));
  CHECK_FALSE(has_kind(turned.structures[0], DefectKind::doubled));
}

TEST_CASE("a neighbour that took a part is named, and gives it back") {
  const VolumeRead truth = stone_map();
  const Mended mended(DefectKind::taken_from_neighbour, 4);
  REQUIRE(mended.wrong.planted.size() == 2);
  CHECK(has_kind(mended.found.structures[2], DefectKind::taken_from_neighbour));
  CHECK(dice_of(mended.map, truth, 3) > dice_of(mended.wrong.map, truth, 3));
}

TEST_CASE("what was given to a neighbour in another layer comes back and no two layers hold a voxel") {
  const CorruptedLabels wrong = made_wrong(DefectKind::given_to_neighbour, 3);
  VolumeRead map;
  std::vector<Volume> layers;
  for (int k = 0; k < stones; ++k) {
    Volume& layer = layers.emplace_back(wrong.map.volume);
    std::visit(
        [&](auto& voxels) {
          for (auto& voxel : voxels) voxel = rounded_label(voxel) == k + 1 ? 1 : 0;
        },
        layer.data);
    layer.range_max = 1;
    map.segmentation.add({name_of_stone(k), 1, static_cast<std::size_t>(k), {}, {}});
  }
  map.volume = layers.front();
  map.other_layers.assign(layers.begin() + 1, layers.end());
  const RepairedMap found = test::must(repair_map(the_set(), map, 0));
  CHECK(has_kind(found.structures[2], DefectKind::given_to_neighbour));
  const VolumeRead truth = stone_map();
  for (int k = 0; k < stones; ++k) {
    CAPTURE(k);
    VolumeRead own;
    own.volume = k == 0 ? map.volume : map.other_layers[static_cast<std::size_t>(k) - 1];
    VolumeRead right = truth;
    std::visit(
        [&](auto& voxels) {
          for (auto& voxel : voxels) voxel = rounded_label(voxel) == k + 1 ? 1 : 0;
        },
        right.volume.data);
    CHECK(dice_of(own, right, 1) > 0.95);
  }
  std::size_t held_twice = 0;
  for (std::size_t v = 0; v < truth.volume.geometry.voxels(); ++v) {
    int held = 0;
    for (std::size_t k = 0; k < stones; ++k)
      held += std::visit([&](const auto& voxels) { return voxels[v] != 0 ? 1 : 0; },
                         k == 0 ? map.volume.data : map.other_layers[k - 1].data);
    held_twice += held > 1 ? 1 : 0;
  }
  CHECK(held_twice == 0);
}

TEST_CASE("labels of which some are a level off get their names back, by where they lie") {
  const VolumeRead truth = stone_map();
  const auto renamed = [&](const std::map<int, int>& to) {
    VolumeRead map = truth;
    std::visit(
        [&](auto& voxels) {
          using Voxel = typename std::decay_t<decltype(voxels)>::value_type;
          for (Voxel& voxel : voxels)
            if (const auto found = to.find(static_cast<int>(voxel)); found != to.end())
              voxel = static_cast<Voxel>(found->second);
        },
        map.volume.data);
    return map;
  };
  struct Names {
    const char* what;
    std::map<int, int> to;
    std::vector<std::size_t> wrong;  ///< which structures of the set
  };
  for (const auto& [what, to, wrong] :
       {Names{"two exchanged", {{2, 3}, {3, 2}}, {1, 2}}, Names{"the first is one up", {{1, 9}}, {}},
        Names{"the last are one down", {{4, 5}, {5, 6}}, {4}}, Names{"the last but one is missing", {{4, 0}}, {}}}) {
    CAPTURE(std::string(what));
    VolumeRead map = renamed(to);
    const RepairedMap found = test::must(repair_map(the_set(), map, 0));
    for (std::size_t k = 0; k < found.structures.size(); ++k) {
      CAPTURE(k);
      const bool is_wrong = std::ranges::find(wrong, k) != wrong.end();
      CHECK(has_kind(found.structures[k], DefectKind::level_shifted) == is_wrong);
      CHECK((found.structures[k].p_named <= 0.5) == is_wrong);
    }
    // The voxels too have the labels of their names.
    for (const std::size_t k : wrong)
      for (const auto& [value, other] : to)
        if (other == static_cast<int>(k) + 1) CHECK(dice_of(map, truth, value) == 1);
  }
}

TEST_CASE("a level that is split in two labels becomes one, and those below get their names back") {
  const VolumeRead truth = stone_map();
  const Mesh whole = test::must(mask_surface(truth.volume, 3, 0));
  const double middle = whole.points.col(2).mean();
  VolumeRead map = truth;
  std::visit(
      [&](auto& voxels) {
        using Voxel = typename std::decay_t<decltype(voxels)>::value_type;
        for (std::size_t v = 0; v < voxels.size(); ++v) {
          const int label = rounded_label(voxels[v]);
          const bool moves = label > 3 || (label == 3 && place_of_voxel(map.volume.geometry, v).z() > middle);
          if (moves) voxels[v] = static_cast<Voxel>(label + 1);
        }
      },
      map.volume.data);
  map.volume.range_max = 6;
  map.segmentation.add({"vertebrae_L6", 6, 0, {}, {}});
  const RepairedMap found = test::must(repair_map(the_set(), map, 0));
  CHECK(kinds_of(found.structures[2]) == std::vector<std::string>{"given_to_neighbour"});
  CHECK(found.structures[2].confidence < 0.5);
  CHECK(has_kind(found.structures[3], DefectKind::level_shifted));
  CHECK(found.structures[3].proposed_name == name_of_stone(2));
  CHECK(found.structures[4].proposed_name == name_of_stone(3));
  // The one that the set lacks goes along.
  CHECK(found.renamed_without == std::vector<std::pair<std::string, std::string>>{{"vertebrae_L6", name_of_stone(4)}});
  for (const int label : {1, 2, 3, 4, 5}) {
    CAPTURE(label);
    CHECK(dice_of(map, truth, label) == 1);
  }
}

TEST_CASE("a fit whose name is likely another's is doubtful and less sure, and the others stay as they are") {
  VolumeRead map = stone_map();
  std::visit(
      [](auto& voxels) {
        for (auto& voxel : voxels)
          if (voxel == 2 || voxel == 3) voxel = voxel == 2 ? 3 : 2;
      },
      map.volume.data);
  const SetInMap subject = find_in_map(the_set().set, map);
  FittedSet fitted = test::must(fit_set(the_set(), subject));
  const FittedSet before = fitted;
  doubt_names(the_set(), map, 0, subject, fitted);
  for (std::size_t k = 0; k < stones; ++k) {
    CAPTURE(k);
    const FittedStructure& one = fitted.structures[k];
    if (k == 1 || k == 2) {
      CHECK(one.p_named < 0.5);
      CHECK(one.judgement.doubtful);
      CHECK(one.judgement.warnings.back().find("belongs; run repair") != std::string::npos);
      CHECK(one.confidence < before.structures[k].confidence - 0.05);
    } else {
      CHECK(one.p_named > 0.6);
      CHECK(one.judgement.doubtful == before.structures[k].judgement.doubtful);
    }
  }
}

TEST_CASE("two structures never come to one name") {
  const SetOfTemplates& set = the_set();
  const SetInMap subject = find_in_map(set.set, stone_map(), 0);
  std::vector<NameFound> names(stones);
  for (int k = 0; k < stones; ++k) names[static_cast<std::size_t>(k)].proposed = name_of_stone(k);
  // The second and the third exchange their names; the first wants the fourth's, which the fourth keeps.
  names[1] = {name_of_stone(2), 0.1, {{DefectKind::level_shifted, name_of_stone(2)}}};
  names[2] = {name_of_stone(1), 0.1, {{DefectKind::level_shifted, name_of_stone(1)}}};
  names[0] = {name_of_stone(3), 0.1, {{DefectKind::level_shifted, name_of_stone(3)}}};
  settle_clashes(set, subject, names);
  CHECK(names[0].proposed == name_of_stone(0));
  CHECK(names[0].p_named == 0.5);
  CHECK(names[0].defects.empty());
  CHECK(names[1].proposed == name_of_stone(2));
  CHECK(names[2].proposed == name_of_stone(1));
  // What keeps its own name for it stops the next one too.
  names[3].proposed = name_of_stone(0);
  settle_clashes(set, subject, names);
  CHECK(names[3].proposed == name_of_stone(3));
}

TEST_CASE("with an image what is filled in goes to the boundary that it shows") {
  // The third stone is a tenth larger than its neighbours make one expect.
  VolumeGeometry grid = stone_map().volume.geometry;
  std::vector<MeshOfSegment> meshes;
  for (int k = 0; k < stones; ++k)
    meshes.push_back(
        {{name_of_stone(k), k + 1, 0, {}, {}}, stone_at(1.04 * place_of(k), radius_of(k), k == 2 ? 1.15 : 1.05)});
  const VolumeRead truth = std::move(map_of_meshes(meshes, grid).map);
  Volume image;
  image.geometry = grid;
  std::vector<std::int16_t> bright;
  VolumeRead without = truth;
  std::visit(
      [&](auto& voxels) {
        using Voxel = typename std::decay_t<decltype(voxels)>::value_type;
        for (Voxel& voxel : voxels) {
          bright.push_back(voxel != Voxel{0} ? 300 : 40);
          if (voxel == Voxel{3}) voxel = Voxel{0};
        }
      },
      without.volume.data);
  image.data = bright;
  image.range_max = 300;
  VolumeRead with = without;
  must_find_missing(test::must(repair_map(the_set(), without, 0)));
  must_find_missing(test::must(repair_map(the_set(), with, 0, {.image = &image})));
  CHECK(dice_of(without, truth, 3) < 0.92);
  CHECK(dice_of(with, truth, 3) > 0.97);
}

namespace {

/// A stone of a subject all of whose stones are as thick as one another.
Mesh thick_stone(int k, double thickness) {
  Mesh stone = stone_at(Vec3::Zero(), radius_of(k), 1);
  stone.points.col(1) *= thickness;
  stone.points.rowwise() += Eigen::RowVector3d(place_of(k));
  return stone;
}

/// What subjects with thin and with thick stones teach.
ShapeModel model_of_stones() {
  constexpr std::array thicknesses{0.75, 0.85, 0.95, 1.05, 1.15, 1.25};
  std::vector<StructurePart> parts;
  ShapeMatrix shapes;
  for (int k = 0; k < stones; ++k) {
    const Eigen::Index n = thick_stone(k, 1).points.rows();
    parts.push_back({name_of_stone(k), k * n, n, 0, 0});
    shapes.conservativeResize(3 * n * (k + 1), thicknesses.size());
    for (std::size_t s = 0; s < thicknesses.size(); ++s) {
      const Points points = thick_stone(k, thicknesses[s]).points;
      shapes.col(static_cast<Eigen::Index>(s)).tail(3 * n) =
          Eigen::Map<const Eigen::VectorXd>(points.data(), points.size());
    }
  }
  align(shapes, Alignment::rigid);
  ShapeModel model = make_model(principal_components(shapes), 1, nullptr, {});
  model.parts = parts;
  model.alignment = Alignment::rigid;
  return model;
}

}  // namespace

TEST_CASE("with a joint model what is missing has the shape that goes with the others' shapes") {
  constexpr double thickness = 1.2;
  std::vector<MeshOfSegment> meshes;
  for (int k = 0; k < stones; ++k) meshes.push_back({{name_of_stone(k), k + 1, 0, {}, {}}, thick_stone(k, thickness)});
  const VolumeRead truth = std::move(map_of_meshes(meshes, stone_map().volume.geometry).map);
  VolumeRead without = truth;
  std::visit(
      [](auto& voxels) {
        using Voxel = typename std::decay_t<decltype(voxels)>::value_type;
        std::ranges::replace(voxels, Voxel{3}, Voxel{0});
      },
      without.volume.data);
  VolumeRead with = without;
  const SetModel model = test::must(set_model(model_of_stones(), the_set()));
  must_find_missing(test::must(repair_map(the_set(), without, 0)));
  must_find_missing(test::must(repair_map(the_set(), with, 0, {.model = &model})));
  CHECK(dice_of(without, truth, 3) < 0.93);
  CHECK(dice_of(with, truth, 3) > 0.97);
}

TEST_CASE("a model that does not belong to the set is refused with what is wrong") {
  const auto refused = [](const ShapeModel& model, const std::string& what) {
    return says(set_model(model, the_set()), what);
  };
  ShapeModel model = model_of_stones();
  CHECK(set_model(model, the_set()));
  ShapeModel alone = model;
  alone.parts.clear();
  CHECK(refused(alone, "no joint model"));
  ShapeModel apart = model;
  apart.poses = StructurePoses{};
  apart.poses->apart = true;
  CHECK(refused(apart, "--alignment common"));
  ShapeModel other = model;
  for (StructurePart& part : other.parts) part.name += " of another body";
  CHECK(refused(other, "none of the set's structures"));
  ShapeModel few = model;
  few.scores.conservativeResize(Eigen::NoChange, 2);
  CHECK(refused(few, "three training shapes"));
  ShapeModel shifted = model;
  shifted.parts[2].vertices -= 1;
  CHECK(refused(shifted, "vertebrae_L3 has 641 vertices"));
}

TEST_CASE("a name that two labels have is told and nothing is invented for it") {
  const VolumeRead truth = stone_map();
  VolumeRead map = truth;
  map.segmentation.segments[1].name = "Vertebrae_L3";
  const VolumeRead before = map;
  const SetInMap subject = find_in_map(the_set().set, map);
  CHECK_FALSE(subject.structures[2].is_there());
  CHECK(subject.structures[2].why_left_out == "the labels 2 and 3 both have its name; give one of them another name");
  CHECK(subject.without_template.empty());
  const RepairedMap found = test::must(repair_map(the_set(), map, 0));
  CHECK(found.structures[2].changed_voxels == 0);
  CHECK(kinds_of(found.structures[2]) == std::vector<std::string>{});
  const FittedSet fitted = test::must(fit_set(the_set(), subject));
  CHECK(fitted.structures[2].why_not == subject.structures[2].why_left_out);
  CHECK(fitted.structures[3].fit);
  // A name without voxels is none.
  map = truth;
  map.segmentation.add({"VERTEBRAE_L3", 77, 0, {}, {}});
  CHECK(find_in_map(the_set().set, map).structures[2].is_there());
}

TEST_CASE("a level more than the set has is a variant, and one that is missing is not") {
  // The third and the fourth stone come farther apart, with a sixth one between.
  const SetOfTemplates& whole = the_set();
  SetOfTemplates set = whole;
  for (std::size_t k = 0; k < stones; ++k)
    for (const std::size_t n : {k - 1, k + 1})
      if (n < stones) set.set.structures[k].neighbours.push_back(set.set.structures[n].name);
  VolumeGeometry grid = stone_map().volume.geometry;
  grid.dims[2] += 40;
  std::vector<MeshOfSegment> meshes;
  for (int k = 0; k < stones; ++k)
    meshes.push_back(
        {{name_of_stone(k), k + 1, 0, {}, {}}, stone_at(place_of(k) + Vec3(0, 0, k > 2 ? 34 : 0), radius_of(k), 1)});
  meshes.push_back({{"vertebrae_L6", 9, 0, {}, {}}, stone_at(place_of(3), radius_of(3), 1)});
  const VolumeRead six = std::move(map_of_meshes(meshes, grid).map);
  const SetInMap subject = find_in_map(set.set, six);
  const auto variants = find_variants(set, subject, test::must(fit_set(set, subject)));
  REQUIRE(variants.size() == 1);
  REQUIRE(variants[0].more.size() == 1);
  CHECK(variants[0].more[0].name == "vertebrae_L6");
  CHECK(variants[0].absent.empty());
  CHECK(sentence_of(variants[0], set) ==
        "has vertebrae_L6 between vertebrae_L3 and vertebrae_L4; this is a variant, which is left as it is");
  // A label between neighbours that lie as in the set is no variant, and one that is missing there is missing.
  VolumeRead plain = stone_map();
  std::visit(
      [&](auto& voxels) {
        for (auto& voxel : voxels)
          if (voxel == 3) voxel = 0;
        voxels[(100 * 70 + 35) * 90 + 40] = 9;
      },
      plain.volume.data);
  plain.segmentation.add({"vertebrae_L6", 9, 0, {}, {}});
  const RepairedMap found = test::must(repair_map(set, plain, 0));
  CHECK(found.variants.empty());
  must_find_missing(found);
  CHECK(found.structures[2].changed_voxels > 1000);
}

TEST_CASE("what a map does not segment at all is not missing") {
  SetOfTemplates set = the_set();
  for (const int k : {0, 1}) {
    TemplateOfSet disc;
    disc.name = "disc_L" + std::to_string(k + 1) + "_L" + std::to_string(k + 2);
    disc.value = 11 + k;
    set.set.structures.push_back(disc);
    const Mesh between = stone_at((place_of(k) + place_of(k + 1)) / 2, 4, 1);
    set.templates.push_back(test::must(make_template({between.points, between.topology->triangles()}, disc.name)));
  }
  for (const bool is_listed : {false, true}) {
    CAPTURE(is_listed);
    VolumeRead map = stone_map();
    if (is_listed) map.segmentation.add({"disc_L1_L2", 11, 0, {}, {}});  // as a segmenter lists all that it knows
    const RepairedMap found = test::must(repair_map(set, map, 0));
    for (const std::size_t k : {5U, 6U}) {
      CHECK(has_kind(found.structures[k], DefectKind::missing) == is_listed);
      CHECK((found.structures[k].changed_voxels > 0) == is_listed);
    }
  }
}

TEST_CASE("the farther a fit is in doubt the less sure a structure is, with no floor") {
  FittedStructure one;
  one.fit.emplace();
  std::vector<double> confidence;
  for (const double times : {0.5, 3.0, 6.0}) {
    one.judgement.doubt_share = times * most_doubt_share;
    confidence.push_back(structure_confidence(one));
  }
  CHECK(confidence[0] > 0.8);
  CHECK(confidence[1] < confidence[0] + 1e-12);
  CHECK(confidence[2] < 0.05);
}

TEST_CASE("a label that is filled in has a value that no other label has, and its name") {
  VolumeRead map = stone_map();
  std::visit(
      [&](auto& voxels) {
        using Voxel = typename std::decay_t<decltype(voxels)>::value_type;
        for (std::size_t v = 0; v < voxels.size(); ++v)
          if (voxels[v] == Voxel{3}) voxels[v] = v < 20 ? Voxel{3} : Voxel{0};
        voxels[0] = Voxel{3};  // another thing, of the value that the set has for the third stone
      },
      map.volume.data);
  for (Segment& segment : map.segmentation.segments)
    if (segment.value == 3) segment.name = "liver";
  const RepairedMap found = test::must(repair_map(the_set(), map, 0));
  CHECK(has_kind(found.structures[2], DefectKind::missing));
  const auto& segments = map.segmentation.segments;
  const auto third = std::ranges::find(segments, name_of_stone(2), &Segment::name);
  REQUIRE(third != segments.end());
  CHECK(third->value != 3);
  const VolumeRead truth = stone_map();
  VolumeRead by_name = map;
  std::visit(
      [&](auto& voxels) {
        using Voxel = typename std::decay_t<decltype(voxels)>::value_type;
        for (Voxel& voxel : voxels)
          if (static_cast<int>(voxel) == third->value) voxel = Voxel{3};
      },
      by_name.volume.data);
  CHECK(dice_of(by_name, truth, 3) > 0.85);
}

TEST_CASE("a label that the scan cuts is told, and stays as it is") {
  const Mended mended(DefectKind::cut_by_scan, 3);
  CHECK(has_kind(mended.found.structures[2], DefectKind::cut_by_scan));
  CHECK(mended.map.volume.data == mended.wrong.map.volume.data);
}

TEST_CASE("levels are read from names and written into them") {
  CHECK(level_of_name("vertebrae_L3") == 21);
  CHECK(level_of_name("T12") == 18);
  CHECK(level_of_name("l5 body") == 23);
  CHECK(level_of_name("C1") == 0);
  CHECK_FALSE(level_of_name("liver"));
  CHECK_FALSE(level_of_name("CT2x"));
  CHECK_FALSE(level_of_name("L77"));
  CHECK(name_at_level("vertebrae_L1", 18) == "vertebrae_T12");
  CHECK(name_at_level("t12 arch", 19) == "l1 arch");
  CHECK(name_at_level("disc_L5_S1", 22) == "disc_L4_L5");
  CHECK(name_at_level("rib_left_12", 17) == "rib_left_11");
  CHECK(level_in_name("vertebrae_L3")->family == level_in_name("Vertebrae_T9")->family);
  CHECK(level_in_name("disc_L2_L3")->family != level_in_name("vertebrae_L2")->family);
  CHECK(level_in_name("vertebrae_S1")->sacral);
  CHECK_FALSE(level_of_name("tribe_4"));
}

}  // namespace homolog
