#include "app/editor/state/view_geometry.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace homolog {

namespace {

/// The volume's axis that stands for each patient axis: the assignment with the largest sum of |cosines|.
std::array<int, 3> nearest_axes(const Mat3& direction) {
  std::array<int, 3> order{0, 1, 2}, best = order;
  double best_sum = -1;
  do {
    double sum = 0;
    for (int patient = 0; patient < 3; ++patient) sum += std::abs(direction(patient, order[patient]));
    if (sum > best_sum + 1e-9) {
      best_sum = sum;
      best = order;
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

}  // namespace

Mat3 slice_axes(const VolumeGeometry& geometry, bool own_planes) {
  if (!own_planes) return Mat3::Identity();
  const auto axes = nearest_axes(geometry.direction);
  Mat3 result;
  for (int patient = 0; patient < 3; ++patient) {
    const Vec3 axis = geometry.direction.col(axes[patient]);
    result.col(patient) = axis[patient] < 0 ? Vec3(-axis) : axis;
  }
  if (result.determinant() < 0) result.col(2) = -result.col(2);
  return result;
}

ScreenAxes screen_axes(ViewKind kind, const Mat3& axes, bool radiological) {
  const Vec3 left = axes.col(0), posterior = axes.col(1), superior = axes.col(2);
  const Vec3 across = radiological ? left : Vec3(-left);
  switch (kind) {
    case ViewKind::axial:
      return {across, posterior};
    case ViewKind::sagittal:
      return {posterior, -superior};
    default:
      return {across, -superior};
  }
}

std::string view_title(ViewKind kind, const VolumeGeometry& geometry, bool own_planes) {
  if (kind == ViewKind::space) return "3D";
  if (!own_planes) return kind == ViewKind::axial ? "Axial" : kind == ViewKind::sagittal ? "Sagittal" : "Coronal";
  const int patient = kind == ViewKind::axial ? 2 : kind == ViewKind::sagittal ? 0 : 1;
  const char letter = "ijk"[nearest_axes(geometry.direction)[patient]];
  return std::string("Plane across ") + letter;
}

std::string direction_letters(const Vec3& direction) {
  static constexpr const char* positive = "LPS";
  static constexpr const char* negative = "RAI";
  const double second_letter_from = std::sin(std::numbers::pi / 8);
  std::array<int, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](int a, int b) { return std::abs(direction[a]) > std::abs(direction[b]); });
  std::string letters;
  for (int place = 0; place < 2; ++place) {
    const int axis = order[place];
    if (place == 1 && std::abs(direction[axis]) < second_letter_from) break;
    letters += direction[axis] > 0 ? positive[axis] : negative[axis];
  }
  return letters;
}

std::string position_text(const Vec3& p_mm) {
  char text[80];
  std::snprintf(text, sizeof text, "%c %.1f %c %.1f %c %.1f", p_mm.x() < 0 ? 'R' : 'L', std::abs(p_mm.x()),
                p_mm.y() < 0 ? 'A' : 'P', std::abs(p_mm.y()), p_mm.z() < 0 ? 'I' : 'S', std::abs(p_mm.z()));
  return text;
}

double slice_step_mm(const VolumeGeometry& geometry, const Vec3& direction) {
  const Vec3 voxels_per_mm = (geometry.direction.transpose() * direction).cwiseQuotient(geometry.spacing_mm);
  return 1 / voxels_per_mm.norm();
}

Camera3D camera_from(LookFrom from, const Box& box_mm) {
  Camera3D camera;
  switch (from) {
    case LookFrom::anterior:
      camera.to_eye = Vec3(0, -1, 0);
      break;
    case LookFrom::posterior:
      camera.to_eye = Vec3(0, 1, 0);
      break;
    case LookFrom::left:
      camera.to_eye = Vec3(1, 0, 0);
      break;
    case LookFrom::right:
      camera.to_eye = Vec3(-1, 0, 0);
      break;
    case LookFrom::superior:
      camera.to_eye = Vec3(0, 0, 1);
      camera.up = Vec3(0, -1, 0);
      break;
    case LookFrom::inferior:
      camera.to_eye = Vec3(0, 0, -1);
      camera.up = Vec3(0, -1, 0);
      break;
  }
  if (!box_mm.isEmpty()) {
    camera.target = box_mm.center();
    const double half_angle = camera.fov_deg / 2 * std::numbers::pi / 180;
    camera.distance_mm = 0.55 * box_mm.diagonal().norm() / std::sin(half_angle);
  }
  return camera;
}

void look_from(Camera3D& camera, LookFrom from) {
  const Camera3D there = camera_from(from, Box());
  camera.to_eye = there.to_eye;
  camera.up = there.up;
}

void look_from_outside(Camera3D& camera, const Vec3& normal) {
  if (normal.norm() < 0.5) return;
  camera.to_eye = normal.normalized();
  camera.up = std::abs(camera.to_eye.z()) > 0.95 ? Vec3(0, -1, 0) : Vec3::UnitZ();
  camera.up = (camera.up - camera.to_eye * camera.to_eye.dot(camera.up)).normalized();
}

Camera3D turned(const Camera3D& camera, double right_px, double down_px) {
  constexpr double radians_per_px = 0.008;
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(-right_px * radians_per_px, camera.up) *
                                Eigen::AngleAxisd(-down_px * radians_per_px, camera_right(camera)));
  Camera3D result = camera;
  result.to_eye = (turn * camera.to_eye).normalized();
  result.up = turn * camera.up;
  result.up = (result.up - result.to_eye * result.to_eye.dot(result.up)).normalized();
  return result;
}

double camera_mm_per_px(const Camera3D& camera, double side_px) {
  const double half_angle = camera.fov_deg / 2 * std::numbers::pi / 180;
  return 2 * camera.distance_mm * std::tan(half_angle) / side_px;
}

}  // namespace homolog
