// The command-line contract of docs/commands.md: fits to contours.
#include <numbers>

#include "core/mesh/mesh_io.h"
#include "tests/command_line.h"

namespace homolog {

namespace {

/// Ellipses in five slices as closed curves of 3D Slicer; `times` wider.
void put_curves(const fs::path& file, double times = 1) {
  Json markups = Json::array();
  for (int k = -2; k <= 2; ++k) {
    Json points = Json::array();
    const double z = 12.0 * k, across = times * std::sqrt(1 - z * z / (30 * 30));
    for (int p = 0; p < 16; ++p) {
      const double angle = p * std::numbers::pi / 8;
      points.push_back(
          {{"id", std::to_string(p)}, {"position", {20 * across * std::cos(angle), 26 * across * std::sin(angle), z}}});
    }
    markups.push_back({{"type", "ClosedCurve"}, {"coordinateSystem", "LPS"}, {"controlPoints", std::move(points)}});
  }
  REQUIRE(write_whole_file(file, Json{{"markups", std::move(markups)}}.dump()));
}

}  // namespace

TEST_CASE("a fit to contours says how far it lies from them") {
  const TemporaryFolder folder;
  put_curves(folder.path / "drawn.mrk.json");
  const Ran ran = run(folder, "fit built-in:kidney --contours drawn.mrk.json -o m.ply --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  CHECK(ran.json()["contours_mm"]["mean"].get<double>() < 0.3);
  CHECK(ran.json()["contours_mm"]["p95"].get<double>() < 1);
  CHECK(ran.json()["contours"] == 5);
  CHECK(ran.json()["structures"] == Json::array({"drawn"}));
  CHECK(ran.json()["turned_triangles"] == 0);
  CHECK(read_mesh_file(folder.path / "m.ply")->doubt_mm.has_value());
  const Ran again = run(folder, "fit built-in:kidney --contours drawn.mrk.json -o n.ply --jobs 1");
  CHECK(again.status == 0);
  CHECK(read_whole_file(folder.path / "m.ply").value() == read_whole_file(folder.path / "n.ply").value());
}

TEST_CASE("contours that only lie outside make a smaller mesh") {
  const TemporaryFolder folder;
  put_curves(folder.path / "drawn.mrk.json");
  const std::string fit = "fit built-in:kidney --contours drawn.mrk.json --json -o ";
  const Ran rim = run(folder, fit + "rim.ply"), limit = run(folder, fit + "limit.ply --outside");
  REQUIRE_MESSAGE(limit.status == 0, limit.errors);
  const auto volume = [&](const char* name) {
    return run(folder, std::string("info ") + name + " --json").json()["volume_ml"].get<double>();
  };
  CHECK(volume("limit.ply") < 0.8 * volume("rim.ply"));
  CHECK(volume("limit.ply") > 0.4 * volume("rim.ply"));
  CHECK(limit.json()["contours_mm"]["mean"].get<double>() < 0.2);
}

TEST_CASE("contours of one plane alone leave the organ's place beside it in doubt") {
  const TemporaryFolder folder;
  put_curves(folder.path / "drawn.mrk.json");
  Json one = Json::parse(read_whole_file(folder.path / "drawn.mrk.json").value());
  one["markups"] = Json::array({one["markups"][2]});
  REQUIRE(write_whole_file(folder.path / "one.mrk.json", one.dump()));
  const Ran alone = run(folder, "fit built-in:kidney --contours one.mrk.json -o m.ply --json");
  REQUIRE_MESSAGE(alone.status == 0, alone.errors);
  CHECK(alone.json()["doubtful"] == true);
  CHECK(alone.errors.find("draw more of them") != std::string::npos);
  const Ran five = run(folder, "fit built-in:kidney --contours drawn.mrk.json -o m.ply --json");
  CHECK(five.json()["doubtful"] == false);
}

TEST_CASE("info of curves says that they are contours") {
  const TemporaryFolder folder;
  put_curves(folder.path / "drawn.mrk.json");
  const Ran ran = run(folder, "info drawn.mrk.json --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  CHECK(ran.json()["kind"] == "contours");
  CHECK(ran.json()["rois"][0]["name"] == "drawn");
  CHECK(ran.json()["rois"][0]["contours"] == 5);
}

TEST_CASE("contours that cannot be used are refused in a sentence") {
  const TemporaryFolder folder;
  put_curves(folder.path / "drawn.mrk.json");
  REQUIRE(write_whole_file(folder.path / "points.mrk.json", R"({"markups":[{"type":"Fiducial","controlPoints":[]}]})"));
  const std::string fit = "fit built-in:kidney -o m.ply --contours ";
  check_refused(run(folder, fit + "points.mrk.json"), "points.mrk.json");
  check_refused(run(folder, fit + "absent.vtp"), "absent.vtp");
  check_refused(run(folder, fit + "drawn.mrk.json --structure spleen"),
                "has no structure \"spleen\"; it has 1 (drawn)");
  REQUIRE(run(folder, "convert built-in:kidney k.ply").status == 0);
  check_refused(run(folder, fit + "k.ply"), "k.ply: is a mesh and no contours");
  fs::create_directory(folder.path / "curves");
  put_curves(folder.path / "curves/drawn.mrk.json");
  check_refused(run(folder, fit + "curves"), "or the files of curves (.mrk.json, .vtp)");
  CHECK(run(folder, fit + "drawn.mrk.json --mesh m.ply").status == 2);
  CHECK(run(folder, fit + "drawn.mrk.json --partial").status == 2);
  CHECK(run(folder, fit + "drawn.mrk.json --resample").status == 2);
  CHECK(run(folder, fit + "drawn.mrk.json --placement p.json --orientation any").status == 2);
  CHECK_FALSE(fs::exists(folder.path / "m.ply"));
}

}  // namespace homolog
