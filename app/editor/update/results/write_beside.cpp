#include "app/editor/update/results/write_beside.h"

namespace homolog {

void write_picture_beside(Editing& editing, const std::filesystem::path& path, Result<Picture> picture) {
  if (!picture) return add_notice(editing.state, picture.error().sentence());
  write_beside(editing, path,
               [picture = std::move(*picture)](const auto& to, Progress&) { return write_picture(picture, to); });
}

}  // namespace homolog
