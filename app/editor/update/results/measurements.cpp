#include "app/editor/update/results/measurements.h"

#include <utility>

#include "app/editor/update/editing.h"
#include "core/catalogue/catalogue.h"

namespace homolog {

namespace {

void take_recipe(EditorState& state, const std::string& source, std::shared_ptr<const Recipe> recipe, bool chosen) {
  state.measurements.chosen = chosen;
  state.measurements.source = source;
  state.measurements.recipe = std::move(recipe);
  state.measurements.drawn.clear();
}

/// A template that has no recipe of its own keeps the one before, which a person may have chosen for several.
void follow_template(Editing& editing) {
  const Structure* structure = editing.structure();
  const std::string of_template = structure != nullptr ? structure->the_template->source : std::string();
  if (of_template.empty() || of_template == editing.state.measurements.of_template) return;
  editing.state.measurements.of_template = of_template;
  editing.work.imports.queue(of_template, [of_template](Progress&) -> Result<Work::Then> {
    const std::string source = recipe_of_template(of_template);
    if (source.empty()) return Work::Then([](Editing&) {});
    auto read = load_recipe(source);
    if (!read) return fail(read.error());
    return Work::Then([of_template, source, recipe = std::make_shared<const Recipe>(std::move(*read))](Editing& then) {
      if (then.state.measurements.of_template == of_template) take_recipe(then.state, source, recipe, false);
    });
  });
}

/// Whether what is measured is on the screen.
bool is_looked_at(const EditorState& state) {
  const auto& open = state.preferences.sections_open;
  const auto section = open.find(measurements_section);
  return !state.measurements.drawn.empty() || (section != open.end() && section->second);
}

}  // namespace

void choose_recipe(Editing& editing, const std::string& source) {
  editing.work.imports.queue(source, [source](Progress&) -> Result<Work::Then> {
    auto read = load_recipe(source);
    if (!read) return fail(read.error());
    return Work::Then([source, recipe = std::make_shared<const Recipe>(std::move(*read))](Editing& then) {
      take_recipe(then.state, source, recipe, true);
      then.log.is_done(ChooseRecipe{source});
    });
  });
}

bool update_measurements(Editing& editing) {
  EditorState& state = editing.state;
  Work& work = editing.work;
  follow_template(editing);
  const auto& recipe = state.measurements.recipe;
  if (recipe != work.measured_by) {
    work.measured_by = recipe;
    work.measurements.measure_by(
        [recipe](const Document& document, const std::string& of) { return shape_measurements(recipe, document, of); });
  }
  work.measurements.post(recipe && is_looked_at(state) ? editing.shown.displayed() : nullptr, state.look.structure);
  return work.measurements.update();
}

}  // namespace homolog
