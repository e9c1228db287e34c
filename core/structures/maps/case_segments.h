#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/case/document.h"
#include "core/structures/maps/set_map.h"

namespace homolog {

/// The name of a structure: its own, else its template's, else its id.
std::string structure_name(const Structure& structure);

/// The values of a label map by layer and name, in lower case.
using SegmentValues = std::map<std::pair<std::size_t, std::string>, int>;

/// The structures of a case at the shown frame as they go into a label map, with names and colours: each with the value
/// that it has in `values`, else with one that is free, from 1 on. Structures without a mesh in that frame are left
/// out.
std::vector<MeshOfSegment> segments_of(const Document& document, SegmentValues values = {});

}  // namespace homolog
