#include "core/phantom/spine_levels.h"

#include <array>
#include <cmath>
#include <numbers>

#include "core/base/numbers/random.h"
#include "core/phantom/implicit.h"
#include "core/phantom/spine.h"

namespace homolog::phantom {
namespace {

/// The lumbar vertebrae of five, from the first to the last; other numbers take what lies between them.
constexpr std::array<LevelShape, 5> lumbar_shapes{{
    {.width = 0.93, .depth = 0.95, .height = 0.94, .wedge_deg = -2, .transverse = 0.72, .spinous = 0.90},
    {.width = 0.96, .depth = 0.97, .height = 0.97, .wedge_deg = -1, .transverse = 0.92, .spinous = 1.00},
    {.width = 1.00, .depth = 1.00, .height = 1.00, .wedge_deg = 1, .transverse = 1.15, .spinous = 1.06},
    {.width = 1.05, .depth = 1.03, .height = 1.01, .wedge_deg = 3, .transverse = 0.95, .spinous = 0.96},
    {.width = 1.10, .depth = 1.05, .height = 1.01, .wedge_deg = 8, .transverse = 1.00, .spinous = 0.72, .drop_mm = 2},
}};
constexpr LevelShape eleventh_thoracic{.width = 0.86,
                                       .depth = 0.90,
                                       .height = 0.87,
                                       .wedge_deg = -4,
                                       .arch_top = 0.80,
                                       .transverse = 0.25,
                                       .spinous = 0.70,
                                       .drop_mm = 5};
constexpr LevelShape twelfth_thoracic{
    .width = 0.89, .depth = 0.92, .height = 0.91, .wedge_deg = -4, .transverse = 0.25, .spinous = 0.75, .drop_mm = 2};
constexpr LevelShape first_sacral{.width = 1.12, .depth = 1.03};

/// The joints from T12-L1 to L5-S1.
struct MeanJoint {
  double lordosis_deg, disc_mm, arch;
};
constexpr std::array<MeanJoint, 6> mean_joints{
    {{2, 7.5, 0.84}, {5, 8.5, 0.88}, {8, 9.5, 0.93}, {11, 10.5, 1.00}, {14, 11.5, 1.10}, {19, 10.5, 1.28}}};
constexpr MeanJoint uppermost{1, 6.5, 0.82};
constexpr double lower_joints = 0.94, upper_joints = 1.05;  ///< keep the joints of the arches from touching

/// Entry `at` (from 0 to its last) of a table, or what lies between two.
template <class Table, class Number>
double between(const Table& table, double at, Number number) {
  const auto below = std::min(static_cast<std::size_t>(at), table.size() - 2);
  const double share = at - static_cast<double>(below);
  return table[below].*number * (1 - share) + table[below + 1].*number * share;
}

LevelShape lumbar_shape(double at) {
  const auto value = [at](double LevelShape::*number) { return between(lumbar_shapes, at, number); };
  LevelShape shape;
  for (double LevelShape::*number :
       {&LevelShape::width, &LevelShape::depth, &LevelShape::height, &LevelShape::wedge_deg, &LevelShape::transverse,
        &LevelShape::spinous, &LevelShape::drop_mm})
    shape.*number = value(number);
  return shape;
}

std::vector<MeanJoint> joints_of(int lumbar) {
  std::vector<MeanJoint> joints{uppermost};
  for (int k = 0; k <= lumbar; ++k) {
    const double at = 5.0 * k / lumbar;
    const auto value = [at](double MeanJoint::*number) { return between(mean_joints, at, number); };
    // More joints share the same lordosis.
    joints.push_back(
        {value(&MeanJoint::lordosis_deg) * 6 / (lumbar + 1), value(&MeanJoint::disc_mm), value(&MeanJoint::arch)});
  }
  return joints;
}

}  // namespace

Vec3 LevelShape::carried(const Vec3& p) const {
  const double back = smooth_step(6, 24, p.y());  // 0 in the body, 1 in the arch
  const double arch = arch_bottom + (arch_top - arch_bottom) * smooth_step(-20, 20, p.z());
  const double side = std::abs(p.x()), tip = smooth_max(side - 22, 0, 6);
  const double near = width + (arch - width) * back, far = width + (transverse - width) * back;
  const double x = std::copysign(near * (side - tip) + far * tip, p.x());
  const double y = p.y() + (depth - 1) * smooth_min(p.y() - 12, 0, 8) + (spinous - 1) * smooth_max(p.y() - 44, 0, 8);
  const double slope = std::tan(wedge_deg / 2 * std::numbers::pi / 180) / body_half_height_mm;
  const double z = p.z() * height * (1 - slope * std::min(y, 34.0)) - drop_mm * smooth_step(36, 66, p.y());
  return {x, y, z};
}

int lumbar_levels(int subject) {
  if (subject == 0) return 5;
  const auto draw = mix_bits(mix_bits(spine_seed + 221) + static_cast<std::uint64_t>(subject)) % 6;
  return draw == 0 ? 4 : draw == 1 ? 6 : 5;
}

SpinePlan spine_plan(int subject, double amount) {
  const int lumbar = lumbar_levels(subject);
  SpinePlan plan;
  plan.levels = {{"vertebrae_T11", eleventh_thoracic}, {"vertebrae_T12", twelfth_thoracic}};
  for (int k = 0; k < lumbar; ++k)
    plan.levels.push_back({"vertebrae_L" + std::to_string(k + 1), lumbar_shape(4.0 * k / (lumbar - 1))});
  plan.levels.push_back({"sacrum", first_sacral});

  Random random(mix_bits(spine_seed + 1) + static_cast<std::uint64_t>(subject));
  const auto varied = [&](double deviation) {
    return (subject == 0 ? 0 : amount) * deviation * std::clamp(random.normal(), -2.0, 2.0);
  };
  const std::vector<MeanJoint> joints = joints_of(lumbar);
  for (std::size_t k = 0; k < joints.size(); ++k) {
    plan.levels[k].shape.arch_bottom = joints[k].arch * lower_joints;
    plan.levels[k + 1].shape.arch_top = joints[k].arch * upper_joints;
    SpineJoint joint;
    joint.lordosis_deg = joints[k].lordosis_deg;
    joint.bend_deg = varied(1.6);
    joint.lateral_deg = varied(0.9);
    joint.axial_deg = varied(0.6);
    joint.disc_mm = joints[k].disc_mm * (1 + varied(0.08));
    plan.joints.push_back(joint);
  }
  return plan;
}

}  // namespace homolog::phantom
