#include "app/editor/state/file_extensions.h"

namespace homolog {

const std::vector<std::string>& mesh_extensions() {
  static const std::vector<std::string> all{".ply", ".vtk", ".vtp", ".obj", ".stl"};
  return all;
}

const std::vector<std::string>& volume_extensions() {
  static const std::vector<std::string> all{".nii.gz", ".nii", ".hdr", ".img", ".nrrd", ".nhdr", ".mha",
                                            ".mhd",    ".dcm", ".ima", ".png", ".tif",  ".tiff"};
  return all;
}

}  // namespace homolog
