#pragma once

#include <array>
#include <optional>
#include <string>

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

// The names of values in the log.
inline constexpr std::array view_names{"axial", "sagittal", "coronal", "3D"};
inline constexpr std::array organ_names{"kidney", "vertebra", "ventricle"};

}  // namespace homolog
