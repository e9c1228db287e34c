// The command-line contract of docs/commands.md, checked on the program itself.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/files.h"
#include "core/mesh/label_map.h"
#include "core/mesh/mesh_io.h"
#include "core/volume/volume_io.h"
#include "tests/real_data.h"
#include "tests/shapes.h"
#include "tests/temporary_folder.h"

namespace fs = std::filesystem;
using namespace homolog;
using Json = nlohmann::json;

namespace {

struct Ran {
  int status = -1;
  std::string out, errors;
  Json json() const { return Json::parse(out, nullptr, false); }
};

/// Runs the program with `arguments` as a shell would, without a display.
Ran run(const TemporaryFolder& folder, const std::string& arguments) {
  const fs::path errors = folder.path / "stderr";
  const std::string command = "cd '" + folder.path.string() +
                              "' && env -u DISPLAY -u WAYLAND_DISPLAY '" HOMOLOG_PROGRAM "' " + arguments + " 2>'" +
                              errors.string() + "' </dev/null";
  FILE* pipe = ::popen(command.c_str(), "r");
  REQUIRE(pipe != nullptr);
  Ran ran;
  std::array<char, 4096> buffer{};
  for (std::size_t got = 0; (got = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    ran.out.append(buffer.data(), got);
  const int status = ::pclose(pipe);
  ran.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  ran.errors = read_whole_file(errors).value_or("");
  return ran;
}

std::size_t lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

/// A refusal: status 1, nothing on stdout, one line on stderr that starts as the contract says and names `subject`.
void check_refused(const Ran& ran, const std::string& subject) {
  INFO(ran.errors);
  CHECK(ran.status == 1);
  CHECK(ran.out.empty());
  CHECK(lines(ran.errors) == 1);
  CHECK(ran.errors.rfind("homolog: ", 0) == 0);
  CHECK(ran.errors.find(subject) != std::string::npos);
}

const char* all_verbs[] = {"demo",       "info",          "replay",  "compare",      "label-map",
                           "mirror",     "phantom",       "convert", "picture case", "picture correspondence",
                           "study user", "bench",         "model",   "evaluate",     "picture modes",
                           "template",   "study schemes", "fit",     "snap",         "propagate"};

}  // namespace

TEST_CASE("help and version answer on stdout with status 0") {
  const TemporaryFolder folder;
  CHECK(run(folder, "--version").out.rfind("homolog ", 0) == 0);
  CHECK(run(folder, "--help").status == 0);
  for (const std::string verb : all_verbs) {
    const Ran ran = run(folder, verb + " --help");
    CHECK_MESSAGE(ran.status == 0, verb);
    CHECK_MESSAGE(lines(ran.out) > 3, verb);
  }
}

TEST_CASE("a wrong command line is one line with status 2 and where the help is") {
  const TemporaryFolder folder;
  for (const std::string wrong :
       {"info", "info --wobble a.ply", "replay case.homolog", "compare a.ply", "phantom liver --subject 1 -o x",
        "label-map a.ply --like b.nii -o c.nii --value zero", "mirror a.ply -o b.ply --plane oblique",
        "compare a.ply --mask m.nii --mesh b.ply", "replay a -o b --spacing 2", "study", "picture", "model a.ply b.ply",
        "model a.ply b.ply -o m.h5 --variance 2", "evaluate", "evaluate a.ply b.ply --modes few",
        "evaluate a.ply b.ply --samples 0", "picture modes m.h5"}) {
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
  if (ran.status == 1 && ran.errors.find("OpenGL") != std::string::npos) {
    MESSAGE("skipped: no OpenGL here");
    return;
  }
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  CHECK(ran.json()["size"] == Json::array({400, 200}));
  CHECK(ran.json()["glyphs"].get<int>() > 10);
  CHECK(fs::file_size(folder.path / "ab.png") > 1000);
  check_refused(run(folder, "picture correspondence a.ply c.ply -o ac.png"), "c.ply");
  CHECK(run(folder, "picture correspondence a.ply -o a.png --view sideways").status == 2);
  CHECK(run(folder, "picture correspondence a.ply -o a.png --size 9").status == 2);
}

TEST_CASE("a training set becomes a model that info and picture and evaluate know") {
  const TemporaryFolder folder;
  std::string files;
  for (int k = 0; k < 6; ++k) {
    Mesh mesh = icosphere(2, 40);
    mesh.points.col(0) *= 1 + 0.1 * std::sin(k);
    mesh.points.col(1) += 0.003 * std::cos(2.0 * k) * mesh.points.col(2).cwiseAbs2();
    mesh.points.col(2) += 0.1 * std::sin(3.0 * k) * mesh.points.col(0);
    files += " k" + std::to_string(k) + ".ply";
    REQUIRE(write_mesh(mesh, folder.path / ("k" + std::to_string(k) + ".ply")));
  }
  for (const std::string name : {"m.h5.json", "m.h5"}) {
    const Ran made = run(folder, "model" + files + " -o " + name + " --csv tables --aligned aligned --json");
    REQUIRE_MESSAGE(made.status == 0, made.errors);
    CHECK(made.json()["shapes"] == 6);
    CHECK(made.json()["vertices"] == 162);
    CHECK(made.json()["variances"].size() == 5);
    CHECK(made.json()["explained"][4].get<double>() == doctest::Approx(1));
    const Json info = run(folder, "info " + name + " --json").json();
    CHECK(info["kind"] == "model");
    CHECK(info["modes"] == made.json()["modes"]);
    CHECK(info["shapes"][5] == "k5");
  }
  for (const char* path :
       {"tables/mean.csv", "tables/variances.csv", "tables/scores.csv", "aligned/k3.ply", "aligned/k3.particles"})
    CHECK_MESSAGE(fs::exists(folder.path / path), path);

  const Ran evaluated = run(folder, "evaluate" + files + " --modes 1,3 --samples 50 --csv measures.csv --json");
  REQUIRE_MESSAGE(evaluated.status == 0, evaluated.errors);
  const Json measures = evaluated.json();
  for (const std::string key : {"compactness", "generalization_rms", "specificity_rms"}) {
    CHECK(measures[key].size() == 4);
    CHECK(measures[key + "_se"].size() == 4);
  }
  CHECK(measures["modes"] == Json::array({1, 3}));
  for (const std::string key : {"generalization", "specificity", "generalization_surface"}) {
    CHECK(measures[key].size() == 2);
    CHECK(measures[key + "_se"].size() == 2);
    CHECK(measures[key][0].get<double>() > 0);
  }
  CHECK(measures["shapeworks"]["specificity"].size() == 2);
  CHECK(lines(read_whole_file(folder.path / "measures.csv").value()) == 5);
  CHECK(run(folder, "evaluate" + files + " --modes 1,3 --samples 50 --json").json() == measures);
  CHECK(run(folder, "evaluate" + files + " --modes 1,3 --samples 50 --seed 2 --json").json() != measures);
  CHECK(run(folder, "evaluate" + files + " --modes all --json").json()["modes"] == Json::array({1, 2, 3, 4}));

  const Ran picture = run(folder, "picture modes m.h5 -o modes.png --size 300x200 --json");
  if (picture.status == 1 && picture.errors.find("OpenGL") != std::string::npos) {
    MESSAGE("picture skipped: no OpenGL here");
    return;
  }
  REQUIRE_MESSAGE(picture.status == 0, picture.errors);
  CHECK(picture.json()["size"] == Json::array({300, 200}));
}

TEST_CASE("a training set with faults is refused or goes on as documented") {
  const TemporaryFolder folder;
  for (int k = 0; k < 3; ++k)
    REQUIRE(write_mesh(shapes::torus(8, 6, 20 + k, 5 + k * k), folder.path / ("t" + std::to_string(k) + ".ply")));
  REQUIRE(write_mesh(icosphere(1, 20), folder.path / "ball.ply"));
  check_refused(run(folder, "model t0.ply ball.ply t1.ply -o m.h5"), "ball.ply");
  check_refused(run(folder, "model t0.ply -o m.h5"), "t0.ply");
  check_refused(run(folder, "model t0.ply t1.ply -o m.txt"), "m.txt");
  check_refused(run(folder, "evaluate t0.ply t1.ply"), "at least three");
  check_refused(run(folder, "evaluate t0.ply t1.ply t2.ply --modes 5"), "--modes 5");
  check_refused(run(folder, "info absent.h5"), "absent.h5");
  const Ran two = run(folder, "model t0.ply absent.ply t1.ply -o m.h5 --json");
  CHECK(two.status == 0);
  CHECK(two.json()["modes"] == 1);
  CHECK(two.errors.find("homolog: warning: absent.ply") != std::string::npos);
  CHECK(two.errors.find("single mode") != std::string::npos);
}

TEST_CASE("template makes a reference mesh of a label and says how") {
  const TemporaryFolder folder;
  REQUIRE(run(folder, "phantom kidney --subject 1 -o .").status == 0);
  const Ran ran = run(folder, "template kidney-1-labels.nii.gz -o t.ply --vertices 800 --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  const auto report = ran.json();
  CHECK(report["vertices"] == 800);
  CHECK(report["genus"] == 0);
  CHECK(report["closed"] == true);
  CHECK(report["self_intersections"] == 0);
  for (const char* key : {"mean", "p95", "max"}) {
    CHECK(report["distance_to_mask_mm"][key].get<double>() < 3);
    CHECK(report["distance_from_mask_mm"].contains(key));
  }
  const auto file = read_mesh_file(folder.path / "t.ply");
  REQUIRE(file);
  REQUIRE(file->stiffness);
  CHECK(std::any_of(file->comments.begin(), file->comments.end(),
                    [](const std::string& comment) { return comment.starts_with("homolog.provenance {"); }));
  const auto info = run(folder, "info t.ply --mask kidney-1-labels.nii.gz --json").json();
  CHECK(info["distance_to_mask_mm"]["mean"].get<double>() ==
        doctest::Approx(report["distance_to_mask_mm"]["mean"].get<double>()).epsilon(0.05));
  const Ran again = run(folder, "template t.ply -o u.ply --vertices 500 --json");
  REQUIRE_MESSAGE(again.status == 0, again.errors);
  CHECK(again.json()["vertices"] == 500);
  CHECK(run(folder, "template kidney-1-labels.nii.gz -o v.ply --label 4").status == 1);
  CHECK(run(folder, "template kidney-1-labels.nii.gz -o v.ply --opening-mm 20 --closing-mm 0").status == 1);
  CHECK(run(folder, "template kidney-1-labels.nii.gz -o v.ply --genus many").status == 2);
  CHECK(run(folder, "template kidney-1-labels.nii.gz -o v.ply --rings 5").status == 2);
  CHECK_FALSE(fs::exists(folder.path / "v.ply"));
}

TEST_CASE("template --tube makes rings and sectors of a ventricle") {
  const TemporaryFolder folder;
  REQUIRE(run(folder, "phantom ventricle --subject 1 -o .").status == 0);
  const Ran ran =
      run(folder, "template ventricle-1-labels.nii.gz --label 1 --tube --rings 12 --sectors 20 -o t.ply --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  CHECK(ran.json()["vertices"] == 12 * 20 + 1);
  CHECK(ran.json()["closed"] == false);
  CHECK(ran.json()["distance_to_mask_mm"]["mean"].get<double>() < 2);
}

TEST_CASE("the demo plays the whole job without a display") {
  const TemporaryFolder folder;
  const Ran ran = run(folder, "demo --headless -o out --json");
  if (ran.status == 1 && ran.errors.find("OpenGL") != std::string::npos) {
    MESSAGE("skipped: no OpenGL here");
    return;
  }
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

TEST_CASE("fit does every case of a folder that can be done and reports the others") {
  const TemporaryFolder folder;
  const Mesh ball = icosphere(3, 20);
  VolumeGeometry grid;
  grid.dims = {30, 30, 30};
  grid.spacing_mm.setConstant(2);
  grid.origin_mm.setConstant(-29);
  REQUIRE(write_mesh(ball, folder.path / "ball.ply"));
  REQUIRE(write_volume(label_map(ball, grid), folder.path / "good.nii.gz"));
  REQUIRE(write_volume(label_map({ball.topology, 0.001 * ball.points}, grid), folder.path / "empty.nii.gz"));
  const Ran both = run(folder, "fit ball.ply --mask good.nii.gz empty.nii.gz -o fitted --json");
  CHECK(both.status == 0);
  const Json json = both.json();
  REQUIRE(json.is_object());
  CHECK(json["fitted"] == 1);
  CHECK(json["failed"] == 1);
  CHECK(json["cases"][0]["dice"] > 0.97);
  CHECK(json["cases"][0]["turned_triangles"] == 0);
  CHECK(json["cases"][1]["error"].get<std::string>().find("empty.nii.gz") == 0);
  CHECK(fs::exists(folder.path / "fitted" / "good.ply"));
  CHECK(!fs::exists(folder.path / "fitted" / "empty.ply"));

  check_refused(run(folder, "fit ball.ply --mask empty.nii.gz -o M.ply"), "empty.nii.gz");
  check_refused(run(folder, "fit ball.ply --mask good.nii.gz --label 7 -o M.ply"), "label 7");
  CHECK(!fs::exists(folder.path / "M.ply"));
  CHECK(run(folder, "fit ball.ply --mask good.nii.gz empty.nii.gz -o M.ply").status == 2);
  CHECK(run(folder, "fit ball.ply -o M.ply").status == 2);
}

TEST_CASE("fit starts where a placement file says") {
  const TemporaryFolder folder;
  const Mesh ball = icosphere(3, 20);
  VolumeGeometry grid;
  grid.dims = {30, 30, 30};
  grid.spacing_mm.setConstant(2);
  grid.origin_mm.setConstant(-29);
  REQUIRE(write_mesh(ball, folder.path / "ball.ply"));
  REQUIRE(write_volume(label_map(ball, grid), folder.path / "good.nii.gz"));
  std::ofstream(folder.path / "near.json") << R"({"placement":{"rotation":[1,0,0,0],"scale":1,"translation":[4,0,0]}})";
  std::ofstream(folder.path / "far.json") << R"({"rotation":[1,0,0,0],"scale":1,"translation":[400,0,0]})";
  std::ofstream(folder.path / "wrong.json") << "[]";
  CHECK(run(folder, "fit ball.ply --mask good.nii.gz -o M.ply --placement near.json").status == 0);
  check_refused(run(folder, "fit ball.ply --mask good.nii.gz -o N.ply --placement far.json"), "placement");
  check_refused(run(folder, "fit ball.ply --mask good.nii.gz -o N.ply --placement wrong.json"), "wrong.json");
}

TEST_CASE("study schemes compares ways of working and writes tables and case files") {
  const TemporaryFolder folder;
  const Mesh ball = icosphere(3, 20);
  Mesh longer = ball;
  longer.points.col(2) *= 1.3;
  VolumeGeometry grid;
  grid.dims = {30, 30, 36};
  grid.spacing_mm.setConstant(2);
  grid.origin_mm = Vec3(-29, -29, -35);
  REQUIRE(write_mesh(ball, folder.path / "ball.ply"));
  REQUIRE(write_volume(label_map(longer, grid), folder.path / "good.nii.gz"));
  REQUIRE(write_volume(label_map(longer, grid, 2), folder.path / "other.nii.gz"));

  const Ran ran = run(folder,
                      "study schemes ball.ply --mask good.nii.gz other.nii.gz --label 1 --schemes raw,anchored "
                      "--pulls 4 -o out --cases --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  CHECK(ran.errors.find("other.nii.gz: label 1") != std::string::npos);
  const Json json = ran.json();
  REQUIRE(json["schemes"].size() == 2);
  CHECK(json["schemes"][1]["scheme"] == "anchored");
  CHECK(json["schemes"][1]["cases"] == 1);
  CHECK(json["schemes"][1]["turned_triangles"] == 0);
  CHECK(json["runs"][1]["assd_mm"] < json["runs"][1]["assd_placed_mm"]);
  CHECK(json["runs"][1]["landmarks_mm"].is_null());
  for (const std::string path : json["paths"]) CHECK_MESSAGE(fs::exists(folder.path / path), path);

  const Ran played = run(folder, "replay out/good.anchored.homolog -o again.ply --json");
  REQUIRE_MESSAGE(played.status == 0, played.errors);
  CHECK(played.json()["strokes"] == json["runs"][1]["pulls"]);

  check_refused(run(folder, "study schemes ball.ply --mask other.nii.gz --label 1 --json"), "other.nii.gz");
  check_refused(run(folder, "study schemes ball.ply --mask good.nii.gz --schemes magic"), "magic");
  check_refused(run(folder, "study schemes ball.ply --mask good.nii.gz --schemes raw+warp"), "raw+warp");
  CHECK(run(folder, "study schemes ball.ply").status == 2);
  CHECK(run(folder, "study schemes ball.ply --phantoms 1").status == 2);
  CHECK(run(folder, "study schemes built-in:kidney --phantoms 1 --cases").status == 2);
}

TEST_CASE("study schemes knows the truth of phantoms") {
  const TemporaryFolder folder;
  const Ran ran =
      run(folder, "study schemes built-in:ventricle --phantoms 1,2,3,4 --schemes anchored+warp --pulls 2 --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  const Json json = ran.json();
  CHECK(json["default_scheme"] == "anchored+warp");
  REQUIRE(json["schemes"].size() == 2);
  const Json& ours = json["schemes"][0];
  CHECK(ours["landmarks_mm"] < ours["landmarks_placed_mm"]);
  CHECK(ours["generalization_rms"] > 0);
  CHECK(json["schemes"][1]["scheme"] == "truth");
  CHECK(json["paths"].empty());
}

namespace {

/// A ball of 20 mm in the middle of an image; frame by frame smaller where there are several.
Volume ball_image(int frames) {
  VolumeGeometry grid;
  grid.dims = {30, 30, 30};
  grid.spacing_mm.setConstant(2);
  grid.origin_mm.setConstant(-29);
  Volume image;
  std::vector<std::uint8_t> voxels;
  for (int f = 0; f < frames; ++f) {
    image = label_map(icosphere(3, 20 - 1.5 * f), grid, 100);
    const auto& frame = std::get<std::vector<std::uint8_t>>(image.data);
    voxels.insert(voxels.end(), frame.begin(), frame.end());
  }
  image.data = std::move(voxels);
  image.frames = frames;
  return image;
}

}  // namespace

TEST_CASE("snap and fit to an image report confidence and write the mesh on the edge") {
  const TemporaryFolder folder;
  REQUIRE(write_mesh(icosphere(3, 23), folder.path / "large.ply"));
  REQUIRE(write_mesh(icosphere(3, 20), folder.path / "truth.ply"));
  REQUIRE(write_volume(ball_image(1), folder.path / "ball.nii.gz"));
  std::ofstream(folder.path / "near.json") << R"({"rotation":[1,0,0,0],"scale":1,"translation":[1,0,0]})";
  std::ofstream(folder.path / "far.json") << R"({"rotation":[1,0,0,0],"scale":1,"translation":[400,0,0]})";
  for (const std::string command :
       {"snap large.ply --image ball.nii.gz", "fit large.ply --image ball.nii.gz --placement near.json"}) {
    const Ran ran = run(folder, command + " -o M.ply --json");
    INFO(ran.errors);
    REQUIRE(ran.status == 0);
    const Json json = ran.json();
    CHECK(json["confidence"] > 0.8);
    CHECK(json["doubtful"] == false);
    CHECK(json["turned_triangles"] == 0);
    CHECK(json["self_intersections"] == 0);
    CHECK(json["moved_mm"] > 2);
    CHECK(run(folder, "compare M.ply --mesh truth.ply --json").json()["assd_mm"] < 0.6);
  }
  const Ran still = run(folder, "snap large.ply --image ball.nii.gz --strength 0 -o S.ply --json");
  CHECK(still.json()["moved_mm"] == 0);
  check_refused(run(folder, "fit large.ply --image ball.nii.gz --placement far.json -o N.ply"), "ball.nii.gz");
  check_refused(run(folder, "fit large.ply --image ball.nii.gz -o N.ply"), "--placement");
  check_refused(run(folder, "snap large.ply --image ball.nii.gz --frame 3 -o N.ply"), "ball.nii.gz");
  CHECK(!fs::exists(folder.path / "N.ply"));
  CHECK(run(folder, "snap large.ply -o N.ply").status == 2);
}

TEST_CASE("a snap of a case is one more line and replays without search") {
  const TemporaryFolder folder;
  REQUIRE(write_mesh(icosphere(3, 23), folder.path / "large.ply"));
  REQUIRE(write_volume(ball_image(1), folder.path / "ball.nii.gz"));
  std::ofstream(folder.path / "c.homolog")
      << R"({"homolog":1,"volume":"ball.nii.gz","template":"large.ply","placement":{"rotation":[1,0,0,0],"scale":1,"translation":[0,0,0]}})"
      << "\n";
  REQUIRE(run(folder, "snap c.homolog -o snapped.ply").status == 0);
  const std::string text = read_whole_file(folder.path / "c.homolog").value();
  CHECK(lines(text) == 2);
  CHECK(text.find(R"("by":"snap")") != std::string::npos);
  REQUIRE(run(folder, "replay c.homolog -o replayed.ply").status == 0);
  CHECK(run(folder, "compare snapped.ply --mesh replayed.ply --json").json()["vertex_distance_mm"]["max"] < 1e-9);
}

TEST_CASE("propagate writes a mesh a frame with volumes and a study") {
  const TemporaryFolder folder;
  REQUIRE(write_mesh(icosphere(3, 20), folder.path / "first.ply"));
  REQUIRE(write_volume(ball_image(4), folder.path / "cine.nii.gz"));
  const Ran ran = run(folder, "propagate first.ply --image cine.nii.gz --frame 0 -o out --json");
  INFO(ran.errors);
  REQUIRE(ran.status == 0);
  const Json json = ran.json();
  REQUIRE(json["frames"].size() == 4);
  CHECK(json["end_diastole"] == 0);
  CHECK(json["end_systole"] == 3);
  CHECK(json["ejection_fraction"].get<double>() == doctest::Approx(1 - std::pow(15.5 / 20, 3)).epsilon(0.1));
  CHECK(lines(read_whole_file(folder.path / "out" / "volumes.csv").value()) == 5);
  CHECK(fs::exists(folder.path / "out" / "cine.study.json"));
  REQUIRE(run(folder, "replay out/cine.homolog --frame 2 -o replayed.ply").status == 0);
  CHECK(run(folder, "compare out/frame-02.ply --mesh replayed.ply --json").json()["vertex_distance_mm"]["max"] < 1e-6);
  check_refused(run(folder, "propagate first.ply --image cine.nii.gz --frame 4 -o out"), "cine.nii.gz");
}
