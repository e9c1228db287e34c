#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/base/numbers/random.h"
#include "core/base/processes/parallel.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/voxels/voxelise.h"
#include "core/phantom/phantom_scene.h"
#include "core/phantom/spine_levels.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

Mesh surface_of(const SceneStructure& one) {
  return {Topology::make(one.truth.points.rows(), one.truth.triangles).value(), one.truth.points};
}

VolumeGeometry grid_around(const std::vector<SceneStructure>& structures, double spacing_mm) {
  Box box;
  for (const SceneStructure& one : structures) box.extend(bounds_of(one.truth.points));
  VolumeGeometry grid;
  grid.spacing_mm.setConstant(spacing_mm);
  grid.origin_mm = box.min();
  for (std::size_t axis = 0; axis < 3; ++axis)
    grid.dims[axis] = static_cast<int>(box.sizes()[static_cast<Eigen::Index>(axis)] / spacing_mm) + 2;
  return grid;
}

template <class Voxels>
std::uint64_t spine_hash(const Voxels& voxels) {
  std::uint64_t hash = 0;
  for (const auto voxel : voxels) hash = mix_bits(hash ^ static_cast<std::uint64_t>(voxel));
  return hash;
}

/// How many voxels lie inside two structures; says which.
std::size_t shared_voxels(const std::vector<SceneStructure>& structures, double spacing_mm) {
  const VolumeGeometry grid = grid_around(structures, spacing_mm);
  std::vector<std::uint8_t> owner(grid.voxels());
  std::map<std::string, std::size_t> shared;
  std::size_t all = 0;
  for (std::size_t s = 0; s < structures.size(); ++s) {
    const auto inside = voxelise(surface_of(structures[s]), grid);
    for (std::size_t n = 0; n < inside.size(); ++n) {
      if (inside[n] == 0) continue;
      if (owner[n] != 0) ++all, ++shared[structures[owner[n] - 1U].name + " and " + structures[s].name];
      owner[n] = static_cast<std::uint8_t>(s + 1);
    }
  }
  for (const auto& [pair, count] : shared) MESSAGE(pair << " share " << count << " voxels");
  return all;
}

}  // namespace

TEST_CASE("the same number gives the same spine on every machine and with any threads") {
  const auto hash = [](const PhantomScene& scene) {
    return spine_hash(std::get<std::vector<std::int16_t>>(scene.image.data)) ^
           mix_bits(spine_hash(std::get<std::vector<std::uint8_t>>(scene.label_map.data)));
  };
  const int threads = thread_limit();
  CHECK(hash(make_spine_phantom(3, 3)) == 0x51dc667263713415U);
  set_thread_limit(1);
  CHECK(hash(make_spine_phantom(3, 3)) == 0x51dc667263713415U);
  set_thread_limit(threads);
}

TEST_CASE("most spines have five lumbar vertebrae and some have four or six") {
  CHECK(phantom::lumbar_levels(0) == 5);
  std::map<int, int> subjects;
  for (int subject = 0; subject < 30; ++subject) ++subjects[phantom::lumbar_levels(subject)];
  CHECK(subjects.size() == 3);
  CHECK(subjects[4] == 5);
  CHECK(subjects[6] == 5);
  for (const int subject : {0, 1, 2, 3, 4, 5}) {
    const auto structures = spine_phantom_truth(subject);
    const int lumbar = phantom::lumbar_levels(subject);
    REQUIRE(structures.size() == static_cast<std::size_t>(2 * lumbar + 3));
    CHECK(structures.front().name == "vertebrae_T12");
    CHECK(structures[2].name == "vertebrae_L1");
    CHECK(structures[3].name == "disc_L1_L2");
    CHECK(structures[structures.size() - 3].name == "vertebrae_L" + std::to_string(lumbar));
    CHECK(structures[structures.size() - 2].name == "disc_L" + std::to_string(lumbar) + "_S1");
    CHECK(structures.back().name == "sacrum");
  }
}

TEST_CASE("vertices of the spine agree between subjects and so do labels and landmarks") {
  const auto mean = spine_phantom_truth(0);
  std::map<std::string, int> values;
  std::map<char, const MeshFile*> of_kind;  // vertebra, disc, sacrum
  for (const SceneStructure& one : mean) of_kind[one.name.front()] = &one.truth;
  CHECK(of_kind.size() == 3);
  for (int subject = 0; subject < 8; ++subject) {
    std::set<int> used;
    for (const SceneStructure& one : spine_phantom_truth(subject)) {
      CAPTURE(one.name);
      const MeshFile& same = *of_kind.at(one.name.front());
      CHECK(one.truth.triangles == same.triangles);
      REQUIRE(one.truth.landmarks.size() == same.landmarks.size());
      CHECK(one.truth.landmarks.front().name == same.landmarks.front().name);
      CHECK(values.emplace(one.name, one.value).first->second == one.value);
      CHECK(used.insert(one.value).second);
    }
  }
}

TEST_CASE("vertebrae are wider the lower they lie and the spine curves forwards") {
  const auto spine = spine_phantom_truth(0);
  const auto landmark = [&](std::size_t vertebra, const std::string& name) {
    for (const Landmark& one : spine[2 * vertebra].truth.landmarks)
      if (one.name == name) return one.position;
    return Vec3(Vec3::Zero());
  };
  const auto tilt_deg = [&](std::size_t vertebra) {
    const Vec3 up = landmark(vertebra, "body anterior superior") - landmark(vertebra, "body anterior inferior");
    return std::atan2(-up.y(), up.z()) * 180 / 3.14159265;
  };
  for (std::size_t k = 1; k < 6; ++k) {
    const auto width = [&](std::size_t vertebra) {
      return landmark(vertebra, "body left lateral").x() - landmark(vertebra, "body right lateral").x();
    };
    CHECK(width(k) > width(k - 1));
    CHECK(tilt_deg(k) > tilt_deg(k - 1));
    CHECK(bounds_of(spine[2 * k].truth.points).center().z() < bounds_of(spine[2 * k - 2].truth.points).center().z());
  }
}

TEST_CASE("discs touch the bones above and below them") {
  for (const int subject : {0, 1, 4}) {
    const auto spine = spine_phantom_truth(subject);
    for (std::size_t disc = 1; disc < spine.size(); disc += 2)
      for (const std::size_t bone : {disc - 1, disc + 1}) {
        const SurfaceSearch search(surface_of(spine[bone]));
        double nearest_mm = 1e9;
        for (Eigen::Index i = 0; i < spine[disc].truth.points.rows(); ++i)
          nearest_mm = std::min(nearest_mm, search.nearest(spine[disc].truth.points.row(i)).distance_mm);
        CAPTURE(spine[disc].name);
        CHECK(nearest_mm < 0.5);
      }
  }
}

TEST_CASE("the spine's label map is the inside of the true surfaces and bears their names") {
  const PhantomScene scene = make_spine_phantom(1, 1.5);
  const VolumeGeometry& grid = scene.label_map.geometry;
  CHECK(same_grid(grid, scene.image.geometry));
  const auto& labels = std::get<std::vector<std::uint8_t>>(scene.label_map.data);
  std::vector<std::uint8_t> all(labels.size());
  for (const SceneStructure& one : scene.structures) {
    CAPTURE(one.name);
    const auto inside = voxelise(surface_of(one), grid);
    std::size_t differing = 0;
    for (std::size_t n = 0; n < labels.size(); ++n) {
      differing += (labels[n] == one.value) != (inside[n] == 1);
      all[n] = static_cast<std::uint8_t>(all[n] + inside[n]);
    }
    CHECK(differing == 0);
    CHECK(grid.bounds_mm().contains(bounds_of(one.truth.points)));
    const Segment* named = scene.segmentation.find(one.value);
    REQUIRE(named != nullptr);
    CHECK(named->name == one.name);
  }
  CHECK(*std::max_element(all.begin(), all.end()) == 1);
}

TEST_CASE("the spine's image shows bone inside the true surfaces of the bones") {
  const PhantomScene scene = make_spine_phantom(2, 1.5);
  for (std::size_t k = 0; k < scene.structures.size(); k += 2) {
    const Mesh truth = surface_of(scene.structures[k]);
    const Points normals = vertex_normals(truth);
    double inside = 0, outside = 0;
    for (Eigen::Index i = 0; i < truth.points.rows(); ++i) {
      const Vec3 p = truth.points.row(i), n = normals.row(i);
      inside += scene.image.sample(p - n, -1000);
      outside += scene.image.sample(p + 2 * n, -1000);
    }
    CAPTURE(scene.structures[k].name);
    CHECK((inside - outside) / static_cast<double>(truth.points.rows()) > 200);
  }
}

TEST_CASE("structures of the spine share no voxel") {
  CHECK(shared_voxels(spine_phantom_truth(0), 0.6) == 0);
  for (int subject = 0; subject < 20; ++subject) {
    CAPTURE(subject);
    CHECK(shared_voxels(spine_phantom_truth(subject), 1) == 0);
  }
}

TEST_CASE("surfaces of the spine are closed and not folded") {
  for (int subject = 0; subject < 12; ++subject)
    for (const SceneStructure& one : spine_phantom_truth(subject)) {
      CAPTURE(subject);
      CAPTURE(one.name);
      const Mesh mesh = surface_of(one);
      CHECK(mesh.topology->closed());
      CHECK(mesh.topology->genus() == (one.name.starts_with("vertebrae") ? 1 : 0));
      CHECK(self_intersections(mesh).empty());
      CHECK(enclosed_volume_ml(mesh) > 1);
    }
}
