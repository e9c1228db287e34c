#include "core/phantom/spine.h"

namespace homolog::phantom {
namespace {

/// The body's cross-section: an ellipse, narrower at half height.
double body_outline(const Vec3& p) {
  const double level = std::clamp(p.z() / body_half_height_mm, -1.2, 1.2);
  const double waist_mm = 2.2 * (1 - level * level);
  return elliptic_cylinder(p.x(), p.y(), 22.5 - waist_mm, 16.5 - waist_mm);
}

double body(const Vec3& p) {
  return smooth_max(body_outline(p), std::abs(p.z()) - body_half_height_mm + endplate_hollow_mm(p.x(), p.y()), 4);
}

double canal(const Vec3& p) {
  return elliptic_cylinder(p.x(), p.y() - 22.5, 11.5, 8.5);
}

/// The parts behind the body, of the side that x > 0 stands for.
double arch(const Vec3& p) {
  const double pedicle = round_cone(Vec3(p.x(), p.y(), 0.72 * p.z()), {13, 8, 3.2}, {15.5, 25, 2.4}, 5.4, 5.2);
  const double lamina = round_cone(Vec3(p.x(), p.y(), 0.5 * p.z()), {14, 28, 0}, {1.5, 36.5, -2}, 4.6, 4.6);
  const double spinous = round_box(Vec3(p.x(), p.y() - 49, p.z() + 6.5 + 0.12 * (p.y() - 49)), Vec3(3.6, 15, 8.2), 3.4);
  const double transverse = round_cone(p, {15, 26, 2.5}, {40, 32, 4.5}, 5.6, 4.4);
  const double superior = round_cone(p, {16, 28, 2}, {17.5, 30.5, 16}, 5.4, 4.6);
  const double inferior = round_cone(p, {9.5, 33.5, -5}, {11, 38.5, -18.5}, 5.2, 4.1);
  double d = smooth_min(pedicle, lamina, 5);
  d = smooth_min(d, spinous, 5);
  d = smooth_min(d, transverse, 5);
  d = smooth_min(d, superior, 4);
  return smooth_min(d, inferior, 4);
}

}  // namespace

double endplate_hollow_mm(double x, double y) {
  return 1.3 * std::max(0.0, 1 - (x * x + y * y) / (14.0 * 14.0));
}

double vertebra_solid(const Vec3& p) {
  // A slight difference between the sides, as in every patient; it also leaves no ties to the mesher.
  const Vec3 q(std::abs(p.x()) * (p.x() > 0 ? 1 : 1.015), p.y(), p.z());
  return smooth_max(smooth_min(body(q), arch(q), 5), -canal(q), 3);
}

void paint_spine(Voxel& voxel, const Vec3& p, double grain) {
  const double level = std::round(p.z() / vertebra_pitch_mm);
  const Vec3 q(p.x(), p.y(), p.z() - level * vertebra_pitch_mm);
  const Vec3 neighbour(q.x(), q.y(), q.z() - std::copysign(vertebra_pitch_mm, q.z()));
  if (q.x() * q.x() + (q.y() - 20) * (q.y() - 20) > 52 * 52) return;

  voxel.paint(smooth_max(elliptic_cylinder(q.x(), q.y(), 23, 17), 12 - std::abs(q.z()), 3), 82);  // discs
  voxel.paint(canal(q), -60);                                                                     // epidural fat
  voxel.paint(elliptic_cylinder(q.x(), q.y() - 22.5, 8.8, 6.6), 22);
  voxel.paint(elliptic_cylinder(q.x(), q.y() - 23.5, 4.6, 3.4), 42);
  const double bone = std::min(vertebra_solid(q), vertebra_solid(neighbour));
  voxel.paint(bone, 680);
  voxel.paint(bone + 1.2, 190 + 30 * grain);
}

}  // namespace homolog::phantom
