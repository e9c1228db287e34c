#include "app/editor/state/files/file_extensions.h"

#include "core/mesh/formats/formats.h"
#include "core/volume/formats/formats.h"

namespace homolog {

const std::vector<std::string>& mesh_extensions() {
  static const std::vector<std::string> all = mesh_format_extensions(&MeshFormat::has_faces);
  return all;
}

const std::vector<std::string>& shape_extensions() {
  static const std::vector<std::string> all = mesh_format_extensions(&MeshFormat::keeps_numbers);
  return all;
}

const std::vector<std::string>& volume_extensions() {
  static const std::vector<std::string> all = volume_format_endings(&VolumeFormat::endings);
  return all;
}

}  // namespace homolog
