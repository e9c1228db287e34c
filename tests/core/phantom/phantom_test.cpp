#include "core/phantom/phantom.h"

#include <doctest/doctest.h>

#include <set>

#include "core/base/numbers/random.h"
#include "core/deform/fold_guard.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/voxels/voxelise.h"
#include "core/phantom/deformation.h"
#include "core/phantom/phantom_scene.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

constexpr Organ all_organs[] = {Organ::kidney, Organ::vertebra, Organ::ventricle};
constexpr double coarse_mm = 3;  // of the images whose fineness does not matter

Mesh mesh_of(const MeshFile& file) {
  return {Topology::make(file.points.rows(), file.triangles).value(), file.points};
}

template <class Voxels>
std::uint64_t hash_of(const Voxels& voxels) {
  std::uint64_t hash = 0;
  for (const auto voxel : voxels) hash = mix_bits(hash ^ static_cast<std::uint64_t>(voxel));
  return hash;
}

std::uint64_t hash_of(const PhantomSubject& subject) {
  return hash_of(std::get<std::vector<std::int16_t>>(subject.image.data)) ^
         mix_bits(hash_of(std::get<std::vector<std::uint8_t>>(subject.label_map.data)));
}

Eigen::Index nearest_vertex(const Points& points, const Vec3& p) {
  Eigen::Index nearest = 0;
  (points.rowwise() - p.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
  return nearest;
}

}  // namespace

TEST_CASE("an organ is known by its name and no other") {
  for (const Organ organ : all_organs) CHECK(organ_from_name(organ_name(organ)).value() == organ);
  CHECK(organ_from_name("spleen").error().sentence().find("spleen") == 0);
  CHECK(organ_from_name("spleen").error().sentence().find("ventricle or spine") != std::string::npos);
}

TEST_CASE("the deformation of every subject is undone by its inverse and subject 0 is not deformed") {
  Random random(7);
  for (int subject = 0; subject < 20; ++subject) {
    const phantom::Deformation deformation(subject, 1, {});
    for (int i = 0; i < 50; ++i) {
      const Vec3 x(random.uniform(-80, 80), random.uniform(-80, 80), random.uniform(-80, 80));
      const Vec3 p = deformation.to_subject(x);
      CHECK((deformation.to_mean(p) - x).norm() < 1e-9);
      if (subject == 0) CHECK(p == x);
    }
  }
}

TEST_CASE("the same number gives the same voxels on every machine") {
  CHECK(hash_of(make_phantom(Organ::kidney, 3, coarse_mm)) == 0x2b5e1b5fd0c2c64aU);
  CHECK(hash_of(make_phantom(Organ::vertebra, 3, coarse_mm)) == 0xea5f97287ff6ae13U);
  CHECK(hash_of(make_phantom(Organ::ventricle, 3, coarse_mm)) == 0x534e228d155cb333U);
}

TEST_CASE("templates of kidney and vertebra are closed and even and of the right genus") {
  for (const Organ organ : {Organ::kidney, Organ::vertebra}) {
    CAPTURE(organ_name(organ));
    const Mesh mesh = mesh_of(built_in_template(organ));
    const MeshQuality quality = mesh_quality(mesh);
    CHECK(mesh.topology->closed());
    CHECK(mesh.topology->components() == 1);
    CHECK(mesh.topology->genus() == (organ == Organ::vertebra ? 1 : 0));
    CHECK(mesh.points.rows() >= 2450);
    CHECK(mesh.points.rows() <= 2600);
    CHECK(quality.edge_cv < 0.1);
    CHECK(quality.min_angle_deg > 30);
    CHECK(quality.self_intersections == 0);
    CHECK(mesh.points.colwise().mean().norm() < 1e-9);
  }
}

TEST_CASE("the template of the ventricle is a ring by sector tube that is open at the base") {
  const Mesh mesh = mesh_of(built_in_template(Organ::ventricle));
  REQUIRE(mesh.topology->rims().size() == 1);
  const auto& base = mesh.topology->rims().front();
  const std::set<std::int32_t> first_ring(base.begin(), base.end());
  CHECK(*first_ring.begin() == 0);
  CHECK(*first_ring.rbegin() == static_cast<std::int32_t>(base.size()) - 1);
  CHECK(mesh.topology->genus() == 0);
  CHECK((mesh.points.rows() - 1) % static_cast<Eigen::Index>(base.size()) == 0);
  CHECK(mesh.topology->one_ring(mesh.points.rows() - 1).size() == base.size());  // the apex
}

TEST_CASE("the kidney is stiff at its capsule and soft in its hilum") {
  const MeshFile kidney = built_in_template(Organ::kidney);
  REQUIRE(kidney.stiffness);
  CHECK(kidney.stiffness->minCoeff() == doctest::Approx(1));
  CHECK(kidney.stiffness->maxCoeff() == doctest::Approx(5));
  for (const Landmark& landmark : kidney.landmarks) {
    const double factor = (*kidney.stiffness)[nearest_vertex(kidney.points, landmark.position)];
    if (landmark.name == "hilum") CHECK(factor == doctest::Approx(1));
    if (landmark.name == "lateral convexity") CHECK(factor == doctest::Approx(5));
  }
}

TEST_CASE("landmarks have names of their own and lie at the same vertex in every subject") {
  for (const Organ organ : all_organs) {
    const MeshFile mean = built_in_template(organ);
    std::set<std::string> names;
    std::set<Eigen::Index> vertices;
    for (const Landmark& landmark : mean.landmarks) {
      CHECK(names.insert(landmark.name).second);
      CHECK(vertices.insert(nearest_vertex(mean.points, landmark.position)).second);
    }
    CHECK(names.size() >= 6);
    for (int number = 0; number < 4; ++number)
      for (const MeshFile& truth : phantom_truth(organ, number)) {
        CHECK(truth.triangles == mean.triangles);
        REQUIRE(truth.landmarks.size() == mean.landmarks.size());
        for (std::size_t i = 0; i < mean.landmarks.size(); ++i) {
          const Eigen::Index vertex = nearest_vertex(mean.points, mean.landmarks[i].position);
          CHECK(truth.landmarks[i].name == mean.landmarks[i].name);
          CHECK((truth.landmarks[i].position - Vec3(truth.points.row(vertex))).norm() < 1e-9);
        }
      }
  }
}

TEST_CASE("no subject is folded and subject 0 is the template") {
  for (const Organ organ : all_organs) {
    const MeshFile mean = built_in_template(organ);
    const Mesh reference = mesh_of(mean);
    CHECK(phantom_truth(organ, 0).front().points == mean.points);
    for (int number = 1; number < 20; ++number) {
      CAPTURE(organ_name(organ));
      CAPTURE(number);
      const auto frames = phantom_truth(organ, number);
      const Points& points =
          frames[static_cast<std::size_t>(number) % frames.size()].points;  // another phase each time
      CHECK(turned_triangles(*reference.topology, reference.points, points).empty());
      CHECK(self_intersections({reference.topology, points}).empty());
    }
  }
}

TEST_CASE("subjects differ as patients do") {
  const auto check_volumes = [](Organ organ, double least_ml, double most_ml) {
    for (int number = 0; number < 20; ++number) {
      const double ml = enclosed_volume_ml(mesh_of(phantom_truth(organ, number).front()));
      CAPTURE(number);
      CHECK(ml > least_ml);
      CHECK(ml < most_ml);
    }
  };
  check_volumes(Organ::kidney, 90, 240);
  check_volumes(Organ::vertebra, 28, 70);
  check_volumes(Organ::ventricle, 90, 190);

  double sum_mm = 0;
  int pairs = 0;
  for (int a = 0; a < 10; ++a)
    for (int b = 0; b < a; ++b, ++pairs)
      sum_mm +=
          mean_distance(phantom_truth(Organ::kidney, a).front().points, phantom_truth(Organ::kidney, b).front().points);
  CHECK(sum_mm / pairs > 5);
  CHECK(sum_mm / pairs < 10);
}

TEST_CASE("the ventricle ejects a healthy share of its blood and comes back smoothly") {
  for (int number = 0; number < 20; ++number) {
    CAPTURE(number);
    const auto truth = phantom_truth(Organ::ventricle, number);
    REQUIRE(truth.size() == 20);
    std::vector<double> ml;
    for (const MeshFile& frame : truth) ml.push_back(enclosed_volume_ml(mesh_of(frame)));
    const auto [smallest, largest] = std::minmax_element(ml.begin(), ml.end());
    CHECK(largest == ml.begin());
    CHECK((*largest - *smallest) / *largest > 0.48);
    CHECK((*largest - *smallest) / *largest < 0.68);
    for (std::size_t frame = 0; frame < ml.size(); ++frame)  // the last frame leads back to the first
      CHECK(std::abs(ml[(frame + 1) % ml.size()] - ml[frame]) < 0.17 * *largest);
  }
}

TEST_CASE("the label map is the inside of the truth and its edge is seen in the image") {
  for (const Organ organ : all_organs) {
    const PhantomSubject subject = make_phantom(organ, 2, organ == Organ::ventricle ? 2.8 : 2.0);
    CAPTURE(organ_name(organ));
    REQUIRE(subject.truth.size() == static_cast<std::size_t>(subject.image.frames));
    CHECK(same_grid(subject.image.geometry, subject.label_map.geometry));
    const auto& labels = std::get<std::vector<std::uint8_t>>(subject.label_map.data);
    const std::size_t voxels = subject.image.geometry.voxels();
    REQUIRE(labels.size() == voxels * subject.truth.size());
    for (std::size_t frame = 0; frame < subject.truth.size(); ++frame) {
      const auto inside = voxelise(mesh_of(subject.truth[frame]), subject.image.geometry);
      std::size_t differing = 0, organ_voxels = 0;
      for (std::size_t n = 0; n < voxels; ++n) {
        differing += (labels[frame * voxels + n] == 1) != (inside[n] == 1);
        organ_voxels += inside[n];
      }
      CHECK(differing == 0);
      CHECK(subject.image.geometry.bounds_mm().contains(bounds_of(subject.truth[frame].points)));
      const double voxel_ml = subject.image.geometry.voxel_volume_mm3() / 1000;
      CHECK(static_cast<double>(organ_voxels) * voxel_ml ==
            doctest::Approx(enclosed_volume_ml(mesh_of(subject.truth[frame]))).epsilon(0.05));
    }
  }
}

TEST_CASE("the heart muscle keeps its volume while it contracts") {
  const PhantomSubject subject = make_phantom(Organ::ventricle, 2, coarse_mm);
  const auto at_end_diastole = static_cast<double>(labels_of(subject.label_map, 0).at(2));
  for (int frame = 1; frame < subject.label_map.frames; ++frame)
    CHECK(static_cast<double>(labels_of(subject.label_map, frame).at(2)) ==
          doctest::Approx(at_end_diastole).epsilon(0.15));
}

TEST_CASE("the image changes at the true surface of the kidney from tissue to fat") {
  const PhantomSubject subject = make_phantom(Organ::kidney, 5, 2);
  const Mesh truth = mesh_of(subject.truth.front());
  const Points normals = vertex_normals(truth);
  double inside = 0, outside = 0;
  for (Eigen::Index i = 0; i < truth.points.rows(); ++i) {
    const Vec3 p = truth.points.row(i), n = normals.row(i);
    inside += subject.image.sample(p - 3 * n, -1000);
    outside += subject.image.sample(p + 3 * n, -1000);
  }
  CHECK((inside - outside) / static_cast<double>(truth.points.rows()) > 100);
  for (const double hu : {subject.image.range_min, subject.image.range_max}) CHECK(std::abs(hu) < 1500);
}

TEST_CASE("a phantom that is cancelled is not made") {
  Progress progress;
  CHECK(hash_of(make_phantom(Organ::kidney, 3, coarse_mm, &progress)) == 0x2b5e1b5fd0c2c64aU);
  progress.cancel();
  for (const Organ organ : {Organ::kidney, Organ::vertebra}) {
    const PhantomSubject subject = make_phantom(organ, 3, coarse_mm, &progress);
    CHECK(subject.image.range_min == subject.image.range_max);
  }
  CHECK(make_phantom(Organ::ventricle, 3, coarse_mm, &progress).truth.empty());
  CHECK(make_spine_phantom(3, 3, &progress).structures.empty());
}
