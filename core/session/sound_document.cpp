#include "core/session/sound_document.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <tuple>

#include "core/base/numbers/limits.h"
#include "core/case/actions/contours.h"
#include "core/case/members.h"
#include "core/case/placing.h"

namespace homolog {

namespace {

bool is_positive(double value) {
  return value > 0 && std::isfinite(value);
}

bool is_sound(const Regions& regions, Eigen::Index vertices) {
  const std::size_t numbers = regions.of_vertex.size(), most = regions.list.size();
  return (numbers == 0 || numbers == static_cast<std::size_t>(vertices)) && most <= 255 &&
         std::all_of(regions.of_vertex.begin(), regions.of_vertex.end(), [&](auto number) { return number <= most; }) &&
         std::all_of(regions.list.begin(), regions.list.end(),
                     [](const Region& region) { return is_positive(region.factor); });
}

bool possible(int count) {
  return count >= 0;
}

bool possible(const std::string&) {
  return true;
}

bool possible(const Similarity& placement) {
  return check_placement(placement).has_value();
}

bool possible(const std::map<std::string, Vec3>& landmarks) {
  return std::all_of(landmarks.begin(), landmarks.end(),
                     [](const auto& landmark) { return all_in_reach(landmark.second); });
}

template <class Array>
bool possible(const std::shared_ptr<const Array>& values) {
  return !values || all_in_reach(*values);
}

bool is_sound(const Shape& shape) {
  const auto all = [&](const auto&... member) { return (possible(shape.*member.of) && ...); };
  return std::apply(all, shape_members) && shape.placed && shape.reference && shape.points;
}

bool is_sound(const Paint& paint) {
  return is_positive(paint.base) && paint.stiffness && paint.stiffness->allFinite() &&
         (paint.stiffness->array() > 0).all() && is_sound(*paint.regions, paint.stiffness->size());
}

bool is_sound(const ContourSet& set) {
  return !set.id.empty() && set.off_mm >= 0 && is_in_reach(set.off_mm) && check_curves(set.curves).has_value();
}

/// A structure shares vertices that it has, and that the other one has where the case has that.
bool is_sound(const SharedWith& shared, const Structure& own, const Document& document) {
  if (shared.with.empty() || shared.with == own.id) return false;
  const Structure* other = document.structure(shared.with);
  const auto has = [](const Structure* one, std::int32_t vertex) {
    return vertex >= 0 && (one == nullptr || vertex < one->the_template->topology->vertices());
  };
  return std::all_of(shared.vertices->begin(), shared.vertices->end(),
                     [&](const VertexPair& pair) { return has(&own, pair[0]) && has(other, pair[1]); });
}

bool is_sound(const LandmarkRules& rules) {
  return rules.pull >= LandmarkPull::off && rules.pull <= LandmarkPull::warp &&
         rules.rule >= LandmarkRule::closed_form && rules.rule <= LandmarkRule::by_size;
}

}  // namespace

bool is_sound(const Document& document) {
  const auto frame_exists = [&](int frame) { return frame >= 0 && frame < document.scan.frames(); };
  const auto structure_is_sound = [&](const auto& structure) {
    return structure->shape(document.frame) != nullptr && is_sound(structure->paint) &&
           is_sound(structure->landmarks) && structure->side >= Side::none && structure->side <= Side::right &&
           std::all_of(structure->shared.begin(), structure->shared.end(),
                       [&](const auto& shared) { return is_sound(shared, *structure, document); }) &&
           std::all_of(structure->contours.begin(), structure->contours.end(),
                       [&](const auto& set) { return frame_exists(set->frame) && is_sound(*set); }) &&
           std::all_of(structure->shapes.begin(), structure->shapes.end(),
                       [&](const auto& one) { return frame_exists(one.first) && is_sound(*one.second); });
  };
  return frame_exists(document.frame) && document.scheme >= Scheme::anchored && document.scheme <= Scheme::raw &&
         document.paper_events >= 1 && document.paper_events <= 1000 && document.even_spacing >= 0 &&
         document.even_spacing <= 1 && !document.structures.empty() &&
         std::all_of(document.structures.begin(), document.structures.end(), structure_is_sound);
}

}  // namespace homolog
