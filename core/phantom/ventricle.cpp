#include <cassert>
#include <functional>
#include <numbers>

#include "core/base/numbers/random.h"
#include "core/mesh/construction/tube_mesh.h"
#include "core/mesh/voxels/voxelise.h"
#include "core/phantom/chest.h"
#include "core/phantom/deformation.h"
#include "core/phantom/imaging.h"
#include "core/phantom/noise.h"
#include "core/phantom/organs.h"

// Short-axis cine MR (balanced steady-state: bright blood, dark muscle) of one heartbeat. Two frames are used: the
// ventricle's own (ventricle_shape.h), called `q`, and the patient's around the template's origin, called `p`.
namespace homolog::phantom {
namespace {

constexpr std::uint64_t ventricle_seed = 0x76656e7472;  // "ventr"
constexpr int frames = 20;
constexpr double heartbeat_s = 0.9;
constexpr int rings = 40, sectors = 64;
constexpr double slice_mm = 8;
constexpr int slices = 14, samples_per_slice = 4;

/// Heartbeats since end-diastole.
double time_of(int frame) {
  return static_cast<double>(frame) / frames;
}

/// The ventricle's axes as columns in LPS: lateral, inferior, apex to base. The apex points left, forward and down.
Mat3 ventricle_axes() {
  const Vec3 to_base = Vec3(-0.63, 0.61, 0.48).normalized();
  const Vec3 left_back(0.71, 0.70, 0.05);
  const Vec3 lateral = (left_back - left_back.dot(to_base) * to_base).normalized();
  Mat3 axes;
  axes << lateral, to_base.cross(lateral), to_base;
  return axes;
}
const Mat3 patient_from_ventricle = ventricle_axes();
const Vec3 template_centre(0, 0, 46);  ///< the origin of the patient's frame, in the ventricle's

Vec3 to_patient(const Vec3& q) {
  return patient_from_ventricle * (q - template_centre);
}
Vec3 to_ventricle(const Vec3& p) {
  return patient_from_ventricle.transpose() * p + template_centre;
}

/// Heights of the rings, base first, evenly spread along the wall from the base to the apex (which is no ring).
std::vector<double> ring_heights(const BeatingVentricle::Dimensions& dimensions) {
  constexpr int steps = 4000;
  std::vector<double> length_mm{0};
  const auto wall_point = [&](int step) {
    const double slope = static_cast<double>(step) / steps;
    const double height = 1 - slope * slope * (2 - slope);  // finer near the apex, where the profile is steep
    return Eigen::Vector2d(dimensions.radius_mm * profile(height), dimensions.length_mm * height);
  };
  for (int step = 1; step <= steps; ++step)
    length_mm.push_back(length_mm.back() + (wall_point(step) - wall_point(step - 1)).norm());
  std::vector<double> heights;
  for (int step = 0; step <= steps && std::ssize(heights) < rings; ++step)
    if (length_mm[step] * rings >= length_mm.back() * static_cast<double>(heights.size()))
      heights.push_back(wall_point(step).y() / dimensions.length_mm);
  return heights;
}

/// Vertex (ring, sector) has the index ring · sectors + sector, rings from the base; the apex is the last vertex.
Points endocardium(const BeatingVentricle& ventricle, const std::vector<double>& heights) {
  Points points(rings * sectors + 1, 3);
  for (int ring = 0; ring < rings; ++ring)
    for (int sector = 0; sector < sectors; ++sector)
      points.row(ring * sectors + sector) =
          ventricle.endocardium(heights[ring], 2 * std::numbers::pi * sector / sectors);
  points.row(rings * sectors) = ventricle.endocardium(0, 0);
  return points;
}

std::vector<Landmark> landmarks_of(const Points& points) {
  const auto at = [&](int ring, int sector) { return Vec3(points.row(ring * sectors + sector)); };
  return {{"apex", Vec3(points.row(rings * sectors))},
          {"base lateral", at(0, 0)},
          {"base inferior", at(0, sectors / 4)},
          {"base septal", at(0, sectors / 2)},
          {"base anterior", at(0, 3 * sectors / 4)},
          {"mid inferior insertion", at(rings / 2, sectors * 23 / 64)},
          {"mid anterior insertion", at(rings / 2, sectors * 41 / 64)}};
}

MeshFile surface(const BeatingVentricle::Dimensions& dimensions, double time, const Deformation& deformation) {
  MeshFile mesh;
  mesh.points = endocardium(BeatingVentricle(dimensions, time), ring_heights({}));
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i)
    mesh.points.row(i) = deformation.to_subject(to_patient(Vec3(mesh.points.row(i)))).transpose();
  mesh.triangles = tube_triangles(rings, sectors);
  mesh.stiffness = std::make_shared<const VertexScalars>(VertexScalars::Ones(mesh.points.rows()));
  mesh.landmarks = landmarks_of(mesh.points);
  return mesh;
}

Deformation deformation_of(int number) {
  Variation small;
  small.size = 0.05;
  small.elongation = 0.03;
  small.bump_mm = 1.8;
  small.half_size_mm = Vec3::Constant(38);
  small.bend_mm = 2;
  return {number, ventricle_seed, small};
}

BeatingVentricle::Dimensions dimensions_of(int number) {
  BeatingVentricle::Dimensions dimensions;
  if (number == 0) return dimensions;
  Random random(mix_bits(ventricle_seed ^ 1) + static_cast<std::uint64_t>(number));
  dimensions.wall_mm += random.uniform(-1.2, 1.5);
  dimensions.radial += random.uniform(-0.035, 0.035);
  dimensions.longitudinal += random.uniform(-0.03, 0.03);
  dimensions.twist_rad += random.uniform(-0.05, 0.05);
  return dimensions;
}

VolumeGeometry short_axis_grid(double spacing_mm) {
  VolumeGeometry grid;
  const double extent_mm = 179.2;
  const double in_plane_mm = spacing_mm > 0 ? std::max(spacing_mm, 0.5) : 1.4;
  const int width = static_cast<int>(std::lround(extent_mm / in_plane_mm));
  grid.dims = {width, width, slices};
  grid.spacing_mm = Vec3(in_plane_mm, in_plane_mm, slice_mm);
  grid.direction = patient_from_ventricle;
  grid.origin_mm = to_patient(Vec3(-extent_mm / 2 + in_plane_mm / 2 - 12, -extent_mm / 2 + in_plane_mm / 2, -slice_mm));
  return grid;
}

/// Edges in the plane are as soft as this.
double blur_of(const VolumeGeometry& grid) {
  return 1.3 * grid.spacing_mm[0];
}

/// One point inside a voxel, with what does not change over the heartbeat.
struct Sample {
  Vec3 q;
  double around, mottle;
  double gain;  ///< the coils lie on the chest
  bool still;
};

/// Maps a point of the subject to the mean shape's patient frame.
using ToMean = std::function<Vec3(const Vec3& p_mm)>;

/// The points that make up the thick voxels of slice k: samples_per_slice each, i fastest.
std::vector<Sample> samples_of_slice(const VolumeGeometry& grid, int k, const ToMean& to_mean, std::uint64_t seed) {
  std::vector<Sample> samples;
  samples.reserve(grid.voxels() / slices * samples_per_slice);
  for (int j = 0; j < grid.dims[1]; ++j)
    for (int i = 0; i < grid.dims[0]; ++i)
      for (int s = 0; s < samples_per_slice; ++s) {
        const double depth = (s + 0.5) / samples_per_slice - 0.5;
        const Vec3 p = to_mean(grid.to_mm({1.0 * i, 1.0 * j, k + depth}));
        const Vec3 q = to_ventricle(p);
        samples.push_back(
            {q, chest(p, blur_of(grid), seed), smooth_noise(p / 9, seed + 2), 1 - p.y() / 450, Heart::beyond(q)});
      }
  return samples;
}

std::vector<std::int16_t> cine(const VolumeGeometry& grid, const std::vector<Heart>& hearts, const ToMean& to_mean,
                               std::uint64_t seed, const Progress* progress) {
  const double noise = 9;
  const std::size_t slice_voxels = grid.voxels() / slices;
  std::vector<std::int16_t> voxels(grid.voxels() * frames);
  for (int k = 0; k < slices && !is_cancelled(progress); ++k) {
    const std::vector<Sample> samples = samples_of_slice(grid, k, to_mean, seed);
    for (int frame = 0; frame < frames && !is_cancelled(progress); ++frame) {
      const auto slice = static_cast<std::size_t>(frame * slices + k);
      const auto grain = slice_grain(grid.dims[0], grid.dims[1], seed, slice);
      const Heart& heart = hearts[frame];
      for (std::size_t n = 0; n < slice_voxels; ++n) {
        double sum = 0;
        for (std::size_t s = n * samples_per_slice; s < (n + 1) * samples_per_slice; ++s) {
          const Sample& at = samples[s];
          sum += at.gain * (at.still ? at.around : heart.paint(at.around, at.q, at.mottle, blur_of(grid)));
        }
        const double value = std::abs(sum / samples_per_slice + noise * grain[n]);
        voxels[slice * slice_voxels + n] = static_cast<std::int16_t>(std::lround(value));
      }
    }
  }
  return voxels;
}

/// 1 in the cavity (the truth, capped at the base), 2 in the myocardium.
std::vector<std::uint8_t> labels_of_frame(const VolumeGeometry& grid, const MeshFile& truth, const Heart& heart,
                                          const std::vector<Vec3>& centres) {
  const auto topology = Topology::make(truth.points.rows(), truth.triangles);
  assert(topology);
  std::vector<std::uint8_t> labels = voxelise({*topology, truth.points}, grid);
  for (std::size_t n = 0; n < labels.size(); ++n)
    if (labels[n] == 0 && heart.in_myocardium(centres[n])) labels[n] = 2;
  return labels;
}

/// The voxel centres in the ventricle's frame, i fastest.
std::vector<Vec3> voxel_centres(const VolumeGeometry& grid, const ToMean& to_mean) {
  std::vector<Vec3> centres;
  centres.reserve(grid.voxels());
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i)
        centres.push_back(to_ventricle(to_mean(grid.to_mm({1.0 * i, 1.0 * j, 1.0 * k}))));
  return centres;
}

}  // namespace

MeshFile ventricle_template() {
  return surface({}, 0, deformation_of(0));
}

std::vector<MeshFile> ventricle_truth(int number) {
  const auto dimensions = dimensions_of(number);
  const Deformation deformation = deformation_of(number);
  std::vector<MeshFile> truth;
  for (int frame = 0; frame < frames; ++frame) truth.push_back(surface(dimensions, time_of(frame), deformation));
  return truth;
}

PhantomSubject ventricle_subject(int number, double spacing_mm, const Progress* progress) {
  const auto dimensions = dimensions_of(number);
  const Deformation deformation = deformation_of(number);
  const ToMean to_mean = [&](const Vec3& p_mm) { return deformation.to_mean(p_mm); };
  const VolumeGeometry grid = short_axis_grid(spacing_mm);
  const std::vector<Vec3> centres = voxel_centres(grid, to_mean);

  PhantomSubject subject;
  subject.truth = ventricle_truth(number);
  std::vector<Heart> hearts;
  std::vector<std::uint8_t> labels;
  for (int frame = 0; frame < frames; ++frame) {
    if (is_cancelled(progress)) return {};
    hearts.emplace_back(dimensions, time_of(frame));
    const auto here = labels_of_frame(grid, subject.truth[frame], hearts.back(), centres);
    labels.insert(labels.end(), here.begin(), here.end());
  }
  subject.landmarks = subject.truth.front().landmarks;
  subject.image.geometry = subject.label_map.geometry = grid;
  subject.image.frames = subject.label_map.frames = frames;
  subject.image.frame_seconds = subject.label_map.frame_seconds = heartbeat_s / frames;
  subject.image.modality = "MR";
  subject.image.data =
      cine(grid, hearts, to_mean, mix_bits(ventricle_seed + static_cast<std::uint64_t>(number)), progress);
  subject.label_map.data = std::move(labels);
  note_range(subject.image);
  note_range(subject.label_map);
  return subject;
}

}  // namespace homolog::phantom
