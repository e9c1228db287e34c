// The command-line contract of docs/commands.md: fit, snap, propagate and the studies.
#include <array>
#include <fstream>
#include <map>

#include "core/mesh/construction/mirror.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/phantom/phantom.h"
#include "core/volume/volume_io.h"
#include "tests/ball_folder.h"
#include "tests/case_folder.h"
#include "tests/command_line.h"
#include "tests/real_data.h"
#include "tests/shapes.h"

namespace homolog {

TEST_CASE("fit does every case of a folder that can be done and reports the others") {
  const BallFolder folder;
  REQUIRE(write_volume(label_map({folder.ball.topology, 0.001 * folder.ball.points}, folder.grid),
                       folder.path / "empty.nii.gz"));
  const Ran both = run(folder, "fit ball.ply --mask good.nii.gz empty.nii.gz -o fitted --json");
  CHECK(both.status == 0);
  const Json json = both.json();
  REQUIRE(json.is_object());
  CHECK(json["fitted"] == 1);
  CHECK(json["failed"] == 1);
  CHECK(json["cases"][0]["dice"] > 0.97);
  CHECK(json["cases"][0]["turned_triangles"] == 0);
  CHECK(json["cases"][0]["doubt_mm"]["mean"] > 0);
  CHECK(json["cases"][0]["doubt_mm"]["max"] >= json["cases"][0]["doubt_mm"]["p95"]);
  CHECK(json["cases"][1]["error"].get<std::string>().find("empty.nii.gz") == 0);
  CHECK(fs::exists(folder.path / "fitted" / "good.ply"));
  CHECK(!fs::exists(folder.path / "fitted" / "empty.ply"));

  check_refused(run(folder, "fit ball.ply --mask empty.nii.gz -o M.ply"), "empty.nii.gz");
  check_refused(run(folder, "fit ball.ply --mask good.nii.gz --label 7 -o M.ply"), "label 7");
  CHECK(!fs::exists(folder.path / "M.ply"));
  CHECK(run(folder, "fit ball.ply --mask good.nii.gz empty.nii.gz -o M.ply").status == 2);
  CHECK(run(folder, "fit ball.ply -o M.ply").status == 2);
}

TEST_CASE("fit refuses a folder whose study has another template before anything is fitted") {
  const BallFolder folder;
  REQUIRE(write_mesh(icosphere(2, 20), folder.path / "coarse.ply"));
  REQUIRE(run(folder, "fit ball.ply --mask good.nii.gz -o fits").status == 0);
  const fs::path mesh = folder.path / "fits/good.ply";
  const std::string before = read_whole_file(mesh).value();
  const Ran other = run(folder, "fit coarse.ply --mask good.nii.gz -o fits");
  check_refused(other, "fits/fits.study.json: is of the template ");
  CHECK(other.errors.find("which has other faces than coarse.ply; give that template, or another folder") !=
        std::string::npos);
  CHECK(read_whole_file(mesh).value() == before);
  CHECK(run(folder, "fit ball.ply --mask good.nii.gz -o fits").status == 0);
  // A mesh alone comes into no study.
  CHECK(run(folder, "fit coarse.ply --mask good.nii.gz -o fits/coarse.ply").status == 0);
}

TEST_CASE("fit refuses landmarks that the template lacks and says how many it used") {
  const NamedBallFolder folder;
  fs::copy(folder.path / "good.nii.gz", folder.path / "plain.nii.gz");
  const auto write = [&](const char* name, const char* text) { std::ofstream(folder.path / "places" / name) << text; };
  write("good.json", R"([{"id":"top","coordinates":[0,0,20]}])");
  write("other.json", R"([{"id":"top","coordinates":[0,0,20]},{"id":"apex","coordinates":[1,2,3]}])");

  check_refused(run(folder, "fit named.ply --mask good.nii.gz -o M.ply --landmarks places/other.json"), "\"apex\"");
  CHECK(!fs::exists(folder.path / "M.ply"));
  const Ran one = run(folder, "fit named.ply --mask good.nii.gz -o M.ply --landmarks places/good.json --json");
  CHECK(one.json()["landmarks_used"] == 1);
  CHECK(one.json()["landmarks_place"] == false);
  CHECK(one.json()["mirrored"] == false);
  CHECK(one.errors.find("did not help to place") != std::string::npos);

  const Ran many =
      run(folder, "fit named.ply --mask good.nii.gz other.nii.gz plain.nii.gz -o out --landmarks places --json");
  CHECK(many.status == 0);
  const Json cases = many.json()["cases"];
  REQUIRE(cases.size() == 3);
  CHECK(cases[0]["landmarks_used"] == 1);
  CHECK(cases[1]["landmarks_used"] == 1);
  CHECK(cases[2]["landmarks_used"] == 0);
  CHECK(many.errors.find("other.nii.gz: its landmark file names \"apex\"") != std::string::npos);
  CHECK(many.errors.find("plain.nii.gz: has no landmark file in places (plain.mrk.json, .fcsv or .json)") !=
        std::string::npos);
  CHECK(run(folder, "fit named.ply --mask good.nii.gz other.nii.gz -o out --landmarks places/good.json").status == 2);
}

TEST_CASE("fit refuses landmarks at one place and landmark files without points") {
  const NamedBallFolder folder;
  std::ofstream(folder.path / "places/good.json")
      << R"([{"id":"top","coordinates":[0,0,20]},{"id":"left","coordinates":[0,0,20.0005]},)"
      << R"({"id":"back","coordinates":[0,20,0]}])";
  std::ofstream(folder.path / "places/other.json") << "[]";
  const std::string one = "fit named.ply --mask good.nii.gz -o M.ply --landmarks places/";
  check_refused(run(folder, one + "good.json"), "places/good.json: has \"left\", \"top\" at one place; place each");
  check_refused(run(folder, one + "other.json"), "places/other.json: holds no points; place");
  CHECK_FALSE(fs::exists(folder.path / "M.ply"));
  const Ran many = run(folder, "fit named.ply --mask good.nii.gz other.nii.gz -o out --landmarks places --json");
  CHECK(many.status == 0);
  CHECK(many.json()["cases"][0]["landmarks_used"] == 1);
  CHECK(many.json()["cases"][0]["landmarks_place"] == false);
  CHECK(many.errors.find("good.nii.gz: its landmark file has \"left\", \"top\" at one place; they were left out") !=
        std::string::npos);
  CHECK(many.errors.find("other.nii.gz: its landmark file holds no points") != std::string::npos);
}

TEST_CASE("fit says that an organ looks mirrored and does not with the template of its side") {
  const TemporaryFolder folder;
  MeshFile other = mirrored(phantom_truth(Organ::kidney, 2).front());
  REQUIRE(write_mesh_file(other, folder.path / "left.ply"));
  const Ran wrong = run(folder, "fit built-in:kidney --mesh left.ply -o M.ply --json");
  CHECK(wrong.status == 0);
  CHECK(wrong.json()["mirrored"] == true);
  CHECK(wrong.json()["doubtful"] == true);
  CHECK(wrong.errors.find("mirror") != std::string::npos);
  const Ran right = run(folder, "fit built-in:kidney --mesh left.ply -o M.ply --json --mirror");
  CHECK(right.json()["mirrored"] == false);
  CHECK(right.json()["doubtful"] == false);
  CHECK(right.errors.empty());
}

TEST_CASE("template says what is wrong with the surface it was made of") {
  const TemporaryFolder folder;
  REQUIRE(write_mesh(shapes::torus(48, 32, 5, 8), folder.path / "spindle.ply"));
  const Ran ran = run(folder, "template spindle.ply --vertices 400 --genus keep -o T.ply");
  CHECK(ran.status == 0);
  CHECK(ran.errors.find("faces that cut each other") != std::string::npos);
  // Nobody asked to keep it as it is: it is made anew.
  const Ran anew = run(folder, "template spindle.ply --vertices 400 -o T.ply --json");
  CHECK(anew.json()["self_intersections"] == 0);
  CHECK(anew.errors.find("was rebuilt from voxels") != std::string::npos);
}

TEST_CASE("fit starts where a placement file says") {
  const BallFolder folder;
  std::ofstream(folder.path / "near.json") << R"({"placement":{"rotation":[1,0,0,0],"scale":1,"translation":[4,0,0]}})";
  std::ofstream(folder.path / "far.json") << R"({"rotation":[1,0,0,0],"scale":1,"translation":[400,0,0]})";
  std::ofstream(folder.path / "wrong.json") << "[]";
  CHECK(run(folder, "fit ball.ply --mask good.nii.gz -o M.ply --placement near.json").status == 0);
  check_refused(run(folder, "fit ball.ply --mask good.nii.gz -o N.ply --placement far.json"), "placement");
  check_refused(run(folder, "fit ball.ply --mask good.nii.gz -o N.ply --placement wrong.json"), "wrong.json");
  for (const char* huge : {R"("scale":1,"translation":[0,1e308,0])", R"("scale":1,"translation":[0,-2e9,0])",
                           R"("scale":1e300,"translation":[0,0,0])", R"("scale":1e-300,"translation":[0,0,0])"}) {
    std::ofstream(folder.path / "huge.json") << R"({"rotation":[1,0,0,0],)" << huge << "}";
    check_refused(run(folder, "fit ball.ply --mask good.nii.gz -o N.ply --placement huge.json", "timeout 20 "),
                  "huge.json");
  }
}

TEST_CASE("a pull to nowhere is refused with its line and none runs for ever") {
  const BallFolder folder;
  std::ofstream(folder.path / "far.homolog") << R"({"homolog":1,"template":"ball.ply"})"
                                             << "\n"
                                             << R"({"tool":"pull","at":[0,0,20],"to":[0,0,1e308],"sigma_mm":10})"
                                             << "\n";
  for (const char* verb : {"info far.homolog", "replay far.homolog -o o.ply"})
    check_refused(run(folder, verb, "timeout 20 "), "far.homolog: line 2: \"to\" lies beyond 1,000,000,000 mm");
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
                      "study schemes ball.ply --mask good.nii.gz other.nii.gz --label 1 "
                      "--schemes raw,anchored,fit,projection "
                      "--pulls 4 -o out --cases --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  CHECK(ran.errors.find("other.nii.gz: label 1") != std::string::npos);
  const Json json = ran.json();
  REQUIRE(json["schemes"].size() == 4);
  CHECK(json["schemes"][1]["scheme"] == "anchored");
  CHECK(json["schemes"][1]["cases"] == 1);
  CHECK(json["schemes"][1]["turned_triangles"] == 0);
  CHECK(json["runs"][1]["assd_mm"] < json["runs"][1]["assd_placed_mm"]);
  CHECK(json["runs"][1]["landmarks_mm"].is_null());
  for (const int without_hand : {2, 3}) {
    CHECK(json["runs"][without_hand]["pulls"] == 0);
    CHECK(json["runs"][without_hand]["assd_mm"] < json["runs"][1]["assd_mm"]);
  }
  for (const std::string path : json["paths"]) CHECK_MESSAGE(fs::exists(folder.path / path), path);

  const Ran played = run(folder, "replay out/good.anchored.homolog -o again.ply --json");
  REQUIRE_MESSAGE(played.status == 0, played.errors);
  CHECK(played.json()["strokes"] == json["runs"][1]["pulls"]);

  const Ran refined = run(folder, "refine out/good.anchored.homolog -o refined.ply --json");
  REQUIRE_MESSAGE(refined.status == 0, refined.errors);
  CHECK(refined.json()["moved_mm"]["mean"] > 0.01);
  CHECK(refined.json()["surface_distance_mm"]["mean"] < 0.1);
  CHECK(refined.json()["turned_triangles"] == 0);
  CHECK(run(folder, "replay out/good.anchored.homolog -o again.ply").status == 0);
  CHECK(run(folder, "compare refined.ply --mesh again.ply --json").json()["vertex_distance_mm"]["max"] < 1e-4);
  check_refused(run(folder, "refine ball.ply"), "ball.ply");

  const Ran fitted = run(folder, "replay out/good.fit.homolog -o fitted.ply --json");
  REQUIRE_MESSAGE(fitted.status == 0, fitted.errors);

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
  CHECK(json["default_scheme"] == "anchored+warp+refine");
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

TEST_CASE("refine and snap of a case work on the structure that is named and say which they take") {
  const CaseFolder made;
  made.create();
  made.append(
      R"({"structure":{"id":"s2","name":"other","template":"ball.ply","placement":{"rotation":[1,0,0,0],"scale":1,"translation":[200,0,0]}}})"
      "\n");
  const TemporaryFolder& folder = made.folder;
  // What a pull draws out is refined.
  for (const char* of : {"", R"(,"of":"s2")"})
    made.append(std::string(R"({"tool":"pull","at":[)") + (*of == 0 ? "0" : "200") + R"(,0,40],"to":[)" +
                (*of == 0 ? "0" : "200") + R"(,0,55],"sigma_mm":10)" + of + "}\n");
  const auto mesh_of = [&](const std::string& structure) {
    const Ran ran = run(folder, "replay ball.homolog --structure " + structure + " -o now.ply");
    REQUIRE_MESSAGE(ran.status == 0, ran.errors);
    return read_mesh_file(folder.path / "now.ply").value().points;
  };
  const Points first = mesh_of("s1"), second = mesh_of("other");
  const Ran named = run(folder, "refine ball.homolog --structure other -o refined.ply --json");
  REQUIRE_MESSAGE(named.status == 0, named.errors);
  CHECK(named.json()["moved_mm"]["mean"] > 0.01);
  CHECK(named.errors.find("of which the first") == std::string::npos);
  CHECK(mesh_of("s1") == first);
  CHECK(mesh_of("other") != second);
  CHECK(run(folder, "compare refined.ply --mesh now.ply --json").json()["vertex_distance_mm"]["max"] < 1e-4);
  CHECK(run(folder, "verify refined.ply --json").json()["same"] == true);
  const Ran unnamed = run(folder, "refine ball.homolog");
  REQUIRE_MESSAGE(unnamed.status == 0, unnamed.errors);
  CHECK(unnamed.errors.find("has s1, other, of which the first is taken; name another one with --structure") !=
        std::string::npos);
  CHECK(mesh_of("s1") != first);
  check_refused(run(folder, "refine ball.homolog --structure third"), "has no structure \"third\"");
  check_refused(run(folder, "snap ball.homolog --structure third"), "has no structure \"third\"");
  CHECK(run(folder, "snap now.ply --image x.nii --structure other -o y.ply").status == 2);
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
  REQUIRE(write_mesh(icosphere(2, 20), folder.path / "coarse.ply"));
  const std::string table = read_whole_file(folder.path / "out" / "volumes.csv").value();
  check_refused(run(folder, "propagate coarse.ply --image cine.nii.gz --frame 0 -o out"), "out/cine.study.json");
  CHECK(read_whole_file(folder.path / "out" / "volumes.csv").value() == table);
  const Ran other = run(folder, "propagate out/frame-01.ply --image cine.nii.gz --frame 0 -o other");
  CHECK(other.errors.find("notes that it is of frame 1, and was carried from frame 0") != std::string::npos);
}

TEST_CASE("a case without an image is not snapped and says why") {
  const TemporaryFolder folder;
  REQUIRE(write_mesh(icosphere(2, 20), folder.path / "t.ply"));
  const std::string header = R"({"homolog":1,"template":"t.ply"})";
  REQUIRE(write_whole_file(folder.path / "bare.homolog", header + "\n"));
  check_refused(run(folder, "snap bare.homolog"), "bare.homolog");
}

TEST_CASE("a study of a propagated cine names the built-in template that it started from") {
  const TemporaryFolder folder;
  REQUIRE(write_volume(ball_image(2), folder.path / "cine.nii.gz"));
  REQUIRE(run(folder, "propagate built-in:kidney --image cine.nii.gz --frame 0 -o out").status == 0);
  const auto study = Json::parse(read_whole_file(folder.path / "out" / "cine.study.json").value());
  CHECK(study["template"] == "built-in:kidney");
}

namespace {

/// The bytes of every file below a folder, by name.
std::map<std::string, std::string> files_below(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      files[fs::relative(entry.path(), folder).string()] = read_whole_file(entry.path()).value();
  return files;
}

}  // namespace

TEST_CASE("every verb that works in parallel writes the same bytes whatever the number of threads") {
  const TemporaryFolder folder;
  REQUIRE(write_mesh(icosphere(3, 23), folder.path / "large.ply"));
  REQUIRE(write_volume(ball_image(3), folder.path / "cine.nii.gz"));
  for (const char* subject : {"1", "2"})
    REQUIRE(run(folder, std::string("phantom kidney -o kidneys --subject ") + subject).status == 0);
  const std::string masks = "kidneys/kidney-1-labels.nii.gz kidneys/kidney-2-labels.nii.gz";
  const std::vector<std::string> commands = {
      "fit built-in:kidney --mask " + masks + " -o OUT",
      "fit large.ply --image cine.nii.gz --placement near.json -o OUT/fitted.ply",
      "snap large.ply --image cine.nii.gz -o OUT/snapped.ply",
      "propagate large.ply --image cine.nii.gz --frame 0 -o OUT",
      "study schemes built-in:ventricle --phantoms 1,2 --schemes anchored,fit --pulls 1 -o OUT --cases",
  };
  std::ofstream(folder.path / "near.json") << R"({"rotation":[1,0,0,0],"scale":1,"translation":[1,0,0]})";
  for (std::string command : commands) {
    CAPTURE(command);
    std::vector<std::map<std::string, std::string>> written;
    for (const std::string threads : {"1", "3"}) {
      const std::string out = "out";  // the same name each time: files may hold it
      fs::remove_all(folder.path / out);
      fs::create_directory(folder.path / out);
      std::string named = command;
      named.replace(named.find("OUT"), 3, out);
      const Ran ran =
          threads == "1" ? run(folder, named, "HOMOLOG_THREADS=1 ") : run(folder, named + " --jobs " + threads);
      INFO(ran.errors);
      REQUIRE(ran.status == 0);
      written.push_back(files_below(folder.path / out));
    }
    CHECK(!written[0].empty());
    CHECK(written[0] == written[1]);
  }
}

TEST_CASE("a number of threads that is none is a usage error") {
  const TemporaryFolder folder;
  REQUIRE(write_mesh(icosphere(2, 20), folder.path / "ball.ply"));
  for (const char* jobs : {"0", "-1", "nan", "1.5", "x", "1025"})
    CHECK(run(folder, std::string("info ball.ply --jobs ") + jobs).status == 2);
  for (const char* threads : {"0", "-1", "x", "2x", "\"\""}) {
    const Ran ran = run(folder, "info ball.ply", std::string("HOMOLOG_THREADS=") + threads + " ");
    CHECK(ran.status == 2);
    CHECK(ran.errors.find("HOMOLOG_THREADS") != std::string::npos);
  }
  CHECK(run(folder, "info ball.ply", "HOMOLOG_THREADS=3 ").status == 0);
}

}  // namespace homolog
