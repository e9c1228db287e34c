#pragma once

#include <stdexcept>

#include "core/base/result.h"

namespace homolog {

/// Refuses an argument of a function that returns no Result. Throws std::invalid_argument with the refusal's sentence.
inline void demand(const Result<void>& checked) {
  if (!checked) throw std::invalid_argument(checked.error().sentence());
}
inline void demand(bool holds, const char* otherwise) {
  if (!holds) throw std::invalid_argument(otherwise);
}

}  // namespace homolog
