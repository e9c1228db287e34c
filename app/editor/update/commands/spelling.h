#pragma once

#include <array>
#include <optional>
#include <string>

#include "app/editor/state/settings.h"
#include "core/case/actions/fields.h"

namespace homolog {

/// An enumeration's value in a command's line; `names` are in the order of its values.
template <class Value, std::size_t count>
void spell_choice(Fields& line, const char* key, const std::array<const char*, count>& names, Value& value) {
  Names<Value, count> known;
  for (std::size_t i = 0; i < count; ++i) known[i] = {names[i], static_cast<Value>(i)};
  line.member(key, known, value);
}

/// The same, null where there is no value.
template <class Value, std::size_t count>
void spell_choice_or_null(Fields& line, const char* key, const std::array<const char*, count>& names,
                          std::optional<Value>& value) {
  std::optional<std::string> name;
  if (value) name = names[static_cast<std::size_t>(*value)];
  line.or_null(key, name);
  if (!line.reads()) return;
  value.reset();
  if (name) spell_choice(line, key, names, value.emplace());
}

inline void spell_fit(Fields& line, FitSettings& fit) {
  line.member("label", fit.label);
  line.optional("all_labels", fit.all_labels, fit.all_labels);
  line.or_null("closing_mm", fit.closing_mm);
  line.member("as_placed", fit.as_placed);
  static constexpr std::array model_names{"none", "study", "file"};
  if (!line.reads() || line.has("model")) spell_choice(line, "model", model_names, fit.model);
  line.optional("partial", fit.partial, fit.partial);
  line.optional("beyond", fit.beyond);
}

inline void spell_template(Fields& line, TemplateSettings& settings) {
  static constexpr std::array tunnel_names{"automatic", "keep", "number"};
  line.member("label", settings.label);
  line.optional("all_labels", settings.all_labels, settings.all_labels);
  line.member("tube", settings.tube);
  Fields mask = line.object("organ_options");
  mask.count("vertices", settings.mask.vertices);
  mask.or_null("closing_mm", settings.mask.closing_mm);
  mask.or_null("opening_mm", settings.mask.opening_mm);
  spell_choice(mask, "tunnels", tunnel_names, settings.mask.genus.kind);
  mask.count("genus", settings.mask.genus.genus);
  Fields tube = line.object("tube_options");
  tube.count("rings", settings.tube_options.rings);
  tube.count("sectors", settings.tube_options.sectors);
  tube.member("capped", settings.tube_options.capped);
  line.member("outer_label", settings.outer_label);
  line.member("axis_by_ruler", settings.axis_by_ruler);
}

// What values are called in the log.
inline constexpr std::array view_names{"axial", "sagittal", "coronal", "3D"};
inline constexpr std::array organ_names{"kidney", "vertebra", "ventricle"};

}  // namespace homolog
