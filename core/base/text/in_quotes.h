#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/text/text.h"

namespace homolog {

/// A name in a sentence: in double quotes, as it is.
inline std::string in_quotes(std::string_view name) {
  return '"' + std::string(name) + '"';
}

/// Several, with commas between them.
inline std::string in_quotes(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + in_quotes(name);
  return text;
}

/// The words of a file in double quotes: printable, and not too long [excerpt].
inline std::string excerpt_in_quotes(std::string_view words) {
  return in_quotes(excerpt(words));
}

}  // namespace homolog
