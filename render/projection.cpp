#include "render/projection.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

namespace homolog {
namespace {

/// Farther than any scan reaches from its middle, and small enough for the depth buffer to part a hundredth of a mm.
constexpr double reach_mm = 5000;

/// How far a camera sees: shapes in another unit than mm, and a gallery of many, need it to be far off.
double reach_of(const Camera3D& camera) {
  return std::max(reach_mm, 4 * camera.distance_mm);
}

/// The camera's axes in LPS; `back` points at the eye.
struct Axes {
  Vec3 right, up, back;
};

Axes axes_of(const Camera3D& camera) {
  const Vec3 back = camera.to_eye.normalized();
  const Vec3 right = camera.up.cross(back).normalized();
  return {right, back.cross(right), back};
}

Vec3 eye_of(const Camera3D& camera) {
  return camera.target + camera.distance_mm * camera.to_eye.normalized();
}

/// px per mm in the plane through the camera's target.
double px_per_mm(const Camera3D& camera, const Viewport& target) {
  const double fov_deg = camera.fov_deg > 0 ? camera.fov_deg : Camera3D{}.fov_deg;
  const double half_side_mm = camera.distance_mm * std::tan(fov_deg * std::numbers::pi / 360);
  return std::min(target.width, target.height) / 2.0 / half_side_mm;
}

glm::mat4 eye_from_mm(const Vec3& eye, const Axes& axes) {
  return glm::mat4(glm::lookAt(glm::dvec3(eye.x(), eye.y(), eye.z()),
                               glm::dvec3(eye.x() - axes.back.x(), eye.y() - axes.back.y(), eye.z() - axes.back.z()),
                               glm::dvec3(axes.up.x(), axes.up.y(), axes.up.z())));
}

glm::mat4 orthographic(double half_width_mm, double half_height_mm, double far_mm) {
  return glm::mat4(glm::ortho(-half_width_mm, half_width_mm, -half_height_mm, half_height_mm, -far_mm, far_mm));
}

glm::vec2 size_of(const Viewport& target) {
  return {static_cast<float>(target.width), static_cast<float>(target.height)};
}

}  // namespace

Projection projection_of(const SliceView& view, const Viewport& target) {
  return {eye_from_mm(view.centre, {view.right, -view.down, -view.normal()}),
          orthographic(target.width * view.mm_per_px / 2, target.height * view.mm_per_px / 2, reach_mm),
          size_of(target), target.content_scale};
}

Projection projection_of(const Camera3D& camera, const Viewport& target) {
  const double scale = px_per_mm(camera, target);
  const double half_width_mm = target.width / 2.0 / scale, half_height_mm = target.height / 2.0 / scale;
  const glm::mat4 eye = eye_from_mm(eye_of(camera), axes_of(camera));
  if (camera.fov_deg <= 0)
    return {eye, orthographic(half_width_mm, half_height_mm, reach_of(camera)), size_of(target), target.content_scale};
  const double near_mm = camera.distance_mm / 50, shrink = near_mm / camera.distance_mm;
  const glm::mat4 clip(glm::frustum(-half_width_mm * shrink, half_width_mm * shrink, -half_height_mm * shrink,
                                    half_height_mm * shrink, near_mm, camera.distance_mm + reach_of(camera)));
  return {eye, clip, size_of(target), target.content_scale};
}

Vec3 slice_point_mm(const SliceView& view, const Viewport& target, double x_px, double y_px) {
  return view.centre +
         view.mm_per_px * ((x_px - target.width / 2.0) * view.right + (y_px - target.height / 2.0) * view.down);
}

Eigen::Vector2d slice_point_px(const SliceView& view, const Viewport& target, const Vec3& p_mm) {
  const Vec3 from_centre = p_mm - view.centre;
  return {target.width / 2.0 + view.right.dot(from_centre) / view.mm_per_px,
          target.height / 2.0 + view.down.dot(from_centre) / view.mm_per_px};
}

Ray camera_ray(const Camera3D& camera, const Viewport& target, double x_px, double y_px) {
  const Axes axes = axes_of(camera);
  const double scale = px_per_mm(camera, target);
  const Vec3 on_target =
      camera.target + (x_px - target.width / 2.0) / scale * axes.right - (y_px - target.height / 2.0) / scale * axes.up;
  const Vec3 eye = eye_of(camera);
  if (camera.fov_deg <= 0) return {on_target + camera.distance_mm * axes.back, -axes.back};
  return {eye, (on_target - eye).normalized()};
}

Vec3 camera_point_px(const Camera3D& camera, const Viewport& target, const Vec3& p_mm) {
  const Axes axes = axes_of(camera);
  const Vec3 from_eye = p_mm - eye_of(camera);
  const double depth_mm = -axes.back.dot(from_eye);
  const double scale = px_per_mm(camera, target) * (camera.fov_deg > 0 ? camera.distance_mm / depth_mm : 1);
  return {target.width / 2.0 + scale * axes.right.dot(from_eye), target.height / 2.0 - scale * axes.up.dot(from_eye),
          depth_mm};
}

}  // namespace homolog
