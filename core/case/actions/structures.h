#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/base/same_values.h"
#include "core/case/actions/kind.h"

namespace homolog {

/// Adds a structure to the case, or changes what is said of one that is there. How each member stands in the line, and
/// what it changes, is in the list of structures.cpp.
struct SetStructure {
  std::string id;
  std::optional<std::string> name{}, label{};
  std::optional<int> layer{};
  std::optional<std::array<std::uint8_t, 3>> colour{};
  std::optional<double> confidence{};  ///< 0…1 [Structure::confidence]
  std::optional<std::string> doubt{};  ///< empty: it need not be looked at
  std::optional<Side> side{};
  std::optional<std::string> partner{};             ///< another structure's id; empty: there is none
  std::optional<std::vector<SharedWith>> shared{};  ///< all that it shares; empty: nothing
  /// The source of a new structure's template, as Template::source; empty for one that is there.
  std::string source{};
  std::optional<Similarity> placement{};  ///< a new one's placement; without it in the middle of the image
  std::vector<double> mark{};  ///< a new template's mark [template_mark.h]; lines of older versions have none
  /// The template of a new one. A line holds its source alone: who reads the line loads it [case_templates.h].
  BesideValues<Template> the_template{};

  bool operator==(const SetStructure&) const = default;
};
const ActionKind<SetStructure>& action_kind(const SetStructure&);

/// Takes a structure out of the case, and what others share with it. The last one stays.
struct RemoveStructure {
  std::string id;
  bool operator==(const RemoveStructure&) const = default;
};
const ActionKind<RemoveStructure>& action_kind(const RemoveStructure&);

// How shared vertices stand in a line: checkpoints hold them in the same way.

nlohmann::ordered_json shared_to_json(const std::vector<SharedWith>& shared);
/// Throws as Fields does if they cannot be read.
std::vector<SharedWith> shared_from_json(const nlohmann::ordered_json& json);

}  // namespace homolog
