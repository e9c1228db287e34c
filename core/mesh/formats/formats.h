#pragma once

#include <array>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh/mesh_io.h"

namespace homolog {

/// All that the program knows of a mesh format. Each has one of these in the source of this folder that is named like
/// it.
struct MeshFormat {
  const char* name;             ///< its name in docs/formats.md
  const char* extension;        ///< how the names of its files end, in lower case
  const char* note = "";        ///< a remark for docs/formats.md
  bool has_faces = true;        ///< false for a list of points
  bool keeps_numbers = true;    ///< a file that is written and read has the same vertices in the same order
  bool keeps_template = false;  ///< stiffness, regions and landmarks too
  bool keeps_record = false;    ///< how the file was made; else a file beside it does

  /// Takes the bytes of a whole file. Errors name no file. It need not check that coordinates are finite, that indices
  /// are in range and that every vertex has its values.
  Result<MeshFile> (*read)(std::string_view bytes);
  /// In its place for a format whose files may name others: `folder` is where those lie.
  Result<MeshFile> (*read_with_others)(std::string_view bytes, const std::filesystem::path& folder) = nullptr;
  void (*write)(const MeshFile&, std::ostream&);
};

namespace formats {
extern const MeshFormat ply, vtk, vtp, vtu, obj, mni_obj, gifti, msh, stl, particles;
}

/// The mesh formats, in the order in which sentences and file dialogs list them.
inline constexpr std::array mesh_formats{&formats::ply,     &formats::vtk,      &formats::vtp, &formats::vtu,
                                         &formats::obj,     &formats::gifti,    &formats::msh, &formats::stl,
                                         &formats::mni_obj, &formats::particles};

/// The format that a name asks for: the one with the longest ending that fits; null where none does.
const MeshFormat* mesh_format_of(const std::filesystem::path& path);

/// The extensions of those formats of which `property` is `wanted`; without a property of all.
inline std::vector<std::string> mesh_format_extensions(bool MeshFormat::*property = nullptr, bool wanted = true) {
  std::vector<std::string> extensions;
  for (const MeshFormat* format : mesh_formats)
    if (property == nullptr || format->*property == wanted) extensions.emplace_back(format->extension);
  return extensions;
}

}  // namespace homolog
