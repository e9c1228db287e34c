#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/mesh/topology.h"

namespace homolog {

/// A boundary loop, as vertices in turn [Topology::rims].
using Rim = std::vector<std::int32_t>;

/// A rim longer than this share of the diagonal of a surface's bounding box is where the surface ends. A shorter one is
/// a hole in it. A femur cut through its shaft comes to 0.2.
inline constexpr double least_rim_share = 0.1;

/// The length around a rim, mm.
double rim_length_mm(const Rim& rim, const Points& points);

/// The rims longer than `share` of the mesh's diagonal.
std::vector<Rim> long_rims(const Mesh& mesh, double share = least_rim_share);

/// A place on a rim: between two of its neighbouring vertices, `share` of the way from the first to the second.
struct RimPlace {
  std::array<std::int32_t, 2> between{};
  double share = 0;
  Vec3 position = Vec3::Zero();
};

/// The place of the rims that is nearest to `p`, all in mm. `rims`: at least one.
RimPlace nearest_on_rims(const std::vector<Rim>& rims, const Points& points, const Vec3& p);

/// The lengths of a rim's edges, each from a vertex to the next, mm.
std::vector<double> rim_edges_mm(const Rim& rim, const Points& points);

/// Returns a place on the rim `onto` of another surface for each vertex of a rim, in order along it: about where it is
/// nearest, and spread as the edges `rest_mm` are [rim_edges_mm], since the nearest places alone leave out what lies in
/// a bay. If a way around the one does not lead around the other, they are the nearest places. All LPS mm.
std::vector<Vec3> spread_on_rim(const Rim& rim, const Points& points, const std::vector<double>& rest_mm,
                                const Rim& onto, const Points& there);

/// Returns what is to be said of an open mesh where something needs its inside: "is open, so its rim was closed flat to
/// have an inside"; empty for a closed one.
std::string closed_flat(const Topology& topology);

/// How far the rims of two surfaces lie apart, mm: mean over both lengths together, and the larger of the two
/// directions' 95th percentiles.
struct RimDistance {
  double mean_mm = 0, p95_mm = 0;
};

/// Returns how far the rims longer than least_rim_share of two meshes lie apart; 0 where one has none. LPS mm.
RimDistance rim_distance(const Mesh& a, const Mesh& b);

}  // namespace homolog
