#include <doctest/doctest.h>

#include "core/adapt/boundary/find_placement.h"
#include "core/adapt/judge_fit.h"
#include "core/groupwise/consensus.h"
#include "core/mesh/construction/mirror.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/phantom/phantom.h"
#include "core/volume/volume_io.h"
#include "tests/adapting.h"
#include "tests/ball.h"
#include "tests/real_data.h"
#include "tests/shapes.h"

using namespace homolog;

TEST_CASE("the organ of the other side looks mirrored and the own side does not") {
  const auto the_template = built_in(Organ::kidney);
  Mesh organ{the_template->topology, phantom_truth(Organ::kidney, 3).front().points};
  CHECK_FALSE(other_lie(*the_template, mesh_boundary(organ)).has_value());
  const MeshFile other = mirrored({organ.points, organ.topology->triangles()});
  organ = {Topology::make(other.points.rows(), other.triangles).value(), other.points};
  CHECK(other_lie(*the_template, mesh_boundary(organ)).has_value());
}

TEST_CASE("an organ that is its own mirror image never looks mirrored") {
  const Mesh ball = icosphere(3, 20);
  const auto the_template = ball_template(20);
  CHECK_FALSE(other_lie(*the_template, mesh_boundary(ball)).has_value());
  Mesh egg = ball;
  egg.points.col(1) *= 1.3;
  CHECK_FALSE(other_lie(*the_template, mesh_boundary(egg)).has_value());
}

TEST_CASE("femora of the other side look mirrored and those of the same side do not") {
  const auto data = real_data();
  if (data.empty()) return;
  for (const char* own : {"fem_z009_R", "fem_z013_L"}) {
    const auto the_template = load_template((data / "bones" / (std::string(own) + ".ply")).string()).value();
    for (const char* other : {"fem_z009_R", "fem_z013_L", "fem_z050_L", "fem_z066_R"}) {
      CAPTURE(own);
      CAPTURE(other);
      const Boundary boundary = mesh_boundary(read_mesh(data / "bones" / (std::string(other) + ".ply")).value());
      CHECK(other_lie(*the_template, boundary).has_value() == (own[9] != other[9]));
    }
  }
}

TEST_CASE("kidneys of the other side look mirrored though they lie turned by 60 degrees as well") {
  const auto data = real_data();
  if (data.empty()) return;
  const auto kidney = [&](const char* name) {
    const std::string file = std::string("case_") + name + "_healthy_thin.nii.gz";
    return label_boundary(read_volume(data / "kidney_masks" / file).value().volume, every_label, 0, {}, 1000).value();
  };
  const Mesh own = own_template(kidney("00003_left"), 1000).value().mesh;
  const auto the_template = make_template({own.points, own.topology->triangles()}, "left kidney").value();
  for (const char* left : {"00014_left", "00116_left", "00096_left"}) {
    CAPTURE(left);
    CHECK_FALSE(other_lie(*the_template, kidney(left)).has_value());
  }
  for (const char* right : {"00002_right", "00059_right", "00102_right"}) {
    CAPTURE(right);
    const auto other = other_lie(*the_template, kidney(right));
    REQUIRE(other.has_value());
    CHECK_FALSE(other->half_turned);
  }
}

TEST_CASE("an organ turned from LPS to RAS is told from its mirror image and from its own side") {
  for (const Organ organ : {Organ::kidney, Organ::vertebra}) {
    const auto the_template = built_in(organ);
    Mesh there{the_template->topology, phantom_truth(organ, 3).front().points};
    CHECK_FALSE(other_lie(*the_template, mesh_boundary(there)).has_value());
    there.points.leftCols<2>() *= -1;
    const auto other = other_lie(*the_template, mesh_boundary(there));
    REQUIRE(other.has_value());
    CHECK(other->half_turned);
    CHECK_FALSE(
        other_lie(*the_template, mesh_boundary(there), Orientation::any, false).value_or(OtherLie{}).half_turned);
  }
}

TEST_CASE("three landmarks near a line leave the spin to the surface and the patient's axes") {
  const auto the_template = built_in(Organ::kidney);
  for (const int subject : {2, 3}) {
    CAPTURE(subject);
    const MeshFile truth = phantom_truth(Organ::kidney, subject).front();
    const Boundary boundary = boundary_of({the_template->topology, truth.points});
    const auto off_mm = [&](const FitOptions& options) {
      return mean_distance(fit_to_boundary(*the_template, boundary, options).value().mesh.points, truth.points);
    };
    CHECK(off_mm({{}, landmarks_of(truth, {"hilum", "superior pole", "inferior pole"})}) < off_mm({}) + 0.1);
  }
}

TEST_CASE("no three or four landmarks place worse than none") {
  const auto the_template = built_in(Organ::kidney);
  const std::vector<std::vector<std::string>> sets{{"hilum", "superior pole", "inferior pole"},
                                                   {"superior pole", "inferior pole", "lateral convexity"},
                                                   {"hilum", "anterior lip", "inferior hilar notch"},
                                                   {"anterior lip", "posterior lip", "superior hilar notch"},
                                                   {"hilum", "superior pole", "inferior pole", "lateral convexity"},
                                                   {"hilum", "anterior lip", "posterior lip", "inferior hilar notch"}};
  for (const int subject : {1, 5, 7, 9, 12}) {
    CAPTURE(subject);
    const MeshFile truth = phantom_truth(Organ::kidney, subject).front();
    const Boundary boundary = boundary_of({the_template->topology, truth.points}, 2.5);
    const auto off_mm = [&](const std::map<std::string, Vec3>& landmarks) {
      const Similarity placed = find_placement(*the_template, boundary, {landmarks, {}, {}}).placement;
      return mean_distance(placed.apply(the_template->points), truth.points);
    };
    const double alone_mm = off_mm({});
    for (const auto& names : sets) CHECK(off_mm(landmarks_of(truth, names)) < alone_mm + 0.2);
  }
}

TEST_CASE("a landmark that is none is not trusted") {
  const auto the_template = built_in(Organ::kidney);
  const MeshFile truth = phantom_truth(Organ::kidney, 4).front();
  const Boundary boundary = boundary_of({the_template->topology, truth.points}, 2.5);
  for (const auto& [name, off_mm] : {std::pair("inferior pole", 60.0), std::pair("hilum", -45.0)}) {
    auto landmarks = landmarks_of(truth, {"hilum", "superior pole", "inferior pole", "lateral convexity"});
    landmarks.at(name).y() += off_mm;
    const Placed found = find_placement(*the_template, boundary, {landmarks, {}, {}});
    CHECK(mean_distance(found.placement.apply(the_template->points), truth.points) < 4);
    const auto [own, there] = matched_landmarks(*the_template, landmarks);
    REQUIRE(found.trust.size() == own.rows());
    for (Eigen::Index k = 0; k < own.rows(); ++k) {
      const bool wrong = Vec3(there.row(k)) == landmarks.at(name);
      CHECK((found.trust[k] < 0.5) == wrong);
    }
  }
}

TEST_CASE("named landmarks decide the placement where patient axes are wrong") {
  const auto the_template = built_in(Organ::kidney);
  const Similarity fallen{Eigen::Quaterniond(Eigen::AngleAxisd(2, Vec3::UnitX())), 1, Vec3(10, 20, 30)};
  const Mesh there{the_template->topology, fallen.apply(the_template->points)};
  FitOptions options;
  for (const Landmark& landmark : the_template->landmarks)
    options.landmarks[landmark.name] = fallen.apply(landmark.position);
  REQUIRE(options.landmarks.size() >= 3);
  const Boundary boundary = boundary_of(there, 2);
  CHECK(mean_distance(fit_to_boundary(*the_template, boundary, options).value().mesh.points, there.points) < 1);
  CHECK(mean_distance(fit_to_boundary(*the_template, boundary).value().mesh.points, there.points) > 5);
}

TEST_CASE("every rotation is tried on request") {
  const auto the_template = built_in(Organ::vertebra);
  const Similarity fallen{Eigen::Quaterniond(Eigen::AngleAxisd(2, Vec3::UnitX())), 1, Vec3(10, 20, 30)};
  const Mesh there{the_template->topology, fallen.apply(the_template->points)};
  const auto found = find_placement(*the_template, boundary_of(there, 2), {{}, Orientation::any, {}});
  CHECK(found.placement.rotation.angularDistance(fallen.rotation) < 0.1);
}
