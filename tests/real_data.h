#pragma once

#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>

namespace homolog {

/// The folder of real data: HOMOLOG_DATA, else ../shared/data beside the source; empty, with a message, where absent.
inline std::filesystem::path real_data() {
  const char* named = std::getenv("HOMOLOG_DATA");
  const std::filesystem::path folder =
      named != nullptr ? std::filesystem::path(named) : std::filesystem::path(HOMOLOG_SOURCE_DIR) / "../shared/data";
  if (std::filesystem::is_directory(folder)) return folder;
  MESSAGE("skipped: no real data at ", folder.string(), " (set HOMOLOG_DATA)");
  return {};
}

}  // namespace homolog
