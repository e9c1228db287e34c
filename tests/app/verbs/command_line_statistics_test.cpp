#include <cmath>
#include <map>

#include "core/base/numbers/random.h"
#include "core/base/text/text_table.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/model/shapes/doubtful_shapes.h"
#include "tests/command_line.h"

// The verb `test`.

using namespace homolog;

namespace {

/// Twelve balls c0 … c11 with noise; every second one has a bump of `bump_mm` at its top. And a table.
void put_balls(const fs::path& folder, double bump_mm) {
  Random random(9);
  std::string table = "name,group,age,subject\n";
  fs::create_directory(folder / "shapes");
  for (int k = 0; k < 12; ++k) {
    Mesh ball = icosphere(2, 20);
    for (Eigen::Index i = 0; i < ball.points.rows(); ++i) {
      const bool top = ball.points(i, 2) > 17;
      ball.points.row(i) *= 1 + 0.02 * random.normal();
      if (top && k % 2 == 1) ball.points(i, 2) += bump_mm;
    }
    const std::string name = "c" + std::to_string(k);
    REQUIRE(write_mesh(ball, folder / "shapes" / (name + ".ply")));
    table += name + (k % 2 == 1 ? ",ill," : ",well,") + std::to_string(40 + (7 * k) % 12) + ",s" +
             std::to_string(k / 2) + "\n";
  }
  REQUIRE(write_whole_file(folder / "t.csv", table));
}

std::string by(const std::string& formula) {
  return "test shapes --covariates t.csv --json --formula \"" + formula + "\" ";
}

}  // namespace

TEST_CASE("a bump of one group is found where it is and age is not blamed") {
  const TemporaryFolder folder;
  put_balls(folder.path, 4);
  // As they lie: alignment would spread the bump over the ball.
  const Ran ran = run(folder, by("shape ~ group + age") + "--no-align --csv out");
  REQUIRE(ran.status == 0);
  const Json report = ran.json();
  CHECK(report["shapes"] == 12);
  CHECK(report["sided"] == "two");
  CHECK(report["left_out"].empty());
  CHECK(report["terms"][0]["name"] == "group");
  CHECK(report["terms"][0]["p"].get<double>() <= 0.01);
  CHECK(report["terms"][1]["p"].get<double>() > 0.05);
  CHECK(report["pairs"][0]["a"] == "ill");
  CHECK(report["landmarks"] == "out/landmarks.csv");
  const Mesh ball = icosphere(2, 20);
  const std::string table = read_whole_file(folder.path / "out/landmarks.csv").value_or("");
  CHECK(lines(table) == 1 + 2 * static_cast<std::size_t>(ball.points.rows()));
  int hits = 0, wrong = 0, top = 0;
  for (Eigen::Index v = 0; v < ball.points.rows(); ++v) {
    const auto at = table.find("\ngroup," + std::to_string(v) + ",");
    REQUIRE(at != std::string::npos);
    const auto cells = csv_fields(std::string_view(table).substr(at + 1, table.find('\n', at + 1) - at - 1));
    const bool found = std::stod(cells[3]) <= 0.05, is_top = ball.points(v, 2) > 17;
    top += is_top ? 1 : 0;
    (is_top ? hits : wrong) += found ? 1 : 0;
    if (is_top) CHECK(std::stod(cells[4]) == doctest::Approx(4).epsilon(0.4));
    if (is_top) CHECK(std::stod(cells[5]) < 0);  // from ill to well: inwards
  }
  CHECK(hits == top);
  CHECK(wrong <= top / 4);
  CHECK(lines(read_whole_file(folder.path / "out/cases.csv").value_or("")) == 13);
  // Where a vertex of the bump lies in each case: outwards in those that are ill.
  Eigen::Index pole = 0;
  ball.points.col(2).maxCoeff(&pole);
  const std::string at = "vertex-" + std::to_string(pole) + ".csv";
  REQUIRE(run(folder, by("shape ~ group") + "--no-align --csv one --at " + std::to_string(pole)).status == 0);
  const std::string places = read_whole_file(folder.path / "one" / at).value_or("");
  CHECK(lines(places) == 13);
  for (int k = 0; k < 12; ++k) {
    const auto row = places.find("\nc" + std::to_string(k) + ",");
    REQUIRE(row != std::string::npos);
    const auto cells = csv_fields(std::string_view(places).substr(row + 1, places.find('\n', row + 1) - row - 1));
    CHECK(std::stod(cells[4]) * (k % 2 == 1 ? 1 : -1) > 0);
  }
  // With 19 permutations q cannot be small, and that is said.
  CHECK(run(folder, by("shape ~ group") + "--no-align --csv few --permutations 19").errors.find("ask for more") !=
        std::string::npos);
  // The same bytes with one thread.
  REQUIRE(run(folder, by("shape ~ group + age") + "--no-align --csv other --jobs 1").out.size() > 0);
  CHECK(read_whole_file(folder.path / "other/landmarks.csv").value_or("") == table);
}

TEST_CASE("a formula of sizes alone needs no table") {
  const TemporaryFolder folder;
  put_balls(folder.path, 4);
  const Ran without = run(folder, "test shapes --json --formula \"shape ~ log(size)\"");
  REQUIRE_MESSAGE(without.status == 0, without.errors);
  CHECK(without.json()["shapes"] == 12);
  CHECK(without.json()["terms"] == run(folder, by("shape ~ log(size)")).json()["terms"]);
  const Ran group = run(folder, "test shapes --formula \"shape ~ group\"");
  CHECK(group.status == 1);
  CHECK(group.errors.find("--covariates: is needed for group") != std::string::npos);
}

TEST_CASE("cases without a partner or a value are left out with the reason") {
  const TemporaryFolder folder;
  put_balls(folder.path, 0);
  std::string table = read_whole_file(folder.path / "t.csv").value_or("");
  table.replace(table.find("c3,ill,49"), 9, "c3,ill,NA");
  table.erase(table.find("c5,"), table.find("c6,") - table.find("c5,"));
  REQUIRE(write_whole_file(folder.path / "t.csv", table + "stranger,ill,50,s9\n"));
  const Json report = run(folder, by("size ~ group + age")).json();
  CHECK(report["shapes"] == 10);
  CHECK(report["landmarks"].is_null());
  const Json expected = Json::array({{{"name", "c5"}, {"reason", "has no row in t.csv"}},
                                     {{"name", "stranger"}, {"reason", "is a row without a shape"}},
                                     {{"name", "c3"}, {"reason", "has no value of age"}}});
  CHECK(report["left_out"] == expected);
  const Json paired = run(folder, by("shape ~ group") + "--paired subject").json();
  CHECK(paired["shapes"] == 10);
  CHECK(paired["terms"].size() == 1);
  CHECK(paired["left_out"][2]["reason"] == "is the only case of subject s2");
  // One that is left out for its doubt is no row without a shape.
  MeshFile doubtful = read_mesh_file(folder.path / "shapes/c4.ply").value();
  doubtful.comments.push_back(doubt_comment("lies 3 mm off"));
  REQUIRE(write_mesh_file(doubtful, folder.path / "shapes/c4.ply"));
  const Json sure = run(folder, by("size ~ group + age") + "--without-doubtful").json();
  CHECK(sure["shapes"] == 9);
  CHECK(sure["left_out"].size() == 4);
}

TEST_CASE("shapes of one name are told apart by their folders") {
  const TemporaryFolder folder;
  put_balls(folder.path, 0);
  std::string table = "name,visit,subject,score\n";
  for (const char* visit : {"pre", "post"}) {
    fs::create_directory(folder.path / visit);
    for (int k = 0; k < 6; ++k) {
      const int ball = 2 * k + (visit == std::string("pre") ? 0 : 1);
      const std::string file = visit + ("/P" + std::to_string(k) + ".ply");
      fs::copy_file(folder.path / "shapes" / ("c" + std::to_string(ball) + ".ply"), folder.path / file);
      table += file + "," + visit + ",P" + std::to_string(k) + "," + std::to_string((5 * ball) % 12) + "\n";
    }
  }
  REQUIRE(write_whole_file(folder.path / "visits.csv", table));
  const auto sizes = [&](const std::string& shapes) {
    const Ran ran = run(folder, "test " + shapes + " --covariates visits.csv --formula 'size ~ score' --csv out");
    REQUIRE_MESSAGE(ran.status == 0, ran.errors);
    std::map<std::string, std::string> size_of;
    const TextTable cases = read_text_table(folder.path / "out/cases.csv").value();
    for (const auto& row : cases.rows) size_of[row[0]] = row[1];
    return size_of;
  };
  const auto both = sizes("pre post");
  CHECK(both.size() == 12);
  CHECK(both == sizes("post pre"));
  const auto pre = sizes("pre");
  CHECK(pre.size() == 6);
  CHECK(pre.at("pre/P3.ply") == both.at("pre/P3.ply"));
  CHECK(both.at("pre/P3.ply") != both.at("post/P3.ply"));
  // The folder that a shape lies in goes before the order of the arguments.
  const Ran paired =
      run(folder, "test post pre --covariates visits.csv --json --formula 'size ~ visit' --paired subject");
  REQUIRE_MESSAGE(paired.status == 0, paired.errors);
  CHECK(paired.json()["shapes"] == 12);
  CHECK(paired.json()["left_out"].empty());
  // A shape whose row is not there takes none of another folder.
  const std::string last = table.substr(table.find("post/P5.ply"));
  REQUIRE(write_whole_file(folder.path / "visits.csv", table.substr(0, table.size() - last.size())));
  const Json lacks = run(folder, "test post --covariates visits.csv --json --formula 'size ~ score'").json();
  CHECK(lacks["shapes"] == 5);
  CHECK(lacks["left_out"][0] == Json({{"name", "P5"}, {"reason", "has no row in visits.csv"}}));
  // Names of other folders count by the file alone; a plain name that may be of two shapes does not.
  std::string moved = table, plain = "name,score\n";
  for (std::size_t at = 0; (at = moved.find(".ply", at)) != std::string::npos;) moved.replace(at, 4, ".nii.gz");
  for (std::size_t at = moved.find('\n'); at + 1 < moved.size(); at = moved.find('\n', at + 1))
    moved.insert(at + 1, "/data/");
  REQUIRE(write_whole_file(folder.path / "visits.csv", moved));
  CHECK(sizes("pre post").at("/data/pre/P3.nii.gz") == both.at("pre/P3.ply"));
  for (int k = 0; k < 6; ++k) plain += "P" + std::to_string(k) + "," + std::to_string((5 * k) % 12) + "\n";
  REQUIRE(write_whole_file(folder.path / "visits.csv", plain));
  CHECK(sizes("post").at("P3") == both.at("post/P3.ply"));
  check_refused(run(folder, "test pre post --covariates visits.csv --formula 'size ~ score'"),
                "has the row P0, which may be of pre/P0.ply or of post/P0.ply; write the folder into the names of its "
                "rows, as pre/P0");
  REQUIRE(write_whole_file(folder.path / "visits.csv", table));
  check_refused(run(folder, "test shapes --covariates visits.csv --formula 'size ~ score'"),
                "names none of the shapes");
  const std::string twice = "name,score\na/P0.ply,1\nb/P0.ply,2\na/P1.ply,4\n";
  REQUIRE(write_whole_file(folder.path / "visits.csv", twice));
  check_refused(run(folder, "test pre --covariates visits.csv --formula 'size ~ score'"),
                "has the rows a/P0.ply and b/P0.ply, and either may be of pre/P0.ply");
}

TEST_CASE("an answer that rests on vertices in doubt or on one template is told apart from one that does not") {
  const TemporaryFolder folder;
  put_balls(folder.path, 4);
  fs::copy(folder.path / "shapes", folder.path / "twin");
  fs::rename(folder.path / "shapes", folder.path / "bumps");
  put_balls(folder.path, 0);
  fs::rename(folder.path / "shapes", folder.path / "flat");
  fs::rename(folder.path / "bumps", folder.path / "shapes");

  const Json sure = run(folder, by("shape ~ group") + "--no-align").json();
  CHECK_FALSE(sure.contains("again"));
  const Json other = run(folder, by("shape ~ group + age") + "--no-align --templates twin flat").json();
  REQUIRE(other["holds"].size() == 2);
  CHECK(other["holds"][0] == "group: p <= 0.05, but not flat");
  CHECK(other["holds"][1] == "age: p > 0.05, and so twin and flat");
  REQUIRE(other["again"].size() == 2);
  CHECK(other["again"][0]["terms"][0]["p"] == other["terms"][0]["p"]);
  CHECK(other["again"][1]["terms"][0]["p"].get<double>() > 0.05);

  // The record of its tables names no folder of shapes by its path, and finds it wherever it lies.
  fs::remove(folder.path / "twin/c11.ply");
  const Ran fewer = run(
      folder, by("shape ~ group") + "--no-align --templates '" + (folder.path / "twin").string() + "' --csv tables");
  CHECK(fewer.status == 0);
  CHECK(fewer.errors.find("has other cases (11 where there are 12)") != std::string::npos);
  for (const auto& table : fs::directory_iterator(folder.path / "tables"))
    CHECK(read_whole_file(table.path()).value().find(folder.path.string()) == std::string::npos);
  fs::create_directory(folder.path / "moved");
  fs::rename(folder.path / "twin", folder.path / "moved/twin");
  const Ran again = run(folder, "verify tables/landmarks.csv --inputs .");
  CHECK_MESSAGE(again.status == 0, again.errors);

  // All that the groups differ in lies where nobody knows what belongs where.
  int top = 0;
  for (int k = 0; k < 12; ++k) {
    const fs::path file = folder.path / "shapes" / ("c" + std::to_string(k) + ".ply");
    MeshFile mesh = read_mesh_file(file).value();
    mesh.doubt_mm = VertexScalars::Constant(mesh.points.rows(), 0.01);
    top = 0;
    for (Eigen::Index i = 0; i < mesh.points.rows(); ++i)
      if (icosphere(2, 20).points(i, 2) > 17) (*mesh.doubt_mm)[i] = 12, ++top;
    REQUIRE(write_mesh_file(mesh, file));
  }
  const Json doubtful = run(folder, by("shape ~ group") + "--no-align").json();
  CHECK(doubtful["terms"][0]["p"] == sure["terms"][0]["p"]);
  const std::string without = "without the " + std::to_string(top) + " vertices in doubt";
  CHECK(doubtful["holds"][0] == "group: p <= 0.05, but not " + without);
  CHECK(doubtful["again"][0]["of"] == without);
  CHECK(doubtful["again"][0]["terms"][0]["p"].get<double>() > 0.05);
  check_refused(run(folder, by("shape ~ group") + "--templates absent"), "absent");
}

TEST_CASE("terms of other shapes are compared by their names, since pairs may leave one out there") {
  const TemporaryFolder folder;
  put_balls(folder.path, 4);
  // The arm varies within the first subject alone, which the other shapes lack.
  std::string table = "name,visit,arm,subject\n";
  for (int k = 0; k < 12; ++k)
    table += "c" + std::to_string(k) + (k % 2 == 1 ? ",late," : ",early,") +
             (k == 0 || k / 2 % 2 == 1 ? "drug," : "none,") + "s" + std::to_string(k / 2) + "\n";
  REQUIRE(write_whole_file(folder.path / "t.csv", table));
  fs::copy(folder.path / "shapes", folder.path / "fewer");
  for (const char* name : {"c0.ply", "c1.ply"}) fs::remove(folder.path / "fewer" / name);
  const Ran ran = run(folder, by("shape ~ visit*arm") + "--paired subject --no-align --templates fewer");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  REQUIRE(ran.json()["terms"].size() == 3);
  REQUIRE(ran.json()["again"][0]["terms"].size() == 2);
  CHECK(ran.json()["holds"][1].get<std::string>().ends_with("; fewer cannot test it"));
  const std::string interaction = ran.json()["holds"][2];
  const bool same = (ran.json()["terms"][2]["p"].get<double>() <= 0.05) ==
                    (ran.json()["again"][0]["terms"][1]["p"].get<double>() <= 0.05);
  CHECK(interaction.ends_with(same ? ", and so fewer" : ", but not fewer"));
}

TEST_CASE("doubts weigh by how shapes scatter where the shapes themselves explain") {
  const TemporaryFolder folder;
  put_balls(folder.path, 4);
  for (int k = 0; k < 12; ++k) {
    const fs::path file = folder.path / "shapes" / ("c" + std::to_string(k) + ".ply");
    MeshFile mesh = read_mesh_file(file).value();
    mesh.doubt_mm = VertexScalars::Constant(mesh.points.rows(), 0.2);
    REQUIRE(write_mesh_file(mesh, file));
  }
  const auto mean_weight = [&](const std::string& options) {
    const Ran ran = run(folder, by("age ~ shape") + "--by-doubt --modes " + options);
    REQUIRE_MESSAGE(ran.status == 0, ran.errors);
    return ran.json()["weights"]["mean"].get<double>();
  };
  CHECK(mean_weight("1") == doctest::Approx(mean_weight("6")).epsilon(1e-9));
}

TEST_CASE("with size taken out cases and their doubt may be of any size") {
  const TemporaryFolder folder;
  put_balls(folder.path, 4);
  const auto put = [&](const std::string& into, const std::vector<double>& scales) {
    fs::create_directory(folder.path / into);
    for (std::size_t k = 0; k < 12; ++k) {
      const std::string name = "c" + std::to_string(k) + ".ply";
      MeshFile mesh = read_mesh_file(folder.path / "shapes" / name).value();
      const double scale = scales[k % scales.size()];
      mesh.points *= scale;
      mesh.doubt_mm = VertexScalars::LinSpaced(mesh.points.rows(), 0, scale * static_cast<double>(k % 5));
      REQUIRE(write_mesh_file(mesh, folder.path / into / name));
    }
  };
  put("plain", {1.0});
  put("scaled", {0.6, 1.0, 1.5});
  const auto test_of = [&](const std::string& shapes, const std::string& more) {
    const Ran ran = run(folder, "test " + shapes + " --covariates t.csv --json --formula 'shape ~ group' " + more);
    REQUIRE_MESSAGE(ran.status == 0, ran.errors);
    return ran.json();
  };
  const double f = test_of("plain", "--by-doubt")["terms"][0]["f"];
  CHECK(test_of("scaled", "--by-doubt")["terms"][0]["f"].get<double>() == doctest::Approx(f).epsilon(1e-4));
  CHECK(test_of("scaled", "")["again"][0]["of"] == test_of("plain", "")["again"][0]["of"]);
}

TEST_CASE("few cases say that no p can be small") {
  const TemporaryFolder folder;
  put_balls(folder.path, 4);
  for (int k = 6; k < 12; ++k) fs::remove(folder.path / "shapes" / ("c" + std::to_string(k) + ".ply"));
  const Ran six = run(folder, by("shape ~ group"));
  REQUIRE_MESSAGE(six.status == 0, six.errors);
  CHECK(six.errors.find("in 10 ways that differ, so no p can be below 0.1") != std::string::npos);
  CHECK(run(folder, by("shape ~ age")).errors.find("ways that differ") == std::string::npos);
}

TEST_CASE("what a test cannot answer is refused in a sentence") {
  const TemporaryFolder folder;
  put_balls(folder.path, 0);
  check_refused(run(folder, by("shape ~ grop")), "Did you mean group?");
  check_refused(run(folder, by("shape ~ log(group)")), "where group should be a number");
  check_refused(run(folder, by("group ~ age")), "groups are no number; test shape by them instead: shape ~ group");
  check_refused(run(folder, by("log(shape) ~ group")), "log(shape): is of shapes");
  check_refused(run(folder, by("age ~ factor(shape)")), "factor(shape): is of shapes");
  check_refused(run(folder, by("shape ~ factor(size)")), "factor(size): is of sizes, which name no groups");
  check_refused(run(folder, by("factor(age) ~ group")), "factor(age): is what is tested");
  check_refused(run(folder, by("shape ~ group*age*factor(subject)")), "parameters");
  check_refused(run(folder, by("shape ~ factor(subject)") + "--paired subject"),
                "factor(subject) is the same in all cases of a subject, so --paired takes it out");
  check_refused(run(folder, by("shape ~ group") + "--by-doubt"), "none of the shapes has a doubt");
  check_refused(run(folder, by("age ~ shape") + "--modes 40"), "--modes");
  check_refused(run(folder, by("shape ~ age") + "--modes 2"), "--modes: has no effect");
  check_refused(run(folder, by("size ~ age") + "--without-direction shapes/c0.ply shapes/c1.ply"), "has no effect");
  check_refused(run(folder, by("shape ~ group") + "--csv out --at 162"), "--at");
  check_refused(run(folder, by("shape ~ group") + "--csv out --at top"), "and the shapes have none");
  CHECK_FALSE(fs::exists(folder.path / "out"));
  check_refused(run(folder, by("shape ~ group") + "--sided greater"), "has no meaning for shapes");
  check_refused(run(folder, by("size ~ factor(subject)") + "--sided less"), "needs a term of two groups");
  check_refused(run(folder, by("size ~ mirrored") + "--object-symmetry"), "write shape before the ~");
  CHECK(run(folder, "test shapes").status == 2);
  CHECK(run(folder, by("size ~ group") + "--sided both").status == 2);
  check_refused(run(folder, "test shapes --formula \"shape ~ group\""), "--covariates");
  check_refused(run(folder, by("shape ~ group") + "--paired name"), "is no column");
  check_refused(run(folder, by("shape ~ group") + "--paired age"), "is the only case of age");
  REQUIRE(write_whole_file(folder.path / "orders.txt", "0 1 2\n"));
  check_refused(run(folder, by("shape ~ group") + "--permutation-file orders.txt"), "orders.txt");
  REQUIRE(write_whole_file(folder.path / "t.csv", "Age,Subject ID\n40,c0\n41,c1\n"));
  check_refused(run(folder, by("shape ~ Age")),
                "Age: was taken as the names of the cases, since no column of t.csv is called name, case or id");
  REQUIRE(write_whole_file(folder.path / "t.csv", "name,group\nx,a\ny,b\n"));
  check_refused(run(folder, by("shape ~ group")), "names none of the shapes");
  REQUIRE(write_mesh(icosphere(1, 20), folder.path / "shapes" / "c12.ply"));
  check_refused(run(folder, by("shape ~ group")), "c12.ply");
}

TEST_CASE("a study brings its own covariates and shape explains a number by its modes") {
  const TemporaryFolder folder;
  put_balls(folder.path, 3);
  Json study{{"homolog_study", 1}, {"cases", Json::array()}};
  for (int k = 0; k < 12; ++k)
    study["cases"].push_back({{"name", "case " + std::to_string(k)},
                              {"file", "shapes/c" + std::to_string(k) + ".ply"},
                              {"group", k % 2 == 1 ? "ill" : "well"},
                              {"age", 30 + k * k}});
  REQUIRE(write_whole_file(folder.path / "s.study.json", study.dump()));
  const Json report = run(folder, "test s.study.json --json --formula \"shape ~ group + age\"").json();
  CHECK(report["shapes"] == 12);
  CHECK(report["terms"][0]["p"].get<double>() <= 0.01);
  const Json turned = run(folder, "test s.study.json --json --modes 2 --formula \"age ~ shape\"").json();
  CHECK(turned["modes"] == 2);
  CHECK(turned["terms"][0]["df"] == 2);
}

TEST_CASE("a study that study make wrote brings the columns of its table, with decimal commas too") {
  const TemporaryFolder folder;
  put_balls(folder.path, 3);
  std::string table = "name;file;group;mass;subject\n";
  for (int k = 0; k < 12; ++k)
    table += "case " + std::to_string(k) + ";shapes/c" + std::to_string(k) + ".ply;" + (k % 2 == 1 ? "ill;" : "well;") +
             std::to_string(50 + k * k) + ",5;s" + std::to_string(k / 2) + "\n";
  REQUIRE(write_whole_file(folder.path / "cases.csv", table));
  const Ran made = run(folder, "study make cases.csv --template shapes/c0.ply -o s.study.json");
  REQUIRE_MESSAGE(made.status == 0, made.errors);
  const Ran ran = run(folder, "test s.study.json --json --formula \"shape ~ group + mass\"");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  CHECK(ran.json()["shapes"] == 12);
  CHECK(ran.json()["terms"][0]["p"].get<double>() <= 0.01);
  CHECK(ran.json()["terms"][1]["df"] == 1);  // a number, and not twelve groups
  CHECK(run(folder, "test s.study.json --json --paired subject --formula \"shape ~ group\"").status == 0);
  // The same numbers in a table of their own.
  REQUIRE(write_whole_file(folder.path / "t.csv", table));
  const Ran own = run(folder, "test shapes --covariates cases.csv --json --formula \"shape ~ group + mass\"");
  CHECK(own.status == 1);  // names of cases, not of files
  std::string by_file = "name;mass\n";
  for (int k = 0; k < 12; ++k) by_file += "c" + std::to_string(k) + ";" + std::to_string(50 + k * k) + ",5\n";
  REQUIRE(write_whole_file(folder.path / "comma.csv", by_file));
  const Ran comma = run(folder, "test shapes --covariates comma.csv --json --formula \"shape ~ mass\"");
  REQUIRE_MESSAGE(comma.status == 0, comma.errors);
  CHECK(comma.json()["terms"][0]["df"] == 1);
}

TEST_CASE("repeated measures of two arms test the visit and how the arms differ in it") {
  const TemporaryFolder folder;
  put_balls(folder.path, 4);
  // Two visits of each of six subjects; the bump is there at the second, in one arm as in the other.
  std::string table = "name,visit,arm,subject\n";
  for (int k = 0; k < 12; ++k)
    table += "c" + std::to_string(k) + (k % 2 == 1 ? ",late," : ",early,") + (k / 2 % 2 == 1 ? "drug," : "none,") +
             "s" + std::to_string(k / 2) + "\n";
  REQUIRE(write_whole_file(folder.path / "t.csv", table));
  const Ran repeated = run(folder, by("shape ~ visit*arm") + "--paired subject --no-align");
  REQUIRE_MESSAGE(repeated.status == 0, repeated.errors);
  REQUIRE(repeated.json()["terms"].size() == 2);
  CHECK(repeated.json()["terms"][0]["name"] == "visit");
  CHECK(repeated.json()["terms"][0]["p"].get<double>() <= 0.05);
  CHECK(repeated.json()["terms"][1]["name"] == "visit:arm");
  CHECK(repeated.json()["terms"][1]["p"].get<double>() > 0.05);
  CHECK(repeated.json()["residual"]["df"] == 4);  // 12 less 6 subjects, a visit and an interaction
  CHECK(repeated.errors.find("arm: is the same in all cases of a subject") != std::string::npos);
  // Alone it cannot be tested: nothing is left of it.
  CHECK(run(folder, by("shape ~ visit + arm") + "--paired subject")
            .errors.find("the term arm is the same in all cases of a subject, so --paired takes it out") !=
        std::string::npos);
}

TEST_CASE("an interaction with an empty cell has fewer df, and the answer says so") {
  const TemporaryFolder folder;
  put_balls(folder.path, 4);
  const std::string kinds = "aabbccaabbcc", sexes = "fmfmfffmfmff";  // no m of c
  std::string table = "name,kind,sex\n";
  for (std::size_t k = 0; k < 12; ++k) table += "c" + std::to_string(k) + "," + kinds[k] + "," + sexes[k] + "\n";
  REQUIRE(write_whole_file(folder.path / "t.csv", table));
  const Ran ran = run(folder, by("size ~ kind*sex"));
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  const Json terms = ran.json()["terms"];
  CHECK(terms[2]["name"] == "kind:sex");
  CHECK(terms[2]["df"] == 1);
  CHECK(ran.json()["residual"]["df"] == 7);
  CHECK(ran.errors.find("kind:sex: has 1 df and not 2, since the others follow from these") != std::string::npos);
}

TEST_CASE("numbers that name groups are told apart by their value") {
  const TemporaryFolder folder;
  put_balls(folder.path, 4);
  const auto pairs = [&](const std::vector<std::string>& sites) {
    std::string table = "name,site\n";
    for (std::size_t k = 0; k < 12; ++k) table += "c" + std::to_string(k) + "," + sites[k % sites.size()] + "\n";
    REQUIRE(write_whole_file(folder.path / "t.csv", table));
    const Ran ran = run(folder, by("size ~ factor(site)"));
    REQUIRE_MESSAGE(ran.status == 0, ran.errors);
    return ran.json()["pairs"];
  };
  CHECK(pairs({"1", "2", "1.0", "02"}) == pairs({"1", "2"}));
}

TEST_CASE("a direction that is nobody's is taken out before the test") {
  const TemporaryFolder folder;
  put_balls(folder.path, 4);
  Mesh shut = icosphere(2, 20), open = shut;
  for (Eigen::Index i = 0; i < open.points.rows(); ++i)
    if (open.points(i, 2) > 17) open.points(i, 2) += 7;
  REQUIRE(write_mesh(shut, folder.path / "shut.ply"));
  REQUIRE(write_mesh(open, folder.path / "open.ply"));
  const std::string asked = by("shape ~ group") + "--no-align ";
  CHECK(run(folder, asked).json()["terms"][0]["p"].get<double>() <= 0.01);
  const Ran without = run(folder, asked + "--without-direction shut.ply open.ply");
  REQUIRE_MESSAGE(without.status == 0, without.errors);
  CHECK(without.json()["terms"][0]["p"].get<double>() > 0.05);
  CHECK(without.json()["total"]["ss"].get<double>() < 0.9 * run(folder, asked).json()["total"]["ss"].get<double>());
  check_refused(run(folder, asked + "--without-direction shut.ply shut.ply"), "which gives no direction");
  CHECK(run(folder, asked + "--without-direction shut.ply open.ply --templates shapes").status == 2);
  // The two shapes are inputs, known by what they hold.
  REQUIRE(run(folder, asked + "--csv out --without-direction shut.ply open.ply").status == 0);
  fs::create_directory(folder.path / "elsewhere");
  for (const char* name : {"shut.ply", "open.ply", "t.csv", "shapes", "out"})
    fs::rename(folder.path / name, folder.path / "elsewhere" / name);
  const Ran verified = run(folder, "verify elsewhere/out/landmarks.csv --inputs elsewhere");
  CHECK_MESSAGE(verified.status == 0, verified.errors);
  for (const char* name : {"shut.ply", "open.ply", "t.csv", "shapes"})
    fs::rename(folder.path / "elsewhere" / name, folder.path / name);
  REQUIRE(write_mesh(icosphere(1, 20), folder.path / "coarse.ply"));
  check_refused(run(folder, asked + "--without-direction shut.ply coarse.ply"), "coarse.ply: has 42 vertices");
}

TEST_CASE("structures of cases are tested, one or together") {
  const TemporaryFolder folder;
  put_balls(folder.path, 4);
  for (int k = 0; k < 12; ++k) {
    const std::string name = "c" + std::to_string(k);
    fs::create_directories(folder.path / "fits" / name);
    fs::copy_file(folder.path / "shapes" / (name + ".ply"), folder.path / "fits" / name / "top.ply");
    REQUIRE(write_mesh(icosphere(1, 10 + 0.1 * (k * 7 % 12)), folder.path / "fits" / name / "base.ply"));
  }
  const std::string asked = "test fits --covariates t.csv --json --no-align --formula \"shape ~ group\" --structures ";
  const Json alone = run(folder, by("shape ~ group") + "--no-align").json();
  const Ran top = run(folder, asked + "top");
  REQUIRE_MESSAGE(top.status == 0, top.errors);
  CHECK(top.json()["shapes"] == 12);
  CHECK(top.json()["terms"] == alone["terms"]);
  CHECK(run(folder, asked + "base").json()["terms"][0]["p"].get<double>() > 0.05);
  const Json both = run(folder, asked + "top,base").json();
  CHECK(both["vertices"] == 162 + 42);
  CHECK(both["terms"][0]["p"].get<double>() <= 0.05);
  // Doubts count as they do of one structure's meshes.
  check_refused(run(folder, asked + "top --by-doubt"), "none of the shapes has a doubt");
  for (int k = 0; k < 12; ++k)
    for (const char* part : {"top", "base"}) {
      const fs::path file = folder.path / "fits" / ("c" + std::to_string(k)) / (part + std::string(".ply"));
      MeshFile mesh = read_mesh_file(file).value();
      mesh.doubt_mm = VertexScalars::Constant(mesh.points.rows(), k < 6 ? 0.1 : 3);
      REQUIRE(write_mesh_file(mesh, file));
    }
  const Ran by_doubt = run(folder, asked + "top,base --by-doubt");
  REQUIRE_MESSAGE(by_doubt.status == 0, by_doubt.errors);
  CHECK(by_doubt.json()["weights"]["min"].get<double>() < 0.5 * by_doubt.json()["weights"]["mean"].get<double>());
}

TEST_CASE("what no number is gets a short sentence") {
  const TemporaryFolder folder;
  put_balls(folder.path, 0);
  const Ran ran = run(folder, "evaluate shapes --seed top");
  CHECK(ran.status == 2);
  CHECK(ran.errors.find("--seed: \"top\" is no number of 0 or more") != std::string::npos);
  CHECK(ran.errors.size() < 100);
}

TEST_CASE("a side that is asked for is the side that counts, and the answer says which") {
  const TemporaryFolder folder;
  put_balls(folder.path, 4);  // the bumps are of those that are ill, the first of the two groups
  const auto term = [&](const std::string& options) { return run(folder, by("size ~ group + age") + options).json(); };
  const Json two = term(""), greater = term("--sided greater"), less = term("--sided less");
  CHECK(two["sided"] == "two");
  CHECK(less["sided"] == "less");
  CHECK(less["terms"][0]["sided"] == "less");
  CHECK(two["terms"][0]["change"].get<double>() < 0);
  CHECK(two["pairs"][0]["difference"] == two["terms"][0]["change"]);
  CHECK(less["terms"][0]["p"].get<double>() < 0.01);
  CHECK(greater["terms"][0]["p"].get<double>() > 0.99);
  CHECK(less["pairs"][0]["p"] == less["terms"][0]["p"]);
  CHECK(less["terms"][0]["f"] == two["terms"][0]["f"]);
}

TEST_CASE("--at takes the names of landmarks, at the place where the template has them") {
  const TemporaryFolder folder;
  put_balls(folder.path, 4);
  for (int k = 0; k < 12; ++k) {
    const fs::path file = folder.path / "shapes" / ("c" + std::to_string(k) + ".ply");
    MeshFile ball = read_mesh_file(file).value();
    ball.landmarks = {{"north pole", ball.points.row(5).transpose()}, {"elsewhere", Vec3(0, 0, -20)}};
    REQUIRE(write_mesh_file(ball, file));
  }
  const Ran ran = run(folder, by("shape ~ group") + "--no-align --csv out --at 5,\"north pole\"");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  const std::string by_number = read_whole_file(folder.path / "out/vertex-5.csv").value_or("");
  CHECK(lines(by_number) == 13);
  const auto rows = [&](const std::string& table) {
    std::vector<double> values;
    for (int k = 0; k < 12; ++k) {
      const auto row = table.find("\nc" + std::to_string(k) + ",");
      REQUIRE(row != std::string::npos);
      const auto cells = csv_fields(std::string_view(table).substr(row + 1, table.find('\n', row + 1) - row - 1));
      for (std::size_t column = 1; column < 5; ++column) values.push_back(std::stod(cells[column]));
    }
    return values;
  };
  const auto numbers = rows(by_number);
  const auto names = rows(read_whole_file(folder.path / "out/landmark-north pole.csv").value_or(""));
  REQUIRE(numbers.size() == names.size());
  for (std::size_t k = 0; k < numbers.size(); ++k) CHECK(names[k] == doctest::Approx(numbers[k]).epsilon(1e-6));
  check_refused(run(folder, by("shape ~ group") + "--csv two --at \"north pol\""), "Did you mean north pole?");
  CHECK_FALSE(fs::exists(folder.path / "two"));
}
