// The command-line contract of docs/commands.md: measure --recipe.
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/phantom/phantom.h"
#include "tests/command_line.h"
#include "tests/joint_cases.h"

namespace homolog {

namespace {

void put_recipe(const TemporaryFolder& folder, const std::string& name, const std::string& text) {
  REQUIRE(write_whole_file(folder.path / name, text));
}

/// Balls that differ in their size alone, with a landmark at each pole but where it is left out.
void put_marked_balls(const TemporaryFolder& folder) {
  for (int k = 0; k < 4; ++k) {
    const double radius_mm = 20 + 2 * k;
    const Mesh ball = icosphere(3, radius_mm);
    MeshFile file;
    file.points = ball.points;
    file.triangles = ball.topology->triangles();
    file.landmarks = {{"north", Vec3(0, 0, radius_mm)}};
    if (k != 2) file.landmarks.push_back({"south", Vec3(0, 0, -radius_mm)});
    REQUIRE(write_mesh_file(file, folder.path / ("b" + std::to_string(k) + ".ply")));
  }
  put_recipe(folder, "r.json", R"({"homolog_recipe": 1, "name": "Ball", "measurements": [
    {"name": "length", "kind": "distance", "from": {"kind": "landmark", "landmark": "north"},
     "to": {"kind": "landmark", "landmark": "south"}},
    {"name": "radius", "kind": "radius", "of": {"kind": "sphere", "of": {"kind": "whole"}}}]})");
}

}  // namespace

TEST_CASE("a recipe gives a value a shape and what a shape lacks is null with one warning") {
  const TemporaryFolder folder;
  put_marked_balls(folder);
  const Ran ran = run(folder, "measure b0.ply b1.ply b2.ply b3.ply --recipe r.json -o t.csv --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  const Json report = ran.json();
  CHECK(report["recipe"] == "Ball");
  CHECK(report["measurements"][0]["unit"] == "mm");
  CHECK(report["measurements"][0]["count"] == 3);
  CHECK(report["cases"][1]["name"] == "b1");
  CHECK(report["cases"][1]["values"]["length"].get<double>() == doctest::Approx(44));
  CHECK(report["cases"][2]["values"]["length"].is_null());
  CHECK(report["cases"][2]["values"]["radius"].get<double>() == doctest::Approx(24));
  CHECK_FALSE(report.contains("modes"));
  CHECK(lines(ran.errors) == 1);
  CHECK(ran.errors.find("b2: has no landmark \"south\" (the nearest name is \"north\"), so length is left empty") !=
        std::string::npos);
  const std::string table = read_whole_file(folder.path / "t.csv").value();
  CHECK(table.starts_with("name,length mm,radius mm\nb0,40,20\n"));
  CHECK(table.find("\nb2,,24\n") != std::string::npos);
  CHECK(run(folder, "measure b2.ply --recipe r.json --template b0.ply --json").json()["cases"][0]["values"]["length"] ==
        48);
  REQUIRE(write_mesh(icosphere(1, 20), folder.path / "coarse.ply"));
  CHECK(run(folder, "measure b2.ply --recipe r.json --template coarse.ply")
            .errors.find("coarse.ply: has other vertices") != std::string::npos);
}

TEST_CASE("a recipe is measured along the modes of a model with the landmarks of the first shape") {
  const TemporaryFolder folder;
  put_marked_balls(folder);
  REQUIRE(run(folder, "model b0.ply b1.ply b2.ply b3.ply --keep-scale -o m.h5").status == 0);
  const Ran ran = run(folder, "measure b0.ply --recipe r.json --model m.h5 --modes 1 --csv t.csv --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  const Json modes = ran.json()["modes"];
  REQUIRE(modes.size() == 5);
  const auto length = [&](std::size_t k) { return modes[k]["values"]["length"].get<double>(); };
  CHECK(modes[0]["sd"] == -2);
  CHECK(modes[2]["sd"] == 0);
  CHECK(length(2) == doctest::Approx(46).epsilon(1e-5));
  // Radii 20, 22, 24 and 26 mm have the standard deviation 2.58 mm.
  CHECK(std::abs(length(3) - length(2)) == doctest::Approx(2 * std::sqrt(20.0 / 3)).epsilon(1e-4));
  CHECK(length(4) - length(2) == doctest::Approx(length(2) - length(0)).epsilon(1e-5));
  CHECK(lines(read_whole_file(folder.path / "t.csv").value()) == 7);
}

TEST_CASE("the structures of a case are measured together") {
  const TemporaryFolder folder;
  for (const int k : {0, 1}) {
    const fs::path there = folder.path / "fits" / ("c" + std::to_string(k));
    fs::create_directories(there);
    const JointCase one{2.0 * k, 1, 1, 1};
    REQUIRE(write_mesh(lower_ellipsoid(one), there / "low.ply"));
    REQUIRE(write_mesh(upper_ellipsoid(one), there / "high.ply"));
  }
  put_recipe(folder, "r.json", R"({"homolog_recipe": 1, "measurements": [
    {"name": "gap", "kind": "distance", "from": {"kind": "centroid", "structure": "low"},
     "to": {"kind": "centroid", "structure": "high"}}, {"name": "low volume", "kind": "volume", "structure": "low"}]})");
  const Ran ran = run(folder, "measure fits --recipe r.json --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  REQUIRE(ran.json()["cases"].size() == 2);
  CHECK(ran.json()["cases"][0]["values"]["gap"].get<double>() == doctest::Approx(61).epsilon(1e-4));
  CHECK(ran.json()["cases"][0]["values"]["low volume"].get<double>() > 0);
}

TEST_CASE("a measurement of the first structure is empty where a case lacks it") {
  const TemporaryFolder folder;
  for (const int k : {0, 1}) {
    const fs::path there = folder.path / "fits" / ("c" + std::to_string(k));
    fs::create_directories(there);
    const JointCase one{0, 1, 1, 1};
    if (k == 0) REQUIRE(write_mesh(upper_ellipsoid(one), there / "zygoma.ply"));
    REQUIRE(write_mesh(lower_ellipsoid(one), there / "atlas.ply"));
  }
  put_recipe(folder, "r.json", R"({"homolog_recipe": 1, "measurements": [{"name": "first", "kind": "volume"},
    {"name": "zygoma", "kind": "volume", "structure": "zygoma"},
    {"name": "atlas", "kind": "volume", "structure": "atlas"}]})");
  const Ran ran = run(folder, "measure fits --recipe r.json --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  const Json cases = ran.json()["cases"];
  CHECK(cases[0]["values"]["first"] == cases[0]["values"]["zygoma"]);
  CHECK(cases[1]["values"]["first"].is_null());
  CHECK(cases[1]["values"]["atlas"].get<double>() > 0);
  check_refused(run(folder, "measure fits --recipe r.json --group ill"), "fits");
  check_refused(run(folder, "measure fits --recipe r.json --all-frames"), "--all-frames");
}

TEST_CASE("the first shape lends its landmarks to the shapes of the model and to no other case") {
  const TemporaryFolder folder;
  put_marked_balls(folder);
  REQUIRE(run(folder, "model b0.ply b1.ply b2.ply b3.ply --keep-scale -o m.h5").status == 0);
  const Ran ran = run(folder, "measure b0.ply b2.ply --recipe r.json --model m.h5 --modes 1 --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  CHECK(ran.json()["cases"][1]["values"]["length"].is_null());
  CHECK(ran.json()["modes"][2]["values"]["length"].get<double>() == doctest::Approx(46).epsilon(1e-5));
}

TEST_CASE("a built-in template brings its recipe along and a recipe with a fault is refused") {
  const TemporaryFolder folder;
  put_marked_balls(folder);
  REQUIRE(run(folder, "phantom ventricle --subject 1 -o .").status == 0);
  const Ran ran =
      run(folder, "measure ventricle-1-truth-00.ply ventricle-1-truth-07.ply --template built-in:ventricle --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  CHECK(ran.json()["recipe"] == "Left ventricle");
  const Json cases = ran.json()["cases"];
  CHECK(cases[0]["values"]["volume"].get<double>() > 1.5 * cases[1]["values"]["volume"].get<double>());
  check_refused(run(folder, "measure b0.ply --recipe femurr"), "femur is the nearest");
  check_refused(run(folder, "measure b0.ply --template b0.ply"), "has no recipe beside it");
  put_recipe(folder, "bad.json", R"({"homolog_recipe": 1, "measurements": [{"name": "a", "kind": "distanse"}]})");
  check_refused(run(folder, "measure b0.ply --recipe bad.json"), "\"distance\"");
  CHECK(run(folder, "measure b0.ply --model m.h5").status == 2);
  put_recipe(folder, "b0.recipe.json",
             R"({"homolog_recipe": 1, "name": "Kept", "measurements": [{"name": "v", "kind": "volume"}]})");
  CHECK(run(folder, "measure b0.ply --template b0.ply --json").json()["recipe"] == "Kept");
}

TEST_CASE("shapes of one name have landmark files of their own folders") {
  const TemporaryFolder folder;
  put_marked_balls(folder);
  fs::create_directory(folder.path / "lmk");
  const auto put_landmarks = [&](const std::string& file, double south_mm) {
    fs::create_directories((folder.path / file).parent_path());
    REQUIRE(write_whole_file(folder.path / file, R"([{"id": "north", "coordinates": [0, 0, 10]},
      {"id": "south", "coordinates": [0, 0, )" + std::to_string(south_mm) +
                                                     "]}]"));
  };
  for (const char* visit : {"pre", "post"}) {
    fs::create_directory(folder.path / visit);
    fs::copy(folder.path / "b0.ply", folder.path / visit / "P1.ply");
  }
  fs::copy(folder.path / "b1.ply", folder.path / "pre/P2.ply");
  put_landmarks("lmk/P1.json", -5);
  put_landmarks("lmk/P2.json", -6);
  const std::string measure = "measure pre/P1.ply pre/P2.ply post/P1.ply --recipe r.json --landmarks lmk --json";
  check_refused(run(folder, measure),
                "lmk/P1.json: may be of pre/P1.ply or of post/P1.ply; put each shape's landmarks "
                "into a folder of its folder's name");
  put_landmarks("lmk/post/P1.json", -7);
  const Ran ran = run(folder, measure + " -o t.csv");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  const Json cases = ran.json()["cases"];
  const std::vector<std::pair<std::string, double>> lengths{{"pre/P1", 15}, {"P2", 16}, {"post/P1", 17}};
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    CHECK(cases[k]["name"] == lengths[k].first);
    CHECK(cases[k]["values"]["length"].get<double>() == doctest::Approx(lengths[k].second));
  }
  // The table brings each shape its own row.
  const Ran tested = run(folder, "test pre post --covariates t.csv --formula 'size ~ `length mm`' --json");
  REQUIRE_MESSAGE(tested.status == 0, tested.errors);
  CHECK(tested.json()["left_out"].empty());
}

TEST_CASE("an image is measured along the normals") {
  const TemporaryFolder folder;
  REQUIRE(run(folder, "phantom kidney --subject 1 -o .").status == 0);
  put_recipe(folder, "r.json", R"({"homolog_recipe": 1, "measurements": [
    {"name": "inside", "kind": "image_mean", "from_mm": -4, "to_mm": -2},
    {"name": "outside", "kind": "image_mean", "from_mm": 2, "to_mm": 4}]})");
  const Ran ran =
      run(folder, "measure kidney-1-truth.ply --recipe r.json --image kidney-1-image.nii.gz --profiles p --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  const Json values = ran.json()["cases"][0]["values"];
  CHECK(values["inside"].get<double>() > values["outside"].get<double>() + 30);
  const MeshFile profiles = read_mesh_file(folder.path / "p/kidney-1-truth.vtp").value();
  CHECK(profiles.arrays.contains("inside"));
  CHECK(profiles.arrays.contains("inside at -4.00 mm"));

  // Two shapes of one name keep a file each, a folder of images is searched by the files' names, and nothing that was
  // read is written over.
  for (const char* one : {"a", "b", "images"}) fs::create_directory(folder.path / one);
  for (const char* one : {"a", "b"}) fs::copy(folder.path / "kidney-1-truth.ply", folder.path / one / "k.ply");
  fs::copy(folder.path / "kidney-1-image.nii.gz", folder.path / "images/k.nii.gz");
  fs::copy(folder.path / "kidney-1-truth.ply", folder.path / "stray.ply");
  const Ran several =
      run(folder, "measure a/k.ply b/k.ply stray.ply --recipe r.json --image images --profiles both --json");
  REQUIRE_MESSAGE(several.status == 0, several.errors);
  CHECK(several.json()["cases"][1]["values"] == values);
  CHECK(several.json()["cases"][2]["values"]["inside"].is_null());
  CHECK(several.errors.find("stray: has no image in images (stray.nii.gz)") != std::string::npos);
  CHECK(
      several.errors.find("images/k.nii.gz: is sampled for a/k.ply and for b/k.ply; if it is not the image of both") !=
      std::string::npos);
  CHECK(fs::exists(folder.path / "both/k.vtp"));
  CHECK(fs::exists(folder.path / "both/k-2.vtp"));
  check_refused(run(folder, "measure both/k.vtp --recipe r.json --image images --profiles both"), "both/k.vtp");
  CHECK(read_mesh_file(folder.path / "both/k.vtp").value().arrays.contains("inside"));
}

}  // namespace homolog
