#pragma once

#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/volume/volume_io.h"
#include "tests/command_line.h"
#include "tests/shapes.h"

namespace homolog {

/// A folder with a ball as a mesh and as a label map.
struct BallFolder : TemporaryFolder {
  Mesh ball = icosphere(3, 20);
  VolumeGeometry grid;

  BallFolder() {
    grid.dims = {30, 30, 30};
    grid.spacing_mm.setConstant(2);
    grid.origin_mm.setConstant(-29);
    REQUIRE(write_mesh(ball, path / "ball.ply"));
    REQUIRE(write_volume(label_map(ball, grid), path / "good.nii.gz"));
  }
};

/// … and as a mesh with landmarks, named.ply, a second label map and a folder for landmark files.
struct NamedBallFolder : BallFolder {
  NamedBallFolder() {
    MeshFile named{ball.points, ball.topology->triangles()};
    named.landmarks = {{"top", {0, 0, 20}}, {"left", {20, 0, 0}}, {"back", {0, 20, 0}}};
    REQUIRE(write_mesh_file(named, path / "named.ply"));
    fs::create_directory(path / "places");
    fs::copy(path / "good.nii.gz", path / "other.nii.gz");
  }
};

}  // namespace homolog
