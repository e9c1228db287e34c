#include "core/case/relations.h"

#include <algorithm>

#include "core/base/text/text.h"

namespace homolog {

std::string text_of_pairs(const std::vector<VertexPair>& pairs) {
  std::string text;
  for (const auto& [a, b] : pairs) text += (text.empty() ? "" : " ") + std::to_string(a) + ':' + std::to_string(b);
  return text;
}

std::optional<std::vector<VertexPair>> pairs_of_text(std::string_view text) {
  std::vector<VertexPair> pairs;
  while (!text.empty()) {
    const std::string_view pair = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(pair.size() + 1, text.size()));
    const auto colon = pair.find(':');
    if (colon == std::string_view::npos) return std::nullopt;
    const auto a = as_number<std::int32_t>(pair.substr(0, colon));
    const auto b = as_number<std::int32_t>(pair.substr(colon + 1));
    if (!a || !b || *a < 0 || *b < 0) return std::nullopt;
    pairs.push_back({*a, *b});
  }
  return pairs;
}

}  // namespace homolog
