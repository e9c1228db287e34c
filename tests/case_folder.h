#pragma once

#include <doctest/doctest.h>

#include <fstream>

#include "core/base/files/files.h"
#include "core/catalogue/catalogue.h"
#include "core/session/case_file.h"
#include "tests/shapes.h"
#include "tests/temporary_folder.h"

namespace homolog {

namespace fs = std::filesystem;

inline const Vec3 pole(0, 0, 40);

inline std::vector<std::string> lines_of(const fs::path& path) {
  std::ifstream file(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

/// A folder with a template and, once saved, a case without an image.
struct CaseFolder {
  TemporaryFolder folder;
  fs::path template_path = folder.path / "ball.ply", case_path = folder.path / "ball.homolog";

  CaseFolder() {
    const Mesh ball = icosphere(3, 40);
    MeshFile file{ball.points, ball.topology->triangles()};
    file.landmarks = {{"north", pole}, {"south", -pole}, {"east", Vec3(40, 0, 0)}, {"front", Vec3(0, -40, 0)}};
    REQUIRE(write_mesh_file(file, template_path));
  }
  Document document() const { return new_document("", nullptr, load_template(template_path.string()).value()); }
  EditSession create() const { return create_case(document(), case_path).value(); }
  std::string text() const { return read_whole_file(case_path).value(); }
  void append(const std::string& bytes) const { std::ofstream(case_path, std::ios::app | std::ios::binary) << bytes; }
};

inline Stroke pull(const Vec3& at, const Vec3& to, double sigma_mm = 10) {
  return {Tool::pull, at, to, sigma_mm, {}, false, 1};
}

}  // namespace homolog
