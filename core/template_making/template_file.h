#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/mesh/mesh_io.h"
#include "core/template_making/mask_template.h"
#include "core/template_making/tube_template.h"

namespace homolog {

/// The template file of a mesh just made: uniform stiffness, the unit, and how it was made
/// (`comment homolog.provenance {…}`).
MeshFile template_file(const Mesh& mesh, const nlohmann::ordered_json& provenance);

/// Marks where the scan cut the organ of a template off: the region cut_region.
void mark_cut(MeshFile& file, const std::vector<std::int32_t>& vertices);

/// The source (a file's name) and the settings.
nlohmann::ordered_json provenance_of(const std::string& source, const MaskTemplateOptions& options);
nlohmann::ordered_json provenance_of(const std::string& source, const TubeTemplateOptions& options);

/// "auto", "keep" or the number, as `--genus` takes it.
std::string genus_text(const GenusRule& rule);

}  // namespace homolog
