#include "app/editor/update/results/kept_choices.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <utility>

#include "app/editor/update/editing.h"
#include "core/catalogue/catalogue.h"
#include "core/model/files/statismo.h"

namespace homolog {

namespace {

/// Reads a file of the case that is shown. `take(then, value)` is called while it still is, `else_do(then)` where there
/// is no such file or it cannot be read. Neither is where something else was chosen meanwhile. `chosen(then)`: what is.
template <class Chosen, class Read, class Take, class Else>
void read_kept(Editing& editing, const std::string& source, Chosen chosen, Read read, Take take, Else else_do) {
  const std::uint64_t number = editing.shown.number();
  const auto before = chosen(std::as_const(editing));
  editing.work.imports.queue(source, [=](Progress&) -> Result<Work::Then> {
    auto got = read(source);
    std::error_code ignored;
    const bool is_gone = !got && !std::filesystem::exists(source, ignored);
    const std::string why = got || is_gone ? std::string() : got.error().sentence();
    using Value = typename decltype(got)::value_type;
    const auto value = got ? std::make_shared<const Value>(std::move(*got)) : nullptr;
    return Work::Then([=](Editing& then) {
      if (then.shown.number() != number || chosen(std::as_const(then)) != before) return;
      if (value) return take(then, value);
      if (!why.empty()) add_notice(then.state, why, false);
      else_do(then);
    });
  });
}

void bring_back_set(Editing& editing, const std::string& source) {
  const Automatic& automatic = editing.state.automatic;
  if (automatic.set && automatic.set_source == source) return;
  read_kept(
      editing, source, [](const Editing& now) { return now.state.automatic.set_source; },
      [](const std::string& file) { return load_set_of_templates(file); },
      [source](Editing& then, const std::shared_ptr<const SetOfTemplates>& set) {
        then.state.automatic.set_source = source;
        then.state.automatic.set = set;
      },
      [](Editing&) {});
}

void bring_back_recipe(Editing& editing, const std::string& source, const std::vector<std::string>& measured) {
  // That of the template would come in its place.
  const Structure* structure = editing.structure();
  editing.state.measurements.of_template = structure != nullptr ? structure->the_template->source : std::string();
  read_kept(
      editing, source, [](const Editing& now) { return now.state.measurements.source; },
      [](const std::string& file) { return load_recipe(file); },
      [source, measured](Editing& then, const std::shared_ptr<const Recipe>& recipe) {
        Measurements& measurements = then.state.measurements;
        measurements.source = source;
        measurements.recipe = recipe;
        measurements.drawn = {measured.begin(), measured.end()};
        measurements.chosen = true;
      },
      [](Editing& then) { then.state.measurements.of_template.clear(); });
}

void bring_back_model(Editing& editing, const std::string& source) {
  Scoring& scoring = editing.state.scoring;
  if (scoring.of_file && scoring.file == source) {
    scoring.by_file = true;
    return;
  }
  read_kept(
      editing, source, [](const Editing& now) { return now.state.scoring.file; },
      [](const std::string& file) { return read_model(file); },
      [source](Editing& then, const std::shared_ptr<const ShapeModel>& model) {
        Scoring& of_case = then.state.scoring;
        of_case.of_file = model;
        of_case.file = source;
        of_case.by_file = true;
      },
      [](Editing&) {});
}

}  // namespace

void bring_back_choices(Editing& editing, const KeptLooks& kept) {
  const std::filesystem::path folder = editing.shown.snapshot().file.parent_path();
  if (!kept.set.empty()) bring_back_set(editing, resolved_source(folder, kept.set));
  const auto shipped = shipped_recipes();
  const bool ships = std::ranges::find(shipped, kept.recipe) != shipped.end();
  if (!kept.recipe.empty())
    bring_back_recipe(editing, ships ? kept.recipe : resolved_source(folder, kept.recipe), kept.measured);
  if (!kept.model.empty()) bring_back_model(editing, resolved_source(folder, kept.model));
}

}  // namespace homolog
