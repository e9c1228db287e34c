#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include "app/sample/sample.h"
#include "core/base/files/files.h"
#include "core/base/pictures/picture_io.h"
#include "tests/driver.h"
#include "tests/must.h"
#include "tests/screens.h"

// docs/heart.md, step by step as its reader does it in the window. The pictures of the page are left in
// build/PRESET/heart; who changes the window looks at them and copies them to docs/images/heart.

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// The window of the page, and what is left of each step.
struct HeartTour {
  std::unique_ptr<OffscreenContext> gl = test::context_or_skip();
  Driver driver{new_document({}, nullptr, nullptr), {920, 640, 1}};
  fs::path heart = driver.folder() / "heart", pictures = fs::path(HOMOLOG_BINARY_DIR) / "heart";
  std::string page = test::must(read_whole_file(fs::path(HOMOLOG_SOURCE_DIR) / "docs/heart.md"));

  HeartTour() { fs::create_directories(pictures); }
  /// With 32 shades of each colour, a file is half as large.
  void leave_picture(const std::string& name) {
    driver.state().notices.clear();
    driver.move(driver.app().layout().status_line.x + 4, driver.app().layout().status_line.y + 4);
    driver.settle();
    CHECK(page.find("images/heart/" + name + ".png") != std::string::npos);
    if (!gl) return;
    Picture picture = driver.picture();
    for (std::uint8_t& shade : picture.rgba) shade = static_cast<std::uint8_t>((shade & 0xF8) | (shade >> 5));
    REQUIRE(write_picture(picture, pictures / (name + ".png")));
    CHECK(fs::file_size(pictures / (name + ".png")) < 150'000);
  }
  void open_only(const std::string& section) {
    for (const char* title : {"Case", "Structures", "Cine", "Template", "Place", "Deform", "Correspondence", "Export"})
      driver.app().send(OpenSection{title, title == section});
    driver.settle();
  }
  void press_and_wait(const std::string& control) {
    driver.click(control);
    driver.settle();
  }
  void save_as(const std::string& name) {
    driver.type_into("name", (heart / name).string());
    driver.press(key::enter);
    driver.settle();
  }
  /// The window shows it, and the page says it.
  void both_say(const std::string& words) {
    CAPTURE(words);
    CHECK(driver.shows(words));
    CHECK(page.find(words) != std::string::npos);
  }
};

}  // namespace

TEST_CASE("the page of the heart says what its reader sees from the cine to the curve and to the model") {
  HeartTour tour;
  Driver& driver = tour.driver;
  REQUIRE(write_sample(tour.heart));

  driver.app().send(OpenFiles{{tour.heart / "heart-cine.nii.gz", tour.heart / "heart-cine-labels.nii.gz"}});
  driver.wait_until("the cine is open", [&] { return driver.document().scan.image != nullptr; });
  tour.open_only("Cine");
  driver.type_into("Cine/Frame/value", "18");
  driver.press(key::enter);
  driver.settle();
  tour.open_only("Case");
  tour.press_and_wait("Case/It is of this frame");
  tour.open_only("Cine");
  tour.leave_picture("cine");

  tour.open_only("Template");
  tour.press_and_wait("Template/Make the template");
  tour.leave_picture("template");
  tour.press_and_wait("Template/Save and use…");
  tour.save_as("ventricle");

  tour.open_only("Cine");
  tour.press_and_wait("Cine/Propagate");
  for (const char* words : {"187.4 ml, frame 18", "139.5 ml, frame 7", "25.6 %", "no frame"}) tour.both_say(words);
  tour.leave_picture("curve");
  tour.press_and_wait("Cine/Volumes…");
  tour.save_as("volumes.csv");
  CHECK(fs::exists(tour.heart / "volumes.csv"));

  tour.open_only("Case");
  tour.press_and_wait("Case/Save as…");
  tour.save_as("heart");
  tour.press_and_wait("top bar/mode/Models");
  tour.press_and_wait("cases/Meshes…");
  tour.save_as("heart.homolog");
  tour.press_and_wait("cases/heart/row");
  tour.press_and_wait("Add its 19 other frames as cases");
  tour.press_and_wait("alignment/As they lie");
  for (const char* words : {"2 of 19 hold 95.9 %", "87.3 %"}) tour.both_say(words);
  driver.type_into("1  87.3 %/value", "-2");
  driver.press(key::enter);
  driver.settle();
  tour.leave_picture("model");
  tour.press_and_wait("Export model…");
  tour.save_as("beat.h5.json");
  CHECK(fs::exists(tour.heart / "beat.h5.json"));
}

}  // namespace homolog
