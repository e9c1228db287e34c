#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/numbers/geometry.h"
#include "core/base/result.h"
#include "core/mesh/topology.h"

namespace homolog {

/// The corners of tetrahedra, as indices of points.
using Tetrahedra = Eigen::Matrix<std::int32_t, Eigen::Dynamic, 4, Eigen::RowMajor>;

/// The file that a volume mesh was read from, kept to be written again with other points.
struct VolumeFile;

/// A body cut into tetrahedra, as a user brings it.
struct VolumeMesh {
  Points points;                      ///< n×3, LPS mm (flipped on reading where the file says SPACE=RAS)
  Tetrahedra tetrahedra;              ///< m×4, each of positive volume
  std::vector<std::string> warnings;  ///< remarks on what was read, each a sentence
  std::shared_ptr<const VolumeFile> file;
};

/// Reads the tetrahedra of a .vtu or .msh file. A file whose tetrahedra are all turned over counts them the other way
/// round. Errors: those of read_mesh_file; no tetrahedra, another kind of element, some that are turned over or flat.
Result<VolumeMesh> read_volume_mesh(const std::filesystem::path& path);
/// How the name of its file ends: ".vtu" or ".msh".
std::string volume_mesh_extension(const VolumeMesh& mesh);

/// Writes that file again with other points, whole or not at all. All else stays byte for byte: values of points and
/// elements, names, groups. `points`: n×3, LPS mm; in the file they have the space that it had.
Result<void> write_volume_mesh(const VolumeMesh& mesh, const Points& points, const std::filesystem::path& path);

/// The scaled Jacobian of each tetrahedron: √2 times six times its volume, divided by the largest product of the three
/// edges that meet in a corner. 1 where it is regular, 0 where it is flat, negative where it is turned over. Source:
/// Knupp et al. 2006, The Verdict Geometric Quality Library.
VertexScalars scaled_jacobians(const Tetrahedra& tetrahedra, const Points& points);

/// Six times the volume of each, in mm³; negative where it is turned over.
VertexScalars sixfold_volumes(const Tetrahedra& tetrahedra, const Points& points);

/// Which points lie on the outside.
std::vector<char> on_outside(const VolumeMesh& mesh);

/// The outside as a surface of its own, LPS mm; nothing where its faces are no manifold.
std::optional<Mesh> outside_of(const VolumeMesh& mesh);

}  // namespace homolog
