// The command-line contract of docs/commands.md: tets.
#include <fstream>

#include "core/mesh/mesh_io.h"
#include "tests/command_line.h"
#include "tests/tetrahedra.h"

namespace homolog {

TEST_CASE("tetrahedra of a template are written in the shape of each case") {
  const TemporaryFolder folder;
  const Mesh ball = icosphere(2, 20);
  REQUIRE(write_mesh(ball, folder.path / "t.ply"));
  REQUIRE(write_mesh({ball.topology, bent(ball.points, 0.02)}, folder.path / "a.ply"));
  REQUIRE(write_mesh({ball.topology, ball.points * 1.5}, folder.path / "b.ply"));
  REQUIRE(write_mesh(icosphere(1, 20), folder.path / "c.ply"));
  std::ofstream(folder.path / "t.vtu") << BallOfTetrahedra(ball, 4).vtu();
  const Ran ran = run(folder, "tets t.vtu a.ply b.ply --template t.ply -o out --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  const Json report = ran.json();
  CHECK(report["tetrahedra"] == 3200);
  REQUIRE(report["cases"].size() == 2);
  for (const Json& row : report["cases"]) {
    CHECK(row["inverted"] == 0);
    CHECK(row["doubtful"] == false);
    CHECK(row["scaled_jacobian_least"] >= report["scaled_jacobian_asked"]);
  }
  CHECK(report["cases"][1]["name"] == "b");
  const VolumeMesh larger = read_volume_mesh(folder.path / "out/b.vtu").value();
  CHECK(larger.points.rowwise().norm().maxCoeff() == doctest::Approx(30).epsilon(1e-4));
  CHECK(read_whole_file(folder.path / "out/a.vtu").value().find("Name=\"tissue\"") != std::string::npos);
  const std::string first = read_whole_file(folder.path / "out/a.vtu").value();
  REQUIRE(run(folder, "tets t.vtu a.ply --template t.ply -o out --jobs 1").status == 0);
  CHECK(read_whole_file(folder.path / "out/a.vtu").value() == first);
  const Ran wrong = run(folder, "tets t.vtu c.ply --template t.ply -o out2");
  CHECK(wrong.status == 1);
  CHECK(wrong.errors.find("42 vertices") != std::string::npos);
  CHECK(run(folder, "tets t.ply a.ply --template t.ply -o out2").status == 1);
}

TEST_CASE("tetrahedra whose outside lies off the template are doubtful and said") {
  const TemporaryFolder folder;
  const Mesh ball = icosphere(2, 20);
  REQUIRE(write_mesh(ball, folder.path / "t.ply"));
  REQUIRE(write_mesh(ball, folder.path / "a.ply"));
  const auto carried = [&](const Mesh& outside) {
    std::ofstream(folder.path / "t.vtu") << BallOfTetrahedra(outside, 4).vtu();
    return run(folder, "tets t.vtu a.ply --template t.ply -o out --json");
  };
  const Ran near = carried({ball.topology, ball.points * 1.01});
  REQUIRE_MESSAGE(near.status == 0, near.errors);
  CHECK(near.json()["cases"][0]["doubtful"] == false);
  CHECK(near.errors.find("off the template's surface") == std::string::npos);
  const Ran larger = carried({ball.topology, ball.points * 1.1});
  REQUIRE_MESSAGE(larger.status == 0, larger.errors);
  CHECK(larger.json()["off_mm"].get<double>() == doctest::Approx(2).epsilon(0.1));
  CHECK(larger.json()["cases"][0]["doubtful"] == true);
  CHECK(larger.errors.find("t.vtu: its outside lies up to ") != std::string::npos);
  CHECK(larger.errors.find(" mm off the template's surface, and about as far off that of each case") !=
        std::string::npos);
}

TEST_CASE("tetrahedra are not carried into a shape of another numbering") {
  const TemporaryFolder folder;
  const Mesh ball = icosphere(2, 20);
  REQUIRE(write_mesh(ball, folder.path / "t.ply"));
  std::ofstream(folder.path / "t.vtu") << BallOfTetrahedra(ball, 3).vtu();
  const Eigen::Index count = ball.points.rows();
  Points points(count, 3);
  Triangles faces = ball.topology->triangles();
  for (Eigen::Index k = 0; k < count; ++k) points.row((k + 7) % count) = ball.points.row(k);
  for (auto& corner : faces.reshaped()) corner = (corner + 7) % static_cast<std::int32_t>(count);
  REQUIRE(write_mesh({Topology::make(count, faces).value(), points}, folder.path / "turned.ply"));
  REQUIRE(write_mesh(ball, folder.path / "same.ply"));
  const Ran ran = run(folder, "tets t.vtu same.ply turned.ply --template t.ply -o out");
  CHECK(ran.status == 1);
  INFO(ran.errors);
  CHECK(ran.errors.find("turned.ply: has other faces (or another numbering) than the template") != std::string::npos);
  CHECK(fs::exists(folder.path / "out/same.vtu"));
  CHECK_FALSE(fs::exists(folder.path / "out/turned.vtu"));
}

TEST_CASE("tetrahedra are not written over a file that they are made of") {
  const TemporaryFolder folder;
  const Mesh ball = icosphere(2, 20);
  REQUIRE(write_mesh(ball, folder.path / "kidney.ply"));
  fs::create_directory(folder.path / "fits");
  REQUIRE(write_mesh(ball, folder.path / "fits/a.vtu"));
  REQUIRE(write_mesh(ball, folder.path / "fits/b.ply"));
  REQUIRE(write_mesh(ball, folder.path / "t.vtu"));
  std::ofstream(folder.path / "kidney.vtu") << BallOfTetrahedra(ball, 3).vtu();
  const auto kept = [&](const std::string& name, const std::string& arguments) {
    const std::string before = read_whole_file(folder.path / name).value();
    check_refused(run(folder, "tets " + arguments), name);
    const bool same = read_whole_file(folder.path / name).value() == before;
    CHECK(same);
  };
  kept("kidney.vtu", "kidney.vtu kidney.ply --template kidney.ply -o .");
  kept("kidney.vtu", "kidney.vtu fits/b.ply kidney.ply --template kidney.ply -o fits/..");
  kept("fits/a.vtu", "kidney.vtu fits --template kidney.ply -o fits");
  CHECK(!fs::exists(folder.path / "fits/b.vtu"));
  fs::copy_file(folder.path / "fits/b.ply", folder.path / "fits/t.ply");
  kept("t.vtu", "kidney.vtu fits/t.ply --template t.vtu -o .");
  CHECK(run(folder, "tets kidney.vtu kidney.ply --template kidney.ply -o out").status == 0);
}

TEST_CASE("tetrahedra are not carried into a mirrored shape") {
  const TemporaryFolder folder;
  const Mesh ball = icosphere(2, 20);
  REQUIRE(write_mesh(ball, folder.path / "t.ply"));
  Points mirrored = ball.points;
  mirrored.col(0) *= -1;
  REQUIRE(write_mesh({ball.topology, mirrored}, folder.path / "m.ply"));
  std::ofstream(folder.path / "t.vtu") << BallOfTetrahedra(ball, 3).vtu();
  const Ran ran = run(folder, "tets t.vtu m.ply --template t.ply -o out --json");
  CHECK(ran.status == 1);
  CHECK(ran.errors.find("m.ply: ") != std::string::npos);
  CHECK(ran.errors.find("mirrored against the template") != std::string::npos);
  CHECK(!fs::exists(folder.path / "out/m.vtu"));
}

}  // namespace homolog
