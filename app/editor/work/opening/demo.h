#pragma once

#include "app/editor/state/guide.h"
#include "core/case/document.h"
#include "core/phantom/phantom.h"

namespace homolog {

/// A phantom's image with the organ's built-in template, placed by a similarity through the named landmarks: near the
/// organ, but not on its boundary. Ready to drag.
Result<Document> demo_document(Organ organ, int subject);

/// The case that a newcomer meets: the first kidney phantom, with the template so far from its boundary that five pulls
/// are to be seen, and what leads through them.
struct FirstCase {
  Document document;
  Guide guide;
};
Result<FirstCase> first_case();

}  // namespace homolog
