#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "app/editor/update/controls.h"
#include "app/editor/update/status.h"
#include "core/base/files/files.h"
#include "core/case/edit_words.h"
#include "core/case/held_landmarks.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/volume/labels/label_likeness.h"
#include "core/volume/volume_io.h"
#include "tests/beating_ball.h"
#include "tests/driver.h"
#include "tests/must.h"
#include "tests/organ_scan.h"
#include "tests/real_data.h"

// What the window takes files for, what it writes, and what it says of edits.

namespace homolog {

namespace {

namespace fs = std::filesystem;

void apply_and_wait(Driver& driver, Action action) {
  driver.app().send(ApplyEdit{std::move(action), false});
  driver.settle();
}

bool is_in_notices(Driver& driver, std::string_view words) {
  return std::any_of(driver.state().notices.begin(), driver.state().notices.end(),
                     [&](const Notice& one) { return one.text.find(words) != std::string::npos; });
}

/// Blocks of `block` voxels, each with a value of its own, `step` apart.
Volume map_of_blocks(int block, int step) {
  Volume map;
  map.geometry = OrganScan::grid();
  std::vector<std::uint16_t> values(map.geometry.voxels());
  for (std::size_t v = 0; v < values.size(); ++v) {
    const int i = static_cast<int>(v % 64) / block, j = static_cast<int>(v / 64 % 64) / block;
    values[v] = static_cast<std::uint16_t>((1 + i + j * (64 / block)) * step);
    map.range_max = std::max(map.range_max, static_cast<double>(values[v]));
  }
  map.data = std::move(values);
  return map;
}

/// A scan without negative values, with noise as cameras have it.
Volume noisy_image() {
  Volume image;
  image.geometry = OrganScan::grid();
  std::vector<std::uint16_t> values(image.geometry.voxels());
  std::uint32_t random = 1;
  for (auto& value : values) {
    random = random * 1664525U + 1013904223U;
    value = static_cast<std::uint16_t>(60 + (random >> 24U) / 16);
  }
  image.data = std::move(values);
  image.range_max = 80;
  return image;
}

}  // namespace

TEST_CASE("label maps of many labels and of large values are opened beside their image in either order") {
  for (const auto& [block, step] : {std::pair(8, 1), std::pair(8, 225), std::pair(4, 1)}) {  // 64 and 256 labels
    CAPTURE(block);
    CAPTURE(step);
    Driver driver(new_document("", nullptr, nullptr));
    const fs::path image = driver.folder() / "image.nii", map = driver.folder() / "map.nii";
    REQUIRE(write_volume(*OrganScan::image(), image));
    REQUIRE(write_volume(map_of_blocks(block, step), map));
    for (const auto& files : {std::vector{image, map}, std::vector{map, image}}) {
      driver.app().open(files);
      driver.settle();
      CHECK(driver.document().scan.source == image.string());
      CHECK(driver.shows("map.nii"));
      driver.app().send(OpenSection{"Place", true});
      CHECK(driver.state().notices.size() == 1);
      driver.state().notices.clear();
    }
    // Dropped alone on the image that is open.
    driver.app().send(CloseLabels{});
    driver.app().open({map});
    driver.settle();
    CHECK(driver.document().scan.source == image.string());
    CHECK(is_in_notices(driver, "is shown as a label map"));
  }
}

TEST_CASE("a grey image is not taken for a label map and the sentence is said whole") {
  Driver driver(new_document("", nullptr, nullptr), {800, 600, 1});
  const fs::path image = driver.folder() / "image.nii", grey = driver.folder() / "grey.nii";
  REQUIRE(write_volume(*OrganScan::image(), image));
  Volume noisy = noisy_image();
  CHECK_FALSE(holds_labels(noisy));  // of 16 grey values in all
  for (auto& value : std::get<std::vector<std::uint16_t>>(noisy.data)) value = static_cast<std::uint16_t>(20 * value);
  noisy.range_max = 1600;
  REQUIRE(write_volume(noisy, grey));
  driver.app().open({image, grey});
  driver.settle();
  CHECK_FALSE(driver.document().scan.image);
  REQUIRE(driver.state().notices.size() == 1);
  const std::string& said = driver.state().notices.front().text;
  CHECK(said.find("is a second image, and not a label map with the voxels of image.nii") != std::string::npos);
  CHECK(driver.shows("not a label map with the voxels of image.nii; open one image at a time"));
}

TEST_CASE("real scans are no label maps and real label maps are") {
  const fs::path data = real_data();
  if (data.empty()) return;
  for (const char* name : {"lv_cine/sunnybrook_SC-HF-I-1_ED_img.nii.gz", "spine_mr/vb3_01_image.nii.gz",
                           "lv_cine/bivme_patient1_sax_cine4d.nii.gz", "ct/totalseg_example_ct_3mm.nii.gz"})
    CHECK_MESSAGE(!holds_labels(test::must(read_volume(data / name)).volume), name);
  for (const char* name : {"lv_cine/sunnybrook_SC-HF-I-1_ED_label.nii.gz", "spine_mr/vb3_01_labels.nii.gz",
                           "vertebra_L1/verse004_T9-L5_masks.nii.gz", "ct/totalseg_example_ct_3mm_label.nii.gz",
                           "ct/tptbox_L3_subregion_mask.nii.gz"})
    CHECK_MESSAGE(holds_labels(test::must(read_volume(data / name)).volume), name);
}

TEST_CASE("of a cine all meshes are written with their frames' numbers or the one that is shown") {
  Document document = BeatingBall::document();
  EditSession session(document);
  for (const int frame : {1, 2, 3, 4, 5})
    REQUIRE(session.apply(points_edit(*session.document().view(), frame,
                                      (1 - 0.05 * frame) * *document.view()->shape.points, PointsFinder("test"))));
  Driver driver(session.document(), {1280, 1400, 1});
  driver.click("side panel/Export");
  const fs::path out = driver.folder() / "out";
  fs::create_directories(out);
  const auto write = [&](const char* button, const std::string& name) {
    driver.state().notices.clear();
    driver.click(button);
    driver.type_into("name", (out / name).string());
    driver.press(key::enter);
    driver.settle();
  };
  driver.app().send(ShowFrame{2});
  driver.settle();
  write("Export/Mesh…", "heart.ply");
  for (int frame = 0; frame < BeatingBall::frames; ++frame) {
    const Mesh written = test::must(read_mesh(out / ("heart-frame-0" + std::to_string(frame) + ".ply")));
    CHECK(written.points.isApprox(*driver.document().structure()->shape(frame)->points, 1e-5));
  }
  CHECK_FALSE(fs::exists(out / "heart.ply"));
  write("Export/Label map…", "heart.nii.gz");
  for (int frame = 0; frame < BeatingBall::frames; ++frame)
    CHECK(fs::exists(out / ("heart-frame-0" + std::to_string(frame) + ".nii.gz")));
  const auto voxels = [&](int frame) {
    return labels_of(test::must(read_volume(out / ("heart-frame-0" + std::to_string(frame) + ".nii.gz"))).volume).at(1);
  };
  CHECK(voxels(5) < 0.7 * static_cast<double>(voxels(0)));
  // Those that are there already are not replaced unasked.
  write("Export/Mesh…", "heart.ply");
  CHECK(driver.shows("heart-frame-00.ply exists already."));
  driver.press(key::escape);
  driver.click("frames/This one");
  write("Export/Mesh…", "one.ply");
  CHECK(test::must(read_mesh(out / "one.ply")).points.isApprox(*driver.document().structure()->shape(2)->points, 1e-5));
  CHECK_FALSE(fs::exists(out / "one-frame-02.ply"));
}

TEST_CASE("a label map of one frame is shown at its frame of a cine and leads there") {
  Driver driver(BeatingBall::document(), {1280, 1400, 1});
  const fs::path map = driver.folder() / "labels.nii";
  REQUIRE(write_volume(label_map(icosphere(3, 25), driver.document().scan.image->geometry, 1), map));
  driver.app().send(ShowFrame{3});
  driver.settle();
  driver.app().send(open_labels(map));
  driver.wait_until("it is open", [&] { return driver.shows("labels.nii"); });
  driver.settle();
  CHECK(is_in_notices(driver, "It is shown at frame 3"));
  const auto label_at_middle = [&] {
    const RectPx& view = driver.app().layout().image(ViewKind::axial);
    driver.move(view.x + view.width / 2 + 9, view.y + view.height / 2 + 9);
    driver.settle();
    return driver.shows("label 1");
  };
  CHECK(label_at_middle());
  driver.app().send(ShowFrame{0});
  driver.settle();
  CHECK_FALSE(label_at_middle());
  driver.app().send(OpenSection{"Place", true});
  driver.frames(3);
  CHECK_FALSE(driver.control("Place/Fit to the label").enabled);
  CHECK(driver.control("Place/Fit to the label").tip.find("belongs to frame 3") != std::string::npos);
  driver.click("Belongs to");
  driver.settle();
  CHECK(driver.document().frame == 3);
  driver.app().send(ShowFrame{5});
  driver.settle();
  driver.click("It is of this frame");
  driver.settle();
  CHECK(label_at_middle());
}

TEST_CASE("undo names tool and size and place") {
  const OrganScan scan;
  Driver driver(scan.document());
  Stroke pull;
  pull.at = Vec3(0, 20, 0);
  pull.to = Vec3(0, 23.2, 0);
  pull.sigma_mm = 8;
  apply_and_wait(driver, pull);
  CHECK(driver.app().snapshot().undo_names.front() == "pull 3.2 mm, posterior");
  pull.tool = Tool::grab;
  pull.at = driver.document().view()->shape.points->row(0);
  const Points& points = *driver.document().view()->shape.points;
  for (const auto& [axis, high, words] : {std::tuple(0, false, "right"), std::tuple(0, true, "left"),
                                          std::tuple(1, false, "anterior"), std::tuple(2, false, "near lower end")}) {
    Vec3 at = Vec3::Zero();
    at[axis] = high ? 20 : -20;
    if (axis == 2) at = 20 * Vec3(std::sin(2.1), 0, std::cos(2.1));
    pull.at = at;
    pull.to = 1.05 * at;
    CHECK(edit_words(pull, driver.document().view()) == std::string("grab 1.0 mm, ") + words);
  }
  CHECK(points.rows() > 0);
  CHECK(edit_words(Confirm{Vec3(-20, 0, 0), 6.5, true}, driver.document().view()) == "confirm 6.5 mm, right");
  CHECK(edit_words(SetStiffnessBase{3}, driver.document().view()) == "stiffness");
  driver.click("history");
  CHECK(driver.has("history/Undo: pull 3.2 mm, posterior"));
  driver.press(key::escape);
  CHECK(driver.control("top bar/undo").tip == "Undo: pull 3.2 mm, posterior (Ctrl+Z)");
  driver.press('Z', {false, true, false});
  driver.settle();
  CHECK(driver.shows("Undone: pull 3.2 mm, posterior."));
}

TEST_CASE("where something that is held keeps the mesh from following the reason is said") {
  const OrganScan scan;
  Driver driver(scan.document());
  apply_and_wait(driver, PlaceLandmark{"upper end", Vec3(0, 0, 20)});
  apply_and_wait(driver, Confirm{Vec3(0, 0, 20), 4, true});
  Stroke grab;
  grab.tool = Tool::grab;
  grab.at = 20 * Vec3(std::sin(0.3), 0, std::cos(0.3));
  grab.to = grab.at + Vec3(-8, 0, 0);
  grab.sigma_mm = 6;
  apply_and_wait(driver, grab);
  CHECK(driver.app().snapshot().message.find("is held. Its lock in Place releases it.") != std::string::npos);
  CHECK(driver.shows("\"upper end\""));
  Stroke free = grab;
  free.at = Vec3(20, 0, 0);
  free.to = Vec3(24, 0, 0);
  apply_and_wait(driver, free);
  CHECK(driver.app().snapshot().message.empty());
}

TEST_CASE("after landmarks are undone the next one is the first that is missing") {
  const OrganScan scan;
  Driver driver(scan.document());
  apply_and_wait(driver, SetLandmarkPull{LandmarkPull::off});
  driver.press('L');
  const RectPx& view = driver.app().layout().image(ViewKind::axial);
  for (const int k : {0, 1}) {
    driver.move(view.x + view.width / 2 + 30.0f * static_cast<float>(k), view.y + view.height / 2 + 10);
    driver.button(MouseButton::left, true);
    driver.button(MouseButton::left, false);
    driver.settle();
  }
  REQUIRE(driver.document().view()->shape.landmarks.size() == 2);
  CHECK(landmark_in_hand(driver.state(), driver.document()) == "hilum");
  for (const char* next : {"lower end", "upper end"}) {
    driver.press('Z', {false, true, false});
    driver.settle();
    CHECK(landmark_in_hand(driver.state(), driver.document()) == next);
  }
  driver.press('Y', {false, true, false});
  driver.settle();
  CHECK(landmark_in_hand(driver.state(), driver.document()) == "lower end");
}

TEST_CASE("a landmark outside the image is said and B and C bring the brush into view") {
  const OrganScan scan;
  Driver driver(scan.document(), {800, 600, 1});
  apply_and_wait(driver, SetLandmarkPull{LandmarkPull::off});
  for (const char* section : {"Template", "Place"}) driver.app().send(OpenSection{section, true});
  driver.frames(3);
  for (const int letter : {'B', 'C'}) {
    driver.app().send(ChooseTool{MouseTool::pull});
    driver.settle();
    driver.press(letter);
    driver.settle();
    const DrawnItem& radius = driver.control("Brush radius/value");
    CHECK(radius.seen.height >= radius.rect.height);
  }
  driver.press('B');
  driver.settle();
  CHECK(driver.control("Paints factor/value").value == "0.2 \xc3\x97");
  CHECK(driver.shows("soft"));
  CHECK(driver.shows("stiff"));
  driver.press('L');
  driver.settle();
  driver.state().look.slices[0].mm_per_px = 1;
  driver.frames(2);
  const RectPx& view = driver.app().layout().image(ViewKind::axial);
  driver.move(view.x + 4, view.y + 6);
  driver.button(MouseButton::left, true);
  driver.button(MouseButton::left, false);
  driver.settle();
  REQUIRE(driver.document().view()->shape.landmarks.size() == 1);
  CHECK(is_in_notices(driver, "was placed outside the image"));
}

TEST_CASE("a built-in template is not taken into the next image and one of a file is with a word") {
  const OrganScan scan;
  const fs::path first = scan.folder.path / "first.nii", next = scan.folder.path / "next.nii";
  for (const fs::path& file : {first, next}) REQUIRE(write_volume(*OrganScan::image(), file));
  const auto open = [](Driver& driver, const fs::path& file) {
    driver.app().open({file});
    driver.wait_until("it is open", [&] { return driver.document().scan.source == file.string(); });
    driver.settle();
  };
  {
    Driver driver(new_document(first.string(), OrganScan::image(), test::must(load_template("built-in:kidney"))));
    open(driver, next);
    CHECK_FALSE(driver.document().view());
    CHECK(driver.has("Template/Kidney"));
  }
  Driver driver(scan.document());
  open(driver, next);
  CHECK(driver.document().view());
  CHECK(is_in_notices(driver, "The template organ.ply of the case before was placed in this image too."));
}

TEST_CASE("unsaved cases are offered once and what was undone is not and the views stay free") {
  Driver driver(OrganScan().document());
  const fs::path state = driver.folder() / "homolog";
  fs::create_directories(state);
  const std::string header = "{\"homolog\":1,\"volume\":\"../ct.nii.gz\"}\n";
  std::ofstream(state / "unsaved-1-1.homolog") << header << "{\"stiffness_base\":5}\n";
  std::ofstream(state / "unsaved-2-1.homolog") << header << "{\"stiffness_base\":5}\n{\"undo\":true}\n";
  const auto start_again = [&] {
    driver.state().unsaved_found = 0;
    EditorOptions options;
    options.files = {driver.case_file()};
    driver.app().start(options);
    driver.settle();
  };
  start_again();
  CHECK(driver.state().unsaved_found == 1);
  CHECK_FALSE(driver.state().dialog);
  CHECK_FALSE(is_in_notices(driver, "saved"));  // no card over the views
  CHECK(driver.shows("1 case was not saved. Unsaved cases (Case) recovers it."));
  CHECK(driver.has("Unsaved cases (1)…"));
  start_again();
  CHECK(driver.state().unsaved_found == 0);
  driver.click("Unsaved cases…");
  driver.wait_until("they are listed", [&] { return driver.state().dialog.has_value(); });
  CHECK(std::get<RecoverDialog>(*driver.state().dialog).found.size() == 1);
}

TEST_CASE("a long name of a landmark is whole beside how far it is off") {
  const OrganScan scan;
  Driver driver(scan.document({"left inferior articular process tip", "north", "south"}), {1280, 1400, 1});
  driver.click("side panel/Place");
  apply_and_wait(driver, SetLandmarkPull{LandmarkPull::off});
  const float before = driver.control("north/row").rect.y;
  apply_and_wait(driver, PlaceLandmark{"left inferior articular process tip", Vec3(0, 0, 31)});
  CHECK(driver.control("north/row").rect.y == before);
  bool whole = false;
  for (const DrawnItem& item : driver.items())
    whole = whole || (item.name == "left inferior articular process tip" && item.kind == DrawnItem::Kind::text);
  CHECK(whole);
  CHECK(driver.shows("11.0 mm off"));
}

}  // namespace homolog
