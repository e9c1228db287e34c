#include "core/base/files/freesurfer_files.h"

#include <array>
#include <fstream>

#include "core/base/text/text.h"

namespace homolog {

std::string freesurfer_words(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return {};  // a pipe may never end
  if (lower_case(path.extension().string()) == ".annot")
    return "is a parcellation of FreeSurfer, which holds no shape; give the surface that it is of, converted by "
           "FreeSurfer: mris_convert lh.pial lh.surf.gii";
  std::ifstream in(path, std::ios::binary);
  std::array<char, 3> mark{};
  constexpr std::array triangles{'\xff', '\xff', '\xfe'}, quads{'\xff', '\xff', '\xff'},
      new_quads{'\xff', '\xff', '\xfd'};
  if (!in.read(mark.data(), mark.size()) || (mark != triangles && mark != quads && mark != new_quads)) return {};
  const std::string name = path.filename().string();
  return "is a surface in FreeSurfer's own format, which is not read; convert it by FreeSurfer: mris_convert " + name +
         " " + name + ".surf.gii";
}

}  // namespace homolog
