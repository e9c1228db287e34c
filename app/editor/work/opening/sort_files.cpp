#include "app/editor/work/opening/sort_files.h"

#include <algorithm>
#include <fstream>

#include "app/editor/state/files/file_extensions.h"
#include "core/base/files/paths.h"
#include "core/base/text/text.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/files/slicer_curves.h"
#include "core/mesh/mesh_io.h"
#include "core/session/case_file.h"
#include "core/volume/contours.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

bool ends_with_any(const fs::path& path, const std::vector<std::string>& extensions) {
  const std::string name = lower_case(path.filename().string());
  return std::any_of(extensions.begin(), extensions.end(), [&](const auto& e) { return name.ends_with(e); });
}

/// As dialogs, recent files and cases need it, wherever the program was started.
std::string whole_path(const fs::path& path) {
  return path.is_absolute() || !names_file(path.string()) ? path.string() : absolute_path(path).string();
}

/// Whether the beginning of a VTP file says of a piece that it has such cells ("NumberOfLines").
bool announces(std::string_view start, std::string_view cells) {
  for (std::size_t at = start.find(cells); at != std::string_view::npos; at = start.find(cells, at)) {
    at += cells.size();
    const std::size_t digit = start.find_first_not_of(" \t\r\n=\"'", at);
    if (digit != std::string_view::npos && start[digit] >= '1' && start[digit] <= '9') return true;
  }
  return false;
}

/// Whether a VTP file says that it has lines and no faces. Only its beginning is read, since the window waits.
bool says_lines_alone(const fs::path& path) {
  std::string start(std::size_t{1} << 16, '\0');
  std::ifstream in(path, std::ios::binary);
  in.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(in.gcount()));
  return announces(start, "NumberOfLines") && !announces(start, "NumberOfPolys") && !announces(start, "NumberOfStrips");
}

/// Whether a file holds drawn curves and no surface.
bool is_contour_file(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return false;
  const std::string name = lower_case(path.filename().string());
  if (name.ends_with(".mrk.json")) return read_slicer_curves(path).has_value();
  if (name.ends_with(".vtp")) return says_lines_alone(path);
  return holds_contours(path);
}

}  // namespace

Error second_image(const std::string& path, const std::string& why) {
  return {path, "is a second image" + why +
                    "; open one image at a time, a series of slices as its folder, and a label map by "
                    "Template → Open a label map…"};
}

Result<OpenRequest> sort_files(const std::vector<fs::path>& paths) {
  OpenRequest request;
  for (const fs::path& path : paths) {
    std::error_code ignored;
    const bool folder = fs::is_directory(path, ignored);
    if (!folder && ends_with_any(path, {case_extension})) {
      if (!request.case_file.empty()) return fail(path.string(), "is a second case; open one case at a time");
      request.case_file = absolute_path(path);  // as studies name it
    } else if (is_contour_file(path)) {
      request.contours.push_back(absolute_path(path));
    } else if (!folder && ends_with_any(path, mesh_extensions())) {
      if (!request.template_source.empty()) return fail(path.string(), "is a second template; open one at a time");
      request.template_source = whole_path(path);
    } else if (request.volume_source.empty()) {
      request.volume_source = whole_path(path);
    } else if (request.other_source.empty()) {
      request.other_source = whole_path(path);
    } else {
      return fail(second_image(path.string(), ""));
    }
  }
  if (!request.case_file.empty() && !request.other_source.empty()) return fail(second_image(request.other_source, ""));
  if (!request.case_file.empty() && !request.template_source.empty())
    return fail(request.case_file.string(),
                "is a case and has its own template; open it alone, or with its image if the image has moved");
  return request;
}

}  // namespace homolog
