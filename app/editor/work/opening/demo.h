#pragma once

#include "app/editor/state/guide.h"
#include "core/case/document.h"

namespace homolog {

/// The case that a newcomer meets: the first kidney phantom, with the template so far from its boundary that five pulls
/// are to be seen, and what leads through them.
struct FirstCase {
  Document document;
  Guide guide;
};
Result<FirstCase> first_case();

}  // namespace homolog
