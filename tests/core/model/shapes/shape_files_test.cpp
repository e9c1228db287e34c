#include "core/model/shapes/shape_files.h"
#include "core/catalogue/catalogue.h"
#include "core/model/shapes/shape_folder.h"

#include <doctest/doctest.h>

#include "core/base/files/files.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/construction/mirror.h"
#include "core/mesh/mesh_quality.h"
#include "core/model/files/model_files.h"
#include "core/model/measures/groups.h"
#include "core/model/shapes/case_of_shape.h"
#include "core/model/shapes/study.h"
#include "core/model/training_set.h"
#include "core/session/case_file.h"
#include "core/volume/volume_io.h"
#include "tests/must.h"
#include "tests/temporary_folder.h"

namespace fs = std::filesystem;
using namespace homolog;

namespace {

/// An organ without any symmetry, one of a family.
MeshFile lopsided_organ(int number) {
  const Mesh ball = icosphere(2, 30);
  MeshFile file{ball.points, ball.topology->triangles()};
  const double k = 0.05 * number;
  for (Eigen::Index v = 0; v < file.points.rows(); ++v) {
    const Vec3 p = ball.points.row(v);
    file.points.row(v) << p.x() + 0.01 * p.y() * p.y() + k * p.z(), 1.5 * p.y() + 0.01 * p.x() * p.z(),
        (2 + k) * p.z() + 0.01 * p.x() * p.y();
  }
  return file;
}

/// A cine of four frames without voxels to speak of.
std::shared_ptr<const Volume> empty_cine() {
  auto volume = std::make_shared<Volume>();
  volume->geometry.dims = {2, 2, 2};
  volume->frames = 4;
  volume->data = std::vector<std::int16_t>(32, 0);
  return volume;
}

struct ShapeFolder : TemporaryFolder {
  fs::path write(const MeshFile& mesh, const std::string& name) const {
    REQUIRE(write_mesh_file(mesh, path / name));
    return path / name;
  }
  /// A case of the template lopsided_organ(0) in which the points of another organ were found.
  fs::path write_case(int number, const std::string& name) const {
    const fs::path reference = write(lopsided_organ(0), "template.ply");
    EditSession session =
        create_case(new_document("", nullptr, load_template(reference.string()).value()), path / name).value();
    REQUIRE(session.apply(SetPoints{FoundBy::fit, {}, std::make_shared<const Points>(lopsided_organ(number).points)}));
    return path / name;
  }
};

}  // namespace

TEST_CASE("a case file gives its current mesh to a training set beside meshes") {
  const ShapeFolder files;
  const TrainingSetRead read =
      read_training_set({files.write(lopsided_organ(1), "one.ply"), files.write_case(2, "two.homolog")}).value();
  CHECK(read.warnings.empty());
  REQUIRE(read.set.shapes.cols() == 2);
  CHECK(points_of(read.set.shapes, 0) == lopsided_organ(1).points);
  CHECK(points_of(read.set.shapes, 1) == lopsided_organ(2).points);
  CHECK(shape_names(read.set.names) == std::vector<std::string>{"one", "two"});
}

TEST_CASE("of a cine the frames that were edited are shapes and without asking the one it shows") {
  Document document = new_document("", empty_cine(), make_template(lopsided_organ(0), "organ.ply").value());
  EditSession session(std::move(document));
  for (const int frame : {1, 3}) {
    REQUIRE(session.apply(SetFrame{frame}));
    REQUIRE(session.apply(SetPoints{FoundBy::fit, {}, std::make_shared<const Points>(lopsided_organ(frame).points)}));
  }
  REQUIRE(session.apply(SetFrame{2}));
  REQUIRE(session.apply(SetFrame{3}));
  const ShapesOfFile shapes = shapes_of(session.document());
  CHECK(shapes.shown == 3);
  CHECK(shapes.structure({})->edited == std::vector<int>{1, 3});
  CHECK(shapes.shape({}, "heart").value()->points == lopsided_organ(3).points);
  CHECK(shapes.shape({{}, 1}, "heart").value()->points == lopsided_organ(1).points);
  const auto none = shapes.shape({{}, 7}, "heart");
  REQUIRE(!none);
  CHECK(none.error().sentence() == "heart: has no mesh at frame 7 yet; place a template in it first");
  CHECK(shape_names({"a/heart.homolog frame 1", "b/heart.homolog frame 1"}) ==
        std::vector<std::string>{"a-heart frame 1", "b-heart frame 1"});
}

TEST_CASE("each structure of a case gives its own shapes") {
  const ShapeFolder files;
  const fs::path path = files.path / "two.homolog";
  {
    const fs::path organ = files.write(lopsided_organ(0), "organ.ply"),
                   other = files.write(lopsided_organ(5), "other.ply");
    EditSession made = test::must(create_case(new_document("", nullptr, load_template(organ.string()).value()), path));
    REQUIRE(made.apply(SetStructure{.id = "s2", .name = "other", .source = other.string()}));
    REQUIRE(
        made.apply(SetPoints{FoundBy::fit, {}, std::make_shared<const Points>(lopsided_organ(6).points)}, false, "s2"));
  }
  const ShapesOfFile shapes = test::must(read_shapes_of(path));
  CHECK(shapes.structure("s2")->edited == std::vector<int>{0});
  CHECK(shapes.structure({})->edited.empty());
  CHECK(shapes.shape({"s2", 0}, "two").value()->points == lopsided_organ(6).points);
  CHECK(shapes.shape({"s1", 0}, "two").value()->points == shapes.shape({{}, 0}, "two").value()->points);
  const auto none = shapes.shape({"s9", {}}, "two");
  REQUIRE(!none);
  CHECK(none.error().sentence() == "two: has no structure \"s9\"; correct the study, or choose another file");

  Study study;
  study.cases.push_back({"plain", files.write(lopsided_organ(7), "plain.ply")});
  StudyCase of_second{"second", path, 0};
  of_second.structure = "s2";
  study.cases.push_back(of_second);
  const fs::path file = files.path / "s.study.json";
  REQUIRE(write_study(study, file));
  const TrainingSetRead read = test::must(read_training_set({file}));
  REQUIRE(read.set.shapes.cols() == 2);
  CHECK(points_of(read.set.shapes, 1) == lopsided_organ(6).points);
  CHECK(shape_names(read.set.names) == std::vector<std::string>{"plain", "two structure s2 frame 0"});
}

TEST_CASE("the shapes of a cine's case need no voxel of its image") {
  for (const char* name : {"cine.nii", "cine.nrrd", "cine.mha"}) {
    CAPTURE(name);
    const ShapeFolder files;
    const fs::path image = files.path / name, file = files.path / "heart.homolog";
    REQUIRE(write_volume(*empty_cine(), image));
    const fs::path reference = files.write(lopsided_organ(0), "template.ply");
    {
      auto whole = std::make_shared<const Volume>(std::move(read_volume(image)->volume));
      EditSession session =
          create_case(new_document(image.string(), whole, load_template(reference.string()).value()), file).value();
      REQUIRE(session.apply(SetFrame{3}));
      REQUIRE(session.apply(SetPoints{FoundBy::fit, {}, std::make_shared<const Points>(lopsided_organ(3).points)}));
    }
    fs::resize_file(image, fs::file_size(image) - 8);
    CHECK_FALSE(read_case(file));
    const auto shapes = read_shapes_of(file);
    REQUIRE(shapes);
    CHECK(shapes->shown == 3);
    CHECK(shapes->structure({})->edited == std::vector{3});
    CHECK((*shapes->shape({{}, 3}, ""))->points == lopsided_organ(3).points);
  }
}

TEST_CASE("a case with edits of a hand was worked on, also where it has no fit, and one that only waits was not") {
  const ShapeFolder files;
  const fs::path reference = files.write(lopsided_organ(0), "template.ply"), file = files.path / "a.homolog";
  {
    EditSession session =
        test::must(create_case(new_document("", nullptr, load_template(reference.string()).value()), file));
    CHECK_FALSE(was_worked_on(file));
    REQUIRE(session.apply(Note{"the window", {}, {}}));
    CHECK_FALSE(was_worked_on(file));
    REQUIRE(session.apply(SetPoints{FoundBy::fit, {}, std::make_shared<const Points>(lopsided_organ(3).points)}));
    CHECK(was_worked_on(file));
    CHECK_FALSE(goes_on_after_fit(file));
    REQUIRE(session.apply(Note{"fit", {}, {}}));
    CHECK_FALSE(was_worked_on(file));
    REQUIRE(
        session.apply(SetPoints{PointsFinder("hand"), {}, std::make_shared<const Points>(lopsided_organ(2).points)}));
  }
  CHECK(was_worked_on(file));
  CHECK(goes_on_after_fit(file));
}

TEST_CASE("all frames of a study's cines keep the groups of their cases") {
  const ShapeFolder files;
  const fs::path image = files.path / "cine.nii", reference = files.write(lopsided_organ(0), "template.ply");
  REQUIRE(write_volume(*empty_cine(), image));
  Study study;
  for (const int k : {0, 1}) {
    const std::string name = "heart" + std::to_string(k);
    const fs::path file = files.path / (name + ".homolog");
    auto whole = std::make_shared<const Volume>(std::move(read_volume(image)->volume));
    EditSession session =
        create_case(new_document(image.string(), whole, load_template(reference.string()).value()), file).value();
    for (const int frame : {1, 3}) {
      REQUIRE(session.apply(SetFrame{frame}));
      REQUIRE(session.apply(
          SetPoints{FoundBy::fit, {}, std::make_shared<const Points>(lopsided_organ(1 + 2 * k + frame).points)}));
    }
    study.cases.push_back({name, file, {}, k == 0 ? "healthy" : "ill"});
  }
  const fs::path path = files.path / "s.study.json";
  REQUIRE(write_study(study, path));
  TrainingOptions all;
  all.all_frames = true;
  const TrainingSetRead read = test::must(read_training_set({path}, all));
  CHECK(read.groups == std::vector<std::string>{"healthy", "healthy", "ill", "ill"});
  REQUIRE(read.study_keys.size() == 4);
  CHECK(read.study_keys[0] == read.study_keys[1]);
  CHECK(read.study_keys[1] != read.study_keys[2]);
}

TEST_CASE("a study stands for its cases and a group for those that belong to it") {
  const ShapeFolder files;
  Study study;
  for (int k = 0; k < 4; ++k) {
    const std::string name = "case" + std::to_string(k);
    study.cases.push_back({name, files.write(lopsided_organ(k), name + ".ply"), {}, k < 2 ? "healthy" : "ill"});
  }
  const fs::path path = files.path / "s.study.json";
  REQUIRE(write_study(study, path));
  CHECK(read_training_set({path}).value().set.shapes.cols() == 4);
  TrainingOptions ill;
  ill.group = "ill";
  const auto read = read_training_set({path}, ill);
  REQUIRE(read);
  CHECK(points_of(read->set.shapes, 0) == lopsided_organ(2).points);
  ill.group = "odd";
  const auto unknown = read_training_set({path}, ill);
  REQUIRE(!unknown);
  CHECK(unknown.error().sentence().find("healthy, ill") != std::string::npos);
  CHECK(!read_training_set({files.path / "case0.ply"}, ill));
}

TEST_CASE("a mirrored shape is named and flipped where that is asked for") {
  const ShapeFolder files;
  std::vector<fs::path> paths;
  for (int k = 0; k < 4; ++k) paths.push_back(files.write(lopsided_organ(k), "right" + std::to_string(k) + ".ply"));
  // As a template of the other side has it: faces turned too.
  paths.push_back(files.write(mirrored(lopsided_organ(4)), "left.ply"));
  const TrainingSetRead plain = read_training_set(paths).value();
  CHECK(plain.mirrored == std::vector<std::string>{paths.back().string()});
  REQUIRE(plain.warnings.size() == 1);
  CHECK(plain.warnings[0].find("--flip-mirrored") != std::string::npos);
  TrainingOptions flip;
  flip.flip_mirrored = true;
  const TrainingSetRead flipped = read_training_set(paths, flip).value();
  CHECK(points_of(flipped.set.shapes, 4) == lopsided_organ(4).points);
  CHECK(points_of(flipped.set.shapes, 1) == lopsided_organ(1).points);
  CHECK(mirrored_shapes(flipped.set).empty());
  CHECK(flipped.set.topology->triangles() == lopsided_organ(0).triangles);
}

TEST_CASE("faces turned inside out are said and taken as those of most others") {
  const ShapeFolder files;
  MeshFile inside_out = lopsided_organ(0);
  inside_out.triangles = (*inside_out.triangles)(Eigen::all, std::array{0, 2, 1});
  const TrainingSetRead read =
      read_training_set({files.write(inside_out, "inside.ply"), files.write(lopsided_organ(1), "one.ply"),
                         files.write(lopsided_organ(2), "two.ply")})
          .value();
  REQUIRE(read.warnings.size() == 1);
  CHECK(read.warnings[0].find("inside.ply") != std::string::npos);
  CHECK(read.warnings[0].find("look inward") != std::string::npos);
  CHECK(read.set.topology->triangles() == lopsided_organ(0).triangles);
}

TEST_CASE("a training set goes out as it came in with one shape repaired") {
  for (const std::string extension : {".particles", ".vtk", ".ply"}) {
    const ShapeFolder files;
    std::vector<NamedShape> shapes;
    for (int k = 0; k < 3; ++k) {
      const std::string name = "s" + std::to_string(k);
      const fs::path path = files.write(lopsided_organ(k), name + extension);
      shapes.push_back({name, read_shapes_of(path).value().shape({}, name).value(), path, false});
    }
    const auto faces = Topology::make(lopsided_organ(0).points.rows(), lopsided_organ(0).triangles).value();
    const fs::path made = make_case_of_shape(*shapes[1].mesh, faces, "s1", files.path / "repaired").value();
    {
      EditSession session = open_case(made).value().session;
      CHECK(session.document().view()->shape.points->isApprox(lopsided_organ(1).points, 1e-12));
      REQUIRE(session.apply(Stroke{Tool::grab,
                                   lopsided_organ(1).points.row(7),
                                   Vec3(lopsided_organ(1).points.row(7)) + Vec3(2, 0, 0),
                                   5,
                                   {},
                                   false,
                                   1}));
    }
    shapes[1].mesh = read_shapes_of(made).value().shape({}, "s1").value();
    shapes[1].changed = true;
    REQUIRE(write_shapes(shapes, "", files.path / "out"));
    for (const int untouched : {0, 2}) {
      const std::string name = "s" + std::to_string(untouched) + extension;
      CHECK(read_whole_file(files.path / "out" / name).value() == read_whole_file(files.path / name).value());
    }
    const MeshFile repaired = read_mesh_file(files.path / "out" / ("s1" + extension)).value();
    CHECK((repaired.points.row(7) - lopsided_organ(1).points.row(7)).norm() == doctest::Approx(2).epsilon(1e-3));
    CHECK((repaired.points - lopsided_organ(1).points).rowwise().norm().minCoeff() < 1);
    CHECK(repaired.triangles.rows() == (extension == ".particles" ? 0 : lopsided_organ(0).triangles.rows()));
    REQUIRE(write_shapes(shapes, ".particles", files.path / "points"));
    CHECK(read_mesh_file(files.path / "points/s2.particles").value().points.isApprox(lopsided_organ(2).points, 1e-8));
  }
}

TEST_CASE("a case's name that leads out of the folder is refused for a repair and for an export") {
  const ShapeFolder files;
  for (const std::string name : {"../outside", "..", "", "/tmp/outside", "a/b"}) {
    CHECK_FALSE(make_case_of_shape(lopsided_organ(1), nullptr, name, files.path / "repaired"));
    const auto mesh = std::make_shared<const MeshFile>(lopsided_organ(1));
    CHECK_FALSE(write_shapes({{name, mesh, {}, true}}, ".ply", files.path / "out"));
  }
  CHECK_FALSE(fs::exists(files.path / "outside.homolog"));
  CHECK_FALSE(fs::exists(files.path / "outside-imported.ply"));
}

TEST_CASE("points alone are not repaired without faces and a second repair takes another name") {
  const ShapeFolder files;
  MeshFile points = lopsided_organ(1);
  points.triangles.edit().resize(0, 3);
  const auto refused = make_case_of_shape(points, nullptr, "s1", files.path / "repaired");
  REQUIRE(!refused);
  CHECK(refused.error().sentence().find("template") != std::string::npos);
  CHECK(make_case_of_shape(lopsided_organ(1), nullptr, "s1", files.path / "repaired").value().filename() ==
        "s1.homolog");
  CHECK(make_case_of_shape(lopsided_organ(1), nullptr, "s1", files.path / "repaired").value().filename() ==
        "s1-2.homolog");
  const std::vector<NamedShape> escaping{{"../s1", std::make_shared<const MeshFile>(lopsided_organ(1)), {}, true}};
  CHECK(!write_shapes(escaping, "", files.path / "out"));
}

TEST_CASE("the difference of two groups is that of their means and goes along the normals") {
  ShapeMatrix columns(lopsided_organ(0).points.size(), 5);
  for (int k = 0; k < 5; ++k) {
    const MeshFile one = lopsided_organ(k);
    columns.col(k) = Eigen::Map<const Eigen::VectorXd>(one.points.data(), one.points.size());
  }
  const Points expected = (lopsided_organ(2).points + lopsided_organ(3).points + lopsided_organ(4).points) / 3 -
                          (lopsided_organ(0).points + lopsided_organ(1).points) / 2;
  const PrincipalComponents components = principal_components(columns);
  const Points difference = group_difference_mm(components, {0, 1}, {2, 3, 4});
  CHECK((difference - expected).norm() < 1e-9);
  CHECK((group_difference_mm(components, {2, 3, 4}, {0, 1}) + difference).norm() < 1e-9);
  const Mesh ball = icosphere(2, 30);
  const Points normals = vertex_normals(ball);
  CHECK((outward_mm(ball, 1.5 * normals).array() - 1.5).abs().maxCoeff() < 1e-12);
  CHECK((outward_mm({nullptr, ball.points}, -2 * normals).array() - 2).abs().maxCoeff() < 1e-12);
}
