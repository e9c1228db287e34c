#include <doctest/doctest.h>

#include <set>

#include "core/catalogue/catalogue.h"
#include "core/mesh/voxels/voxelise.h"
#include "core/structures/repair/defects.h"
#include "core/volume/labels/read_labels.h"
#include "tests/driver.h"
#include "tests/must.h"
#include "tests/stones_on_disk.h"

// A label map that was repaired in the window: it is written as the structures are then, and the case brings back what
// was seen of it.

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// The stones in the window, repaired and fitted.
struct RepairedStones {
  StonesOnDisk stones;
  Driver driver;

  RepairedStones()
      : driver(new_document(stones.labels.string(), std::make_shared<const Volume>(stones.map.volume), nullptr),
               {1280, 1600, 1}) {
    driver.app().send(open_labels(stones.labels));
    driver.settle();
    driver.app().send(ChooseSet{stones.set.string()});
    driver.wait_until("the set is read", [&] { return driver.state().automatic.set != nullptr; });
    driver.settle();
    driver.click("Repair and fit");
    driver.wait_until("the set is fitted", [&] { return driver.document().structures.size() == 5; });
    driver.settle();
  }
  std::string id_of(int k) const {
    for (const auto& one : driver.document().structures)
      if (one->name == name_of_stone(k)) return one->id;
    return {};
  }
  void work_on(int k) {
    driver.app().send(ChooseStructure{id_of(k)});
    driver.settle();
  }
  VolumeRead written(const char* name) {
    const fs::path file = stones.folder.path / name;
    driver.app().send(ExportMendedMap{{file}});
    driver.wait_until("it is written", [&] { return driver.shows(("Written: " + file.string()).c_str()); });
    driver.settle();
    return test::must(read_labels(file));
  }
};

const std::vector<std::uint8_t>& voxels_of(const VolumeRead& map) {
  return std::get<std::vector<std::uint8_t>>(map.volume.data);
}

std::size_t voxels_with(const VolumeRead& map, int label) {
  return static_cast<std::size_t>(std::ranges::count(voxels_of(map), static_cast<std::uint8_t>(label)));
}

/// How many voxels that have one of these labels in either map have another in the other.
std::size_t different(const VolumeRead& a, const VolumeRead& b, const std::set<int>& labels) {
  std::size_t count = 0;
  for (std::size_t v = 0; v < voxels_of(a).size(); ++v) {
    const int one = voxels_of(a)[v], other = voxels_of(b)[v];
    count += one != other && (labels.contains(one) || labels.contains(other)) ? 1 : 0;
  }
  return count;
}

}  // namespace

TEST_CASE("a repaired map is written as proposed, but for what was taken back or changed by hand") {
  RepairedStones repaired;
  Driver& driver = repaired.driver;
  const StonesOnDisk& stones = repaired.stones;
  const VolumeRead proposed = repaired.written("proposed.seg.nrrd");
  CHECK(voxels_with(proposed, 9) == 1);
  CHECK(proposed.segmentation.find(9)->name == "other");
  CHECK(different(proposed, stones.map, {1, 2, 5}) == 0);
  CHECK(different(proposed, stones.whole, {4}) < voxels_with(stones.whole, 4) / 100);
  CHECK(voxels_with(proposed, 3) > voxels_with(stones.whole, 3) / 2);
  CHECK(proposed.segmentation.find(3)->name == name_of_stone(2));

  // In the format that it has, with the names beside it.
  const VolumeRead nifti = repaired.written("proposed.nii.gz");
  CHECK(voxels_of(nifti) == voxels_of(proposed));
  CHECK(fs::exists(stones.folder.path / "proposed.json"));

  repaired.work_on(3);
  driver.click("Take back");
  repaired.work_on(2);
  driver.click("Take back");
  driver.settle();
  const VolumeRead as_read = repaired.written("as-read.seg.nrrd");
  CHECK(different(as_read, stones.map, {1, 2, 3, 4, 5, 9}) == 0);

  // The first one goes sideways by hand: it alone changes.
  repaired.work_on(0);
  const Points moved =
      driver.document().structure(repaired.id_of(0))->shape(0)->points->rowwise() + Eigen::RowVector3d(5, 0, 0);
  driver.app().send(ApplyEdit{SetPoints{FoundBy::fit, std::nullopt, std::make_shared<const Points>(moved)}});
  driver.settle();
  const VolumeRead by_hand = repaired.written("by-hand.seg.nrrd");
  CHECK(different(by_hand, stones.map, {2, 3, 4, 5, 9}) == 0);
  const Structure& first = *driver.document().structure(repaired.id_of(0));
  const auto inside = voxelise({first.the_template->topology, *first.shape(0)->points}, stones.map.volume.geometry);
  std::size_t off = 0;
  for (std::size_t v = 0; v < inside.size(); ++v) off += (inside[v] != 0) != (voxels_of(by_hand)[v] == 1) ? 1 : 0;
  CHECK(off == 0);

  // The map that was read stays as it is.
  driver.app().send(ExportMendedMap{{stones.labels}});
  driver.settle();
  CHECK(driver.shows("is the map that was read, and stays as it is. Give another name."));
}

TEST_CASE("the button of the mended map asks for a name beside the map that was read") {
  RepairedStones repaired;
  Driver& driver = repaired.driver;
  driver.app().send(OpenSection{"Export", true});
  driver.settle();
  driver.click("The label map, mended\xe2\x80\xa6");
  driver.settle();
  REQUIRE(driver.state().dialog);
  CHECK(std::get<FileDialog>(*driver.state().dialog).browser.name == "labels-mended.seg.nrrd");
}

TEST_CASE("a case that is opened again has its shapes as read, its looks and its proposal") {
  RepairedStones repaired;
  Driver& driver = repaired.driver;
  const std::string hollow = repaired.id_of(3), missing = repaired.id_of(2);
  driver.app().send(ShowStructures{{repaired.id_of(0)}, false});
  driver.app().send(LockStructures{{repaired.id_of(1)}, true});
  driver.app().send(SetStructureOpacity{{hollow}, 0.25});
  repaired.work_on(3);
  const VolumeRead proposed = repaired.written("before.seg.nrrd");
  const StructureLooks before = driver.state().look.structures;
  const fs::path file = repaired.stones.folder.path / "stones.homolog";
  driver.app().send(SaveCaseAs{{file}});
  driver.wait_until("it is saved", [&] { return driver.case_file() == file; });
  driver.settle();
  driver.app().send(open_phantom(Organ::kidney, 1));
  driver.wait_until("another case is open", [&] { return driver.case_file() != file; });
  driver.settle();
  CHECK(driver.state().look.structures.as_read.empty());

  driver.app().send(OpenFiles{{file}});
  driver.wait_until("the case is open again", [&] { return driver.case_file() == file; });
  driver.settle();
  const StructureLooks& looks = driver.state().look.structures;
  CHECK(looks.hidden == before.hidden);
  CHECK(looks.locked == before.locked);
  CHECK(looks.opacity == before.opacity);
  CHECK(driver.state().look.structure == hollow);
  REQUIRE(looks.as_read.size() == 2);
  CHECK(looks.as_read.at(missing) == nullptr);
  REQUIRE(looks.as_read.at(hollow));
  CHECK((*looks.as_read.at(hollow) == *before.as_read.at(hollow)));
  CHECK(voxels_of(repaired.written("after.seg.nrrd")) == voxels_of(proposed));
  driver.click("Take back");
  driver.settle();
  CHECK((*driver.document().structure(hollow)->shape(0)->points - *before.as_read.at(hollow)).cwiseAbs().maxCoeff() <
        1e-3);
}

TEST_CASE("the list says how sure the name of a structure is, until a person says that it is right") {
  RepairedStones repaired;
  Driver& driver = repaired.driver;
  const KeptMapFit* fit = driver.app().snapshot().kept.map_fit.get();
  REQUIRE(fit != nullptr);
  const auto named = [&](int k) {
    return name_confidence(driver.app().snapshot().kept.map_fit.get(), *driver.document().structure(repaired.id_of(k)));
  };
  CHECK(named(3) == fit->structures.at(repaired.id_of(3)).p_named);
  CHECK(named(3) > 0.5);
  CHECK(named(3) <= 1);
  CHECK(driver.shows("named"));
  driver.point_at("vertebrae_L4/vertebrae_L4");
  driver.settle();
  repaired.work_on(3);
  driver.click("It is right");
  driver.settle();
  CHECK(named(3) == 1);
  driver.app().send(ApplyEdit{SetStructure{.id = repaired.id_of(1), .name = "vertebrae_L9"}});
  driver.settle();
  const auto& renamed = driver.document().structures[1];
  CHECK(name_confidence(fit, *renamed) < 0);
}

TEST_CASE("what a repair changed is taken back in its own frame only") {
  RepairedStones repaired;
  Driver& driver = repaired.driver;
  repaired.work_on(3);
  const Points proposed = *driver.document().structure(repaired.id_of(3))->shape(0)->points;
  driver.state().look.structures.as_read_frame = 1;
  driver.settle();
  driver.point_at("Take back");
  driver.settle();
  CHECK(driver.shows("Another frame was repaired: 1."));
  driver.app().send(TakeBackRepair{});
  driver.settle();
  CHECK((*driver.document().structure(repaired.id_of(3))->shape(0)->points == proposed));
}

TEST_CASE("a body with a level more than the set is told of in the window, and its label stays in the mended map") {
  StonesOnDisk stones;
  SetOfTemplates set = stone_set();
  for (std::size_t k = 0; k < set.set.structures.size(); ++k) {
    TemplateOfSet& one = set.set.structures[k];
    one.file = stones.folder.path / (one.name + ".ply");
    for (const std::size_t n : {k - 1, k + 1})
      if (n < set.set.structures.size()) one.neighbours.push_back(name_of_stone(static_cast<int>(n)));
  }
  REQUIRE(write_template_set(set.set, stones.set));
  VolumeGeometry grid = stones.whole.volume.geometry;
  grid.dims[2] += 40;
  std::vector<MeshOfSegment> meshes;
  for (int k = 0; k < homolog::stones; ++k)
    meshes.push_back(
        {{name_of_stone(k), k + 1, 0, {}, {}}, stone_at(place_of(k) + Vec3(0, 0, k > 2 ? 34 : 0), radius_of(k), 1)});
  meshes.push_back({{"vertebrae_L6", 9, 0, {}, {}}, stone_at(place_of(3), radius_of(3), 1)});
  const VolumeRead six = std::move(map_of_meshes(meshes, grid).map);
  REQUIRE(write_segmentation(six, stones.labels));
  Driver driver(new_document(stones.labels.string(), std::make_shared<const Volume>(six.volume), nullptr));
  driver.app().send(open_labels(stones.labels));
  driver.settle();
  driver.app().send(ChooseSet{stones.set.string()});
  driver.wait_until("the set is read", [&] { return driver.state().automatic.set != nullptr; });
  driver.settle();
  driver.app().send(FitSet{});
  driver.wait_until("the set is fitted", [&] { return driver.document().structures.size() == 5; });
  driver.settle();
  CHECK(driver.shows("The label map has vertebrae_L6 between vertebrae_L3 and vertebrae_L4"));
  const fs::path file = stones.folder.path / "out.seg.nrrd";
  driver.app().send(ExportMendedMap{{file}});
  driver.wait_until("it is written", [&] { return driver.shows("Written: "); });
  const VolumeRead written = test::must(read_labels(file));
  CHECK(voxels_of(written) == voxels_of(six));
  CHECK(written.segmentation.find(9)->name == "vertebrae_L6");
}

TEST_CASE("a level whose name may be wrong is called doubtful with the name that it may have") {
  RepairedStones repaired;
  Driver& driver = repaired.driver;
  const std::string id = repaired.id_of(1);
  driver.app().send(ApplyEdit{SetStructure{
      .id = id, .confidence = 0.3, .doubt = sentence_of_defects({{DefectKind::level_shifted, "vertebrae_L3"}})}});
  driver.settle();
  repaired.work_on(1);
  CHECK(is_doubtful(*driver.document().structure(id)));
  CHECK(driver.shows("Found: level shifted (vertebrae_L3)."));
  driver.click("It is right");
  driver.settle();
  CHECK_FALSE(is_doubtful(*driver.document().structure(id)));
}

TEST_CASE("a repair that was taken back is said in its row, is not taken back twice and needs no more looking at") {
  RepairedStones repaired;
  Driver& driver = repaired.driver;
  const std::string hollow = repaired.id_of(3);
  const auto to_be_seen = [&](const std::string& id) {
    return is_to_be_seen(driver.state().look.structures, *driver.document().structure(id));
  };
  REQUIRE(to_be_seen(hollow));
  const std::string name = driver.document().structure(hollow)->name;
  for (const auto& one : driver.document().structures)
    if (one->id != hollow) driver.app().send(ApplyEdit{SetStructure{.id = one->id, .confidence = 1, .doubt = ""}});
  driver.settle();
  CHECK_FALSE(driver.shows("taken back"));
  repaired.work_on(3);
  driver.click("Take back");
  driver.settle();
  const std::vector<std::string> steps = driver.app().snapshot().undo_names;
  CHECK(steps.front() == name + " taken back");
  CHECK(driver.shows("taken back"));
  CHECK(driver.shows("Taken back: it is as the label map has it."));
  CHECK_FALSE(driver.control("Take back").enabled);
  CHECK(driver.control("Take back").tip.find("It was taken back.") != std::string::npos);
  CHECK_FALSE(to_be_seen(hollow));
  CHECK(listed_structures(driver.state().look.structures, driver.document()).back()->id == hollow);
  driver.app().send(TakeBackRepair{});
  driver.settle();
  CHECK(driver.app().snapshot().undo_names == steps);
  repaired.work_on(0);
  driver.press('K');
  driver.settle();
  CHECK(driver.shows("No other structure is doubtful."));
  driver.press('Z', {.ctrl = true});
  driver.settle();
  CHECK(driver.shows("Undone: " + name + " taken back."));
  CHECK(to_be_seen(hollow));
  driver.press('K');
  driver.settle();
  CHECK(driver.state().look.structure == hollow);
}

TEST_CASE("a case has its structure, its set and its recipe again where the program was ended and its folder moved") {
  const TemporaryFolder moved;
  const std::string recipe = shipped_recipes().front();
  std::string hollow;
  {
    RepairedStones repaired;
    Driver& driver = repaired.driver;
    const fs::path file = repaired.stones.folder.path / "stones.homolog";
    hollow = repaired.id_of(3);
    driver.app().send(SaveCaseAs{{file}});
    driver.wait_until("it is saved", [&] { return driver.case_file() == file; });
    repaired.work_on(3);
    driver.app().send(ShowAsRead{false});
    driver.app().send(ChooseRecipe{recipe});
    driver.wait_until("the recipe is read", [&] { return driver.state().measurements.source == recipe; });
    driver.app().send(DrawMeasurement{"a measurement", true});
    driver.settle();
    constexpr int more_than_a_second = 100;
    driver.frames(more_than_a_second);
    driver.settle();
    CHECK(driver.lines_with(R"("set":"stones.set.json")") > 0);
    // The program has no time to do more.
    fs::copy(repaired.stones.folder.path, moved.path, fs::copy_options::recursive);
  }
  Driver driver(new_document({}, nullptr, nullptr), {1280, 1600, 1});
  const fs::path file = moved.path / "stones.homolog";
  SUBCASE("all is there") {
    driver.app().send(OpenFiles{{file}});
    driver.wait_until("the case is open", [&] { return driver.case_file() == file; });
    driver.wait_until("the set is read", [&] { return driver.state().automatic.set != nullptr; });
    driver.wait_until("the recipe is read", [&] { return driver.state().measurements.source == recipe; });
    driver.settle();
    CHECK(driver.state().automatic.set_source == (moved.path / "stones.set.json").string());
    CHECK(driver.state().measurements.drawn == std::set<std::string>{"a measurement"});
  }
  SUBCASE("the set is gone") {
    fs::remove(moved.path / "stones.set.json");
    driver.app().send(OpenFiles{{file}});
    driver.wait_until("the case is open", [&] { return driver.case_file() == file; });
    driver.settle();
    CHECK(driver.state().automatic.set == nullptr);
    for (const Notice& notice : driver.state().notices) CHECK(notice.text.find(".set.json") == std::string::npos);
  }
  CHECK(driver.state().look.structure == hollow);
  CHECK_FALSE(driver.state().look.structures.as_read_shown);
  // Nothing was done, so nothing is written.
  const int lines = driver.lines_with("\"looks\"");
  driver.frames(200);
  driver.settle();
  CHECK(driver.lines_with("\"looks\"") == lines);
}

}  // namespace homolog
