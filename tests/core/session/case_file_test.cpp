#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <random>
#include <set>

#include "core/base/files/files.h"
#include "core/catalogue/catalogue.h"
#include "core/session/unsaved_cases.h"
#include "core/volume/volume_io.h"
#include "tests/case_folder.h"
#include "tests/environment_variable.h"
#include "tests/must.h"
#include "tests/refusal.h"
#include "tests/small_files.h"

namespace homolog {

TEST_CASE("a case whose image has moved opens with the image where it is now and remembers it") {
  const TemporaryFolder folder;
  VolumeGeometry grid;
  grid.dims = {4, 5, 6};
  Volume volume;
  volume.geometry = grid;
  volume.data = std::vector<std::int16_t>(grid.voxels(), 7);
  const fs::path image = folder.path / "ct.nrrd", moved = folder.path / "moved.nrrd", file = folder.path / "a.homolog";
  REQUIRE(write_volume(volume, image));
  const auto read = std::make_shared<const Volume>(read_volume(image).value().volume);
  REQUIRE(create_case(new_document(image.string(), read, load_template("built-in:kidney").value()), file));
  fs::rename(image, moved);
  const auto lost = open_case(file);
  REQUIRE_FALSE(lost);
  CHECK(lost.error().sentence().find("a.homolog") != std::string::npos);
  CHECK(lost.error().sentence().find("open the case together with the image") != std::string::npos);
  {
    auto found = open_case(file, nullptr, moved.string());
    REQUIRE(found);
    REQUIRE(found->session.apply(Note{"here it is"}));
  }
  const auto again = open_case(file);
  REQUIRE(again);
  CHECK(again->session.document().scan.image->geometry.dims == grid.dims);
}

TEST_CASE("an image on another grid is refused in voxels and mm") {
  const TemporaryFolder folder;
  const auto write = [&](const fs::path& path, double spacing_mm, double origin_mm) {
    Volume volume;
    volume.geometry.dims = {4, 5, 6};
    volume.geometry.spacing_mm.setConstant(spacing_mm);
    volume.geometry.origin_mm.setConstant(origin_mm);
    volume.data = std::vector<std::int16_t>(volume.geometry.voxels(), 7);
    REQUIRE(write_volume(volume, path));
    return std::make_shared<const Volume>(std::move(volume));
  };
  const fs::path image = folder.path / "ct.nrrd", coarse = folder.path / "coarse.nrrd",
                 away = folder.path / "away.nrrd", file = folder.path / "a.homolog";
  const auto volume = write(image, 1.5, 0);
  write(coarse, 3, 0);
  write(away, 1.5, 40);
  REQUIRE(create_case(new_document(image.string(), volume, load_template("built-in:kidney").value()), file));
  CHECK(open_case(file, nullptr, image.string()));
  CHECK(says(open_case(file, nullptr, coarse.string()), "made on an image of 4 × 5 × 6 voxels of 1.5 × 1.5 × 1.5 mm"));
  CHECK(says(open_case(file, nullptr, coarse.string()), "coarse.nrrd has 4 × 5 × 6 voxels of 3 × 3 × 3 mm"));
  CHECK(says(open_case(file, nullptr, away.string()), "at another place or angle"));

  // Headers of other hands: without the grid in numbers, and with a grid that is none.
  std::string text = read_whole_file(file).value();
  const std::string voxels = R"("voxels":[4,5,6],)";
  REQUIRE(text.find(voxels) != std::string::npos);
  std::ofstream(file) << std::string(text).erase(text.find(voxels), voxels.size());
  CHECK(open_case(file));
  CHECK(says(open_case(file, nullptr, coarse.string()), "made on an image of another grid"));
  std::ofstream(file) << std::string(text).replace(text.find(voxels), voxels.size(), R"("voxels":"many",)");
  CHECK(says(open_case(file, nullptr, coarse.string()), "of the wrong kind"));
}

TEST_CASE("a torn last line is dropped with a warning and everything before it is restored") {
  const CaseFolder folder;
  Points kept;
  {
    EditSession session = folder.create();
    REQUIRE(session.apply(pull(pole, Vec3(0, 0, 50))));
    kept = *session.document().view()->shape.points;
  }
  const std::string torn = R"({"tool":"pull","at":[0,0,-40],"to":[0,0,-4)";
  for (std::size_t length = 1; length <= torn.size(); ++length) {
    const std::string whole = folder.text();
    folder.append(torn.substr(0, length));
    auto read = read_case(folder.case_path);
    REQUIRE(read);
    CHECK(read->warnings.size() == 1);
    CHECK(*read->session.document().view()->shape.points == kept);
    CHECK(read->whole_bytes == whole.size());
    fs::resize_file(folder.case_path, whole.size());
  }
  folder.append(torn);
  auto opened = open_case(folder.case_path);
  REQUIRE(opened);
  REQUIRE(opened->session.apply(pull(pole, Vec3(0, 0, 55))));
  CHECK(read_case(folder.case_path)->warnings.empty());
}

TEST_CASE("a file without a last line feed goes on in a line of its own") {
  const CaseFolder folder;
  { const EditSession session = folder.create(); }
  folder.append(R"({"note":"written by a script"})");
  {
    auto opened = open_case(folder.case_path);
    REQUIRE(opened);
    REQUIRE(opened->session.apply(pull(pole, Vec3(0, 0, 50))));
  }
  CHECK(read_case(folder.case_path)->session.strokes() == 1);
}

TEST_CASE("lines that are no action are errors that name the line") {
  const CaseFolder folder;
  { const EditSession session = folder.create(); }
  const std::string whole = folder.text();
  for (const std::string bad : {R"({"wobble":1})", R"({"tool":"push","at":[0,0,0],"to":[0,0,0],"sigma_mm":1})",
                                R"({"tool":"pull","at":[0,0],"to":[0,0,0],"sigma_mm":1})", R"({"tool":"pull"})",
                                R"({"tool":"pull","at":[0,0,40],"to":[0,0,45],"sigma_mm":-1})", R"({"undo":true})",
                                R"({"frame":3})", R"({"frame":0.5})", R"({"frame":1e300})", R"({"undo":false})",
                                R"([1,2])", R"(nonsense)", R"({"stiffness_base":"soft"})"}) {
    folder.append("{\"note\":\"fine\"}\n" + bad + "\n{\"note\":\"fine\"}\n");
    const auto read = read_case(folder.case_path);
    REQUIRE_MESSAGE(!read, bad);
    CHECK_MESSAGE(read.error().sentence().find("ball.homolog: line 3: ") != std::string::npos, read.error().sentence());
    fs::resize_file(folder.case_path, whole.size());
  }
}

TEST_CASE("what stands before a line that cannot be played is read where that is asked for, and the file stays") {
  const CaseFolder folder;
  Points before;
  {
    EditSession session = folder.create();
    REQUIRE(session.apply(pull(pole, 1.1 * pole)));
    before = *session.document().view()->shape.points;
    REQUIRE(session.apply(pull(-pole, -1.1 * pole)));
  }
  const std::vector<std::string> lines = lines_of(folder.case_path);
  REQUIRE(lines.size() == 3);
  ReplayOptions options;
  options.up_to_bad_line = true;
  CHECK(read_case(folder.case_path, options)->fault.empty());
  // One that is found before anything is played, and one that is found by playing it.
  for (const std::string bad : {R"({"wobble":1})", R"({"frame":3})"}) {
    CAPTURE(bad);
    std::ofstream(folder.case_path) << lines[0] << '\n' << lines[1] << '\n' << bad << '\n' << lines[2] << '\n';
    const std::string text = folder.text();
    CHECK_FALSE(read_case(folder.case_path));
    CHECK_FALSE(open_case(folder.case_path));
    auto read = open_case(folder.case_path, nullptr, {}, {}, true);
    REQUIRE(read);
    CHECK(read->fault.find("ball.homolog: line 3: ") != std::string::npos);
    CHECK(*read->session.document().view()->shape.points == before);
    CHECK(read->session.journal() == nullptr);
    CHECK(read->whole_bytes == lines[0].size() + lines[1].size() + 2);
    REQUIRE(read->session.apply(pull(pole, 1.2 * pole)));
    REQUIRE(read->session.apply(Undo{}));
    REQUIRE(read->session.apply(Undo{}));
    CHECK_FALSE(read->session.can_undo());
    REQUIRE(read->session.apply(Redo{}));
    CHECK(*read->session.document().view()->shape.points == before);
    CHECK(folder.text() == text);
    // It goes on elsewhere with the lines that were read.
    const fs::path elsewhere = folder.folder.path / "elsewhere.homolog";
    REQUIRE(save_case_as(read->session, elsewhere));
    CHECK(*test::must(read_case(elsewhere)).session.document().view()->shape.points == before);
    CHECK(folder.text() == text);
  }
}

TEST_CASE("a number that no case needs is refused with its line") {
  const CaseFolder folder;
  { const EditSession session = folder.create(); }
  const std::string whole = folder.text();
  const std::string turned = R"("rotation":[1,0,0,0])";
  for (const std::string huge : {"1e308", "-1e308", "1.5e154", "1000000001"}) {
    const std::string place = "[0,0," + huge + "]";
    for (const std::string& bad : {R"({"tool":"pull","at":[0,0,40],"to":)" + place + R"(,"sigma_mm":12})",
                                   R"({"tool":"pull","at":)" + place + R"(,"to":[0,0,45],"sigma_mm":12})",
                                   R"({"tool":"pull","at":[0,0,40],"to":[0,0,45],"on":)" + place + R"(,"sigma_mm":12})",
                                   R"({"tool":"slide","at":[0,0,40],"to":[0,0,45],"sigma_mm":)" + huge + "}",
                                   R"({"confirm":{"at":)" + place + R"(,"radius_mm":10,"hold":true}})",
                                   R"({"confirm":{"at":[0,0,40],"radius_mm":)" + huge + R"(,"hold":true}})",
                                   R"({"landmark":{"name":"north","at":)" + place + "}}",
                                   R"({"template_landmark":{"name":"north","at":)" + place + "}}",
                                   R"({"placement":{)" + turned + R"(,"scale":1,"translation":)" + place + "}}",
                                   R"({"placement":{)" + turned + R"(,"scale":)" + huge + R"(,"translation":[0,0,0]}})",
                                   R"({"points":)" + place + "}"}) {
      folder.append("{\"note\":\"fine\"}\n" + bad + "\n");
      CHECK_MESSAGE(says(read_case(folder.case_path), "ball.homolog: line 3: "), bad);
      fs::resize_file(folder.case_path, whole.size());
    }
    for (const std::string& placement :
         {R"("scale":1,"translation":)" + place, R"("scale":)" + huge + R"(,"translation":[0,0,0])"}) {
      std::ofstream(folder.folder.path / "placed.homolog")
          << R"({"homolog":1,"template":"ball.ply","placement":{)" + turned + "," + placement + "}}\n";
      CHECK_MESSAGE(says(read_case(folder.folder.path / "placed.homolog"), "placed.homolog: line 1: "), placement);
    }
  }
  // What is far away, but not too far.
  folder.append(R"({"tool":"pull","at":[0,0,40],"to":[0,0,999999999],"sigma_mm":12})"
                "\n");
  const auto read = read_case(folder.case_path);
  REQUIRE(read);
  CHECK(read->session.document().view()->shape.points->allFinite());
}

TEST_CASE("a file whose name is no UTF-8 is refused and nothing is written of it") {
  const CaseFolder folder;
  const fs::path image = folder.folder.path / "caf\xe9.nii", file = folder.folder.path / "a.homolog";
  const auto whole = test::must(load_template(folder.template_path.string()));
  const auto begun = create_case(new_document(image.string(), nullptr, whole), file);
  CHECK(says(begun, "caf\xe9.nii: has a name that is no UTF-8"));
  CHECK_FALSE(fs::exists(file));
  // Beside the case its name is not written.
  const fs::path odd = folder.folder.path / "odd\xe9";
  fs::create_directory(odd);
  fs::copy_file(folder.template_path, odd / "ball.ply");
  const Document document = new_document("", nullptr, load_template((odd / "ball.ply").string()).value());
  REQUIRE(create_case(document, odd / "b.homolog"));
  CHECK(read_case(odd / "b.homolog"));
  EditSession session = folder.create();
  const std::string before = folder.text();
  CHECK(says(session.apply(Note{"saved", {}, odd / "t.ply"}), "no UTF-8"));
  CHECK(folder.text() == before);
}

TEST_CASE("a line that cannot be played is said before the image is looked for") {
  const TemporaryFolder folder;
  const fs::path file = folder.path / "a.homolog";
  for (const std::string bad : {R"(nonsense)", R"({"wobble":1})", R"({"tool":"pull","at":[0,0]})"}) {
    std::ofstream(file) << R"({"homolog":1,"volume":"absent.nii","template":"built-in:kidney"})"
                        << "\n"
                        << bad << "\n"
                        << R"({"note":"fine"})"
                        << "\n";
    CHECK(says(read_case(file), "a.homolog: line 2: "));
    CHECK(says(read_case(file), "; "));  // and a remedy
  }
  std::ofstream(file) << R"({"homolog":1})"
                      << "\n"
                      << std::string(70, '[') << "\n{}\n";
  CHECK(says(read_case(file), "levels deep, which no file of this kind does; correct that line or take it out"));
  std::ofstream(file) << R"({"wobble":1})"
                      << "\n";
  CHECK(says(read_case(file), "its first line is no header; open a .homolog file"));
}

TEST_CASE("a phantom's number that is too large or negative is refused with those allowed") {
  const TemporaryFolder folder;
  for (const char* number : {"99999999999999999999", "2147483648", "-1", "1x", ""}) {
    std::ofstream(folder.path / "a.homolog")
        << R"({"homolog":1,"volume":"phantom:kidney:)" << number << R"(","template":"built-in:kidney"})"
        << "\n";
    CHECK(says(read_case(folder.path / "a.homolog"), "needs a subject number from 0 to 2147483647"));
  }
}

TEST_CASE("unknown keys are no error and stay in the file") {
  const CaseFolder folder;
  { const EditSession session = folder.create(); }
  folder.append("{\"note\":\"x\",\"author\":\"someone\"}\n");
  const fs::path copy = folder.folder.path / "copy.homolog";
  {
    auto opened = open_case(folder.case_path);
    REQUIRE(opened);
    REQUIRE(save_case_as(opened->session, copy));
  }
  CHECK(read_whole_file(copy)->find("\"author\":\"someone\"") != std::string::npos);
}

TEST_CASE("a template that differs from the case is refused with both values") {
  const CaseFolder folder;
  { const EditSession session = folder.create(); }
  REQUIRE(write_mesh(icosphere(2, 40), folder.template_path));
  const auto read = read_case(folder.case_path);
  REQUIRE(!read);
  CHECK(read.error().sentence().find("642") != std::string::npos);
  CHECK(read.error().sentence().find("162") != std::string::npos);
}

TEST_CASE("a second opener is told that the case is open") {
  const CaseFolder folder;
  const EditSession session = folder.create();
  const auto second = open_case(folder.case_path);
  REQUIRE(!second);
  CHECK(second.error().what.find("open in another program") != std::string::npos);
  CHECK(!create_case(folder.document(), folder.case_path));
  CHECK(read_case(folder.case_path));  // reading alone is no harm
}

TEST_CASE("saving under another name goes on there with relative paths") {
  const CaseFolder folder;
  EditSession session = folder.create();
  REQUIRE(session.apply(pull(pole, Vec3(0, 0, 50))));
  const fs::path other = folder.folder.path / "elsewhere";
  fs::create_directories(other);
  REQUIRE(save_case_as(session, other / "moved.homolog"));
  REQUIRE(session.apply(pull(-pole, Vec3(0, 0, -50))));
  const auto read = read_case(other / "moved.homolog");
  REQUIRE(read);
  CHECK(read->session.strokes() == 2);
  CHECK(read_whole_file(other / "moved.homolog")->find("../ball.ply") != std::string::npos);
  CHECK(read_case(folder.case_path)->session.strokes() == 1);
}

TEST_CASE("an edit that cannot be written is not made") {
  const CaseFolder folder;
  EditSession session = folder.create();
  const std::string before = folder.text();
  const Points points = *session.document().view()->shape.points;
  const auto done = [&] {
    const SmallFilesOnly full(before.size() + 10);
    return session.apply(pull(pole, Vec3(0, 0, 50)));
  }();
  CHECK(says(done, "the edit was not made"));
  CHECK(*session.document().view()->shape.points == points);
  CHECK_FALSE(session.can_undo());
  CHECK(folder.text() == before);
}

namespace {

/// The unsaved cases that hold an edit.
std::vector<fs::path> edited_cases() {
  std::vector<fs::path> found;
  for (const UnsavedCase& one : unsaved_cases())
    if (one.edited) found.push_back(one.journal);
  return found;
}

}  // namespace

TEST_CASE("looking for unsaved cases does not mend what opening must find torn") {
  const CaseFolder folder;
  const EnvironmentVariable state("XDG_STATE_HOME", folder.folder.path);
  {
    auto session = create_unsaved_case(folder.document()).value();
    REQUIRE(session.apply(pull(pole, Vec3(0, 0, 50))));
  }
  REQUIRE(edited_cases().size() == 1);
  const fs::path left = edited_cases().front();
  std::ofstream(left, std::ios::app) << "{\"tool\":\"pu";
  REQUIRE(edited_cases().size() == 1);
  const auto opened = open_case(left);
  REQUIRE(opened);
  CHECK(opened->warnings.size() == 1);
  CHECK(opened->session.strokes() == 1);
}

TEST_CASE("a session that could not be journalled is saved whole") {
  const CaseFolder folder;
  EditSession session(folder.document());
  REQUIRE(session.apply(pull(pole, Vec3(0, 0, 50))));
  REQUIRE(session.apply(pull(-pole, Vec3(0, 0, -50))));
  REQUIRE(session.apply(Undo{}));
  REQUIRE(save_case_as(session, folder.case_path));
  REQUIRE(session.apply(pull(Vec3(40, 0, 0), Vec3(45, 0, 0))));
  const auto read = read_case(folder.case_path);
  REQUIRE(read);
  CHECK(largest_difference(*read->session.document().view()->shape.points, *session.document().view()->shape.points) <
        1e-9);
}

TEST_CASE("a case behind a linked folder finds its template") {
  const CaseFolder folder;
  const fs::path real = folder.folder.path / "a" / "b", link = folder.folder.path / "link";
  fs::create_directories(real);
  fs::create_directory_symlink(real, link);
  { REQUIRE(create_case(folder.document(), link / "case.homolog")); }
  CHECK(read_case(link / "case.homolog"));
}

TEST_CASE("after kill minus nine at any moment everything shown as done is restored") {
  const CaseFolder folder;
  { const EditSession session = folder.create(); }
  std::mt19937 random(1);
  int done_before = 0;
  for (int round = 0; round < 8; ++round) {
    int report[2];
    REQUIRE(::pipe(report) == 0);
    const pid_t child = ::fork();
    if (child == 0) {
      auto opened = open_case(folder.case_path);
      for (int k = 0; opened; ++k) {
        if (!opened->session.apply(pull(pole, Vec3(0, 0, 45 + k % 3)))) break;
        const char done = 1;
        if (::write(report[1], &done, 1) != 1) break;  // shown as done
      }
      ::_exit(1);
    }
    ::close(report[1]);
    int shown = 0;
    char byte = 0;
    if (round == 0) shown += ::read(report[0], &byte, 1) == 1;  // however slow the machine is, something was done
    ::usleep(static_cast<useconds_t>(20000 + random() % 60000));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    while (::read(report[0], &byte, 1) == 1) ++shown;
    ::close(report[0]);
    const auto read = read_case(folder.case_path);
    REQUIRE(read);
    const int restored = read->session.strokes() - done_before;
    CHECK(restored >= shown);
    CHECK(restored <= shown + 1);  // the one on disk but not yet shown
    done_before = read->session.strokes();
  }
  CHECK(done_before > 0);
}

TEST_CASE("the window and the saved template are kept with a case and no undo takes them back") {
  const CaseFolder folder;
  HistoryLimits limits;
  limits.replayed_steps = 2;  // so that what is kept lies before a checkpoint too
  {
    EditSession session = create_case(folder.document(), folder.case_path, limits).value();
    CHECK_FALSE(session.kept().window);
    REQUIRE(session.apply(Note{"window", std::array{0.0, 100.0}, {}}, true));
    REQUIRE(session.apply(Note{"the template was saved", std::nullopt, "/far/mine.ply"}));
    CHECK_FALSE(session.can_undo());
    for (int k = 0; k < 6; ++k) REQUIRE(session.apply(pull(pole, Vec3(0, 0, 45 + k))));
    REQUIRE(session.apply(Note{"window", std::array{-160.0, 240.0}, {}}, true));
    for (int k = 0; k < 6; ++k) REQUIRE(session.apply(pull(-pole, Vec3(0, 0, -45 - k))));
    REQUIRE(session.apply(Undo{}));
    CHECK(*session.kept().window == std::array{-160.0, 240.0});
  }
  CHECK(folder.text().find("checkpoint") != std::string::npos);
  for (const bool from_checkpoint : {false, true}) {
    ReplayOptions options;
    options.from_checkpoint = from_checkpoint;
    const auto read = read_case(folder.case_path, options);
    REQUIRE(read);
    CHECK(*read->session.kept().window == std::array{-160.0, 240.0});
    CHECK(read->session.kept().template_file == "/far/mine.ply");
  }
  folder.append("{\"note\":\"window\",\"window\":[3,1]}\n");
  CHECK(says(read_case(folder.case_path), "two ascending numbers"));
}

TEST_CASE("unsaved cases of one millisecond have a name each") {
  const CaseFolder folder;
  const EnvironmentVariable state("XDG_STATE_HOME", folder.folder.path);
  std::set<fs::path> names;
  for (int k = 0; k < 1000; ++k) names.insert(new_unsaved_path().value());
  CHECK(names.size() == 1000);
}

TEST_CASE("a case of which only the window was changed is no unsaved work") {
  const CaseFolder folder;
  const EnvironmentVariable state("XDG_STATE_HOME", folder.folder.path);
  {
    auto session = create_unsaved_case(folder.document()).value();
    REQUIRE(session.apply(Note{"window", std::array{0.0, 100.0}, {}}, true));
  }
  REQUIRE(unsaved_cases().size() == 1);
  CHECK_FALSE(unsaved_cases().front().edited);
}

TEST_CASE("unsaved cases are offered once they hold an action and are not open") {
  const CaseFolder folder;
  const EnvironmentVariable state("XDG_STATE_HOME", folder.folder.path);
  {
    auto session = create_unsaved_case(folder.document()).value();
    CHECK(unsaved_cases().empty());
    REQUIRE(session.apply(pull(pole, Vec3(0, 0, 50))));
    CHECK(unsaved_cases().empty());  // open here
  }
  REQUIRE(edited_cases().size() == 1);
  auto again = open_case(edited_cases().front());
  REQUIRE(again);
  REQUIRE(save_case_as(again->session, folder.case_path));
  CHECK(unsaved_cases().empty());
}

}  // namespace homolog
