#include "core/phantom/spine_image.h"

#include "core/base/numbers/random.h"
#include "core/base/processes/parallel.h"
#include "core/phantom/distance_field.h"
#include "core/phantom/imaging.h"
#include "core/phantom/implicit.h"
#include "core/phantom/noise.h"
#include "core/phantom/spine_levels.h"

// The bones and discs are painted by their distance from the true surfaces, all else by where it lies to the column's
// and the canal's middle in its slice.
namespace homolog::phantom {
namespace {

constexpr double cortex_mm = 1.2;

Mesh spine_surface(const MeshFile& file) {
  return {Topology::make(file.points.rows(), file.triangles).value(), file.points};
}

/// The place at which a line down the body, given by places from the head down, crosses the height `z`.
Vec3 crossing(const std::vector<Vec3>& line, double z) {
  std::size_t k = 1;
  while (k + 1 < line.size() && line[k].z() > z) ++k;
  const Vec3 step = line[k] - line[k - 1];
  const double share = std::clamp((line[k - 1].z() - z) / std::max(-step.z(), 1e-6), 0.0, 1.0);
  return line[k - 1] + share * step;
}

/// All that is the same for all voxels of a slice.
struct Slice {
  Vec3 column, canal;
  double down;       ///< 0 at the first lumbar vertebra, 1 at the sacrum
  double sacrum_mm;  ///< height over the first sacral body
};

struct Distances {
  double bone, disc, sacrum;
};

class Back {
 public:
  Back(const SpineMeshes& spine, int subject, double blur_mm)
      : spine_(spine), seed_(mix_bits(spine_seed ^ static_cast<std::uint64_t>(subject))), blur_mm_(blur_mm) {}

  Slice slice(double z) const {
    const auto& bodies = spine_.bodies;
    const double top = bodies[2].z(), sacrum = bodies[bodies.size() - 2].z();
    return {crossing(bodies, z), crossing(spine_.canal, z), std::clamp((top - z) / (top - sacrum), -0.5, 1.5),
            z - sacrum};
  }

  double hounsfield(const Slice& slice, const Vec3& p, const Distances& distance) const {
    const double fine = smooth_noise(p / 4, seed_ + 1);
    Voxel voxel{-102 + 12 * fine, blur_mm_};
    if (distance.bone > -blur_mm_) paint_soft_tissue(voxel, slice, p, fine);
    voxel.paint(distance.disc, 85 + 5 * fine);
    const double spongy = 190 + 66 * smooth_noise(p / 2.2, seed_ + 2);
    paint_ilium(voxel, slice, p, distance.sacrum, spongy);
    voxel.paint(distance.bone, 680);
    if (distance.bone < 0) voxel.paint(distance.bone + cortex_mm, spongy);
    if (distance.sacrum < -2) paint_sacral_disc(voxel, p);
    return voxel.value;
  }

 private:
  void paint_soft_tissue(Voxel& voxel, const Slice& slice, const Vec3& p, double fine) const {
    const double coarse = smooth_noise(p / 14, seed_);
    const Vec3 q = p - slice.column, c = p - slice.canal;
    const double muscle = 55 + 9 * fine, down = slice.down;
    const double streaks = 5 * std::max(0.0, coarse - 0.15);  // fat between the bundles
    const double side = std::abs(q.x());
    voxel.paint(smooth_max(q.y() + 52 + 14 * smooth_noise(p / 22, seed_ + 3), 4 - 20 * (coarse + 0.35), 4),
                35);  // bowel
    const double low = std::max(down, 0.0);
    const double psoas =
        elliptic_cylinder(side - 31 - 9 * low * low, q.y() - 4 + 14 * low, 12 + 6 * down, 15 + 6 * down);
    voxel.paint(psoas, muscle);
    voxel.paint(elliptic_cylinder(side - 58, c.y() - 8, 18, 9), muscle);  // quadratus lumborum
    const double behind = smooth_step(1.3, 0.7, down);                    // muscles end upon the sacrum
    const double erector = smooth_max(elliptic_cylinder(side - 28, c.y() - 31, 27, 8 + 11 * behind), 1.5 - side, 3);
    const double multifidus = elliptic_cylinder(side - 14, c.y() - 21, 14, 6 + 11 * behind);
    voxel.paint(erector + streaks, muscle - 4);
    voxel.paint(multifidus, -20);  // its fascia
    voxel.paint(multifidus + 0.8 * blur_mm_ + streaks, muscle);
    paint_vessels(voxel, p, q, down);
    voxel.paint(elliptic_cylinder(c.x(), c.y(), 12.5, 9), -60);  // epidural fat
    const double thin = 1 - 0.5 * std::clamp(down - 0.8, 0.0, 1.0);
    voxel.paint(elliptic_cylinder(c.x(), c.y(), 8.8 * thin, 6.8 * thin), 22);
    voxel.paint(elliptic_cylinder(c.x(), c.y() - 1, 4.6 * thin, 3.4 * thin), 42);
  }

  /// The aorta and the vena cava, which part above the sacrum.
  void paint_vessels(Voxel& voxel, const Vec3& p, const Vec3& q, double down) const {
    const double apart = 45 * std::max(0.0, down - 0.72), thin = 1 - 0.3 * smooth_step(0.70, 0.78, down);
    const double cava =
        elliptic_cylinder(std::abs(q.x() + 13) - apart, q.y() + 29 - 0.3 * apart, 11 * thin, 8.5 * thin);
    const double aorta = elliptic_cylinder(std::abs(q.x() - 11) - apart, q.y() + 31 - 0.1 * apart, 9 * thin, 9 * thin);
    voxel.paint(std::min(cava, aorta), 42);
    const double calcium = std::max(std::abs(aorta) - 0.7, 4 - 30 * (smooth_noise(p / 12, seed_ + 4) - 0.1));
    voxel.paint(calcium, 330);
  }

  /// The hip bones beside the sacrum.
  void paint_ilium(Voxel& voxel, const Slice& slice, const Vec3& p, double sacrum, double spongy) const {
    if (slice.sacrum_mm > 60) return;
    const Vec3 q = p - spine_.bodies[spine_.bodies.size() - 2];
    const double side = std::abs(q.x());
    const double along = 0.46 * (side - 40) - 0.89 * (q.y() - 55), across = 0.89 * (side - 40) + 0.46 * (q.y() - 55);
    const double thick = 5.5 + 3.5 * smooth_step(50, 10, along);
    const double sheet = ellipsoid(Vec3(along - 58, 0, q.z() + 12), Vec3(66, 1e3, 58));
    const double ilium = smooth_max(smooth_max(std::abs(across) - thick, sheet, 5), 2.2 - sacrum, 2);
    voxel.paint(ilium, 620);
    voxel.paint(ilium + cortex_mm, spongy);
  }

  /// Paints the rest of the disc between the first two sacral bodies.
  void paint_sacral_disc(Voxel& voxel, const Vec3& p) const {
    const Vec3 body = spine_.bodies[spine_.bodies.size() - 2], down = spine_.bodies.back() - body;
    const Vec3 from = p - body - 0.25 * down;
    const double along = from.dot(down.normalized());
    const double across = (from - along * down.normalized()).norm();
    const double disc = smooth_max(std::abs(along) - 1.1, across - 11, 2);
    voxel.paint(disc - 1, 400);
    voxel.paint(disc, 90);
  }

  const SpineMeshes& spine_;
  std::uint64_t seed_;
  double blur_mm_;
};

}  // namespace

Volume spine_image(const SpineMeshes& spine, int subject, const VolumeGeometry& grid, const Progress* progress) {
  const double blur_mm = 1.3 * grid.spacing_mm[0], reach_mm = std::max(cortex_mm + blur_mm, 3.5);
  std::vector<Mesh> bones, discs;
  for (std::size_t k = 0; k < spine.structures.size(); ++k)
    (k % 2 == 0 ? bones : discs).push_back(spine_surface(spine.structures[k].truth));
  const std::vector<float> sacrum = distance_field({bones.back()}, grid, reach_mm);
  if (is_cancelled(progress)) return {};
  for (std::size_t k = 0; k < spine.beyond.size(); ++k)
    (k % 2 == 0 ? bones : discs).push_back(spine_surface(spine.beyond[k]));
  const std::vector<float> bone = distance_field(bones, grid, reach_mm);
  if (is_cancelled(progress)) return {};
  const std::vector<float> disc = distance_field(discs, grid, reach_mm);

  const Back back(spine, subject, blur_mm);
  const std::uint64_t noise_seed = mix_bits(spine_seed + static_cast<std::uint64_t>(subject));
  const auto slice_voxels = static_cast<std::size_t>(grid.dims[0]) * static_cast<std::size_t>(grid.dims[1]);
  std::vector<std::int16_t> voxels(grid.voxels());
  for_each_in_parallel(static_cast<std::size_t>(grid.dims[2]), [&](std::size_t k) {
    if (is_cancelled(progress)) return;
    const auto grain = slice_grain(grid.dims[0], grid.dims[1], noise_seed, k);
    const Slice slice = back.slice(grid.to_mm({0, 0, static_cast<double>(k)}).z());
    std::size_t n = k * slice_voxels;
    auto grain_here = grain.begin();
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i, ++n) {
        const Vec3 p = grid.to_mm({1.0 * i, 1.0 * j, static_cast<double>(k)});
        const double value = back.hounsfield(slice, p, {bone[n], disc[n], sacrum[n]}) + 22 * *grain_here++;
        voxels[n] = static_cast<std::int16_t>(std::lround(std::clamp(value, -1024.0, 3071.0)));
      }
  });
  Volume image;
  image.geometry = grid;
  image.modality = "CT";
  image.data = std::move(voxels);
  note_range(image);
  return image;
}

}  // namespace homolog::phantom
