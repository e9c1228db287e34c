#pragma once

#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "core/case/document.h"
#include "core/mesh/construction/icosphere.h"
#include "core/volume/volume.h"
#include "tests/changed_shape.h"
#include "tests/must.h"

namespace homolog {

/// A bright ball that grows smaller and larger again in a small dark cine, once in all its frames; and cases on it.
struct BeatingBall {
  static constexpr int frames = 6;
  static double radius_mm(int frame) { return 26 + 4 * std::cos(2 * std::numbers::pi * frame / frames); }

  static Volume cine() {
    Volume image;
    image.geometry.dims = {28, 28, 28};
    image.geometry.spacing_mm.setConstant(3);
    image.geometry.origin_mm.setConstant(-40.5);
    image.frames = frames;
    std::vector<float> voxels;
    for (int frame = 0; frame < frames; ++frame)
      for (int k = 0; k < 28; ++k)
        for (int j = 0; j < 28; ++j)
          for (int i = 0; i < 28; ++i) {
            const double away_mm = image.geometry.to_mm(Vec3(i, j, k)).norm() - radius_mm(frame);
            voxels.push_back(static_cast<float>(100 / (1 + std::exp(away_mm)) + (i * 7 + j * 5 + k * 3) % 4));
          }
    image.data = std::move(voxels);
    image.range_max = 104;
    return image;
  }

  /// The case with the ball of frame 0 as its template, on its place.
  static Document document() {
    const Mesh ball = icosphere(2, radius_mm(0));
    MeshFile file{ball.points, ball.topology->triangles()};
    Document document = new_document("beating ball", std::make_shared<const Volume>(cine()),
                                     test::must(make_template(std::move(file), "ball.ply")));
    Shape& shape = test::changed_shape(document);
    shape.placement = shape.before_landmarks = {};
    shape.placed = shape.reference = shape.points = std::make_shared<const Points>(ball.points);
    return document;
  }
};

}  // namespace homolog
