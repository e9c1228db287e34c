#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "core/case/document.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"

#include "core/catalogue/catalogue.h"
#include "core/volume/volume_io.h"
#include "tests/must.h"
#include "tests/temporary_folder.h"

namespace homolog {

/// Files and a case with these names.
struct Named {
  TemporaryFolder folder;
  std::vector<std::string> names;
  Document document = new_document({}, nullptr, nullptr);
  std::vector<std::filesystem::path> shapes;
  std::filesystem::path labels;

  explicit Named(std::vector<std::string> given) : names(std::move(given)) {
    if (names.empty()) return;
    const Mesh ball = icosphere(2, 40);
    MeshFile file{ball.points, ball.topology->triangles()};
    for (std::size_t k = 0; k < names.size(); ++k) {
      const double turn = 2.4 * static_cast<double>(k);
      file.landmarks.push_back({names[k], 40 * Vec3(std::cos(turn), std::sin(turn), 0)});
      MeshFile shape{ball.points, ball.topology->triangles()};
      shape.points.col(0) *= 1 + 0.1 * static_cast<double>(k);
      shape.points(static_cast<Eigen::Index>(k), 1) += 5;
      shapes.push_back(folder.path / (names[k].substr(0, 200) + ".ply"));
      REQUIRE(write_mesh_file(shape, shapes.back()));
    }
    const std::filesystem::path with_landmarks = folder.path / "template.ply";
    REQUIRE(write_mesh_file(file, with_landmarks));
    Volume volume;
    volume.geometry.dims = {24, 24, 24};
    volume.geometry.spacing_mm = Vec3::Constant(5);
    volume.geometry.origin_mm = Vec3::Constant(-60);
    std::vector<std::uint8_t> voxels(volume.geometry.voxels(), 0);
    for (std::size_t v = 0; v < voxels.size() / 2; ++v) voxels[v] = v % 3 == 0 ? 2 : 1;
    volume.data = std::move(voxels);
    volume.range_max = 2;
    labels = folder.path / (names.front().substr(0, 200) + ".nii.gz");
    REQUIRE(write_volume(volume, labels));
    document = new_document(labels.string(), std::make_shared<const Volume>(std::move(volume)),
                            test::must(load_template(with_landmarks.string())));
  }
};

}  // namespace homolog
