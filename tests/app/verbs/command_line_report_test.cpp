// The command-line contract of docs/commands.md: report.
#include <cstring>

#include "core/base/encoding/base64.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/model/files/statismo.h"
#include "tests/command_line.h"

namespace homolog {

namespace {

/// Five ellipsoids of 642 vertices, a study of them in two groups, and a name that HTML would take for an element.
void put_study(const TemporaryFolder& folder) {
  const std::vector<Vec3> axes{{30, 20, 10}, {33, 19, 11}, {28, 22, 10}, {31, 20, 12}, {29, 18, 9}};
  Json cases = Json::array();
  for (std::size_t k = 0; k < axes.size(); ++k) {
    Mesh mesh = icosphere(3, 1);
    mesh.points = mesh.points * axes[k].asDiagonal();
    const std::string name = "e" + std::to_string(k) + ".ply";
    REQUIRE(write_mesh(mesh, folder.path / name));
    cases.push_back({{"name", k == 1 ? "</script><b>" : "case " + std::to_string(k)},
                     {"file", name},
                     {"group", k < 3 ? "flat" : "tall"},
                     {"state", "done"}});
  }
  cases[4]["doubt"] = "lies 3 mm off the label map";
  cases[4]["state"] = "in work";
  const Json study{{"homolog_study", 1}, {"cases", cases}};
  REQUIRE(write_whole_file(folder.path / "organs.study.json", study.dump()));
}

Json data_of(const std::string& page) {
  const std::string open = "<script type=\"application/json\" id=\"data\">";
  const auto begin = page.find(open) + open.size();
  return Json::parse(page.substr(begin, page.find("</script>", begin) - begin), nullptr, false);
}

std::vector<float> floats_of(const Json& text) {
  const std::vector<unsigned char> bytes = from_base64(text.get<std::string>());
  std::vector<float> numbers(bytes.size() / sizeof(float));
  std::memcpy(numbers.data(), bytes.data(), bytes.size());
  return numbers;
}

std::string page_in(const TemporaryFolder& folder, const std::string& name) {
  return read_whole_file(folder.path / name).value_or("");
}

}  // namespace

TEST_CASE("a report is one page that loads nothing and is the same bytes twice") {
  const TemporaryFolder folder;
  put_study(folder);
  const Ran ran = run(folder, "report organs.study.json -o page.html --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  CHECK(ran.json()["cases"] == 5);
  CHECK(ran.json()["groups"] == Json::array({"flat", "tall"}));
  const std::string page = page_in(folder, "page.html");
  CHECK(ran.json()["bytes"] == page.size());
  CHECK(page.size() < 2'500'000);
  CHECK(page.find("default-src 'none'") != std::string::npos);
  for (const char* load : {"src=\"http", "href=\"http", "src='http", "url(http", "@import", "<link", "{{"})
    CHECK_MESSAGE(page.find(load) == std::string::npos, load);
  CHECK(page.find(folder.path.string()) == std::string::npos);
  CHECK(page.find("<b>") == page.find("<b></b>"));  // the legend's own, and no name's
  REQUIRE(run(folder, "report organs.study.json -o again.html --jobs 1").status == 0);
  CHECK(page_in(folder, "again.html") == page);
}

TEST_CASE("the arrays of a report are the model's to float precision") {
  const TemporaryFolder folder;
  put_study(folder);
  REQUIRE(run(folder, "report organs.study.json --modes 3 -o page.html").status == 0);
  REQUIRE(run(folder, "model organs.study.json --variance 1 -o m.h5.json").status == 0);
  const ShapeModel model = read_model(folder.path / "m.h5.json").value();
  const Json data = data_of(page_in(folder, "page.html"));
  const std::vector<float> mean = floats_of(data["mean"]), modes = floats_of(data["mode_shapes"]);
  const auto size = static_cast<std::size_t>(model.mean.size());
  REQUIRE(mean.size() == size);
  REQUIRE(modes.size() == 3 * size);
  double farthest = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    farthest = std::max(farthest, std::abs(static_cast<double>(mean[i]) - model.mean[row]));
    for (Eigen::Index m = 0; m < 3; ++m)
      farthest = std::max(farthest, std::abs(static_cast<double>(modes[static_cast<std::size_t>(m) * size + i]) -
                                             model.basis(row, m) * std::sqrt(model.variances[m])));
  }
  CHECK(farthest < 1e-5);
  const std::vector<float> shapes = floats_of(data["shapes"]);
  REQUIRE(shapes.size() == 5 * size);
  for (std::size_t k = 0; k < 5; ++k) {
    CHECK(data["cases"][k]["modes"].size() == 3);
    for (Eigen::Index m = 0; m < 3; ++m)
      CHECK(
          data["cases"][k]["modes"][static_cast<std::size_t>(m)].get<double>() ==
          doctest::Approx(model.scores(m, static_cast<Eigen::Index>(k)) / std::sqrt(model.variances[m])).epsilon(1e-4));
  }
  const std::vector<unsigned char> faces = from_base64(data["faces"].get<std::string>());
  CHECK(faces.size() == static_cast<std::size_t>(model.topology->triangles().size()) * sizeof(std::uint16_t));
}

TEST_CASE("a report says which cases are left out and why") {
  const TemporaryFolder folder;
  put_study(folder);
  const Ran ran = run(folder, "report organs.study.json --without-doubtful -o page.html --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  CHECK(ran.json()["cases"] == 4);
  CHECK(ran.json()["left_out"] == 1);
  const std::string page = page_in(folder, "page.html");
  CHECK(page.find("left out: lies 3 mm off the label map") != std::string::npos);
  CHECK(page.find("1 case was left out: 1 (lies 3 mm off the label map)") != std::string::npos);
  CHECK(page.find("from 4 shapes") != std::string::npos);
  CHECK(page.find("Erdt M, Kirschner M, Wesarg S.") != std::string::npos);
  CHECK(page.find("homolog report organs.study.json --without-doubtful</code>") != std::string::npos);
}

TEST_CASE("a report lists cases that never became shapes") {
  const TemporaryFolder folder;
  put_study(folder);
  REQUIRE(write_whole_file(
      folder.path / "agreement.csv",
      "case,dice,failed\ne0,0.98,\ntorn-case,,\"homolog: masks/torn-case.nii.gz: is cut short, so it is left\"\n"
      "case 2,,odd\n"));
  const std::string report = "report organs.study.json --left-out agreement.csv -o page.html --json ";
  const Ran ran = run(folder, report);
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  CHECK(ran.json()["cases"] == 5);
  CHECK(ran.json()["left_out"] == 1);
  CHECK(ran.errors.find("agreement.csv: names case 2, which is among the shapes") != std::string::npos);
  const std::string page = page_in(folder, "page.html");
  CHECK(page.find("torn-case") != std::string::npos);
  CHECK(page.find("left out: is cut short, so it is left") != std::string::npos);
  CHECK(page.find("masks/torn-case.nii.gz") == std::string::npos);
  REQUIRE(run(folder, report + "--without-names").status == 0);
  CHECK(page_in(folder, "page.html").find("torn-case") == std::string::npos);
  REQUIRE(write_whole_file(folder.path / "agreement.csv", "case,dice\ne0,0.98\n"));
  check_refused(run(folder, report), "agreement.csv: has no column failed or reason");
}

TEST_CASE("a report without names numbers its cases") {
  const TemporaryFolder folder;
  put_study(folder);
  REQUIRE(run(folder, "report organs.study.json --without-names -o page.html").status == 0);
  const std::string page = page_in(folder, "page.html");
  CHECK(data_of(page)["cases"][1]["name"] == "case 2");
  CHECK(page.find("&lt;/script&gt;") == std::string::npos);
  REQUIRE(run(folder, "report organs.study.json -o page.html").status == 0);
  CHECK(page_in(folder, "page.html").find("&lt;/script&gt;") != std::string::npos);
  // Of several files the first one's name is a case's.
  std::string shapes;
  for (const auto& entry : fs::directory_iterator(folder.path))
    if (entry.path().extension() == ".ply") shapes += " " + entry.path().filename().string();
  REQUIRE(run(folder, "report" + shapes + " --without-names -o several.html").status == 0);
  CHECK(page_in(folder, "several.html").find("<h1>Shapes</h1>") != std::string::npos);
  // Nor of so few that the command would name them.
  fs::copy(folder.path / "e0.ply", folder.path / "Mueller.ply");
  REQUIRE(run(folder, "report Mueller.ply e1.ply e2.ply --without-names -o few.html").status == 0);
  CHECK(page_in(folder, "few.html").find("Mueller") == std::string::npos);
  CHECK(page_in(folder, "few.html").find("homolog report (3 files) --without-names") != std::string::npos);
}

TEST_CASE("a report of a model has its modes and the places of its training shapes") {
  const TemporaryFolder folder;
  put_study(folder);
  REQUIRE(run(folder, "model organs.study.json -o m.h5").status == 0);
  const Ran ran = run(folder, "report m.h5 --title \"Organs & more\" -o page.html --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  CHECK(ran.json()["cases"] == 5);
  const std::string page = page_in(folder, "page.html");
  CHECK(page.find("<h1>Organs &amp; more</h1>") != std::string::npos);
  CHECK(data_of(page)["generalisation_rms"].empty());
  CHECK(floats_of(data_of(page)["shapes"]).size() == 5 * floats_of(data_of(page)["mean"]).size());
}

TEST_CASE("a report refuses what is no model and options without effect") {
  const TemporaryFolder folder;
  put_study(folder);
  check_refused(run(folder, "report e0.ply -o page.html"), "needs at least two");
  REQUIRE(write_whole_file(folder.path / "one.study.json",
                           R"({"homolog_study":1,"cases":[{"name":"a","file":"e0.ply","state":"done"}]})"));
  check_refused(run(folder, "report one.study.json -o page.html"), "needs at least two");
  check_refused(run(folder, "report organs.study.json --modes 9 -o page.html"), "--modes 9");
  CHECK_FALSE(fs::exists(folder.path / "page.html"));
  REQUIRE(run(folder, "model organs.study.json -o m.h5").status == 0);
  CHECK(run(folder, "report m.h5 --keep-scale -o page.html").status == 2);
  CHECK(run(folder, "report organs.study.json -o page.png").status == 2);
  REQUIRE(run(folder, "convert e0.ply e0.particles").status == 0);
  REQUIRE(run(folder, "convert e1.ply e1.particles").status == 0);
  check_refused(run(folder, "report e0.particles e1.particles -o page.html"), "without faces");
}

TEST_CASE("a report has the values of a recipe along the first modes as measure gives them") {
  const TemporaryFolder folder;
  put_study(folder);
  REQUIRE(
      write_whole_file(folder.path / "size.recipe.json", R"({"homolog_recipe": 1, "name": "Size <&>", "measurements": [
    {"name": "content", "kind": "volume"},
    {"name": "to the apex", "kind": "distance", "from": {"kind": "landmark", "landmark": "apex"},
     "to": {"kind": "landmark", "landmark": "base"}}]})"));
  REQUIRE(run(folder, "model organs.study.json --keep-scale --variance 1 -o m.h5").status == 0);
  const Ran ran =
      run(folder, "report organs.study.json --keep-scale --modes 3 --recipe size.recipe.json -o page.html --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  CHECK(ran.json()["measurements"] == 2);
  CHECK(ran.errors.find("the model: has no landmark \"apex\", so to the apex is left empty") != std::string::npos);
  const std::string page = page_in(folder, "page.html");
  CHECK(page.find("by the recipe Size &lt;&amp;&gt;.") != std::string::npos);
  CHECK(page.find("standard deviations of each of its first 3 modes.") != std::string::npos);
  const Json content = data_of(page)["measurements"][0], apex = data_of(page)["measurements"][1];
  CHECK(content["unit"] == "ml");
  REQUIRE(content["values"].size() == 3);
  REQUIRE(content["values"][0].size() == 7);
  CHECK(apex["values"][0][3].is_null());
  CHECK(apex["texts"][0][3] == "\xe2\x80\x93");
  // −3…3: the middle five are those of measure.
  const Json along =
      run(folder, "measure e0.ply --recipe size.recipe.json --model m.h5 --modes 3 --json").json()["modes"];
  for (const Json& one : along) {
    const auto mode = one["mode"].get<std::size_t>() - 1;
    const auto at = static_cast<std::size_t>(one["sd"].get<double>() + 3);
    CHECK(content["values"][mode][at].get<double>() ==
          doctest::Approx(one["values"]["content"].get<double>()).epsilon(1e-4));
  }
  CHECK(content["values"][0][6] != content["values"][0][0]);

  // Of a model's file, and by the recipe beside a template.
  REQUIRE(run(folder, "convert e0.ply size.ply").status == 0);
  const Ran of_model = run(folder, "report m.h5 --template size.ply -o model.html --json");
  REQUIRE_MESSAGE(of_model.status == 0, of_model.errors);
  CHECK(of_model.json()["measurements"] == 2);
  CHECK(of_model.errors.find("has other vertices") == std::string::npos);
  // A template of another numbering lends nothing, and that is said.
  REQUIRE(write_mesh(icosphere(1, 20), folder.path / "other.ply"));
  const Ran other = run(folder, "report m.h5 --template other.ply --recipe size.recipe.json -o other.html");
  CHECK(other.status == 0);
  CHECK(other.errors.find("other.ply: has other vertices or faces than the model") != std::string::npos);
  check_refused(run(folder, "report m.h5 --template e1.ply -o none.html"), "has no recipe beside it");
  CHECK_FALSE(fs::exists(folder.path / "none.html"));
  CHECK(run(folder, "report organs.study.json -o plain.html").status == 0);
  CHECK(page_in(folder, "plain.html").find("id=\"measurements\"") == std::string::npos);
}

}  // namespace homolog
