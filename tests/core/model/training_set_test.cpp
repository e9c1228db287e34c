#include "core/model/training_set.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <numeric>
#include <random>

#include "core/mesh/construction/mirror.h"
#include "core/mesh/mesh_io.h"
#include "core/model/files/model_files.h"
#include "core/model/shape_model.h"
#include "core/template/template.h"
#include "tests/real_data.h"
#include "tests/shapes.h"
#include "tests/temporary_folder.h"

namespace fs = std::filesystem;
using namespace homolog;

namespace {

/// An organ without any symmetry, one of a family.
Mesh organ(int number) {
  Mesh mesh = icosphere(2, 30);
  const double k = 0.05 * number;
  for (Eigen::Index v = 0; v < mesh.points.rows(); ++v) {
    const Vec3 p = mesh.points.row(v);
    mesh.points.row(v) << p.x() + 0.01 * p.y() * p.y() + k * p.z(), 1.5 * p.y() + 0.01 * p.x() * p.z(),
        (2 + k) * p.z() + 0.01 * p.x() * p.y();
  }
  return mesh;
}

/// The files of a training set that starts with `count` organs.
struct Folder : TemporaryFolder {
  std::vector<fs::path> files;
  explicit Folder(int count = 0) {
    for (int k = 0; k < count; ++k) add(organ(k), "organ" + std::to_string(k) + ".ply");
  }
  void add(const Mesh& mesh, const std::string& name) {
    files.push_back(path / name);
    REQUIRE(write_mesh(mesh, files.back()));
  }
  void add(const std::string& text, const std::string& name) {
    files.push_back(path / name);
    std::ofstream(files.back()) << text;
  }
};

/// A file of a shape that says which part of a label it is of.
void add_part(Folder& folder, MeshFile file, const std::optional<FacedNames>& faced, const std::string& name) {
  if (faced) file.comments = {faced_comment(*faced)};
  folder.files.push_back(folder.path / name);
  REQUIRE(write_mesh_file(file, folder.files.back()));
}

MeshFile mesh_file_of(const Mesh& mesh) {
  MeshFile file;
  file.points = mesh.points;
  file.triangles = mesh.topology->triangles();
  return file;
}

/// The one error of a set that is refused: it must name `file` and say `what`.
void check_refused(const Folder& folder, const std::string& file, const std::string& what) {
  const auto read = read_training_set(folder.files);
  REQUIRE(!read);
  INFO(read.error().sentence());
  CHECK(read.error().sentence().find(file) != std::string::npos);
  CHECK(read.error().sentence().find(what) != std::string::npos);
}

void check_warned(const TrainingSetRead& read, const std::string& file, const std::string& what) {
  REQUIRE(read.warnings.size() == 1);
  INFO(read.warnings.front());
  CHECK(read.warnings.front().find(file) != std::string::npos);
  CHECK(read.warnings.front().find(what) != std::string::npos);
}

}  // namespace

TEST_CASE("a training set keeps the order and the numbers of its files") {
  const Folder folder(4);
  const TrainingSetRead read = read_training_set(folder.files).value();
  CHECK(read.warnings.empty());
  CHECK(read.set.topology->hash() == organ(0).topology->hash());
  REQUIRE(read.set.shapes.cols() == 4);
  for (int k = 0; k < 4; ++k) {
    CHECK(points_of(read.set.shapes, k) == organ(k).points);
    CHECK(read.set.names[static_cast<std::size_t>(k)] == folder.files[static_cast<std::size_t>(k)].string());
  }
}

TEST_CASE("points without faces join the meshes of their count or make a set of their own") {
  Folder mixed(2);
  mixed.add(organ(2), "organ2.particles");
  const TrainingSetRead read = read_training_set(mixed.files).value();
  CHECK(read.set.topology);
  CHECK(read.set.shapes.cols() == 3);
  Folder points;
  for (int k = 0; k < 3; ++k) points.add(organ(k), "organ" + std::to_string(k) + ".particles");
  CHECK(!read_training_set(points.files)->set.topology);
}

TEST_CASE("a mesh with another count or other faces is refused by name wherever it stands") {
  Folder first(0);
  first.add(icosphere(1, 30), "small.ply");
  for (int k = 0; k < 3; ++k) first.add(organ(k), "organ" + std::to_string(k) + ".ply");
  check_refused(first, "small.ply", "42 vertices");
  Folder last(3);
  Mesh turned = organ(3);
  Triangles triangles = turned.topology->triangles();
  triangles.row(0).swap(triangles.row(1));
  turned.topology = Topology::make(turned.points.rows(), triangles).value();
  last.add(turned, "renumbered.ply");
  check_refused(last, "renumbered.ply", "numbering");
  Folder points(2);
  points.add(icosphere(1, 30), "few.particles");
  check_refused(points, "few.particles", "42 vertices");
  Folder soup(2);
  soup.add(organ(2), "organ2.stl");
  check_refused(soup, "organ2.stl", ".stl");
  Folder large_letters(2);
  large_letters.add(organ(2), "organ2.Stl");
  check_refused(large_letters, "organ2.Stl", ".stl");
}

namespace {

/// Where each vertex of a shape in another order comes from.
std::vector<Eigen::Index> shuffled(Eigen::Index count, unsigned seed) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::mt19937 random(seed);
  for (std::size_t k = order.size() - 1; k > 0; --k) std::swap(order[k], order[random() % (k + 1)]);
  return order;
}

Mesh in_order(const Mesh& mesh, const std::vector<Eigen::Index>& order) {
  return {mesh.topology, Points(mesh.points(order, Eigen::all))};
}

}  // namespace

TEST_CASE("faces that begin at another corner are the same, and turned ones are turned ones") {
  Folder folder;
  const std::array<std::array<int, 3>, 5> orders{{{0, 1, 2}, {1, 2, 0}, {2, 1, 0}, {1, 0, 2}, {2, 0, 1}}};
  for (int k = 0; k < 5; ++k) {
    MeshFile file = mesh_file_of(organ(k));
    const Triangles faces = file.triangles;
    Triangles moved(faces.rows(), 3);
    for (int c = 0; c < 3; ++c)
      moved.col(c) = faces.col(orders[static_cast<std::size_t>(k)][static_cast<std::size_t>(c)]);
    CHECK(same_faces(faces, moved) == (k != 2 && k != 3));
    CHECK(turned_faces(faces, moved) == (k == 2 || k == 3));
    file.triangles = moved;
    folder.files.push_back(folder.path / ("organ" + std::to_string(k) + ".ply"));
    REQUIRE(write_mesh_file(file, folder.files.back()));
  }
  const auto read = read_training_set(folder.files);
  REQUIRE_MESSAGE(read, read.error().sentence());
  CHECK(read->set.shapes.cols() == 5);
  CHECK(read->set.topology->triangles() == organ(0).topology->triangles());
}

TEST_CASE("a shape whose vertices are in another order is refused by name wherever it stands") {
  for (const char* ending : {".ply", ".particles"})
    for (const std::size_t at : {0, 2, 5}) {
      CAPTURE(ending);
      CAPTURE(at);
      Folder folder;
      for (int k = 0; k < 6; ++k)
        folder.add(k == static_cast<int>(at) ? in_order(organ(k), shuffled(162, 5)) : organ(k),
                   "organ" + std::to_string(k) + ending);
      check_refused(folder, "organ" + std::to_string(at) + ending + ": has its vertices in another order than",
                    "organ");
    }
}

TEST_CASE("several shapes that have one other order and a part that is in another order are named") {
  const auto order = shuffled(162, 7);
  Folder two;
  for (int k = 0; k < 6; ++k)
    two.add(k == 1 || k == 4 ? in_order(organ(k), order) : organ(k), "organ" + std::to_string(k) + ".ply");
  check_refused(two, "organ1.ply: has its vertices in another order than", "organ4.ply");
  Folder half;  // as many of each: the faces tell which is right
  for (int k = 0; k < 4; ++k)
    half.add(k < 2 ? in_order(organ(k), order) : organ(k), "organ" + std::to_string(k) + ".ply");
  check_refused(half, "organ0.ply: has its vertices in another order than", "organ2.ply (so has");
  Folder pair;
  pair.add(in_order(organ(0), order), "organ0.ply");
  pair.add(organ(1), "organ1.ply");
  check_refused(pair, "organ0.ply: has its vertices in another order than", "organ1.ply");
  Folder part;
  auto some = shuffled(162, 9);
  for (std::size_t k = 54; k < some.size(); ++k) some[k] = static_cast<Eigen::Index>(k);
  for (std::size_t k = 0; k < 54; ++k) some[k] = static_cast<Eigen::Index>((k + 17) % 54);
  for (int k = 0; k < 5; ++k)
    part.add(k == 3 ? in_order(organ(k), some) : organ(k), "organ" + std::to_string(k) + ".ply");
  check_refused(part, "organ3.ply: has its vertices in another order than", "organ0.ply");
  Folder reversed;
  for (int k = 0; k < 5; ++k) {
    Mesh mesh = organ(k);
    if (k == 2) mesh.points = mesh.points.colwise().reverse().eval();
    reversed.add(mesh, "organ" + std::to_string(k) + ".particles");
  }
  check_refused(reversed, "organ2.particles: has its vertices in another order than", "organ0.particles");
}

TEST_CASE("shapes that differ much and a few swapped vertices are no other order") {
  Folder folder;
  for (int k = 0; k < 6; ++k) {
    Mesh mesh = organ(10 * k);  // up to twice as long, and sheared
    if (k == 3) mesh.points.row(5).swap(mesh.points.row(90));
    if (k == 4) mesh.points *= 1000;
    if (k == 5) mesh.points.leftCols<2>() *= -1;
    folder.add(mesh, "organ" + std::to_string(k) + ".ply");
  }
  const auto read = read_training_set(folder.files);
  REQUIRE_MESSAGE(read, read.error().sentence());
  Folder few;  // too few points to tell
  for (int k = 0; k < 3; ++k) few.add(shapes::box(Vec3::Zero(), Vec3(1 + k, 2, 3)), "box" + std::to_string(k) + ".ply");
  CHECK(read_training_set(few.files));
}

TEST_CASE("real shapes are in one order and are named once one of them is shuffled") {
  const fs::path data = real_data();
  if (data.empty()) return;
  for (const char* name : {"meshes/patella", "meshes/bivme_lv_cine25", "odd/shuffled_vertices"}) {
    CAPTURE(name);
    Folder folder;
    for (const auto& entry : fs::directory_iterator(data / name))
      if (is_mesh_name(entry.path())) folder.files.push_back(entry.path());
    std::sort(folder.files.begin(), folder.files.end());
    REQUIRE(folder.files.size() > 3);
    if (name == std::string("odd/shuffled_vertices")) {
      check_refused(folder, "s3.obj: has its vertices in another order than", "shuffled_vertices");
      continue;
    }
    const auto read = read_training_set(folder.files);
    REQUIRE_MESSAGE(read, read.error().sentence());
    MeshFile other = read_mesh_file(folder.files[1]).value();
    other.points = Points(other.points(shuffled(other.points.rows(), 3), Eigen::all));
    REQUIRE(write_mesh_file(other, folder.path / ("shuffled" + folder.files[1].extension().string())));
    folder.files[1] = folder.path / ("shuffled" + folder.files[1].extension().string());
    check_refused(folder, "shuffled", "another order");
  }
}

TEST_CASE("a file that cannot be read is named and the rest goes on") {
  Folder folder(5);
  folder.files.insert(folder.files.begin() + 2, folder.path / "absent.ply");
  const TrainingSetRead absent = read_training_set(folder.files).value();
  check_warned(absent, "absent.ply", "does not exist");
  CHECK(absent.set.shapes.cols() == 5);
  CHECK(points_of(absent.set.shapes, 2) == organ(2).points);
  Folder damaged(3);
  Mesh nan = organ(3);
  nan.points(7, 1) = std::nan("");
  damaged.add(nan, "nan.ply");
  check_warned(read_training_set(damaged.files).value(), "nan.ply", "vertex 7");
}

TEST_CASE("too few shapes or equal ones are refused with what would help") {
  check_refused(Folder(1), "organ0.ply", "at least two");
  Folder one(1);
  one.add("nothing", "broken.ply");
  check_refused(one, "organ0.ply", "broken.ply");
  Folder none;
  none.add("nothing", "broken.ply");
  none.add("nothing", "broken2.ply");
  check_refused(none, "broken.ply", "");
  Folder equal;
  for (int k = 0; k < 3; ++k) equal.add(organ(1), "same" + std::to_string(k) + ".ply");
  check_refused(equal, "same0.ply", "nothing to model");
  CHECK(!read_training_set({}));
}

TEST_CASE("a mirrored shape is pointed out even where it comes first") {
  MeshFile mirror;
  mirror.points = organ(9).points;
  mirror.triangles = organ(9).topology->triangles();
  mirror = mirrored(mirror);
  mirror.triangles = organ(9).topology->triangles();  // as a program would write that mirrors points alone
  for (const bool first : {false, true}) {
    Folder folder(5);
    folder.files.insert(first ? folder.files.begin() : folder.files.end(), folder.path / "left.ply");
    REQUIRE(write_mesh_file(mirror, folder.path / "left.ply"));
    check_warned(read_training_set(folder.files).value(), "left.ply", "mirror image");
  }
}

TEST_CASE("sizes a factor of ten or a thousand off are pointed out and children are not") {
  for (const auto& [factor, said] : std::vector<std::pair<double, std::string>>{
           {0.1, "10 times as small"}, {1000, "1000 times as large"}, {0.5, ""}}) {
    Folder folder(5);
    Mesh scaled = organ(6);
    scaled.points *= factor;
    folder.add(scaled, "scaled.ply");
    const TrainingSetRead read = read_training_set(folder.files).value();
    if (said.empty())
      CHECK(read.warnings.empty());
    else
      check_warned(read, "scaled.ply", said);
  }
}

TEST_CASE("a set is of the part of a label that all shapes name that name one") {
  const FacedNames left{"left atrium", false}, right{"right atrium", false};
  const Folder silent(2);
  CHECK_FALSE(read_training_set(silent.files)->set.faced);
  Folder same(1);
  for (int k = 1; k < 4; ++k) add_part(same, mesh_file_of(organ(k)), left, "part" + std::to_string(k) + ".ply");
  TrainingSetRead read = read_training_set(same.files).value();
  CHECK(read.warnings.empty());
  CHECK(read.set.faced == left);

  // The mirror image of one may be named as of its own side or of the others'.
  for (const FacedNames& named : {left, right})
    for (const bool flip : {false, true}) {
      Folder folder(0);
      add_part(folder, mirrored(mesh_file_of(organ(9))), named, "mirrored.ply");
      for (int k = 1; k < 5; ++k) add_part(folder, mesh_file_of(organ(k)), left, "part" + std::to_string(k) + ".ply");
      TrainingOptions options;
      options.flip_mirrored = flip;
      read = read_training_set(folder.files, options).value();
      CHECK(read.mirrored.size() == 1);
      CHECK(read.warnings.size() == 1);
      CHECK(read.set.faced == left);
    }

  for (const FacedNames& other : {right, FacedNames{"left atrium", true}}) {
    Folder folder(0);
    for (int k = 0; k < 3; ++k) add_part(folder, mesh_file_of(organ(k)), left, "part" + std::to_string(k) + ".ply");
    add_part(folder, mesh_file_of(organ(7)), other, "other.ply");
    read = read_training_set(folder.files).value();
    CHECK_FALSE(read.set.faced);
    REQUIRE(read.warnings.size() == 1);
    check_warned(read, "other.ply", other.kept ? "faces \"left atrium\"" : "ends at \"right atrium\"");
    check_warned(read, "part0.ply", "ends at \"left atrium\"; a model of both keeps neither");
  }
}

TEST_CASE("a shape given twice is pointed out") {
  Folder folder(4);
  folder.add(organ(1), "again.ply");
  check_warned(read_training_set(folder.files).value(), "again.ply", "organ1.ply");
}

TEST_CASE("equal shapes in different poses leave no component") {
  ShapeMatrix posed(organ(0).points.size(), 3);
  for (int k = 0; k < 3; ++k) {
    const Similarity pose{Eigen::Quaterniond(Eigen::AngleAxisd(k, Vec3(1, 2, k).normalized())), 1.0 + k,
                          Vec3(k, 500, 3)};
    const Points points = pose.apply(organ(0).points);
    posed.col(k) = Eigen::Map<const Eigen::VectorXd>(points.data(), points.size());
  }
  align(posed, Alignment::similarity);
  CHECK(principal_components(posed).scatter.size() == 0);
}

TEST_CASE("files of one name from several folders keep names apart") {
  CHECK(shape_names({"a/k.ply", "b/k.ply", "c/k-2.ply", "m.vtk"}) ==
        std::vector<std::string>{"a-k", "b-k", "k-2", "m"});
  CHECK(shape_names({"a/k.ply", "b/k.ply", "c/a-k.ply"}) == std::vector<std::string>{"a-k", "b-k", "a-k-2"});
  CHECK(names_with_folders({"x/a/k.ply", "x/b/k.ply", "x/b/m.ply", "x/b/m.vtk", "x/b/m.ply"}) ==
        std::vector<std::string>{"a/k", "b/k", "m", "m-2", "m-3"});
  CHECK(names_with_folders({"p/now/k.ply", "q/now/k.ply", "q/then/h.homolog frame 2", "m/h.homolog frame 2"}) ==
        std::vector<std::string>{"p/now/k", "q/now/k", "then/h frame 2", "m/h frame 2"});
}

TEST_CASE("aligned shapes and tables can be read again") {
  const Folder folder(4);
  TrainingSetRead read = read_training_set(folder.files).value();
  align(read.set.shapes, Alignment::similarity);
  const ShapeMatrix aligned = read.set.shapes;
  const PrincipalComponents components = principal_components(std::move(read.set.shapes));
  const auto names = shape_names(read.set.names);
  REQUIRE(write_aligned_shapes(components, read.set.topology, names, folder.path / "aligned"));
  REQUIRE(write_model_tables(components, names, folder.path / "tables"));
  const std::vector<fs::path> written{folder.path / "aligned/organ0.ply", folder.path / "aligned/organ1.particles"};
  const TrainingSetRead again = read_training_set(written).value();
  CHECK((again.set.shapes - aligned.leftCols(2)).cwiseAbs().maxCoeff() < 1e-9);
  std::ifstream scores(folder.path / "tables/scores.csv");
  std::string line;
  std::getline(scores, line);
  CHECK(line == "shape,b1,b2,b3");
  std::getline(scores, line);
  CHECK(line.rfind("organ0,", 0) == 0);
  CHECK(std::stod(line.substr(7)) == doctest::Approx(components.scores()(0, 0)));
  CHECK(csv_field("a, \"b\"") == "\"a, \"\"b\"\"\"");
}

TEST_CASE("real shapes: the patellae make a model without a warning") {
  const fs::path data = real_data();
  if (data.empty()) return;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(data / "meshes/patella")) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  TrainingSetRead read = read_training_set(files).value();
  CHECK(read.warnings.empty());
  CHECK(read.set.shapes.cols() == 24);
  align(read.set.shapes, Alignment::similarity);
  const PrincipalComponents components = principal_components(std::move(read.set.shapes));
  CHECK(components.scatter.size() == 23);
}
