#pragma once

#include "core/case/document.h"
#include "core/phantom/phantom.h"

namespace homolog {

/// A phantom's image with the organ's built-in template, placed by a similarity through the named landmarks: near the
/// organ, but not on its boundary. Ready to drag.
Result<Document> demo_document(Organ organ, int subject);

}  // namespace homolog
