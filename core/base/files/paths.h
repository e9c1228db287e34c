#pragma once

#include <filesystem>
#include <system_error>

namespace homolog {

/// The path from the root, without "." and "..". If the working folder is gone, the path as it is.
inline std::filesystem::path absolute_path(const std::filesystem::path& path) {
  std::error_code gone;
  const std::filesystem::path whole = std::filesystem::absolute(path, gone);
  return (gone ? path : whole).lexically_normal();
}

}  // namespace homolog
