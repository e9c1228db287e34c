#pragma once

#include <cstdlib>
#include <filesystem>

#include "tests/skip.h"

namespace homolog {

/// The folder of real data: HOMOLOG_DATA, else ../shared/data beside the source; empty where absent, which skips the
/// test.
inline std::filesystem::path real_data() {
  const char* named = std::getenv("HOMOLOG_DATA");
  const std::filesystem::path folder =
      named != nullptr ? std::filesystem::path(named) : std::filesystem::path(HOMOLOG_SOURCE_DIR) / "../shared/data";
  if (std::filesystem::is_directory(folder)) return folder;
  test::skip("no real data at " + folder.string() + " (set HOMOLOG_DATA)");
  return {};
}

}  // namespace homolog
