#include "core/phantom/phantom_files.h"

#include <doctest/doctest.h>
#include <unistd.h>

#include "core/mesh/files/landmark_io.h"
#include "core/volume/volume_io.h"

using namespace homolog;
namespace fs = std::filesystem;

TEST_CASE("a phantom's files hold what was made") {
  const fs::path folder = fs::temp_directory_path() / ("homolog-phantom-" + std::to_string(::getpid()));
  const auto paths = write_phantom(Organ::ventricle, 1, folder / "new");
  REQUIRE(paths);
  CHECK(paths->size() == 23);
  for (const fs::path& path : *paths) CHECK(fs::exists(path));
  const auto truth = phantom_truth(Organ::ventricle, 1);
  const auto image = read_volume(folder / "new" / "ventricle-1-image.nii.gz");
  REQUIRE(image);
  CHECK(image->volume.frames == 20);
  CHECK(read_mesh_file(folder / "new" / "ventricle-1-truth-07.ply")->points == truth[7].points);
  CHECK(read_landmarks(folder / "new" / "ventricle-1-landmarks.mrk.json").value() == truth[0].landmarks);
  fs::remove_all(folder);
  CHECK(!write_phantom(Organ::kidney, 0, "/dev/null/folder"));
}

TEST_CASE("a spine's files hold its names and a mesh of each structure") {
  const fs::path folder = fs::temp_directory_path() / ("homolog-spine-" + std::to_string(::getpid()));
  const auto paths = write_spine_phantom(4, folder);
  REQUIRE(paths);
  for (const fs::path& path : *paths) CHECK(fs::exists(path));
  const auto truth = spine_phantom_truth(4);
  CHECK(paths->size() == truth.size() + 4);
  const auto labels = read_volume(folder / "spine-4-labels.nii.gz");
  REQUIRE(labels);
  for (const SceneStructure& one : truth) {
    const auto mesh = read_mesh_file(folder / "spine-4-truth" / (one.name + ".ply"));
    REQUIRE(mesh);
    CHECK(mesh->points == one.truth.points);
    CHECK(mesh->landmarks == one.truth.landmarks);
  }
  CHECK(read_landmarks(folder / "spine-4-landmarks.mrk.json")->front().name ==
        "vertebrae_T12 " + truth.front().truth.landmarks.front().name);
  fs::remove_all(folder);
  CHECK(!write_spine_phantom(0, "/dev/null/folder"));
}
