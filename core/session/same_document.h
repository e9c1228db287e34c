#pragma once

#include <vector>

#include "core/case/document.h"

namespace homolog {

/// Whether two documents of one start are the same to the last bit.
bool same_document(const Document& a, const Document& b);

/// Whether landmarks have the same names and places, in the same order.
bool same_landmarks(const std::vector<Landmark>& a, const std::vector<Landmark>& b);

}  // namespace homolog
