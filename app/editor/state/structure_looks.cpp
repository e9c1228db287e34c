#include "app/editor/state/structure_looks.h"

#include <algorithm>
#include <iterator>
#include <tuple>

#include "core/base/text/text.h"
#include "core/volume/labels/segmentation.h"

namespace homolog {

KeptLooks kept_looks(const StructureLooks& looks, const std::string& active) {
  KeptLooks kept;
  kept.active = active;
  kept.hidden.assign(looks.hidden.begin(), looks.hidden.end());
  kept.locked.assign(looks.locked.begin(), looks.locked.end());
  kept.opacity = looks.opacity;
  kept.as_read_hidden = !looks.as_read_shown;
  return kept;
}

StructureLooks looks_of_case(const KeptLooks* kept, const KeptMapFit* fit, const Document& document) {
  StructureLooks looks;
  const auto is_there = [&](const std::string& id) { return !id.empty() && document.structure(id) != nullptr; };
  if (kept != nullptr) {
    std::ranges::copy_if(kept->hidden, std::inserter(looks.hidden, looks.hidden.end()), is_there);
    std::ranges::copy_if(kept->locked, std::inserter(looks.locked, looks.locked.end()), is_there);
    for (const auto& [id, opacity] : kept->opacity)
      if (is_there(id)) looks.opacity.emplace(id, std::clamp(opacity, 0.0, 1.0));
  }
  if (fit != nullptr) take_as_read(looks, *fit);
  if (kept != nullptr) looks.as_read_shown = !kept->as_read_hidden;
  return looks;
}

void take_as_read(StructureLooks& looks, const KeptMapFit& fit) {
  looks.as_read.clear();
  looks.as_read_shown = true;
  looks.as_read_frame = fit.frame;
  for (const auto& [id, in] : fit.structures) {
    if (in.was_missing) looks.as_read[id] = nullptr;
    if (in.as_read.empty()) continue;
    const Eigen::Index vertices = std::ssize(in.as_read) / 3;
    looks.as_read[id] = std::make_shared<const Points>(Eigen::Map<const Points>(in.as_read.data(), vertices, 3));
  }
}

double name_confidence(const KeptMapFit* fit, const Structure& structure) {
  if (structure.confidence == 1 && structure.doubt.empty()) return 1;  // a person looked at it
  if (fit == nullptr) return -1;
  const auto found = fit->structures.find(structure.id);
  return found == fit->structures.end() || found->second.name != structure.name ? -1 : found->second.p_named;
}

const Points* shape_as_read(const StructureLooks& looks, const Structure& structure) {
  const auto kept = looks.as_read.find(structure.id);
  if (kept == looks.as_read.end() || !kept->second) return nullptr;
  return kept->second->rows() == structure.the_template->points.rows() ? kept->second.get() : nullptr;
}

bool is_taken_back(const StructureLooks& looks, const Structure& structure) {
  constexpr double rounding_mm = 1e-4;
  const Points* read = shape_as_read(looks, structure);
  const Shape* shape = structure.shape(looks.as_read_frame);
  return read != nullptr && shape != nullptr && (*shape->points - *read).cwiseAbs().maxCoeff() <= rounding_mm;
}

Rgb structure_colour(const Structure& structure) {
  const auto [r, g, b] = structure.colour.value_or(colour_by_name(structure_name(structure)));
  return {static_cast<float>(r) / 255, static_cast<float>(g) / 255, static_cast<float>(b) / 255};
}

bool is_doubtful(const Structure& structure) {
  constexpr double least_confidence = 0.5;
  return !structure.doubt.empty() || (structure.confidence >= 0 && structure.confidence < least_confidence);
}

bool is_to_be_seen(const StructureLooks& looks, const Structure& structure) {
  return is_doubtful(structure) && !is_taken_back(looks, structure);
}

std::string locked_sentence(const Structure& structure) {
  return "\"" + structure_name(structure) + "\" is locked. The lock in its row (Structures) opens it.";
}

std::vector<std::string> carried_structures(const StructureLooks& looks, const Document& document,
                                            const std::string& active) {
  const Structure* first = document.structure(active);
  std::vector<std::string> ids{active};
  for (const auto& structure : document.structures)
    if (structure.get() != first && !structure->shapes.empty() && !looks.locks(structure->id))
      ids.push_back(structure->id);
  return ids;
}

std::vector<const Structure*> listed_structures(const StructureLooks& looks, const Document& document) {
  std::vector<const Structure*> listed;
  const std::string wanted = lower_case(looks.filter);
  for (const auto& one : document.structures)
    if (wanted.empty() || lower_case(structure_name(*one)).find(wanted) != std::string::npos)
      listed.push_back(one.get());
  if (!looks.worst_first) return listed;
  std::map<const Structure*, std::tuple<bool, bool, double>> worth;
  for (const Structure* one : listed) {
    const bool seen = is_doubtful(*one) && is_taken_back(looks, *one);
    worth[one] = {seen || one->doubt.empty(), seen || one->confidence < 0, one->confidence};
  }
  std::ranges::stable_sort(listed, {}, [&](const Structure* one) { return worth[one]; });
  return listed;
}

void choose_rows(StructureLooks& looks, const Document& document, const std::string& id, bool ctrl, bool shift) {
  const auto listed = listed_structures(looks, document);
  const auto row_of = [&](const std::string& of) {
    const auto is_it = [&](const Structure* one) { return one->id == of; };
    return static_cast<std::size_t>(std::ranges::find_if(listed, is_it) - listed.begin());
  };
  const std::size_t from = row_of(looks.range_from), to = row_of(id);
  if (shift && std::max(from, to) < listed.size()) {
    if (!ctrl) looks.chosen.clear();
    for (std::size_t k = std::min(from, to); k <= std::max(from, to); ++k) looks.chosen.insert(listed[k]->id);
    return;
  }
  looks.range_from = id;
  if (!ctrl)
    looks.chosen = {id};
  else if (looks.chosen.erase(id) == 0)
    looks.chosen.insert(id);
}

std::vector<std::string> rows_with(const StructureLooks& looks, const std::string& id) {
  if (!looks.chosen.contains(id)) return {id};
  return {looks.chosen.begin(), looks.chosen.end()};
}

void begin_looks(StructureLooks& looks, const std::string& id) {
  for (auto* ids : {&looks.hidden, &looks.locked, &looks.chosen}) ids->erase(id);
  looks.opacity.erase(id);
}

}  // namespace homolog
