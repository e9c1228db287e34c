#include "tests/ball_folder.h"

namespace homolog {

namespace {

/// Two balls that nearly touch and a speck, named as 3D Slicer names segments.
struct BodyFolder : TemporaryFolder {
  BodyFolder() {
    VolumeGeometry grid;
    grid.dims = {70, 36, 36};
    grid.spacing_mm.setConstant(2);
    grid.origin_mm = Vec3(-35, -35, -35);
    Volume body = label_map(icosphere(4, 20), grid, 3);
    Mesh second = icosphere(4, 20);
    second.points.col(0).array() += 44;
    const Volume other = label_map(second, grid, 5);
    auto& voxels = std::get<std::vector<std::uint8_t>>(body.data);
    const auto& further = std::get<std::vector<std::uint8_t>>(other.data);
    for (std::size_t i = 0; i < voxels.size(); ++i)
      if (further[i] != 0) voxels[i] = further[i];
    voxels[0] = 9;
    REQUIRE(write_volume(body, path / "body.nrrd"));
    std::string bytes = read_whole_file(path / "body.nrrd").value();
    const std::string names =
        "Segment0_ID:=Segment_1\nSegment0_LabelValue:=3\nSegment0_Layer:=0\nSegment0_Name:=kidney_left\n"
        "Segment0_Color:=0.5 0.25 1\nSegment1_ID:=Segment_2\nSegment1_LabelValue:=5\nSegment1_Layer:=0\n"
        "Segment1_Name:=kidney_right\nSegment2_ID:=Segment_3\nSegment2_LabelValue:=9\nSegment2_Layer:=0\n"
        "Segment2_Name:=speck\n";
    bytes.insert(bytes.find("\n\n") + 1, names);
    REQUIRE(write_whole_file(path / "body.seg.nrrd", bytes));
  }
};

}  // namespace

TEST_CASE("set make gives a template of each structure and names what suits none") {
  const BodyFolder folder;
  const Ran made = run(folder, "set make body.seg.nrrd --all --vertices 400 -o body.set.json --json");
  REQUIRE(made.status == 0);
  const Json structures = made.json()["structures"];
  REQUIRE(structures.size() == 3);
  CHECK(structures[0]["name"] == "kidney_left");
  CHECK(structures[0]["value"] == 3);
  CHECK(structures[0]["vertices"] == 400);
  CHECK(structures[0]["genus"] == 0);
  CHECK(structures[2]["name"] == "speck");
  CHECK(structures[2]["vertices"] == 0);
  const std::string warning = structures[2]["warning"];
  INFO(warning);
  CHECK(warning.find("too few for a shape") != std::string::npos);
  CHECK(made.errors.find("speck: has no template in the set") != std::string::npos);
  CHECK(fs::exists(folder.path / "body" / "kidney_left.ply"));
  CHECK_FALSE(fs::exists(folder.path / "body" / "speck.ply"));

  const Ran told = run(folder, "set info body.set.json --json");
  REQUIRE(told.status == 0);
  const Json known = told.json()["structures"];
  REQUIRE(known.size() == 2);
  CHECK(known[0]["side"] == "left");
  CHECK(known[0]["partner"] == "kidney_right");
  CHECK(known[1]["neighbours"] == Json::array({"kidney_left"}));
  CHECK(known[1]["vertices"] == 400);
}

TEST_CASE("a set is the same whatever the threads and holds only what was asked for") {
  const BodyFolder folder;
  REQUIRE(run(folder, "set make body.seg.nrrd --labels kidney_right,3 --vertices 400 -o a.set.json --jobs 1").status ==
          0);
  REQUIRE(run(folder, "set make body.seg.nrrd --labels kidney_right,3 --vertices 400 -o b.set.json --jobs 2").status ==
          0);
  for (const char* name : {"kidney_left.ply", "kidney_right.ply"})
    CHECK(read_whole_file(folder.path / "a" / name).value() == read_whole_file(folder.path / "b" / name).value());
  const Ran unknown = run(folder, "set make body.seg.nrrd --labels kidny_left -o c.set.json");
  CHECK(unknown.status == 1);
  CHECK(unknown.errors.find("kidney_left") != std::string::npos);
  CHECK(run(folder, "set make body.seg.nrrd -o c.set.json").status == 2);
  CHECK(run(folder, "set make body.seg.nrrd --all -o c.json").status == 2);
  CHECK(run(folder, "set info body.nrrd").status == 1);
}

}  // namespace homolog
