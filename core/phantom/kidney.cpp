#include "core/base/numbers/random.h"
#include "core/phantom/imaging.h"
#include "core/phantom/implicit.h"
#include "core/phantom/noise.h"
#include "core/phantom/organs.h"
#include "core/phantom/solid_template.h"
#include "core/phantom/spine.h"

// A right kidney in the portal-venous phase. The scene's frame has its origin in the kidney and the patient's axes:
// x to the left (towards the spine), y to the back, z to the head.
namespace homolog::phantom {
namespace {

constexpr std::uint64_t kidney_seed = 0x6b69646e6579;  // "kidney"

/// Kidney axes as columns: towards the hilum, to the back, along the organ. The hilum looks forward and to the spine,
/// the upper pole leans to the spine and to the back.
Mat3 kidney_axes() {
  const Vec3 along = Vec3(0.19, 0.15, 1).normalized();
  const Vec3 lean(0.87, -0.50, 0);
  const Vec3 medial = (lean - lean.dot(along) * along).normalized();
  Mat3 axes;
  axes << medial, along.cross(medial), along;
  return axes;
}
const Mat3 scene_from_kidney = kidney_axes();
const Mat3 kidney_from_scene = scene_from_kidney.transpose();

/// The recess on the medial side, in kidney axes straightened as in `kidney_solid`.
double recess(const Vec3& q) {
  return ellipsoid(q - Vec3(25.5, -0.5, -1), Vec3(15.5, 7.5, 18));
}

Vec3 straightened(const Vec3& p) {
  Vec3 q = kidney_from_scene * p;
  q.x() -= 0.0030 * q.z() * q.z() - 3.0;  // both poles lean to the hilum's side
  return q;
}

double kidney_solid(const Vec3& p) {
  const Vec3 q = straightened(p);
  const double girth = 1 + 0.0012 * q.z();  // the upper half is the larger
  const double bean = ellipsoid(q, Vec3(29 * girth, 23 * girth, 54));
  return smooth_max(bean, -recess(q), 9);
}

const SolidTemplate& mean_kidney() {
  static const SolidTemplate kidney = [] {
    const auto place = [](double x, double y, double z) { return Vec3(scene_from_kidney * Vec3(x, y, z)); };
    SolidTemplate made = template_of(kidney_solid, Box(Vec3(-45, -45, -65), Vec3(45, 45, 65)), 2500,
                                     {{"hilum", place(10, -0.5, -1)},
                                      {"superior pole", place(6, 0, 56)},
                                      {"inferior pole", place(6, 0, -56)},
                                      {"lateral convexity", place(-34, 0, 0)},
                                      {"anterior lip", place(24, -14, 0)},
                                      {"posterior lip", place(24, 14, 0)},
                                      {"superior hilar notch", place(24, 0, 22)},
                                      {"inferior hilar notch", place(24, 0, -24)}});
    // Capsule 5, hilum 1 [Erdt 2009, §2.1], with a soft edge.
    made.mesh.regions.list = {{"capsule", 5, {224, 164, 88}}, {"hilum", 1, {96, 165, 214}}};
    VertexScalars stiffness(made.mesh.points.rows());
    for (Eigen::Index i = 0; i < stiffness.size(); ++i) {
      const double from_recess_mm = recess(straightened(Vec3(made.mesh.points.row(i)) + made.centre_mm));
      const double capsule = smooth_step(2, 12, from_recess_mm);
      stiffness[i] = 1 + 4 * capsule;
      made.mesh.regions.of_vertex.push_back(capsule >= 0.5 ? 1 : 2);
    }
    made.mesh.stiffness = std::make_shared<const VertexScalars>(std::move(stiffness));
    return made;
  }();
  return kidney;
}

/// The differences between patients besides shape.
struct Contrast {
  double cortex, medulla, liver, vessels;
};

/// The neighbourhood of the mean kidney; a subject's voxels look their tissue up here through the deformation.
class Abdomen {
 public:
  Abdomen(int number, double blur_mm)
      : seed_(mix_bits(kidney_seed ^ static_cast<std::uint64_t>(number))), blur_mm_(blur_mm) {
    Random random(seed_);
    if (number == 0) return;
    contrast_.cortex += random.uniform(-20, 20);
    contrast_.medulla = contrast_.cortex - random.uniform(25, 45);
    contrast_.liver += random.uniform(-12, 12);
    contrast_.vessels += random.uniform(-15, 15);
    liver_edge_mm_ += random.uniform(-12, 12);
    perirenal_fat_mm_ += random.uniform(-1.5, 3);
  }

  double hounsfield(const Vec3& p) const {
    const double skin = elliptic_cylinder(p.x() - 72, p.y() + 40, 165, 118);
    const double coarse = smooth_noise(p / 17, seed_), fine = smooth_noise(p / 5, seed_ + 1);
    Voxel voxel{-1000, blur_mm_};
    if (skin > 2) return voxel.value;
    voxel.paint(skin, 20);
    voxel.paint(skin + 2, -105 + 14 * fine);
    const double kidney = kidney_solid(p);
    paint_wall(voxel, p, skin, fine);
    paint_back(voxel, p, fine);
    paint_bowel(voxel, p, skin, coarse, fine);
    paint_liver(voxel, p, skin, kidney, coarse);
    paint_vessels(voxel, p);
    paint_kidney(voxel, p, kidney, coarse, fine);
    return voxel.value;
  }

 private:
  /// Muscle layers of the abdominal wall, and the ribs in it.
  void paint_wall(Voxel& voxel, const Vec3& p, double skin, double fine) const {
    const double layer = std::abs(skin + 22 + 2 * fine) - 6;
    voxel.paint(std::max(layer, p.x() - 45), 56 + 8 * fine);
    voxel.paint(std::abs(skin + 22.5) - 0.4, -20);  // fat between the layers
    if (std::abs(skin + 23) > 6 || p.x() > 38) return;
    for (const auto& [height_mm, end_y_mm] : {std::pair(92.0, -200.0), std::pair(58.0, -70.0), std::pair(24.0, 18.0)}) {
      const double rise = p.z() - height_mm + 12 - 0.55 * p.y();
      const double tube = elliptic_cylinder(skin + 23, 0.87 * rise, 3.6, 6.2);
      const double rib = std::max(tube, end_y_mm - p.y());
      voxel.paint(rib, 480);
      voxel.paint(rib + 1.3, 150);
    }
  }

  /// Muscles along the spine, and the spine itself.
  void paint_back(Voxel& voxel, const Vec3& p, double fine) const {
    const Vec3 s = p - spine_centre;
    const double side = std::abs(s.x());
    const double muscle = 60 + 10 * fine;
    const double sink = (p.z() + 20) / 100;  // the psoas grows downwards
    voxel.paint(elliptic_cylinder(side - 31 + 3 * sink, s.y() - 5, 13 - 6 * sink, 18 - 8 * sink), muscle);
    voxel.paint(elliptic_cylinder(side - 53, s.y() - 45, 20, 9), muscle - 3);
    voxel.paint(smooth_max(elliptic_cylinder(side - 25, s.y() - 58, 26, 20), 2 - side, 3), muscle - 8 + 14 * fine);
    paint_spine(voxel, s, 2 * fine);
  }

  /// Loops in front of the kidney: a wall, and contents with gas above the fluid level.
  void paint_bowel(Voxel& voxel, const Vec3& p, double skin, double coarse, double fine) const {
    const double ripple = 3 * coarse;
    const double flexure = round_cone(p, {-34, -54, -62}, {22, -76, -36}, 18, 15);
    const double ascending = round_cone(p, {-34, -54, -62}, {-38, -42, -110}, 18, 21);
    const double duodenum = round_cone(p, {27, -48, 10}, {22, -46, -62}, 11, 12);
    const double jejunum =
        std::min({ellipsoid(p - Vec3(86, -84, -40), {20, 15, 22}), ellipsoid(p - Vec3(66, -98, 4), {30, 11, 15}),
                  ellipsoid(p - Vec3(52, -84, -58), {15, 14, 17})});
    const double colon = smooth_min(flexure, ascending, 6) + ripple;
    for (const auto& [loop, contents] :
         {std::pair(jejunum + ripple, 32.0), std::pair(duodenum + ripple, 38.0), std::pair(colon, 18.0)}) {
      const double within_wall = smooth_max(loop, skin + 32, 4);
      voxel.paint(within_wall, 66);
      voxel.paint(within_wall + 2.5, contents + 40 * fine);
    }
    voxel.paint(smooth_max(colon + 3, p.y() + 62 + 5 * coarse, 2), -850);
    const double mesenteric = std::min(round_cone(p, {70, -66, 40}, {58, -72, -80}, 3.2, 2.4),
                                       round_cone(p, {76, -64, 30}, {78, -70, -80}, 2.6, 1.8));
    voxel.paint(mesenteric, contrast_.vessels);
  }

  void paint_liver(Voxel& voxel, const Vec3& p, double skin, double kidney, double coarse) const {
    const double lobe = ellipsoid(p - Vec3(-26, -42, 66), Vec3(80, 76, liver_edge_mm_)) + 2 * coarse;
    // The liver lies on the upper front of the kidney with almost no fat between them.
    const double gap_mm =
        perirenal_fat_mm_ + 9 * smooth_step(-10, 25, p.y() - 0.35 * p.z()) + 5 * smooth_step(10, -30, p.z());
    double liver = smooth_max(lobe, skin + 31, 8);
    liver = smooth_max(liver, gap_mm - kidney, 5);
    liver = smooth_max(liver, 16 - elliptic_cylinder(p.x() - 62, p.y() + 40, 22, 14), 8);  // clear of the great vessels
    voxel.paint(liver, contrast_.liver + 7 * coarse);
    const double gallbladder = ellipsoid(p - Vec3(14, -74, 4), {12, 15, 21});
    voxel.paint(gallbladder - 1.5, 70);
    voxel.paint(gallbladder, 9);
    if (liver > 0) return;
    const Vec3 bent = p + Vec3(0, 6 * coarse, 0);
    const double vein = std::min({round_cone(bent, {30, -48, 70}, {-25, -38, 62}, 5, 3),
                                  round_cone(bent, {-25, -38, 62}, {-55, -20, 40}, 3, 1.6),
                                  round_cone(bent, {-10, -40, 64}, {-30, -75, 34}, 3.4, 1.6),
                                  round_cone(bent, {20, -50, 92}, {-40, -55, 60}, 4.4, 1.8),
                                  round_cone(bent, {-30, -48, 60}, {-48, -70, 30}, 2.6, 1.2)});
    voxel.paint(smooth_max(vein, liver + 4, 2), contrast_.vessels);
  }

  void paint_vessels(Voxel& voxel, const Vec3& p) const {
    const Vec3 hilum = scene_from_kidney * Vec3(16, -1, 0);
    const double cava = elliptic_cylinder(p.x() - 50 - 0.03 * p.z(), p.y() + 45, 12, 9);
    const double aorta = elliptic_cylinder(p.x() - 79, p.y() + 45, 9.5, 9.5);
    const double vein = round_cone(p, hilum + Vec3(0, -2, 3), {46, -42, 8}, 3.6, 5.2);
    const double artery = round_cone(p, hilum + Vec3(0, 2, 6), {72, -38, 14}, 2.0, 2.9);
    const double pelvis = round_cone(p, hilum + Vec3(0, 2, -5), {28, -14, -26}, 5.2, 3);
    const double ureter = round_cone(p, {28, -14, -26}, {32, -20, -110}, 2.4, 2.2);
    voxel.paint(std::min(pelvis, ureter), 12);
    voxel.paint(artery, contrast_.vessels + 10);
    voxel.paint(std::min(cava, vein), contrast_.vessels);
    voxel.paint(aorta, contrast_.vessels + 12);
    voxel.paint(std::max(std::abs(aorta) - 0.7, p.x() - 84), 260);  // a little calcium
  }

  /// Cortex outside and in columns, pyramids of medulla between them, two calyces with their fat.
  void paint_kidney(Voxel& voxel, const Vec3& p, double kidney, double coarse, double fine) const {
    if (kidney > blur_mm_) return;
    voxel.paint(kidney, contrast_.cortex + 6 * coarse);
    const Vec3 q = straightened(p);
    const double depth = kidney + 6.5 + 1.5 * fine;
    const Vec3 outward = (q - Vec3(8, 0, 0.72 * q.z())).normalized();
    // Columns part the pyramids about every 15 mm along the organ and a few times around it.
    const double columns = std::abs(smooth_noise(Vec3(q.z() / 13, 2.2 * outward.y(), 2.2 * outward.x()), kidney_seed));
    voxel.paint(smooth_max(depth, 1.2 - 20 * (columns - 0.05), 2), contrast_.medulla + 4 * coarse);
    const double calyces =
        std::min(round_cone(q, {12, 0, 8}, {8, 1, 26}, 1.5, 2.6), round_cone(q, {12, 0, -10}, {8, 1, -27}, 1.5, 2.6));
    voxel.paint(calyces - 1.8, -30);
    voxel.paint(calyces, 14);
  }

  static inline const Vec3 spine_centre{66, -14, 10};
  Contrast contrast_{176, 138, 118, 158};
  double liver_edge_mm_ = 74;      ///< vertical half size of the right lobe
  double perirenal_fat_mm_ = 0.5;  ///< between liver and kidney where they lie closest
  std::uint64_t seed_;
  double blur_mm_;
};

Deformation kidney_deformation(int number) {
  Variation variation;
  variation.half_size_mm = Vec3(28, 24, 52);
  return {number, kidney_seed, variation};
}

}  // namespace

MeshFile kidney_template() {
  return mean_kidney().mesh;
}

std::vector<MeshFile> kidney_truth(int number) {
  return {deformed(mean_kidney().mesh, kidney_deformation(number))};
}

PhantomSubject kidney_subject(int number, double spacing_mm, const Progress* progress) {
  const SolidTemplate& mean = mean_kidney();
  const Deformation deformation = kidney_deformation(number);
  const VolumeGeometry grid = grid_over(Box(Vec3(-93, -112, -96), Vec3(99, 80, 96)), spacing_mm, 1.5);
  const Abdomen abdomen(number, 1.3 * grid.spacing_mm[0]);
  const auto hounsfield = [&](const Vec3& p_mm) {
    return abdomen.hounsfield(deformation.to_mean(p_mm) + mean.centre_mm);
  };
  const std::uint64_t noise_seed = mix_bits(kidney_seed + static_cast<std::uint64_t>(number));
  return solid_subject(mean, deformation, ct_image(grid, hounsfield, 13, noise_seed, progress));
}

}  // namespace homolog::phantom
