#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/text/text.h"
#include "core/measure/recipe/step_kinds.h"

namespace homolog {

namespace {

/// Those of a part's vertices that `keep` takes.
template <class Keep>
Result<StepValue> filtered(Result<PartValue> part, const Keep& keep) {
  if (!part) return fail(part.error());
  std::erase_if(part->vertices, [&](std::int32_t v) { return !keep(v); });
  return *part;
}

Result<StepValue> whole(Measuring& measuring, const RecipeStep& step) {
  const auto part = measuring.part(step, "of");
  if (!part) return fail(part.error());
  return *part;
}

Result<StepValue> painted_region(Measuring& measuring, const RecipeStep& step) {
  const auto there = measuring.structure(step);
  if (!there) return fail(there.error());
  const Regions& regions = measuring.surface(*there).structure().regions;
  const std::string name = measuring.has(step, "region") ? measuring.given(step, "region").texts.front() : step.name;
  PartValue part{*there, vertices_in(regions, name)};
  if (part.vertices.empty()) return lacks("has no region \"" + excerpt(name) + '"');
  return part;
}

Result<StepValue> listed_vertices(Measuring& measuring, const RecipeStep& step) {
  const auto there = measuring.structure(step);
  if (!there) return fail(there.error());
  const Eigen::Index count = measuring.surface(*there).mesh().points.rows();
  PartValue part{*there, {}};
  for (const double number : measuring.given(step, "vertices").numbers) {
    if (!(number < static_cast<double>(count)))
      return lacks("has " + std::to_string(count) + " vertices and none of number " +
                   std::to_string(static_cast<long long>(number)));
    part.vertices.push_back(static_cast<std::int32_t>(number));
  }
  std::ranges::sort(part.vertices);
  part.vertices.erase(std::unique(part.vertices.begin(), part.vertices.end()), part.vertices.end());
  return part;
}

Result<StepValue> near_point(Measuring& measuring, const RecipeStep& step) {
  auto part = measuring.part(step, "of");
  if (!part) return fail(part.error());
  const Vec3 point = measuring.point(step, "point");
  const double within_mm = measuring.number(step, "within_mm");
  const Points& points = measuring.surface(part->structure).mesh().points;
  return filtered(std::move(part),
                  [&](std::int32_t v) { return (points.row(v).transpose() - point).norm() <= within_mm; });
}

/// Between two planes across an axis.
Result<StepValue> slab(Measuring& measuring, const RecipeStep& step) {
  auto part = measuring.part(step, "of");
  if (!part) return fail(part.error());
  const Vec3 at = measuring.point(step, "at");
  const LineValue along = measuring.axis(step, "along");
  if (!along.directed) return fail("", "goes along an axis without a direction; give that \"towards\"");
  const double from_mm = measuring.number(step, "from_mm"), to_mm = measuring.number(step, "to_mm");
  const Points& points = measuring.surface(part->structure).mesh().points;
  return filtered(std::move(part), [&](std::int32_t v) {
    const double height_mm = (points.row(v).transpose() - at).dot(along.direction);
    return height_mm >= from_mm && height_mm <= to_mm;
  });
}

Result<StepValue> facing(Measuring& measuring, const RecipeStep& step) {
  auto part = measuring.part(step, "of");
  if (!part) return fail(part.error());
  if (auto sound = measuring.check_faces(part->structure); !sound) return fail(sound.error());
  const LineValue along = measuring.axis(step, "along");
  if (!along.directed) return fail("", "goes along an axis without a direction; give that \"towards\"");
  const double least = std::cos(measuring.number(step, "within_deg") * std::numbers::pi / 180);
  const Points& normals = measuring.surface(part->structure).normals();
  return filtered(std::move(part), [&](std::int32_t v) { return normals.row(v).dot(along.direction) >= least; });
}

Result<StepValue> rim(Measuring& measuring, const RecipeStep& step) {
  const auto there = measuring.faces(step);
  if (!there) return fail(there.error());
  const Topology& topology = *measuring.surface(*there).mesh().topology;
  if (topology.closed()) return lacks("is closed and has no rim");
  return filtered(measuring.part(step, "of"), [&](std::int32_t v) { return topology.on_rim(v); });
}

Result<StepValue> sheet(Measuring& measuring, const RecipeStep& step) {
  const auto there = measuring.faces(step);
  if (!there) return fail(there.error());
  const Topology& topology = *measuring.surface(*there).mesh().topology;
  const auto number = static_cast<std::int64_t>(measuring.number(step, "sheet"));
  if (number < 1 || number > topology.components())
    return lacks("has " + std::to_string(topology.components()) + (topology.components() == 1 ? " sheet" : " sheets") +
                 " and none of number " + std::to_string(number));
  return filtered(measuring.part(step, "of"), [&](std::int32_t v) { return topology.component()[v] == number - 1; });
}

Result<StepValue> joined(Measuring& measuring, const RecipeStep& step) {
  PartValue all = measuring.as<PartValue>(step, "of");
  for (std::size_t k = 1; k < measuring.given(step, "of").steps.size(); ++k) {
    const auto& more = measuring.as<PartValue>(step, "of", k);
    if (more.structure != all.structure) return fail("", "joins parts of two structures");
    all.vertices.insert(all.vertices.end(), more.vertices.begin(), more.vertices.end());
  }
  std::ranges::sort(all.vertices);
  all.vertices.erase(std::unique(all.vertices.begin(), all.vertices.end()), all.vertices.end());
  return all;
}

}  // namespace

const std::vector<StepKind>& part_kinds() {
  constexpr unsigned point = bits(Gives::point), part = bits(Gives::part);
  const StepMember of_part{"of", Takes::steps, part, 0}, along{"along", Takes::steps, any_axis};
  static const std::vector<StepKind> kinds{
      {"whole", Gives::part, "", Draws::nothing, {}, whole},
      {"region", Gives::part, "", Draws::nothing, {{"region", Takes::text, 0, 0}}, painted_region},
      {"vertices", Gives::part, "", Draws::nothing, {{"vertices", Takes::whole_numbers, 0, 1, many}}, listed_vertices},
      {"near",
       Gives::part,
       "",
       Draws::nothing,
       {{"point", Takes::steps, point}, {"within_mm", Takes::length}, of_part},
       near_point},
      {"slab",
       Gives::part,
       "",
       Draws::nothing,
       {{"at", Takes::steps, point}, along, {"from_mm", Takes::length}, {"to_mm", Takes::length}, of_part},
       slab},
      {"facing", Gives::part, "", Draws::nothing, {along, {"within_deg", Takes::number}, of_part}, facing},
      {"rim", Gives::part, "", Draws::nothing, {of_part}, rim},
      {"sheet", Gives::part, "", Draws::nothing, {{"sheet", Takes::whole_numbers}, of_part}, sheet},
      {"joined", Gives::part, "", Draws::nothing, {{"of", Takes::steps, part, 2, many}}, joined},
  };
  return kinds;
}

}  // namespace homolog
