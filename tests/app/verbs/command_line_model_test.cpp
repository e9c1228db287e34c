// The command-line contract of docs/commands.md: templates and models.
#include <cmath>
#include <fstream>

#include "core/base/numbers/random.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/construction/mirror.h"
#include "core/mesh/files/landmark_io.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/volume/volume_io.h"
#include "tests/command_line.h"
#include "tests/real_data.h"
#include "tests/shapes.h"
#include "tests/skip.h"

namespace homolog {

namespace {

/// Six ellipsoids in correspondence, k0.ply to k5.ply; gives their names, each after a space.
std::string put_training_set(const fs::path& folder) {
  std::string files;
  for (int k = 0; k < 6; ++k) {
    Mesh mesh = icosphere(2, 40);
    mesh.points.col(0) *= 1 + 0.1 * std::sin(k);
    mesh.points.col(1) += 0.003 * std::cos(2.0 * k) * mesh.points.col(2).cwiseAbs2();
    mesh.points.col(2) += 0.1 * std::sin(3.0 * k) * mesh.points.col(0);
    files += " k" + std::to_string(k) + ".ply";
    REQUIRE(write_mesh(mesh, folder / ("k" + std::to_string(k) + ".ply")));
  }
  return files;
}

}  // namespace

TEST_CASE("a training set becomes a model that info and evaluate know") {
  const TemporaryFolder folder;
  const std::string files = put_training_set(folder.path);
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
}

TEST_CASE("model --modes keeps so many modes") {
  const TemporaryFolder folder;
  const std::string files = put_training_set(folder.path);
  const Json all = run(folder, "model" + files + " --variance 1 -o all.h5 --json").json();
  const Ran made = run(folder, "model" + files + " --modes 2 -o two.h5 --json");
  REQUIRE_MESSAGE(made.status == 0, made.errors);
  CHECK(made.json()["modes"] == 2);
  // Of few shapes all variances are known as soon.
  CHECK(made.json()["variances"] == all["variances"]);
  CHECK(made.json()["explained"] == all["explained"]);
  CHECK(run(folder, "info two.h5 --json").json()["variances"].size() == 2);
  CHECK(run(folder, "verify two.h5 --json").json()["same"] == true);
  const Ran too_many = run(folder, "model" + files + " --modes 6 -o no.h5");
  CHECK(too_many.status == 1);
  CHECK(too_many.errors.find("--modes 6: is more than 6 shapes allow; the most is 5") != std::string::npos);
  CHECK(run(folder, "model" + files + " --modes 2 --variance 0.9 -o no.h5").status == 2);
  CHECK(run(folder, "model" + files + " --modes some -o no.h5").status == 2);
  CHECK(run(folder, "model" + files + " --modes 0 -o no.h5").status == 2);
  CHECK_FALSE(fs::exists(folder.path / "no.h5"));
}

TEST_CASE("model --modes parallel keeps as many modes as test finds above chance") {
  const TemporaryFolder folder;
  std::string files;
  for (int k = 0; k < 12; ++k) {
    Mesh ball = icosphere(2, 20);
    Random random(static_cast<std::uint64_t>(k) + 1);
    const double longer = 1 + 0.1 * std::sin(2.0 * k), wider = 1 + 0.1 * std::cos(5.0 * k);
    for (Eigen::Index v = 0; v < ball.points.rows(); ++v)
      ball.points.row(v) = Vec3(ball.points(v, 0), wider * ball.points(v, 1), longer * ball.points(v, 2)) +
                           0.1 * Vec3(random.normal(), random.normal(), random.normal());
    const std::string name = "b" + std::to_string(k) + ".ply";
    REQUIRE(write_mesh(ball, folder.path / name));
    files += " " + name;
  }
  const Ran made = run(folder, "model" + files + " --modes parallel -o m.h5 --json");
  REQUIRE_MESSAGE(made.status == 0, made.errors);
  CHECK(made.json()["modes"] == 2);
  CHECK(run(folder, "test" + files + " --formula \"size ~ shape\" --json").json()["modes"] == made.json()["modes"]);
  CHECK(run(folder, "verify m.h5 --json").json()["same"] == true);
}

TEST_CASE("model --optimise slides vertices and writes the meshes and what it gained") {
  const TemporaryFolder folder;
  const std::string files = put_training_set(folder.path);
  MeshFile marked = read_mesh_file(folder.path / "k2.ply").value();
  marked.landmarks = {{"tip", marked.points.row(7).transpose()}};
  REQUIRE(write_mesh_file(marked, folder.path / "k2.ply"));
  const Ran made = run(folder, "model" + files + " --optimise -o m.h5.json --json");
  REQUIRE_MESSAGE(made.status == 0, made.errors);
  const Json report = made.json()["optimise"];
  CHECK(report["after"]["bits"].get<double>() < report["before"]["bits"].get<double>());
  for (const std::string key : {"position_bits", "compactness", "generalization_rms", "specificity_rms"})
    CHECK(report["after"][key].get<double>() > 0);
  CHECK(report["turned_triangles"] == 0);
  CHECK(report["largest_slide_mm"].get<double>() > 0);
  CHECK(report["shapes"].size() == 6);
  CHECK(report["meshes"] == "m-optimised");
  const auto slid = read_mesh_file(folder.path / "m-optimised/k2.ply");
  REQUIRE(slid);
  CHECK(slid->points.row(7) == marked.points.row(7));
  CHECK(slid->points != marked.points);
  CHECK(slid->landmarks == marked.landmarks);
  const Ran again = run(folder, "model" + files + " --optimise --optimised there --jobs 1 -o n.h5.json --json");
  REQUIRE_MESSAGE(again.status == 0, again.errors);
  for (const char* name : {"k0.ply", "k5.ply"})
    CHECK(read_whole_file(folder.path / "m-optimised" / name).value() ==
          read_whole_file(folder.path / "there" / name).value());
  CHECK(run(folder, "model" + files + " --optimised there -o n.h5.json").status == 2);
  // The set itself is never written over.
  const auto before = read_whole_file(folder.path / "k2.ply").value();
  check_refused(run(folder, "model" + files + " --optimise --optimised . -o n.h5.json"), "another folder");
  CHECK(read_whole_file(folder.path / "k2.ply").value() == before);
}

TEST_CASE("template --consensus takes several subjects in any order") {
  const TemporaryFolder folder;
  put_training_set(folder.path);
  const Ran made = run(folder, "template --consensus k0.ply k1.ply k3.ply -o t.ply --vertices 300 --json");
  REQUIRE_MESSAGE(made.status == 0, made.errors);
  CHECK(made.json()["vertices"] == 300);
  CHECK(made.json()["subjects"] == 3);
  CHECK(made.json()["rounds"].get<int>() >= 1);
  CHECK(made.json()["moved_mm"].get<double>() > 0);
  CHECK(made.json()["closed"] == true);
  REQUIRE(run(folder, "template --consensus k3.ply k0.ply k1.ply -o u.ply --vertices 300 --jobs 1").status == 0);
  CHECK(read_whole_file(folder.path / "t.ply").value() == read_whole_file(folder.path / "u.ply").value());
  CHECK(run(folder, "template -o t.ply").status == 2);
  CHECK(run(folder, "template k0.ply --consensus k1.ply k3.ply -o t.ply").status == 2);
  check_refused(run(folder, "template --consensus k0.ply absent.ply -o t.ply"), "absent.ply");
}

TEST_CASE("template --best-of takes the subject whose template suits the others and none with a pit of its own") {
  const TemporaryFolder folder;
  for (int k = 0; k < 5; ++k) {
    Mesh one = icosphere(4, 40);
    for (Eigen::Index i = 0; i < one.points.rows(); ++i) {
      const Vec3 u = Vec3(one.points.row(i)).normalized();
      // Two have a deep pit that the others have not.
      const double pit = k == 1 || k == 3 ? 25 * std::exp(-60 * (u - Vec3(0, 0.6, 0.8)).squaredNorm()) : 0;
      Vec3 p = (40 - pit) * u;
      p.z() *= 1.3 + 0.03 * k;
      p.x() += 0.006 * p.y() * p.y();
      one.points.row(i) = p.transpose();
    }
    REQUIRE(write_mesh_file({one.points, one.topology->triangles()}, folder.path / ("s" + std::to_string(k) + ".ply")));
  }
  const Ran made = run(folder, "template --best-of s0.ply s1.ply s2.ply s3.ply s4.ply -o t.ply --vertices 500 --json");
  REQUIRE_MESSAGE(made.status == 0, made.errors);
  const auto report = made.json();
  const std::string best = report["subject"];
  CHECK((best == "s0" || best == "s2" || best == "s4"));
  CHECK(report["subjects"] == 5);
  CHECK(report["candidates"].size() == 5);
  double best_assd_mm = 0;
  for (const auto& one : report["candidates"])
    if (one["subject"] == best) best_assd_mm = one["assd_mm"];
  CHECK(best_assd_mm > 0);
  for (const auto& one : report["candidates"]) {
    CHECK(one["fits"] == 4);
    const bool has_pit = one["subject"] == "s1" || one["subject"] == "s3";
    INFO(one.dump());
    CHECK(one["doubtful"] == (has_pit ? 3 : 2));  // each is in doubt where the other kind is fitted
    if (!has_pit) CHECK(one["assd_mm"].get<double>() >= best_assd_mm);
  }
  // It is that subject's own template, whatever the order and the number of threads.
  REQUIRE(run(folder, "template " + best + ".ply -o own.ply --vertices 500").status == 0);
  CHECK(without_record(read_whole_file(folder.path / "t.ply").value()) ==
        without_record(read_whole_file(folder.path / "own.ply").value()));
  REQUIRE(
      run(folder, "template --best-of s4.ply s3.ply s0.ply s1.ply s2.ply -o u.ply --vertices 500 --jobs 1").status ==
      0);
  CHECK(read_whole_file(folder.path / "t.ply").value() == read_whole_file(folder.path / "u.ply").value());
  check_refused(run(folder, "template --best-of s0.ply s1.ply -o v.ply"), "name three or more");
  CHECK(run(folder, "template --best-of s0.ply s1.ply s2.ply --consensus s3.ply s4.ply -o v.ply").status == 2);
  CHECK(run(folder, "template s0.ply --flip-mirrored -o v.ply").status == 2);
}

TEST_CASE("a subject of five times the others' volume is named with both volumes and no other is") {
  const TemporaryFolder folder;
  std::string files;
  for (int k = 0; k < 6; ++k) {
    Mesh one = icosphere(3, k == 5 ? 70 : 40 + k);
    one.points.col(2) *= 1.3;
    const std::string name = "s" + std::to_string(k) + ".ply";
    REQUIRE(write_mesh_file({one.points, one.topology->triangles()}, folder.path / name));
    files += " " + name;
  }
  const Ran made = run(folder, "template --consensus" + files + " -o t.ply --vertices 300");
  INFO(made.errors);
  CHECK(made.errors.find("s5: has a volume of 1852 ml, and most others about 400 ml;") != std::string::npos);
  CHECK(made.errors.find(": has a volume") == made.errors.rfind(": has a volume"));
}

TEST_CASE("template --parts all keeps an organ in two pieces and its fits go to both") {
  const TemporaryFolder folder;
  VolumeGeometry grid;
  grid.dims = {90, 60, 60};
  grid.origin_mm = Vec3(-44.5, -29.5, -29.5);
  for (int k = 0; k < 2; ++k) {
    Mesh left = icosphere(3, 15 + k), right = icosphere(3, 11 - k);
    left.points.col(2) *= 1.3;
    right.points.col(1) *= 1.4;
    left.points.col(0).array() -= 22;
    right.points.col(0).array() += 20 + 2 * k;
    Volume both = label_map(left, grid, 1);
    const Volume other = label_map(right, grid, 1);
    auto& voxels = std::get<std::vector<std::uint8_t>>(both.data);
    for (std::size_t v = 0; v < voxels.size(); ++v) voxels[v] |= std::get<std::vector<std::uint8_t>>(other.data)[v];
    REQUIRE(write_volume(both, folder.path / ("s" + std::to_string(k) + ".nii")));
  }
  const Ran one = run(folder, "template s0.nii -o one.ply --vertices 900");
  REQUIRE(one.status == 0);
  CHECK(one.errors.find("--parts all") != std::string::npos);
  const Ran made = run(folder, "template s0.nii -o t.ply --vertices 900 --parts all --json");
  INFO(made.errors);
  REQUIRE(made.status == 0);
  CHECK(made.errors == "");
  CHECK(made.json()["components"] == 2);
  // All parts count for such a template without a word.
  const Ran fitted = run(folder, "fit t.ply --mask s1.nii -o f.ply --json");
  INFO(fitted.errors);
  REQUIRE(fitted.status == 0);
  const Json report = fitted.json();
  CHECK(report["doubtful"] == false);
  CHECK(report["dice_raw"].get<double>() > 0.97);
  CHECK(report["parts_left_out"]["count"] == 0);
  CHECK(report["self_intersections"] == 0);
  const Ran refused = run(folder, "template --consensus s0.nii s1.nii -o c.ply --parts all");
  CHECK(refused.status == 2);
  CHECK(refused.errors.find("--parts") != std::string::npos);
}

TEST_CASE("mirror images among the subjects of a consensus are named, or flipped where asked") {
  const TemporaryFolder folder;
  for (int k = 0; k < 3; ++k) {
    Mesh one = icosphere(3, 40);
    one.points.col(2) *= 1.3 + 0.05 * k;
    for (Eigen::Index i = 0; i < one.points.rows(); ++i) {
      auto p = one.points.row(i);
      p.x() += 0.01 * p.y() * p.z() + 0.006 * p.y() * p.y();  // no plane of symmetry
    }
    const MeshFile file{one.points, one.topology->triangles()};
    REQUIRE(write_mesh_file(k == 1 ? mirrored(file) : file, folder.path / ("s" + std::to_string(k) + ".ply")));
  }
  const std::string verb = "template --consensus s0.ply s1.ply s2.ply -o t.ply --vertices 300 --json";
  const Ran asked = run(folder, verb + " --flip-mirrored"), plain = run(folder, verb);
  REQUIRE_MESSAGE(plain.status == 0, plain.errors);
  CHECK(plain.errors.find("s1: looks like a mirror image of most others") != std::string::npos);
  CHECK(plain.errors.find("--flip-mirrored") != std::string::npos);
  CHECK(plain.errors.find("s0: looks") == std::string::npos);
  REQUIRE_MESSAGE(asked.status == 0, asked.errors);
  CHECK(asked.errors.find("looks like a mirror image") == std::string::npos);
}

TEST_CASE("studies of templates and experts report landmarks by name and the script prints their tables") {
  const TemporaryFolder folder;
  put_training_set(folder.path);
  fs::create_directory(folder.path / "bones");
  for (const char* name : {"k0", "k1", "k3"}) {
    const auto shape = read_mesh_file(folder.path / (std::string(name) + ".ply"));
    REQUIRE(shape);
    const std::vector<Landmark> landmarks{{"tip", shape->points.row(7).transpose()},
                                          {"side", shape->points.row(90).transpose()}};
    REQUIRE(write_landmarks(landmarks, folder.path / "bones" / (std::string(name) + ".mrk.json")));
    fs::copy_file(folder.path / (std::string(name) + ".ply"), folder.path / "bones" / (std::string(name) + ".ply"));
  }
  const std::string files = " bones/k0.ply bones/k1.ply bones/k3.ply --landmarks bones ";
  const Ran bias = run(folder, "study bias" + files + "--vertices 200 --json");
  REQUIRE_MESSAGE(bias.status == 0, bias.errors);
  CHECK(bias.json()["spread_mm"]["mean"].get<double>() > 0);
  CHECK(bias.json()["spread_of_mm"].contains("tip"));
  CHECK(bias.json()["rv"].get<double>() <= 1);
  CHECK(run(folder, "study bias" + files + "--vertices 200 --json --jobs 1").out == bias.out);

  REQUIRE(write_whole_file(folder.path / "bones/raters.csv", "landmark,mm\ntip,1.25\n"));
  const Ran experts =
      run(folder, "study experts" + files + "--raters bones/raters.csv --shown side --vertices 200 -o out --json");
  REQUIRE_MESSAGE(experts.status == 0, experts.errors);
  CHECK(experts.json()["methods"].size() == 8);
  CHECK(experts.json()["landmarks"].size() == 1);
  CHECK(experts.json()["landmarks"][0]["raters_mm"] == 1.25);
  REQUIRE(write_whole_file(folder.path / "bones/wrong.csv", "landmark,mm\ntip,1.25\nside;2\n"));
  check_refused(run(folder, "study experts" + files + "--raters bones/wrong.csv --vertices 200"), "line 3");
  REQUIRE(write_whole_file(folder.path / "bones/wrong.csv", "tip,-1.25\nside,2\n"));
  check_refused(run(folder, "study experts" + files + "--raters bones/wrong.csv --vertices 200"), "line 1");
  REQUIRE(write_whole_file(folder.path / "bones/wrong.csv", "tip,1.25\n\"tip\",2\n"));
  check_refused(run(folder, "study experts" + files + "--raters bones/wrong.csv --vertices 200"), "twice");
  CHECK(fs::exists(folder.path / experts.json()["worst"]["mesh"].get<std::string>()));
  check_refused(run(folder, "study experts k0.ply k2.ply --landmarks bones"), "k2");
}

TEST_CASE("the script of the experts' tables takes surfaces and landmarks of several formats") {
  const TemporaryFolder folder;
  put_training_set(folder.path);
  const fs::path bones = folder.path / "some bones";
  fs::create_directory(bones);
  const auto put = [&](const char* name, const char* surface, const char* landmarks) {
    const auto shape = read_mesh_file(folder.path / (std::string(name) + ".ply"));
    REQUIRE(shape);
    REQUIRE(write_mesh_file(*shape, bones / (name + std::string(surface))));
    REQUIRE(write_landmarks({{"tip", shape->points.row(7).transpose()}}, bones / (name + std::string(landmarks))));
  };
  put("k0", ".ply", ".mrk.json");
  put("k1", ".stl", ".fcsv");
  put("k3", ".obj", ".json");
  fs::copy_file(folder.path / "k0.ply", bones / "without_landmarks.ply");
  const auto tables = [&] {
    const std::string script = "cd '" + folder.path.string() +
                               "' && env -u DISPLAY HOMOLOG='" HOMOLOG_PROGRAM "' '" HOMOLOG_SOURCE_DIR
                               "/scripts/benchmark-experts.sh' 'some bones' --vertices 200 --templates 1 > tables";
    REQUIRE(std::system(script.c_str()) == 0);
    return read_whole_file(folder.path / "tables").value();
  };
  const std::string unrated = tables();
  CHECK(unrated.find("| k0 | point drift |") != std::string::npos);
  CHECK(unrated.find("| landmark | fit |") != std::string::npos);
  CHECK(unrated.find("Worst fit: ") != std::string::npos);
  CHECK((fs::exists(folder.path / "benchmark-experts" / "worst.png") ||
         unrated.find("no picture of it could be drawn") != std::string::npos));
  REQUIRE(write_whole_file(bones / "raters.csv", "landmark,mm\ntip,1.25\n"));
  const std::string rated = tables();
  CHECK(rated.find("| landmark | raters | fit |") != std::string::npos);
  CHECK(rated.find("| tip | 1.25 |") != std::string::npos);
}

TEST_CASE("the modes of a model are drawn at the size asked for") {
  const TemporaryFolder folder;
  REQUIRE(run(folder, "model" + put_training_set(folder.path) + " -o m.h5").status == 0);
  const Ran picture = run(folder, "picture modes m.h5 -o modes.png --size 300x200 --json");
  if (cannot_draw(picture)) return;
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
  CHECK(ran.json()["missed"]["share"].get<double>() < 0.05);
  CHECK(std::abs(ran.json()["volume_ml"].get<double>() / ran.json()["label_ml"].get<double>() - 1) < 0.03);
}

TEST_CASE("a tube that lacks a part of its label says so and what is propagated from it is in doubt") {
  const TemporaryFolder folder;
  REQUIRE(run(folder, "phantom ventricle --subject 1 -o .").status == 0);
  const std::string tube = "template ventricle-1-labels.nii.gz --label 1 --tube --rings 12 --sectors 20 --json ";
  REQUIRE(run(folder, tube + "-o t.ply").status == 0);
  const Points whole = read_mesh(folder.path / "t.ply").value().points;
  const Eigen::RowVector3d apex = whole.row(12 * 20), end = whole.topRows(20).colwise().mean();
  const Eigen::RowVector3d base = end + 0.35 * (apex - end);
  const auto text = [](const Eigen::RowVector3d& p) {
    return std::to_string(p[0]) + "," + std::to_string(p[1]) + "," + std::to_string(p[2]);
  };
  const Ran cut = run(folder, tube + "-o cut.ply --base=" + text(base) + " --apex=" + text(apex));
  REQUIRE_MESSAGE(cut.status == 0, cut.errors);
  const double share = cut.json()["missed"]["share"].get<double>();
  CHECK(share > 0.3);
  CHECK(cut.errors.find(std::to_string(std::lround(100 * share)) +
                        " % of label 1 is not in the template; give its --axis") != std::string::npos);

  const Ran carried = run(folder, "propagate cut.ply --image ventricle-1-image.nii.gz --frame 0 -o beat --json");
  REQUIRE_MESSAGE(carried.status == 0, carried.errors);
  CHECK(carried.json()["doubtful"].size() == carried.json()["frames"].size());
  CHECK(carried.json()["frames"][3]["doubt"].get<std::string>().starts_with("comes from a template that lacks "));
  CHECK(carried.errors.find("cut.ply: every frame comes from a template that lacks") != std::string::npos);
}

}  // namespace homolog
