#include "core/template_making/label_surface.h"

#include <algorithm>

#include "core/mesh/voxels/isosurface.h"
#include "core/template_making/label_body.h"
#include "core/template_making/level_set.h"

namespace homolog {
namespace {

bool holds_nothing(const LevelSet& surface) {
  return std::none_of(surface.values().begin(), surface.values().end(), [](float value) { return value < 0; });
}

}  // namespace

Result<Mesh> label_surface(const Volume& labels, int label, int frame, Progress* progress) {
  const auto goes_on = [&](double fraction) {
    if (progress != nullptr) progress->report(fraction);
    return progress == nullptr || !progress->cancelled();
  };
  const auto cancelled = [] { return fail("", "the surface of the label was cancelled"); };
  const LabelExtent extent = label_extent(labels, label, frame);
  if (extent.area_mm2 <= 0) return fail("", label_name(label) + " does not occur in the label map; name one that does");
  if (!goes_on(0.2)) return cancelled();
  constexpr double voxel_share = 1.0 / 120;  // share of the organ's size: about 20,000 vertices
  const double smallest_mm = labels.geometry.spacing_mm.minCoeff();
  const double margin_mm = 2 * std::max(smallest_mm, voxel_share * organ_size_mm(extent));
  const double spacing_mm = worked_spacing_mm(labels, extent, 3 * voxel_share * organ_size_mm(extent), margin_mm);
  auto region = whole_label(labels, label, frame, extent, spacing_mm, margin_mm);
  if (!region) return fail(region.error());
  if (!goes_on(0.4)) return cancelled();
  const LevelSet distance = signed_distance(*region);
  if (!goes_on(0.6)) return cancelled();
  const LevelSet fine = resampled(distance, spacing_mm);
  if (!goes_on(0.7)) return cancelled();
  // Half a voxel takes the steps away and leaves walls of one voxel.
  const LevelSet smooth = smoothed(fine, 0.5 * std::max(spacing_mm, smallest_mm));
  if (!goes_on(0.9)) return cancelled();
  return surface_of(holds_nothing(smooth) ? fine : smooth);
}

}  // namespace homolog
