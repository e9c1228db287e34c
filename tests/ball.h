#pragma once

#include <memory>

#include "core/case/document.h"
#include "core/mesh/construction/icosphere.h"
#include "tests/must.h"

namespace homolog {

/// A ball about the origin as a template without landmarks.
inline std::shared_ptr<const Template> ball_template(double radius_mm, int subdivisions = 3) {
  const Mesh ball = icosphere(subdivisions, radius_mm);
  return test::must(make_template({ball.points, ball.topology->triangles()}, "ball"));
}

/// A case of that ball without an image.
inline Document ball_document(double radius_mm, int subdivisions = 3) {
  return new_document("", nullptr, ball_template(radius_mm, subdivisions));
}

}  // namespace homolog
