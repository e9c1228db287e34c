#pragma once

#include "app/verbs/verb.h"
#include "core/mesh/repair/mesh_repair.h"
#include "core/template_making/mesh_template.h"

namespace homolog {

// The verbs' words on surfaces that were mended.

/// Counts by name, as `mended` in the reports of `repair-mesh`, `template` and `info`.
Json json_of(const MendedFaults& mended);
/// A surface made anew from voxels: `rebuilt` in reports.
Json json_of(const Rebuilt& rebuilt);

/// `--genus auto|keep|N`, checked when parsed.
GenusRule genus_rule(const std::string& text);
void add_genus_option(CLI::App& verb, std::string& genus, const std::string& help);

/// `--holes small|all|keep`, and the share of the diagonal up to which the rim of a hole is closed by it.
void add_holes_option(CLI::App& verb, std::string& holes);
double longest_rim_share(const std::string& holes);

/// The faults of a mesh that was made, each a sentence about `path`.
std::vector<std::string> faults_of(const MeshFile& file, const std::filesystem::path& path);

}  // namespace homolog
