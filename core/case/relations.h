#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/same_values.h"
#include "core/base/text/side_of_name.h"

namespace homolog {

// The relations between the structures of a body.

/// A vertex of one mesh, and the one of another that it is.
using VertexPair = std::array<std::int32_t, 2>;

/// Vertices that a structure of a case has in common with another one, as bones do where they meet.
struct SharedWith {
  std::string with;                               ///< the other structure's id
  SharedValue<std::vector<VertexPair>> vertices;  ///< pairs of vertices: this template's, the other's; never null

  bool operator==(const SharedWith&) const = default;
};

/// Pairs as files have them: "12:40 13:41".
std::string text_of_pairs(const std::vector<VertexPair>& pairs);
/// None where it is not that.
std::optional<std::vector<VertexPair>> pairs_of_text(std::string_view text);

}  // namespace homolog
