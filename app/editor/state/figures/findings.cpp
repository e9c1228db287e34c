#include "app/editor/state/figures/findings.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

/// Puts vertices that hang together into groups.
class Groups {
 public:
  void join(std::int32_t a, std::int32_t b) {
    a = first_of(a);
    b = first_of(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }
  /// In the order of their lowest vertices.
  std::map<std::int32_t, std::vector<std::int32_t>> all() {
    std::map<std::int32_t, std::vector<std::int32_t>> groups;
    for (const auto& [vertex, parent] : std::map(parent_)) groups[first_of(vertex)].push_back(vertex);
    return groups;
  }
  std::int32_t first_of(std::int32_t vertex) {
    auto parent = parent_.try_emplace(vertex, vertex).first->second;
    while (parent != vertex) {
      vertex = parent;
      parent = parent_.at(vertex);
    }
    return vertex;
  }

 private:
  std::map<std::int32_t, std::int32_t> parent_;
};

/// The vertex of a group that is nearest to the group's centre.
std::int32_t middle_of(const Points& points, const std::vector<std::int32_t>& group) {
  Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
  for (const std::int32_t v : group) centre += points.row(v) / static_cast<double>(group.size());
  return *std::min_element(group.begin(), group.end(), [&](std::int32_t a, std::int32_t b) {
    return (points.row(a) - centre).squaredNorm() < (points.row(b) - centre).squaredNorm();
  });
}

void large_first(std::vector<Finding>& findings) {
  std::stable_sort(findings.begin(), findings.end(),
                   [](const Finding& a, const Finding& b) { return a.count > b.count; });
}

/// The vertices for which something holds, in groups that hang together.
std::vector<Finding> places_where(FindingKind kind, const Mesh& mesh,
                                  const Eigen::Array<bool, Eigen::Dynamic, 1>& holds) {
  Groups groups;
  for (Eigen::Index v = 0; v < holds.size(); ++v) {
    if (!holds[v]) continue;
    const auto vertex = static_cast<std::int32_t>(v);
    groups.join(vertex, vertex);
    for (const std::int32_t next : mesh.topology->one_ring(v))
      if (holds[next]) groups.join(vertex, next);
  }
  std::vector<Finding> findings;
  for (const auto& [first, group] : groups.all())
    findings.push_back({kind, middle_of(mesh.points, group), {}, group.size()});
  large_first(findings);
  return findings;
}

}  // namespace

std::vector<Finding> findings_of(FindingKind kind, const Mesh& mesh, const std::vector<FacePair>& pairs) {
  const auto& triangles = mesh.topology->triangles();
  Groups groups;
  std::set<std::int32_t> faces;
  for (const auto& [a, b] : pairs) {
    groups.join(triangles(a, 0), triangles(b, 0));
    for (const std::int32_t face : {a, b}) {
      faces.insert(face);
      for (const std::int32_t v : triangles.row(face)) groups.join(triangles(face, 0), v);
    }
  }
  std::map<std::int32_t, std::vector<std::int32_t>> faces_of;
  for (const std::int32_t face : faces) faces_of[groups.first_of(triangles(face, 0))].push_back(face);
  std::vector<Finding> findings;
  for (const auto& [first, group] : groups.all()) {
    Finding finding{kind, middle_of(mesh.points, group), std::move(faces_of[first]), 0};
    finding.count = finding.faces.size();
    findings.push_back(std::move(finding));
  }
  if (kind == FindingKind::thin) {
    const auto thinnest = [&](const Finding& finding) {
      double smallest = 180;
      for (const std::int32_t f : finding.faces) smallest = std::min(smallest, smallest_angle_deg(mesh, f));
      return smallest;
    };
    std::stable_sort(findings.begin(), findings.end(),
                     [&](const Finding& a, const Finding& b) { return thinnest(a) < thinnest(b); });
  } else {
    large_first(findings);
  }
  return findings;
}

std::vector<Finding> unclear_edges(const Mesh& mesh, const VertexScalars& confidence) {
  return places_where(FindingKind::unclear, mesh, confidence.array() < unclear_below);
}

std::vector<Finding> doubtful_places(const Mesh& mesh, const VertexScalars& doubt_mm, double most_mm) {
  return places_where(FindingKind::doubtful, mesh, doubt_mm.array() > most_mm);
}

std::string finding_words(FindingKind kind) {
  switch (kind) {
    case FindingKind::intersecting:
      return "Triangles that pass through each other";
    case FindingKind::turned:
      return "Turned triangles";
    case FindingKind::thin:
      return "Thin triangles";
    case FindingKind::unclear:
      return "No clear edge in the image";
    case FindingKind::doubtful:
      return "In doubt since the fit";
    case FindingKind::suspicious:
      return "Unusual in the study";
  }
  return {};
}

}  // namespace homolog
