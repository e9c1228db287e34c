#pragma once

#include <memory>

#include "core/case/document.h"

namespace homolog::test {

/// A shape of a document's first structure for a test to change: a copy that takes the place of the old one, which
/// other documents share.
inline Shape& changed_shape(Document& document, int frame = 0) {
  auto shape = std::make_shared<Shape>(*document.structure()->shape(frame));
  Shape& changed = *shape;
  document.change({}, [&](Structure& structure) { structure.shapes[frame] = std::move(shape); });
  return changed;
}

}  // namespace homolog::test
