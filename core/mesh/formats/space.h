#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/mesh/mesh_io.h"

namespace homolog::formats {

/// The names by which a mesh file says in which space its coordinates are. 3D Slicer and others write SPACE=LPS or
/// SPACE=RAS into a title or a comment, and VTK a field of that name.
class SpaceNames {
 public:
  /// Takes every "SPACE=NAME" of a title or comment. False where there is none.
  bool look_in(std::string_view text);
  /// Takes the value of a field that is called SPACE.
  void add(std::string_view name);
  /// Turns the mesh into LPS where the file says RAS. Any other space, and a file that names both, is warned of: what
  /// is named first counts.
  void apply_to(MeshFile& mesh) const;

 private:
  std::vector<std::string> names_;
};

}  // namespace homolog::formats
