#include <algorithm>
#include <cerrno>
#include <functional>
#include <vector>

#include "app/editor/update/controls.h"
#include "app/editor/work/files/preferences.h"
#include "tests/faults/disk.h"
#include "tests/screens.h"
#include "tests/wait.h"

// Everything in the window that writes, on a disk that fails at one call, or from that call on. What is asked for:
// every file is what it was or what the whole deed makes of it; where something is lacking it is said, with the
// system's reason; and all work is in memory, from where it can be saved to another disk.

namespace homolog {

namespace {

struct Deed {
  std::string name;
  std::function<void(Driver&, const BallDesk&)> before;  ///< on a disk that works
  std::function<void(Driver&, const BallDesk&)> act;
};

void nothing(Driver&, const BallDesk&) {}

void pull_and_study(Driver& driver, const BallDesk& desk) {
  apply(driver, BallDesk::pull(1));
  driver.app().send(OpenStudy{{desk.study}});
  driver.settle();
}

void show_model(Driver& driver, const BallDesk& desk) {
  pull_and_study(driver, desk);
  driver.app().send(ShowModels{true});
  driver.wait_until("the model is made", [&] { return driver.state().models.made.model != nullptr; });
  driver.settle();
}

void show_measures(Driver& driver, const BallDesk& desk) {
  show_model(driver, desk);
  driver.app().send(StartEvaluation{});
  driver.wait_until("the measures are there", [&] { return driver.state().models.made.evaluation != nullptr; });
}

/// A deed that is one command with a file's name.
template <class C>
Deed writing(const std::string& name, const std::string& file, decltype(Deed::before) before = nothing) {
  return {name, std::move(before),
          [file](Driver& driver, const BallDesk& desk) { driver.app().send(C{{desk.out / file}}); }};
}

std::vector<Deed> edits() {
  const auto once = [](Driver& driver, const BallDesk&) { apply(driver, BallDesk::pull(1)); };
  return {
      {"pull", once, [](Driver& driver, const BallDesk&) { apply(driver, BallDesk::pull(2)); }},
      {"drag with the mouse", once,
       [](Driver& driver, const BallDesk&) {
         const Points points = *driver.document().view()->shape.points;
         const Vec3 from = points.row(0), to = from * 1.2;
         driver.app().send(LookAt{from});
         driver.settle();
         const ViewMap map = view_map(driver.state(), driver.app().layout(), driver.document(), ViewKind::coronal);
         const Eigen::Vector2d a = map.to_px(from).value(), b = map.to_px(to).value();
         driver.move(a.x(), a.y());
         driver.button(MouseButton::left, true);
         driver.move(b.x(), b.y());
         driver.button(MouseButton::left, false);
       }},
      {"touches of a brush and a pull", once,
       [](Driver& driver, const BallDesk&) {
         apply(driver, BallDesk::relax(2));
         for (int k = 3; k < 6; ++k) apply(driver, BallDesk::relax(k), true);
         apply(driver, BallDesk::pull(6));
       }},
      {"touches of a brush", once,
       [](Driver& driver, const BallDesk&) {
         apply(driver, BallDesk::relax(2));
         for (int k = 3; k < 6; ++k) apply(driver, BallDesk::relax(k), true);
       }},
      {"undo", once, [](Driver& driver, const BallDesk&) { driver.app().send(GoInHistory{-1}); }},
      {"redo",
       [](Driver& driver, const BallDesk&) {
         apply(driver, BallDesk::pull(1));
         driver.settle();
         driver.app().send(GoInHistory{-1});
       },
       [](Driver& driver, const BallDesk&) { driver.app().send(GoInHistory{1}); }},
      {"a look at a frame and an edit", once,
       [](Driver& driver, const BallDesk&) {
         driver.app().send(ShowFrame{2});
         driver.settle();
         driver.app().send(ShowFrame{0});
         driver.settle();
         apply(driver, SetStiffnessBase{7});
       }},
      {"a landmark", once,
       [](Driver& driver, const BallDesk&) {
         apply(driver, PlaceLandmark{"north", Vec3(0, 0, 31)});
       }},
      {"grey values", once,
       [](Driver& driver, const BallDesk&) {
         driver.app().send(SetWindow{10, 90});
       }},
      {"propagate", once, [](Driver& driver, const BallDesk&) { driver.app().send(PropagateFrames{}); }},
      {"snap", once, [](Driver& driver, const BallDesk&) { driver.app().send(SnapMesh{}); }},
      {"refine", once, [](Driver& driver, const BallDesk&) { driver.app().send(RefineAlongSurface{}); }},
      {"paint stiffness", once,
       [](Driver& driver, const BallDesk&) {
         apply(driver, PaintStiffness{Vec3(0, 0, 30), 10, 50, 0});
       }},
  };
}

std::vector<Deed> openings() {
  const auto once = [](Driver& driver, const BallDesk&) { apply(driver, BallDesk::pull(1)); };
  const auto label = [](Driver& driver, const BallDesk& desk) {
    apply(driver, BallDesk::pull(1));
    driver.app().send(open_labels(desk.labels));
    driver.settle();
  };
  return {
      {"open an image and pull", once,
       [](Driver& driver, const BallDesk& desk) {
         driver.app().send(OpenFiles{{desk.scan}});
         driver.settle();
         apply(driver, BallDesk::pull(3));
       }},
      {"open a torn case and pull", once,
       [](Driver& driver, const BallDesk& desk) {
         driver.app().send(OpenFiles{{desk.torn}});
         driver.settle();
         apply(driver, BallDesk::pull(3));
       }},
      {"save as and pull", once,
       [](Driver& driver, const BallDesk& desk) {
         driver.app().send(SaveCaseAs{{desk.out / "saved.homolog"}});
         driver.settle();
         apply(driver, BallDesk::pull(3));
       }},
      {"save an unsaved case over another",
       [](Driver& driver, const BallDesk& desk) {
         driver.app().send(OpenFiles{{desk.scan}});
         driver.settle();
         apply(driver, BallDesk::pull(3));
       },
       [](Driver& driver, const BallDesk& desk) {
         driver.app().send(SaveCaseAs{{desk.torn}});
         driver.settle();
         apply(driver, BallDesk::pull(4));
       }},
      {"fit to a label", label,
       [](Driver& driver, const BallDesk&) { driver.app().send(StartFit{driver.state().automatic.fit_settings}); }},
      {"make a template and use it", label,
       [](Driver& driver, const BallDesk& desk) {
         TemplateSettings settings = driver.state().automatic.template_settings;
         settings.mask.vertices = 300;
         driver.app().send(MakeTemplate{settings, {}});
         driver.settle();
         driver.app().send(UseMadeTemplate{{desk.out / "made.ply"}});
       }},
  };
}

std::vector<Deed> exports() {
  return {
      writing<ExportMesh>("export a mesh", "old.ply"),
      writing<ExportMesh>("export a mesh as STL", "mesh.stl"),
      writing<ExportLabelMap>("export a label map", "old.nii.gz"),
      writing<ExportLabelMap>("export a label map as NRRD", "label.nrrd"),
      writing<ExportLandmarks>("export landmarks", "old.mrk.json",
                               [](Driver& driver, const BallDesk&) {
                                 apply(driver, PlaceLandmark{"north", Vec3(0, 0, 31)});
                               }),
      writing<ExportTemplateLandmarks>("export the template's landmarks", "points.fcsv"),
      writing<ExportTemplate>("save the template", "template.ply",
                              [](Driver& driver, const BallDesk&) {
                                apply(driver, PaintStiffness{Vec3(0, 0, 30), 10, 50, 0});
                              }),
      writing<ExportVolumes>("export volumes", "old.csv"),
      writing<ExportModel>("export a model", "old.h5.json", show_model),
      writing<ExportModel>("export a model as HDF5", "model.h5", show_model),
      writing<ExportEvaluation>("export the measures", "measures.csv", show_measures),
      writing<ExportSizes>("export sizes", "sizes.csv", show_model),
      writing<ExportLandmarkTable>("export a landmark table", "old.tps", show_model),
      {"export shapes", show_model,
       [](Driver& driver, const BallDesk& desk) {
         driver.app().send(ExportShapes{desk.out / "shapes", ".ply"});
       }},
  };
}

std::vector<Deed> studies() {
  return {
      {"new study with shapes", nothing,
       [](Driver& driver, const BallDesk& desk) {
         driver.app().send(NewStudy{{desk.out / "new.study.json"}});
         driver.settle();
         driver.app().send(AddCases{{desk.folder.path / "ball100.ply", desk.folder.path / "ball110.ply"}});
       }},
      {"change a study", pull_and_study,
       [](Driver& driver, const BallDesk&) {
         driver.app().send(SetCaseState{"ball110", CaseState::done});
       }},
      {"change a study twice", pull_and_study,
       [](Driver& driver, const BallDesk&) {
         driver.app().send(SetCaseState{"ball110", CaseState::done});
         driver.settle();
         driver.app().send(SetCaseState{"ball125", CaseState::done});
       }},
      writing<SaveStudyAs>("save a study as", "other.study.json", pull_and_study),
      {"add a scan", pull_and_study,
       [](Driver& driver, const BallDesk& desk) { driver.app().send(AddScans{{desk.scan}}); }},
      {"fit a worklist",
       [](Driver& driver, const BallDesk& desk) {
         pull_and_study(driver, desk);
         driver.app().send(AddScans{{desk.scan.parent_path()}});
         driver.settle();
       },
       [](Driver& driver, const BallDesk&) { driver.app().send(FitWaiting{}); }},
      {"shapes without a study file", nothing,
       [](Driver& driver, const BallDesk& desk) {
         driver.app().send(ShowModels{true});
         driver.settle();
         driver.app().send(AddCases{{desk.folder.path / "ball100.ply", desk.folder.path / "ball110.ply"}});
       }},
      {"settings", nothing,
       [](Driver& driver, const BallDesk&) {
         if (auto written = write_preferences(driver.state().preferences, preferences_file()); !written)
           add_notice(driver.state(), written.error().sentence());
       }},
      {"a log", nothing,
       [](Driver& driver, const BallDesk& desk) {
         if (auto written = driver.app().log().write_to(desk.out / "session.log"); !written)
           add_notice(driver.state(), written.error().sentence());
         apply(driver, BallDesk::pull(2));
       }},
      {"a new folder", nothing,
       [](Driver& driver, const BallDesk& desk) {
         driver.app().send(ShowFileDialog{FilePurpose::save_case, "x"});
         driver.settle();
         driver.app().send(EnterFolder{desk.out});
         driver.app().send(NameFolder{"inner"});
         driver.app().send(MakeFolder{});
         driver.settle();
         const auto* dialog = driver.state().dialog ? std::get_if<FileDialog>(&*driver.state().dialog) : nullptr;
         REQUIRE(dialog != nullptr);
         if (!dialog->browser.error.empty()) add_notice(driver.state(), dialog->browser.error);
         driver.state().dialog.reset();
       }},
  };
}

/// What one try left: the bytes of the files but those of cases, and the states that the case went through.
struct Left {
  std::map<std::string, std::string> files;
  std::vector<std::string> states;
  std::map<std::string, std::string> states_of_cases;  ///< of the case files, where no fault was tried
  std::string shown, notices;
  long calls = 0;
};

/// Whether the bytes of a file are the same every time.
bool is_compared(const std::string& name) {
  return !name.ends_with(".homolog") && !name.ends_with(".h5.json") && !name.ends_with(".h5") &&
         !name.ends_with(".log");
}

/// Another disk, which works.
struct OtherDisk {
  fs::path path = fs::temp_directory_path() / ("homolog-other-disk-" + std::to_string(::getpid()));
  OtherDisk() { fs::create_directory(path); }
  ~OtherDisk() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  OtherDisk(const OtherDisk&) = delete;
  OtherDisk& operator=(const OtherDisk&) = delete;
};

struct Fault {
  long at = 0;
  int error = 0;
  bool stays = false;
};

/// The work in memory comes whole onto another disk, while this one still fails.
void save_elsewhere(Driver& driver, const OtherDisk& other) {
  const fs::path saved = other.path / "saved.homolog", study = other.path / "saved.study.json";
  const std::string shown = state_of(driver.document());
  const std::size_t cases = driver.state().models.study.cases.size();
  driver.app().send(SaveCaseAs{{saved}});
  driver.settle();
  REQUIRE(driver.case_file() == saved);
  CHECK(states_of_file(saved).front() == shown);
  apply(driver, SetStiffnessBase{9});  // which goes on there
  driver.settle();
  CHECK(states_of_file(saved).front() == state_of(driver.document()));
  if (driver.state().models.kept.file.empty()) return;
  driver.app().send(SaveStudyAs{{study}});
  driver.settle();
  CHECK(driver.state().models.kept.file == study);
  const auto read = read_study(study);
  REQUIRE(read);
  CHECK(read->study.cases.size() == cases);
}

using Files = std::map<std::string, std::string>;

/// By their names below desk/ and home/. What the folders are called is another at every try, and does not count.
Files all_files(const BallDesk& desk, const Driver& driver) {
  Files files;
  const std::map<std::string, fs::path> folders{{"desk/", desk.folder.path}, {"home/", driver.folder()}};
  for (const auto& [as, folder] : folders)
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (!entry.is_regular_file()) continue;
      std::string bytes = test::must(read_whole_file(entry.path()));
      for (const auto& [word, other] : folders) {
        const std::string name = other.filename().string() + '/';
        for (std::size_t at = 0; (at = bytes.find(name, at)) != std::string::npos; at += word.size())
          bytes.replace(at, name.size(), word);
      }
      files[as + fs::relative(entry.path(), folder).string()] = std::move(bytes);
    }
  return files;
}

fs::path path_of(const std::string& name, const BallDesk& desk, const Driver& driver) {
  return (name.starts_with("desk/") ? desk.folder.path : driver.folder()) / name.substr(5);
}

Files states_of_cases(const Files& files, const BallDesk& desk, const Driver& driver) {
  Files states;
  for (const auto& [name, bytes] : files)
    if (name.ends_with(".homolog")) states[name] = states_of_file(path_of(name, desk, driver)).front();
  return states;
}

/// `left`: after the fault; `whole`: of a try without one.
void check_files(const Files& before, const Left& left, const Left& whole, const BallDesk& desk, const Driver& driver) {
  const auto went_through = [](const Left& one, const std::string& state) {
    return std::find(one.states.begin(), one.states.end(), state) != one.states.end();
  };
  for (const auto& [name, bytes] : left.files) {
    CHECK_MESSAGE(!name.ends_with(".tmp"), name, " was left");
    if (before.contains(name) && before.at(name) == bytes) continue;
    if (name.ends_with(".homolog")) {
      const std::string state = states_of_file(path_of(name, desk, driver)).front();
      // A new one may hold less than the screen shows, which was said; and one whose last line was to be taken back,
      // more.
      const bool is_new = !before.contains(name) || left.notices.find("could not be removed") != std::string::npos;
      const auto then = whole.states_of_cases.find(name);  // of one that is not on the screen
      const bool is_whole = then != whole.states_of_cases.end() && then->second == state;
      CHECK_MESSAGE((is_new || is_whole || went_through(left, state) || went_through(whole, state)), name,
                    " holds something else");
    } else if (name.ends_with(".study.json")) {
      // Written again and again: it may be one of those in between.
      CHECK_MESSAGE(read_study(path_of(name, desk, driver)), name, " cannot be read");
    } else if (is_compared(name)) {
      CHECK_MESSAGE((whole.files.contains(name) && whole.files.at(name) == bytes), name,
                    " is neither as it was nor whole");
    }
  }
  for (const auto& [name, bytes] : before)
    if (!name.starts_with("home/homolog/unsaved-")) CHECK_MESSAGE(left.files.contains(name), name, " is gone");
}

/// `whole`: what a try without a fault left; null for that try itself.
Left run(const Deed& deed, const Fault& fault, const Left* whole) {
  const BallDesk desk;
  const OtherDisk other;
  for (const char* old : {"old.ply", "old.nii.gz", "old.mrk.json", "old.csv", "old.h5.json", "old.tps", "old.png"})
    write_bytes(desk.out / old, "an older file");
  Driver driver(desk.document());
  deed.before(driver, desk);
  driver.settle();
  driver.state().notices.clear();
  Left left;
  left.states.push_back(state_of(driver.document()));
  const Files before = all_files(desk, driver);
  disk_fail(fault.at, fault.error, fault.stays);
  deed.act(driver, desk);
  deed.name.starts_with("touches") ? rest(driver) : driver.settle();
  left.calls = disk_calls();
  left.shown = state_of(driver.document());
  left.states.push_back(left.shown);
  for (const Notice& notice : driver.state().notices) left.notices += notice.text + '\n';
  for (const StudyCase& one : driver.state().models.study.cases) left.notices += one.doubt + '\n';  // its row says it
  if (whole != nullptr) save_elsewhere(driver, other);
  disk_fail(0, 0, 0);
  left.files = all_files(desk, driver);
  if (whole != nullptr)
    check_files(before, left, *whole, desk, driver);
  else
    left.states_of_cases = states_of_cases(left.files, desk, driver);
  return left;
}

/// Gives how many faults were tried.
int try_faults(std::vector<Deed> deeds) {
  const WatchedDisk watched;
  const int most = trials("HOMOLOG_FAULTS", 0);
  // In a hurry a few of the first, each time the same ones.
  constexpr std::size_t few = 12;
  std::size_t number = 0;
  if (most == 0) std::erase_if(deeds, [&](const Deed&) { return number++ % 5 != 0 || number > few; });
  constexpr int errors[] = {ENOSPC, EIO, EACCES};
  int tried = 0;
  for (const Deed& deed : deeds) {
    INFO(deed.name);
    const Left whole = run(deed, {}, nullptr);
    REQUIRE_MESSAGE(whole.calls > 0, deed.name, " writes nothing");
    const long steps = std::min<long>(std::max(most, 1), 6 * whole.calls);
    for (long k = 0; k < steps; ++k, ++tried) {
      const Fault fault{1 + (k * whole.calls / steps + tried) % whole.calls, errors[tried % 3], tried / 3 % 2 != 0};
      const std::string reason = std::strerror(fault.error);
      INFO("call ", fault.at, " of ", whole.calls, ": ", reason, std::string(fault.stays ? " and so on" : ""));
      const Left left = run(deed, fault, &whole);
      INFO("It says: ", left.notices);
      // An edit that follows on one that failed is refused as such.
      const auto says = [&](const std::string& words) { return left.notices.find(words) != std::string::npos; };
      if (says(reason) || says("so the edit was not made")) continue;
      // Nothing was said, so nothing may be lacking.
      CHECK_MESSAGE(left.shown == whole.shown, "it was not done");
      for (const auto& [name, bytes] : whole.files)
        if (is_compared(name))
          CHECK_MESSAGE((left.files.contains(name) && left.files.at(name) == bytes), name, " is not whole");
    }
  }
  MESSAGE(tried, " faults in ", deeds.size(), " deeds");
  return tried;
}

}  // namespace

TEST_CASE("on a disk that fails edits and cases are kept or refused with the reason") {
  auto deeds = edits();
  for (Deed& deed : openings()) deeds.push_back(std::move(deed));
  CHECK(try_faults(deeds) > 0);
}

TEST_CASE("on a disk that fails exports and studies are whole or refused with the reason") {
  CHECK(try_faults(exports()) > 0);
  CHECK(try_faults(studies()) > 0);
}

TEST_CASE("a study is on the disk when the window is at rest") {
  const BallDesk desk;
  Driver driver(desk.document());
  pull_and_study(driver, desk);
  driver.app().send(AddScans{{desk.scan}});
  REQUIRE(test::wait_until([&] {
    driver.frame();
    return driver.app().at_rest();
  }));
  const auto read = read_study(desk.study);
  REQUIRE(read);
  CHECK(read->study.cases.size() == 5);
}

TEST_CASE("a study whose folder could not be made is written as soon as it can be") {
  const WatchedDisk watched;
  const BallDesk desk;
  Driver driver(desk.document());
  driver.app().send(ShowModels{true});
  driver.settle();
  disk_fail(1, EACCES, 0);
  driver.app().send(AddCases{{desk.folder.path / "ball100.ply", desk.folder.path / "ball110.ply"}});
  driver.settle();
  CHECK(disk_calls() > 1);
  const auto read = read_study(driver.state().models.kept.file);
  REQUIRE(read);
  CHECK(read->study.cases.size() == 2);
}

TEST_CASE("on a disk that fails pictures are whole or refused with the reason") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  const auto draw = [](Driver& driver, const BallDesk&) { driver.picture(); };
  const auto draw_measures = [](Driver& driver, const BallDesk& desk) {
    driver.picture();
    show_measures(driver, desk);
  };
  CHECK(try_faults({writing<ExportPicture>("a picture", "old.png", draw),
                    writing<ExportPlots>("plots", "plots.png", draw_measures)}) > 0);
}

}  // namespace homolog
