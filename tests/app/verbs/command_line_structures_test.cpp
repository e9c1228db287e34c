// The command-line contract of docs/commands.md: models of several structures.
#include "core/case/actions/structures.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/mesh_io.h"
#include "core/session/case_file.h"
#include "tests/command_line.h"
#include "tests/joint_cases.h"

namespace homolog {

namespace {

/// Six cases as `fit SET` writes them; the last has no upper structure where it is said so.
void put_cases(const TemporaryFolder& folder, bool last_lacks_high = false) {
  const std::vector<JointCase> cases{{-6, 0, 1, 0.9}, {2, 2, 1, 1.1},  {4, -1, 1, 1},
                                     {-2, 1, 1, 1.2}, {1, -2, 1, 0.8}, {3, 0, 1, 1.05}};
  for (std::size_t k = 0; k < cases.size(); ++k) {
    const fs::path of_case = folder.path / "fits" / ("c" + std::to_string(k));
    fs::create_directories(of_case);
    REQUIRE(write_mesh(lower_ellipsoid(cases[k]), of_case / "low.ply"));
    if (k < 5 || !last_lacks_high) REQUIRE(write_mesh(upper_ellipsoid(cases[k]), of_case / "high.ply"));
  }
}

}  // namespace

TEST_CASE("structures of cases become one model whose file and reports know them") {
  const TemporaryFolder folder;
  put_cases(folder);
  const std::string set = " fits --structures low,high --keep-scale";
  const Ran common = run(folder, "model" + set + " -o common.h5 --json");
  REQUIRE_MESSAGE(common.status == 0, common.errors);
  const Ran each = run(folder, "model" + set + " --alignment each -o each.h5 --csv tables --aligned sw --json");
  REQUIRE_MESSAGE(each.status == 0, each.errors);
  CHECK(common.json()["alignment"] == "common");
  CHECK(each.json()["alignment"] == "each");
  CHECK(each.json()["vertices"] == 324);
  // The turns and offsets of the upper ones are no longer in the modes.
  CHECK(each.json()["modes"] == 1);
  CHECK(common.json()["modes"].get<int>() > 1);
  for (const Json& report : {common.json(), each.json(), run(folder, "info each.h5 --json").json()}) {
    const Json high = report["structures"][1];
    CHECK(high["name"] == "high");
    CHECK(high["first_vertex"] == 162);
    CHECK(high["faces"] == 320);
    // Half of the turns and offsets of the upper ones: the common frame goes half the way.
    CHECK(high["turn_sd_deg"].get<double>() == doctest::Approx(3.63 / 2).epsilon(0.2));
    CHECK(high["offset_sd_mm"].get<double>() == doctest::Approx(1.41 / 2).epsilon(0.05));
  }
  CHECK(lines(read_whole_file(folder.path / "tables/poses.csv").value()) == 13);
  // What was read is not written over.
  const std::string before = read_whole_file(folder.path / "fits/c0/low.ply").value();
  check_refused(run(folder, "model" + set + " --aligned fits -o m.h5"), "fits/c0/low.ply");
  CHECK(read_whole_file(folder.path / "fits/c0/low.ply").value() == before);

  // What was written as ShapeWorks has it is read again, in the scan and as it was aligned.
  const Ran again = run(folder, "model sw --structures low,high --keep-scale -o again.h5 --json");
  REQUIRE_MESSAGE(again.status == 0, again.errors);
  CHECK(again.json()["structures"][1]["faces"] == 0);
  for (std::size_t k = 0; k < 5; ++k)
    CHECK(again.json()["variances"][k].get<double>() ==
          doctest::Approx(common.json()["variances"][k].get<double>()).epsilon(1e-6));
  const Ran world = run(folder, "model sw --structures low,high --no-align --world -o world.h5 --json");
  REQUIRE_MESSAGE(world.status == 0, world.errors);
  CHECK(world.json()["variances"][0].get<double>() ==
        doctest::Approx(each.json()["variances"][0].get<double>()).epsilon(1e-6));
  CHECK(world.json()["structures"][1]["turn_sd_deg"].get<double>() < 1e-3);
}

TEST_CASE("a study whose cases name their frames keeps them and their groups in joint sets and reports") {
  const TemporaryFolder folder;
  put_cases(folder);
  Json cases = Json::array();
  for (int k = 0; k < 6; ++k) {
    const std::string name = "c" + std::to_string(k);
    const fs::path meshes = folder.path / "fits" / name;
    const auto low = load_template((meshes / "low.ply").string());
    EditSession session =
        create_case(new_document("", nullptr, low.value()), folder.path / (name + ".homolog")).value();
    REQUIRE(session.apply(SetStructure{.id = "s1", .name = "low"}));
    REQUIRE(session.apply(SetStructure{.id = "s2", .name = "high", .source = (meshes / "high.ply").string()}));
    cases.push_back({{"name", "case " + std::to_string(k)},
                     {"file", name + ".homolog"},
                     {"frame", 0},
                     {"group", k < 3 ? "flat" : "tall"},
                     {"state", "done"}});
  }
  REQUIRE(write_whole_file(folder.path / "j.study.json", Json{{"homolog_study", 1}, {"cases", cases}}.dump()));
  const Ran model = run(folder, "model j.study.json --structures low,high --csv tables -o m.h5 --json");
  REQUIRE_MESSAGE(model.status == 0, model.errors);
  CHECK(model.json()["shapes"] == 6);
  CHECK(read_whole_file(folder.path / "tables/scores.csv").value().find(",flat\n") != std::string::npos);
  const Ran report = run(folder, "report j.study.json --structures low,high -o page.html --json");
  REQUIRE_MESSAGE(report.status == 0, report.errors);
  CHECK(report.json()["cases"] == 6);
  CHECK(report.json()["left_out"] == 0);
  CHECK(report.json()["groups"] == Json::array({"flat", "tall"}));
  const Ran test = run(folder, "test j.study.json --structures low,high --formula \"shape ~ group\" --json");
  REQUIRE_MESSAGE(test.status == 0, test.errors);
  CHECK(test.json()["shapes"] == 6);
  CHECK(test.json()["left_out"].empty());
}

TEST_CASE("measures are of all structures or of one") {
  const TemporaryFolder folder;
  put_cases(folder);
  const std::string set = "evaluate fits --structures low,high --alignment each --samples 20 --json";
  const Json all = run(folder, set).json(), high = run(folder, set + " --structure High").json();
  CHECK(all["vertices"] == 324);
  CHECK(high["vertices"] == 162);
  CHECK(high["structure"] == "high");
  // Both structures have the same shapes.
  CHECK(high["total_variance_mm2"].get<double>() ==
        doctest::Approx(all["total_variance_mm2"].get<double>() / 2).epsilon(1e-6));
  const Ran none = run(folder, set + " --structure middle");
  CHECK(none.status == 1);
  CHECK(none.errors.find("name low or high") != std::string::npos);
}

TEST_CASE("a joint model's mean and random shapes and pictures are of all structures or of one") {
  const TemporaryFolder folder;
  put_cases(folder);
  REQUIRE(run(folder, "model fits --structures low,high -o m.h5").status == 0);
  CHECK(run(folder, "convert m.h5 all.ply --json").json()["components"] == 2);
  REQUIRE(run(folder, "convert m.h5 high.ply --structure high").status == 0);
  REQUIRE(run(folder, "convert m.h5 random.ply --structure high --sample 3").status == 0);
  const MeshFile all = read_mesh_file(folder.path / "all.ply").value(),
                 high = read_mesh_file(folder.path / "high.ply").value(),
                 random = read_mesh_file(folder.path / "random.ply").value();
  CHECK(all.points.rows() == 324);
  CHECK((high.points - all.points.bottomRows(162)).norm() == 0);
  CHECK(high.triangles == icosphere(2, 1).topology->triangles());
  const double moved = (random.points - high.points).rowwise().norm().mean();
  CHECK(moved > 0.1);
  CHECK(moved < 10);
  check_refused(run(folder, "convert m.h5 x.ply --structure hihg"), "m.h5");
  check_refused(run(folder, "convert m.h5 x.nii.gz"), "x.nii.gz");
  check_refused(run(folder, "convert all.ply x.ply --structure high"), "all.ply");
  const Ran gallery =
      run(folder, "picture correspondence fits --structures low,high --structure low -o g.png --size 200x200");
  if (gallery.errors.find("OpenGL") != std::string::npos) return;
  CHECK_MESSAGE(gallery.status == 0, gallery.errors);
  CHECK(run(folder, "picture modes m.h5 --structure high -o modes.png --size 200x200").status == 0);
}

TEST_CASE("a case that lacks a structure is left out or completed and marked") {
  const TemporaryFolder folder;
  put_cases(folder, true);
  const std::string set = "model fits --structures low,high --keep-scale -o m.h5 --json";
  const Ran left_out = run(folder, set);
  REQUIRE_MESSAGE(left_out.status == 0, left_out.errors);
  CHECK(left_out.json()["shapes"] == 5);
  CHECK(left_out.json()["left_out"] == Json::array({{{"name", "c5"}, {"reason", "has no high"}}}));
  CHECK(left_out.errors.find("c5: has no high (left out)") != std::string::npos);
  const Ran completed = run(folder, set + " --complete --aligned sw --csv tables");
  REQUIRE_MESSAGE(completed.status == 0, completed.errors);
  CHECK(completed.json()["shapes"] == 6);
  CHECK(completed.json()["left_out"].empty());
  CHECK(completed.errors.find("variances are too small") != std::string::npos);
  const Json report = completed.json()["completed"], file = run(folder, "info m.h5 --json").json()["completed"];
  for (const Json& list : {report, file}) {
    REQUIRE(list.size() == 1);
    CHECK(list[0]["name"] == "c5");
    CHECK(list[0]["structure"] == "high");
    CHECK(list[0]["expected_error_mm"].get<double>() > 0);
  }
  const std::string poses = read_whole_file(folder.path / "tables/poses.csv").value();
  CHECK(poses.ends_with(",1\n"));
  // Its shape is known from the lower one, its pose only on average.
  const Points found = read_mesh_file(folder.path / "sw/c5_high_local.particles").value().points;
  const Points truth = upper_ellipsoid({3, 0, 1, 1.05}).points;
  CHECK((found - truth).rowwise().norm().mean() < 3);
  CHECK(found.col(0).maxCoeff() == doctest::Approx(truth.col(0).maxCoeff()).epsilon(0.02));
}

TEST_CASE("shapes of several structures that are taken as one are named") {
  const TemporaryFolder folder;
  put_cases(folder, false);
  REQUIRE(run(folder, "model fits --structures low,high --aligned sw -o m.h5").status == 0);
  for (const auto& entry : fs::directory_iterator(folder.path / "sw"))
    if (entry.is_directory()) fs::remove_all(entry.path());
  const Ran mixed = run(folder, "model sw -o mixed.h5");
  REQUIRE_MESSAGE(mixed.status == 0, mixed.errors);
  CHECK(mixed.errors.find("sw: each subject has files of high and low, which are mixed here") != std::string::npos);
  CHECK(run(folder, "model sw --structures low,high -o m.h5").errors.find("mixed") == std::string::npos);
  const Ran folders = run(folder, "model fits -o m.h5");
  CHECK(folders.status == 1);
  CHECK(folders.errors.find("name the structures by --structures") != std::string::npos);
}

TEST_CASE("structures that make no joint model are refused in a sentence") {
  const TemporaryFolder folder;
  put_cases(folder, true);
  const auto refused = [&](const std::string& arguments, const std::string& why) {
    const Ran ran = run(folder, "model fits -o m.h5 " + arguments);
    INFO(ran.errors);
    CHECK(ran.status != 0);
    CHECK(ran.errors.find(why) != std::string::npos);
    CHECK_FALSE(fs::exists(folder.path / "m.h5"));
  };
  refused("--structures low,hihg", "fits: holds no case with hihg; the nearest names there are high");
  refused("--structures low,low", "names low twice");
  refused("--structures low", "names one structure only");
  refused("--alignment each", "--structures");
  refused("--complete", "--structures");
  refused("--structures low,high --optimise", "--structures");
  refused("--structures low,high --alignment each --no-align", "--alignment");
  REQUIRE(write_mesh(icosphere(1, 20), folder.path / "fits/c2/high.ply"));
  refused("--structures low,high", "fits/c2/high.ply: has 42 vertices where fits/c0/high.ply has 162");
  REQUIRE(write_mesh(upper_ellipsoid({}), folder.path / "fits/c2/high.ply"));
  for (const char* name : {"c1", "c2", "c3", "c4"}) fs::remove(folder.path / "fits" / name / "low.ply");
  refused("--structures low,high", "c1: has no low");
}

}  // namespace homolog
