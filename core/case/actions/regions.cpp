#include "core/case/actions/regions.h"

#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/base/pictures/colour.h"
#include "core/case/actions/brush.h"
#include "core/case/actions/fields.h"
#include "core/mesh/geometry/curvature.h"
#include "core/mesh/parts/patches.h"

namespace homolog {

namespace {

constexpr std::size_t most_regions = 255;

constexpr Names<FillRegion::By, 2> fill_names{
    {{"region", FillRegion::By::region}, {"curvature", FillRegion::By::curvature}}};

/// A copy to paint on, each vertex in no region where there was none yet.
std::shared_ptr<Regions> regions_to_paint(const Paint& paint) {
  auto regions = std::make_shared<Regions>(*paint.regions);
  regions->of_vertex.resize(static_cast<std::size_t>(paint.stiffness->size()), 0);
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

void spell_painting(Fields& line, PaintRegion& action) {
  Fields dab = line.object("paint_region");
  dab.member("name", action.name);
  dab.member("at", action.at);
  dab.member("radius_mm", action.radius_mm);
  dab.optional("soft", action.soft);
}

Result<EditReport> apply_painting(const PaintRegion& action, StructureEdit& edit) {
  if (auto usable = check_brush(action.at, action.radius_mm, action.soft); !usable) return fail(usable.error());
  const auto number = region_number(*edit.before.paint.regions, action.name);
  if (!number) return fail(number.error());
  auto factors = std::make_shared<VertexScalars>(*edit.before.paint.stiffness);
  auto regions = regions_to_paint(edit.before.paint);
  const double factor = factor_of(*regions, *number);
  const int touched =
      brush(*edit.shape().points, action.at, action.radius_mm, action.soft, [&](Eigen::Index i, double b) {
        (*factors)[i] += b * (factor - (*factors)[i]);
        if (b >= 0.5) regions->of_vertex[i] = *number;
      });
  edit.after.paint.stiffness = std::move(factors);
  edit.after.paint.regions = std::move(regions);
  return painted(touched);
}

void spell_filling(Fields& line, FillRegion& action) {
  Fields fill = line.object("fill_region");
  fill.member("name", action.name);
  fill.member("at", action.at);
  fill.member("by", fill_names, action.by);
  fill.optional("tolerance_per_mm", action.tolerance_per_mm, action.by == FillRegion::By::curvature);
}

Result<EditReport> apply_filling(const FillRegion& action, StructureEdit& edit) {
  if (auto usable = check_brush(action.at, 1, 0); !usable) return fail(usable.error());
  const auto number = region_number(*edit.before.paint.regions, action.name);
  if (!number) return fail(number.error());
  const Mesh mesh{edit.before.the_template->topology, *edit.shape().points};
  Eigen::Index seed = 0;
  (mesh.points.rowwise() - action.at.transpose()).rowwise().squaredNorm().minCoeff(&seed);
  auto factors = std::make_shared<VertexScalars>(*edit.before.paint.stiffness);
  auto regions = regions_to_paint(edit.before.paint);
  const auto region_of = [&](Eigen::Index i) { return regions->of_vertex[i]; };
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
    regions->of_vertex[i] = *number;
  }
  edit.after.paint.stiffness = std::move(factors);
  edit.after.paint.regions = std::move(regions);
  return painted(std::ssize(filled));
}

void spell_region(Fields& line, SetRegion& action) {
  Fields region = line.object("region");
  std::string colour = hex_of(action.region.colour);
  region.member("name", action.region.name);
  region.member("factor", action.region.factor);
  region.member("colour", colour);
  const auto read = colour_from_hex(colour);
  if (!read) throw Unreadable{"\"colour\" is not \"#rrggbb\""};
  action.region.colour = *read;
}

Result<EditReport> apply_region(const SetRegion& action, StructureEdit& edit) {
  const Region& region = action.region;
  if (region.name.empty() || !(region.factor > 0) || !std::isfinite(region.factor))
    return fail("region", "needs a name and a positive factor");
  auto regions = regions_to_paint(edit.before.paint);
  const auto number = region_number(*regions, region.name);
  if (!number) {
    if (regions->list.size() == most_regions) return fail("region", "cannot be added: a template has at most 255");
    regions->list.push_back(region);
    edit.after.paint.regions = std::move(regions);
    return EditReport{};
  }
  const double change = region.factor / factor_of(*regions, *number);
  regions->list[*number - 1U] = region;
  int touched = 0;
  if (change != 1) {
    auto factors = std::make_shared<VertexScalars>(*edit.before.paint.stiffness);
    for (Eigen::Index i = 0; i < factors->size(); ++i)
      if (regions->of_vertex[i] == *number) {
        (*factors)[i] *= change;
        ++touched;
      }
    edit.after.paint.stiffness = std::move(factors);
  }
  edit.after.paint.regions = std::move(regions);
  return painted(touched);
}

void spell_renaming(Fields& line, RenameRegion& action) {
  Fields rename = line.object("rename_region");
  rename.member("name", action.name);
  rename.member("to", action.to);
}

Result<EditReport> apply_renaming(const RenameRegion& action, StructureEdit& edit) {
  auto regions = regions_to_paint(edit.before.paint);
  const auto number = region_number(*regions, action.name);
  if (!number) return fail(number.error());
  if (*number == 0 || action.to.empty()) return fail("region", "needs a name");
  if (region_number(*regions, action.to))
    return fail("region", "\"" + excerpt(action.to) + "\" exists already; choose another name");
  regions->list[*number - 1U].name = action.to;
  edit.after.paint.regions = std::move(regions);
  return EditReport{};
}

Result<EditReport> apply_removal(const RemoveRegion& action, StructureEdit& edit) {
  auto regions = regions_to_paint(edit.before.paint);
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
  edit.after.paint.regions = std::move(regions);
  return painted(touched);
}

}  // namespace

const ActionKind<PaintRegion>& action_kind(const PaintRegion&) {
  static constexpr ActionKind<PaintRegion> kind{
      .key = "paint_region",
      .example = R"({"paint_region":{"name":"hilum","at":[-21,20,-9],"radius_mm":10,"soft":0.5}})",
      .meaning = "brings vertices into a region; the empty name takes them out",
      .name = [](const PaintRegion& action) -> std::string {
        return action.name.empty() ? "painting away" : "painting of " + action.name;
      },
      .spell = spell_painting,
      .apply = apply_painting};
  return kind;
}

const ActionKind<FillRegion>& action_kind(const FillRegion&) {
  static constexpr ActionKind<FillRegion> kind{
      .key = "fill_region",
      .example = R"({"fill_region":{"name":"hilum","at":[-21,20,-9],"by":"region"}})",
      .meaning =
          "fills what is connected; `\"by\":\"curvature\"` with `\"tolerance_per_mm\"` only where the surface "
          "bends alike",
      .name = [](const FillRegion& action) -> std::string {
        return action.name.empty() ? "emptying" : "filling of " + action.name;
      },
      .spell = spell_filling,
      .apply = apply_filling};
  return kind;
}

const ActionKind<SetRegion>& action_kind(const SetRegion&) {
  static constexpr ActionKind<SetRegion> kind{
      .key = "region",
      .example = R"({"region":{"name":"hilum","factor":1,"colour":"#60a5d6"}})",
      .meaning = "adds a region, or changes its factor and colour",
      .name = [](const SetRegion& action) { return "region " + action.region.name; },
      .spell = spell_region,
      .apply = apply_region};
  return kind;
}

const ActionKind<RenameRegion>& action_kind(const RenameRegion&) {
  static constexpr ActionKind<RenameRegion> kind{
      .key = "rename_region",
      .example = R"({"rename_region":{"name":"hilum","to":"sinus"}})",
      .meaning = "gives a region another name",
      .name = [](const RenameRegion& action) { return "renaming to " + action.to; },
      .spell = spell_renaming,
      .apply = apply_renaming};
  return kind;
}

const ActionKind<RemoveRegion>& action_kind(const RemoveRegion&) {
  static constexpr ActionKind<RemoveRegion> kind{
      .key = "remove_region",
      .example = R"({"remove_region":"hilum"})",
      .meaning = "forgets a region; its vertices keep their stiffness",
      .name = [](const RemoveRegion& action) { return "removal of " + action.name; },
      .spell = [](Fields& line, RemoveRegion& action) { line.member("remove_region", action.name); },
      .apply = apply_removal};
  return kind;
}

}  // namespace homolog
