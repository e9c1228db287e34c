#include "core/structures/naming/name_levels.h"

#include <doctest/doctest.h>

#include <map>

#include "core/structures/naming/right_names.h"
#include "tests/stones.h"

// Which levels the names of a spine say, with fits that are put in by hand: no form tells here.

namespace homolog {

namespace {

/// Fits of stones: by their places in the set, at which place each really lies.
struct Lying {
  SetInMap subject;
  FittedSet fitted;
  std::vector<char> placed = std::vector<char>(stones);

  Lying(const std::map<std::size_t, int>& really, int height);
};

Lying::Lying(const std::map<std::size_t, int>& really, int height) {
  subject.grid = stone_map().volume.geometry;
  subject.grid.dims[2] = height;
  subject.structures.resize(stones);
  fitted.structures.resize(stones);
  for (const auto& [k, place] : really) {
    subject.structures[k].mask.emplace();
    FitResult& fit = fitted.structures[k].fit.emplace();
    fit.mesh = stone_at(place_of(place), radius_of(place), 1);
    fitted.structures[k].judgement.inside_scan.dice = 1;
    placed[k] = 1;
  }
}

std::vector<LevelFound> levels_of(const SetOfTemplates& set, const std::map<std::size_t, int>& really, int height) {
  const Lying there(really, height);
  return find_levels(set, there.subject, there.fitted, there.placed, std::vector<char>(stones));
}

constexpr int with_room = 154, without_room = 127;  // for one more below the last

}  // namespace

TEST_CASE("a stretch of names that are off is one error however long it is") {
  const SetOfTemplates set = stone_set();
  // The upper three of four are a level up. The last one is right, and may be taken for the one that is wrong.
  const std::map<std::size_t, int> upper_are_off{{0, 1}, {1, 2}, {2, 3}, {4, 4}};
  const auto unknown = levels_of(set, upper_are_off, without_room);
  for (const auto& [k, place] : upper_are_off) {
    CAPTURE(k);
    CHECK(unknown[k].shift == 0);
    CHECK(unknown[k].maybe == (k == 4 ? -1 : 1));
    CHECK(unknown[k].p_named == doctest::Approx(0.5));
  }
  // With the last one as L4 there would be room for an L5, and nobody labelled it.
  const auto told = levels_of(set, upper_are_off, with_room);
  for (const auto& [k, place] : upper_are_off) {
    CAPTURE(k);
    CHECK(told[k].shift == (k == 4 ? 0 : 1));
    CHECK(told[k].maybe == 0);
    CHECK(told[k].p_named == doctest::Approx(k == 4 ? 1 / 1.1 : 0.1 / 1.1));
  }
}

TEST_CASE("names that a small set cannot compare are likely right, and not half wrong") {
  // Two vertebrae and the disc between them: nothing of the set is a level above, or below.
  const SetOfTemplates all = stone_set();
  SetOfTemplates set;
  SetInMap subject;
  FittedSet fitted;
  for (const auto& [name, k] :
       std::map<std::string, std::size_t>{{"disc_L4_L5", 2}, {"vertebrae_L4", 3}, {"vertebrae_L5", 4}}) {
    set.set.structures.push_back(all.set.structures[k]);
    set.set.structures.back().name = name;
    set.templates.push_back(all.templates[k]);
    subject.structures.emplace_back().mask.emplace();
    fitted.structures.emplace_back().fit.emplace().mesh = {all.templates[k]->topology, all.templates[k]->points};
  }
  const auto levels = find_levels(set, subject, fitted, {1, 1, 1}, {0, 0, 0});
  for (const LevelFound& found : levels) {
    CHECK(found.shift == 0);
    CHECK(found.maybe == 0);
    CHECK(found.p_named > 0.85);  // 0.5 where the side that the set lacks counted as much as its own
  }
  CHECK(levels[0].p_named == doctest::Approx(0.97));  // a disc alone
}

TEST_CASE("two names that are exchanged among others are the wrong ones") {
  for (const int height : {with_room, without_room}) {
    CAPTURE(height);
    const auto levels = levels_of(stone_set(), {{0, 0}, {1, 2}, {2, 1}, {3, 3}, {4, 4}}, height);
    for (std::size_t k = 0; k < stones; ++k) {
      CAPTURE(k);
      CHECK(levels[k].shift == (k == 1 ? 1 : k == 2 ? -1 : 0));
      CHECK(levels[k].maybe == 0);
      CHECK((levels[k].p_named < 0.5) == (k == 1 || k == 2));
    }
  }
}

TEST_CASE("what the scan hardly cuts has a say in its name, and what lost a part has none") {
  const SetOfTemplates set = stone_set();
  const Lying there({{0, 0}, {1, 2}, {2, 1}, {3, 3}, {4, 4}}, with_room);
  const auto is_exchanged = [&](auto sign) {
    std::vector<StructureSigns> signs(stones);
    sign(signs[1]);
    return find_names(set, there.subject, there.fitted, signs)[2].proposed == name_of_stone(1);
  };
  CHECK(is_exchanged([](StructureSigns& signs) { signs.at_border = 0.016; }));
  CHECK_FALSE(is_exchanged([](StructureSigns& signs) { signs.at_border = 0.1; }));
  CHECK_FALSE(is_exchanged([](StructureSigns& signs) { signs.lost_to[4] = 0.1; }));
  CHECK(is_exchanged([](StructureSigns& signs) { signs.lost_to[4] = 0.9; }));
}

TEST_CASE("T12 and L1 that are exchanged are no spine without a T12") {
  SetOfTemplates set = stone_set();
  const std::vector<std::string> names{"vertebrae_T10", "vertebrae_T11", "vertebrae_T12", "vertebrae_L1",
                                       "vertebrae_L2"};
  for (std::size_t k = 0; k < stones; ++k) set.set.structures[k].name = names[k];
  const auto exchanged = levels_of(set, {{0, 0}, {1, 1}, {2, 3}, {3, 2}, {4, 4}}, with_room);
  for (std::size_t k = 0; k < stones; ++k) {
    CAPTURE(k);
    CHECK(exchanged[k].shift == (k == 2 ? 1 : k == 3 ? -1 : 0));
  }
  // Who has 11 ribs has none: L1 lies where T12 would.
  const std::map<std::size_t, int> eleven_ribs{{0, 0}, {1, 1}, {3, 2}, {4, 3}};
  const auto variant = levels_of(set, eleven_ribs, with_room);
  for (const auto& [k, place] : eleven_ribs) {
    CAPTURE(k);
    CHECK(variant[k].shift == 0);
    CHECK(variant[k].maybe == 0);
  }
}

}  // namespace homolog
