#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/model/joint_models/structure_parts.h"
#include "core/model/shapes/shape_files.h"

namespace homolog {

/// The shapes of one case, one for each structure that was asked for; without a file where it has none.
struct CaseFiles {
  std::string name;
  std::vector<ShapeSource> of_structure;
};

/// Which of ShapeWorks' two files of a shape: in the scan, or as ShapeWorks aligned them.
enum class ShapeWorksFrame { local, world };

/// The shapes of these structures, case by case in the order of the cases' names. Each of `files` is
/// - a folder of cases, CASE/STRUCTURE.ply [fit_set.h] or of another format that keeps vertices, or such a CASE itself.
///   A case file CASE.homolog beside CASE is taken in its place, as a whole, where it was worked on after the fit,
/// - a folder of ShapeWorks' with several domains, SUBJECT_DOMAIN_local.particles and _world.particles,
/// - a case file, in place of the folder CASE beside it, or a study, which stands for its cases that are fitted.
/// Names of structures are found in any case; a mesh .ply is taken before others of its name. Errors: fewer than
/// `least` structures, one twice, one that no case has (with the nearest names), two files of one case and structure,
/// ShapeWorks' files of the other frame alone, a folder, a case or a study that cannot be read, a study with a mesh.
Result<std::vector<CaseFiles>> structure_files(const std::vector<std::filesystem::path>& files,
                                               const std::vector<std::string>& structures,
                                               ShapeWorksFrame frame = ShapeWorksFrame::local, std::size_t least = 2);

/// Writes shapes of several structures (columns of `local`, in the scan, and of `world`, aligned; mm, LPS) into
/// `folder`, made where absent: NAME_STRUCTURE_local.particles and NAME_STRUCTURE_world.particles as ShapeWorks'
/// projects with several domains have them, and where there are triangles NAME/STRUCTURE.ply as aligned. Each file
/// whole or not at all. Errors: a name that cannot be a file's, the folder.
Result<void> write_structures(const ShapeMatrix& local, const ShapeMatrix& world, const Triangles& triangles,
                              const std::vector<StructurePart>& parts, const std::vector<std::string>& names,
                              const std::filesystem::path& folder);

}  // namespace homolog
