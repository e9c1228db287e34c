#pragma once

#include <doctest/doctest.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/case/document.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/volume/volume_io.h"
#include "tests/must.h"
#include "tests/temporary_folder.h"

namespace homolog {

namespace fs = std::filesystem;

/// A ball of 20 mm as a template, and images of 50 mm in which it may lie.
struct Globe {
  TemporaryFolder folder;
  fs::path file = folder.path / "globe.ply";

  Globe() {
    const Mesh mesh = icosphere(3, 20);
    REQUIRE(write_mesh_file({mesh.points, mesh.topology->triangles()}, file));
  }
  static VolumeGeometry grid() {
    VolumeGeometry grid;
    grid.dims = {60, 60, 60};
    grid.origin_mm.setConstant(-29.5);
    return grid;
  }
  /// Grey values 0 … 99; `frames` of them.
  fs::path image(const std::string& name, int frames = 1) const {
    Volume volume;
    volume.geometry = grid();
    volume.frames = frames;
    std::vector<std::int16_t> values(volume.geometry.voxels() * static_cast<std::size_t>(frames));
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<std::int16_t>((i * 7919) % 100);
    volume.data = std::move(values);
    REQUIRE(write_volume(volume, folder.path / name));
    return folder.path / name;
  }
  Document document() const { return new_document("", nullptr, test::must(load_template(file.string()))); }
  Document on(const fs::path& path) const {
    const auto volume = std::make_shared<const Volume>(test::must(read_volume(path)).volume);
    return new_document(path.string(), volume, test::must(load_template(file.string())));
  }
};

/// A ball as a label map of its own.
inline void write_ball_map(const fs::path& file, double radius_mm, const Vec3& centre) {
  Mesh ball = icosphere(4, radius_mm);
  ball.points.rowwise() += centre.transpose();
  REQUIRE(write_volume(label_map(ball, Globe::grid(), 1), file));
}

}  // namespace homolog
