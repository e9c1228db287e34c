#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/case/actions/points.h"
#include "core/case/document.h"

namespace homolog {

/// The ids of the structures that a structure (`of`: its id; empty: the first) shares vertices with, and of those that
/// these share with, and so on; in the order of the case. Without its own.
std::vector<std::string> sharing_structures(const Document& document, std::string_view of);

/// The vertices of a structure that others share, 1 each, else 0. Empty where it shares none.
VertexScalars shared_vertices_of(const Document& document, std::string_view of);

/// Whose vertices decide where those lie that structures share.
struct SharedLead {
  std::string leader;             ///< the id of the structure that moved
  std::vector<std::string> held;  ///< ids of those that may not move: they come before the leader
};

/// The edit of a structure (`of`: its id) after which the vertices that it shares at the shown frame lie where those
/// that lead have them [follow_shared]. The leader has one too: it goes to the grid of computed points, and to those
/// that are held. First the leader is edited, then the others. None where nothing lies apart, or where it is held.
std::optional<SetPoints> edit_to_shared(const Document& document, const std::string& of, const SharedLead& lead);

/// Edits that carry a structure to frames of a cine; each names its frame.
struct CarriedStructure {
  std::string of;  ///< its id
  std::vector<SetPoints>& edits;
};

/// Gives the vertices that structures share one place in each frame that they are carried to: where structures have
/// them that are not carried there but were edited there, in the order of the case, else where the first of those that
/// are carried has them [follow_shared].
void share_carried(const Document& document, const std::vector<CarriedStructure>& carried);

}  // namespace homolog
