#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/mesh/topology.h"

namespace homolog {

enum class FindingKind {
  intersecting,  ///< triangles that pass through each other
  turned,        ///< triangles that are turned over [fold_guard.h]
  thin,          ///< triangles with an angle below `thin_below_deg`
  unclear,       ///< vertices at which the last snap saw no clear edge
  doubtful,      ///< vertices that the last fit leaves in much doubt
  suspicious     ///< unusual among the shapes of the study
};
inline constexpr double thin_below_deg = 10, unclear_below = 0.3;

/// A place of the mesh that a person should look at: faces or vertices of one kind that hang together.
struct Finding {
  FindingKind kind = FindingKind::intersecting;
  std::int32_t vertex = 0;          ///< a vertex in its middle
  std::vector<std::int32_t> faces;  ///< the faces that are marked; none where vertices are meant
  std::size_t count = 1;            ///< faces or vertices
  bool operator==(const Finding&) const = default;
};

/// Two faces that belong to one finding; a face by itself is a pair with itself.
using FacePair = std::array<std::int32_t, 2>;
/// The findings of a kind among these faces: large ones first; thin ones the thinnest first.
std::vector<Finding> findings_of(FindingKind kind, const Mesh& mesh, const std::vector<FacePair>& pairs);
/// Places where the confidence (one a vertex, 0…1) is below `unclear_below`; large ones first.
std::vector<Finding> unclear_edges(const Mesh& mesh, const VertexScalars& confidence);
/// Places where the doubt (mm, one a vertex) is above `most_mm`; large ones first.
std::vector<Finding> doubtful_places(const Mesh& mesh, const VertexScalars& doubt_mm, double most_mm);

/// One that is looked at, and marked in all views.
struct ShownFinding {
  Finding finding;
  std::size_t number = 1, of = 1;  ///< among those of its kind
};

/// "Turned triangles"
std::string finding_words(FindingKind kind);

}  // namespace homolog
