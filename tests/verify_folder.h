#pragma once

#include "core/mesh/construction/icosphere.h"
#include "core/mesh/voxels/label_map.h"
#include "core/volume/volume_io.h"
#include "tests/ball_folder.h"

namespace homolog {

/// A ball as a template, and label maps of a larger and of a longer one.
struct VerifyFolder : BallFolder {
  VerifyFolder() {
    fs::create_directory(path / "data");
    fs::rename(path / "ball.ply", path / "data/ball.ply");
    Mesh longer = icosphere(3, 20);
    longer.points.col(2) *= 1.2;
    REQUIRE(write_volume(label_map(longer, grid), path / "data/long.nii.gz"));
    fs::rename(path / "good.nii.gz", path / "data/round.nii.gz");
  }
  std::string bytes(const fs::path& name) const { return read_whole_file(path / name).value(); }
};

inline Json verified(const TemporaryFolder& folder, const std::string& arguments) {
  const Ran ran = run(folder, "verify " + arguments + " --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  CHECK(ran.json()["largest_mm"] == 0);
  return ran.json();
}

/// Fits a set of the ball alone, data/ball.set.json, to the longer one, into sets/.
inline void fit_set_of_ball(const VerifyFolder& folder) {
  write_bytes(folder.path / "data/ball.set.json",
              R"({"homolog_set":1,"structures":[{"name":"A","value":1,"template":"ball.ply"}]})");
  REQUIRE(run(folder, "fit data/ball.set.json --mask data/long.nii.gz -o sets").status == 0);
}

/// A file that is not what its inputs give: the report all the same, and one sentence.
inline Json differs(const TemporaryFolder& folder, const std::string& arguments) {
  const Ran ran = run(folder, "verify " + arguments + " --json");
  INFO(ran.errors);
  CHECK(ran.status == 1);
  CHECK(lines(ran.errors) == 1);
  CHECK(ran.json()["same"] == false);
  return ran.json();
}

}  // namespace homolog
