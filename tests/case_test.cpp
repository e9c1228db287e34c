#include "core/case/case_file.h"

#include <doctest/doctest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <random>

#include "core/base/files.h"
#include "core/volume/volume_io.h"
#include "tests/shapes.h"
#include "tests/temporary_folder.h"

namespace fs = std::filesystem;
using namespace homolog;

namespace {

const Vec3 pole(0, 0, 40);

/// A folder with a template and, once saved, a case without an image.
struct CaseFolder {
  TemporaryFolder folder;
  fs::path template_path = folder.path / "ball.ply", case_path = folder.path / "ball.homolog";

  CaseFolder() {
    const Mesh ball = icosphere(3, 40);
    MeshFile file{ball.points, ball.topology->triangles()};
    file.landmarks = {{"north", pole}, {"south", -pole}, {"east", Vec3(40, 0, 0)}, {"front", Vec3(0, -40, 0)}};
    REQUIRE(write_mesh_file(file, template_path));
  }
  Document document() const { return new_document("", nullptr, load_template(template_path.string()).value()); }
  EditSession create() const { return create_case(document(), case_path).value(); }
  std::string text() const { return read_whole_file(case_path).value(); }
  void append(const std::string& bytes) const { std::ofstream(case_path, std::ios::app | std::ios::binary) << bytes; }
};

Stroke pull(const Vec3& at, const Vec3& to, double sigma_mm = 10) {
  return {Tool::pull, at, to, sigma_mm, {}, false, 1};
}

/// The template's ball, blown up unevenly.
std::shared_ptr<const Points> found_points(double factor) {
  Points points = icosphere(3, 40 * factor).points;
  points.col(1) *= 1 / 1.3;
  return std::make_shared<const Points>(std::move(points));
}

std::vector<Action> some_of_every_kind() {
  return {
      SetPlacement{{Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Vec3(1, 2, 2) / 3)), 1.1, Vec3(3, 0.1, -7)}},
      PlaceLandmark{"north", Vec3(2, 1, 45)},
      PlaceLandmark{"south", Vec3(0, 2, -43)},
      PlaceLandmark{"east", Vec3(44, 2, 0)},
      PlaceLandmark{"front", Vec3(-3, -41, 1)},
      PlaceLandmark{"east", std::nullopt},
      PlaceLandmark{"east", Vec3(45, 2, 0)},
      SetLandmarkFit{LandmarkFit::similarity},
      SetLandmarkFit{LandmarkFit::warp},
      SetStiffnessBase{7.5},
      PaintStiffness{Vec3(0, 0, 40), 15, 30, 0.5},
      pull(pole, Vec3(4, 1, 52)),
      Stroke{Tool::grab, Vec3(40, 0, 0), Vec3(46, 3, 1), 8, {}, true, 1},
      Stroke{Tool::slide, Vec3(0, 40, 0), Vec3(3, 40, 2), 8, {}, false, 1},
      SetSpacing{0.5},
      pull(Vec3(0, 40, 0), Vec3(0, 48, 3)),
      Stroke{Tool::relax, Vec3(0, 44, 0), Vec3(0, 44, 0), 12, {}, false, 0.7},
      Confirm{Vec3(0, 0, -40), 12, true},
      pull(Vec3(-40, 0, 0), Vec3(-45, 0, -3)),
      SetScheme{Scheme::paper, 3},
      pull(Vec3(0, -40, 0), Vec3(0, -44, 0)),
      SetScheme{Scheme::anchored, 1},
      Confirm{Vec3(0, 0, -40), 12, false},
      SetPoints{"fit", Similarity{Eigen::Quaterniond::Identity(), 1.3, Vec3(0.1, 0, 7)}, found_points(1.3)},
      pull(Vec3(0, 0, 52), Vec3(1, 2, 55)),
      SetPoints{"snap", std::nullopt, found_points(1.1)},
      Note{"naïve, “quoted” \\ note"},
      SetPlacement{{Eigen::Quaterniond::Identity(), 1.2, Vec3(1, 2, 3)}},
      Undo{},
      Undo{},
      Redo{},
      MirrorTemplate{},
      Undo{},
  };
}

}  // namespace

TEST_CASE("every action reads back from its line as it was") {
  for (Action action : some_of_every_kind()) {
    for (const bool joined : {false, true}) {
      const auto read = parse_action(action_line(action, joined));
      REQUIRE(read);
      CHECK(read->action == action);
      CHECK(read->joined == joined);
    }
  }
}

TEST_CASE("replaying the file alone gives the same mesh to the last bit and the same history") {
  const CaseFolder folder;
  EditSession session = folder.create();
  for (const Action& action : some_of_every_kind()) {
    const auto done = session.apply(action);
    CHECK_MESSAGE(done, action_line(action) << ": " << (done ? "" : done.error().sentence()));
  }
  const auto read = read_case(folder.case_path);
  REQUIRE(read);
  CHECK(read->warnings.empty());
  const Document &kept = session.document(), &restored = read->session.document();
  CHECK(largest_difference(*kept.shape().points, *restored.shape().points) < 1e-12);
  CHECK(largest_difference(*kept.shape().reference, *restored.shape().reference) < 1e-12);
  CHECK(*kept.stiffness == *restored.stiffness);
  CHECK(kept.stiffness_base == restored.stiffness_base);
  CHECK(kept.shape().landmarks == restored.shape().landmarks);
  CHECK(session.undo_name() == read->session.undo_name());
  CHECK(session.redo_name() == read->session.redo_name());
  CHECK(session.strokes() == read->session.strokes());
}

TEST_CASE("undo takes back everything one by one and redo does it again") {
  const CaseFolder folder;
  EditSession session = folder.create();
  const Points start = *session.document().shape().points;
  for (const Action& action : some_of_every_kind()) REQUIRE(session.apply(action));
  while (session.can_redo()) REQUIRE(session.apply(Redo{}));
  const Points end = *session.document().shape().points;
  while (session.can_undo()) REQUIRE(session.apply(Undo{}));
  CHECK(*session.document().shape().points == start);
  CHECK(session.document().shape().landmarks.empty());
  CHECK(!session.apply(Undo{}));
  while (session.can_redo()) REQUIRE(session.apply(Redo{}));
  CHECK(*session.document().shape().points == end);
}

TEST_CASE("joined edits are one step of the history, in the file too") {
  const CaseFolder folder;
  EditSession session = folder.create();
  const auto paint = [](double x) { return PaintStiffness{Vec3(x, 0, 40), 6, 50, 0.5}; };
  REQUIRE(session.apply(pull(pole, Vec3(0, 0, 50))));
  const auto pulled = session.shared_document();
  REQUIRE(session.apply(paint(0)));
  REQUIRE(session.apply(paint(5), true));
  REQUIRE(session.apply(paint(10), true));
  const VertexScalars painted = *session.document().stiffness;
  auto read = read_case(folder.case_path);
  REQUIRE(read);
  for (EditSession* one : {&session, &read->session}) {
    REQUIRE(one->apply(Undo{}));
    CHECK(*one->document().stiffness == *pulled->stiffness);
    CHECK(one->undo_name() == action_name(pull(pole, pole)));
    REQUIRE(one->apply(Redo{}));
    CHECK(*one->document().stiffness == painted);
    CHECK_FALSE(one->can_redo());
  }
  // What is taken back or refused joins nothing.
  REQUIRE(session.apply(Undo{}));
  REQUIRE(session.apply(paint(-5), true));
  REQUIRE(session.apply(Undo{}));
  CHECK(*session.document().shape().points == *pulled->shape().points);
  CHECK_FALSE(session.apply(PaintStiffness{pole, -1, 50, 0.5}));
  REQUIRE(session.apply(paint(0), true));
  REQUIRE(session.apply(Undo{}));
  CHECK(*session.document().shape().points == *pulled->shape().points);
}

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
  CHECK(again->session.document().volume->geometry.dims == grid.dims);
}

TEST_CASE("points that were found are taken as they are and lines with other counts are refused") {
  const CaseFolder folder;
  EditSession session(folder.document());
  const auto found = found_points(1.2);
  REQUIRE(session.apply(SetPoints{"fit", std::nullopt, found}));
  CHECK(*session.document().shape().points == *found);
  CHECK(*session.document().shape().reference == session.document().reference->points);
  CHECK(session.undo_name() == "fit");
  CHECK(!session.apply(SetPoints{"fit", std::nullopt, std::make_shared<const Points>(Points::Zero(5, 3))}));
  Points broken = *found;
  broken(7, 1) = std::nan("");
  CHECK(!session.apply(SetPoints{"fit", std::nullopt, std::make_shared<const Points>(broken)}));
  CHECK(!parse_action(R"({"points":[1,2],"by":"fit"})"));
  CHECK(!parse_action(R"({"points":[1,2,"x"],"by":"fit"})"));
}

TEST_CASE("a preview changes neither the document nor the file") {
  const CaseFolder folder;
  EditSession session = folder.create();
  const std::string before = folder.text();
  const auto shown = session.preview(pull(pole, Vec3(0, 0, 50)));
  REQUIRE(shown);
  CHECK(*shown->document.shape().points != *session.document().shape().points);
  CHECK(folder.text() == before);
}

TEST_CASE("a stroke is kept exactly as its preview showed it") {
  const CaseFolder folder;
  EditSession session = folder.create();
  Updated shown;
  for (double angle = 0; angle < 0.3; angle += 0.01) {
    shown = session.preview(pull(pole, 45 * Vec3(std::sin(angle), 0, std::cos(angle)))).value();
  }
  const Vec3 last = 45 * Vec3(std::sin(0.29), 0, std::cos(0.29));
  shown = session.preview(pull(pole, last)).value();
  REQUIRE(session.apply(pull(pole, last)));
  CHECK(largest_difference(*shown.document.shape().points, *session.document().shape().points) < 1e-9);
}

TEST_CASE("a torn last line is dropped with a warning and everything before it is restored") {
  const CaseFolder folder;
  Points kept;
  {
    EditSession session = folder.create();
    REQUIRE(session.apply(pull(pole, Vec3(0, 0, 50))));
    kept = *session.document().shape().points;
  }
  const std::string torn = R"({"tool":"pull","at":[0,0,-40],"to":[0,0,-4)";
  for (std::size_t length = 1; length <= torn.size(); ++length) {
    const std::string whole = folder.text();
    folder.append(torn.substr(0, length));
    auto read = read_case(folder.case_path);
    REQUIRE(read);
    CHECK(read->warnings.size() == 1);
    CHECK(*read->session.document().shape().points == kept);
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
  { const EditSession session = folder.create(); }
  const std::string before = folder.text();
  const pid_t child = ::fork();
  if (child == 0) {  // with a disk that is full a few bytes on
    auto opened = open_case(folder.case_path);
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{before.size() + 10, before.size() + 10};
    if (!opened || ::setrlimit(RLIMIT_FSIZE, &limit) != 0) ::_exit(2);
    const Points points = *opened->session.document().shape().points;
    const auto done = opened->session.apply(pull(pole, Vec3(0, 0, 50)));
    const bool refused = !done && done.error().what.find("the edit was not made") != std::string::npos;
    ::_exit(refused && *opened->session.document().shape().points == points && !opened->session.can_undo() ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  REQUIRE(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 0);
  CHECK(folder.text() == before);
}

TEST_CASE("looking for unsaved cases does not mend what opening must find torn") {
  const CaseFolder folder;
  ::setenv("XDG_STATE_HOME", folder.folder.path.c_str(), 1);
  {
    auto session = create_unsaved_case(folder.document()).value();
    REQUIRE(session.apply(pull(pole, Vec3(0, 0, 50))));
  }
  REQUIRE(unsaved_cases().size() == 1);
  const fs::path left = unsaved_cases().front();
  std::ofstream(left, std::ios::app) << "{\"tool\":\"pu";
  REQUIRE(unsaved_cases().size() == 1);
  const auto opened = open_case(left);
  REQUIRE(opened);
  CHECK(opened->warnings.size() == 1);
  CHECK(opened->session.strokes() == 1);
  ::unsetenv("XDG_STATE_HOME");
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
  CHECK(largest_difference(*read->session.document().shape().points, *session.document().shape().points) < 1e-9);
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
    ::usleep(static_cast<useconds_t>(20000 + random() % 60000));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    int shown = 0;
    for (char byte; ::read(report[0], &byte, 1) == 1;) ++shown;
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

TEST_CASE("unsaved cases are offered once they hold an action and are not open") {
  const CaseFolder folder;
  ::setenv("XDG_STATE_HOME", folder.folder.path.c_str(), 1);
  {
    auto session = create_unsaved_case(folder.document()).value();
    CHECK(unsaved_cases().empty());
    REQUIRE(session.apply(pull(pole, Vec3(0, 0, 50))));
    CHECK(unsaved_cases().empty());  // open here
  }
  REQUIRE(unsaved_cases().size() == 1);
  auto again = open_case(unsaved_cases().front());
  REQUIRE(again);
  REQUIRE(save_case_as(again->session, folder.case_path));
  CHECK(unsaved_cases().empty());
  ::unsetenv("XDG_STATE_HOME");
}
