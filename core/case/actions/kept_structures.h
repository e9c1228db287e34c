#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/base/numbers/geometry.h"

namespace homolog {

// Things that a case keeps of its structures beside its steps, so that no undo takes them back. All by structures' ids.

/// How the window shows them, and what it goes by. Files are named relative to the case's folder.
struct KeptLooks {
  std::string active;  ///< the one that is worked on; empty: the first
  std::vector<std::string> hidden, locked;
  std::map<std::string, double> opacity;  ///< 0…1, in 3D; 1 of those that are not named
  bool as_read_hidden = false;            ///< repaired structures are not shown as the label map has them
  std::string set;                        ///< the template set that was chosen, a file or built in; empty: none was
  std::string recipe;                     ///< of measurements, a file or one that ships; empty: the template's, or none
  std::vector<std::string> measured;      ///< the measurements that are drawn on the mesh, by their names
  std::string model;                      ///< the file that the mesh is scored against; empty: none
  bool operator==(const KeptLooks&) const = default;
};

/// One structure in the label map that a set was fitted to.
struct InFittedMap {
  std::string name;             ///< the set's name for it
  std::size_t layer = 0;        ///< its layer of the map
  int value = 0;                ///< its label there, as the repair proposes the map
  std::string mesh;             ///< mesh_hash of what the fit gave
  double p_named = 1;           ///< 0…1: that its name is the right one
  bool was_missing = false;     ///< the map has no such structure: the repair filled it in
  std::vector<double> as_read;  ///< x, y, z of every vertex before the repair, LPS mm; empty: the repair left it
  bool operator==(const InFittedMap&) const = default;
};

/// The findings of a set's fit in a label map, and what its repair proposes there.
struct KeptMapFit {
  int frame = 0;  ///< the case's frame
  std::map<std::string, InFittedMap> structures;
  std::vector<std::uint32_t> changes;  ///< the changes of voxels [voxel_changes]; empty: none is proposed
  bool operator==(const KeptMapFit&) const = default;
};

class Fields;
/// Their members in a line of the case file. Reading throws, as Fields does.
void spell_looks(Fields line, KeptLooks& looks);
void spell_map_fit(Fields line, KeptMapFit& fit);

}  // namespace homolog
