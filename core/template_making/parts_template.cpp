#include "core/template_making/parts_template.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "core/mesh/repair/mesh_repair.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/template_making/label_body.h"
#include "core/template_making/voxel_components.h"

namespace homolog {

namespace {

constexpr double smallest_share = 0.01;  // share of the label's voxels
constexpr double fewest_vertices_a_part = 50;

/// The label's parts in the map's own voxels.
struct Parts {
  VoxelComponents found;
  std::vector<std::size_t> kept, crumbs;  ///< the largest first

  int label = 1;  ///< their label in the maps of one part

  Parts(const Volume& mask, const MaskTemplateOptions& options) {
    if (options.label > 0 && options.label <= std::numeric_limits<std::uint16_t>::max()) label = options.label;
    std::vector<std::uint8_t> inside(mask.geometry.voxels());
    const std::size_t first = static_cast<std::size_t>(options.frame) * inside.size();
    std::visit(
        [&](const auto& voxels) {
          for (std::size_t v = 0; v < inside.size(); ++v)
            inside[v] = has_label(voxels[first + v], options.label) ? 1 : 0;
        },
        mask.data);
    found = connected_components(inside, mask.geometry.dims, Touching::faces);
    std::vector<std::size_t> order(found.sizes.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::greater(), [&](std::size_t part) { return found.sizes[part]; });
    const auto total = static_cast<double>(std::accumulate(found.sizes.begin(), found.sizes.end(), std::size_t{0}));
    for (const std::size_t part : order) {
      const std::size_t voxels = found.sizes[part];
      const bool is_crumb = voxels < fewest_voxels_of_shape || static_cast<double>(voxels) < smallest_share * total;
      (is_crumb ? crumbs : kept).push_back(part);
    }
  }

  /// One part alone.
  Volume map_of(std::size_t part, const Volume& mask, int frame) const {
    Volume map;
    map.geometry = mask.geometry;
    map.range_max = label;
    map.empty_beyond_slices = mask.empty_beyond_slices;
    if (mask.soft) {
      const float* shares =
          std::get<std::vector<float>>(mask.data).data() + static_cast<std::size_t>(frame) * found.part.size();
      std::vector<float> own(shares, shares + found.part.size());
      for (std::size_t v = 0; v < own.size(); ++v)
        if (found.part[v] >= 0 && found.part[v] != static_cast<std::int32_t>(part)) own[v] = 0;
      map.data = std::move(own);
      map.soft = true;
      return map;
    }
    std::vector<std::uint16_t> voxels(found.part.size());
    std::ranges::transform(found.part, voxels.begin(), [&](std::int32_t of) {
      return static_cast<std::uint16_t>(of == static_cast<std::int32_t>(part) ? label : 0);
    });
    map.data = std::move(voxels);
    return map;
  }
};

/// `of_all`: how much of the surface the distance is a mean over.
void add_distance(SurfaceDistance& all, const SurfaceDistance& part, double of_all) {
  all.mean_mm += of_all * part.mean_mm;
  all.p95_mm = std::max(all.p95_mm, part.p95_mm);
  all.max_mm = std::max(all.max_mm, part.max_mm);
}

}  // namespace

Result<MaskTemplate> make_parts_template(const Volume& mask, const MaskTemplateOptions& options, Progress* progress) {
  const Parts parts(mask, options);
  if (parts.kept.size() < 2) return make_mask_template(mask, options, progress);
  std::vector<double> areas_mm2;
  for (const std::size_t part : parts.kept)
    areas_mm2.push_back(label_extent(parts.map_of(part, mask, options.frame), parts.label, 0).area_mm2);
  const double total_mm2 = std::accumulate(areas_mm2.begin(), areas_mm2.end(), 0.0);
  MaskTemplate whole;
  std::vector<Mesh> meshes;
  std::int32_t vertices = 0;  // vertices of these
  double volume = 0, missed = 0;
  for (std::size_t k = 0; k < parts.kept.size(); ++k) {
    const double share = areas_mm2[k] / total_mm2;
    if (share * options.vertices < fewest_vertices_a_part)
      return fail("", label_name(options.label) + " has " + std::to_string(parts.kept.size()) +
                          " parts, too many for " + std::to_string(options.vertices) +
                          " vertices; ask for more vertices, or leave out --parts");
    std::optional<Progress> own;
    if (progress != nullptr) own.emplace(*progress, share);
    MaskTemplateOptions making = options;
    making.label = parts.label;
    making.frame = 0;
    making.vertices = static_cast<int>(std::lround(share * options.vertices));
    auto made = make_mask_template(parts.map_of(parts.kept[k], mask, options.frame), making, own ? &*own : nullptr);
    if (!made)
      return fail("", "part " + std::to_string(k + 1) + " of " + label_name(options.label) + ": " + made.error().what);
    for (const std::int32_t vertex : made->cut) whole.cut.push_back(vertices + vertex);
    vertices += static_cast<std::int32_t>(made->mesh.points.rows());
    meshes.push_back(std::move(made->mesh));
    add_distance(whole.to_mask, made->to_mask, share);
    add_distance(whole.from_mask, made->from_mask, share);
    std::ranges::move(made->tunnels, std::back_inserter(whole.tunnels));
    std::ranges::move(made->warnings, std::back_inserter(whole.warnings));
    std::ranges::move(made->islands_ml, std::back_inserter(whole.islands_ml));
    whole.cavities += made->cavities;
    whole.cavities_ml += made->cavities_ml;
    whole.missed_ml += made->missed_ml;
    if (k == 0)
      whole.resampled_mm = made->resampled_mm, whole.closing_mm = made->closing_mm, whole.opening_mm = made->opening_mm;
    const auto voxels = static_cast<double>(parts.found.sizes[parts.kept[k]]);
    volume += voxels;
    missed += voxels * made->missed_share;
  }
  whole.mesh = joined(meshes);
  whole.missed_share = missed / volume;
  for (const std::size_t crumb : parts.crumbs)
    whole.islands_ml.push_back(static_cast<double>(parts.found.sizes[crumb]) * mask.geometry.voxel_volume_mm3() / 1000);
  return whole;
}

}  // namespace homolog
