#include "core/adapt/image/profiles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "core/base/processes/parallel.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

/// Trilinear value at a voxel position; unknown beyond the outer faces of the outermost voxels.
template <class T>
float trilinear(const T* frame, const std::array<int, 3>& dims, const Vec3& voxel) {
  std::array<std::ptrdiff_t, 3> low{}, step{1, dims[0], static_cast<std::ptrdiff_t>(dims[0]) * dims[1]};
  std::array<float, 3> part{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double at = voxel[static_cast<Eigen::Index>(a)];
    const int last = dims[a] - 1;
    if (!(at >= -0.5 && at <= last + 0.5)) return not_shown;
    const double inside = std::clamp(at, 0.0, static_cast<double>(last));
    low[a] = std::min(static_cast<int>(inside), std::max(last - 1, 0));
    part[a] = static_cast<float>(inside - static_cast<double>(low[a]));
    if (last == 0) step[a] = 0;
  }
  const T* corner = frame + low[0] + low[1] * step[1] + low[2] * dims[0] * static_cast<std::ptrdiff_t>(dims[1]);
  const auto along_i = [&](const T* p) {
    return static_cast<float>(p[0]) + part[0] * (static_cast<float>(p[step[0]]) - static_cast<float>(p[0]));
  };
  const auto along_j = [&](const T* p) {
    const float a = along_i(p), b = along_i(p + step[1]);
    return a + part[1] * (b - a);
  };
  const float a = along_j(corner), b = along_j(corner + step[2]);
  return a + part[2] * (b - a);
}

}  // namespace

double profile_step_mm(const Volume& image) {
  const Vec3& voxel = image.geometry.spacing_mm;
  return 0.5 * (voxel.sum() - voxel.minCoeff() - voxel.maxCoeff());
}

Profiles sample_profiles(const Volume& image, int frame, const Mesh& mesh, double reach_mm, double step_mm) {
  const VolumeGeometry& grid = image.geometry;
  const Eigen::Index middle = std::max<Eigen::Index>(1, static_cast<Eigen::Index>(std::ceil(reach_mm / step_mm)));
  Profiles profiles{Eigen::MatrixXf(2 * middle + 1, mesh.points.rows()), step_mm, vertex_normals(mesh)};
  const Mat3 to_voxel = grid.spacing_mm.cwiseInverse().asDiagonal() * grid.direction.inverse();
  std::visit(
      [&](const auto& voxels) {
        const auto* first = voxels.data() + static_cast<std::size_t>(frame) * grid.voxels();
        in_parallel(mesh.points.rows(), [&](Eigen::Index from, Eigen::Index to) {
          for (Eigen::Index i = from; i < to; ++i) {
            const Vec3 centre = to_voxel * (Vec3(mesh.points.row(i)) - grid.origin_mm);
            const Vec3 step = step_mm * (to_voxel * Vec3(profiles.normals.row(i)));
            for (Eigen::Index k = 0; k < profiles.values.rows(); ++k)
              profiles.values(k, i) = trilinear(first, grid.dims, centre + static_cast<double>(k - middle) * step);
          }
        });
      },
      image.data);
  return profiles;
}

Profiles smoothed_over_surface(const Topology& topology, Profiles profiles) {
  const Eigen::MatrixXf sharp = profiles.values;
  in_parallel(sharp.cols(), [&](Eigen::Index from, Eigen::Index to) {
    for (Eigen::Index i = from; i < to; ++i)
      for (Eigen::Index k = 0; k < sharp.rows(); ++k) {
        if (!std::isfinite(sharp(k, i))) continue;
        float sum = 2 * sharp(k, i), count = 2;
        for (const std::int32_t j : topology.one_ring(i)) {
          if (!std::isfinite(sharp(k, j))) continue;
          sum += sharp(k, j);
          count += 1;
        }
        profiles.values(k, i) = sum / count;
      }
  });
  return profiles;
}

}  // namespace homolog
