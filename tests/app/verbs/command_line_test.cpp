// The command-line contract of docs/commands.md, checked on the program itself: the conventions of every verb, files,
// cases.
#include <fstream>
#include <sstream>

#include "core/base/pictures/picture_io.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/model/shapes/study.h"
#include "core/session/case_file.h"
#include "core/volume/volume_io.h"
#include "tests/command_line.h"
#include "tests/real_data.h"
#include "tests/shapes.h"
#include "tests/skip.h"

namespace homolog {

namespace {

/// The verbs that `homolog … --help` lists, each behind what it is a verb of; those with verbs of their own are left
/// out.
std::vector<std::string> verbs_of(const TemporaryFolder& folder, const std::string& of = "") {
  const Ran ran = run(folder, of + "--help");
  std::vector<std::string> verbs;
  const std::string heading = "Subcommands:\n";
  const auto begin = ran.out.find(heading);
  if (begin == std::string::npos) return verbs;
  std::istringstream listed(ran.out.substr(begin + heading.size()));
  for (std::string line; std::getline(listed, line) && line.starts_with("  ");) {
    if (line.starts_with("   ")) continue;  // a description goes on
    const std::string verb = of + line.substr(2, line.find(' ', 2) - 2);
    const auto parts = verbs_of(folder, verb + " ");
    verbs.insert(verbs.end(), parts.begin(), parts.end());
    if (parts.empty()) verbs.push_back(verb);
  }
  return verbs;
}

}  // namespace

TEST_CASE("help and version answer on stdout with status 0") {
  const TemporaryFolder folder;
  CHECK(run(folder, "--version").out.rfind("homolog ", 0) == 0);
  CHECK(run(folder, "--help").status == 0);
  const std::string page = read_whole_file(fs::path(HOMOLOG_SOURCE_DIR) / "docs" / "commands.md").value();
  const auto verbs = verbs_of(folder);
  CHECK(verbs.size() > 20);
  for (const std::string& verb : verbs) {
    const Ran ran = run(folder, verb + " --help");
    CHECK_MESSAGE(ran.status == 0, verb);
    CHECK_MESSAGE(lines(ran.out) > 3, verb);
    CHECK_MESSAGE(ran.out.find("(1x)") == std::string::npos, verb << " takes several, and says one");
    CHECK_MESSAGE(page.find("| `" + verb) != std::string::npos, verb << " has no row in docs/commands.md");
  }
}

TEST_CASE("what cannot be printed is an error of help and version too") {
  const TemporaryFolder folder;
  for (const std::string arguments :
       {"--help >/dev/full", "--version >/dev/full", "fit --help >/dev/full", "--version >&-"}) {
    CAPTURE(arguments);
    const Ran ran = run(folder, arguments);
    CHECK(ran.status == 1);
    CHECK(ran.errors == "homolog: standard output: cannot be written; free some space or choose another place\n");
  }
  REQUIRE(write_mesh(icosphere(2, 40), folder.path / "ball.ply"));
  CHECK(run(folder, "convert ball.ply out.ply >&-").status == 1);
}

TEST_CASE("a wrong command line is one line with status 2 and where the help is") {
  const TemporaryFolder folder;
  for (const std::string wrong : {"info",
                                  "info --wobble a.ply",
                                  "replay case.homolog",
                                  "compare a.ply",
                                  "phantom liver --subject 1 -o x",
                                  "label-map a.ply --like b.nii -o c.nii --value zero",
                                  "mirror a.ply -o b.ply --plane oblique",
                                  "compare a.ply --mask m.nii --mesh b.ply",
                                  "replay a -o b --spacing 2",
                                  "study",
                                  "picture",
                                  "model a.ply b.ply",
                                  "model a.ply b.ply -o m.h5 --variance 2",
                                  "evaluate",
                                  "evaluate a.ply b.ply --modes few",
                                  "evaluate a.ply b.ply --samples 0",
                                  "picture modes m.h5",
                                  "replay a -o b --spacing nan",
                                  "fit t.ply --mask m.nii -o o.ply --closing-mm nan",
                                  "template m.nii -o o.ply --opening-mm -nan",
                                  "template m.nii -o o.ply --tube --axis nan,0,1",
                                  "model a.ply b.ply -o m.h5 --variance nan",
                                  "evaluate a.ply b.ply --seed -1",
                                  "picture correspondence a.ply -o b.png --glyph-spacing nan",
                                  "picture correspondence a.ply -o b.png --glyph-spacing inf",
                                  "convert a.tif b.nii --spacing 1,nan,1",
                                  "convert a.tif b.nii --spacing -1,1,1",
                                  "compare a.ply --mask m.nii --label -1",
                                  "info a.ply --mask m.nii --label -1",
                                  "snap a.ply --image b.nii -o c.ply --at nan,0,0",
                                  "snap a.ply --image b.nii -o c.ply --strength nan",
                                  "propagate a.ply --image b.nii -o c --reach-mm nan",
                                  "phantom kidney --subject -1 -o x",
                                  "study schemes built-in:kidney --phantoms 1 --seed -1",
                                  "study schemes built-in:kidney --stiffness nan",
                                  "study user built-in:kidney --mask m.nii -o c.homolog --seed -1",
                                  "evaluate a.ply b.ply --seed nan",
                                  "evaluate a.ply b.ply --seed 99999999999999999999999",
                                  "study schemes built-in:kidney --phantoms 1 --seed 18446744073709551616",
                                  "convert a.ply ''",
                                  "info ''",
                                  "mirror a.ply -o ''",
                                  "fit t.ply --mask '' -o o.ply",
                                  "--log session.log info a.ply",
                                  "--replay session.log info a.ply",
                                  "--template t.ply info a.ply",
                                  "fit t.ply --mask m.nii -o o.ply --closing-mm 1e10",
                                  "template m.nii -o o.ply --tube --axis 0,1e308,1",
                                  "snap a.ply --image b.nii -o c.ply --reach-mm 1e308",
                                  "convert a.tif b.nii --spacing 1,1e300,1"}) {
    const Ran ran = run(folder, wrong);
    INFO(wrong << ": " << ran.errors);
    CHECK(ran.status == 2);
    CHECK(ran.out.empty());
    CHECK(lines(ran.errors) == 1);
    CHECK(ran.errors.find("--help") != std::string::npos);
  }
}

TEST_CASE("info of a mesh reports every figure of the contract") {
  const TemporaryFolder folder;
  REQUIRE(write_mesh(icosphere(3, 40), folder.path / "ball.ply"));
  const Ran ran = run(folder, "info ball.ply --json");
  REQUIRE(ran.status == 0);
  const Json info = ran.json();
  CHECK(info["kind"] == "mesh");
  CHECK(info["vertices"] == 642);
  CHECK(info["faces"] == 1280);
  CHECK(info["components"] == 1);
  CHECK(info["genus"] == 0);
  CHECK(info["closed"] == true);
  CHECK(info["oriented"] == true);
  CHECK(info["self_intersections"] == 0);
  CHECK(info["bounds_mm"][1][2].get<double>() == doctest::Approx(40));
  for (const char* key : {"mean", "cv", "min", "max"}) CHECK(info["edge_length_mm"][key].is_number());
  CHECK(info["min_angle_deg"].get<double>() > 40);
}

TEST_CASE("a refusal is one line that names the file and leaves nothing half-written") {
  const TemporaryFolder folder;
  check_refused(run(folder, "info absent.ply"), "absent.ply");
  std::ofstream(folder.path / "broken.ply") << "ply\nformat ascii 1.0\nelement vertex 3\nend_header\n";
  check_refused(run(folder, "info broken.ply --json"), "broken.ply");
  check_refused(run(folder, "convert broken.ply out.vtk"), "broken.ply");
  CHECK(!fs::exists(folder.path / "out.vtk"));
  std::ofstream(folder.path / "broken.nii.gz") << "not a scan";
  check_refused(run(folder, "info broken.nii.gz"), "broken.nii.gz");
  REQUIRE(write_mesh(icosphere(2, 40), folder.path / "ball.ply"));
  check_refused(run(folder, "convert ball.ply nowhere/ball.ply"), "nowhere/ball.ply");
  check_refused(run(folder, "convert ball.ply ball.nii.gz"), "ball.nii.gz");
}

TEST_CASE("meshes that cannot carry correspondence are refused with the fault named") {
  const TemporaryFolder folder;
  const auto refuse = [&](const std::string& body, const std::string& fault) {
    std::ofstream(folder.path / "bad.obj") << body;
    const Ran ran = run(folder, "info bad.obj");
    check_refused(ran, "bad.obj");
    CHECK_MESSAGE(ran.errors.find(fault) != std::string::npos, ran.errors);
  };
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  refuse("v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "vertex");
  refuse(corners + "v 5 5 5\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n", "vertex 4");
  refuse(corners + "v 1 1 1\nf 1 2 3\nf 1 2 4\nf 1 2 5\n", "edge");
  refuse(corners, "face");
}

TEST_CASE("UTF-8 paths work in every place") {
  const TemporaryFolder folder;
  REQUIRE(write_mesh(icosphere(2, 40), folder.path / "Nière–腎臓.ply"));
  CHECK(run(folder, "convert 'Nière–腎臓.ply' 'Ça va.vtk'").status == 0);
  CHECK(fs::exists(folder.path / "Ça va.vtk"));
}

TEST_CASE("a phantom goes through replay and compare and label map") {
  const TemporaryFolder folder;
  const Ran made = run(folder, "phantom kidney --subject 2 -o phantom --json");
  REQUIRE(made.status == 0);
  const Json paths = made.json()["paths"];
  REQUIRE(paths.size() == 4);
  const std::string image = paths[0], labels = paths[1], truth = paths[2];
  const Ran user = run(
      folder, "study user built-in:kidney --mask " + labels + " --image " + image + " --pulls 6 -o k.homolog --json");
  REQUIRE_MESSAGE(user.status == 0, user.errors);
  const Ran played = run(folder, "replay k.homolog -o k.ply --json");
  REQUIRE_MESSAGE(played.status == 0, played.errors);
  CHECK(played.json()["strokes"] == user.json()["pulls"]);
  CHECK(played.json()["turned_triangles"] == 0);
  const Ran compared = run(folder, "compare k.ply --mask " + labels + " --json");
  REQUIRE(compared.status == 0);
  // The user works towards the label's boundary as a fit does; compare measures against its voxels.
  CHECK(compared.json()["assd_mm"].get<double>() ==
        doctest::Approx(user.json()["assd_mm"].get<double>()).epsilon(0.02));
  CHECK(run(folder, "compare k.ply --mesh " + truth + " --json").json()["vertex_distance_mm"]["mean"].is_number());
  const Ran voxels = run(folder, "label-map k.ply --like " + image + " -o k.nii.gz --value 7 --json");
  REQUIRE(voxels.status == 0);
  CHECK(labels_of(read_volume(folder.path / "k.nii.gz")->volume).at(7) == voxels.json()["voxels"].get<std::size_t>());
  CHECK(compared.json()["dice"].get<double>() > 0.8);

  const Ran raw = run(folder, "replay k.homolog -o raw.ply --scheme raw --json");
  CHECK(raw.status == 0);
  CHECK(read_mesh(folder.path / "raw.ply")->points != read_mesh(folder.path / "k.ply")->points);
  check_refused(run(folder, "replay k.homolog -o k2.ply --frame 3"), "k.homolog");
  CHECK(run(folder, "info k.homolog --json").json()["kind"] == "case");
}

TEST_CASE("a mirrored template keeps its numbering and turns its faces") {
  const TemporaryFolder folder;
  REQUIRE(write_mesh(icosphere(2, 40, Vec3(100, 20, 30)), folder.path / "right.ply"));
  REQUIRE(run(folder, "mirror right.ply -o left.ply").status == 0);
  const Mesh right = read_mesh(folder.path / "right.ply").value(), left = read_mesh(folder.path / "left.ply").value();
  CHECK(left.points.col(0) == -right.points.col(0));
  CHECK(left.points.col(1) == right.points.col(1));
  CHECK(run(folder, "info left.ply --json").json()["volume_ml"].get<double>() > 0);
}

TEST_CASE("pictures are written at the size asked for") {
  const TemporaryFolder folder;
  REQUIRE(write_mesh(icosphere(3, 40), folder.path / "a.ply"));
  REQUIRE(write_mesh(icosphere(3, 45), folder.path / "b.ply"));
  REQUIRE(write_mesh(icosphere(2, 45), folder.path / "c.ply"));
  const Ran ran =
      run(folder, "picture correspondence a.ply b.ply -o ab.png --size 400x200 --view 1,-1,0.5 --transparent --json");
  if (cannot_draw(ran)) return;
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  CHECK(ran.json()["size"] == Json::array({400, 200}));
  CHECK(ran.json()["glyphs"].get<int>() > 10);
  CHECK(fs::file_size(folder.path / "ab.png") > 1000);
  check_refused(run(folder, "picture correspondence a.ply c.ply -o ac.png"), "c.ply");
  CHECK(run(folder, "picture correspondence a.ply -o a.png --view sideways").status == 2);
  CHECK(run(folder, "picture correspondence a.ply -o a.png --size 9").status == 2);
}

namespace {

/// The colour of a picture's upper left corner, and how many of its pixels are not of that colour; of these, in the
/// rows that names take at the top, which are grey as letters are and which are colourful as shapes are.
struct Drawn {
  std::vector<int> ground;
  std::size_t others = 0, letters = 0, shapes = 0;

  explicit Drawn(const fs::path& file) {
    const Picture picture = read_picture(file).value();
    ground.assign(picture.rgba.begin(), picture.rgba.begin() + 4);
    for (std::size_t i = 0; i < picture.rgba.size(); i += 4)
      others += !std::equal(ground.begin(), ground.end(), picture.rgba.begin() + static_cast<std::ptrdiff_t>(i));
    constexpr std::size_t name_rows = 26;
    for (std::size_t i = 0; i < 4 * name_rows * static_cast<std::size_t>(picture.width); i += 4) {
      const auto [low, high] = std::minmax({picture.rgba[i], picture.rgba[i + 1], picture.rgba[i + 2]});
      letters += low < 200 && high - low < 20 ? 1 : 0;
      shapes += high - low > 60 ? 1 : 0;
    }
  }
};

/// 2 mm voxels, 120 mm wide.
VolumeGeometry grid_about_origin() {
  VolumeGeometry grid;
  grid.dims = {60, 60, 60};
  grid.spacing_mm.setConstant(2);
  grid.origin_mm.setConstant(-59);
  return grid;
}

/// Whether a picture is on the ground that is asked for, and captions add to it. `in_grid`: they lie over no shape.
void check_grounds(const TemporaryFolder& folder, const std::string& picture, bool in_grid) {
  const auto drawn = [&](const std::string& options) {
    const Ran ran = run(folder, picture + " -o x.png --size 320x240 " + options);
    REQUIRE_MESSAGE(ran.status == 0, picture, ": ", ran.errors);
    return Drawn(folder.path / "x.png");
  };
  CAPTURE(picture);
  CHECK(drawn("--ground transparent").ground == std::vector<int>(4, 0));
  const Drawn plain = drawn("--ground light"), captioned = drawn("--ground light --captions");
  CHECK(captioned.ground == std::vector<int>(4, 255));
  if (in_grid) {
    CHECK(captioned.letters > 30);
    CHECK(captioned.shapes == 0);
  } else {
    CHECK(captioned.others > plain.others + 50);
  }
}

}  // namespace

TEST_CASE("pictures are made on any ground with captions or without") {
  const TemporaryFolder folder;
  Study study;
  std::string balls;
  for (const double stretch : {1.0, 1.2, 1.3}) {
    Mesh ball = icosphere(3, 40);
    ball.points.col(2) *= stretch;
    const std::string name = "ball" + std::to_string(static_cast<int>(10 * stretch));
    REQUIRE(write_mesh(ball, folder.path / (name + ".ply")));
    study.cases.push_back({name, folder.path / (name + ".ply")});
    balls += name + ".ply ";
  }
  REQUIRE(write_study(study, folder.path / "a.study.json"));
  const Volume image = label_map(icosphere(3, 38), grid_about_origin(), 1);
  REQUIRE(write_volume(image, folder.path / "image.nii"));
  const auto the_template = load_template((folder.path / "ball10.ply").string()).value();
  const auto volume = std::make_shared<const Volume>(image);
  REQUIRE(
      create_case(new_document((folder.path / "image.nii").string(), volume, the_template), folder.path / "a.homolog"));
  if (cannot_draw(run(folder, "picture case a.homolog -o case.png"))) return;
  REQUIRE(run(folder, "model " + balls + "-o m.h5").status == 0);
  check_grounds(folder, "picture correspondence " + balls, true);
  check_grounds(folder, "picture modes m.h5", true);
  check_grounds(folder, "picture case a.homolog", true);
  check_grounds(folder, "picture window a.homolog --only 3d", false);
  check_grounds(folder, "picture study a.study.json --only gallery", true);
  check_grounds(folder, "picture study a.study.json --only modes", true);
  study.cases.pop_back();
  REQUIRE(write_study(study, folder.path / "two.study.json"));
  CHECK(run(folder, "picture study two.study.json -o two.png").status == 0);
  CHECK(run(folder, "picture window a.homolog -o x.png --ground light").status == 2);
  CHECK(run(folder, "picture window a.homolog -o x.png --only upside").status == 2);
  CHECK(run(folder, "picture modes m.h5 -o x.png --ground light --transparent").status == 2);
}

TEST_CASE("the bench times the editor's frames with every tool of a stroke") {
  const TemporaryFolder folder;
  const Ran ran = run(folder, "bench --editor --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  const Json rows = ran.json()["editor"];
  REQUIRE(rows.size() == 7);
  CHECK(rows[0]["structures"] == 1);
  CHECK(rows[6]["structures"] == 60);
  for (const Json& row : rows) {
    CHECK(row["frame_ms"].get<double>() > 0.01);
    CHECK(row["slowest_frame_ms"].get<double>() >= row["frame_ms"].get<double>());
  }
}

TEST_CASE("the bench opens a study of meshes and of cases and turns its pages") {
  const TemporaryFolder folder;
  const Ran ran = run(folder, "bench --study --shapes 24 --json");
  if (cannot_draw(ran)) return;
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  const Json study = ran.json()["study"];
  CHECK(study["shapes"] == 24);
  for (const char* from : {"from_meshes", "from_cases"}) {
    CHECK(study[from]["open_ms"].get<double>() > 1);
    CHECK(study[from]["at_rest_ms"].get<double>() >= study[from]["open_ms"].get<double>());
    CHECK(study[from]["turned_frame_ms"].get<double>() > 0.1);
    CHECK(study[from]["next_page_frame_ms"].get<double>() > 0.1);
  }
  CHECK(run(folder, "bench --study --editor").status == 2);
  CHECK(run(folder, "bench --shapes 24").status == 2);
}

TEST_CASE("the demo plays the whole job without a display") {
  const TemporaryFolder folder;
  const Ran ran = run(folder, "demo --headless -o out --json");
  if (cannot_draw(ran)) return;
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  for (const std::string path : ran.json()["paths"]) CHECK_MESSAGE(fs::exists(folder.path / path), path);
  CHECK(ran.json()["pulled"]["assd_mm"].get<double>() < ran.json()["placed"]["assd_mm"].get<double>());
  CHECK(ran.json()["model"]["shapes"] == 10);
  CHECK(run(folder, "replay out/demo.homolog -o again.ply").status == 0);
  const Points again = read_mesh(folder.path / "again.ply")->points;
  CHECK((again - read_mesh(folder.path / "out/kidney.ply")->points).cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("real scans: three organs adapted by boundary pulls from case files come within 1.5 mm") {
  const fs::path data = real_data();
  if (data.empty()) return;
  const TemporaryFolder folder;
  const std::string image = "'" + (data / "ct/totalseg_example_ct_3mm.nii.gz").string() + "'";
  const std::string mask = "'" + (data / "ct/totalseg_example_ct_3mm_label.nii.gz").string() + "'";
  struct Organ {
    std::string reference, label, extra;
  };
  for (const Organ& organ : {Organ{"kidney", "1", ""}, Organ{"kidney", "2", " --mirror"}, Organ{"vertebra", "5", ""}}) {
    const std::string name = organ.reference + organ.label;
    const Ran user =
        run(folder, "study user built-in:" + organ.reference + " --mask " + mask + " --label " + organ.label +
                        " --image " + image + organ.extra + " -o " + name + ".homolog --json");
    REQUIRE_MESSAGE(user.status == 0, user.errors);
    const Ran played = run(folder, "replay " + name + ".homolog -o " + name + ".ply --json");
    REQUIRE_MESSAGE(played.status == 0, played.errors);
    CHECK(played.json()["turned_triangles"] == 0);
    const Ran compared = run(folder, "compare " + name + ".ply --mask " + mask + " --label " + organ.label + " --json");
    REQUIRE_MESSAGE(compared.status == 0, compared.errors);
    CHECK_MESSAGE(compared.json()["assd_mm"].get<double>() <= 1.5, name);
  }
  check_refused(run(folder, "compare kidney1.ply --mask " + mask), "totalseg_example_ct_3mm_label.nii.gz");
}

}  // namespace homolog
