#include "core/adapt/boundary/boundary.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <vector>

#include "core/adapt/boundary/label_parts.h"
#include "core/base/demand.h"
#include "core/base/text/text.h"
#include "core/measure/compare.h"
#include "core/mesh/check_mesh.h"
#include "core/mesh/construction/remesh.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/parts/rims.h"
#include "core/mesh/repair/mesh_faults.h"
#include "core/mesh/repair/mesh_repair.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/template_making/label_body.h"
#include "core/template_making/level_set.h"
#include "core/template_making/solid_voxels.h"
#include "core/template_making/voxel_components.h"
#include "core/volume/check_volume.h"

namespace homolog {

namespace {

/// The borders at which the label's largest part lies at the first or last plane of the label map in an axis.
std::vector<ScanBorder> borders_of(const LabelBody& region, const VolumeGeometry& whole) {
  std::vector<ScanBorder> borders;
  for (const MapSide& side : sides_that_cut(region, whole))
    borders.push_back(
        {side.outward, side.offset_mm, std::max(whole.spacing_mm[side.axis], region.grid.spacing_mm[side.axis])});
  return borders;
}

/// closed_by of what a ball of `radius_mm` reaches from without: a pocket behind a narrower neck is filled too, even
/// where a ball would fit into it.
LevelSet closed_from_outside(const LevelSet& surface, double radius_mm) {
  if (radius_mm <= 0) return surface;
  std::vector<float> values = surface.values();
  std::vector<std::uint8_t> centres(values.size());
  std::transform(values.begin(), values.end(), centres.begin(),
                 [radius_mm](float value) { return static_cast<std::uint8_t>(value >= radius_mm); });
  const auto parts = connected_components(centres, surface.grid().dims, Touching::faces_and_edges).part;
  for (std::size_t v = 0; v < values.size(); ++v)
    if (parts[v] > 0) values[v] = 0;  // part 0 holds the grid's first corner
  return closed_by({surface.grid(), std::move(values)}, radius_mm);
}

/// Closes what is a hole where `rims` of the boundary loops, the longest, are where the surface ends. Returns how many.
std::size_t close_holes(Mesh& surface, std::size_t rims) {
  std::vector<double> lengths_mm;
  for (const Rim& rim : surface.topology->rims()) lengths_mm.push_back(rim_length_mm(rim, surface.points));
  if (lengths_mm.size() <= rims) return 0;
  std::ranges::sort(lengths_mm, std::greater());
  constexpr double hole_share = 2.0 / 3;  // share of the shortest rim: a ventricle's outflow comes to 0.58 of its base
  double longest_mm = hole_share * lengths_mm[rims - 1];
  // What template_of_mesh closes is a hole here too where the rims are of those that it keeps.
  const double small_mm = small_rim_share * bounds_of(surface.points).diagonal().norm();
  if (lengths_mm[rims - 1] > small_mm && lengths_mm[rims] <= small_mm) longest_mm = std::max(longest_mm, small_mm);
  surface = capped(surface, longest_mm);
  return lengths_mm.size() - surface.topology->rims().size();
}

/// Takes the part that is asked for of a label's boundary, which is whole.
void take_faced_part(Boundary& boundary, const Volume& mask, int label, int frame, const LabelParts& parts) {
  const auto take_whole = [&](const std::string& why) {
    boundary.why_whole = why + ", and its whole surface was taken";
    boundary.warnings.push_back(boundary.why_whole);
  };
  auto part = faced_part(boundary.surface, mask, label, frame, *parts.faced);
  if (!part) return take_whole(part.error().what.substr(0, part.error().what.find(';')));
  std::optional<std::string> left_out;
  if (!parts.all) left_out = take_largest_piece(*part, label);
  if (parts.rims > 0) close_holes(*part, parts.rims);
  if (const auto rims = long_rims(*part).size(); parts.rims > 0 && !parts.all && rims != parts.rims)
    return take_whole(label_name(label) + " ends at the labels that are named with " + std::to_string(rims) +
                      (rims == 1 ? " rim" : " rims") + ", where the template has " + std::to_string(parts.rims));
  boundary.surface = std::move(*part);
  if (left_out) boundary.warnings.push_back(std::move(*left_out));
}

}  // namespace

bool Boundary::shows(const Vec3& p) const {
  return std::none_of(scan_borders.begin(), scan_borders.end(), [&](const ScanBorder& border) {
    return border.outward.dot(p) > border.offset_mm - border.tolerance_mm;
  });
}

Result<Boundary> label_boundary(const Volume& mask, int label, int frame, std::optional<double> asked_closing_mm,
                                Eigen::Index vertices, const LabelParts& parts) {
  if (auto sound = check_frame_of(mask, frame); !sound) return fail(sound.error());
  if (asked_closing_mm && !(*asked_closing_mm >= 0 && std::isfinite(*asked_closing_mm)))
    return fail("", "cannot be closed by a ball of such a radius; give a number that is not negative, or leave it out");
  if (vertices < 4) return fail("", "cannot be shown by fewer than four vertices; use another template");
  const LabelExtent extent = label_extent(mask, label, frame);
  const double closing_mm = asked_closing_mm.value_or(ball_share * organ_size_mm(extent));
  const double edge_mm = spread_edge_mm(extent.area_mm2, vertices), margin_mm = closing_mm + edge_mm;
  const double spacing_mm = worked_spacing_mm(mask, extent, edge_mm, margin_mm);
  const auto cut_out = label_parts(mask, label, frame, extent, spacing_mm, margin_mm, parts);
  if (!cut_out) return fail(cut_out.error());
  const LabelBody* const region = &cut_out->region;

  LevelSet surface = resampled(signed_distance(*region), spacing_mm);
  surface = closed_from_outside(surface, closing_mm);
  if (!parts.all) make_one_body(surface);
  auto mesh = surface_of(surface);
  if (!mesh)
    return fail("", label_name(label) + " is too small for " + std::to_string(vertices) +
                        " vertices; use a template with fewer vertices, or another label");
  Boundary boundary;
  boundary.surface = std::move(*mesh);
  boundary.scan_borders = borders_of(*region, mask.geometry);
  if (!boundary.scan_borders.empty())
    boundary.warnings.push_back(
        label_name(label) +
        " is cut off by the border of the label map; the mesh beyond the border follows the template");
  boundary.parts_left_out = cut_out->left_out.count;
  boundary.share_left_out = cut_out->left_out.share;
  boundary.parts_alike = cut_out->left_out.alike;
  if (auto said = cut_out->left_out.warning(label, "one", "")) boundary.warnings.push_back(std::move(*said));
  if (parts.faced) take_faced_part(boundary, mask, label, frame, parts);
  return boundary;
}

Result<void> check_boundary(const Boundary& boundary) {
  const Mesh& surface = boundary.surface;
  if (!surface.topology || surface.points.rows() == 0)
    return fail("", "gives no surface to fit to; give a boundary that has one");
  if (auto sound = check_mesh(surface, "the surface to fit to"); !sound) return sound;
  if (!boundary.cut.empty() && std::ssize(boundary.cut) != surface.topology->triangles().rows())
    return fail("", "marks cuts of other faces than its surface has; give one mark a face, or none");
  const auto is_finite = [](const ScanBorder& border) {
    return border.outward.allFinite() && std::isfinite(border.offset_mm) && std::isfinite(border.tolerance_mm);
  };
  if (!std::ranges::all_of(boundary.scan_borders, is_finite))
    return fail("", "has a border of the scan that is no plane; correct it or leave it out");
  return {};
}

LabelParts parts_for(const Topology& the_template) {
  return {.all = the_template.closed() && the_template.components() > 1};
}

Result<FacedLabels> faced_labels(const FacedNames& names, const Segmentation& known) {
  const auto no_labels = [&] {
    return fail("", "cannot be asked for \"" + excerpt(names.labels) +
                        "\"; name labels by numbers above 0, names or background, with commas between them");
  };
  std::vector<std::string> each = csv_fields(names.labels);
  for (std::string& name : each) name = trimmed(name);
  FacedLabels faced{{}, names.kept};
  const auto is_background = [](const std::string& name) { return name == "background" || name == "0"; };
  if (std::ranges::any_of(each, is_background)) {
    faced.values.push_back(0);
    std::erase_if(each, is_background);
    if (each.empty()) return faced;
  }
  if (std::ranges::any_of(each, [](const std::string& name) { return name.empty(); })) return no_labels();
  std::string rest;
  for (const std::string& name : each) rest += (rest.empty() ? "" : ",") + name;
  if (faced.values.empty()) rest = names.labels;  // a name may hold a comma
  if (is_bad_label(rest)) return no_labels();
  auto segments = asked_segments(rest, known);
  if (!segments) return fail(segments.error());
  for (const Segment& segment : *segments) faced.values.push_back(segment.value);
  return faced;
}

LabelParts parts_for(const Template& the_template, const Segmentation& known, std::vector<std::string>& warnings) {
  LabelParts parts = parts_for(*the_template.topology);
  if (!the_template.faced) return parts;
  auto faced = faced_labels(*the_template.faced, known);
  if (faced) {
    parts.faced = std::move(*faced);
    parts.rims = long_rims({the_template.topology, the_template.points}).size();
  } else {
    const std::string& what = faced.error().what;
    warnings.push_back("the template ends at its neighbours, and the map " + what.substr(0, what.find(';')) +
                       "; the label's whole surface was taken");
  }
  return parts;
}

Boundary mesh_boundary(const Mesh& mesh, bool all_parts) {
  demand(check_mesh(mesh, "the surface to fit to"));
  Boundary boundary;
  if (all_parts) {
    boundary.surface = mesh;
    return boundary;
  }
  boundary.surface = largest_part(mesh);
  if (const auto parts = mesh.topology->components(); parts > 1)
    boundary.warnings.push_back("has " + std::to_string(parts) + " parts; the largest was taken");
  return boundary;
}

Result<Boundary> surface_boundary(const MeshFile& surface, Eigen::Index vertices, Progress* progress, bool all_parts,
                                  std::size_t rims) {
  auto repair = mended_if_broken(surface, rims > 0 ? least_rim_share : small_rim_share);
  if (!repair) return fail(repair.error());
  MeshFaults faults;
  faults.tunnels = repair->mesh.topology->genus();
  Boundary boundary;
  if (faults.riddled()) {
    const Mesh together = neighbouring_parts(repair->mesh).front();
    const SolidVoxels solid =
        solid_voxels(together, solid_detail(largest_part(together), static_cast<int>(vertices)), progress);
    if (progress != nullptr && progress->cancelled()) return fail("", "reading the surface was cancelled");
    auto rebuilt = label_boundary(solid.label_map, 1, 0, std::nullopt, vertices, {.all = all_parts});
    if (!rebuilt) return fail(rebuilt.error());
    boundary = std::move(*rebuilt);
    char mm[32];
    std::snprintf(mm, sizeof mm, "%.3g mm", mean_surface_distance_mm(boundary.surface, together));
    boundary.warnings = {"has " + std::to_string(faults.tunnels) +
                         " tunnels, so it was rebuilt from voxels for the fit, which lies " + mm +
                         " from it on average; mend it by repair-mesh --genus to see what is fitted to"};
  } else {
    boundary = mesh_boundary(repair->mesh, all_parts);
    if (rims > 0 && !all_parts) repair->mended.holes += close_holes(boundary.surface, rims);
  }
  if (repair->mended.any())
    boundary.warnings.insert(boundary.warnings.begin(), "was mended: " + repair->mended.words());
  return boundary;
}

}  // namespace homolog
