#include "app/fonts/fonts.h"

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <vector>

#include "core/base/files/files.h"

namespace homolog {

std::string east_asian_font() {
  namespace fs = std::filesystem;
  const auto set_to = [](const char* name, const std::string& otherwise) {
    const char* value = std::getenv(name);
    return value != nullptr && value[0] != 0 ? std::string(value) : otherwise;
  };
  const fs::path own = fs::path(set_to("XDG_DATA_HOME", (home_folder() / ".local/share").string())) / "fonts";
  const std::string shared = set_to("XDG_DATA_DIRS", "/usr/local/share:/usr/share");
  for (const fs::path file : {"opentype/noto/NotoSansCJK-Regular.ttc", "truetype/droid/DroidSansFallbackFull.ttf"}) {
    std::vector<fs::path> places{own / file.filename()};
    std::istringstream folders(shared);
    for (std::string folder; std::getline(folders, folder, ':');) places.push_back(fs::path(folder) / "fonts" / file);
    for (const fs::path& place : places) {
      std::error_code ignored;
      if (!fs::is_regular_file(place, ignored)) continue;
      if (auto bytes = read_whole_file(place)) return std::move(*bytes);
    }
  }
  return {};
}

}  // namespace homolog
