#include "core/phantom/spine.h"

// The sacrum in the frame of its first vertebra, whose upper endplate is that of the mean vertebra.
namespace homolog::phantom {
namespace {

/// The bodies, which curve forwards as they go down.
double sacral_bodies(const Vec3& p) {
  const Vec3 q(0.72 * p.x(), p.y(), p.z());
  double d = round_cone(q, {0, 0, -6}, {0, 1, -28}, 14.5, 11);
  d = smooth_min(d, round_cone(q, {0, 1, -28}, {0, -1, -50}, 11, 8.5), 4);
  d = smooth_min(d, round_cone(q, {0, -1, -50}, {0, -8, -70}, 8.5, 6.5), 4);
  d = smooth_min(d, round_cone(q, {0, -8, -70}, {0, -17, -86}, 6.5, 4.5), 4);
  const double first = smooth_max(elliptic_cylinder(p.x(), p.y(), 22.5, 16.5), std::abs(p.z() + 2) - 19, 5);
  return smooth_min(d, first, 5);
}

/// The wings and the fused transverse processes, of the side x > 0.
double sacral_wing(const Vec3& p) {
  const double ala = round_cone(p, {20, 7, -3}, {38, 13, -11}, 9, 11);
  const double upper = round_cone(p, {36, 15, -12}, {29, 12, -44}, 11.5, 8);
  const double lower = round_cone(p, {29, 12, -44}, {17, -3, -72}, 8, 4.5);
  const double sheet = round_cone(p, {20, 12, -10}, {14, 6, -52}, 11, 7.5);
  const double lower_sheet = round_cone(p, {14, 6, -52}, {9, -8, -74}, 7.5, 5);
  return smooth_min(smooth_min(smooth_min(ala, upper, 6), lower, 5), smooth_min(sheet, lower_sheet, 5), 6);
}

/// The parts behind the canal, of the side x > 0: laminae, crests, the upper joints.
double sacral_back(const Vec3& p) {
  const double side = round_cone(p, {17, 22, -9}, {13, 13, -58}, 8.5, 6);
  const double lamina = round_cone(Vec3(p.x(), p.y(), 0.45 * p.z()), {15, 28, -4}, {1.5, 34, -5}, 4.2, 4.2);
  const double plate = round_cone(p, {9, 29, -16}, {6, 17, -62}, 6, 4.5);
  const double crest = round_cone(p, {0, 38, -14}, {0, 22, -60}, 4.2, 3.4);
  const double joint = round_cone(p, {16, 28, -2}, {17.5, 30.5, 12}, 5.4, 4.4);
  const double end = round_cone(p, {0, 12, -53}, {0, 5, -68}, 7, 6);  // closes the canal
  const double wall = smooth_min(smooth_min(plate, crest, 5), end, 5);
  return smooth_min(smooth_min(smooth_min(side, lamina, 4), wall, 5), joint, 4);
}

/// Closed below, so that the surface is a ball's.
double sacral_canal(const Vec3& p) {
  return round_cone(Vec3(0.72 * p.x(), p.y(), p.z()), {0, 22.5, 40}, {0, 15, -42}, 9.5, 3.5);
}

/// The openings of the nerves, in front and behind, as hollows, of the side x > 0.
double sacral_foramina(const Vec3& p) {
  double d = 1e9;
  for (const auto& [z, y] : {std::pair(-17.0, -4.5), std::pair(-39.0, -4.5), std::pair(-59.0, -8.0)}) {
    d = std::min(d, ellipsoid(p - Vec3(18 + 0.06 * z, y, z), Vec3(5.2, 7, 5)));
    d = std::min(d, ellipsoid(p - Vec3(19 + 0.09 * z, y + 36, z), Vec3(4, 5, 4)));
  }
  return d;
}

}  // namespace

double sacrum_solid(const Vec3& p) {
  const Vec3 q(std::abs(p.x()) * (p.x() > 0 ? 1 : 1.015), p.y(), p.z());
  double d = smooth_min(sacral_bodies(q), sacral_wing(q), 7);
  d = smooth_max(d, p.z() - body_half_height_mm + endplate_hollow_mm(p.x(), p.y()), 4);
  d = smooth_min(d, sacral_back(q), 5);
  d = smooth_max(d, -sacral_canal(q), 3);
  return smooth_max(d, -sacral_foramina(q), 2);
}

double disc_solid(const Vec3& p) {
  const double rim =
      smooth_max(elliptic_cylinder(p.x(), p.y(), 23, 17), -elliptic_cylinder(p.x(), p.y() - 23, 12, 9), 4);
  return smooth_max(rim, std::abs(p.z()) - disc_half_mm, 3);
}

}  // namespace homolog::phantom
