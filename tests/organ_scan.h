#pragma once

#include <doctest/doctest.h>
#include <filesystem>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "core/case/document.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/volume/volume.h"
#include "tests/must.h"
#include "tests/temporary_folder.h"

namespace homolog {

/// An organ of 22 mm in a body, in CT numbers and without noise, so that pictures of it stay small; and a template of
/// 20 mm with a region and landmarks.
struct OrganScan {
  TemporaryFolder folder;

  static VolumeGeometry grid() {
    VolumeGeometry grid;
    grid.dims = {64, 64, 48};
    grid.spacing_mm = Vec3(1.5, 1.5, 2);
    grid.origin_mm = Vec3(-47, -47, -47);
    return grid;
  }
  static std::shared_ptr<const Volume> image() {
    auto volume = std::make_shared<Volume>();
    volume->geometry = grid();
    volume->modality = "CT";
    std::vector<std::int16_t> values(volume->geometry.voxels());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Vec3 p = volume->geometry.to_mm(
          Vec3(static_cast<double>(i % 64), static_cast<double>(i / 64 % 64), static_cast<double>(i / 4096)));
      const auto inside = [](double depth_mm) { return std::clamp(0.5 + depth_mm / 2, 0.0, 1.0); };
      const double body = inside(1 - p.cwiseQuotient(Vec3(44, 36, 200)).norm() > 0 ? 2 : -2),
                   organ = inside(22 - p.norm()), bone = inside(7 - (p - Vec3(0, 30, 0)).head<2>().norm());
      double value = -1000 + body * 950;
      value += organ * (150 - value);
      value += bone * (600 - value);
      values[i] = static_cast<std::int16_t>(std::lround(value));
    }
    volume->data = std::move(values);
    volume->range_min = -1000;
    volume->range_max = 600;
    return volume;
  }
  /// With landmarks of these names.
  Document document(const std::vector<std::string>& names = {"upper end", "lower end", "hilum"},
                    const std::string& file_name = "organ.ply") const {
    const Mesh mesh = icosphere(3, 20);
    MeshFile file{mesh.points, mesh.topology->triangles()};
    for (std::size_t k = 0; k < names.size(); ++k) {
      const double turn = 2.1 * static_cast<double>(k);
      file.landmarks.push_back({names[k], 20 * Vec3(std::sin(turn), 0, std::cos(turn))});
    }
    const std::filesystem::path path = folder.path / file_name;
    REQUIRE(write_mesh_file(file, path));
    return new_document((folder.path / "scan.nii").string(), image(), test::must(load_template(path.string())));
  }
};

}  // namespace homolog
