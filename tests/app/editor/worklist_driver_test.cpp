#include <doctest/doctest.h>

#include <fstream>
#include <set>
#include <variant>

#include "app/editor/state/models/gallery.h"
#include "app/editor/update/controls.h"
#include "core/mesh/mesh_io.h"
#include "core/model/shapes/doubtful_shapes.h"
#include "core/session/case_file.h"
#include "tests/driver.h"
#include "tests/globe.h"
#include "tests/must.h"

// The study as a worklist: scans become cases, a template is made of them, and those that wait are fitted.

namespace homolog {

namespace {

const StudyCase& case_named(const Driver& driver, const std::string& name) {
  const StudyCase* one = find_case(const_cast<Driver&>(driver).state().models.study, name);
  if (one == nullptr) FAIL("no case is called " << name);
  return *one;
}

}  // namespace

TEST_CASE("scans of two folders that are called the same are two cases each of its own image") {
  const Globe globe;
  Driver driver(globe.document());
  driver.press(key::tab);
  std::vector<fs::path> scans;
  for (const double radius_mm : {16.0, 22.0}) {
    scans.push_back(globe.folder.path / std::to_string(static_cast<int>(radius_mm)) / "scan.nii");
    fs::create_directory(scans.back().parent_path());
    write_ball_map(scans.back(), radius_mm, Vec3::Zero());
    driver.app().send(AddScans{{scans.back()}});
    driver.wait_until("the scan is a case", [&] { return driver.state().models.study.cases.size() == scans.size(); });
    driver.settle();
  }
  for (std::size_t k = 0; k < 2; ++k) {
    const StudyCase& one = driver.state().models.study.cases[k];
    CHECK(one.labels == scans[k]);
    CHECK(fs::path(test::must(read_case(one.file)).session.document().scan.source) == scans[k]);
  }
  driver.app().send(AddScans{{scans[0]}});  // again: nothing new
  driver.settle();
  CHECK(driver.state().models.study.cases.size() == 2);
}

TEST_CASE("a folder of scans becomes a worklist that is fitted and gone through by one key") {
  const Globe globe;
  const fs::path scans = globe.folder.path / "scans";
  fs::create_directory(scans);
  write_ball_map(scans / "a_seg.nii", 18, {2, 0, 0});
  fs::rename(globe.image("a.nii"), scans / "a.nii");
  write_ball_map(scans / "b.nii", 16, {-3, 1, 0});
  write_ball_map(scans / "c.nii", 22, {0, 0, 2});
  Volume nothing;
  nothing.geometry = Globe::grid();
  nothing.data = std::vector<std::uint8_t>(nothing.geometry.voxels());
  REQUIRE(write_volume(nothing, scans / "empty.nii"));
  Driver driver(globe.document());
  driver.press(key::tab);
  driver.app().send(AddScans{{scans / "b.nii"}});
  driver.wait_until("the scans are cases", [&] { return driver.shows("4 scans were added."); });
  const auto& cases = driver.state().models.study.cases;
  REQUIRE(cases.size() == 4);
  CHECK(case_named(driver, "a").labels == scans / "a_seg.nii");
  CHECK(case_named(driver, "b").labels == scans / "b.nii");
  CHECK(std::all_of(cases.begin(), cases.end(), [](const StudyCase& one) { return one.waits(); }));
  CHECK(driver.state().models.shapes.shown.empty());

  driver.click("Fit waiting (4)");
  driver.wait_until("all are fitted", [&] { return driver.shows("1 case is in doubt and listed first"); });
  driver.settle();
  CHECK(case_named(driver, "b").state == CaseState::in_work);
  CHECK(case_named(driver, "empty").doubt.starts_with("Could not be fitted"));
  CHECK(cases[listed_cases(driver.state().models).front()].name == "empty");
  CHECK(driver.state().models.list.selected == "empty");
  const auto read = read_case(case_named(driver, "c").file);
  REQUIRE(read);
  CHECK(bounds_of(*read->session.document().view()->shape.points).sizes().x() == doctest::Approx(44).epsilon(0.05));
  CHECK(driver.state().models.shapes.shown.size() == 3);

  driver.app().send(OpenCaseOfStudy{"b", {}});
  driver.wait_until("b is open", [&] { return driver.case_file() == case_named(driver, "b").file; });
  driver.settle();
  driver.app().send(ApplyEdit{SetEvenSpacing{0.3}, false});
  driver.settle();
  CHECK(case_named(driver, "b").gestures == 1);
  driver.app().send(ApplyEdit{SetStiffnessBase{-1}, false});  // refused
  driver.settle();
  for (int touch = 0; touch < 4; ++touch)
    driver.app().send(ApplyEdit{PaintStiffness{Vec3::Zero(), 30, 20, 0.5}, touch > 0});
  driver.settle();
  CHECK(case_named(driver, "b").gestures == 2);
  driver.press(key::enter);
  driver.wait_until("the one in doubt is open", [&] { return driver.case_file() == case_named(driver, "empty").file; });
  CHECK(case_named(driver, "b").state == CaseState::done);

  // Added again, nothing that was done is lost.
  driver.app().send(AddScans{{scans}});
  driver.wait_until("that is said", [&] { return driver.shows("in the study already"); });
  CHECK(cases.size() == 4);
}

TEST_CASE("scans whose names hold dots are cases of their own and none vanishes") {
  const Globe globe;
  const fs::path scans = globe.folder.path / "scans";
  fs::create_directory(scans);
  const std::vector<std::string> subjects{"sub.01", "sub.02", "sub.03"};
  for (const std::string& subject : subjects) {
    fs::rename(globe.image(subject + ".nii"), scans / (subject + ".nii"));
    write_ball_map(scans / (subject + "_seg.nii"), 18, Vec3::Zero());
  }
  std::ofstream(scans / "loose.dcm") << "x";
  Driver driver(globe.document());
  driver.press(key::tab);
  driver.app().send(AddScans{{scans}});
  driver.wait_until("the scans are cases", [&] { return driver.shows("3 scans were added."); });
  driver.settle();
  CHECK(driver.shows("loose in it"));
  REQUIRE(driver.state().models.study.cases.size() == 3);
  for (const std::string& subject : subjects) {
    const StudyCase& one = case_named(driver, subject);
    CHECK(one.labels == scans / (subject + "_seg.nii"));
    CHECK(fs::path(test::must(read_case(one.file)).session.document().scan.source) == scans / (subject + ".nii"));
  }

  // Two maps of one image whose names differ by their endings alone.
  const fs::path twice = globe.folder.path / "twice";
  fs::create_directory(twice);
  fs::rename(globe.image("m_ct.nii"), twice / "m_ct.nii");
  write_ball_map(twice / "m.nii", 18, Vec3::Zero());
  write_ball_map(twice / "m.mha", 16, Vec3::Zero());
  driver.app().send(AddScans{{twice}});
  driver.wait_until("both maps are cases", [&] { return driver.shows("2 scans were added."); });
  driver.settle();
  std::set<fs::path> maps;
  for (const StudyCase& one : driver.state().models.study.cases) maps.insert(one.labels);
  CHECK(maps.contains(twice / "m.nii"));
  CHECK(maps.contains(twice / "m.mha"));
  CHECK(maps.size() == 5);
  fs::rename(globe.image("sub.04.nii"), scans / "sub.04.nii");
  driver.app().send(AddScans{{scans}});
  driver.wait_until("what is new is said",
                    [&] { return driver.shows("1 scan was added. 3 are in the study already."); });
}

TEST_CASE("what begins a case file is read without the rest of it") {
  const Globe globe;
  const fs::path scans = globe.folder.path / "scans", cases = globe.folder.path / "s-cases";
  fs::create_directory(scans);
  fs::create_directory(cases);
  write_ball_map(scans / "a.nii", 18, Vec3::Zero());
  // Something else of that name: a line of 100 GB, which takes no room on the disk.
  std::ofstream(cases / "a.homolog") << "{";
  fs::resize_file(cases / "a.homolog", std::uintmax_t{100} << 30);
  Driver driver(globe.document());
  driver.press(key::tab);
  driver.app().send(NewStudy{{globe.folder.path / "s.study.json"}});
  driver.settle();
  driver.app().send(AddScans{{scans}});
  driver.wait_until("the scan is a case", [&] { return driver.state().models.study.cases.size() == 1; });
  driver.settle();
  CHECK(driver.state().models.study.cases.front().file == cases / "a-2.homolog");
}

TEST_CASE("a worklist begins with the template mirrored as it is and fits it") {
  const Globe globe;
  const fs::path scans = globe.folder.path / "scans";
  fs::create_directory(scans);
  write_ball_map(scans / "a.nii", 18, Vec3::Zero());
  Driver driver(new_document("", nullptr, test::must(load_template("built-in:kidney"))));
  driver.app().send(ApplyEdit{MirrorTemplate{}, false});
  driver.settle();
  const Points mirrored = driver.document().structure()->the_template->points;
  driver.press(key::tab);
  driver.app().send(AddScans{{scans}});
  driver.wait_until("the scan is a case", [&] { return driver.state().models.study.cases.size() == 1; });
  driver.settle();
  const fs::path file = driver.state().models.study.cases.front().file;
  CHECK(test::must(read_case(file)).session.document().structure()->the_template->points == mirrored);
  driver.app().send(FitWaiting{});
  driver.wait_until("it is fitted", [&] { return waiting_cases(driver.state().models) == 0; });
  driver.settle();
  const Document fitted = test::must(read_case(file)).session.document();
  CHECK(fitted.structure()->the_template->points == mirrored);
  CHECK(bounds_of(*fitted.view()->shape.points).sizes().z() == doctest::Approx(36).epsilon(0.1));
}

TEST_CASE("two studies of one folder keep their cases apart and those of another template are said") {
  const Globe globe;
  const fs::path scans = globe.folder.path / "scans";
  fs::create_directory(scans);
  write_ball_map(scans / "a.nii", 18, Vec3::Zero());
  const auto of_study = [&](const std::string& study, const Document& document) {
    Driver driver(document);
    driver.press(key::tab);
    driver.app().send(NewStudy{{globe.folder.path / study}});
    driver.settle();
    driver.app().send(AddScans{{scans}});
    driver.wait_until("the scan is a case", [&] { return driver.state().models.study.cases.size() == 1; });
    driver.settle();
    const bool said = driver.shows("of these scans with another template");
    return std::pair(driver.state().models.study.cases.front().file, said);
  };
  const Document kidney = new_document("", nullptr, test::must(load_template("built-in:kidney")));
  const auto left = of_study("left.study.json", globe.document()), right = of_study("right.study.json", kidney);
  CHECK(left.first == globe.folder.path / "left-cases/a.homolog");
  CHECK(right.first == globe.folder.path / "right-cases/a.homolog");
  CHECK_FALSE(right.second);
  // A study that was thrown away and begun anew with another template, and once more.
  fs::remove(globe.folder.path / "left.study.json");
  const auto anew = of_study("left.study.json", kidney);
  CHECK(anew.first == globe.folder.path / "left-cases/a-2.homolog");
  CHECK(anew.second);
  CHECK(test::must(read_case(left.first)).session.document().structure()->the_template->source == globe.file);
  fs::remove(globe.folder.path / "left.study.json");
  CHECK(of_study("left.study.json", kidney).first == anew.first);
}

TEST_CASE("fits of a worklist are cancelled between two cases and those that are done stay") {
  const Globe globe;
  const fs::path scans = globe.folder.path / "scans";
  fs::create_directory(scans);
  for (int k = 0; k < 12; ++k)
    write_ball_map(scans / ("m" + std::to_string(10 + k) + ".nii"), 14 + k / 2.0, Vec3::Zero());
  Driver driver(globe.document());
  driver.press(key::tab);
  driver.app().send(AddScans{{scans}});
  driver.wait_until("the scans are cases", [&] { return driver.state().models.study.cases.size() == 12; });
  driver.settle();
  driver.app().send(FitWaiting{});
  driver.wait_until("one is fitted", [&] { return waiting_cases(driver.state().models) < 12; });
  driver.app().send(CancelWorklist{});
  driver.wait_until("that is said", [&] { return driver.shows("What was fitted stays so"); });
  driver.settle();
  const std::size_t waiting = waiting_cases(driver.state().models);
  CHECK(waiting > 0);
  CHECK(waiting < 12);
  CHECK_FALSE(driver.state().models.runs.listing);
}

TEST_CASE("a consensus of a study's label maps becomes its template and the waiting cases begin with it") {
  const Globe globe;
  const fs::path scans = globe.folder.path / "scans", made = globe.folder.path / "mean.ply";
  fs::create_directory(scans);
  for (int k = 0; k < 5; ++k) {
    // Two labels, so that one has to be chosen.
    Mesh organ = icosphere(4, 14 + k / 2.0), other = icosphere(3, 4);
    organ.points.col(2) *= 1.3 + 0.04 * k;
    organ.points.col(0) *= 0.8;
    other.points.col(0).array() += 24;
    Volume map = label_map(organ, Globe::grid(), 1);
    const Volume second = label_map(other, Globe::grid(), 2);
    const auto& there = std::get<std::vector<std::uint8_t>>(second.data);
    auto& voxels = std::get<std::vector<std::uint8_t>>(map.data);
    for (std::size_t i = 0; i < voxels.size(); ++i)
      if (there[i] != 0) voxels[i] = 2;
    REQUIRE(write_volume(map, scans / ("m" + std::to_string(k) + ".nii")));
  }
  Driver driver(globe.document());
  driver.press(key::tab);
  driver.app().send(AddScans{{scans}});
  driver.wait_until("the scans are cases", [&] { return driver.state().models.study.cases.size() == 5; });
  driver.settle();
  // It is offered first where cases wait, in the menu, and beside the making of a template.
  CHECK(driver.has("gallery/Make a consensus template…"));
  driver.click("Study");
  driver.click("study menu/Make a consensus template…");
  REQUIRE(std::holds_alternative<FileDialog>(*driver.state().dialog));
  driver.press(key::escape);
  driver.app().send(MakeStudyTemplate{{made}});
  driver.wait_until("it is asked for the label", [&] {
    return driver.state().dialog && std::holds_alternative<LabelDialog>(*driver.state().dialog);
  });
  CHECK(driver.shows("The template is made of the one that you choose."));
  driver.click("Which label is the organ?/1/Label 1");
  driver.wait_until("it is made", [&] { return driver.shows("The template of 5 cases was saved as mean.ply."); });
  driver.settle();
  CHECK(driver.state().models.study.template_file == made);
  CHECK(waiting_cases(driver.state().models) == 5);
  const MeshFile file = test::must(read_mesh_file(made));
  CHECK(file.points.rows() == 2500);
  for (const StudyCase& one : driver.state().models.study.cases)
    CHECK(test::must(read_case(one.file)).session.document().structure()->the_template->source == made);
  // The mean of five ellipsoids, within a voxel.
  const Vec3 size = bounds_of(file.points).sizes();
  CHECK(size.z() == doctest::Approx(2 * 15 * 1.38).epsilon(0.04));
  CHECK(size.x() == doctest::Approx(2 * 15 * 0.8).epsilon(0.04));
  CHECK_FALSE(driver.has("gallery/Make a consensus template…"));
  driver.app().send(FitWaiting{1});
  driver.wait_until("they are fitted", [&] { return waiting_cases(driver.state().models) == 0; });
  driver.settle();
  for (const StudyCase& one : driver.state().models.study.cases) CHECK(one.doubt == "");
  // A scan that comes later begins with it too.
  write_ball_map(globe.folder.path / "late.nii", 16, Vec3::Zero());
  driver.app().send(AddScans{{globe.folder.path / "late.nii", scans / "m0.nii"}});
  driver.wait_until("it is a case", [&] { return driver.state().models.study.cases.size() == 6; });
  driver.settle();
  CHECK(test::must(read_case(case_named(driver, "late").file)).session.document().structure()->the_template->source ==
        made);
}

TEST_CASE("a consensus template leaves a case alone that somebody worked on and says how to go on without maps") {
  const Globe globe;
  const fs::path scans = globe.folder.path / "scans", made = globe.folder.path / "mean.ply";
  fs::create_directory(scans);
  for (int k = 0; k < 4; ++k) write_ball_map(scans / ("m" + std::to_string(k) + ".nii"), 14 + k, Vec3::Zero());
  fs::rename(globe.image("zz.nii"), scans / "zz.nii");  // an image that has no label map
  Driver driver(globe.document());
  driver.press(key::tab);
  driver.app().send(AddScans{{scans}});
  driver.wait_until("the scans are cases", [&] { return driver.state().models.study.cases.size() == 5; });
  driver.settle();
  // What was undone is work too.
  const fs::path undone = case_named(driver, "m3").file;
  {
    auto read = test::must(open_case(undone));
    const Vec3 at = read.session.document().view()->shape.points->row(0);
    REQUIRE(read.session.apply(Stroke{Tool::pull, at, at + Vec3(2, 0, 0), 10, {}, false, 1}));
    REQUIRE(read.session.apply(Undo{}));
  }
  const fs::path worked_on = case_named(driver, "m1").file;
  Points pulled;
  {
    auto read = test::must(open_case(worked_on));
    const Vec3 at = read.session.document().view()->shape.points->row(0);
    REQUIRE(read.session.apply(Stroke{Tool::pull, at, at + Vec3(2, 0, 0), 10, {}, false, 1}));
    pulled = *read.session.document().view()->shape.points;
  }
  driver.app().send(MakeStudyTemplate{{made}});
  driver.wait_until("it is made", [&] { return driver.shows("2 cases that you worked on keep their own."); });
  driver.settle();
  const Document kept = test::must(read_case(worked_on)).session.document();
  CHECK(*kept.view()->shape.points == pulled);
  CHECK(kept.structure()->the_template->source == globe.file);
  CHECK(test::must(read_case(case_named(driver, "m0").file)).session.document().structure()->the_template->source ==
        made);
  CHECK(test::must(read_case(case_named(driver, "zz").file)).session.document().structure()->the_template->source ==
        made);
  CHECK(test::must(read_case(undone)).session.can_redo());
  // In place of it none is made: its cases could not be opened.
  driver.app().send(MakeStudyTemplate{{made}});
  driver.wait_until("it is refused", [&] { return driver.shows("exists already, and cases may have begun with it"); });
  for (const char* name : {"m0", "m2", "m3"}) driver.app().send(RemoveCase{name});
  driver.app().send(MakeStudyTemplate{{globe.folder.path / "other.ply"}});
  driver.wait_until("it is said", [&] { return driver.shows("has fewer than two cases with label maps"); });
  CHECK(!fs::exists(globe.folder.path / "other.ply"));
}

TEST_CASE("the gallery marks a shape in doubt with the reason until somebody has looked at it") {
  const Globe globe;
  Driver driver(globe.document());
  driver.press(key::tab);
  std::vector<fs::path> files;
  for (int k = 0; k < 4; ++k) {
    Mesh mesh = icosphere(3, 20);
    mesh.points.col(2) *= 1 + 0.1 * k + 0.02 * k * k;
    mesh.points.col(0) *= 1 + 0.05 * (k % 2);
    MeshFile file{mesh.points, mesh.topology->triangles()};
    if (k == 2) file.comments.push_back(doubt_comment("Dice with the label is 0.41."));
    files.push_back(globe.folder.path / ("s" + std::to_string(k) + ".ply"));
    REQUIRE(write_mesh_file(file, files.back()));
  }
  driver.app().send(AddCases{files});
  driver.wait_until("there is a model", [&] { return driver.state().models.made.model != nullptr; });
  driver.settle();
  REQUIRE(driver.state().models.made.suspicions);
  CHECK(driver.state().models.made.suspicions->doubts[2] == "Dice with the label is 0.41.");
  const RectPx cells = driver.control("gallery/cells").rect;
  const GalleryGrid grid = gallery_grid(4, cells);
  const auto said_over = [&](std::size_t shape) {
    const RectPx cell = grid.cell(shape);
    driver.move(cell.x + cell.width / 2, cell.y + cell.height / 2);
    driver.frames(60);
    return driver.shows("s2 is in doubt: Dice with the label is 0.41.");
  };
  for (const std::size_t sound : {0, 1, 3}) CHECK_FALSE(said_over(sound));
  CHECK(said_over(2));
  driver.app().send(SetCaseState{"s2", CaseState::done});
  driver.settle();
  CHECK_FALSE(said_over(2));
}

}  // namespace homolog
