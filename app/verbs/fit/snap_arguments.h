#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "app/verbs/verb.h"
#include "core/adapt/snap.h"

namespace homolog {

/// The arguments of the verbs that look for the boundary in an image.
struct SnapArguments {
  int frame = 0;
  double reach_mm = 10, strength = 1;
  std::string polarity = "automatic";
  std::vector<std::pair<std::string, std::string>> done;  ///< meshes of cases that are done, and their images
};

void add_snap_arguments(CLI::App& verb, SnapArguments& arguments);

/// Reads the cases that are done. Errors: unreadable, of different templates, not of `vertices`.
Result<SnapOptions> snap_options(const SnapArguments& arguments, Eigen::Index vertices, Progress& progress);

/// The report of a snap; `placed` is what turned triangles are counted against. Warnings name `path`.
Report snap_report(const SnapResult& result, const Mesh& mesh, const Points& placed, const std::filesystem::path& path);

}  // namespace homolog
