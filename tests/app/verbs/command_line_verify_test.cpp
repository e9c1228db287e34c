// The command-line contract of docs/verify.md: records in what verbs write, and `verify`.
#include "core/base/pictures/picture_io.h"
#include "core/mesh/mesh_io.h"
#include "tests/verify_folder.h"

namespace homolog {

namespace {

/// The first vertex of a binary PLY goes by so much along x.
void move_first_vertex(const fs::path& file, double mm) {
  std::string bytes = read_whole_file(file).value();
  const std::size_t at = bytes.find("end_header\n") + 11;
  double x = 0;
  std::memcpy(&x, bytes.data() + at, sizeof x);
  x += mm;
  std::memcpy(bytes.data() + at, &x, sizeof x);
  write_bytes(file, bytes);
}

}  // namespace

TEST_CASE("a fit is verified by what its inputs hold wherever they lie and whatever they are called") {
  const VerifyFolder folder;
  REQUIRE(run(folder, "fit data/ball.ply --mask data/long.nii.gz -o a.ply").status == 0);
  const Json report = verified(folder, "a.ply");
  CHECK(report["same"] == true);
  CHECK(report["command"] == "fit");
  CHECK(report["inputs"].size() == 2);
  CHECK(report["inputs"][1]["name"] == "long.nii.gz");
  CHECK(folder.bytes("a.ply").find(folder.path.string()) == std::string::npos);
  CHECK(folder.bytes("a.ply").find("data/") == std::string::npos);

  fs::create_directories(folder.path / "data/deep/er");
  fs::rename(folder.path / "data/long.nii.gz", folder.path / "data/deep/er/patient 1.nii.gz");
  CHECK(verified(folder, "a.ply --inputs data")["same"] == true);

  write_bytes(folder.path / "data/deep/er/patient 1.nii.gz", folder.bytes("data/round.nii.gz"));
  const Ran changed = run(folder, "verify a.ply --inputs data");
  check_refused(changed, "a.ply");
  CHECK(changed.errors.find("made of long.nii.gz, which") != std::string::npos);
}

TEST_CASE("a mesh that was changed by hand is not the same and the report says by how much") {
  const VerifyFolder folder;
  REQUIRE(run(folder, "fit data/ball.ply --mask data/long.nii.gz -o a.ply").status == 0);
  move_first_vertex(folder.path / "a.ply", 2);
  CHECK(differs(folder, "a.ply")["largest_mm"].get<double>() == doctest::Approx(2));
  // A text in it alone.
  REQUIRE(run(folder, "convert data/ball.ply b.obj").status == 0);
  write_bytes(folder.path / "b.obj", folder.bytes("b.obj") + "# a remark\n");
  CHECK(differs(folder, "b.obj")["largest_mm"] == 0);
}

TEST_CASE("a case of a cohort has the bytes that it has alone and on any number of threads") {
  const VerifyFolder folder;
  REQUIRE(run(folder, "fit data/ball.ply --mask data/long.nii.gz -o alone.ply --json").status == 0);
  REQUIRE(run(folder, "fit data/ball.ply --mask data -o one --jobs 1 --quiet").status == 0);
  REQUIRE(run(folder, "fit data/ball.ply --mask data/round.nii.gz data/long.nii.gz -o four --jobs 4").status == 0);
  CHECK(folder.bytes("one/long.ply") == folder.bytes("alone.ply"));
  CHECK(folder.bytes("four/long.ply") == folder.bytes("alone.ply"));
  CHECK(folder.bytes("four/round.ply") == folder.bytes("one/round.ply"));
  CHECK(verified(folder, "one/long.ply --inputs data")["same"] == true);
}

TEST_CASE("models are verified in both formats and name all their shapes") {
  const VerifyFolder folder;
  fs::create_directory(folder.path / "shapes");
  for (const int k : {1, 2, 3}) {
    Mesh shape = icosphere(2, 20);
    shape.points.col(2) *= 1 + 0.1 * k;
    shape.points.col(1) *= 1 + 0.05 * k * k;
    REQUIRE(write_mesh(shape, folder.path / "shapes" / (std::to_string(k) + ".ply")));
  }
  for (const std::string name : {"m.h5", "m.h5.json"}) {
    CAPTURE(name);
    REQUIRE(run(folder, "model shapes -o " + name).status == 0);
    CHECK(verified(folder, name)["inputs"].size() == 3);
    CHECK(folder.bytes(name).find(folder.path.string()) == std::string::npos);
  }
  REQUIRE(run(folder, "model shapes/1.ply shapes/2.ply shapes/3.ply -o shapes/other.h5.json --csv tables").status == 0);
  CHECK(folder.bytes("shapes/other.h5.json") == folder.bytes("m.h5.json"));
  // A shape's mean by a model.
  REQUIRE(run(folder, "convert m.h5 mean.vtk").status == 0);
  CHECK(verified(folder, "mean.vtk")["same"] == true);
  fs::remove(folder.path / "shapes/2.ply");
  check_refused(run(folder, "verify m.h5"), "made of 2.ply, which");
}

TEST_CASE("tables pages and pictures are verified and what was changed in them is named") {
  const VerifyFolder folder;
  fs::create_directory(folder.path / "shapes");
  std::string covariates = "name,age\n";
  for (const int k : {1, 2, 3, 4, 5}) {
    Mesh shape = icosphere(2, 20);
    shape.points.col(2) *= 1 + 0.1 * k;
    shape.points.col(1) *= 1 + 0.02 * k * k;
    REQUIRE(write_mesh(shape, folder.path / "shapes" / (std::to_string(k) + ".ply")));
    covariates += std::to_string(k) + ',' + std::to_string(40 + 7 * k % 5) + '\n';
  }
  write_bytes(folder.path / "data/ages.csv", covariates);
  // A recipe that ships is no file; one beside a template is read with it.
  REQUIRE(write_mesh(icosphere(2, 20), folder.path / "data/ball.ply"));
  write_bytes(folder.path / "data/ball.recipe.json",
              R"({"homolog_recipe": 1, "measurements": [{"name": "content", "kind": "volume"}]})");
  REQUIRE(run(folder, "model shapes -o m.h5").status == 0);
  const std::vector<std::pair<std::string, std::string>> made{
      {"score shapes/1.ply shapes/2.ply --model m.h5 -o ", "scores/scores.csv"},
      {"score shapes/1.ply shapes/2.ply --model m.h5 -o ", "scores/2.vtp"},
      {"test shapes --covariates data/ages.csv --formula 'shape ~ age' --csv ", "tests/landmarks.csv"},
      {"evaluate shapes --samples 10 --csv ", "e.csv"},
      {"measure shapes -o ", "s.csv"},
      {"measure shapes --recipe ventricle -o ", "v.csv"},
      {"measure shapes --template data/ball.ply -o ", "b.csv"},
      {"landmarks shapes --vertices -o ", "l.tps"},
      {"observers shapes shapes --csv ", "o.csv"},
      {"picture plot m.h5 -o ", "p.svg"},
      {"picture plot m.h5 -o ", "p.pdf"},
      {"picture plot m.h5 -o ", "p.png"},
      {"report m.h5 -o ", "r.html"},
      {"report m.h5 --template data/ball.ply -o ", "t.html"},
  };
  for (const auto& [command, file] : made) {
    CAPTURE(file);
    const std::string folder_of = fs::path(file).parent_path().string();
    const Ran ran = run(folder, command + (folder_of.empty() ? file : folder_of));
    REQUIRE_MESSAGE(ran.status == 0, ran.errors);
    CHECK(verified(folder, file + " --inputs .")["same"] == true);
    CHECK(folder.bytes(file).find(folder.path.string()) == std::string::npos);
    const fs::path beside = folder.path / (file + ".made.json");
    const std::string ending = fs::path(file).extension();
    CHECK(fs::exists(beside) == (ending == ".csv" || ending == ".tps" || ending == ".pdf"));
    if (ending == ".png") REQUIRE(read_picture(folder.path / file));
    if (ending == ".vtp") continue;
    const std::string bytes = folder.bytes(file);
    write_bytes(folder.path / file, bytes + "1");
    const Ran changed = run(folder, "verify " + file + " --inputs .");
    CHECK(changed.status == 1);
    CHECK(changed.errors.find(ending == ".png" || ending == ".pdf" ? "its bytes are others" : " is another") !=
          std::string::npos);
  }
  // The recipe is an input, so a table by another one is not what was verified.
  CHECK(Json::parse(folder.bytes("b.csv.made.json"))["homolog.record"]["options"]["--recipe"][0]["file"] ==
        "ball.recipe.json");
  // Names of cases may be those of patients.
  REQUIRE(run(folder, "report shapes --samples 10 --without-names -o n.html").status == 0);
  CHECK(folder.bytes("n.html").find("1.ply") == std::string::npos);
}

TEST_CASE("a score says how it was made as it would alone") {
  const VerifyFolder folder;
  fs::create_directory(folder.path / "shapes");
  for (const int k : {1, 2, 3, 4}) {
    Mesh shape = icosphere(2, 20);
    shape.points.col(2) *= 1 + 0.1 * k * k;
    REQUIRE(write_mesh(shape, folder.path / "shapes" / (std::to_string(k) + ".ply")));
  }
  REQUIRE(run(folder, "model shapes -o m.h5").status == 0);
  REQUIRE(run(folder, "score shapes/3.ply --model m.h5 -o alone").status == 0);
  REQUIRE(run(folder, "score shapes/1.ply shapes/2.ply shapes/3.ply --model m.h5 -o all").status == 0);
  CHECK(folder.bytes("alone/3.vtp") == folder.bytes("all/3.vtp"));
}

TEST_CASE("every format carries its record and what is made of it carries its own alone") {
  const VerifyFolder folder;
  for (const std::string name : {"m.ply", "m.obj", "m.vtk", "m.vtp", "m.stl", "m.particles"}) {
    CAPTURE(name);
    REQUIRE(run(folder, "convert data/ball.ply " + name).status == 0);
    CHECK(verified(folder, name)["command"] == "convert");
    CHECK(fs::exists(folder.path / (name + ".made.json")) == (name == "m.stl" || name == "m.particles"));
  }
  for (const std::string name : {"l.nrrd", "l.nii.gz", "l.mha"}) {
    CAPTURE(name);
    REQUIRE(run(folder, "label-map m.ply --like data/long.nii.gz -o " + name).status == 0);
    CHECK(verified(folder, name)["inputs"].size() == 2);
    REQUIRE(run(folder, "info " + name).status == 0);
    CHECK(fs::exists(folder.path / (name + ".made.json")) == (name != "l.nrrd"));
  }
  // A mesh that was read keeps nothing of its record: mirroring says mirror, twice as once.
  REQUIRE(run(folder, "mirror m.ply -o u.ply").status == 0);
  CHECK(verified(folder, "u.ply")["command"] == "mirror");
  CHECK(folder.bytes("u.ply").find("convert") == std::string::npos);
  // What replaces a file takes its record away where it has none itself.
  REQUIRE(write_mesh(folder.ball, folder.path / "m.stl"));
  CHECK_FALSE(fs::exists(folder.path / "m.stl.made.json"));
  check_refused(run(folder, "verify m.stl"), "m.stl: carries no record");
}

TEST_CASE("a label map that was changed says how many voxels differ") {
  const VerifyFolder folder;
  REQUIRE(run(folder, "label-map data/ball.ply --like data/long.nii.gz -o l.nii").status == 0);
  std::string bytes = folder.bytes("l.nii");
  for (const std::size_t back : {1, 2, 3}) bytes[bytes.size() - back] = 1;
  write_bytes(folder.path / "l.nii", bytes);
  const Json report = differs(folder, "l.nii");
  CHECK(report["different_voxels"] == 3);
  CHECK(report["largest_mm"].is_null());
}

TEST_CASE("labels that are chosen by name are verified with the file that names them") {
  const VerifyFolder folder;
  write_bytes(folder.path / "data/long.json", R"({"labels":[{"value":1,"name":"pear"}]})");
  REQUIRE(run(folder, "template data/long.nii.gz --label pear --vertices 300 -o t.ply").status == 0);
  CHECK(verified(folder, "t.ply")["inputs"].size() == 2);
  fs::remove(folder.path / "data/long.json");
  check_refused(run(folder, "verify t.ply"), "made of long.json, which");
}

TEST_CASE("each file of a fitted set is verified") {
  const VerifyFolder folder;
  fit_set_of_ball(folder);
  CHECK(verified(folder, "sets/long/A.ply --inputs data")["inputs"].size() == 3);
  CHECK(verified(folder, "sets/long.seg.nrrd --inputs data")["same"] == true);
}

TEST_CASE("a template set and a mended map are verified and a set that goes on has no old record") {
  const VerifyFolder folder;
  REQUIRE(run(folder, "set make data/long.nii.gz --all --vertices 300 -o pear.set.json").status == 0);
  CHECK(verified(folder, "pear.set.json")["command"] == "set make");
  REQUIRE(run(folder, "repair data/round.nii.gz data/long.nii.gz --templates pear.set.json -o mended").status == 0);
  CHECK(verified(folder, "mended/long.nii.gz --inputs .")["inputs"].size() == 3);
  const std::string name = Json::parse(folder.bytes("pear.set.json"))["structures"][0]["name"];
  // Its templates too; what is changed and written elsewhere names what it was made of.
  const fs::path the_template = Json::parse(folder.bytes("pear.set.json"))["structures"][0]["template"];
  CHECK(verified(folder, "'" + the_template.string() + "' --inputs .")["command"] == "set make");
  // A template that was changed is named, though the set itself has the same bytes.
  const std::string before = folder.bytes(the_template);
  MeshFile moved = read_mesh_file(folder.path / the_template).value();
  moved.points(0, 0) += 1;
  REQUIRE(write_mesh_file(moved, folder.path / the_template));
  const Ran changed = run(folder, "verify pear.set.json");
  CHECK(changed.status == 1);
  CHECK(changed.errors.find(the_template.filename().string() + ", which it names, is another") != std::string::npos);
  write_bytes(folder.path / the_template, before);
  REQUIRE(run(folder, "set rename pear.set.json \"" + name + "\" core -o sets/core.set.json").status != 0);
  fs::create_directory(folder.path / "sets");
  REQUIRE(run(folder, "set rename pear.set.json \"" + name + "\" core -o sets/core.set.json").status == 0);
  CHECK(verified(folder, "sets/core.set.json --inputs .")["command"] == "set rename");
  std::string other = folder.bytes("sets/core.set.json");
  write_bytes(folder.path / "sets/core.set.json", other.replace(other.find("core"), 4, "pith"));
  CHECK(differs(folder, "sets/core.set.json --inputs .")["command"] == "set rename");
  REQUIRE(run(folder, "set rename pear.set.json \"" + name + "\" core").status == 0);
  check_refused(run(folder, "verify pear.set.json"), "carries no record");
}

TEST_CASE("edits by hand are verified by playing their case which may have gone on since") {
  const VerifyFolder folder;
  fs::create_directory(folder.path / "cases");
  write_bytes(folder.path / "cases/c.homolog",
              R"({"homolog":1,"volume":"../data/long.nii.gz","template":"../data/ball.ply",)"
              R"("placement":{"rotation":[1,0,0,0],"scale":1,"translation":[0,0,0]}})"
              "\n"
              R"({"tool":"pull","at":[0,0,20],"to":[0,0,24],"sigma_mm":8})"
              "\n");
  REQUIRE(run(folder, "replay cases/c.homolog -o edited.ply").status == 0);
  const Json report = verified(folder, "edited.ply");
  CHECK(report["command"] == "replay");
  CHECK(report["inputs"].size() == 3);
  write_bytes(folder.path / "cases/c.homolog", folder.bytes("cases/c.homolog") +
                                                   R"({"tool":"pull","at":[0,20,0],"to":[0,23,0],"sigma_mm":8})"
                                                   "\n");
  CHECK(verified(folder, "edited.ply")["same"] == true);
  // The case of the mesh must stay as it is.
  CHECK(lines(folder.bytes("cases/c.homolog")) == 3);
  check_refused(run(folder, "verify cases/c.homolog"), "is a case");
}

TEST_CASE("a record can write nowhere and read nothing but what it names by its content") {
  const VerifyFolder folder;
  REQUIRE(run(folder, "convert data/ball.ply m.stl").status == 0);
  const fs::path record = folder.path / "m.stl.made.json";
  const Json good = Json::parse(read_whole_file(record).value());
  const auto refuses = [&](const Json& changed, const std::string& because) {
    write_bytes(record, changed.dump());
    check_refused(run(folder, "verify m.stl"), because);
  };
  Json bad = good;
  bad["homolog.record"]["options"]["OUT"] = {"elsewhere.ply"};
  refuses(bad, "damaged record");
  CHECK_FALSE(fs::exists(folder.path / "elsewhere.ply"));
  bad = good;
  bad["homolog.record"]["options"]["IN"][0]["file"] = "../../ball.ply";
  refuses(bad, "damaged record");
  bad = good;
  bad["homolog.record"]["command"] = "sample";
  refuses(bad, "m.stl: was made by \"sample\"");
  bad = good;
  bad["homolog.record"]["options"]["--csv"] = {"x"};
  refuses(bad, "cannot be done again");
  bad = good;
  bad["homolog.record"]["options"]["--times=2"] = true;
  refuses(bad, "damaged record");
  bad = good;
  bad["homolog.record"]["options"]["IN"][0] = (folder.path / "data/ball.ply").string();
  refuses(bad, "damaged record");
  bad = good;
  bad["homolog.record"]["options"]["--times"] = {"1", "--from-ras"};
  refuses(bad, "damaged record");
  bad = good;
  bad["homolog.record"]["output"] = "../out.ply";
  refuses(bad, "damaged record");
  bad["homolog.record"]["output"] = "*.ply";
  bad["homolog.record"]["beside"] = "/../../out.ply";
  refuses(bad, "damaged record");
}

TEST_CASE("another version is named and the same points are the same") {
  const VerifyFolder folder;
  REQUIRE(run(folder, "mirror data/ball.ply -o m.ply").status == 0);
  std::string bytes = folder.bytes("m.ply");
  const std::string version = R"({"version":")";
  bytes[bytes.find(version) + version.size()] = '9';
  write_bytes(folder.path / "m.ply", bytes);
  const Json report = verified(folder, "m.ply");
  CHECK(report["same"] == true);
  CHECK(report["made_by"].get<std::string>().starts_with("9"));
  CHECK(report["made_by"] != report["verified_by"]);
  move_first_vertex(folder.path / "m.ply", 1);
  const Ran ran = run(folder, "verify m.ply");
  CHECK(ran.status == 1);
  CHECK(ran.errors.find("up to 1 mm; it was made by version 9") != std::string::npos);
}

}  // namespace homolog
