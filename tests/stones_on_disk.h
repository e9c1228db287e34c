#pragma once

#include <doctest/doctest.h>

#include <array>

#include "core/structures/template_set.h"
#include "core/volume/labels/write_segmentation.h"
#include "tests/stones.h"
#include "tests/temporary_folder.h"

namespace homolog {

/// The five stones as files: their set, and a map of another subject in which the third is missing and the fourth has
/// a hollow.
struct StonesOnDisk {
  TemporaryFolder folder;
  std::filesystem::path set = folder.path / "stones.set.json", labels = folder.path / "labels.seg.nrrd";
  VolumeRead whole = stone_map(), map = whole;

  StonesOnDisk() {
    const SetOfTemplates stones_of = stone_set();
    TemplateSet files = stones_of.set;
    for (std::size_t k = 0; k < files.structures.size(); ++k) {
      files.structures[k].file = folder.path / (files.structures[k].name + ".ply");
      REQUIRE(write_mesh({stones_of.templates[k]->topology, stones_of.templates[k]->points}, files.structures[k].file));
    }
    REQUIRE(write_template_set(files, set));
    const Vec3 hollow = 1.04 * place_of(3);
    auto& voxels = std::get<std::vector<std::uint8_t>>(map.volume.data);
    const auto& dims = map.volume.geometry.dims;
    std::size_t v = 0;
    for (int k = 0; k < dims[2]; ++k)
      for (int j = 0; j < dims[1]; ++j)
        for (int i = 0; i < dims[0]; ++i, ++v) {
          const bool is_hollow = (map.volume.geometry.to_mm(Vec3(i, j, k)) - hollow).norm() < 6;
          if (voxels[v] == 3 || (voxels[v] == 4 && is_hollow)) voxels[v] = 0;
        }
    // A label of which the set knows nothing.
    voxels.front() = 9;
    map.segmentation.add({.name = "other", .value = 9, .layer = 0});
    REQUIRE(write_segmentation(map, labels));
  }
};

}  // namespace homolog
