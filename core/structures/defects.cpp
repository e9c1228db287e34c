#include "core/structures/defects.h"

namespace homolog {

std::optional<DefectKind> defect_of_name(const std::string& name) {
  for (std::size_t k = 0; k < defect_names.size(); ++k)
    if (name == defect_names[k]) return static_cast<DefectKind>(k);
  return std::nullopt;
}

}  // namespace homolog
