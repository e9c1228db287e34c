#include "core/structures/fitting/shared_in_case.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/structures/fitting/share_vertices.h"

namespace homolog {

namespace {

/// Calls `visit(structure, shared)` for all that structures of the case share.
void for_each_shared(const Document& document, const auto& visit) {
  for (const auto& one : document.structures)
    for (const SharedWith& shared : one->shared) visit(*one, shared);
}

std::vector<SharedVertices> all_shared(const Document& document) {
  std::vector<SharedVertices> all;
  for_each_shared(document, [&](const Structure& one, const SharedWith& shared) {
    all.push_back({one.id, shared.with, *shared.vertices});
  });
  return all;
}

bool is_in(const std::vector<std::string>& ids, const std::string& id) {
  return std::ranges::find(ids, id) != ids.end();
}

}  // namespace

std::vector<std::string> sharing_structures(const Document& document, std::string_view of) {
  const Structure* own = document.structure(of);
  if (own == nullptr) return {};
  std::vector<std::string> found{own->id};
  const auto add = [&](const std::string& id, const std::string& because_of) {
    if (is_in(found, because_of) && !is_in(found, id)) found.push_back(id);
  };
  for (std::size_t before = 0; before != found.size();) {
    before = found.size();
    for_each_shared(document, [&](const Structure& one, const SharedWith& shared) {
      add(shared.with, one.id);
      add(one.id, shared.with);
    });
  }
  std::vector<std::string> others;
  for (const auto& one : document.structures)
    if (one.get() != own && is_in(found, one->id)) others.push_back(one->id);
  return others;
}

VertexScalars shared_vertices_of(const Document& document, std::string_view of) {
  const Structure* own = document.structure(of);
  VertexScalars shared_ones;
  if (own == nullptr) return shared_ones;
  for_each_shared(document, [&](const Structure& one, const SharedWith& shared) {
    if (&one != own && shared.with != own->id) return;
    if (shared_ones.size() == 0) shared_ones.setZero(own->the_template->topology->vertices());
    for (const VertexPair& pair : *shared.vertices) shared_ones[&one == own ? pair[0] : pair[1]] = 1;
  });
  return shared_ones;
}

std::optional<SetPoints> edit_to_shared(const Document& document, const std::string& of, const SharedLead& lead) {
  const auto own = document.view(of);
  const auto leading = document.view(lead.leader);
  if (!own || !leading || is_in(lead.held, own->structure.id)) return std::nullopt;
  std::vector<std::string> ids = sharing_structures(document, leading->structure.id);
  if (ids.empty()) return std::nullopt;
  ids.push_back(leading->structure.id);
  std::erase_if(ids, [&](const std::string& id) { return !document.view(id); });  // without a mesh at this frame
  const auto at = static_cast<std::size_t>(std::ranges::find(ids, own->structure.id) - ids.begin());
  if (at == ids.size()) return std::nullopt;
  std::vector<Mesh> meshes;
  std::vector<std::size_t> leaders;
  for (const std::string& id : ids) {
    if (is_in(lead.held, id)) leaders.push_back(meshes.size());
    meshes.push_back(document.view(id)->mesh());
  }
  if (!is_in(lead.held, ids.back())) leaders.push_back(meshes.size() - 1);
  follow_shared(all_shared(document), ids, meshes, leaders);
  SetPoints edit = points_edit(*own, meshes[at].points, FoundBy::shared);
  if (*edit.points == *own->shape.points) return std::nullopt;
  edit.doubt = own->shape.doubt;  // nobody has looked at it
  return edit;
}

void share_carried(const Document& document, const std::vector<CarriedStructure>& carried) {
  const std::vector<SharedVertices> all = all_shared(document);
  if (all.empty()) return;
  std::map<int, std::map<std::string, SetPoints*>> frames;
  for (const CarriedStructure& one : carried)
    for (SetPoints& edit : one.edits)
      if (edit.of_frame && edit.by == FoundBy::propagation) frames[*edit.of_frame][one.of] = &edit;
  for (const auto& [frame, edits] : frames) {
    std::vector<std::string> ids;
    std::vector<Mesh> meshes;
    std::vector<std::size_t> leaders;
    for (const auto& one : document.structures) {
      if (edits.contains(one->id)) continue;
      const Shape* there = one->shape(frame);
      if (there == nullptr || there->strokes == 0) continue;
      leaders.push_back(ids.size());
      ids.push_back(one->id);
      meshes.push_back({one->the_template->topology, *there->points});
    }
    for (const CarriedStructure& one : carried) {
      const auto edit = edits.find(one.of);
      if (edit == edits.end()) continue;
      ids.push_back(one.of);
      meshes.push_back({document.structure(one.of)->the_template->topology, *edit->second->points});
    }
    const std::size_t first = leaders.size();
    if (first < ids.size()) leaders.push_back(first);
    follow_shared(all, ids, meshes, leaders);
    for (std::size_t k = first; k < ids.size(); ++k) {
      SetPoints& edit = *edits.at(ids[k]);
      if (meshes[k].points != *edit.points)
        edit.points = points_edit(*document.view(ids[k]), frame, meshes[k].points, edit.by).points;
    }
  }
}

}  // namespace homolog
