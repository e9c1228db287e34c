#include "core/base/processes/parallel.h"
#include "core/mesh/voxels/voxelise.h"
#include "core/phantom/imaging.h"
#include "core/phantom/phantom_scene.h"
#include "core/phantom/spine_image.h"
#include "core/phantom/spine_meshes.h"

namespace homolog {
namespace {

/// The image's box: all of the spine, the vessels in front of it, the muscles behind it.
Box field_of_view(const std::vector<SceneStructure>& structures) {
  Box box;
  for (const SceneStructure& one : structures) box.extend(bounds_of(one.truth.points));
  box.min() -= Vec3(14, 34, 6);
  box.max() += Vec3(14, 12, 6);
  return box;
}

/// Each voxel that lies inside a structure has its value; no two structures share one.
Volume label_map_of(const std::vector<SceneStructure>& structures, const VolumeGeometry& grid) {
  std::vector<std::vector<std::uint8_t>> inside(structures.size());
  for_each_in_parallel(structures.size(), [&](std::size_t s) {
    const MeshFile& truth = structures[s].truth;
    inside[s] = voxelise({Topology::make(truth.points.rows(), truth.triangles).value(), truth.points}, grid);
  });
  std::vector<std::uint8_t> labels(grid.voxels());
  for (std::size_t s = 0; s < structures.size(); ++s)
    for (std::size_t n = 0; n < labels.size(); ++n)
      if (inside[s][n] != 0 && labels[n] == 0) labels[n] = static_cast<std::uint8_t>(structures[s].value);
  Volume map;
  map.geometry = grid;
  map.data = std::move(labels);
  phantom::note_range(map);
  return map;
}

}  // namespace

std::vector<SceneStructure> spine_phantom_truth(int subject) {
  return phantom::spine_meshes(subject).structures;
}

PhantomScene make_spine_phantom(int subject, double spacing_mm, const Progress* progress) {
  phantom::SpineMeshes spine = phantom::spine_meshes(subject);
  if (phantom::is_cancelled(progress)) return {};
  const VolumeGeometry grid = phantom::grid_over(field_of_view(spine.structures), spacing_mm, 1);
  PhantomScene scene;
  scene.image = phantom::spine_image(spine, subject, grid, progress);
  if (phantom::is_cancelled(progress)) return {};
  scene.label_map = label_map_of(spine.structures, grid);
  for (const SceneStructure& one : spine.structures) scene.segmentation.add({.name = one.name, .value = one.value});
  colour_by_names(scene.segmentation);
  scene.structures = std::move(spine.structures);
  return scene;
}

}  // namespace homolog
