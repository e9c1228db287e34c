#include "core/case/paint.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/mesh/curvature.h"

namespace homolog {

namespace {

constexpr std::size_t most_regions = 255;

bool usable_brush(const Vec3& at, double radius_mm, double soft) {
  return at.allFinite() && std::isfinite(radius_mm) && radius_mm > 0 && soft >= 0 && soft <= 1;
}

tl::unexpected<Error> bad_brush() {
  return fail("brush", "needs a place, a radius above 0 mm and a soft edge between 0 and 1");
}

/// A copy to paint on, each vertex in no region where there was none yet.
std::shared_ptr<Regions> regions_to_paint(const Document& document) {
  auto regions = std::make_shared<Regions>(*document.regions);
  regions->of_vertex.resize(static_cast<std::size_t>(document.stiffness->size()), 0);
  return regions;
}

/// The number of a region, from 1; 0 for the empty name: none.
Result<std::uint8_t> region_number(const Regions& regions, const std::string& name) {
  if (name.empty()) return std::uint8_t{0};
  for (std::size_t r = 0; r < regions.list.size(); ++r)
    if (regions.list[r].name == name) return static_cast<std::uint8_t>(r + 1);
  return fail("region", "\"" + excerpt(name) + "\" does not exist; add it first");
}

double factor_of(const Regions& regions, std::uint8_t number) {
  return number == 0 ? 1 : regions.list[number - 1U].factor;
}

/// The vertices reached from `seed` over edges, each of which `joins(vertex)`.
template <class Joins>
std::vector<std::int32_t> flood(const Topology& topology, std::int32_t seed, const Joins& joins) {
  std::vector<char> seen(static_cast<std::size_t>(topology.vertices()), 0);
  std::vector<std::int32_t> reached{seed};
  seen[static_cast<std::size_t>(seed)] = 1;
  for (std::size_t next = 0; next < reached.size(); ++next)
    for (const std::int32_t n : topology.one_ring(reached[next])) {
      if (seen[static_cast<std::size_t>(n)] != 0 || !joins(n)) continue;
      seen[static_cast<std::size_t>(n)] = 1;
      reached.push_back(n);
    }
  return reached;
}

}  // namespace

Result<Painted> painted(const Document& document, const PaintStiffness& action) {
  if (!usable_brush(action.at, action.radius_mm, action.soft)) return bad_brush();
  if (!(action.value > 0) || !std::isfinite(action.value)) return fail("stiffness", "must be a positive number");
  auto factors = std::make_shared<VertexScalars>(*document.stiffness);
  const double factor = action.value / document.stiffness_base;
  const int touched = brush(*document.shape().points, action.at, action.radius_mm, action.soft,
                            [&](Eigen::Index i, double b) { (*factors)[i] += b * (factor - (*factors)[i]); });
  return Painted{std::move(factors), document.regions, touched};
}

Result<Painted> painted(const Document& document, const SmoothStiffness& action) {
  if (!usable_brush(action.at, action.radius_mm, 0)) return bad_brush();
  if (!(action.strength >= 0 && action.strength <= 1)) return fail("strength", "must be between 0 and 1");
  const VertexScalars& before = *document.stiffness;
  auto factors = std::make_shared<VertexScalars>(before);
  const int touched = brush(*document.shape().points, action.at, action.radius_mm, 0.5, [&](Eigen::Index i, double b) {
    double sum = 0;
    const auto ring = document.reference->topology->one_ring(i);
    for (const std::int32_t n : ring) sum += before[n];
    (*factors)[i] += b * action.strength * (sum / static_cast<double>(ring.size()) - before[i]);
  });
  return Painted{std::move(factors), document.regions, touched};
}

Result<Painted> painted(const Document& document, const PaintRegion& action) {
  if (!usable_brush(action.at, action.radius_mm, action.soft)) return bad_brush();
  const auto number = region_number(*document.regions, action.name);
  if (!number) return fail(number.error());
  auto factors = std::make_shared<VertexScalars>(*document.stiffness);
  auto regions = regions_to_paint(document);
  const double factor = factor_of(*regions, *number);
  const int touched =
      brush(*document.shape().points, action.at, action.radius_mm, action.soft, [&](Eigen::Index i, double b) {
        (*factors)[i] += b * (factor - (*factors)[i]);
        if (b >= 0.5) regions->of_vertex[static_cast<std::size_t>(i)] = *number;
      });
  return Painted{std::move(factors), std::move(regions), touched};
}

Result<Painted> painted(const Document& document, const FillRegion& action) {
  if (!action.at.allFinite()) return bad_brush();
  const auto number = region_number(*document.regions, action.name);
  if (!number) return fail(number.error());
  const Mesh mesh = document.mesh();
  Eigen::Index seed = 0;
  (mesh.points.rowwise() - action.at.transpose()).rowwise().squaredNorm().minCoeff(&seed);
  auto factors = std::make_shared<VertexScalars>(*document.stiffness);
  auto regions = regions_to_paint(document);
  const auto region_of = [&](Eigen::Index i) { return regions->of_vertex[static_cast<std::size_t>(i)]; };
  const std::uint8_t here = region_of(seed);
  std::vector<std::int32_t> filled;
  if (action.by == FillRegion::By::region) {
    filled =
        flood(*mesh.topology, static_cast<std::int32_t>(seed), [&](std::int32_t n) { return region_of(n) == here; });
  } else {
    if (!(action.tolerance_per_mm > 0)) return fail("fill", "needs a curvature tolerance above 0 per mm");
    const VertexScalars curvature = mean_curvature(mesh);
    filled = flood(*mesh.topology, static_cast<std::int32_t>(seed), [&](std::int32_t n) {
      return region_of(n) == here && std::abs(curvature[n] - curvature[seed]) <= action.tolerance_per_mm;
    });
  }
  for (const std::int32_t i : filled) {
    (*factors)[i] = factor_of(*regions, *number);
    regions->of_vertex[static_cast<std::size_t>(i)] = *number;
  }
  return Painted{std::move(factors), std::move(regions), static_cast<int>(filled.size())};
}

Result<Painted> painted(const Document& document, const SetRegion& action) {
  const Region& region = action.region;
  if (region.name.empty() || !(region.factor > 0) || !std::isfinite(region.factor))
    return fail("region", "needs a name and a positive factor");
  auto regions = regions_to_paint(document);
  const auto number = region_number(*regions, region.name);
  if (!number) {
    if (regions->list.size() == most_regions) return fail("region", "cannot be added: a template has at most 255");
    regions->list.push_back(region);
    return Painted{document.stiffness, std::move(regions), 0};
  }
  const double change = region.factor / factor_of(*regions, *number);
  regions->list[*number - 1U] = region;
  if (change == 1) return Painted{document.stiffness, std::move(regions), 0};
  auto factors = std::make_shared<VertexScalars>(*document.stiffness);
  int touched = 0;
  for (Eigen::Index i = 0; i < factors->size(); ++i)
    if (regions->of_vertex[static_cast<std::size_t>(i)] == *number) {
      (*factors)[i] *= change;
      ++touched;
    }
  return Painted{std::move(factors), std::move(regions), touched};
}

Result<Painted> painted(const Document& document, const RenameRegion& action) {
  auto regions = regions_to_paint(document);
  const auto number = region_number(*regions, action.name);
  if (!number) return fail(number.error());
  if (*number == 0 || action.to.empty()) return fail("region", "needs a name");
  if (region_number(*regions, action.to))
    return fail("region", "\"" + excerpt(action.to) + "\" exists already; choose another name");
  regions->list[*number - 1U].name = action.to;
  return Painted{document.stiffness, std::move(regions), 0};
}

Result<Painted> painted(const Document& document, const RemoveRegion& action) {
  auto regions = regions_to_paint(document);
  const auto number = region_number(*regions, action.name);
  if (!number) return fail(number.error());
  if (*number == 0) return fail("region", "needs a name");
  regions->list.erase(regions->list.begin() + (*number - 1));
  int touched = 0;
  for (auto& of_vertex : regions->of_vertex) {
    touched += of_vertex == *number;
    if (of_vertex == *number)
      of_vertex = 0;
    else if (of_vertex > *number)
      --of_vertex;
  }
  if (regions->list.empty()) regions->of_vertex.clear();
  return Painted{document.stiffness, std::move(regions), touched};
}

Result<Painted> painted(const Document& document, const SetStiffnessFactors& action) {
  if (!action.factors || action.factors->size() != document.stiffness->size())
    return fail("stiffness", "needs one factor for each of the " + std::to_string(document.stiffness->size()) +
                                 " vertices; take an array of a mesh with the same vertices");
  if (!action.factors->allFinite() || !(action.factors->minCoeff() > 0))
    return fail("stiffness", "needs positive factors; rescale the array");
  return Painted{action.factors, document.regions, static_cast<int>(action.factors->size())};
}

}  // namespace homolog
