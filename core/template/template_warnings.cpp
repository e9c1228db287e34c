#include "core/template/template_warnings.h"

#include <filesystem>

#include "core/mesh/mesh_io.h"
#include "core/mesh/repair/inside_out.h"

namespace homolog {

std::vector<std::string> template_warnings(const Template& the_template) {
  std::vector<std::string> warnings;
  std::error_code ignored;
  const std::filesystem::path path = the_template.source;
  if (!is_mesh_name(path) || !std::filesystem::exists(path, ignored)) return warnings;
  if (const auto file = read_mesh_file(path))
    for (const std::string& warning : file->warnings) warnings.push_back(path.string() + ": " + warning);
  if (auto inward = inside_out({the_template.topology, the_template.points}))
    warnings.push_back(path.string() + ": " + *inward);
  return warnings;
}

}  // namespace homolog
