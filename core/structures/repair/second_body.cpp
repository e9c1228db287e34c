#include "core/structures/repair/second_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>

#include "core/base/numbers/index.h"
#include "core/mesh/mesh_quality.h"
#include "core/structures/fitting/neighbours_say.h"

namespace homolog {

std::optional<BodyInMap> second_body(const SetOfTemplates& set, const SetInMap& subject, const VolumeRead& map,
                                     int frame, std::size_t missing, std::size_t of) {
  constexpr double half_as_large = 0.5, same_way = 0.8, nearer = 0.7, farther = 1.4;
  const StructureInMap& there = subject.structures[of];
  const Template *own = set.templates[missing].get(), *other = set.templates[of].get();
  if (own == nullptr || other == nullptr) return std::nullopt;
  BodyInMap body{around_structure(subject, map, frame, of, there.mask->geometry.bounds_mm(), 1), {}};
  const VolumeGeometry& grid = body.there.grid;
  const auto parts =
      connected_components(voxels_with(body.there.labels, there.segment.value), grid.dims, Touching::faces_and_edges);
  if (parts.sizes.size() < 2) return std::nullopt;
  std::vector<std::size_t> two(parts.sizes.size());
  std::iota(two.begin(), two.end(), 0);
  std::ranges::stable_sort(two, std::ranges::greater{}, [&](std::size_t p) { return parts.sizes[p]; });
  if (static_cast<double>(parts.sizes[two[1]]) < half_as_large * static_cast<double>(parts.sizes[two[0]]))
    return std::nullopt;
  std::array<Vec3, 2> middles{Vec3::Zero(), Vec3::Zero()};
  for (std::size_t v = 0; v < parts.part.size(); ++v)
    for (const std::size_t p : {0U, 1U})
      if (parts.part[v] == static_cast<std::int32_t>(two[p]))
        middles[p] += place_of_voxel(grid, v) / static_cast<double>(parts.sizes[two[p]]);
  const Vec3 way = middles[1] - middles[0];
  const Vec3 in_set = middle_of(own->points) - middle_of(other->points);
  const auto volume_mm3 = [](const Template& one) {
    return 1000 * std::abs(enclosed_volume_ml(Mesh{one.topology, one.points}));
  };
  const double both_mm3 = static_cast<double>(parts.sizes[two[0]] + parts.sizes[two[1]]) * grid.voxel_volume_mm3();
  const double scale = std::cbrt(both_mm3 / (volume_mm3(*own) + volume_mm3(*other)));
  const double share = way.norm() / (scale * in_set.norm()), cosine = way.dot(in_set) / (way.norm() * in_set.norm());
  if (std::abs(cosine) < same_way || share < nearer || share > farther) return std::nullopt;
  const auto its = static_cast<std::int32_t>(two[cosine > 0 ? 1 : 0]);
  body.inside.resize(parts.part.size());
  for (std::size_t v = 0; v < body.inside.size(); ++v) body.inside[v] = parts.part[v] == its ? 1 : 0;
  return body;
}

}  // namespace homolog
