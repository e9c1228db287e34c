#include "core/model/shapes/shape_folder.h"

#include <doctest/doctest.h>

#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "tests/must.h"
#include "tests/temporary_folder.h"

using namespace homolog;

TEST_CASE("a shape that ShapeWorks wrote twice is one shape") {
  const TemporaryFolder folder;
  MeshFile points;
  points.points = icosphere(1, 10).points;
  for (const char* name : {"a_local.particles", "a_world.particles", "b_world.particles"})
    REQUIRE(write_mesh_file(points, folder.path / name));
  std::vector<std::string> names;
  for (const auto& file : test::must(shapes_in_folder(folder.path))) names.push_back(file.filename().string());
  CHECK(names == std::vector<std::string>{"a_local.particles", "b_world.particles"});
}
