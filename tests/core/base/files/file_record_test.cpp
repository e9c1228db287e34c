#include "core/base/files/file_record.h"

#include <doctest/doctest.h>

#include "core/base/encoding/sha256.h"
#include "core/base/files/files.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "tests/temporary_folder.h"

namespace homolog {

namespace fs = std::filesystem;

TEST_CASE("SHA-256 is that of the standard and of a file's first bytes") {
  // FIPS 180-4's examples.
  const std::string abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
  CHECK(sha256_of("abc").value() == abc);
  CHECK(sha256_of("").value() == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  const TemporaryFolder folder;
  write_bytes(folder.path / "f", "abcdef");
  CHECK(sha256_of_file(folder.path / "f", nullptr, 3).value() == abc);
  CHECK(sha256_of_file(folder.path / "f").value() == sha256_of("abcdef").value());
  CHECK_FALSE(sha256_of_file(folder.path));
  CHECK(sha256_of_file(folder.path / "absent").error().subject == (folder.path / "absent").string());
}

TEST_CASE("a record of any length is read from every mesh as it was written and changes nothing else") {
  const TemporaryFolder folder;
  const Mesh ball = icosphere(1, 10);
  MeshFile mesh{ball.points, ball.topology->triangles()};
  for (const std::size_t length : {0, 1, 150, 5000}) {
    CAPTURE(length);
    // Blanks and backslashes at every place of a line.
    std::string name;
    while (name.size() < length) name += R"( \" \\ SPACE=RAS)";
    mesh.record = R"({"version":"1","name":")" + name + R"("})";
    for (const char* file : {"m.ply", "m.obj", "m.vtk", "m.vtp", "m.stl", "m.particles"}) {
      CAPTURE(file);
      const fs::path path = folder.path / file;
      REQUIRE(write_mesh_file(mesh, path));
      CHECK(read_record(path).value() == mesh.record);
      const MeshFile back = read_mesh_file(path).value();
      CHECK(back.record.empty());
      CHECK(back.comments.empty());
      CHECK(back.warnings.empty());
      if (fs::path(file) != "m.stl") CHECK(back.points == mesh.points);
    }
  }
}

TEST_CASE("no line of a header is longer than readers of PLY take") {
  const std::string lines = record_lines("comment ", std::string(3000, 'x'));
  for (std::size_t at = 0; at < lines.size(); at = lines.find('\n', at) + 1) CHECK(lines.find('\n', at) - at < 256);
}

}  // namespace homolog
