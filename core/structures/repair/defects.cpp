#include "core/structures/repair/defects.h"

#include <algorithm>

namespace homolog {

std::optional<DefectKind> defect_of_name(const std::string& name) {
  for (std::size_t k = 0; k < defect_names.size(); ++k)
    if (name == defect_names[k]) return static_cast<DefectKind>(k);
  return std::nullopt;
}

std::string sentence_of_defects(const std::vector<Defect>& defects) {
  std::string text;
  for (const Defect& defect : defects) {
    std::string words = defect_name(defect.kind);
    std::ranges::replace(words, '_', ' ');
    text += (text.empty() ? "" : ", ") + words + (defect.with.empty() ? "" : " (" + defect.with + ")");
  }
  return "Found: " + text + ".";
}

}  // namespace homolog
