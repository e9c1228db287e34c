#include "core/mesh/files/mesh_frame.h"

#include <algorithm>
#include <string_view>

#include "core/mesh/formats/text.h"

namespace homolog {

namespace {
constexpr std::string_view frame_key = "homolog.frame ";
}

void note_frame(MeshFile& mesh, int frame) {
  std::erase_if(mesh.comments, [](const std::string& comment) { return comment.starts_with(frame_key); });
  mesh.comments.push_back(std::string(frame_key) + std::to_string(frame));
}

std::optional<int> noted_frame(const MeshFile& mesh) {
  for (const std::string& comment : mesh.comments) {
    if (!comment.starts_with(frame_key)) continue;
    const auto frame = formats::to_number<int>(std::string_view(comment).substr(frame_key.size()));
    if (frame && *frame >= 0) return frame;
  }
  return std::nullopt;
}

}  // namespace homolog
