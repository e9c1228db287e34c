#include "core/base/files/file_stem.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "core/base/text/text.h"

namespace homolog {

namespace {

/// A longer ending stands before those that it ends in. A test compares them with the formats of images and meshes.
constexpr std::array<std::string_view, 45> endings{
    ".surf.gii",  ".mni.obj", ".gii",      ".msh",        ".seg.nrrd", ".mgh.gz",  ".mgz",  ".mgh",  ".nii.gz",
    ".img.gz",    ".hdr.gz",  ".mrk.json", ".study.json", ".h5.json",  ".homolog", ".nii",  ".nrrd", ".nhdr",
    ".mha",       ".mhd",     ".hdr",      ".img",        ".dcm",      ".ima",     ".png",  ".tif",  ".tiff",
    ".jpg",       ".jpeg",    ".ply",      ".stl",        ".obj",      ".off",     ".vtk",  ".vtp",  ".vtu",
    ".particles", ".fcsv",    ".json",     ".h5",         ".csv",      ".raw",     ".zraw", ".txt",  ".gz"};

}  // namespace

std::string file_stem(const std::filesystem::path& path) {
  std::string name = path.filename().string();
  const std::string lower = lower_case(name);
  const auto known = std::find_if(endings.begin(), endings.end(), [&](std::string_view ending) {
    return lower.size() > ending.size() && lower.ends_with(ending);
  });
  if (known != endings.end()) name.resize(name.size() - known->size());
  return name;
}

}  // namespace homolog
