// The command-line contract of docs/commands.md: score.
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/volume/volume_io.h"
#include "tests/command_line.h"
#include "tests/joint_cases.h"

namespace homolog {

namespace {

/// Seven subjects of two structures, as `fit SET` writes them, and as meshes of one.
void put_subjects(const TemporaryFolder& folder) {
  const std::vector<JointCase> cases{{-6, 0, 1, 0.9}, {2, 2, 1, 1.1},  {4, -1, 1, 1}, {-2, 1, 1, 1.2},
                                     {1, -2, 1, 0.8}, {3, 0, 1, 1.05}, {0, 0, 1, 1.6}};
  for (std::size_t k = 0; k < cases.size(); ++k) {
    const std::string name = "c" + std::to_string(k);
    const fs::path of_case = folder.path / (k < 6 ? "fits" : "new") / name;
    fs::create_directories(of_case);
    REQUIRE(write_mesh(lower_ellipsoid(cases[k]), of_case / "low.ply"));
    REQUIRE(write_mesh(upper_ellipsoid(cases[k]), of_case / "high.ply"));
    REQUIRE(write_mesh(upper_ellipsoid(cases[k]), folder.path / (name + ".ply")));
  }
}

/// A grid of 1 mm with room around points.
VolumeGeometry grid_around(const Points& points) {
  const Box box = bounds_of(points);
  VolumeGeometry grid;
  grid.origin_mm = box.min() - Vec3::Constant(12);
  const Vec3 size = (box.sizes() + Vec3::Constant(24)).array().ceil();
  grid.dims = {static_cast<int>(size.x()), static_cast<int>(size.y()), static_cast<int>(size.z())};
  return grid;
}

}  // namespace

TEST_CASE("a subject is scored against a model, alone as among others") {
  const TemporaryFolder folder;
  put_subjects(folder);
  REQUIRE(run(folder, "model c0.ply c1.ply c2.ply c3.ply c4.ply c5.ply --keep-scale -o m.h5 --variance 0.9").status ==
          0);
  const std::string model = read_whole_file(folder.path / "m.h5").value();
  const Ran both = run(folder, "score c2.ply c6.ply --model m.h5 -o scores --json");
  REQUIRE_MESSAGE(both.status == 0, both.errors);
  const Json usual = both.json()["subjects"][0], far = both.json()["subjects"][1];
  CHECK(usual["name"] == "c2");
  CHECK(usual["distance"].get<double>() < 1);
  CHECK(usual["percentile"].get<double>() < 60);
  CHECK(far["distance"].get<double>() > 2.5);
  CHECK(far["percentile"] == 100);
  CHECK(far["modes"].size() == both.json()["subjects"][0]["modes"].size());
  CHECK(run(folder, "score c6.ply --model m.h5 --json").json()["subjects"][0] == far);
  // The upper one of c6 is larger along its length: it lies outside of the mean there.
  const MeshFile scored = read_mesh_file(folder.path / "scores/c6.vtp").value();
  const VertexScalars& z = scored.arrays.at("z");
  CHECK(z.maxCoeff() > 2);
  CHECK((scored.arrays.at("z_high") - z).minCoeff() > 0);
  CHECK(lines(read_whole_file(folder.path / "scores/scores.csv").value()) == 3);
  CHECK(read_whole_file(folder.path / "m.h5").value() == model);
  // What was read is not written over.
  const std::string written = read_whole_file(folder.path / "scores/c6.vtp").value();
  check_refused(run(folder, "score scores/c6.vtp --model m.h5 -o scores"), "scores/c6.vtp");
  CHECK(read_whole_file(folder.path / "scores/c6.vtp").value() == written);
}

TEST_CASE("a shape of the model itself, other faces and options without effect are told") {
  const TemporaryFolder folder;
  put_subjects(folder);
  REQUIRE(run(folder, "model c0.ply c1.ply c2.ply c3.ply c4.ply -o m.h5 --modes 2").status == 0);
  const Ran both = run(folder, "score c2.ply c6.ply --model m.h5 --json");
  REQUIRE_MESSAGE(both.status == 0, both.errors);
  CHECK(both.errors.find("c2.ply: is itself a shape of the model") != std::string::npos);
  CHECK(both.errors.find("c6.ply") == std::string::npos);
  // As many vertices in other faces.
  MeshFile other = read_mesh_file(folder.path / "c6.ply").value();
  Triangles& faces = other.triangles.edit();
  for (Eigen::Index f = 0; f < faces.rows(); ++f)
    for (int k = 0; k < 3; ++k) faces(f, k) = static_cast<std::int32_t>(other.points.rows()) - 1 - faces(f, k);
  REQUIRE(write_mesh_file(other, folder.path / "other.ply"));
  check_refused(run(folder, "score other.ply --model m.h5 -o scores"), "other.ply: has other faces");
  CHECK_FALSE(fs::exists(folder.path / "scores"));
  const Ran mixed = run(folder, "score other.ply c6.ply --model m.h5 --json");
  CHECK(mixed.status == 0);
  CHECK(mixed.json()["subjects"].size() == 1);
  // Turned inside out they are the same.
  other = read_mesh_file(folder.path / "c6.ply").value();
  Triangles& turned = other.triangles.edit();
  turned.col(1).swap(turned.col(2));
  REQUIRE(write_mesh_file(other, folder.path / "turned.ply"));
  CHECK(run(folder, "score turned.ply --model m.h5").status == 0);
  check_refused(run(folder, "score c6.ply --model m.h5 --label 2"), "--label and --frame have no effect");
  check_refused(run(folder, "score c6.ply --model m.h5 --frame 0"), "--label and --frame have no effect");
}

TEST_CASE("a mirror image, another unit and another numbering are named") {
  const TemporaryFolder folder;
  // Bodies without a plane of symmetry.
  for (int k = 0; k < 6; ++k) {
    Mesh body = icosphere(3, 30);
    for (Eigen::Index i = 0; i < body.points.rows(); ++i) {
      const Vec3 p = body.points.row(i) / 30;
      body.points.row(i) =
          Vec3(40 * p.x() + 12 * p.y() * p.y() + 9 * p.z(), 25 * p.y() + 8 * p.x() * p.z() + 3 * k * p.z(),
               15 * p.z() + 7 * p.x() * p.y() + k * p.x())
              .transpose();
    }
    REQUIRE(write_mesh(body, folder.path / ("c" + std::to_string(k) + ".ply")));
  }
  REQUIRE(run(folder, "model c0.ply c1.ply c2.ply c3.ply c4.ply c5.ply -o m.h5").status == 0);
  const auto score = [&](const MeshFile& mesh, const std::string& options = "") {
    REQUIRE(write_mesh_file(mesh, folder.path / "new.ply"));
    return run(folder, "score new.ply --model m.h5 --json " + options);
  };
  const MeshFile usual = read_mesh_file(folder.path / "c3.ply").value();
  const Ran plain = score(usual);
  CHECK(plain.errors.empty());
  MeshFile changed = usual;
  changed.points.col(0) *= -1;
  const Ran mirrored = score(changed);
  CHECK(mirrored.errors.find("new.ply: looks like a mirror image of the model's mean") != std::string::npos);
  CHECK(mirrored.json()["subjects"][0]["distance"].get<double>() >
        3 * plain.json()["subjects"][0]["distance"].get<double>());
  const Ran flipped = score(changed, "--flip-mirrored");
  CHECK(flipped.json()["subjects"][0]["distance"].get<double>() ==
        doctest::Approx(plain.json()["subjects"][0]["distance"].get<double>()).epsilon(1e-6));
  changed = usual;
  changed.points /= 1000;
  CHECK(score(changed).errors.find("about 1000 times as small as the model's mean") != std::string::npos);
  changed = usual;
  changed.points = usual.points.colwise().reverse().eval();
  CHECK(score(changed).errors.find("has its vertices in another order than the model") != std::string::npos);
  changed = usual;
  changed.points.setZero();
  const Ran none = score(changed);
  CHECK(none.status == 1);
  CHECK(none.errors.find("has all its vertices in one place") != std::string::npos);
}

TEST_CASE("a folder of label maps is scored, each as the nearest shape that the model allows leads to") {
  const TemporaryFolder folder;
  put_subjects(folder);
  REQUIRE(run(folder, "model c0.ply c1.ply c2.ply c3.ply c4.ply c5.ply --keep-scale -o m.h5 --variance 0.95").status ==
          0);
  fs::create_directory(folder.path / "maps");
  for (const std::string name : {"c1", "c3"}) {
    const MeshFile shape = read_mesh_file(folder.path / (name + ".ply")).value();
    REQUIRE(write_volume(label_map({Topology::make(shape.points.rows(), shape.triangles).value(), shape.points},
                                   grid_around(shape.points), 1),
                         folder.path / "maps" / (name + ".nii.gz")));
  }
  const Ran ran = run(folder, "score maps --model m.h5 --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  REQUIRE(ran.json()["subjects"].size() == 2);
  for (const Json& one : ran.json()["subjects"]) {
    const Json mesh = run(folder, "score " + one["name"].get<std::string>() + ".ply --model m.h5 --json").json();
    CHECK(std::abs(one["distance"].get<double>() - mesh["subjects"][0]["distance"].get<double>()) < 0.4);
  }
}

TEST_CASE("a case of several structures is scored in all and in each") {
  const TemporaryFolder folder;
  put_subjects(folder);
  REQUIRE(run(folder, "model fits --structures low,high --alignment each --keep-scale -o m.h5").status == 0);
  const Ran ran = run(folder, "score new/c6 --model m.h5 --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  const Json parts = ran.json()["subjects"][0]["structures"];
  CHECK(parts[1]["name"] == "high");
  CHECK(parts[1]["z_rms"].get<double>() > 1.5);
  // Where both structures are in doubt they say less, as one alone does.
  for (const char* part : {"low", "high"}) {
    const fs::path file = folder.path / "new/c6" / (part + std::string(".ply"));
    MeshFile mesh = read_mesh_file(file).value();
    mesh.doubt_mm = VertexScalars::Constant(mesh.points.rows(), 5);
    REQUIRE(write_mesh_file(mesh, file));
  }
  const Json doubted = run(folder, "score new/c6 --model m.h5 --json").json()["subjects"][0]["structures"];
  CHECK(doubted[1]["z_rms"].get<double>() < 0.7 * parts[1]["z_rms"].get<double>());
}

TEST_CASE("a case that its study flips is scored flipped") {
  const TemporaryFolder folder;
  put_subjects(folder);
  REQUIRE(run(folder, "model c0.ply c1.ply c2.ply c3.ply c4.ply c5.ply --keep-scale -o m.h5").status == 0);
  Mesh other = upper_ellipsoid({0, 0, 1, 1.6});
  other.points.col(0).array() += 0.02 * other.points.col(0).array().square();
  REQUIRE(write_mesh(other, folder.path / "odd.ply"));
  REQUIRE(run(folder, "mirror odd.ply -o left.ply").status == 0);
  write_bytes(folder.path / "one.study.json",
              R"({"homolog_study":1,"cases":[{"name":"odd","file":"left.ply","flipped":true}]})");
  const auto score = [&](const std::string& what) {
    const Ran ran = run(folder, "score " + what + " --json");
    REQUIRE_MESSAGE(ran.status == 0, ran.errors);
    return ran.json()["subjects"];
  };
  const Json flipped = score("one.study.json --model m.h5")[0], right = score("odd.ply --model m.h5")[0];
  CHECK(flipped["distance"].get<double>() == doctest::Approx(right["distance"].get<double>()));
  CHECK(std::abs(score("left.ply --model m.h5")[0]["residual_mm"].get<double>() - right["residual_mm"].get<double>()) >
        0.1);
}

TEST_CASE("an image with landmarks is scored as the mesh that a fit to it with the model gives") {
  const TemporaryFolder folder;
  put_subjects(folder);
  REQUIRE(run(folder, "model c0.ply c1.ply c2.ply c3.ply c4.ply c5.ply --keep-scale -o m.h5 --variance 0.9").status ==
          0);
  const MeshFile truth = read_mesh_file(folder.path / "c6.ply").value();
  MeshFile marked = read_mesh_file(folder.path / "c1.ply").value();
  Json points = Json::array();
  for (const int vertex : {0, 3, 7, 11}) {
    const std::string name = "p" + std::to_string(vertex);
    marked.landmarks.push_back({name, marked.points.row(vertex)});
    const Vec3 at = truth.points.row(vertex);
    points.push_back({{"id", name}, {"label", name}, {"position", {at.x(), at.y(), at.z()}}});
  }
  REQUIRE(write_mesh_file(marked, folder.path / "t.ply"));
  const Json markups{{"type", "Fiducial"}, {"coordinateSystem", "LPS"}, {"controlPoints", points}};
  REQUIRE(write_whole_file(folder.path / "ct.mrk.json", Json{{"markups", {markups}}}.dump()));
  const VolumeGeometry grid = grid_around(truth.points);
  const Mesh organ{Topology::make(truth.points.rows(), truth.triangles).value(), truth.points};
  REQUIRE(write_volume(label_map(organ, grid, 100), folder.path / "ct.nii.gz"));

  const Ran ran = run(folder, "score ct.nii.gz --landmarks ct.mrk.json --template t.ply --model m.h5 -o scores --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  const Json of_image = ran.json()["subjects"][0];
  REQUIRE(run(folder, "fit t.ply --image ct.nii.gz --landmarks ct.mrk.json --model m.h5 -o fitted.ply").status == 0);
  const Json of_fit = run(folder, "score fitted.ply --model m.h5 --json").json()["subjects"][0];
  CHECK(of_image["distance"].get<double>() == doctest::Approx(of_fit["distance"].get<double>()).epsilon(1e-6));
  const Json of_truth = run(folder, "score c6.ply --model m.h5 --json").json()["subjects"][0];
  CHECK(of_image["distance"].get<double>() == doctest::Approx(of_truth["distance"].get<double>()).epsilon(0.15));
  CHECK(of_image["percentile"] == 100);
  const Ran verified = run(folder, "verify scores/ct.vtp --inputs .");
  CHECK_MESSAGE(verified.status == 0, verified.errors);

  CHECK(run(folder, "score ct.nii.gz --landmarks ct.mrk.json --model m.h5").status == 2);
  marked.landmarks.resize(2);
  REQUIRE(write_mesh_file(marked, folder.path / "t.ply"));
  CHECK(run(folder, "score ct.nii.gz --landmarks ct.mrk.json --template t.ply --model m.h5").status != 0);
}

TEST_CASE("what cannot be scored is named, and the rest goes on") {
  const TemporaryFolder folder;
  put_subjects(folder);
  REQUIRE(run(folder, "model c0.ply c1.ply c2.ply c3.ply -o m.h5").status == 0);
  REQUIRE(write_mesh(icosphere(1, 20), folder.path / "other.ply"));
  const Ran mixed = run(folder, "score other.ply absent.ply c5.ply --model m.h5 --json");
  REQUIRE(mixed.status == 0);
  CHECK(mixed.json()["subjects"].size() == 1);
  CHECK(mixed.errors.find("other.ply: has 42 vertices and the model 162") != std::string::npos);
  CHECK(mixed.errors.find("absent.ply") != std::string::npos);
  const Ran none = run(folder, "score other.ply --model m.h5");
  CHECK(none.status == 1);
  CHECK(none.errors.find("42 vertices") != std::string::npos);
}

}  // namespace homolog
