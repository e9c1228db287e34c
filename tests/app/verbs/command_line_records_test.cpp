// The command-line contract of docs/verify.md: records of cases, studies, templates of a set and frames of a mode.
#include "core/base/pictures/picture_io.h"
#include "core/mesh/mesh_io.h"
#include "tests/verify_folder.h"

namespace homolog {

TEST_CASE("a template that a set gets later carries a record and so does the set that is written elsewhere") {
  const VerifyFolder folder;

  Mesh small = icosphere(3, 8);
  small.points.col(0).array() += 2;
  Volume both = label_map(folder.ball, folder.grid);
  const Volume within = label_map(small, folder.grid);
  auto& labels = std::get<std::vector<std::uint8_t>>(both.data);
  for (std::size_t v = 0; v < labels.size(); ++v)
    if (std::get<std::vector<std::uint8_t>>(within.data)[v] != 0) labels[v] = 2;
  REQUIRE(write_volume(both, folder.path / "data/both.nii.gz"));
  REQUIRE(run(folder, "set make data/both.nii.gz --labels 1 --vertices 300 -o one.set.json").status == 0);
  const Ran added = run(folder, "set add one.set.json data/both.nii.gz --labels 2 --vertices 200 -o two.set.json");
  REQUIRE_MESSAGE(added.status == 0, added.errors);
  const Json structures = Json::parse(folder.bytes("two.set.json"))["structures"];
  REQUIRE(structures.size() == 2);
  CHECK(verified(folder, "'" + structures[1]["template"].get<std::string>() + "' --inputs .")["command"] == "set add");
  CHECK(verified(folder, "two.set.json")["command"] == "set add");
  // Under another name it has the same bytes.
  REQUIRE(run(folder, "set make data/both.nii.gz --labels 1 --vertices 300 -o other.set.json").status == 0);
  const fs::path first = structures[0]["template"].get<std::string>();
  CHECK(folder.bytes(first) == folder.bytes(fs::path("other") / first.filename()));
  // In place the set that it was made of is gone.
  REQUIRE(run(folder, "set add one.set.json data/both.nii.gz --labels 2 --vertices 200").status == 0);
  check_refused(run(folder, "verify one.set.json"), "carries no record");
}

TEST_CASE("cases and the study of a cohort are made anew wherever they lie and a case has the same bytes alone") {
  const VerifyFolder folder;
  REQUIRE(run(folder, "fit data/ball.ply --mask data/long.nii.gz data/round.nii.gz -o all --jobs 4").status == 0);
  REQUIRE(run(folder, "fit data/ball.ply --mask data/long.nii.gz -o one --jobs 1").status == 0);
  CHECK(folder.bytes("one/long.homolog") == folder.bytes("all/long.homolog"));
  CHECK(folder.bytes("all/long.homolog").find(folder.path.string()) == std::string::npos);
  const Json report = verified(folder, "all/long.homolog --inputs data");
  CHECK(report["same"] == true);
  CHECK(report["lines_since"] == 0);
  CHECK(report["inputs"].size() == 2);
  CHECK(verified(folder, "all/all.study.json --inputs data")["inputs"].size() == 3);

  // It goes on: what a hand does is behind what the fit gave.
  REQUIRE(run(folder, "refine all/long.homolog").status == 0);
  CHECK(verified(folder, "all/long.homolog --inputs data")["lines_since"].get<int>() > 0);
  CHECK(verified(folder, "all/all.study.json --inputs data")["same"] == true);
  // What the fit gave was changed since.
  std::string bytes = folder.bytes("one/long.homolog");
  const std::size_t at = bytes.find("\"mean_mm\":") + 10;
  bytes[at] = bytes[at] == '1' ? '2' : '1';
  write_bytes(folder.path / "one/long.homolog", bytes);
  const Ran changed = run(folder, "verify one/long.homolog --inputs data");
  CHECK(changed.status == 1);
  CHECK(changed.errors.find("of those that it began with is another") != std::string::npos);
}

TEST_CASE("a case keeps its record when it is saved elsewhere and a study loses its own when it is changed") {
  const VerifyFolder folder;
  REQUIRE(run(folder, "fit data/ball.ply --mask data/long.nii.gz -o all").status == 0);
  const std::string record = folder.bytes("all/long.homolog").substr(0, folder.bytes("all/long.homolog").find('\n'));
  CHECK(Json::parse(record)["homolog"] == 1);
  CHECK(Json::parse(record)["homolog.record"]["command"] == "fit");
  // Of another image, on the same grid.
  fs::copy(folder.path / "data/round.nii.gz", folder.path / "data/other.nii.gz");
  std::string other = folder.bytes("all/long.homolog");
  const std::size_t at = other.find("../data/long.nii.gz");
  write_bytes(folder.path / "all/other.homolog", other.replace(at, 19, "../data/other.nii.gz"));
  const Ran changed = run(folder, "verify all/other.homolog --inputs data");
  CHECK(changed.status == 1);
  CHECK(changed.errors.find("other.nii.gz, which it names, is another") != std::string::npos);

  // A second command puts its case beside the first.
  CHECK(folder.bytes("all/all.study.json").find("homolog.record") != std::string::npos);
  REQUIRE(run(folder, "fit data/ball.ply --mask data/long.nii.gz -o all").status == 0);
  CHECK(folder.bytes("all/all.study.json").find("homolog.record") != std::string::npos);
  REQUIRE(run(folder, "fit data/ball.ply --mask data/round.nii.gz -o all").status == 0);
  CHECK(folder.bytes("all/all.study.json").find("homolog.record") == std::string::npos);
  check_refused(run(folder, "verify all/all.study.json --inputs data"), "carries no record");
}

TEST_CASE("the cases and the study of a fitted set and of a worklist are verified") {
  const VerifyFolder folder;
  fit_set_of_ball(folder);
  CHECK(verified(folder, "sets/long.homolog --inputs data")["inputs"].size() == 3);
  CHECK(verified(folder, "sets/sets.study.json --inputs data")["same"] == true);
  // A map with a speck in a corner is one to look at.
  Volume broken = label_map(folder.ball, folder.grid);
  auto& labels = std::get<std::vector<std::uint8_t>>(broken.data);
  for (const std::size_t first : {31, 61, 91, 931, 961, 991})
    for (std::size_t x = 0; x < 4; ++x) labels[first + x] = 1;
  REQUIRE(write_volume(broken, folder.path / "data/broken.nii.gz"));
  const Ran ran = run(folder, "repair data/broken.nii.gz --templates data/ball.set.json -o worklist --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  REQUIRE(ran.json().contains("study"));
  CHECK(verified(folder, "worklist/worklist.study.json --inputs data")["same"] == true);
  CHECK(verified(folder, "worklist/broken-cases/broken-A.homolog --inputs data")["command"] == "repair");
}

TEST_CASE("a study that was made of a table or of label maps is verified with its cases each as it is made alone") {
  const VerifyFolder folder;
  REQUIRE(write_mesh(folder.ball, folder.path / "data/fitted.ply"));
  write_bytes(folder.path / "data/t.csv",
              "name,labels,file,age\nfirst,long.nii.gz,,40\nsecond,round.nii.gz,fitted.ply,50\n");
  REQUIRE(run(folder, "study make data/t.csv --template data/ball.ply -o s.study.json --jobs 3").status == 0);
  CHECK(verified(folder, "s.study.json --inputs data")["inputs"].size() == 5);
  const Json first = verified(folder, "s-cases/first.homolog --inputs data");
  CHECK(first["inputs"].size() == 3);
  CHECK(first["command"] == "study make");
  CHECK(verified(folder, "s-cases/second.homolog --inputs data")["inputs"].size() == 4);
  const std::string second = folder.bytes("s-cases/second.homolog");
  fs::remove_all(folder.path / "s-cases");
  fs::remove(folder.path / "s.study.json");
  REQUIRE(run(folder, "study make data/t.csv --template data/ball.ply -o s.study.json --case second").status == 0);
  CHECK(folder.bytes("s-cases/second.homolog") == second);
  CHECK_FALSE(fs::exists(folder.path / "s-cases/first.homolog"));
  check_refused(run(folder, "study make data/t.csv --template data/ball.ply -o s.study.json --case third"), "third");

  REQUIRE(run(folder, "study make data --template data/ball.ply -o maps.study.json").status == 0);
  CHECK(verified(folder, "maps.study.json")["same"] == true);
  CHECK(verified(folder, "maps-cases/long.homolog --inputs data")["inputs"].size() == 2);
  const std::string of_folder = folder.bytes("maps-cases/long.homolog");
  fs::remove_all(folder.path / "maps-cases");
  fs::remove(folder.path / "maps.study.json");
  REQUIRE(run(folder, "study make data/long.nii.gz --template data/ball.ply -o maps.study.json").status == 0);
  CHECK(folder.bytes("maps-cases/long.homolog") == of_folder);
}

TEST_CASE("a cine's case and study and the frames of a mode are verified") {
  const VerifyFolder folder;
  REQUIRE(run(folder, "phantom ventricle --subject 1 -o cine").status == 0);
  REQUIRE(run(folder, "propagate cine/ventricle-1-truth-00.ply --image cine/ventricle-1-image.nii.gz --frame 0 -o out")
              .status == 0);
  CHECK(verified(folder, "out/cine.homolog --inputs cine")["inputs"].size() == 2);
  CHECK(verified(folder, "out/cine.study.json --inputs cine")["same"] == true);

  fs::create_directory(folder.path / "shapes");
  for (const int k : {1, 2, 3}) {
    Mesh shape = icosphere(2, 20);
    shape.points.col(2) *= 1 + 0.1 * k;
    REQUIRE(write_mesh(shape, folder.path / "shapes" / (std::to_string(k) + ".ply")));
  }
  REQUIRE(run(folder, "model shapes -o m.h5").status == 0);
  const Ran drawn = run(folder, "picture modes m.h5 --mode 1 --frames 3 -o mode.png");
  if (cannot_draw(drawn)) return;
  REQUIRE(drawn.status == 0);
  CHECK(verified(folder, "mode-0002.png")["command"] == "picture modes");
  CHECK(read_picture(folder.path / "mode-0002.png"));
}

}  // namespace homolog
