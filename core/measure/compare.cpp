#include "core/measure/compare.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/base/demand.h"
#include "core/mesh/check_mesh.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/mesh/voxels/voxelise.h"
#include "core/volume/check_volume.h"
#include "core/volume/labels/label_likeness.h"

namespace homolog {
namespace {

constexpr double dice_spacing_mm = 0.5;
constexpr double least_voxels_across = 128;    ///< voxels of the grid for Dice; finer where meshes are smaller
constexpr double largest_grid = 0x1p31;        ///< voxels of the grid for Dice; coarser beyond
constexpr std::size_t slab_voxels = 1u << 24;  ///< voxelised at a time
constexpr double samples_per_surface = 20000;

/// Distances from one surface to another. Each face is cut into n² equal triangles of at most 1/20,000 of the whole
/// area, sampled at their centres; its corners count for the largest distance only.
class DirectedDistances {
 public:
  DirectedDistances(const Mesh& from, const SurfaceSearch& to) : from_(from), to_(to) {
    const Eigen::Index faces = from.topology->triangles().rows();
    for (Eigen::Index f = 0; f < faces; ++f) area_mm2_ += area_of(f);
    found_in_face_.reserve(static_cast<std::size_t>(faces));
    for (Eigen::Index f = 0; f < faces; ++f) {
      sample_face(f);
      found_in_face_.push_back(found_.position);
    }
    for (Eigen::Index f = 0; f < faces; ++f)
      for (int k = 0; k < 3; ++k) look_at_corner(corner(f, k), found_in_face_[f]);
  }

  double area_mm2() const { return area_mm2_; }
  double integral_mm3() const { return integral_mm3_; }
  double largest_mm() const { return largest_mm_; }
  /// The distance below which `share` of the area is.
  double percentile(double share) {
    std::sort(samples_.begin(), samples_.end(),
              [](const Sample& a, const Sample& b) { return a.distance_mm < b.distance_mm; });
    double below = 0;
    for (const Sample& sample : samples_)
      if ((below += sample.area_mm2) >= share * area_mm2_) return sample.distance_mm;
    return samples_.empty() ? 0 : samples_.back().distance_mm;
  }

 private:
  struct Sample {
    double distance_mm, area_mm2;
  };

  Vec3 corner(Eigen::Index f, int k) const { return from_.points.row(from_.topology->triangles()(f, k)); }
  double area_of(Eigen::Index f) const { return area_normal(from_, f).norm() / 2; }

  void sample_face(Eigen::Index f) {
    const Vec3 a = corner(f, 0), u = corner(f, 1) - a, v = corner(f, 2) - a;
    const double area = area_of(f);
    const double parts = area > 0 ? area / area_mm2_ * samples_per_surface : 1;
    const int n = std::max(1, static_cast<int>(std::ceil(std::sqrt(parts))));
    const auto add = [&](int i, int j) {  // the part whose centre is i and j thirds of a step along u and v
      found_ = to_.nearest(a + (i * u + j * v) / (3.0 * n), found_.at.face);
      samples_.push_back({found_.distance_mm, area / (n * n)});
      integral_mm3_ += found_.distance_mm * area / (n * n);
      largest_mm_ = std::max(largest_mm_, found_.distance_mm);
    };
    for (int i = 0; i < n; ++i) {
      for (int j = 0; i + j < n; ++j) {
        add(3 * i + 1, 3 * j + 1);
        if (i + j + 1 < n) add(3 * i + 2, 3 * j + 2);
      }
    }
  }

  /// A point of the other surface found close by bounds the corner's distance, nearly always well enough.
  void look_at_corner(const Vec3& at, const Vec3& found_beside) {
    if ((at - found_beside).norm() > largest_mm_) largest_mm_ = std::max(largest_mm_, to_.nearest(at).distance_mm);
  }

  const Mesh& from_;
  const SurfaceSearch& to_;
  SurfaceSearch::Nearest found_;
  std::vector<Vec3> found_in_face_;
  std::vector<Sample> samples_;
  double area_mm2_ = 0, integral_mm3_ = 0, largest_mm_ = 0;
};

double mean_of(const DirectedDistances& there, const DirectedDistances& back) {
  const double area = there.area_mm2() + back.area_mm2();
  return area > 0 ? (there.integral_mm3() + back.integral_mm3()) / area : 0;
}

void compare_surfaces(const Mesh& a, const Mesh& b, Agreement& agreement) {
  const SurfaceSearch search_a(a), search_b(b);
  DirectedDistances there(a, search_b), back(b, search_a);
  agreement.assd_mm = mean_of(there, back);
  agreement.hd95_mm = std::max(there.percentile(0.95), back.percentile(0.95));
  agreement.hausdorff_mm = std::max(there.largest_mm(), back.largest_mm());
}

/// Voxels that two sets hold, each and both.
struct Overlap {
  std::size_t a = 0, b = 0, both = 0;

  void add(bool in_a, bool in_b) {
    a += in_a;
    b += in_b;
    both += in_a && in_b;
  }
  /// 1 where both are empty.
  double dice() const { return a + b > 0 ? 2.0 * static_cast<double>(both) / static_cast<double>(a + b) : 1; }
};

/// A grid with further slices, as many as a mesh reaches beyond it, and how many of them come before its own.
std::pair<VolumeGeometry, std::size_t> with_slices_of(const VolumeGeometry& grid, const Mesh& mesh) {
  double first = 0, last = grid.dims[2] - 1;
  for (Eigen::Index p = 0; p < mesh.points.rows(); ++p) {
    const double at = grid.to_voxel(Vec3(mesh.points.row(p))).z();
    first = std::min(first, at);
    last = std::max(last, at);
  }
  // Nobody looks at a mesh that lies farther off than the whole grid.
  const auto slices = [&](double beyond) { return static_cast<int>(std::ceil(std::min(beyond, grid.dims[2] + 1.0))); };
  const int before = slices(-first), behind = slices(last - (grid.dims[2] - 1));
  VolumeGeometry wide = grid;
  wide.origin_mm = grid.to_mm(Vec3(0, 0, -before));
  wide.dims[2] += before + behind;
  return {wide, static_cast<std::size_t>(before)};
}

double dice_of_meshes(const Mesh& a, const Mesh& b) {
  const Box box_a = bounds_of(a.points), box_b = bounds_of(b.points);
  const Box box = box_a.merged(box_b);
  if (!box_a.intersects(box_b) || !box.sizes().allFinite()) return 0;
  constexpr int most_doublings = 1024;  // as many as a finite number has
  double spacing = dice_spacing_mm;
  const double longest_mm = box.sizes().maxCoeff();
  for (int k = 0; k < most_doublings && longest_mm > 0 && spacing * least_voxels_across > longest_mm; ++k) spacing /= 2;
  for (int k = 0; k < most_doublings && (box.sizes() / spacing + Vec3::Ones()).prod() > largest_grid; ++k) spacing *= 2;
  VolumeGeometry grid;
  grid.spacing_mm.setConstant(spacing);
  for (std::size_t axis = 0; axis < 3; ++axis)
    grid.dims[axis] = 1 + static_cast<int>(box.sizes()[static_cast<Eigen::Index>(axis)] / spacing);

  const int slices = grid.dims[2];
  const std::size_t slice_voxels = static_cast<std::size_t>(grid.dims[0]) * static_cast<std::size_t>(grid.dims[1]);
  const int slab =
      static_cast<int>(std::clamp<std::size_t>(slab_voxels / slice_voxels, 1, static_cast<std::size_t>(slices)));
  Overlap overlap;
  for (int first = 0; first < slices; first += slab) {
    grid.dims[2] = std::min(slab, slices - first);
    grid.origin_mm = box.min() + Vec3(0.5, 0.5, 0.5 + first) * spacing;
    const auto in_a = voxelise(a, grid), in_b = voxelise(b, grid);
    for (std::size_t i = 0; i < in_a.size(); ++i) overlap.add(in_a[i] != 0, in_b[i] != 0);
  }
  return overlap.dice();
}

void demand_meshes(const Mesh& a, const Mesh& b) {
  demand(check_mesh(a, "the first surface"));
  demand(check_mesh(b, "the second surface"));
}

}  // namespace

SurfaceDistance surface_distance(const Mesh& from, const Mesh& to) {
  demand_meshes(from, to);
  const SurfaceSearch search(to);
  DirectedDistances distances(from, search);
  const double area = distances.area_mm2();
  return {area > 0 ? distances.integral_mm3() / area : 0, distances.percentile(0.95), distances.largest_mm()};
}

Agreement compare_meshes(const Mesh& a, const Mesh& b) {
  demand_meshes(a, b);
  Agreement agreement;
  compare_surfaces(a, b, agreement);
  agreement.dice = dice_of_meshes(a, b);
  if (a.topology->hash() == b.topology->hash()) {
    const VertexScalars distance = (a.points - b.points).rowwise().norm();
    agreement.vertex_mean_mm = distance.mean();
    agreement.vertex_max_mm = distance.maxCoeff();
  }
  return agreement;
}

double mean_surface_distance_mm(const Mesh& a, const Mesh& b) {
  if (!a.topology || !b.topology) return std::numeric_limits<double>::quiet_NaN();
  demand_meshes(a, b);
  const SurfaceSearch search_a(a), search_b(b);
  return mean_of(DirectedDistances(a, search_b), DirectedDistances(b, search_a));
}

Result<Agreement> compare_with_mask(const Mesh& mesh, const Volume& mask, int label, int frame) {
  if (auto sound = check_mesh(mesh, "the surface"); !sound) return fail(sound.error());
  if (auto sound = check_frame_of(mask, frame); !sound) return fail(sound.error());
  const auto surface = mask_surface(mask, label, frame);
  if (!surface) return fail(surface.error());
  Agreement agreement;
  compare_surfaces(mesh, *surface, agreement);
  agreement.dice = dice_with_mask(mesh, mask, label, frame);
  return agreement;
}

double dice_with_mask(const Mesh& mesh, const Volume& mask, int label, int frame) {
  demand(check_mesh(mesh, "the surface"));
  demand(check_frame_of(mask, frame));
  const auto in_mesh = voxelise(mesh, mask.geometry);
  Overlap overlap;
  if (mask.empty_beyond_slices) {
    const auto [wide, before] = with_slices_of(mask.geometry, mesh);
    const auto in_wide = voxelise(mesh, wide);
    const std::size_t begin = before * (in_mesh.size() / static_cast<std::size_t>(mask.geometry.dims[2]));
    for (std::size_t i = 0; i < in_wide.size(); ++i)
      if (i < begin || i >= begin + in_mesh.size()) overlap.add(in_wide[i] != 0, false);
  }
  std::visit(
      [&](const auto& voxels) {
        const auto in_frame =
            voxels.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(frame) * in_mesh.size());
        for (std::size_t i = 0; i < in_mesh.size(); ++i)
          overlap.add(in_mesh[i] != 0, has_label(in_frame[static_cast<std::ptrdiff_t>(i)], label));
      },
      mask.data);
  return overlap.dice();
}

Result<int> only_label(const Volume& mask, int frame) {
  const auto labels = labels_of(mask, frame);
  if (labels.size() == 1) return labels.begin()->first;
  if (labels.empty()) return fail("", "holds no label (every voxel is 0); choose a label map that does");
  std::string names;
  for (const auto& [label, voxels] : labels) {
    if (names.size() > 100) {
      names += ", …";
      break;
    }
    names += (names.empty() ? "" : ", ") + std::to_string(label);
  }
  if (!holds_labels(mask))
    return fail("", "holds several labels (" + names +
                        ") and looks like a grey image; give its label map, or name one of them");
  return fail("", "holds several labels (" + names + "); name one of them");
}

}  // namespace homolog
