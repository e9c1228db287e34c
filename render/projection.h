#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

#include "render/renderer.h"

namespace homolog {

/// How mm become pixels of a target, as the shaders take it. Eye space: x right, y up, z towards the viewer, in mm.
struct Projection {
  glm::mat4 eye_from_mm{1};
  glm::mat4 clip_from_eye{1};
  glm::vec2 size_px{1, 1};
  float content_scale = 1;
};

Projection projection_of(const SliceView& view, const Viewport& target);
Projection projection_of(const Camera3D& camera, const Viewport& target);

inline glm::vec3 to_glm(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}
inline glm::vec3 to_glm(const std::array<int, 3>& v) {
  return {v[0], v[1], v[2]};
}

}  // namespace homolog
