#include "app/editor/state/looks_to_keep.h"

#include <algorithm>

#include "app/editor/state/state.h"
#include "core/base/text/text.h"
#include "core/catalogue/catalogue.h"

namespace homolog {

KeptLooks looks_to_keep(const EditorState& state, const std::filesystem::path& case_file) {
  KeptLooks kept = kept_looks(state.look.structures, state.look.structure);
  const auto named = [&](const std::string& source) {
    const std::string name = relative_source(case_file.parent_path(), source);
    return is_utf8(name) ? name : std::string();
  };
  kept.set = named(state.automatic.set_source);
  const Measurements& measurements = state.measurements;
  const auto shipped = shipped_recipes();
  const bool ships = std::ranges::find(shipped, measurements.source) != shipped.end();
  // The recipe of the template is found again without its name.
  if (measurements.chosen || !measurements.drawn.empty())
    kept.recipe = ships ? measurements.source : named(measurements.source);
  kept.measured.assign(measurements.drawn.begin(), measurements.drawn.end());
  if (state.scoring.by_file) kept.model = named(state.scoring.file.string());
  return kept;
}

}  // namespace homolog
