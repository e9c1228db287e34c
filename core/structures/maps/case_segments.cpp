#include "core/structures/maps/case_segments.h"

#include <algorithm>
#include <set>

#include "core/base/files/file_stem.h"
#include "core/base/text/text.h"
#include "core/catalogue/catalogue.h"

namespace homolog {

std::string structure_name(const Structure& structure) {
  if (!structure.name.empty()) return structure.name;
  const std::string& source = structure.the_template->source;
  if (is_built_in(source)) return source.substr(source.find(':') + 1);
  return source.empty() ? structure.id : file_stem(source);
}

std::vector<MeshOfSegment> segments_of(const Document& document, SegmentValues values) {
  const bool layered = std::ranges::any_of(values, [](const auto& one) { return one.first.first > 0; });
  const auto known_value = [&](const Structure& one) {
    const std::size_t layer = layered ? static_cast<std::size_t>(one.layer) : 0;
    return values.find({layer, lower_case(structure_name(one))});
  };
  std::set<int> taken;
  for (const auto& one : document.structures)
    if (const auto known = known_value(*one); known != values.end()) taken.insert(known->second);
  std::vector<MeshOfSegment> meshes;
  for (const auto& one : document.structures) {
    const Shape* shape = one->shape(document.frame);
    if (shape == nullptr) continue;
    Segment segment;
    segment.name = structure_name(*one);
    segment.layer = static_cast<std::size_t>(one->layer);
    segment.colour = one->colour.value_or(colour_by_name(segment.name));
    if (const auto known = known_value(*one); known != values.end()) {
      segment.value = known->second;
      values.erase(known);
    } else {
      for (segment.value = 1; taken.contains(segment.value);) ++segment.value;
      taken.insert(segment.value);
    }
    meshes.push_back({std::move(segment), {one->the_template->topology, *shape->points}});
  }
  return meshes;
}

}  // namespace homolog
