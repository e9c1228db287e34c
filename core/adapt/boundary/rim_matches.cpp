#include "core/adapt/boundary/rim_matches.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/mesh/parts/rims.h"

namespace homolog {

KnownMatches with_rims(KnownMatches known, const Mesh& mesh, RimsLie rims_lie, const Points& from,
                       SurfaceTarget& target) {
  if (!target.has_rims()) return known;
  constexpr double noise_share = 0.015;                           // of the diagonal
  const double as_sure_as = rims_lie == RimsLie::near ? 10 : 40;  // of so many places
  constexpr std::size_t most_places = 200;                        // the time goes by their number to the third power
  const std::vector<Rim> rims = long_rims(mesh);
  std::size_t vertices = 0;
  for (const Rim& rim : rims) vertices += rim.size();
  const std::size_t step = std::max<std::size_t>(1, (vertices + most_places - 1) / most_places);
  std::vector<std::int32_t> on_rim;
  for (const Rim& rim : rims)
    for (std::size_t k = 0; k < rim.size(); k += step) on_rim.push_back(rim[k]);
  if (on_rim.empty()) return known;
  const Points to = target.nearest(mesh).targets(on_rim, Eigen::all);
  const auto count = std::ssize(on_rim);
  // What they are off by along the rim they share, so that many tell no more than some.
  const double noise_mm = noise_share * bounds_of(mesh.points).diagonal().norm() *
                          std::sqrt(std::max(1.0, static_cast<double>(count) / as_sure_as));
  KnownMatches all{Points(known.from.rows() + count, 3), Points(known.from.rows() + count, 3),
                   VertexScalars(known.from.rows() + count)};
  all.from << known.from, from(on_rim, Eigen::all);
  all.to << known.to, to;
  all.noise_mm << known.noise_mm, VertexScalars::Constant(count, noise_mm);
  return all;
}

}  // namespace homolog
