#pragma once

#include <optional>

#include "core/mesh/topology.h"

namespace homolog {

/// A mesh without a rim, for what has a sense of closed surfaces only, such as whether a place lies within. A view: it
/// holds no points, and the mesh outlives it and does not change meanwhile.
class ClosedMesh {
 public:
  /// None where the mesh has a rim, or no faces. The connectivity knows, so that this takes no time.
  static std::optional<ClosedMesh> of(const Mesh& mesh) {
    if (!mesh.topology || !mesh.topology->closed()) return std::nullopt;
    return ClosedMesh(mesh);
  }
  static std::optional<ClosedMesh> of(const Mesh&& mesh) = delete;  // it would not outlive the view

  const Mesh& mesh() const { return *mesh_; }
  const Points& points() const { return mesh_->points; }

 private:
  explicit ClosedMesh(const Mesh& mesh) : mesh_(&mesh) {}

  const Mesh* mesh_;  ///< not null
};

}  // namespace homolog
