#pragma once

#include <algorithm>
#include <filesystem>
#include <variant>

#include "core/base/encoding/json.h"
#include "core/base/files/files.h"
#include "core/mesh/files/landmark_io.h"
#include "core/mesh/mesh_io.h"
#include "core/volume/volume_io.h"

/// Readers as one function each, for fuzzing (tests/fuzz) and for measuring (tests/read_one_file.cpp). Each returns how
/// many bytes the values take that it read.
namespace homolog::test {

inline Result<double> read_a_volume(const std::filesystem::path& path) {
  const auto read = read_volume(path, {.stack_spacing_mm = Vec3(1, 1, 1)});
  if (!read) return fail(read.error());
  return std::visit([](const auto& voxels) { return static_cast<double>(voxels.size() * sizeof voxels[0]); },
                    read->volume.data);
}

inline double bytes_of(const MeshFile& mesh) {
  double doubles = static_cast<double>(mesh.points.size() + 4 * std::ssize(mesh.landmarks));
  if (mesh.stiffness) doubles += static_cast<double>(mesh.stiffness->size());
  for (const auto* values : {&mesh.doubt_mm, &mesh.outlier})
    if (*values) doubles += static_cast<double>((*values)->size());
  for (const auto& [name, values] : mesh.arrays) doubles += static_cast<double>(values.size());
  return 8 * doubles + 4 * static_cast<double>(mesh.triangles.size()) +
         static_cast<double>(mesh.regions.of_vertex.size());
}

inline Result<double> read_a_mesh(const std::filesystem::path& path) {
  const auto mesh = read_mesh_file(path);
  if (!mesh) return fail(mesh.error());
  return bytes_of(*mesh);
}

inline Result<double> read_some_landmarks(const std::filesystem::path& path) {
  const auto landmarks = read_landmarks(path);
  if (!landmarks) return fail(landmarks.error());
  return static_cast<double>(landmarks->size() * sizeof(Landmark));
}

inline Result<double> read_some_json(const std::filesystem::path& path) {
  const auto text = read_whole_file(path);
  if (!text) return fail(text.error());
  const auto json = read_json<nlohmann::ordered_json>(*text);
  if (!json) return fail(json.error());
  return static_cast<double>(text->size());
}

}  // namespace homolog::test
