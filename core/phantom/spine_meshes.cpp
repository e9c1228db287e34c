#include "core/phantom/spine_meshes.h"

#include <cmath>
#include <numbers>

#include "core/mesh/mesh_quality.h"
#include "core/phantom/deformation.h"
#include "core/phantom/solid_template.h"
#include "core/phantom/spine.h"

namespace homolog::phantom {
namespace {

constexpr int sacrum_value = 8;  ///< T12 is 1, L1 … L6 are 2 … 7; a disc's label is 10 more than that of the bone below
constexpr double cartilage_mm = 0.3;  ///< between a disc and the bone

const SolidTemplate& mean_sacrum() {
  static const SolidTemplate sacrum = template_of(sacrum_solid, Box(Vec3(-60, -35, -100), Vec3(60, 55, 30)), 2500,
                                                  {{"promontory", {0, -16, 13}},
                                                   {"body posterior superior", {0, 14, 13}},
                                                   {"left wing", {48, 13, -10}},
                                                   {"right wing", {-48, 13, -10}},
                                                   {"median crest", {0, 44, -14}},
                                                   {"left superior articular process tip", {18, 31, 17}},
                                                   {"right superior articular process tip", {-18, 31, 17}},
                                                   {"lower end", {0, -18, -91}}});
  return sacrum;
}

const SolidTemplate& mean_disc() {
  static const SolidTemplate disc = template_of(disc_solid, Box(Vec3(-27, -21, -9), Vec3(27, 21, 9)), 1000,
                                                {{"anterior", {0, -17, 0}},
                                                 {"posterior", {0, 14, 0}},
                                                 {"left lateral", {23, 0, 0}},
                                                 {"right lateral", {-23, 0, 0}},
                                                 {"superior", {0, 0, 4.5}},
                                                 {"inferior", {0, 0, -4.5}}});
  return disc;
}

Mat3 turn(double degrees, const Vec3& axis) {
  return Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis).toRotationMatrix();
}

/// A level's own shape, and where it stands in the mean subject's patient frame.
struct PosedLevel {
  LevelShape shape;
  Deformation own;
  Mat3 rotation = Mat3::Identity();
  Vec3 centre = Vec3::Zero();

  Vec3 to_scene(const Vec3& p_mean) const { return rotation * own.to_subject(shape.carried(p_mean)) + centre; }
};

/// Small differences of a vertebra from its neighbours.
Deformation own_deformation(int subject, std::size_t level, double amount) {
  Variation variation;
  variation.size = 0.012 * amount;
  variation.elongation = 0.015 * amount;
  variation.bend_mm = 0.5 * amount;
  variation.bump_mm = 0.6 * amount;
  variation.bump_radius_mm = 20;
  variation.bumps = 8;
  variation.rotation_deg = 0;
  variation.shift_mm = 0;
  variation.half_size_mm = Vec3(40, 36, 20);
  return {subject, spine_seed + 16 + level, variation};
}

/// Poses a level under the one above it.
void put_below(PosedLevel& level, const PosedLevel& above, const SpineJoint& joint) {
  const Mat3 half = turn(joint.lordosis_deg / 2, Vec3::UnitX());
  const Vec3 rim(0, 0, body_half_height_mm), disc(0, 0, joint.disc_mm);
  const Vec3 arch_joints(0, 34, -18 * above.shape.height);
  const Vec3 centre = -above.shape.height * rim - half * disc - half * half * (level.shape.height * rim);
  const Mat3 turned = turn(joint.bend_deg, Vec3::UnitX()) * turn(joint.lateral_deg, Vec3::UnitY()) *
                      turn(joint.axial_deg, Vec3::UnitZ());
  level.rotation = above.rotation * turned * half * half;
  level.centre = above.centre + above.rotation * (arch_joints + turned * (centre - arch_joints));
}

/// The levels from the head down, one joint after the other; the middle one stands upright at the origin.
std::vector<PosedLevel> posed_levels(const SpinePlan& plan, int subject, double amount) {
  std::vector<PosedLevel> levels;
  const std::size_t middle = plan.levels.size() / 2;
  double tilt_deg = 0;
  for (std::size_t k = 0; k < middle; ++k) tilt_deg += plan.joints[k].lordosis_deg;
  for (std::size_t k = 0; k < plan.levels.size(); ++k) {
    PosedLevel level{plan.levels[k].shape, own_deformation(subject, k, amount)};
    if (k == 0) {
      level.rotation = turn(-tilt_deg, Vec3::UnitX());
    } else {
      put_below(level, levels.back(), plan.joints[k - 1]);
    }
    levels.push_back(std::move(level));
  }
  const Vec3 origin = levels[middle].centre;
  for (PosedLevel& level : levels) level.centre -= origin;
  return levels;
}

/// A mean mesh and its landmarks, every place carried.
template <class Carry>
MeshFile carried_mesh(const SolidTemplate& mean, const Carry& carry) {
  MeshFile mesh = mean.mesh;
  const auto place = [&](const Vec3& p) { return Vec3(carry(Vec3(p + mean.centre_mm))); };
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i) mesh.points.row(i) = place(mean.mesh.points.row(i)).transpose();
  for (Landmark& landmark : mesh.landmarks) landmark.position = place(landmark.position);
  return mesh;
}

/// The height over (x, y) at which a disc meets the endplate of a solid that lies below it (`up` 1) or above (−1). The
/// roots of the arch bulge the body's rim, so the solid itself is asked.
double contact_mm(Solid solid, double x, double y, double up) {
  double z = body_half_height_mm - endplate_hollow_mm(x, y) + cartilage_mm;
  for (int round = 0; round < 12; ++round) z += std::max(0.0, cartilage_mm - solid({x, y, up * z}));
  return up * z;
}

/// A place of the mean disc between the endplates of two levels.
Vec3 between_endplates(const PosedLevel& above, const PosedLevel& below, Solid solid_below, const Vec3& p) {
  const double share = (p.z() / disc_half_mm + 1) / 2, x = p.x(), y = p.y();
  const Vec3 upper = above.to_scene({x, y, contact_mm(vertebra_solid, x, y, -1)});
  return share * upper + (1 - share) * below.to_scene({x, y, contact_mm(solid_below, x, y, 1)});
}

/// "disc_L3_L4" of "vertebrae_L3" and "vertebrae_L4".
std::string disc_name(const std::string& above, const std::string& below) {
  const auto short_name = [](const std::string& name) {
    return name == "sacrum" ? std::string("S1") : name.substr(name.find('_') + 1);
  };
  return "disc_" + short_name(above) + "_" + short_name(below);
}

/// How a whole subject differs from the mean.
Deformation whole_deformation(int subject) {
  Variation variation;
  variation.half_size_mm = Vec3(45, 50, 130);
  variation.bump_radius_mm = 70;
  variation.bend_mm = 5;
  variation.elongation = 0.03;
  variation.shift_mm = 0;
  return {subject, spine_seed, variation};
}

/// A subject with so much of the variation of its bones and joints.
SpineMeshes varied_meshes(int subject, double amount) {
  const SpinePlan plan = spine_plan(subject, amount);
  const std::vector<PosedLevel> levels = posed_levels(plan, subject, amount);
  const Deformation whole = whole_deformation(subject);
  SpineMeshes made;
  const auto add = [&](const std::string& name, int value, MeshFile mesh, bool shown_only) {
    if (shown_only)
      made.beyond.push_back(std::move(mesh));
    else
      made.structures.push_back({name, value, std::move(mesh)});
  };
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const auto carry = [&](const Vec3& p) { return whole.to_subject(levels[k].to_scene(p)); };
    const bool last = k + 1 == levels.size();
    const int value = last ? sacrum_value : static_cast<int>(k);
    add(plan.levels[k].name, value, carried_mesh(last ? mean_sacrum() : mean_vertebra(), carry), k == 0);
    made.bodies.push_back(carry(Vec3::Zero()));
    made.canal.push_back(carry({0, 22.5, 10}));
    if (last) made.bodies.push_back(carry({0, -8, -70}));
    made.canal.push_back(carry(last ? Vec3(0, 14, -48) : Vec3(0, 22.5, -10)));
    if (last) break;
    const Solid solid_below = k + 2 == levels.size() ? sacrum_solid : vertebra_solid;
    const auto into_disc = [&](const Vec3& p) {
      return whole.to_subject(between_endplates(levels[k], levels[k + 1], solid_below, p));
    };
    const int below = k + 2 == levels.size() ? sacrum_value : value + 1;
    add(disc_name(plan.levels[k].name, plan.levels[k + 1].name), 10 + below, carried_mesh(mean_disc(), into_disc),
        k == 0);
  }
  return made;
}

/// Whether two bones that follow each other touch.
bool bones_touch(const SpineMeshes& spine) {
  for (std::size_t k = 2; k < spine.structures.size(); k += 2) {
    const MeshFile &above = spine.structures[k - 2].truth, &below = spine.structures[k].truth;
    const Eigen::Index points = above.points.rows(), faces = above.triangles.rows();
    Mesh both{nullptr, Points(points + below.points.rows(), 3)};
    both.points << above.points, below.points;
    Triangles triangles(faces + below.triangles.rows(), 3);
    triangles << *above.triangles, below.triangles->array() + static_cast<std::int32_t>(points);
    both.topology = Topology::make(both.points.rows(), std::move(triangles)).value();
    if (!self_intersections(both).empty()) return true;
  }
  return false;
}

}  // namespace

SpineMeshes spine_meshes(int subject) {
  if (subject == 0) return varied_meshes(0, 0);
  for (const double amount : {1.0, 0.75, 0.5, 0.25}) {
    SpineMeshes made = varied_meshes(subject, amount);
    if (!bones_touch(made)) return made;
  }
  return varied_meshes(subject, 0);
}

}  // namespace homolog::phantom
