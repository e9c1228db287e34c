#include <doctest/doctest.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "app/editor/state/files/file_browser.h"
#include "app/editor/state/views.h"
#include "app/editor/update/file_purposes.h"
#include "tests/driver.h"
#include "tests/named_case.h"
#include "tests/skip.h"

// What the window does beyond its layout: menus, notices, letters, its title, dialogs, views.

namespace homolog {

namespace fs = std::filesystem;

TEST_CASE("Escape closes a menu and a click beside it does what it is for") {
  Driver driver(new_document({}, nullptr, nullptr));
  driver.press(key::tab);
  driver.click("Study");
  CHECK(driver.has("study menu/New study\xe2\x80\xa6"));
  driver.press(key::escape);
  CHECK_FALSE(driver.has("study menu/New study\xe2\x80\xa6"));

  const auto press_on = [&](const char* name) {
    const RectPx at = driver.control(name).seen;  // an open menu may lie over it
    driver.move(at.x + at.width / 2, at.y + at.height / 2);
    driver.frame();
    driver.button(MouseButton::left, true);
    driver.button(MouseButton::left, false);
    driver.frames(3);
  };
  driver.click("Study");
  press_on("cases/Study");  // its own button closes it
  CHECK_FALSE(driver.has("study menu/New study\xe2\x80\xa6"));
  driver.click("Study");
  CHECK(driver.has("study menu/New study\xe2\x80\xa6"));
  press_on("top bar/keys");
  CHECK_FALSE(driver.has("study menu/New study\xe2\x80\xa6"));
  CHECK(driver.state().dialog);
}

TEST_CASE("an error goes by Escape and after a while but not while a dialog covers it") {
  Driver driver(new_document({}, nullptr, nullptr));
  add_notice(driver.state(), "ct.nii.gz could not be read.");
  driver.frames(2);
  CHECK(driver.shows("ct.nii.gz could not be read."));
  driver.press(key::escape);
  CHECK_FALSE(driver.shows("ct.nii.gz could not be read."));

  add_notice(driver.state(), "ct.nii.gz could not be read.");
  driver.app().update(1000);
  driver.app().update(1030);
  driver.state().dialog = KeysDialog{};
  driver.app().update(1100);
  CHECK(driver.state().notices.size() == 1);
  driver.state().dialog.reset();
  driver.app().update(1101);
  CHECK(driver.state().notices.empty());
}

namespace {
constexpr const char* kidney_in_japanese = "\xe8\x85\x8e\xe8\x87\x93";
constexpr ImWchar first_letter_of_it = 0x814E;
}  // namespace

TEST_CASE("a name in Chinese or Japanese or Korean is drawn in its letters") {
  if (!fs::exists("/usr/share/fonts/truetype/droid/DroidSansFallbackFull.ttf"))
    return test::skip("fonts-droid-fallback is not installed");
  Driver driver(new_document({}, nullptr, nullptr));
  const auto known = [] { return ImGui::GetIO().Fonts->Fonts[0]->FindGlyphNoFallback(first_letter_of_it) != nullptr; };
  CHECK_FALSE(known());
  add_notice(driver.state(), std::string(kidney_in_japanese) + ".nii.gz is open.", false);
  driver.frames(3);
  CHECK(known());
  driver.resize({1280, 800, 2});
  CHECK(known());
  CHECK_FALSE(driver.shows("fonts-"));
}

namespace {

constexpr const char* kidney_in_korean = "\xec\xbd\xa9\xed\x8c\xa5";

/// What the window says of a name in letters that the program's own font lacks.
std::string said_of(const std::string& name) {
  Driver driver(new_document({}, nullptr, nullptr));
  add_notice(driver.state(), name + ".nii.gz is open.", false);
  driver.frames(3);
  return driver.state().notices.size() < 2 ? std::string() : driver.state().notices.back().text;
}

}  // namespace

TEST_CASE("where no font has the letters of a name the package that has them is named") {
  {
    const EnvironmentVariable nowhere("XDG_DATA_DIRS", "/nowhere");
    CHECK(said_of(kidney_in_japanese).find("fonts-noto-cjk") != std::string::npos);
    CHECK(said_of("\xd9\x83\xd9\x84\xd9\x8a\xd8\xa9").find("shown as \"?\"") != std::string::npos);  // Arabic
  }
  const fs::path droid = "/usr/share/fonts/truetype/droid/DroidSansFallbackFull.ttf";
  if (!fs::exists(droid)) return test::skip("fonts-droid-fallback is not installed");
  const TemporaryFolder fonts;
  const EnvironmentVariable only_these("XDG_DATA_DIRS", fonts.path);
  fs::create_directories(fonts.path / "fonts/truetype/droid");
  fs::create_symlink(droid, fonts.path / "fonts/truetype/droid" / droid.filename());
  CHECK(said_of(kidney_in_japanese).empty());
  CHECK(said_of(kidney_in_korean).find("fonts-noto-cjk") != std::string::npos);
  // The package that is named is looked for; another font stands in for it.
  fs::create_directories(fonts.path / "fonts/opentype/noto");
  fs::rename(fonts.path / "fonts/truetype/droid" / droid.filename(),
             fonts.path / "fonts/opentype/noto/NotoSansCJK-Regular.ttc");
  CHECK(said_of(kidney_in_japanese).empty());
}

TEST_CASE("the window's title says what is open and whether it is saved and what runs") {
  const Named named({"kidney"});
  Driver driver(named.document);
  CHECK(driver.app().title() == "case.homolog \xe2\x80\x93 Homolog");
  driver.app().start_session(EditSession(named.document));
  driver.settle();
  CHECK(driver.app().title() == "kidney.nii.gz \xe2\x80\x93 Homolog");
  driver.app().send(ApplyEdit{SetStiffnessBase{7}, false});
  driver.settle();
  CHECK(driver.app().title() == "kidney.nii.gz, not saved \xe2\x80\x93 Homolog");
  driver.app().send(ShowModels{true});
  driver.settle();
  CHECK(driver.app().title() == "No study \xe2\x80\x93 Homolog");
  driver.app().send(NewStudy{{named.folder.path / "hips.study.json"}});
  driver.settle();
  CHECK(driver.app().title() == "hips \xe2\x80\x93 Homolog");
  driver.state().models.runs.modelling = true;
  CHECK(driver.app().title() == "hips, making the model \xe2\x80\x93 Homolog");
}

TEST_CASE("file dialogs start beside the open image and make folders") {
  const Named named({"kidney"});
  Driver driver(named.document);
  const fs::path beside = driver.case_file().parent_path(), of_image = named.labels.parent_path();
  driver.state().preferences.folder = "/";
  driver.click("open");
  const auto browser = [&]() -> const FileBrowser& { return std::get<FileDialog>(*driver.state().dialog).browser; };
  CHECK(browser().folder == of_image);
  driver.press(key::escape);
  driver.press('S', {true, true, false});
  CHECK(browser().folder == beside);
  driver.click("New folder");
  driver.frames(3);
  driver.type("hips");
  driver.press(key::enter);
  driver.settle();
  CHECK(fs::is_directory(beside / "hips"));
  CHECK(browser().folder == beside / "hips");

  driver.click("New folder");
  driver.frames(3);
  driver.type("a/b/c");
  driver.click("Make it");
  CHECK(driver.shows("cannot be made"));
  driver.click("New folder");
  driver.press(key::escape);
  CHECK(driver.has("New folder"));
  driver.press(key::escape);
  CHECK_FALSE(driver.state().dialog);
}

TEST_CASE("the slices zoom together where that is wished and each by itself else") {
  const Named named({"kidney"});
  Driver driver(named.document);
  driver.click("Linked zoom");
  const auto scales = [&] {
    std::set<double> all;
    for (const SlicePan& pan : driver.state().look.slices) all.insert(std::round(1e6 * pan.mm_per_px));
    return all;
  };
  CHECK(scales().size() == 1);
  const RectPx& axial = driver.app().layout().image(ViewKind::axial);
  const auto turn = [&] {
    driver.move(axial.x + axial.width / 3, axial.y + axial.height / 3);
    InputEvent event{Wheel{3}, axial.x + axial.width / 3, axial.y + axial.height / 3, false, true, false, 0, false};
    driver.app().handle(event);
    driver.frames(2);
  };
  const auto before = scales();
  turn();
  CHECK(scales().size() == 1);
  CHECK(scales() != before);
  driver.click("Linked zoom");
  turn();
  CHECK(scales().size() == 2);
}

TEST_CASE("one key goes through the looks of the slices in the 3D view") {
  const Named named({"kidney"});
  Driver driver(named.document);
  const auto shown = [&] { return shown_planes(driver.state(), driver.document()); };
  CHECK(shown().front().opacity < 1);
  driver.press('T');
  CHECK(shown().front().behind_meshes);
  driver.press('T');
  CHECK(shown().front().opacity == 1);
  CHECK_FALSE(shown().front().behind_meshes);
  driver.press('T');
  CHECK(shown().empty());
  driver.press('T');
  CHECK(shown().front().opacity < 1);
}

TEST_CASE("the image fills the view also along its own planes") {
  Volume volume;
  volume.geometry.dims = {200, 160, 4};
  volume.geometry.direction = Eigen::AngleAxisd(0.7, Vec3(1, 1, 0).normalized()).toRotationMatrix();
  volume.data = std::vector<std::uint8_t>(volume.geometry.voxels(), 1);
  Document document = new_document("", std::make_shared<const Volume>(std::move(volume)), nullptr);
  Driver driver(document);
  driver.click("The image's own planes");
  driver.press('F');
  const RectPx& rect = driver.app().layout().image(ViewKind::axial);
  const double mm_per_px = driver.state().look.slices[index_of(ViewKind::axial)].mm_per_px;
  const double filled = std::max(200 / (mm_per_px * rect.width), 160 / (mm_per_px * rect.height));
  CHECK(filled > 0.95);
  CHECK(filled <= 1);
}

TEST_CASE("along the image's own planes the whole image is seen where it was before and else the same place") {
  Volume volume;
  volume.geometry.dims = {200, 160, 4};
  volume.geometry.direction = Eigen::AngleAxisd(0.7, Vec3(1, 1, 0).normalized()).toRotationMatrix();
  volume.data = std::vector<std::uint8_t>(volume.geometry.voxels(), 1);
  Driver driver(new_document("", std::make_shared<const Volume>(std::move(volume)), nullptr));
  const auto zoom = [&] { return driver.state().look.slices[index_of(ViewKind::axial)].mm_per_px; };
  const double whole = zoom();
  driver.click("The image's own planes");
  const RectPx& rect = driver.app().layout().image(ViewKind::axial);
  CHECK(std::max(200 / (zoom() * rect.width), 160 / (zoom() * rect.height)) > 0.95);
  driver.click("The image's own planes");
  CHECK(zoom() == doctest::Approx(whole));
  driver.move(rect.x + 80, rect.y + 80);
  driver.hold_keys({false, true, false});
  driver.wheel(3);
  driver.hold_keys({});
  const double close = zoom();
  CHECK(close < whole);
  driver.click("The image's own planes");
  CHECK(zoom() == close);
}

}  // namespace homolog
