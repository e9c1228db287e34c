#include "core/model/shapes/shape_folder.h"

#include <map>
#include <string_view>

#include "core/base/encoding/json.h"
#include "core/base/files/file_stem.h"
#include "core/base/files/files.h"
#include "core/base/text/listed.h"
#include "core/mesh/formats/formats.h"
#include "core/session/case_file.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// ShapeWorks writes the points of a shape twice, as it lies in its scan and as it is aligned. The aligned ones go
/// where both are there.
void take_local_particles(std::map<std::string, fs::path>& meshes) {
  constexpr std::string_view world = "_world";
  std::erase_if(meshes, [&](const auto& one) {
    const auto& [name, file] = one;
    if (file.extension() != ".particles" || !name.ends_with(world)) return false;
    const auto local = meshes.find(name.substr(0, name.size() - world.size()) + "_local");
    return local != meshes.end() && local->second.extension() == ".particles";
  });
}

/// The facts on a case that the lines of its file tell.
struct WhatLinesSay {
  bool fitted = false;   ///< there is a note of a fit
  bool further = false;  ///< lines after the last such note
  bool edits = false;    ///< lines that are no notes and do not only say where it begins
};

WhatLinesSay what_lines_say(const fs::path& case_file) {
  WhatLinesSay lines;
  const auto text = read_whole_file(case_file);
  if (!text) return lines;
  for (std::size_t at = 0; at < text->size();) {
    const std::size_t end = std::min(text->find('\n', at), text->size());
    const std::string_view line = std::string_view(*text).substr(at, end - at);
    const bool is_header = at == 0;
    at = end + 1;
    const bool is_note = line.find("\"note\"") != std::string_view::npos;
    if (is_note && line.find("\"fit\"") != std::string_view::npos)
      lines.fitted = true, lines.further = false;
    else if (!line.empty())
      lines.further = true;
    const bool begins = is_header || line.starts_with("{\"frame\"") || line.starts_with("{\"mirror\"");
    if (!line.empty() && !is_note && !begins) lines.edits = true;
  }
  return lines;
}

}  // namespace

bool goes_on_after_fit(const fs::path& case_file) {
  const WhatLinesSay lines = what_lines_say(case_file);
  return lines.fitted && lines.further;
}

bool was_worked_on(const fs::path& case_file) {
  const WhatLinesSay lines = what_lines_say(case_file);
  return lines.fitted ? lines.further : lines.edits;
}

Result<std::vector<fs::path>> shapes_in_folder(const fs::path& folder) {
  std::map<std::string, fs::path> meshes, cases;
  bool of_structures = false;  // CASE/STRUCTURE.ply, as `fit SET` writes it
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path& file = entry->path();
    if (file.filename().string().starts_with('.')) continue;
    std::error_code ignored;
    if (entry->is_directory(ignored)) {
      for (fs::directory_iterator inner(file, ignored), none; !ignored && inner != none; inner.increment(ignored))
        of_structures = of_structures || keeps_numbers(inner->path());
      continue;
    }
    if (is_case_file(file))
      cases.emplace(file_stem(file), file);
    else if (keeps_numbers(file)) {
      const auto [there, is_new] = meshes.emplace(file_stem(file), file);
      if (!is_new && file.extension() == ".ply") there->second = file;  // it keeps most
    }
  }
  if (error) return fail(folder.string(), "cannot be read: " + error.message());
  take_local_particles(meshes);
  std::map<std::string, fs::path> shapes = cases;
  for (const auto& [name, mesh] : meshes) {
    constexpr std::string_view imported = "-imported";
    if (name.ends_with(imported) && cases.contains(name.substr(0, name.size() - imported.size()))) continue;
    const auto there = cases.find(name);
    if (there == cases.end() || !goes_on_after_fit(there->second)) shapes[name] = mesh;
  }
  if (shapes.empty())
    return fail(folder.string(),
                of_structures ? std::string("holds folders with meshes and no shapes of its own; name the "
                                            "structures by --structures, or one of the folders")
                              : "holds no shapes; name a folder of meshes (" +
                                    listed(mesh_format_extensions(&MeshFormat::keeps_numbers), ", ") + ") or of cases");
  std::vector<fs::path> files;
  for (const auto& [name, file] : shapes) files.push_back(file);
  return files;
}

}  // namespace homolog
