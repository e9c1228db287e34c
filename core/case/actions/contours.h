#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/base/same_values.h"
#include "core/case/actions/kind.h"

namespace homolog {

/// Adds curves that were drawn of a structure, in the frame that is shown, or changes what is said of those that are
/// there.
struct SetContours {
  std::string id;
  std::optional<std::string> name{};
  /// The curves of new contours, or the one that takes the place of `curve`; null for those that are there. LPS mm.
  SharedValue<std::vector<Contour>> curves{};
  std::optional<int> curve{};      ///< which curve of those that are there `curves` replaces, from 0
  std::optional<double> off_mm{};  ///< [ContourSet::off_mm]
  std::optional<bool> outside{};   ///< [ContourSet::outside]

  bool operator==(const SetContours&) const = default;
};
const ActionKind<SetContours>& action_kind(const SetContours&);

/// Takes curves away.
struct RemoveContours {
  std::string id;
  bool operator==(const RemoveContours&) const = default;
};
const ActionKind<RemoveContours>& action_kind(const RemoveContours&);

// How curves stand in a line, and what is asked of them: checkpoints hold them in the same way.

nlohmann::ordered_json curves_to_json(const std::vector<Contour>& curves);
/// Throws as Fields does if the curves cannot be read.
std::vector<Contour> curves_from_json(const nlohmann::ordered_json& json);
/// Errors: no curve; one of too few points; a place that no case needs.
Result<void> check_curves(const std::vector<Contour>& curves);

}  // namespace homolog
