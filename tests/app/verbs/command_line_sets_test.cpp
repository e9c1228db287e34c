#include <algorithm>
#include <cmath>

#include "core/mesh/mesh_io.h"
#include "core/model/joint_models/structure_files.h"
#include "core/model/shapes/study.h"
#include "core/session/case_file.h"
#include "core/structures/maps/set_map.h"
#include "core/structures/template_set.h"
#include "core/volume/labels/write_segmentation.h"
#include "tests/ball_folder.h"
#include "tests/half_balls.h"
#include "tests/must.h"

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

/// body.set.json: a template of each of the two balls.
void make_set_of_kidneys(const BodyFolder& folder) {
  const Ran made =
      run(folder, "set make body.seg.nrrd --labels kidney_left,kidney_right --vertices 400 -o body.set.json");
  REQUIRE_MESSAGE(made.status == 0, made.errors);
}

/// Maps of eggs in a row, "a" to "d" with the labels 1 to 4, as three subjects have them: moved, larger, each a little
/// off its place. The first lacks "d", the second "a".
struct SubjectsFolder : TemporaryFolder {
  static Mesh egg(std::size_t k, const Vec3& off_mm, double scale) {
    Mesh one = icosphere(3, 10 + 2 * static_cast<double>(k));
    one.points.col(0) *= 1.3;
    one.points.col(2) *= 0.8;
    one.points.rowwise() += Vec3(44 * static_cast<double>(k), k % 2 == 0 ? 0 : 15, 0).transpose() + off_mm.transpose();
    one.points *= scale;
    return one;
  }

  SubjectsFolder() {
    write("one", 0, 1, {0, 1, 2}, 2);
    write("two", 2, 1.15, {1, 2, 3}, 1.6);
    write("three", -2, 0.95, {0, 1, 2, 3}, 2);
  }

  void write(const std::string& name, double off_mm, double scale, const std::vector<std::size_t>& which,
             double spacing_mm) const {
    VolumeGeometry grid;
    grid.spacing_mm.setConstant(spacing_mm);
    for (int axis = 0; axis < 3; ++axis)
      grid.dims[static_cast<std::size_t>(axis)] = static_cast<int>((axis == 0 ? 200 : 80) * scale / spacing_mm);
    grid.origin_mm = scale * Vec3(-30, -35, -40);
    std::vector<MeshOfSegment> meshes;
    for (const std::size_t k : which)
      meshes.push_back({{.name = std::string(1, static_cast<char>('a' + k)), .value = static_cast<int>(k) + 1},
                        egg(k, Vec3(0, k == 1 ? off_mm : 0, 0), scale)});
    REQUIRE(write_segmentation(map_of_meshes(meshes, grid).map, path / (name + ".seg.nrrd")));
  }
};

Vec3 middle_of_file(const fs::path& file) {
  return read_mesh_file(file).value().points.colwise().mean();
}

}  // namespace

TEST_CASE("a set of several maps has what only a later one has and how each structure lies among them") {
  const SubjectsFolder folder;
  const std::string maps = "one.seg.nrrd two.seg.nrrd three.seg.nrrd ";
  const Ran made = run(folder, "set make " + maps + "--all --vertices 150 -o all.set.json --json --jobs 1");
  REQUIRE_MESSAGE(made.status == 0, made.errors);
  const Json structures = made.json()["structures"];
  REQUIRE(structures.size() == 4);
  CHECK(structures[0]["pose"]["subjects"] == 2);
  CHECK(structures[1]["pose"]["subjects"] == 3);
  CHECK(structures[2]["pose"]["subjects"] == 3);
  CHECK_FALSE(structures[1].contains("from"));
  CHECK(structures[3]["name"] == "d");
  CHECK(structures[3]["from"] == "two.seg.nrrd");
  CHECK(structures[3]["pose"]["subjects"] == 2);
  // "b" lies 2 mm to either side of where it lies in the first, and moves with the others a little.
  const double spread_mm = structures[1]["pose"]["offset_sd_mm"];
  INFO(structures.dump(1));
  CHECK(spread_mm > 1);
  CHECK(spread_mm < 4);
  CHECK(structures[1]["pose"]["scale"].get<double>() == doctest::Approx(1).epsilon(0.05));
  // The second subject is larger and lacks a; "d" lies in the set as beside the others of the first.
  const Vec3 d = middle_of_file(folder.path / "all" / "d.ply");
  MESSAGE("d lies ", (d - Vec3(132, 15, 0)).norm(), " mm from its place");
  CHECK((d - Vec3(132, 15, 0)).norm() < 5);

  REQUIRE(run(folder, "set make " + maps + "--all --vertices 150 -o again.set.json --jobs 2").status == 0);
  for (const char* name : {"a.ply", "d.ply"})
    CHECK(read_whole_file(folder.path / "all" / name).value() == read_whole_file(folder.path / "again" / name).value());
  const Json told = run(folder, "set info all.set.json --json").json()["structures"];
  CHECK(told[1]["pose"] == structures[1]["pose"]);
  CHECK(run(folder, "set info again.set.json --json").json()["structures"][1]["pose"] == structures[1]["pose"]);

  const Ran like = run(folder, "set make " + maps + "--all --like three.seg.nrrd --vertices 150 -o l.set.json --json");
  REQUIRE(like.status == 0);
  for (const Json& one : like.json()["structures"]) CHECK_FALSE(one.contains("from"));
}

TEST_CASE("a consensus set does not depend on which map comes first") {
  const SubjectsFolder folder;
  const auto make = [&](const std::string& maps, const std::string& name, const std::string& jobs) {
    const Ran made = run(folder, "set make " + maps + " --all --consensus --vertices 120 -o " + name +
                                     ".set.json --json --jobs " + jobs);
    REQUIRE_MESSAGE(made.status == 0, made.errors);
    return made.json()["structures"];
  };
  const Json first = make("one.seg.nrrd two.seg.nrrd three.seg.nrrd", "first", "1");
  make("one.seg.nrrd two.seg.nrrd three.seg.nrrd", "same", "2");
  make("three.seg.nrrd one.seg.nrrd two.seg.nrrd", "other", "2");
  REQUIRE(first.size() == 4);
  CHECK(first[1]["subjects"] == 3);
  CHECK(first[3]["subjects"] == 2);
  CHECK(first[1]["pose"]["offset_sd_mm"].get<double>() > 1);
  for (const char* name : {"a.ply", "b.ply", "c.ply", "d.ply"}) {
    CAPTURE(name);
    CHECK(without_record(read_whole_file(folder.path / "first" / name).value()) ==
          without_record(read_whole_file(folder.path / "same" / name).value()));
    const Points one = read_mesh_file(folder.path / "first" / name).value().points;
    const Points two = read_mesh_file(folder.path / "other" / name).value().points;
    CHECK((one - two).rowwise().norm().maxCoeff() < 0.01);
  }
  // Between neighbours there is what there is in the subjects, on average: 44 mm along x, by 1.15, 1 and 0.95.
  const Vec3 way = middle_of_file(folder.path / "first" / "c.ply") - middle_of_file(folder.path / "first" / "b.ply");
  CHECK(way.x() == doctest::Approx(44 * std::cbrt(1.15 * 0.95)).epsilon(0.03));
  const Ran fitted = run(folder, "fit first.set.json --mask two.seg.nrrd -o fits --json");
  REQUIRE(fitted.status == 0);
  for (const Json& one : fitted.json()["cases"][0]["structures"])
    if (!one["missing"].get<bool>()) CHECK(one["dice"].get<double>() > 0.95);
  // People see each structure too.
  const Ran plain = run(folder, "fit first.set.json --mask two.seg.nrrd -o plain");
  CHECK(plain.out.find("\nstructures:\n  case") != std::string::npos);
  CHECK(plain.out.find("confidence") != std::string::npos);
}

TEST_CASE("a consensus takes one organ for one whatever the order of its words, and a vertebra by its level") {
  const SubjectsFolder folder;
  VolumeGeometry grid;
  grid.spacing_mm.setConstant(2);
  grid.dims = {100, 40, 40};
  grid.origin_mm = Vec3(-40, -35, -40);
  const auto write = [&](const std::string& name, const std::string& first, const std::string& second) {
    const std::vector<MeshOfSegment> meshes{{{.name = first, .value = 4}, SubjectsFolder::egg(1, Vec3::Zero(), 1)},
                                            {{.name = second, .value = 5}, SubjectsFolder::egg(2, Vec3::Zero(), 1)}};
    REQUIRE(write_segmentation(map_of_meshes(meshes, grid).map, folder.path / name));
  };
  write("x.seg.nrrd", "left kidney", "L3");
  write("y.seg.nrrd", "Kidney_Left", "vertebrae_L3");
  const Ran made = run(folder, "set make x.seg.nrrd y.seg.nrrd --all --consensus --vertices 120 -o k.set.json --json");
  REQUIRE_MESSAGE(made.status == 0, made.errors);
  const Json structures = made.json()["structures"];
  REQUIRE(structures.size() == 2);
  for (const Json& one : structures) CHECK(one["subjects"] == 2);
  // One label that is asked for by two names is one structure.
  const Ran asked =
      run(folder, "set make x.seg.nrrd --labels \"left kidney,kidney left\" --vertices 120 -o a.set.json");
  CHECK_MESSAGE(asked.status == 0, asked.errors);
}

TEST_CASE("set make of several maps refuses what it cannot use before it fits") {
  const SubjectsFolder folder;
  const auto refused = [&](const std::string& arguments, const std::string& says) {
    const Ran ran = run(folder, "set make " + arguments + " -o x.set.json");
    INFO(ran.errors);
    CHECK(ran.status == 1);
    CHECK(ran.errors.find(says) != std::string::npos);
    CHECK_FALSE(fs::exists(folder.path / "x.set.json"));
  };
  refused("one.seg.nrrd three.seg.nrrd --labels a,spleen", "spleen");
  refused("one.seg.nrrd nothing.nii.gz --all", "nothing.nii.gz");
  refused("one.seg.nrrd ./one.seg.nrrd --all", "is given twice");
  CHECK(run(folder, "set make one.seg.nrrd --all --consensus -o x.set.json").status == 2);
  CHECK(run(folder, "set make one.seg.nrrd two.seg.nrrd --all --consensus --like two.seg.nrrd -o x.set.json").status ==
        2);
  // "d" is in none but the second: that is enough.
  const Ran made = run(folder, "set make one.seg.nrrd two.seg.nrrd --labels b,d --vertices 300 -o x.set.json --json");
  REQUIRE_MESSAGE(made.status == 0, made.errors);
  CHECK(made.json()["structures"].size() == 2);
}

TEST_CASE("set add puts a structure of another map beside its neighbours and refuses what the set has") {
  const SubjectsFolder folder;
  REQUIRE(run(folder, "set make one.seg.nrrd --all --vertices 300 -o s.set.json").status == 0);
  const std::string before = read_whole_file(folder.path / "s.set.json").value();
  const auto refused = [&](const std::string& arguments, const std::string& says) {
    const Ran ran = run(folder, "set add s.set.json " + arguments);
    INFO(ran.errors);
    CHECK(ran.status == 1);
    CHECK(ran.errors.find(says) != std::string::npos);
    CHECK(read_whole_file(folder.path / "s.set.json").value() == before);
  };
  refused("two.seg.nrrd --labels c", "rename it with set rename");
  refused("two.seg.nrrd --labels spleen", "spleen");
  refused("one.seg.nrrd --all", "has no voxel of a structure that the set lacks");
  CHECK(run(folder, "set add s.set.json two.seg.nrrd").status == 2);
  CHECK(run(folder, "set add built-in:spine two.seg.nrrd --labels d").errors.find("-o") != std::string::npos);

  // "c" is called otherwise in a copy, which keeps its value: the next "c" takes another one.
  REQUIRE(run(folder, "set rename s.set.json c other -o t.set.json").status == 0);
  const Ran added = run(folder, "set add s.set.json two.seg.nrrd --labels d --vertices 300 -o u.set.json --json");
  REQUIRE_MESSAGE(added.status == 0, added.errors);
  REQUIRE(added.json()["structures"].size() == 1);
  CHECK(added.json()["structures"][0]["name"] == "d");
  const Json told = run(folder, "set info u.set.json --json").json()["structures"];
  REQUIRE(told.size() == 4);
  CHECK(told[3]["value"] == 4);
  CHECK(told[1]["pose"]["subjects"] == 1);
  const Vec3 d = middle_of_file(folder.path / "u" / "d.ply");
  CHECK((d - Vec3(132, 15, 0)).norm() < 5);
  const Ran again = run(folder, "set add t.set.json one.seg.nrrd --labels c --vertices 300 --json");
  REQUIRE_MESSAGE(again.status == 0, again.errors);
  CHECK(again.json()["structures"][0]["value"] == 4);  // 3 is that of "other"
  CHECK(again.errors.find("has the value 4 in the set") != std::string::npos);
  CHECK(fs::exists(folder.path / "s" / "c.ply"));
  CHECK(fs::exists(folder.path / "t" / "c.ply"));
}

TEST_CASE("set rename gives a name that neighbours and partners follow, in place or elsewhere") {
  const BodyFolder folder;
  REQUIRE(run(folder, "set make body.seg.nrrd --labels kidney_left,kidney_right --vertices 300 -o b.set.json").status ==
          0);
  fs::create_directory(folder.path / "deep");
  REQUIRE(run(folder, "set rename b.set.json Kidney_Left Niere -o deep/n.set.json").status == 0);
  const Json told = run(folder, "set info deep/n.set.json --json").json()["structures"];
  CHECK(told[0]["name"] == "Niere");
  CHECK(told[0]["side"] == "left");
  CHECK(told[0]["vertices"] == 300);
  CHECK(told[1]["partner"] == "Niere");
  CHECK(told[1]["neighbours"] == Json::array({"Niere"}));
  CHECK(run(folder, "set info b.set.json --json").json()["structures"][0]["name"] == "kidney_left");
  REQUIRE(run(folder, "set rename b.set.json kidney_left KIDNEY_LEFT").status == 0);
  CHECK(run(folder, "set info b.set.json --json").json()["structures"][1]["partner"] == "KIDNEY_LEFT");
  for (const auto& [arguments, says] :
       std::vector<std::pair<std::string, std::string>>{{"b.set.json liver Leber", "it has KIDNEY_LEFT, kidney_right"},
                                                        {"b.set.json kidney_left Kidney_Right", "choose another name"},
                                                        {"b.set.json kidney_left ' '", "give a name"},
                                                        {"built-in:spine sacrum S1", "-o"},
                                                        {"none.set.json a b", "does not exist"}}) {
    const Ran ran = run(folder, "set rename " + arguments);
    CHECK(ran.status == 1);
    INFO(ran.errors);
    CHECK(ran.errors.find(says) != std::string::npos);
  }
  REQUIRE(run(folder, "set rename built-in:spine sacrum S1 -o spine.set.json").status == 0);
  CHECK(run(folder, "set info spine.set.json --json").json()["structures"][12]["name"] == "S1");
}

TEST_CASE("set share makes vertices of two structures one in every fit") {
  const TemporaryFolder folder;
  std::vector<MeshOfSegment> meshes;
  TemplateSet set;
  for (const bool above : {true, false}) {
    TemplateOfSet one;
    one.name = above ? "upper" : "lower";
    one.value = above ? 1 : 2;
    one.file = folder.path / (one.name + ".ply");
    REQUIRE(write_mesh(shapes::half_ball(20, above), one.file));
    meshes.push_back({{.name = one.name, .value = one.value}, shapes::half_ball(23, above)});
    set.structures.push_back(std::move(one));
  }
  REQUIRE(write_template_set(set, folder.path / "ball.set.json"));
  VolumeGeometry grid;
  grid.dims = {60, 60, 60};
  grid.origin_mm.setConstant(-29.3);
  REQUIRE(write_segmentation(map_of_meshes(meshes, grid).map, folder.path / "map.seg.nrrd"));
  const Ran shared = run(folder, "set share ball.set.json Upper lower --json");
  REQUIRE_MESSAGE(shared.status == 0, shared.errors);
  CHECK(shared.json()["shared"] == shapes::disc_vertices());
  CHECK(shared.json()["farthest_mm"] == 0);
  CHECK(shared.errors.empty());
  const std::string once = read_whole_file(folder.path / "ball.set.json").value();
  REQUIRE(run(folder, "set share ball.set.json lower upper").status == 0);
  REQUIRE(run(folder, "set share ball.set.json upper lower").status == 0);
  CHECK(read_whole_file(folder.path / "ball.set.json").value() == once);
  REQUIRE(run(folder, "fit ball.set.json --mask map.seg.nrrd -o fits --jobs 1").status == 0);
  REQUIRE(run(folder, "fit ball.set.json --mask map.seg.nrrd -o more --jobs 2").status == 0);
  const Points upper = read_mesh_file(folder.path / "fits" / "map" / "upper.ply").value().points;
  const Points lower = read_mesh_file(folder.path / "fits" / "map" / "lower.ply").value().points;
  CHECK((upper - lower).topRows(shapes::disc_vertices()).rowwise().norm().maxCoeff() < 1e-6);
  CHECK(read_whole_file(folder.path / "fits" / "map" / "lower.ply").value() ==
        read_whole_file(folder.path / "more" / "map" / "lower.ply").value());
  const std::string of_case = read_whole_file(folder.path / "fits" / "map.homolog").value();
  CHECK(of_case.find(R"("shared":[{"with":"s)") != std::string::npos);
  CHECK(of_case.find("\"0:0 1:1 2:2 ") != std::string::npos);
  for (const auto& [arguments, says] : std::vector<std::pair<std::string, std::string>>{
           {"ball.set.json upper upper", "name another one"},
           {"ball.set.json upper liver", "it has upper, lower"},
           {"built-in:spine vertebrae_L3 sacrum", "-o"},
           {"built-in:spine vertebrae_L3 vertebrae_T12 -o s.set.json", "--within-mm"}}) {
    const Ran ran = run(folder, "set share " + arguments);
    INFO(ran.errors);
    CHECK(ran.status == 1);
    CHECK(ran.errors.find(says) != std::string::npos);
  }
  // What does not quite coincide is said.
  Mesh off = read_mesh(folder.path / "lower.ply").value();
  off.points.col(0).array() += 0.25;
  REQUIRE(write_mesh(off, folder.path / "lower.ply"));
  const Ran near = run(folder, "set share ball.set.json lower upper -o near.set.json --json");
  REQUIRE_MESSAGE(near.status == 0, near.errors);
  CHECK(near.json()["shared"].get<int>() > 0);
  CHECK(near.errors.find("lower and upper: vertices that lie up to 0.25 mm apart become one") != std::string::npos);
  // A template that was made anew since has fewer vertices: the fit goes on without.
  REQUIRE(write_mesh(shapes::half_ball(20, true, 4, 12), folder.path / "upper.ply"));
  const Ran fitted = run(folder, "fit ball.set.json --mask map.seg.nrrd -o less");
  CHECK(fitted.status == 0);
  CHECK(fitted.errors.find("declare them anew") != std::string::npos);
}

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

TEST_CASE("what reading says of a map is said once and is no structure's warning") {
  const TemporaryFolder folder;
  VolumeGeometry grid;
  grid.spacing_mm.setConstant(2);
  grid.dims = {80, 40, 40};
  grid.origin_mm = Vec3(-40, -40, -40);
  VolumeRead map = map_of_meshes({{{.name = "a", .value = 1}, SubjectsFolder::egg(0, Vec3::Zero(), 1)},
                                  {{.name = "b", .value = 2}, SubjectsFolder::egg(1, Vec3::Zero(), 1)},
                                  {{.name = "lesion", .value = 1, .layer = 1}, icosphere(3, 6)}},
                                 grid)
                       .map;
  REQUIRE(write_segmentation(map, folder.path / "layers.seg.nrrd"));
  const auto is_said = [](const Json& structures, const std::string& what) {
    return std::ranges::any_of(structures, [&](const Json& one) {
      return one["warning"].is_string() && one["warning"].get<std::string>().find(what) != std::string::npos;
    });
  };
  const Ran layered = run(folder, "set make layers.seg.nrrd --all --vertices 150 -o layers.set.json --json");
  REQUIRE_MESSAGE(layered.status == 0, layered.errors);
  CHECK(layered.json()["structures"].size() == 3);
  CHECK(layered.errors.find("layers, not frames") == std::string::npos);  // all are taken
  CHECK_FALSE(is_said(layered.json()["structures"], "layers"));
  const Ran fitted = run(folder, "fit layers.set.json --mask layers.seg.nrrd -o fits");
  CHECK(fitted.errors.find("layers, not frames") == std::string::npos);

  // Values that are no whole numbers are said of the map.
  std::vector<float> values;
  std::visit([&](const auto& voxels) { values.assign(voxels.begin(), voxels.end()); }, map.volume.data);
  values[0] = 1.3F;
  map.volume.data = std::move(values);
  map.other_layers.clear();
  std::erase_if(map.segmentation.segments, [](const Segment& segment) { return segment.layer == 1; });
  REQUIRE(write_segmentation(map, folder.path / "real.nii.gz"));
  const Ran made = run(folder, "set make real.nii.gz --all --vertices 150 -o real.set.json --json");
  REQUIRE_MESSAGE(made.status == 0, made.errors);
  const auto first = made.errors.find("no whole numbers");
  REQUIRE(first != std::string::npos);
  CHECK(made.errors.find("no whole numbers", first + 1) == std::string::npos);
  CHECK_FALSE(is_said(made.json()["structures"], "whole numbers"));
  // `template` says it as before.
  const Ran alone = run(folder, "template real.nii.gz --label a --vertices 150 -o a.ply");
  CHECK(alone.errors.find("no whole numbers") != std::string::npos);
}

TEST_CASE("a set writes over no file of others and names what only its old one had") {
  const BodyFolder folder;
  const fs::path own = folder.path / "own" / "b";
  fs::create_directories(own);
  REQUIRE(write_whole_file(own / "kidney_left.ply", "precious"));
  const std::string make = "set make body.seg.nrrd --vertices 300 -o own/b.set.json --labels ";
  check_refused(run(folder, make + "kidney_left,kidney_right"), "kidney_left.ply");
  CHECK(read_whole_file(own / "kidney_left.ply").value() == "precious");
  CHECK_FALSE(fs::exists(own / "kidney_right.ply"));
  CHECK_FALSE(fs::exists(folder.path / "own" / "b.set.json"));
  fs::rename(own / "kidney_left.ply", own / "mine.ply");

  // What the old set names is its own.
  REQUIRE(run(folder, make + "kidney_left,kidney_right").status == 0);
  const Ran again = run(folder, make + "kidney_left,kidney_right");
  REQUIRE_MESSAGE(again.status == 0, again.errors);
  const Ran fewer = run(folder, make + "kidney_right");
  REQUIRE_MESSAGE(fewer.status == 0, fewer.errors);
  CHECK(fewer.errors.find("holds kidney_left.ply, which only the set before had") != std::string::npos);
  CHECK(fs::exists(own / "kidney_left.ply"));  // a case may have it
  CHECK(fs::exists(own / "kidney_right.ply"));
  CHECK(read_whole_file(own / "mine.ply").value() == "precious");
  REQUIRE(write_whole_file(own / "kidney_left.ply", "precious"));
  check_refused(run(folder, "set add own/b.set.json body.seg.nrrd --labels kidney_left"), "kidney_left.ply");
  // Neither does a command that was killed between its templates and its set: the same one goes on.
  REQUIRE(run(folder, "set make body.seg.nrrd --labels kidney_right --vertices 300 -o own/k.set.json").status == 0);
  REQUIRE(fs::remove(folder.path / "own" / "k.set.json"));
  check_refused(run(folder, "set make body.seg.nrrd --labels kidney_right --vertices 400 -o own/k.set.json"),
                "kidney_right.ply");
  CHECK(run(folder, "set make body.seg.nrrd --labels kidney_right --vertices 300 -o own/k.set.json").status == 0);
  // A set that cannot be written leaves no templates behind, which would be in the way of the next try.
  fs::create_directories(folder.path / "own" / "c.set.json" / "full");
  CHECK(run(folder, "set make body.seg.nrrd --labels kidney_left --vertices 300 -o own/c.set.json").status == 1);
  CHECK_FALSE(fs::exists(folder.path / "own" / "c" / "kidney_left.ply"));
}

TEST_CASE("fit takes a set: a mesh for each structure and one label map") {
  const BodyFolder folder;
  make_set_of_kidneys(folder);
  const Ran fitted = run(folder, "fit body.set.json --mask body.seg.nrrd -o fits --json");
  REQUIRE(fitted.status == 0);
  CHECK(fitted.errors.find("speck") != std::string::npos);  // for which the set has no template
  const Json report = fitted.json();
  REQUIRE(report["cases"].size() == 1);
  const Json& one = report["cases"][0];
  CHECK(one["name"] == "body");
  CHECK(one["overlap_voxels"] == 0);
  REQUIRE(one["structures"].size() == 2);
  for (const Json& structure : one["structures"]) {
    CHECK(structure["dice"].get<double>() > 0.97);
    CHECK(structure["assd_mm"].get<double>() < 0.6);
    CHECK(structure["confidence"].get<double>() > 0.5);
    CHECK(structure["doubtful"] == false);
    CHECK(structure["missing"] == false);
  }
  CHECK(fs::exists(folder.path / "fits" / "body" / "kidney_left.ply"));
  CHECK(report["study"] == "fits/fits.study.json");
  const auto study = read_study(folder.path / "fits" / "fits.study.json");
  REQUIRE(study);
  REQUIRE(study->study.cases.size() == 1);
  CHECK(study->warnings.empty());
  CHECK(study->study.cases[0].doubt.empty());
  const auto kept = read_case(study->study.cases[0].file);
  REQUIRE(kept);
  const Document& document = kept->session.document();
  REQUIRE(document.structures.size() == 2);
  for (std::size_t k = 0; k < 2; ++k) {
    const Structure& structure = *document.structures[k];
    const auto mesh = read_mesh_file(folder.path / "fits" / "body" / (structure.name + ".ply"));
    REQUIRE(mesh);
    CHECK((*structure.shape(0)->points - mesh->points).cwiseAbs().maxCoeff() < 1e-4);  // what a case keeps of a place
    CHECK(structure.confidence == doctest::Approx(one["structures"][k]["confidence"].get<double>()));
    CHECK(structure.colour.has_value());
    CHECK(structure.doubt.empty());
  }
  const Ran told = run(folder, "info fits/body.seg.nrrd --json");
  REQUIRE(told.status == 0);
  const Json labels = told.json()["labels"];
  REQUIRE(labels.size() == 2);
  CHECK(labels[0]["name"] == "kidney_left");
  CHECK(labels[0]["value"] == 3);
  CHECK(labels[1]["value"] == 5);
  // The balls of 20 mm hold 33.5 ml each.
  CHECK(labels[1]["volume_ml"].get<double>() == doctest::Approx(33.5).epsilon(0.03));
}

TEST_CASE("a fit of a set has the same bytes whatever the threads, and a case that fails leaves the others") {
  const BodyFolder folder;
  make_set_of_kidneys(folder);
  fs::copy(folder.path / "body.seg.nrrd", folder.path / "other.seg.nrrd");
  REQUIRE(write_whole_file(folder.path / "torn.nii.gz", "no volume"));
  const Ran many =
      run(folder, "fit body.set.json --mask torn.nii.gz body.seg.nrrd other.seg.nrrd -o many --json --jobs 2");
  REQUIRE(many.status == 0);
  const Json report = many.json();
  CHECK(report["fitted"] == 2);
  CHECK(report["failed"] == 1);
  CHECK(report["cases"][0]["error"].get<std::string>().find("torn.nii.gz") != std::string::npos);
  REQUIRE(run(folder, "fit body.set.json --mask other.seg.nrrd -o one --jobs 1").status == 0);
  for (const char* name : {"other/kidney_left.ply", "other/kidney_right.ply", "other.seg.nrrd"})
    CHECK(read_whole_file(folder.path / "many" / name).value() == read_whole_file(folder.path / "one" / name).value());
}

TEST_CASE("a fit of a set refuses a folder whose study is of another set") {
  const BodyFolder folder;
  make_set_of_kidneys(folder);
  REQUIRE(
      run(folder, "set make body.seg.nrrd --labels kidney_left,kidney_right --vertices 300 -o other.set.json").status ==
      0);
  REQUIRE(run(folder, "fit body.set.json --mask body.seg.nrrd -o fits").status == 0);
  const Ran other = run(folder, "fit other.set.json --mask body.seg.nrrd -o fits");
  check_refused(other, "fits/fits.study.json");
  CHECK(other.errors.find("which has other faces than the templates of other.set.json; give the set that it was made "
                          "with, or another folder") != std::string::npos);
  CHECK(read_mesh_file(folder.path / "fits/body/kidney_left.ply").value().points.rows() == 400);
  CHECK(run(folder, "fit body.set.json --mask body.seg.nrrd -o fits").status == 0);
}

TEST_CASE("maps of one name in several folders are cases with the names of their folders") {
  const BodyFolder folder;
  make_set_of_kidneys(folder);
  for (const char* name : {"p1", "p2"}) {
    fs::create_directory(folder.path / name);
    fs::copy(folder.path / "body.seg.nrrd", folder.path / name / "seg.seg.nrrd");
  }
  const Ran fitted = run(folder, "fit body.set.json --mask p1/seg.seg.nrrd p2/seg.seg.nrrd body.seg.nrrd -o g --json");
  REQUIRE_MESSAGE(fitted.status == 0, fitted.errors);
  const Json cases = fitted.json()["cases"];
  CHECK(cases[0]["name"] == "p1-seg");
  CHECK(cases[1]["name"] == "p2-seg");
  CHECK(cases[2]["name"] == "body");  // nobody has its name
  for (const char* file : {"p1-seg/kidney_left.ply", "p2-seg.seg.nrrd", "p2-seg.homolog"}) {
    CAPTURE(file);
    CHECK(fs::exists(folder.path / "g" / file));
    const Ran again = run(folder, std::string("verify g/") + file + " --inputs .");
    CHECK_MESSAGE(again.status == 0, again.errors);
  }
  CHECK(test::must(read_study(folder.path / "g" / "g.study.json")).study.cases[1].name == "p2-seg");

  const Ran mended = run(folder, "repair p1/seg.seg.nrrd p2/seg.seg.nrrd --templates body.set.json -o out --json");
  REQUIRE_MESSAGE(mended.status == 0, mended.errors);
  CHECK(mended.json()["cases"][1]["name"] == "p2-seg");
  CHECK(fs::exists(folder.path / "out" / "p1-seg.seg.nrrd"));
  CHECK(fs::exists(folder.path / "out" / "p2-seg.seg.nrrd"));

  const Ran twice = run(folder, "fit body.set.json --mask body.seg.nrrd ./body.seg.nrrd -o h");
  check_refused(twice, "is given twice");
  fs::copy(folder.path / "body.nrrd", folder.path / "p1" / "seg.nrrd");
  check_refused(run(folder, "fit body.set.json --mask p1/seg.seg.nrrd p1/seg.nrrd -o h"), "rename one");
}

TEST_CASE("a joint model takes a case that was worked on after the fit in place of its meshes") {
  const BodyFolder folder;
  REQUIRE(run(folder, "set make body.seg.nrrd --labels kidney_left,kidney_right --vertices 300 -o k.set.json").status ==
          0);
  fs::copy(folder.path / "body.seg.nrrd", folder.path / "twin.seg.nrrd");
  REQUIRE(run(folder, "fit k.set.json --mask body.seg.nrrd twin.seg.nrrd -o fits").status == 0);
  const std::string both = " --structures kidney_left,kidney_right --no-align -o ";
  const Ran same = run(folder, "model fits" + both + "m.h5");
  CHECK(same.status == 1);
  CHECK(same.errors.find("is the same shape as all others") != std::string::npos);

  // 6 mm at one place of the second structure, 2 mm at one of the first.
  const fs::path edited = folder.path / "fits/twin.homolog";
  const auto read = test::must(read_case(edited));
  const Document& document = read.session.document();
  REQUIRE(document.structures.size() == 2);
  // The case knows where its structures lie in the map, as one that the window fitted does.
  const auto in_map = read.session.kept().map_fit;
  REQUIRE(in_map);
  REQUIRE(in_map->structures.size() == 2);
  for (const auto& structure : document.structures) {
    const InFittedMap& in = in_map->structures.at(structure->id);
    CHECK(in.name == structure->name);
    CHECK(in.value == (in.name == "kidney_left" ? 3 : 5));
    CHECK(in.mesh == mesh_hash(*structure->shapes.begin()->second->points));
    CHECK(in.p_named > 0.5);
  }
  std::string lines_of_case = read_whole_file(edited).value();
  for (const std::size_t k : {0, 1}) {
    const Vec3 at = document.structures[k]->shapes.begin()->second->points->row(7);
    const double up_mm = k == 0 ? 2 : 6;
    Json pull{{"tool", "pull"}, {"at", {at.x(), at.y(), at.z()}}, {"to", {at.x(), at.y(), at.z() + up_mm}}};
    pull.update({{"sigma_mm", 8}, {"of", document.structures[k]->id}});
    lines_of_case += pull.dump() + "\n";
  }
  REQUIRE(write_whole_file(edited, lines_of_case));
  const Ran ran = run(folder, "model fits" + both + "m.h5 --csv tables --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  CHECK(ran.json()["shapes"] == 2);
  for (const std::string cases : {"fits/body.homolog fits/twin.homolog", "fits/fits.study.json"}) {
    CAPTURE(cases);
    const Ran named = run(folder, "model " + cases + both + "n.h5 --csv others");
    REQUIRE_MESSAGE(named.status == 0, named.errors);
    const auto variance = [&](const char* table) {
      const std::string text = read_whole_file(folder.path / table / "variances.csv").value();
      return std::stod(text.substr(text.find("\n1,") + 3));
    };
    CHECK(variance("others") == doctest::Approx(variance("tables")).epsilon(1e-5));  // a case keeps its fit in float
  }
  const std::vector<std::string> names{"kidney_left", "kidney_right"};
  const auto cases = structure_files({folder.path / "fits"}, names);
  REQUIRE(cases);
  CHECK((*cases)[0].of_structure[1].file.filename() == "kidney_right.ply");
  CHECK((*cases)[1].of_structure[0].file.filename() == "twin.homolog");
  for (const std::size_t k : {0, 1}) {
    const auto moved = read_shape((*cases)[1].of_structure[k]), before = read_shape((*cases)[0].of_structure[k]);
    REQUIRE(moved);
    REQUIRE(before);
    CHECK(((*moved)->points - (*before)->points).row(7).norm() == doctest::Approx(k == 0 ? 2 : 6).epsilon(0.05));
  }

  // The case stands for the folder of its meshes, whichever of them is named, and in any order.
  const fs::path fits = folder.path / "fits", meshes = fits / "twin";
  for (const auto& given : {std::vector{meshes}, {meshes / ""}, {edited, meshes}, {meshes, edited}}) {
    const auto one = structure_files(given, names);
    REQUIRE(one);
    REQUIRE(one->size() == 1);
    CHECK(one->front().of_structure[0].file.filename() == "twin.homolog");
  }
  // What was removed from it does not come back from the folder.
  REQUIRE(write_whole_file(edited, lines_of_case + "{\"remove_structure\":\"" + document.structures[1]->id + "\"}\n"));
  const auto fewer = structure_files({fits}, names);
  REQUIRE(fewer);
  CHECK((*fewer)[1].of_structure[1].file.empty());
  REQUIRE(write_whole_file(edited, lines_of_case));

  // A study says which cases wait, and which are flipped.
  Json study = Json::parse(read_whole_file(fits / "fits.study.json").value());
  for (Json& one : study["cases"]) one["flipped"] = true;
  REQUIRE(write_whole_file(fits / "fits.study.json", study.dump()));
  const auto flipped = structure_files({fits / "fits.study.json"}, names);
  REQUIRE(flipped);
  CHECK((*flipped)[0].of_structure[1].flipped);
  // A score takes them as the model does, which holds both of its two shapes whole.
  REQUIRE(run(folder, "model fits/fits.study.json" + both + "f.h5").status == 0);
  const Json scores = run(folder, "score fits/fits.study.json --model f.h5 --json").json()["subjects"];
  REQUIRE(scores.size() == 2);
  CHECK(scores[1]["name"] == "twin");
  CHECK(scores[1]["residual_mm"].get<double>() < 1e-3);
  const Json unflipped = run(folder, "score fits/twin.homolog --model f.h5 --json").json()["subjects"][0];
  CHECK(unflipped["residual_mm"].get<double>() > 1);
  study["cases"][0]["from_scan"] = true;
  study["cases"][0]["state"] = "to do";
  REQUIRE(write_whole_file(fits / "fits.study.json", study.dump()));
  CHECK(test::must(structure_files({fits / "fits.study.json"}, names)).size() == 1);
  study["cases"][0] = {{"name", "mesh"}, {"file", "twin/kidney_left.ply"}};
  REQUIRE(write_whole_file(fits / "fits.study.json", study.dump()));
  CHECK(run(folder, "model fits/fits.study.json" + both + "n.h5").errors.find("holds one structure") !=
        std::string::npos);
}

TEST_CASE("a fit of a set refuses what it cannot use, in a sentence") {
  const BodyFolder folder;
  make_set_of_kidneys(folder);
  CHECK(run(folder, "fit body.set.json --mask body.seg.nrrd -o fits --partial").status == 2);
  CHECK(run(folder, "fit body.set.json --mask body.seg.nrrd -o fits.ply").status == 2);
  CHECK(run(folder, "fit body.set.json -o fits").status == 2);
  const Ran meant = run(folder, "fit spine --mask body.seg.nrrd -o fits");
  CHECK(meant.status == 1);
  CHECK(meant.errors.find("built-in:spine is one") != std::string::npos);
  // One template is gone: the other is fitted.
  fs::remove(folder.path / "body" / "kidney_left.ply");
  const Ran one = run(folder, "fit body.set.json --mask body.seg.nrrd -o fits --json");
  CHECK(one.status == 0);
  CHECK(one.errors.find("kidney_left.ply") != std::string::npos);
  CHECK(one.json()["cases"][0]["structures"][1]["dice"].get<double>() > 0.97);
  // Both are gone.
  fs::remove(folder.path / "body" / "kidney_right.ply");
  const Ran none = run(folder, "fit body.set.json --mask body.seg.nrrd -o fits");
  CHECK(none.status == 1);
  CHECK(none.errors.find("no template that can be read") != std::string::npos);
}

TEST_CASE("a folder of single masks, each on a grid of its own, is one case of a set") {
  const BodyFolder folder;
  make_set_of_kidneys(folder);
  fs::create_directories(folder.path / "subject");
  for (const double x_mm : {0.0, 44.0}) {
    Mesh ball = icosphere(4, 20);
    ball.points.col(0).array() += x_mm;
    VolumeGeometry grid;
    grid.dims = {26, 26, 26};
    grid.spacing_mm.setConstant(2);
    grid.origin_mm = Vec3(x_mm - 25, -25, -25);
    REQUIRE(write_volume(label_map(ball, grid),
                         folder.path / "subject" / (x_mm == 0 ? "kidney_left.nii.gz" : "kidney_right.nii.gz")));
  }
  const Ran fitted = run(folder, "fit body.set.json --mask subject -o fits --json");
  REQUIRE(fitted.status == 0);
  const Json report = fitted.json();
  REQUIRE(report["cases"].size() == 1);
  CHECK(report["cases"][0]["name"] == "subject");
  for (const Json& structure : report["cases"][0]["structures"]) CHECK(structure["dice"].get<double>() > 0.97);
  // The map that is written holds both, though no file's grid does.
  const Ran told = run(folder, "info fits/subject.seg.nrrd --json");
  const Json labels = told.json()["labels"];
  REQUIRE(labels.size() == 2);
  for (const Json& label : labels) CHECK(label["volume_ml"].get<double>() == doctest::Approx(33.5).epsilon(0.03));
}

TEST_CASE("soft masks in a folder are surfaces at their level, for a set and for one structure") {
  const TemporaryFolder folder;
  constexpr double radius_mm = 20;
  for (const char* kind : {"soft", "hard"}) {
    fs::create_directory(folder.path / kind);
    for (const double x_mm : {0.0, 44.0}) {
      Volume ball;
      ball.geometry.dims = {15, 15, 15};
      ball.geometry.spacing_mm.setConstant(4);
      ball.geometry.origin_mm = Vec3(x_mm - 28, -28, -28);
      constexpr int parts = 6;
      std::vector<float> shares;
      for (int k = 0; k < 15; ++k)
        for (int j = 0; j < 15; ++j)
          for (int i = 0; i < 15; ++i) {
            int in = 0;
            for (int n = 0; n < parts * parts * parts; ++n) {
              const Vec3 within(n % parts, n / parts % parts, n / parts / parts);
              const Vec3 p = ball.geometry.to_mm(Vec3(i, j, k) + (within - Vec3::Constant(2.5)) / parts);
              in += (p - Vec3(x_mm, 0, 0)).norm() < radius_mm ? 1 : 0;
            }
            const float share = static_cast<float>(in) / (parts * parts * parts);
            shares.push_back(std::string_view(kind) == "soft" ? share : std::rint(share));
          }
      ball.data = std::move(shares);
      ball.range_max = 1;
      REQUIRE(write_volume(ball, folder.path / kind / (x_mm == 0 ? "left.nii.gz" : "right.nii.gz")));
    }
  }
  const auto off_mm = [&](const std::string& mesh) {
    const Points points = read_mesh_file(folder.path / mesh).value().points;
    return (points.rowwise().norm().array() - radius_mm).abs().mean();
  };
  const Ran made = run(folder, "set make soft --all --vertices 400 -o balls.set.json");
  REQUIRE_MESSAGE(made.status == 0, made.errors);
  CHECK(made.errors.find("whole numbers") == std::string::npos);
  const Ran fitted = run(folder, "fit balls.set.json --mask soft hard -o fits");
  REQUIRE_MESSAGE(fitted.status == 0, fitted.errors);
  CHECK(fitted.errors.find("whole numbers") == std::string::npos);
  MESSAGE("off the ball: ", off_mm("fits/soft/left.ply"), " mm soft, ", off_mm("fits/hard/left.ply"), " mm hard");
  CHECK(off_mm("fits/soft/left.ply") < 0.8 * off_mm("fits/hard/left.ply"));
  // So is one of them for verbs that take a label.
  const Ran one = run(folder, "template soft --label left --vertices 400 -o one.ply");
  REQUIRE_MESSAGE(one.status == 0, one.errors);
  REQUIRE(run(folder, "template hard --label left --vertices 400 -o voxels.ply").status == 0);
  MESSAGE("templates: ", off_mm("one.ply"), " mm soft, ", off_mm("voxels.ply"), " mm hard");
  CHECK(off_mm("one.ply") < 0.8 * off_mm("voxels.ply"));
  const Ran other = run(folder, "template soft --label left --level 0.4 -o two.ply");
  check_refused(other, "name one file of it");
  // So are those of a consensus.
  for (const std::string kind : {"soft", "hard"}) {
    fs::copy(folder.path / kind, folder.path / (kind + "2"));
    const Ran of_two = run(
        folder, "set make " + kind + " " + kind + "2 --all --consensus --vertices 400 -o mean-" + kind + ".set.json");
    REQUIRE_MESSAGE(of_two.status == 0, of_two.errors);
  }
  MESSAGE("consensus: ", off_mm("mean-soft/left.ply"), " mm soft, ", off_mm("mean-hard/left.ply"), " mm hard");
  CHECK(off_mm("mean-soft/left.ply") < 0.8 * off_mm("mean-hard/left.ply"));
}

TEST_CASE("a name that two labels have is left out of a set and of a fit with both values, and the rest goes on") {
  const BodyFolder folder;
  make_set_of_kidneys(folder);
  VolumeRead doubled = test::must(read_volume(folder.path / "body.seg.nrrd"));
  for (Segment& segment : doubled.segmentation.segments)
    if (segment.name == "speck") segment.name = "Kidney_Left";
  REQUIRE(write_segmentation(doubled, folder.path / "doubled.seg.nrrd"));
  const Ran made = run(folder, "set make doubled.seg.nrrd --all --vertices 400 -o doubled.set.json --json");
  REQUIRE_MESSAGE(made.status == 0, made.errors);
  CHECK(made.json()["structures"].size() == 1);
  CHECK(made.json()["structures"][0]["name"] == "kidney_right");
  CHECK(made.errors.find("named \"kidney_left\", the labels 3 and 9; they are left out") != std::string::npos);
  const Ran fitted = run(folder, "fit body.set.json --mask doubled.seg.nrrd -o fits --json");
  REQUIRE_MESSAGE(fitted.status == 0, fitted.errors);
  CHECK(fitted.errors.find("kidney_left is left out: the labels 3 and 9 both have its name") != std::string::npos);
  const Json rows = fitted.json()["cases"][0]["structures"];
  CHECK(rows[0]["missing"] == false);
  CHECK(rows[0]["doubtful"] == true);
  CHECK(rows[0]["dice"].is_null());
  CHECK(rows[1]["dice"].get<double>() > 0.97);
  const Ran mended = run(folder, "repair doubled.seg.nrrd --templates body.set.json -o out --json");
  REQUIRE_MESSAGE(mended.status == 0, mended.errors);
  CHECK(mended.errors.find("kidney_left is left as it is: the labels 3 and 9") != std::string::npos);
  CHECK(mended.json()["cases"][0]["structures"][0]["changed_voxels"] == 0);
}

TEST_CASE("a map of FreeSurfer is mended in its own format, and label maps are written so") {
  const BodyFolder folder;
  make_set_of_kidneys(folder);
  const Ran converted = run(folder, "convert body.seg.nrrd body.mgz");
  REQUIRE_MESSAGE(converted.status == 0, converted.errors);
  const Json labels = run(folder, "info body.mgz --json").json()["labels"];
  REQUIRE(labels.size() == 3);
  CHECK(labels[0]["name"] == "kidney_left");
  CHECK(labels[0]["colour"] == run(folder, "info body.seg.nrrd --json").json()["labels"][0]["colour"]);
  const Ran mended = run(folder, "repair body.mgz --templates body.set.json -o out --json");
  REQUIRE_MESSAGE(mended.status == 0, mended.errors);
  CHECK(mended.json()["cases"][0]["file"] == "out/body.mgz");
  CHECK(mended.errors.find("its format is not written") == std::string::npos);
  CHECK(test::must(read_volume(folder.path / "out/body.mgz")).segmentation.find(5)->name == "kidney_right");
  const Ran again = run(folder, "verify out/body.mgz --inputs .");
  CHECK_MESSAGE(again.status == 0, again.errors);
  const Ran mesh = run(folder, "label-map body/kidney_left.ply --like body.mgz -o kidney.mgz");
  REQUIRE_MESSAGE(mesh.status == 0, mesh.errors);
  CHECK(labels_of(test::must(read_volume(folder.path / "kidney.mgz")).volume).contains(1));
}

TEST_CASE("a structure that repair puts in goes into the worklist") {
  const SubjectsFolder folder;
  REQUIRE(run(folder, "set make three.seg.nrrd --all --vertices 150 -o eggs.set.json").status == 0);
  VolumeRead map = test::must(read_volume(folder.path / "three.seg.nrrd"));
  std::visit(
      [](auto& voxels) {
        for (auto& voxel : voxels)
          if (voxel == 2) voxel = 0;
      },
      map.volume.data);
  REQUIRE(write_segmentation(map, folder.path / "lacks.seg.nrrd"));
  const Ran mended = run(folder, "repair lacks.seg.nrrd --templates eggs.set.json -o out --json");
  REQUIRE_MESSAGE(mended.status == 0, mended.errors);
  const Json of_mended = mended.json()["cases"][0]["structures"][1];
  CHECK(of_mended["name"] == "b");
  CHECK(of_mended["changed_voxels"].get<int>() > 300);
  const fs::path put_in = folder.path / "out" / "lacks-cases" / "lacks-b.homolog";
  REQUIRE(fs::exists(put_in));
  const Study study = test::must(read_study(folder.path / "out" / "worklist.study.json")).study;
  const auto in_study = std::ranges::find_if(study.cases, [](const StudyCase& one) { return one.name == "lacks-b"; });
  REQUIRE(in_study != study.cases.end());
  CHECK(in_study->doubt == "Found: missing.");
}

TEST_CASE("repair names a map that is empty, has nothing of the set or misses the image, and goes on with the rest") {
  const BodyFolder folder;
  make_set_of_kidneys(folder);
  VolumeRead map = test::must(read_volume(folder.path / "body.seg.nrrd"));
  VolumeRead empty = map;
  std::visit([](auto& voxels) { std::ranges::fill(voxels, 0); }, empty.volume.data);
  REQUIRE(write_segmentation(empty, folder.path / "empty.seg.nrrd"));
  VolumeRead others = map;
  for (Segment& segment : others.segmentation.segments) segment.name = "other " + std::to_string(segment.value);
  REQUIRE(write_segmentation(others, folder.path / "others.seg.nrrd"));
  const Ran mended =
      run(folder, "repair empty.seg.nrrd others.seg.nrrd body.seg.nrrd --templates body.set.json -o out --json");
  REQUIRE_MESSAGE(mended.status == 0, mended.errors);
  CHECK(mended.json()["repaired"] == 1);
  CHECK(mended.json()["failed"] == 2);
  const Json cases = mended.json()["cases"];
  CHECK(cases[0]["error"].get<std::string>() ==
        "empty.seg.nrrd: holds no label; give a label map in which there is one");
  CHECK(cases[1]["error"].get<std::string>().find(
            "others.seg.nrrd: holds no structure of the set; its labels: other 3") == 0);
  CHECK(cases[1]["error"].get<std::string>().find("; those of the set: kidney_left, kidney_right; give the map") !=
        std::string::npos);
  CHECK_FALSE(cases[2].contains("error"));
  CHECK_FALSE(fs::exists(folder.path / "out" / "empty.seg.nrrd"));
  Volume scan = map.volume;
  scan.geometry.origin_mm.x() -= 2000;
  REQUIRE(write_volume(scan, folder.path / "scan.nrrd"));
  const Ran away = run(folder, "repair body.seg.nrrd --templates body.set.json --image scan.nrrd -o away");
  CHECK(away.status == 1);
  CHECK(away.errors.find("body.seg.nrrd: lies 18") != std::string::npos);
  CHECK(away.errors.find("mm outside of scan.nrrd; give the scan that it is of") != std::string::npos);
}

TEST_CASE("the laboratory judges repair on label maps that it made wrong") {
  const BodyFolder folder;
  make_set_of_kidneys(folder);
  const Ran made = run_lab(folder, "corrupt body.seg.nrrd --kinds island --count 3 --seed 4 -o broken");
  REQUIRE_MESSAGE(made.status == 0, made.errors);
  const Ran judged = run_lab(folder, "repairs broken/planted.json --templates body.set.json -o judged --json");
  REQUIRE_MESSAGE(judged.status == 0, judged.errors);
  const Json report = judged.json();
  CHECK(report["maps"] == 3);
  CHECK(report["structures"] == 6);
  CHECK(report["sound_voxels_changed"] == 0);
  REQUIRE(report["kinds"].size() == 1);
  const Json& islands = report["kinds"][0];
  CHECK(islands["kind"] == "island");
  CHECK(islands["planted"].get<int>() >= 1);  // of the speck, too, one may be made
  CHECK(islands["found"] == islands["planted"]);
  CHECK(islands["false_alarms"] == 0);
  CHECK(islands["dice_before"].get<double>() < 1);
  CHECK(islands["dice_after"] == 1.0);
  const std::string table = read_whole_file(folder.path / "judged/structures.csv").value();
  CHECK(lines(table) == 7);
  check_refused(run_lab(folder, "repairs body.set.json --templates body.set.json -o judged"), "lists no label maps");
}

TEST_CASE("repair counts a sixth lumbar vertebra as a variant, and fills nothing in") {
  const TemporaryFolder folder;
  REQUIRE(run(folder, "phantom spine --subject 4 -o .").status == 0);
  const Ran sound = run(folder, "repair spine-4-labels.nii.gz --templates built-in:spine -o sound --json");
  REQUIRE_MESSAGE(sound.status == 0, sound.errors);
  const Json of_sound = sound.json()["cases"][0];
  for (const Json& row : of_sound["structures"]) {
    CHECK(row["changed_voxels"] == 0);
    CHECK(row["defects"].empty());
  }
  std::vector<std::string> names;
  for (const Json& one : of_sound["variants"]) names.push_back(one["name"]);
  std::ranges::sort(names);
  CHECK(names == std::vector<std::string>{"disc_L5_L6", "disc_L5_S1", "disc_L6_S1", "vertebrae_L6"});
  for (const Json& one : of_sound["variants"]) CHECK(one["value"].is_null() == (one["name"] == "disc_L5_S1"));
  CHECK(sound.errors.find("between vertebrae_L5 and sacrum, and so no disc_L5_S1; this is a variant") !=
        std::string::npos);
  CHECK_FALSE(sound.json().contains("study"));
}

TEST_CASE("the built-in set is told without a file and its templates are taken by their names") {
  const TemporaryFolder folder;
  const Ran told = run(folder, "set info built-in:spine --json");
  REQUIRE_MESSAGE(told.status == 0, told.errors);
  const Json structures = told.json()["structures"];
  REQUIRE(structures.size() == 13);
  CHECK(structures[0]["name"] == "vertebrae_T12");
  CHECK(structures[12]["name"] == "sacrum");
  for (const Json& one : structures) {
    CAPTURE(one["name"]);
    CHECK(one["warning"].is_null());
    CHECK(one["vertices"].get<int>() > 900);
    CHECK(one["neighbours"].size() >= 2);
  }
  CHECK(run(folder, "set info built-in:liver").errors.find("choose built-in:spine") != std::string::npos);
  REQUIRE(run(folder, "phantom spine --subject 1 -o .").status == 0);
  const Ran fitted = run(folder,
                         "fit built-in:spine:vertebrae_L3 --mask spine-1-labels.nii.gz --label vertebrae_L3 "
                         "-o l3.ply --json");
  REQUIRE_MESSAGE(fitted.status == 0, fitted.errors);
  const Ran compared = run(folder, "compare l3.ply --mesh spine-1-truth/vertebrae_L3.ply --json");
  REQUIRE(compared.status == 0);
  CHECK(compared.json()["dice"].get<double>() > 0.9);
  CHECK(compared.json()["vertex_distance_mm"]["mean"].get<double>() < 3);
}

TEST_CASE("repair takes an island away, keeps the rest, and writes a worklist") {
  const BodyFolder folder;
  make_set_of_kidneys(folder);
  // A speck of the left kidney in a corner.
  Volume wrong = test::must(read_volume(folder.path / "body.seg.nrrd")).volume;
  const VolumeRead truth = test::must(read_volume(folder.path / "body.seg.nrrd"));
  std::visit(
      [&](auto& voxels) {
        for (std::size_t k = 0; k < 3; ++k)
          for (std::size_t i = 60; i < 66; ++i) voxels[(k * 36 + 1) * 70 + i] = 3;
      },
      wrong.data);
  VolumeRead written = truth;
  written.volume = wrong;
  fs::create_directories(folder.path / "in");
  REQUIRE(write_segmentation(written, folder.path / "in" / "body.seg.nrrd"));
  const Ran mended = run(folder, "repair in/body.seg.nrrd --templates body.set.json -o out --json");
  REQUIRE_MESSAGE(mended.status == 0, mended.errors);
  const Json one = mended.json()["cases"][0];
  REQUIRE(one["structures"].size() == 2);
  CHECK(one["structures"][0]["defects"] == Json::array({{{"kind", "island"}, {"with", nullptr}}}));
  CHECK(one["structures"][0]["changed_voxels"] == 18);
  CHECK(one["found"] == "kidney_left: island");
  CHECK(mended.errors.find("has speck, for which the set has no template; left as they are") != std::string::npos);
  CHECK(one["structures"][1]["defects"].empty());
  CHECK(one["structures"][1]["changed_voxels"] == 0);
  for (const Json& structure : one["structures"]) CHECK(structure["confidence"].get<double>() > 0.8);
  const VolumeRead after = test::must(read_volume(folder.path / "out" / "body.seg.nrrd"));
  CHECK(labels_of(after.volume) == labels_of(truth.volume));
  CHECK(after.segmentation.segments.size() == truth.segmentation.segments.size());
  CHECK(after.segmentation.segments[0].name == "kidney_left");
  CHECK(fs::exists(folder.path / "out" / "worklist.study.json"));
  CHECK(fs::exists(folder.path / "out" / "body-cases" / "body-kidney_left.homolog"));
}

TEST_CASE("repair never writes over the map that it reads, and keeps a folder of single masks as one") {
  const BodyFolder folder;
  make_set_of_kidneys(folder);
  const std::string before = read_whole_file(folder.path / "body.seg.nrrd").value();
  const Ran over = run(folder, "repair body.seg.nrrd --templates body.set.json -o .");
  CHECK(over.status == 1);
  CHECK(over.errors.find("written over") != std::string::npos);
  CHECK(read_whole_file(folder.path / "body.seg.nrrd").value() == before);
  fs::create_directories(folder.path / "in" / "subject");
  for (const double x_mm : {0.0, 44.0}) {
    Mesh ball = icosphere(4, 20);
    ball.points.col(0).array() += x_mm;
    VolumeGeometry grid;
    grid.dims = {70, 36, 36};
    grid.spacing_mm.setConstant(2);
    grid.origin_mm = Vec3(-35, -35, -35);
    REQUIRE(write_volume(label_map(ball, grid),
                         folder.path / "in" / "subject" / (x_mm == 0 ? "kidney_left.nrrd" : "kidney_right.nii.gz")));
  }
  const Ran mended = run(folder, "repair in/subject --templates body.set.json -o out --json");
  REQUIRE_MESSAGE(mended.status == 0, mended.errors);
  for (const char* name : {"kidney_left.nrrd", "kidney_right.nii.gz"}) {
    const VolumeRead read = test::must(read_volume(folder.path / "in" / "subject" / name));
    const VolumeRead written = test::must(read_volume(folder.path / "out" / "subject" / name));
    CHECK(labels_of(written.volume) == labels_of(read.volume));
    CHECK(same_grid(written.volume.geometry, read.volume.geometry));
  }
}

}  // namespace homolog
