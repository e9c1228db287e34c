#pragma once

#include <filesystem>

#include "app/verbs/verb.h"
#include "core/case/document.h"
#include "core/measure/compare.h"
#include "core/measure/meeting.h"
#include "core/mesh/mesh_io.h"
#include "core/volume/volume_io.h"

namespace homolog {

// The JSON that `info` prints, shared by every verb that reports "as info".
Json describe(const Mesh& mesh);
Json describe(const Volume& volume);
/// With its stiffness, landmarks and warnings. Errors: faces that are no manifold surface; `path` is named.
Result<Report> describe(const MeshFile& file, const std::filesystem::path& path);
/// Reads and describes whatever the file is. Errors: the reader's.
Result<Report> describe_file(const std::filesystem::path& path, const VolumeReadOptions& options,
                             std::optional<int> frame = {});

/// Warnings that each begin with the name of the file they are about.
std::vector<std::string> about(const std::filesystem::path& path, std::vector<std::string> warnings);

/// Warnings about a mesh whose volume counts: its reader's warnings, faces that look inward, and rims
/// that were closed.
std::vector<std::string> mesh_warnings(const std::filesystem::path& path, const MeshFile& file, const Mesh& mesh);

/// A file that meets another one, with the size of what it holds [meeting.h].
Meeting meeting_of(const std::filesystem::path& path, const Points& points);

/// The structure of a case that a verb works on.
struct ChosenStructure {
  std::string id;       ///< empty: the first
  std::string warning;  ///< a sentence where the case has several and none is named; else empty
};
/// Chooses one by its name or id; the first where none is named. Errors: the case has no such one.
Result<ChosenStructure> choose_structure(const Document& document, const std::filesystem::path& file,
                                         const std::string& name);

/// For what changes a case or works long before it writes a file. Errors: its folder is not there. An empty name is no
/// file.
Result<void> check_folder_of(const std::filesystem::path& to_write);

Json json_of(const Vec3& p);
/// {mean, p95, max}
Json json_of(const SurfaceDistance& distance);

}  // namespace homolog
