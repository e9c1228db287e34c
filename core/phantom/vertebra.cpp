#include "core/base/numbers/random.h"
#include "core/phantom/imaging.h"
#include "core/phantom/implicit.h"
#include "core/phantom/noise.h"
#include "core/phantom/organs.h"
#include "core/phantom/solid_template.h"
#include "core/phantom/spine.h"

// A lumbar vertebra between its neighbours, without contrast agent. The scene's frame has its origin in the vertebral
// body and the patient's axes: x to the left, y to the back, z to the head.
namespace homolog::phantom {
namespace {

constexpr std::uint64_t vertebra_seed = 0x7665727465627261;  // "vertebra"

/// The neighbourhood of the mean vertebra; a subject's voxels look their tissue up here through the deformation.
class LumbarSpine {
 public:
  LumbarSpine(int number, double blur_mm)
      : seed_(mix_bits(vertebra_seed ^ static_cast<std::uint64_t>(number))), blur_mm_(blur_mm) {}

  double hounsfield(const Vec3& p) const {
    const double coarse = smooth_noise(p / 14, seed_), fine = smooth_noise(p / 4, seed_ + 1);
    Voxel voxel{-102 + 12 * fine, blur_mm_};
    paint_muscles(voxel, p, coarse, fine);
    const double cava = elliptic_cylinder(p.x() + 15, p.y() + 31, 12, 9);
    const double aorta = elliptic_cylinder(p.x() - 11, p.y() + 30, 9, 9);
    voxel.paint(std::min(cava, aorta), 42);
    voxel.paint(std::max(std::abs(aorta) - 0.7, p.y() + 35), 330);  // a little calcium
    paint_spine(voxel, p, 2.2 * smooth_noise(p / 2.2, seed_ + 2));
    return voxel.value;
  }

 private:
  void paint_muscles(Voxel& voxel, const Vec3& p, double coarse, double fine) const {
    const double side = std::abs(p.x());
    const double muscle = 55 + 9 * fine;
    const double streaks = 5 * std::max(0.0, coarse - 0.15);  // fat between the bundles
    voxel.paint(elliptic_cylinder(side - 35, p.y() - 6, 15, 19), muscle);
    voxel.paint(elliptic_cylinder(side - 57, p.y() - 34, 17, 9), muscle);
    const double erector = smooth_max(elliptic_cylinder(side - 27, p.y() - 53, 27, 18), 1.5 - side, 3);
    const double multifidus = elliptic_cylinder(side - 14, p.y() - 47, 13, 14);
    voxel.paint(erector + streaks, muscle - 4);
    voxel.paint(multifidus, -20);  // its fascia
    voxel.paint(multifidus + 0.8 * blur_mm_ + streaks, muscle);
    voxel.paint(70 - 0.004 * side * side - p.y(), -104 + 10 * fine);  // under the skin
  }

  std::uint64_t seed_;
  double blur_mm_;
};

Deformation vertebra_deformation(int number) {
  Variation variation;
  variation.half_size_mm = Vec3(40, 36, 20);
  variation.bump_radius_mm = 28;
  variation.bump_mm = 1.8;
  variation.bend_mm = 1.8;
  variation.bumps = 12;
  return {number, vertebra_seed, variation};
}

}  // namespace

const SolidTemplate& mean_vertebra() {
  static const SolidTemplate vertebra = template_of(vertebra_solid, Box(Vec3(-52, -24, -32), Vec3(52, 72, 30)), 2500,
                                                    {{"body anterior superior", {0, -16, 13}},
                                                     {"body anterior inferior", {0, -16, -13}},
                                                     {"body posterior superior", {0, 14, 13}},
                                                     {"body posterior inferior", {0, 14, -13}},
                                                     {"body left lateral", {21, 0, 0}},
                                                     {"body right lateral", {-21, 0, 0}},
                                                     {"spinous process tip", {0, 64, -8}},
                                                     {"left transverse process tip", {45, 33, 5}},
                                                     {"right transverse process tip", {-45, 33, 5}},
                                                     {"left superior articular process tip", {19, 29, 21}},
                                                     {"right superior articular process tip", {-19, 29, 21}},
                                                     {"left inferior articular process tip", {11.5, 39, -24}},
                                                     {"right inferior articular process tip", {-11.5, 39, -24}}});
  return vertebra;
}

MeshFile vertebra_template() {
  return mean_vertebra().mesh;
}

std::vector<MeshFile> vertebra_truth(int number) {
  return {deformed(mean_vertebra().mesh, vertebra_deformation(number))};
}

PhantomSubject vertebra_subject(int number, double spacing_mm, const Progress* progress) {
  const SolidTemplate& mean = mean_vertebra();
  const Deformation deformation = vertebra_deformation(number);
  const VolumeGeometry grid = grid_over(Box(Vec3(-60, -66, -50), Vec3(60, 60, 50)), spacing_mm, 1);
  const LumbarSpine spine(number, 1.3 * grid.spacing_mm[0]);
  const auto hounsfield = [&](const Vec3& p_mm) {
    return spine.hounsfield(deformation.to_mean(p_mm) + mean.centre_mm);
  };
  const std::uint64_t noise_seed = mix_bits(vertebra_seed + static_cast<std::uint64_t>(number));
  return solid_subject(mean, deformation, ct_image(grid, hounsfield, 22, noise_seed, progress));
}

}  // namespace homolog::phantom
