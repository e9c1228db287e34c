#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/mesh/parts/regions.h"
#include "core/mesh/shared_triangles.h"

namespace homolog {

/// Names of landmarks and regions that files hold are at most this long, in bytes.
constexpr std::size_t longest_name = 255;

/// A named point on the surface of a template (or clicked in an image), LPS mm.
struct Landmark {
  std::string name;
  Vec3 position = Vec3::Zero();
  bool operator==(const Landmark&) const = default;
};

/// w of a vertex of factor 1 where a file does not say. Measured (docs/measurements/ways-of-working.md): fewer strokes
/// than with 10, and no larger error.
constexpr double default_stiffness_base = 3;

/// The content of a mesh file. A template is a mesh whose `stiffness` and `landmarks` are filled.
struct MeshFile {
  Points points;                                   ///< n×3, LPS mm (flipped on reading where the file says SPACE=RAS)
  SharedTriangles triangles;                       ///< m×3; empty for a `.particles` file
  std::shared_ptr<const VertexScalars> stiffness;  ///< per-vertex factors, > 0; null: none. Meshes of one kind share it
  double stiffness_base = default_stiffness_base;  ///< `comment homolog.stiffness_base B`; w_i = base × factor_i
  std::optional<VertexScalars> outlier;            ///< 1: found missing [FitResult::outliers]; not by OBJ, STL
  std::optional<VertexScalars> doubt_mm;           ///< a fit's doubt of each vertex: see FitResult; not by OBJ, STL
  Regions regions;                    ///< `comment homolog.region {"name":…,"factor":…,"colour":"#rrggbb"}`
  std::vector<Landmark> landmarks;    ///< `comment homolog.landmark {"name":…,"position":[x,y,z]}`
  std::vector<std::string> comments;  ///< every other comment line, kept as it was
  std::map<std::string, VertexScalars> arrays;  ///< further per-vertex values by name, as they were read; not written
  std::map<std::string, VertexScalars> values;  ///< further ones to write, as properties of PLY and arrays of VTK, VTP
  std::vector<std::string> warnings;            ///< what was mended on reading, each a sentence
  /// What is behind it where the faces are no sound surface, as the end of a sentence: " (…)"; empty: nothing is known.
  std::string likely_cause{};
  std::string record;  ///< to write: how the mesh was made [file_record.h]; empty: nothing is said. Never read here
  bool may_be_cut = false;  ///< `.particles` without a line break at the end: points may be missing
};

/// What a fit says of each vertex, as PLY, VTK, VTP, VTU and Gmsh keep it.
struct FitValue {
  const char* name;  ///< in the file
  std::optional<VertexScalars> MeshFile::*of;
  bool is_mark = false;  ///< it is 0 or 1
};
inline constexpr std::array fit_values{FitValue{"doubt_mm", &MeshFile::doubt_mm},
                                       FitValue{"outlier", &MeshFile::outlier, true}};
/// The one of a name; null: it is none of them.
constexpr const FitValue* fit_value(std::string_view name) {
  for (const FitValue& value : fit_values)
    if (name == value.name) return &value;
  return nullptr;
}

/// Reads a mesh of one of the formats in formats/, chosen by extension; of PLY and VTK text and binary alike. Order and
/// count are kept; polygons are split into triangles within. Errors: absent, truncated, not of its kind, a count that
/// the file's size belies, NaN or infinite coordinates, places beyond farthest_mm, an index out of range.
Result<MeshFile> read_mesh_file(const std::filesystem::path& path);

/// The same of a file to be mended [mesh_repair.h]: coordinates need not be finite.
Result<MeshFile> read_mesh_to_mend(const std::filesystem::path& path);

/// Writes the format of the extension (binary, with double coordinates where it can), tagged SPACE=LPS where the format
/// can, whole or not at all. PLY alone keeps landmarks and comments; VTK, VTP, VTU and Gmsh keep values of vertices.
/// The record is in the file, or beside it where the format has no place for it; one that lies there and is of no more
/// use is removed.
Result<void> write_mesh_file(const MeshFile& mesh, const std::filesystem::path& path);

/// Whether the name ends as one of the formats that read_mesh_file takes does.
bool is_mesh_name(const std::filesystem::path& path);
/// Whether that format keeps vertices and their order, as shapes of a model need.
bool keeps_numbers(const std::filesystem::path& path);

/// The faces of a file as a mesh. Errors: Topology::make's; a seam of duplicate vertices that was never closed.
Result<Mesh> sound_mesh(const MeshFile& file);

/// The topology of a file's faces: `known` where that has the same, else a new one, which `known` becomes. So meshes of
/// one kind share theirs. Errors: faces that are no surface.
Result<std::shared_ptr<const Topology>> shared_topology(const MeshFile& file, std::shared_ptr<const Topology>& known);

/// read_mesh_file, then sound_mesh with the file named in the error.
Result<Mesh> read_mesh(const std::filesystem::path& path);
Result<void> write_mesh(const Mesh& mesh, const std::filesystem::path& path);

}  // namespace homolog
