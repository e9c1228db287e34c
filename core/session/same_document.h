#pragma once

#include "core/case/document.h"

namespace homolog {

/// Whether two documents of one start are the same to the last bit.
bool same_document(const Document& a, const Document& b);

}  // namespace homolog
