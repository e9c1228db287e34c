#pragma once

#include "core/case/document.h"

namespace homolog {

/// Whether a document is one that actions can make: a line that was damaged may be read and hold anything.
bool is_sound(const Document& document);

}  // namespace homolog
