#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "app/editor/update/editing.h"

namespace homolog {

// Files that are written beside the window, since they may be large or far away.

/// Has a file written; `how` keeps what it is written from. `remark` is said when it is done.
template <class How>
void write_beside(Editing& editing, const std::filesystem::path& path, How how, std::string remark = {}) {
  editing.work.exports.start(
      path, [path, how = std::move(how)](Progress& progress) { return how(path, progress); }, {}, std::move(remark));
}
void write_picture_beside(Editing& editing, const std::filesystem::path& path, Result<Picture> picture);

}  // namespace homolog
