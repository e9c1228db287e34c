#include "core/phantom/phantom_files.h"

#include <doctest/doctest.h>
#include <unistd.h>

#include "core/mesh/landmark_io.h"
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
