// Models of several structures: where they lie, what a case lacks, files.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <fstream>

#include "core/base/files/files.h"
#include "core/model/files/statismo.h"
#include "core/model/joint_models/complete_structures.h"
#include "core/model/joint_models/joint_alignment.h"
#include "core/model/joint_models/joint_set.h"
#include "core/model/shape_model.h"
#include "core/phantom/spine_meshes.h"
#include "tests/joint_cases.h"
#include "tests/temporary_folder.h"

using namespace homolog;
namespace fs = std::filesystem;

namespace {

const std::vector<JointCase> turned_cases{{-6, -1, 1}, {0, 2, 1}, {6, -1, 1}, {3, 0, 1}, {-3, 0, 1}};

/// How the upper structure differs from the lower one in a number of the poses, in each shape.
Eigen::VectorXd upper_less_lower(const StructurePoses& poses, Eigen::Index number) {
  return poses.values.row(StructurePoses::numbers + number) - poses.values.row(number);
}

/// Vertebrae L3 and L4 of spine phantoms; L4 is turned about its middle by so many degrees more, about x.
ShapeMatrix turned_spines(const std::vector<double>& turns_deg, std::vector<StructurePart>& parts) {
  ShapeMatrix shapes;
  for (std::size_t s = 0; s < turns_deg.size(); ++s) {
    std::vector<Points> both;
    for (const auto& one : phantom::spine_meshes(static_cast<int>(s) + 1).structures)
      if (one.name == "vertebrae_L3" || one.name == "vertebrae_L4") both.push_back(one.truth.points);
    REQUIRE(both.size() == 2);
    const Eigen::RowVector3d middle = both[1].colwise().mean();
    const double turn = turns_deg[s] * std::numbers::pi / 180;
    const Eigen::Matrix3d turned = Eigen::AngleAxisd(turn, Vec3::UnitX()).toRotationMatrix();
    both[1] = (((both[1].rowwise() - middle) * turned.transpose()).rowwise() + middle).eval();
    if (s == 0) {
      shapes.resize(both[0].size() + both[1].size(), std::ssize(turns_deg));
      parts = {{"L3", 0, both[0].rows(), 0, 0}, {"L4", both[0].rows(), both[1].rows(), 0, 0}};
    }
    shapes.col(static_cast<Eigen::Index>(s)) << Eigen::Map<const Eigen::VectorXd>(both[0].data(), both[0].size()),
        Eigen::Map<const Eigen::VectorXd>(both[1].data(), both[1].size());
  }
  return shapes;
}

void put(const fs::path& file, const std::string& text) {
  REQUIRE(make_folder(file.parent_path()));
  REQUIRE(write_whole_file(file, text));
}

}  // namespace

TEST_CASE("the poses of structures are those that they were given") {
  for (const bool each : {false, true}) {
    ShapeMatrix shapes = joint_shapes(turned_cases);
    const StructurePoses poses = align_structures(shapes, joint_parts(), Alignment::rigid, each);
    CHECK(poses.apart == each);
    const Eigen::VectorXd turns = upper_less_lower(poses, 5), offsets = upper_less_lower(poses, 2);
    for (Eigen::Index s = 0; s < 5; ++s) {
      const JointCase& one = turned_cases[static_cast<std::size_t>(s)];
      CHECK(turns[s] == doctest::Approx(one.turn_deg).epsilon(1e-6));
      CHECK(std::abs(offsets[s] - one.offset_mm) < 1e-9);
      CHECK(std::abs(poses.values(6, s)) < 1e-9);
    }
    // About what vertices move: the turn of a vertex is its angle times its distance.
    const double radius = std::sqrt(lower_ellipsoid({}).points.rowwise().squaredNorm().mean());
    CHECK(poses.radius_mm[1] == doctest::Approx(radius).epsilon(1e-6));
    CHECK(poses.in_mm()(5, 0) == doctest::Approx(poses.values(5, 0) * std::numbers::pi / 180 * radius).epsilon(1e-6));
  }
}

TEST_CASE("structures that are aligned each on its own differ by their shape alone") {
  ShapeMatrix common = joint_shapes(turned_cases), each = common;
  align_structures(common, joint_parts(), Alignment::rigid, false);
  align_structures(each, joint_parts(), Alignment::rigid, true);
  CHECK((each.colwise() - each.col(0)).cwiseAbs().maxCoeff() < 1e-6);
  CHECK((common.colwise() - common.col(0)).cwiseAbs().maxCoeff() > 1);
  const Points mean = points_of(each, 0);
  const Eigen::RowVector3d between = mean.bottomRows(162).colwise().mean() - mean.topRows(162).colwise().mean();
  CHECK((between - Eigen::RowVector3d(0, 0, joint_gap_mm)).norm() < 1e-6);
}

TEST_CASE("the size of a structure against the other is its pose where sizes are aligned") {
  ShapeMatrix shapes = joint_shapes({{0, 0, 1.1}, {0, 0, 1}, {0, 0, 1 / 1.1}});
  const StructurePoses poses = align_structures(shapes, joint_parts(), Alignment::similarity, true);
  const Eigen::VectorXd sizes = upper_less_lower(poses, 6);
  CHECK(sizes[0] == doctest::Approx(std::log(1.1)).epsilon(1e-6));
  CHECK(std::abs(sizes[1]) < 1e-9);
  CHECK((shapes.colwise() - shapes.col(0)).cwiseAbs().maxCoeff() < 1e-6);
}

TEST_CASE("a turn that is put to a vertebra of spine phantoms is found in its pose") {
  const std::vector<double> none(5, 0), turns{-4, 2, 4, -2, 0};
  std::vector<StructurePart> parts;
  ShapeMatrix as_they_are = turned_spines(none, parts), turned = turned_spines(turns, parts);
  const StructurePoses before = align_structures(as_they_are, parts, Alignment::similarity, true);
  const StructurePoses after = align_structures(turned, parts, Alignment::similarity, true);
  const Eigen::VectorXd more = upper_less_lower(after, 3) - upper_less_lower(before, 3);
  for (Eigen::Index s = 0; s < 5; ++s) CHECK(std::abs(more[s] - turns[static_cast<std::size_t>(s)]) < 0.2);
  // What is left is their shape, which the turns do not change.
  const Eigen::VectorXd variances = principal_components(as_they_are).variances();
  CHECK((principal_components(turned).variances() - variances).cwiseAbs().maxCoeff() < 0.01 * variances[0]);
}

TEST_CASE("a structure that a case lacks is what the others let expect") {
  std::vector<JointCase> cases;
  for (const double length : {0.8, 0.9, 1.0, 1.1, 1.2, 1.05}) cases.push_back({20 * (length - 1), 0, 1, length});
  const ShapeMatrix complete = joint_shapes(cases);
  // Between those that were seen, and lying elsewhere.
  const Eigen::VectorXd truth = joint_shapes({{20 * 0.15, 0, 1, 1.15}});
  Points moved = points_of(truth);
  const Eigen::Matrix3d turned = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  moved = ((moved * turned.transpose()).rowwise() + Eigen::RowVector3d(100, -50, 20)).eval();
  IncompleteShape shape{Eigen::Map<const Eigen::VectorXd>(moved.data(), moved.size()), {true, false}};
  shape.points.tail(3 * 162).setConstant(7);  // counts for nothing
  const CompletedShape found = completed_shape(complete, joint_parts(), shape, Alignment::rigid);
  const Points points = points_of(found.points);
  CHECK((points - moved).topRows(162).cwiseAbs().maxCoeff() == 0);
  const double error = std::sqrt((points - moved).bottomRows(162).rowwise().squaredNorm().mean());
  CHECK(error < 0.3);  // 3.4 mm from the mean
  CHECK(found.expected_error_mm[0] == 0);
  CHECK(found.expected_error_mm[1] > 0);
  CHECK(found.expected_error_mm[1] < 1);
  CHECK(found.mean_error_mm[1] > 3 * found.expected_error_mm[1]);
}

TEST_CASE("a model's file keeps structures and poses and what was completed") {
  const TemporaryFolder folder;
  ShapeMatrix shapes = joint_shapes({{-6, 0, 1, 0.9}, {0, 2, 1, 1}, {6, -2, 1, 1.2}});
  const StructurePoses poses = align_structures(shapes, joint_parts(), Alignment::similarity, true);
  ShapeModel model = make_model(principal_components(shapes), 1, nullptr, {"a", "b", "c"});
  model.parts = joint_parts();
  for (StructurePart& part : model.parts) part.first_triangle = part.triangles = 0;
  model.poses = poses;
  model.completed = {{2, 1, 1.5, 2.5}};
  for (const std::string name : {"m.h5", "m.h5.json"}) {
    REQUIRE(write_model(model, folder.path / name));
    const auto read = read_model(folder.path / name);
    REQUIRE(read);
    REQUIRE(read->parts.size() == 2);
    CHECK(read->parts[1].name == "high");
    CHECK(read->parts[1].first_vertex == 162);
    REQUIRE(read->poses);
    CHECK(read->poses->apart);
    CHECK((read->poses->values - poses.values).cwiseAbs().maxCoeff() < 1e-5);
    CHECK((read->poses->variances - poses.variances).cwiseAbs().maxCoeff() < 1e-5);
    REQUIRE(read->completed.size() == 1);
    CHECK(read->completed[0].shape == 2);
    CHECK(read->completed[0].expected_error_mm == 1.5);
    CHECK(read->completed[0].mean_error_mm == 2.5);
    const ShapeModel high = part_of(*read, read->parts[1]);
    CHECK((shape_of(high, read->scores.col(1)) - points_of(shapes, 1).bottomRows(162)).cwiseAbs().maxCoeff() < 1e-3);
  }
  // Structures that do not fill the model are none.
  model.parts[1].vertices -= 1;
  REQUIRE(write_model(model, folder.path / "m.h5"));
  const auto other = read_model(folder.path / "m.h5");
  REQUIRE(other);
  CHECK(other->parts.empty());
  CHECK_FALSE(other->poses);
}

TEST_CASE("cases of structures are found in folders of meshes and of ShapeWorks") {
  const TemporaryFolder folder;
  for (const char* file : {"fits/b/L3.ply", "fits/b/L4.vtk", "fits/b/L4.ply", "fits/a/l3.ply", "fits/a/other.ply",
                           "sw/k_1_L3_local.particles", "sw/k_1_L3_world.particles", "sw/k_1_disc_L3_local.particles",
                           "sw/k_2_disc_L3_local.particles"})
    put(folder.path / file, "0 0 0\n");
  const auto meshes = structure_files({folder.path / "fits"}, {"L3", "L4"});
  REQUIRE(meshes);
  REQUIRE(meshes->size() == 2);
  CHECK((*meshes)[0].name == "a");
  CHECK((*meshes)[0].of_structure[0].file.filename() == "l3.ply");
  CHECK((*meshes)[0].of_structure[1].file.empty());
  CHECK((*meshes)[1].of_structure[1].file.filename() == "L4.ply");
  const auto one_case = structure_files({folder.path / "fits/b/"}, {"L4", "L3"});
  REQUIRE(one_case);
  CHECK((*one_case)[0].name == "b");
  CHECK((*one_case)[0].of_structure[0].file.filename() == "L4.ply");
  const auto particles = structure_files({folder.path / "sw"}, {"L3", "disc_L3"});
  REQUIRE(particles);
  REQUIRE(particles->size() == 2);
  CHECK((*particles)[0].name == "k_1");
  CHECK((*particles)[0].of_structure[0].file.filename() == "k_1_L3_local.particles");
  CHECK((*particles)[0].of_structure[1].file.filename() == "k_1_disc_L3_local.particles");
  CHECK((*particles)[1].of_structure[0].file.empty());
  const auto misspelt = structure_files({folder.path / "fits"}, {"L3", "L5"});
  REQUIRE_FALSE(misspelt);
  CHECK(misspelt.error().what == "holds no case with L5; the nearest names there are L3, L4 and l3");
  CHECK(structure_files({folder.path / "fits"}, {"L3", "l3"}).error().what ==
        "names l3 twice; name each structure once");
  CHECK_FALSE(structure_files({folder.path / "fits"}, {"L3"}));
  const auto no_world = structure_files({folder.path / "fits"}, {"L3", "L4"}, ShapeWorksFrame::world);
  REQUIRE_FALSE(no_world);
  CHECK(no_world.error().what.starts_with("holds no _world.particles"));
  put(folder.path / "aligned/k_1_L3_world.particles", "0 0 0\n");
  const auto world_alone = structure_files({folder.path / "aligned"}, {"L3", "L4"});
  REQUIRE_FALSE(world_alone);
  CHECK(world_alone.error().what == "holds _world.particles but no _local.particles; use --world");
  CHECK_FALSE(structure_files({folder.path / "none"}, {"L3", "L4"}));
}
