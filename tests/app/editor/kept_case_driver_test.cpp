#include <doctest/doctest.h>

#include <fstream>

#include "app/editor/state/key_codes.h"
#include "core/base/files/files.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/voxels/label_map.h"
#include "core/session/case_file.h"
#include "core/session/journal.h"
#include "core/session/unsaved_cases.h"
#include "core/volume/volume_io.h"
#include "tests/driver.h"
#include "tests/must.h"
#include "tests/organ_scan.h"
#include "tests/small_files.h"

// What a person is told when another program deletes, moves or changes the case that is open; and what a case brings
// back when it is opened again.

namespace homolog {

namespace {

namespace fs = std::filesystem;

constexpr InputRouter::Held with_ctrl{.ctrl = true};

/// A case of an organ in a folder of its own, open in the window.
struct OpenOrgan {
  OrganScan scan;
  Driver driver{new_document({}, nullptr, nullptr)};
  fs::path folder = scan.folder.path / "cases", file = folder / "r.homolog";

  OpenOrgan() {
    fs::create_directory(folder);
    Document document = scan.document();
    document.scan.source = (scan.folder.path / "scan.nii").string();
    REQUIRE(write_volume(*document.scan.image, document.scan.source));
    { REQUIRE(create_case(document, file)); }
    open();
  }
  void open() {
    driver.app().send(OpenFiles{{file}});
    driver.wait_until("the case is open", [&] { return driver.case_file() == file; });
    driver.settle();
  }
  void pull() {
    const Vec3 at = driver.document().view()->shape.points->row(0);
    driver.app().send(ApplyEdit{Stroke{Tool::pull, at, 1.1 * at, 8}});
    driver.settle();
  }
  int strokes_in(const fs::path& path) const { return test::must(read_case(path)).session.strokes(); }
  void close_dialog() {
    driver.press(key::escape);
    driver.settle();
  }
};

}  // namespace

TEST_CASE("a deleted case that is edited and saved in the window is on the disk again") {
  OpenOrgan organ;
  Driver& driver = organ.driver;
  SUBCASE("deleted before the edit") {
    fs::remove(organ.file);
    organ.pull();
    CHECK(driver.shows("was deleted or moved while it was open. It was written anew, with every edit."));
    driver.press('S', with_ctrl);
    driver.settle();
  }
  SUBCASE("deleted after the edit and then saved") {
    organ.pull();
    fs::remove(organ.file);
    driver.press('S', with_ctrl);
    driver.settle();
    CHECK(driver.shows("was deleted or moved while it was open. It was written anew, with every edit."));
  }
  CHECK(driver.shows("Saved: every edit is in " + organ.file.string()));
  CHECK(organ.strokes_in(organ.file) == 1);
  driver.press('Q', with_ctrl);
  driver.settle();
  CHECK(driver.app().wants_to_quit());
}

TEST_CASE("a case that is deleted after its last edit is on the disk when the window closes") {
  OpenOrgan organ;
  organ.pull();
  fs::remove(organ.file);
  organ.driver.press('Q', with_ctrl);
  organ.driver.settle();
  CHECK(organ.driver.app().wants_to_quit());
  CHECK(organ.strokes_in(organ.file) == 1);
}

TEST_CASE("a case whose folder is gone is not saved and the window asks before it closes") {
  OpenOrgan organ;
  Driver& driver = organ.driver;
  bool edited = false;
  SUBCASE("deleted before the edit") {
    fs::remove_all(organ.folder);
  }
  SUBCASE("renamed after the edit") {
    organ.pull();
    edited = true;
    fs::rename(organ.folder, organ.scan.folder.path / "renamed");
  }
  if (!edited) organ.pull();
  driver.press('Q', with_ctrl);
  driver.settle();
  CHECK_FALSE(driver.app().wants_to_quit());
  CHECK(driver.shows("This case was not saved"));
  CHECK(driver.shows("It is kept, and offered again at the next start."));
  organ.close_dialog();
  CHECK(driver.app().title().find("not saved") != std::string::npos);
  CHECK(driver.case_file().parent_path() == unsaved_folder());
  CHECK(organ.strokes_in(driver.case_file()) == 1);
  CHECK_FALSE(driver.shows("Saved: every edit is in"));

  // Saved under a name it is as any other.
  const fs::path saved = organ.scan.folder.path / "saved.homolog";
  driver.press('S', with_ctrl);
  driver.settle();
  driver.type_into("name", saved.string());
  driver.press(key::enter);
  driver.wait_until("the case is saved", [&] { return driver.case_file() == saved; });
  driver.settle();
  CHECK(organ.strokes_in(saved) == 1);
  driver.press('Q', with_ctrl);
  driver.settle();
  CHECK(driver.app().wants_to_quit());
}

TEST_CASE("what another program wrote in place of the open case stays and nothing is said to be saved there") {
  OpenOrgan organ;
  Driver& driver = organ.driver;
  organ.pull();
  const std::string theirs = read_whole_file(organ.file).value() + "{\"note\":\"theirs\"}\n";
  const fs::path beside = organ.folder / "beside";
  std::ofstream(beside) << theirs;
  fs::rename(beside, organ.file);
  driver.press('S', with_ctrl);
  driver.settle();
  CHECK(driver.shows("was changed by another program while it was open."));
  CHECK_FALSE(driver.shows("Saved: every edit is in"));
  CHECK(read_whole_file(organ.file).value() == theirs);
  CHECK(organ.strokes_in(driver.case_file()) == 1);
  driver.press('Q', with_ctrl);
  driver.settle();
  CHECK_FALSE(driver.app().wants_to_quit());
}

TEST_CASE("a case that is left for another when its file is gone is kept and that is said") {
  OpenOrgan organ;
  Driver& driver = organ.driver;
  organ.pull();
  fs::remove_all(organ.folder);
  driver.app().send(OpenFiles{{organ.scan.folder.path / "scan.nii"}});
  driver.wait_until("the image is open", [&] { return driver.case_file() != organ.file; });
  driver.settle();
  CHECK(driver.shows("In the case before: The folder of " + organ.file.string()));
  std::string there;
  for (const auto& entry : fs::directory_iterator(unsaved_folder()))
    there += entry.path().string() + (Journal::in_use(entry.path()) ? " in use\n" : "\n");
  INFO(there);
  REQUIRE(unsaved_cases().size() == 1);
  CHECK(organ.strokes_in(unsaved_cases().front().journal) == 1);
}

TEST_CASE("a case opens again with its label map and with what its fit came to") {
  OpenOrgan organ;
  Driver& driver = organ.driver;
  const fs::path map = organ.scan.folder.path / "map.nii.gz";
  REQUIRE(write_volume(label_map(icosphere(4, 22), OrganScan::grid(), 3), map));
  driver.app().send(open_labels(map));
  driver.click("side panel/Place");
  driver.wait_until("the label map is shown", [&] {
    return driver.has("Place/Fit to the label") && driver.control("Place/Fit to the label").enabled;
  });
  driver.click("Place/Fit to the label");
  driver.wait_until("the fit is done", [&] { return driver.state().found.last_fit.has_value(); });
  driver.settle();
  CHECK(driver.shows("Distance to the label"));
  const double mean_mm = driver.state().found.last_fit->figures.mean_mm,
               dice = driver.state().found.last_fit->figures.dice.value();
  CHECK(read_whole_file(organ.file).value().substr(0, 400).find("\"labels\":\"../map.nii.gz\"") != std::string::npos);
  const std::size_t undo_steps = driver.app().snapshot().undo_names.size();

  const auto leave = [&] {
    driver.app().send(OpenFiles{{organ.scan.folder.path / "organ.ply"}});
    driver.wait_until("another case is open", [&] { return driver.case_file() != organ.file; });
    driver.settle();
    driver.app().send(CloseLabels{});
    driver.settle();
    CHECK_FALSE(driver.control("Place/Fit to the label").enabled);
  };
  leave();
  organ.open();
  CHECK(driver.control("Place/Fit to the label").enabled);
  CHECK(driver.shows("Distance to the label"));
  REQUIRE(driver.state().found.last_fit);
  CHECK(driver.state().found.last_fit->figures.mean_mm == mean_mm);
  CHECK(driver.state().found.last_fit->figures.dice.value() == dice);
  CHECK(driver.app().snapshot().undo_names.size() == undo_steps);

  // Without the file the case opens all the same.
  leave();
  const fs::path away = organ.scan.folder.path / "away.nii.gz";
  fs::rename(map, away);
  organ.open();
  CHECK(driver.shows("is not there any more. Put it back, or open it from where it is now"));
  CHECK_FALSE(driver.shows("Distance to the label"));
  CHECK(read_whole_file(organ.file).value().find("\"labels\":\"../map.nii.gz\"") != std::string::npos);

  // A label map that is closed is not opened again.
  fs::rename(away, map);
  leave();
  organ.open();
  driver.app().send(CloseLabels{});
  driver.settle();
  CHECK(read_whole_file(organ.file).value().find("\"labels\"") == std::string::npos);
}

TEST_CASE("the save dialog starts beside an image that was named without its folder") {
  OpenOrgan organ;
  Driver& driver = organ.driver;
  driver.state().preferences.folder = organ.folder;
  const fs::path before = fs::current_path();
  fs::current_path(organ.scan.folder.path);
  driver.app().open({"scan.nii"});
  driver.wait_until("the image is open", [&] { return driver.case_file() != organ.file; });
  driver.settle();
  fs::current_path(before);
  driver.press('S', with_ctrl);
  driver.settle();
  REQUIRE(driver.state().dialog);
  CHECK(std::get<FileDialog>(*driver.state().dialog).browser.folder == organ.scan.folder.path);
}

TEST_CASE("on a full disk a snap that was not made holds nothing, and the error goes when edits are written again") {
  OpenOrgan organ;
  Driver& driver = organ.driver;
  organ.pull();
  bool refused = false, held = false;
  {
    const SmallFilesOnly full(fs::file_size(organ.file));
    driver.app().send(SnapMesh{});
    driver.settle();
    refused = driver.shows("could not be written");
    held = driver.shows("Snap: held");
  }
  CHECK(refused);
  CHECK_FALSE(held);
  driver.app().send(SnapMesh{});
  driver.settle();
  CHECK(driver.shows("1 pull where you put them."));
  constexpr int some_seconds = 5 * 60;
  driver.frames(some_seconds);
  CHECK_FALSE(driver.shows("could not be written"));
}

TEST_CASE("a case with a line that cannot be played opens as it was before it, and its file stays") {
  OpenOrgan organ;
  Driver& driver = organ.driver;
  organ.pull();
  const fs::path bad = organ.folder / "bad.homolog";
  {
    std::ofstream text(bad);
    text << test::must(read_whole_file(organ.file)) << "{\"wobble\":1}\n{\"stiffness_base\":7}\n";
  }
  const std::string before = test::must(read_whole_file(bad));
  const auto lines = std::count(before.begin(), before.end(), '\n');
  driver.app().send(OpenFiles{{bad}});
  driver.wait_until("it is opened", [&] { return driver.case_file().empty(); });
  driver.settle();
  CHECK(driver.shows("bad.homolog: line " + std::to_string(lines - 1) + ": "));
  CHECK(driver.shows("You see the case as it was before that line. The file stays as it is"));
  CHECK(driver.document().view()->shape.strokes == 1);
  CHECK(driver.document().structure()->paint.base != 7);
  organ.pull();
  CHECK(driver.case_file().parent_path() == unsaved_folder());
  CHECK(organ.strokes_in(driver.case_file()) == 2);
  CHECK(test::must(read_whole_file(bad)) == before);
}

}  // namespace homolog
