// The command-line contract of docs/commands.md: from label maps to a model, and the habits of all verbs.
#include <chrono>
#include <fstream>
#include <thread>

#include "core/mesh/construction/mirror.h"
#include "core/mesh/mesh_io.h"
#include "core/model/shapes/doubtful_shapes.h"
#include "core/model/shapes/shape_files.h"
#include "core/model/shapes/study.h"
#include "core/session/case_file.h"
#include "core/volume/volume_io.h"
#include "tests/command_line.h"
#include "tests/must.h"
#include "tests/shapes.h"

namespace homolog {

namespace {

/// Three kidneys: images and label maps in "scans".
struct Kidneys {
  TemporaryFolder folder;
  Kidneys() {
    for (const char* k : {"1", "2", "3"})
      REQUIRE(run(folder, std::string("phantom kidney --subject ") + k + " -o scans --quiet").status == 0);
  }
};

/// Ellipsoids in correspondence, in "shapes".
struct Ellipsoids {
  TemporaryFolder folder;
  explicit Ellipsoids(int count = 5) {
    fs::create_directory(folder.path / "shapes");
    for (int k = 0; k < count; ++k) write(k, shape(k));
  }
  static MeshFile shape(int k) {
    Mesh mesh = icosphere(2, 40);
    mesh.points.col(0) *= 1 + 0.1 * std::sin(k);
    mesh.points.col(1) += 0.003 * std::cos(2.0 * k) * mesh.points.col(2).cwiseAbs2();
    mesh.points.col(2) += 0.2 * std::sin(3.0 * k) * mesh.points.col(0);
    MeshFile file;
    file.points = mesh.points;
    file.triangles = mesh.topology->triangles();
    return file;
  }
  void write(int k, const MeshFile& file) const {
    REQUIRE(write_mesh_file(file, folder.path / "shapes" / ("k" + std::to_string(k) + ".ply")));
  }
};

}  // namespace

TEST_CASE("a folder of label maps becomes meshes and cases and a study that goes into a model") {
  const Kidneys kidneys;
  const TemporaryFolder& folder = kidneys.folder;
  const Ran fitted = run(folder, "fit built-in:kidney --mask scans -o fits --json");
  REQUIRE_MESSAGE(fitted.status == 0, fitted.errors);
  CHECK(fitted.json()["fitted"] == 3);  // the images are no cases
  CHECK(fitted.json()["study"] == "fits/fits.study.json");
  const StudyRead read = test::must(read_study(folder.path / "fits/fits.study.json"));
  REQUIRE(read.study.cases.size() == 3);
  CHECK(read.warnings.empty());
  const StudyCase& one = read.study.cases.front();
  CHECK(one.name == "kidney-1-labels");
  CHECK(one.labels == fs::weakly_canonical(folder.path / "scans/kidney-1-labels.nii.gz"));
  CHECK(one.from_scan);
  CHECK(!one.waits());
  // The case shows the mesh on its scan.
  const ShapesOfFile shapes = test::must(read_shapes_of(one.file));
  const MeshFile mesh = test::must(read_mesh_file(folder.path / "fits/kidney-1-labels.ply"));
  CHECK((test::must(shapes.shape({}, ""))->points - mesh.points).cwiseAbs().maxCoeff() < 1e-4);
  CHECK(test::must(read_case(one.file)).session.document().scan.image != nullptr);
  // A folder and a study are both shapes, each of them once.
  for (const char* from : {"fits", "fits/fits.study.json"}) {
    const Ran model = run(folder, std::string("model ") + from + " -o m.h5.json --json");
    REQUIRE_MESSAGE(model.status == 0, model.errors);
    CHECK(model.json()["shapes"] == 3);
  }
  CHECK(run(folder, "measure fits --json").json()["cases"].size() == 3);

  SUBCASE("a case that somebody worked on is kept and goes before its mesh") {
    auto opened = test::must(open_case(one.file));
    Points moved = *opened.session.document().view()->shape.points;
    moved.col(0).array() += 5;
    REQUIRE(opened.session.apply(points_edit(*opened.session.document().view(), moved, FoundBy::fit)));
    opened.session.close_journal();
    const Json sizes = run(folder, "measure fits --json").json();
    CHECK(sizes["cases"].size() == 3);
    const Ran again = run(folder, "fit built-in:kidney --mask scans -o fits --json");
    CHECK(again.errors.find("was worked on, so it stays") != std::string::npos);
    const auto kept = test::must(test::must(read_shapes_of(one.file)).shape({}, ""));
    CHECK((kept->points - mesh.points).col(0).mean() == doctest::Approx(5).epsilon(0.01));
    const Ran compared = run(folder, "observers fits fits/kidney-1-labels.ply --json");
    CHECK(compared.status != 2);
  }
}

TEST_CASE("study make takes a table with groups and covariates and what was fitted elsewhere") {
  const Kidneys kidneys;
  const TemporaryFolder& folder = kidneys.folder;
  REQUIRE(run(folder, "fit built-in:kidney --mask scans/kidney-2-labels.nii.gz -o two.ply --quiet").status == 0);
  std::ofstream(folder.path / "cases.csv")
      << "name,scan,mask,label,group,age,sex,file\n"
         "A,scans/kidney-1-image.nii.gz,scans/kidney-1-labels.nii.gz,1,healthy,63,f,\n"
         "B,,scans/kidney-2-labels.nii.gz,,\"ill, much\",70.5,,two.ply\n";
  const Ran made = run(folder, "study make cases.csv --template built-in:kidney -o k.study.json --json");
  REQUIRE_MESSAGE(made.status == 0, made.errors);
  CHECK(made.json()["cases"] == 2);
  CHECK(made.json()["waiting"] == 1);
  CHECK(made.json()["groups"] == Json::array({"healthy", "ill, much"}));
  const Study study = test::must(read_study(folder.path / "k.study.json")).study;
  CHECK(study.template_file == "built-in:kidney");
  CHECK(study.cases[0].waits());
  CHECK(study.cases[0].covariates["age"] == 63);
  CHECK(study.cases[0].covariates["sex"] == "f");
  CHECK(study.cases[0].label == 1);
  CHECK(study.cases[1].group == "ill, much");
  const auto shape = test::must(test::must(read_shapes_of(study.cases[1].file)).shape({}, ""));
  CHECK((shape->points - test::must(read_mesh_file(folder.path / "two.ply")).points).cwiseAbs().maxCoeff() < 1e-4);
  // Made again, nothing is doubled and what is known stays.
  CHECK(run(folder, "study make cases.csv --template built-in:kidney -o k.study.json --json").json()["added"] == 0);
  // A table that is wrong in its last row leaves no case behind.
  for (const std::string last : {"C,,scans/missing.nii.gz,,,,,\n", "A,,scans/kidney-2-labels.nii.gz,,,,,\n",
                                 "a/b,,scans/kidney-2-labels.nii.gz,,,,,\n"}) {
    CAPTURE(last);
    std::ofstream(folder.path / "wrong.csv") << "name,scan,mask,label,group,age,sex,file\n"
                                                "A,,scans/kidney-1-labels.nii.gz,,,,,\n" +
                                                    last;
    CHECK(run(folder, "study make wrong.csv --template built-in:kidney -o w.study.json").status == 1);
    CHECK_FALSE(fs::exists(folder.path / "w-cases"));
    CHECK_FALSE(fs::exists(folder.path / "w.study.json"));
  }
  const Ran folder_of_maps = run(folder, "study make scans --template built-in:kidney -o all.study.json --json");
  REQUIRE_MESSAGE(folder_of_maps.status == 0, folder_of_maps.errors);
  CHECK(folder_of_maps.json()["cases"] == 3);  // each image with its label map

  std::ofstream(folder.path / "wrong.csv") << "name,mask\nA,nowhere.nii.gz\n";
  check_refused(run(folder, "study make wrong.csv --template built-in:kidney -o w.study.json"), "row 1 of wrong.csv");
  CHECK(!fs::exists(folder.path / "w-cases"));
  CHECK(run(folder, "study make scans --template built-in:kidney -o k.json").status == 2);
}

TEST_CASE("study make refuses shapes and studies of another template and knows those of its mirror image") {
  const TemporaryFolder folder;
  for (const auto& [source, name] : {std::pair("built-in:kidney", "kidney"), {"built-in:vertebra", "vertebra"}})
    REQUIRE(run(folder, std::string("convert ") + source + " " + name + ".ply").status == 0);
  REQUIRE(run(folder, "mirror kidney.ply -o left.ply").status == 0);
  REQUIRE(run(folder, "phantom kidney --subject 1 -o p").status == 0);
  const auto table = [&](const std::string& name, const std::string& rows) {
    std::ofstream(folder.path / name) << "name,labels,file\n" << rows;
  };
  table("vertebra.csv", "A,p/kidney-1-labels.nii.gz,vertebra.ply\n");
  table("mesh.csv", "A,,vertebra.ply\n");
  table("kidney.csv", "A,p/kidney-1-labels.nii.gz,kidney.ply\n");
  table("left.csv", "A,p/kidney-1-labels.nii.gz,left.ply\n");
  const std::string of_kidney = " --template built-in:kidney -o s.study.json";
  for (const char* name : {"vertebra.csv", "mesh.csv"}) {
    CAPTURE(name);
    const Ran other = run(folder, std::string("study make ") + name + of_kidney);
    check_refused(other, "vertebra.ply");
    CHECK(other.errors.find("has other faces than built-in:kidney") != std::string::npos);
    CHECK(!fs::exists(folder.path / "s.study.json"));
  }
  REQUIRE(run(folder, "study make kidney.csv" + of_kidney).status == 0);
  // The study stays one of its template.
  const Ran mixed = run(folder, "study make p/kidney-1-labels.nii.gz --template built-in:vertebra -o s.study.json");
  check_refused(mixed, "s.study.json");
  CHECK(mixed.errors.find("is of the template built-in:kidney") != std::string::npos);
  CHECK(test::must(read_study(folder.path / "s.study.json")).study.cases.size() == 1);
  CHECK(run(folder, "study make kidney.csv --template kidney.ply -o s.study.json").status == 0);
  // Its faces are turned, so the template is that of the other side.
  REQUIRE(run(folder, "study make left.csv --template kidney.ply -o left.study.json").status == 0);
  const double left = run(folder, "measure left-cases --json").json()["cases"][0]["volume_ml"];
  CHECK(left == doctest::Approx(run(folder, "info kidney.ply --json").json()["volume_ml"].get<double>()).epsilon(1e-3));
}

TEST_CASE("study make refuses a case of another template and takes the structure that the study takes") {
  const TemporaryFolder folder;
  for (const auto& [source, name] : {std::pair("built-in:kidney", "kidney"), {"built-in:vertebra", "vertebra"}})
    REQUIRE(run(folder, std::string("convert ") + source + " " + name + ".ply").status == 0);
  REQUIRE(run(folder, "mirror kidney.ply -o left.ply").status == 0);
  const auto write = [&](const std::string& name, const std::string& text) {
    write_bytes(folder.path / name, text + "\n");
  };
  for (const std::string name : {"kidney", "vertebra", "left"}) {
    write(name + ".homolog", R"({"homolog":1,"template":")" + name + R"(.ply"})");
    write(name + ".csv", "name,file\nA," + name + ".homolog");
  }
  write("both.csv", "name,file\nA,kidney.homolog\nB,vertebra.homolog");
  const std::string of_kidney = " --template kidney.ply -o s.study.json";
  for (const char* name : {"vertebra.csv", "both.csv"}) {
    CAPTURE(name);
    const Ran other = run(folder, std::string("study make ") + name + of_kidney);
    check_refused(other, "vertebra.homolog: has other faces than kidney.ply");
    CHECK(!fs::exists(folder.path / "s.study.json"));
  }
  CHECK(run(folder, "study make kidney.csv" + of_kidney).status == 0);
  // A case of the other side is one of the template's mirror image.
  CHECK(run(folder, "study make left.csv --template kidney.ply -o left.study.json").status == 0);
  // A case that cannot be read is said by who reads its shapes.
  write("torn.homolog", R"({"homolog":1,"template":"absent.ply"})");
  write("torn.csv", "name,file\nA,torn.homolog");
  CHECK(run(folder, "study make torn.csv --template kidney.ply -o torn.study.json").status == 0);

  // Of two structures it is the first, unless the study says another one.
  write("two.homolog", R"({"homolog":2,"template":"vertebra.ply"})"
                       "\n"
                       R"({"structure":{"id":"s2","name":"kidney","template":"kidney.ply"}})");
  write("two.csv", "name,file,group\nA,two.homolog,old");
  check_refused(run(folder, "study make two.csv --template kidney.ply -o first.study.json"), "two.homolog");
  write("two.study.json",
        R"({"homolog_study":1,"template":"kidney.ply","cases":[{"name":"A","file":"two.homolog","structure":"s2"}]})");
  const Ran second = run(folder, "study make two.csv --template kidney.ply -o two.study.json");
  CHECK_MESSAGE(second.status == 0, second.errors);
  CHECK(test::must(read_study(folder.path / "two.study.json")).study.cases.at(0).group == "old");
}

TEST_CASE("study make leaves no case that waits with another template") {
  const TemporaryFolder folder;
  REQUIRE(run(folder, "phantom kidney --subject 1 -o p").status == 0);
  write_bytes(folder.path / "t.csv", "name,labels\nA,p/kidney-1-labels.nii.gz\n");
  REQUIRE(run(folder, "study make t.csv --template built-in:kidney -o s.study.json").status == 0);
  fs::remove(folder.path / "s.study.json");  // its cases stay
  check_refused(run(folder, "study make t.csv --template built-in:vertebra -o s.study.json"),
                "A.homolog: has other faces than built-in:vertebra");
  CHECK(run(folder, "study make t.csv --template built-in:kidney -o s.study.json").status == 0);
}

TEST_CASE("a model names doubtful and mirrored and faulty shapes and leaves them out where asked") {
  const Ellipsoids set(6);
  MeshFile doubtful = Ellipsoids::shape(1);
  doubtful.comments.push_back(doubt_comment("The fit is poor."));
  set.write(1, doubtful);
  MeshFile uncertain = Ellipsoids::shape(2);
  uncertain.doubt_mm = VertexScalars::Constant(uncertain.points.rows(), 30);
  set.write(2, uncertain);
  MeshFile turned = Ellipsoids::shape(3);
  turned.points.row(7) *= 0.2;  // through the others
  set.write(3, turned);
  const Ran warned = run(set.folder, "model shapes -o m.h5.json --json");
  REQUIRE_MESSAGE(warned.status == 0, warned.errors);
  CHECK(warned.json()["shapes"] == 6);
  CHECK(warned.json()["left_out"].empty());
  REQUIRE(warned.json()["doubtful"].size() >= 2);
  CHECK(warned.errors.find("shapes/k1.ply: The fit is poor.") != std::string::npos);
  CHECK(warned.errors.find("shapes/k2.ply: where along the surface its vertices belong is in doubt by 30.0 mm") !=
        std::string::npos);
  CHECK(warned.errors.find("--without-doubtful") != std::string::npos);
  const Ran left = run(set.folder, "model shapes --without-doubtful -o m.h5.json --json");
  REQUIRE_MESSAGE(left.status == 0, left.errors);
  CHECK(left.json()["doubtful"].empty());
  CHECK(left.json()["left_out"] == warned.json()["doubtful"]);
  CHECK(left.json()["shapes"] == 6 - left.json()["left_out"].size());
  CHECK(run(set.folder, "evaluate shapes --without-doubtful --samples 20 --json").json()["left_out"] ==
        left.json()["left_out"]);

  // Who looked at a case and found it done has the last word.
  const std::string cases =
      R"({"homolog_study":1,"cases":[{"name":"k0","file":"shapes/k0.ply"},{"name":"k3","file":"shapes/k3.ply"},)"
      R"({"name":"k4","file":"shapes/k4.ply"},{"name":"k2","file":"shapes/k2.ply")";
  for (const bool done : {false, true}) {
    write_bytes(set.folder.path / "s.study.json", cases + (done ? R"(,"state":"done"}]})" : "}]}"));
    const Json looked_at = run(set.folder, "model s.study.json --without-doubtful -o m.h5.json --json").json();
    const auto is_second = [](const Json& one) { return one["name"].get<std::string>().ends_with("k2.ply"); };
    const Json& left_out = looked_at["left_out"];
    CHECK(std::any_of(left_out.begin(), left_out.end(), is_second) != done);
  }

  // One of the other side: named as such, and left out or flipped.
  set.write(5, mirrored(Ellipsoids::shape(8)));
  const Json mixed = run(set.folder, "model shapes --without-doubtful -o m.h5.json --json").json();
  REQUIRE(mixed.contains("left_out"));
  const auto is_other_side = [](const Json& one) {
    return one["name"] == "shapes/k5.ply" && one["reason"].get<std::string>().find("mirror image") != std::string::npos;
  };
  CHECK(std::any_of(mixed["left_out"].begin(), mixed["left_out"].end(), is_other_side));
}

TEST_CASE("landmarks come into a template whose vertices stay") {
  const Ellipsoids set(1);
  std::ofstream(set.folder.path / "points.fcsv") << "# Markups fiducial file version = 4.11\n# CoordinateSystem = LPS\n"
                                                    "1,40,0,0,0,0,0,1,1,1,0,tip,,\n";
  const Ran made = run(set.folder, "template shapes/k0.ply --keep-vertices --landmarks points.fcsv -o t.ply --json");
  REQUIRE_MESSAGE(made.status == 0, made.errors);
  const MeshFile before = test::must(read_mesh_file(set.folder.path / "shapes/k0.ply"));
  const MeshFile after = test::must(read_mesh_file(set.folder.path / "t.ply"));
  CHECK(after.points == before.points);
  CHECK(after.triangles == before.triangles);
  REQUIRE(after.landmarks.size() == 1);
  CHECK(after.landmarks.front().name == "tip");
  CHECK(run(set.folder, "template shapes/k0.ply --keep-vertices --vertices 200 -o t.ply").status == 2);
}

TEST_CASE("VTK and VTP keep what a mesh has for each vertex") {
  const TemporaryFolder folder;
  MeshFile mesh = Ellipsoids::shape(0);
  const Eigen::Index n = mesh.points.rows();
  mesh.stiffness = std::make_shared<const VertexScalars>(VertexScalars::LinSpaced(n, 0.5, 2));
  mesh.doubt_mm = VertexScalars::LinSpaced(n, 0, 9);
  mesh.outlier = VertexScalars::Zero(n);
  (*mesh.outlier)[3] = 1;
  mesh.regions.list = {{"hilum", 2, {}}, {"pole", 3, {}}};
  mesh.regions.of_vertex.assign(static_cast<std::size_t>(n), 0);
  mesh.regions.of_vertex[5] = 2;
  REQUIRE(write_mesh_file(mesh, folder.path / "a.ply"));
  for (const std::string ending : {".vtk", ".vtp"}) {
    CAPTURE(ending);
    REQUIRE(run(folder, "convert a.ply a" + ending).status == 0);
    const MeshFile read = test::must(read_mesh_file(folder.path / ("a" + ending)));
    CHECK(read.points == mesh.points);
    CHECK(read.triangles == mesh.triangles);
    REQUIRE(read.stiffness);
    CHECK((*read.stiffness - *mesh.stiffness).cwiseAbs().maxCoeff() < 1e-6);
    REQUIRE(read.doubt_mm);
    CHECK((*read.doubt_mm - *mesh.doubt_mm).cwiseAbs().maxCoeff() < 1e-5);
    REQUIRE(read.outlier);
    CHECK(*read.outlier == *mesh.outlier);
    CHECK(read.regions.of_vertex == mesh.regions.of_vertex);
  }
}

TEST_CASE("a model holds no clock but SOURCE_DATE_EPOCH") {
  const Ellipsoids set;
  const auto model = [&](const char* epoch) {
    REQUIRE(run(set.folder, "model shapes -o m.h5.json --quiet", epoch).status == 0);
    return test::must(read_whole_file(set.folder.path / "m.h5.json"));
  };
  CHECK(model("env -u SOURCE_DATE_EPOCH ").find("buildTime") == std::string::npos);
  const std::string dated = model("env SOURCE_DATE_EPOCH=86400 ");
  CHECK(dated.find("1970-01-02T00:00:00Z") != std::string::npos);

  // Not in an HDF5 file either, whose objects keep the second at which they were made unless told otherwise.
  const auto written = [&](const std::string& name) {
    REQUIRE(run(set.folder, "model shapes -o " + name + " --quiet", "env -u SOURCE_DATE_EPOCH ").status == 0);
    return test::must(read_whole_file(set.folder.path / name));
  };
  const std::string first = written("first.h5");
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  CHECK(written("second.h5") == first);
}

TEST_CASE("a word that is no verb and a file that is not there are told apart") {
  const TemporaryFolder folder;
  const Ran verb = run(folder, "modell x.ply");
  CHECK(verb.status == 2);
  CHECK(verb.errors.find("did you mean \"model\"?") != std::string::npos);
  CHECK(run(folder, "studdy").errors.find("\"study\"") != std::string::npos);
  check_refused(run(folder, "absent.nii.gz"), "absent.nii.gz");
  const Ran option = run(folder, "fit --wobble a");
  CHECK(option.status == 2);
  CHECK(option.errors.find("see homolog fit --help") != std::string::npos);
  CHECK(run(folder, "study make --wobble").errors.find("see homolog study make --help") != std::string::npos);
  CHECK(run(folder, "help").out == run(folder, "--help").out);
  CHECK(run(folder, "help study make").out == run(folder, "study make --help").out);
  const Ran of_lab = run(folder, "corrupt map.nii.gz --count 2");
  CHECK(of_lab.status == 2);
  CHECK(of_lab.errors.find("homolog-lab corrupt --help") != std::string::npos);
  CHECK(run(folder, "fit built-in:kidney --mask m.nii.gz").errors.find("-o, --output is required") !=
        std::string::npos);
}

TEST_CASE("a built-in template is a file for info and convert and mirror") {
  const TemporaryFolder folder;
  const Json info = run(folder, "info built-in:spine:vertebrae_L3 --json").json();
  CHECK(info["closed"] == true);
  REQUIRE(run(folder, "convert built-in:kidney k.ply").status == 0);
  REQUIRE(run(folder, "mirror built-in:kidney -o left.ply").status == 0);
  const MeshFile right = test::must(read_mesh_file(folder.path / "k.ply"));
  const MeshFile left = test::must(read_mesh_file(folder.path / "left.ply"));
  CHECK((right.points.col(0) + left.points.col(0)).cwiseAbs().maxCoeff() < 1e-4);
  CHECK(turned_faces(left.triangles, right.triangles));
  const Ran none = run(folder, "fit built-in:liver --mask m.nii.gz -o l.ply");
  check_refused(none, "built-in:liver");
  for (const char* name : {"built-in:kidney", "built-in:vertebra", "built-in:ventricle", "built-in:spine"})
    CHECK(none.errors.find(name) != std::string::npos);
  // A format without landmarks is said.
  const Ran lost = run(folder, "convert k.ply k.vtk");
  CHECK(lost.errors.find("k.vtk: keeps no landmarks") != std::string::npos);
  CHECK(run(folder, "convert k.ply again.ply").errors.empty());
  CHECK(run(folder, "convert k.ply k.json").status == 1);
}

TEST_CASE("what is no case of a fit is said and is no input of its study") {
  const Kidneys kidneys;
  const TemporaryFolder& folder = kidneys.folder;
  fs::create_directories(folder.path / "empty");
  check_refused(run(folder, "fit built-in:kidney --mask empty -o e"), "empty: is an empty folder");
  check_refused(run(folder, "fit built-in:kidney --mask absent -o e"), "absent: does not exist");
  const Ran grey = run(folder, "fit built-in:kidney --mask scans/kidney-1-image.nii.gz -o g.ply");
  check_refused(grey, "looks like a grey image");
  fs::create_directories(folder.path / "places");
  for (const char* name : {"kidney-1-labels", "other"})
    std::ofstream(folder.path / "places" / (std::string(name) + ".json")) << "[]";
  REQUIRE(run(folder, "fit built-in:kidney --mask scans --landmarks places -o fits").status == 0);
  const Json record =
      Json::parse(read_whole_file(folder.path / "fits/fits.study.json").value())["homolog.record"]["options"];
  CHECK(record["--mask"].size() == 3);
  for (const Json& one : record["--mask"]) CHECK(one["file"].get<std::string>().ends_with("labels.nii.gz"));
  REQUIRE(record["--landmarks"][0]["files"].size() == 1);
  CHECK(record["--landmarks"][0]["files"][0]["file"] == "kidney-1-labels.json");
}

TEST_CASE("info shows the labels of any frame of a map") {
  const TemporaryFolder folder;
  Volume map;
  map.geometry.dims = {6, 6, 6};
  map.frames = 2;
  std::vector<std::uint8_t> voxels(432, 0);
  std::fill(voxels.begin() + 216 + 36, voxels.begin() + 216 + 72, std::uint8_t{3});
  std::fill(voxels.begin() + 36, voxels.begin() + 108, std::uint8_t{1});
  map.data = voxels;
  map.range_max = 3;
  REQUIRE(write_volume(map, folder.path / "map.nii.gz"));
  const auto labels = [&](const std::string& more) {
    return run(folder, "info map.nii.gz --json" + more).json()["labels"];
  };
  CHECK(labels("")[0]["value"] == 1);
  CHECK(labels(" --frame 1")[0]["value"] == 3);
  CHECK(labels(" --frame 1")[0]["voxels"] == 36);
  check_refused(run(folder, "info map.nii.gz --frame 2"), "has 2 frames");
  REQUIRE(write_mesh(icosphere(2, 40), folder.path / "ball.ply"));
  check_refused(run(folder, "info ball.ply --frame 1"), "--frame has no effect");
}

TEST_CASE("a mesh in correspondence is not written where it would lose it") {
  const Ellipsoids set(1);
  for (const char* out : {"x.stl", "x.txt", "x.nii"}) {
    CAPTURE(out);
    const Ran ran = run(set.folder, std::string("mirror shapes/k0.ply -o ") + out);
    CHECK(ran.status == 2);
    CHECK(lines(ran.errors) == 1);
    CHECK(run(set.folder, std::string("fit shapes/k0.ply --mesh shapes/k0.ply -o ") + out).status == 2);
    CHECK(run(set.folder, std::string("template shapes/k0.ply -o ") + out).status == 2);
    CHECK(!fs::exists(set.folder.path / out));
  }
  CHECK(run(set.folder, "convert shapes/k0.ply x.stl").status == 0);
  CHECK(run(set.folder, "fit shapes/k0.ply --mesh shapes/k0.ply -o out --quiet").status == 0);
  CHECK(fs::exists(set.folder.path / "out/k0.ply"));
}

TEST_CASE("a report without --json is a table in plain digits and --quiet prints none") {
  const Ellipsoids set(3);
  const Ran ran = run(set.folder, "measure shapes");
  REQUIRE(ran.status == 0);
  CHECK(ran.out.find("cases:\n  case  volume_ml  area_mm2  centroid_size_mm\n  k0 ") != std::string::npos);
  CHECK(ran.out.find('{') == std::string::npos);
  CHECK(ran.out.find("e-") == std::string::npos);
  const Ran quiet = run(set.folder, "measure shapes --quiet");
  CHECK(quiet.status == 0);
  CHECK(quiet.out.empty());
  CHECK(!run(set.folder, "measure shapes --quiet --json").json()["cases"].empty());
}

TEST_CASE("cancelling gives 130 and keeps what is finished, also where the signal comes twice at once") {
  const Ellipsoids set(5);
  const std::string at_once = "kill -TERM $p; sleep 0.05; kill -TERM $p; ";
  for (const std::string& by :
       {std::string("timeout --preserve-status -s INT 1 "), std::string("timeout --preserve-status -s TERM 1 "),
        "sh -c '\"$@\" & p=$!; sleep 1; " + at_once + "wait $p' sh "}) {
    CAPTURE(by);
    const Ran ran = run(set.folder, "evaluate shapes --samples 1000000 --modes all", by);
    CAPTURE(ran.errors);
    CHECK(ran.status == 130);
    CHECK(ran.errors.starts_with("homolog: "));
  }
}

TEST_CASE("info lists the labels of a map with their volumes and a label that is not there names those that are") {
  const Kidneys kidneys;
  const Json info = run(kidneys.folder, "info scans/kidney-1-labels.nii.gz --json").json();
  REQUIRE(info.contains("labels"));
  const Json& one = info["labels"][0];
  CHECK(one["value"] == 1);
  CHECK(one["name"].is_null());
  CHECK(one["volume_ml"].get<double>() > 50);
  CHECK(one["layer"] == 0);
  CHECK(!run(kidneys.folder, "info scans/kidney-1-image.nii.gz --json").json().contains("labels"));
  const Ran wrong = run(kidneys.folder, "template scans/kidney-1-labels.nii.gz --label 7 -o t.ply");
  check_refused(wrong, "label 7 does not occur in the label map; it holds 1");
}

TEST_CASE("every verb's help has two examples that its own options take and types that can be read") {
  const TemporaryFolder folder;
  for (const std::string verb : {"fit", "model", "study make", "template", "info", "picture modes"}) {
    CAPTURE(verb);
    const std::string help = run(folder, verb + " --help").out;
    const auto at = help.find("Examples:\n  homolog " + verb);
    REQUIRE(at != std::string::npos);
    CHECK(lines(help.substr(at)) >= 3);
    CHECK(help.find(":INT in") == std::string::npos);
    CHECK(help.find("NONNEGATIVE") == std::string::npos);
    CHECK(help.find("--jobs N (1 to 1024)") != std::string::npos);
  }
}

}  // namespace homolog
