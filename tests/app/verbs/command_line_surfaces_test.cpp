// The command-line contract of docs/commands.md: broken surfaces, unions of labels, landmarks in and out.
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>

#include "core/mesh/construction/clip.h"
#include "core/mesh/repair/mesh_repair.h"
#include "core/template/template.h"
#include "tests/ball_folder.h"
#include "tests/tetrahedra.h"

namespace homolog {

TEST_CASE("repair-mesh mends a broken surface and says what it did") {
  const TemporaryFolder folder;
  const Mesh ball = icosphere(3, 10);
  MeshFile broken{ball.points, ball.topology->triangles()};
  broken.points.conservativeResize(ball.points.rows() + 1, 3);
  broken.points.bottomRows(1) =
      0.55 * (ball.points.row(broken.triangles(0, 0)) + ball.points.row(broken.triangles(0, 1)));
  Triangles& faces = broken.triangles.edit();
  faces.conservativeResize(faces.rows() + 1, 3);
  faces.bottomRows(1) << faces(0, 0), faces(0, 1), static_cast<std::int32_t>(ball.points.rows());
  broken.points(77, 0) = std::numeric_limits<double>::quiet_NaN();
  REQUIRE(write_mesh_file(broken, folder.path / "broken.ply"));
  check_refused(run(folder, "convert broken.ply out.ply"), "mend it with repair-mesh");

  check_refused(run(folder, "info broken.ply"), "repair-mesh would mend it: one vertex that is no number left out");
  MeshFile pierced{ball.points, ball.topology->triangles().topRows(ball.topology->triangles().rows() - 1)};
  REQUIRE(write_mesh_file(pierced, folder.path / "pierced.ply"));
  const Ran info = run(folder, "info pierced.ply --json");
  CHECK(info.json()["would_mend"]["holes"] == 1);
  CHECK(info.errors.find("pierced.ply: repair-mesh would mend it: one hole closed flat") != std::string::npos);
  const Ran mended = run(folder, "repair-mesh broken.ply -o mended.ply --json");
  CHECK(mended.status == 0);
  CHECK(mended.json()["mended"]["non_manifold_edges"] == 1);
  CHECK(mended.json()["mended"]["crumbs"] == 1);
  CHECK(mended.json()["mended"]["holes"] == 1);
  CHECK(mended.json()["closed"] == true);
  CHECK(mended.json()["components"] == 1);
  const Ran again = run(folder, "info mended.ply --json");
  CHECK_FALSE(again.json().contains("would_mend"));
  CHECK(again.errors.empty());
  // A fit and a template take the broken one too, and say so.
  REQUIRE(write_mesh(icosphere(2, 12), folder.path / "T.ply"));
  const Ran fitted = run(folder, "fit T.ply --mesh broken.ply -o M.ply --json");
  CHECK(fitted.status == 0);
  CHECK(fitted.json()["dice"] > 0.97);
  CHECK(fitted.errors.find("broken.ply: was mended: one vertex") != std::string::npos);
  CHECK(run(folder, "template broken.ply -o U.ply --vertices 300 --json").json()["mended"]["crumbs"] == 1);
}

TEST_CASE("repair-mesh leaves a sound template as it is and cuts tunnels on request") {
  const NamedBallFolder folder;
  CHECK(run(folder, "repair-mesh named.ply -o same.ply").errors.empty());
  CHECK(without_record(read_whole_file(folder.path / "same.ply").value()) ==
        read_whole_file(folder.path / "named.ply").value());
  REQUIRE(write_mesh(shapes::torus(48, 24, 20, 8), folder.path / "ring.ply"));
  CHECK(run(folder, "repair-mesh ring.ply -o out.ply --json").json()["genus"] == 1);
  const Ran cut = run(folder, "repair-mesh ring.ply -o out.ply --genus 0 --vertices 800 --json");
  CHECK(cut.json()["genus"] == 0);
  CHECK(cut.json()["vertices"] == 800);
  CHECK(cut.json()["rebuilt"]["genus_before"] == 1);
  CHECK(cut.json()["distance_to_mesh_mm"]["mean"].is_number());
  CHECK(run(folder, "template ring.ply -o out.ply --genus 0 --vertices 800 --json").json()["genus"] == 0);
  check_refused(run(folder, "repair-mesh ring.ply -o out.ply --genus 3"), "has one tunnel, fewer than --genus 3");
  check_refused(run(folder, "template ring.ply -o out.ply --genus 3"), "has one tunnel, fewer than --genus 3");
}

TEST_CASE("repair-mesh cuts the tunnels of each part and keeps the others") {
  const TemporaryFolder folder;
  const Mesh ring = shapes::torus(48, 24, 20, 8), ball = icosphere(3, 15);
  const auto aside = [](Mesh mesh, double mm) {
    mesh.points.rowwise() += Eigen::RowVector3d(mm, 0, 0);
    return mesh;
  };
  REQUIRE(write_mesh(joined({ring, aside(ring, 100), aside(ball, 200)}), folder.path / "three.ply"));
  const Json kept = run(folder, "repair-mesh three.ply -o kept.ply --genus 1 --json").json();
  CHECK(kept["components"] == 3);
  CHECK_FALSE(kept.contains("rebuilt"));
  const Json cut = run(folder, "repair-mesh three.ply -o cut.ply --genus 0 --vertices 2000 --json").json();
  CHECK(cut["components"] == 3);
  CHECK(cut["genus"] == 0);
  CHECK(cut["rebuilt"]["genus_before"] == 1);

  // An open ring: what --holes keep leaves open cannot stay open where the surface is made anew.
  MeshFile open{ring.points, ring.topology->triangles()};
  open.triangles.edit().conservativeResize(open.triangles.rows() - 1, 3);
  REQUIRE(write_mesh_file(open, folder.path / "open.ply"));
  const Ran closed = run(folder, "repair-mesh open.ply -o closed.ply --genus 0 --holes keep --vertices 800 --json");
  CHECK(closed.json()["genus"] == 0);
  CHECK(closed.errors.find("open.ply: holes that --holes keep leaves open were closed flat") != std::string::npos);
}

TEST_CASE("a fit with a template of many tunnels never comes without a warning") {
  const TemporaryFolder folder;
  // A ball with dozens of shafts through it.
  const Mesh other = icosphere(3, 20);
  Volume voxels = label_map(other, [] {
    VolumeGeometry grid;
    grid.dims = {64, 64, 64};
    grid.origin_mm = Vec3::Constant(-31.5);
    return grid;
  }());
  auto& set = std::get<std::vector<std::uint8_t>>(voxels.data);
  for (int k = 0; k < 64; ++k)
    for (int i = 0; i < 64; ++i)
      for (int j = 0; j < 64; ++j)
        if (i % 6 < 3 && j % 6 < 3) set[static_cast<std::size_t>((k * 64 + j) * 64 + i)] = 0;
  REQUIRE(write_volume(voxels, folder.path / "riddled.nii.gz"));
  REQUIRE(run(folder, "template riddled.nii.gz -o T.ply --genus keep --closing-mm 0 --opening-mm 0 --vertices 4000")
              .errors.find("tunnels, more than organs have") != std::string::npos);
  REQUIRE(write_mesh(other, folder.path / "ball.ply"));
  const Ran ran = run(folder, "fit T.ply --mesh ball.ply -o M.ply");
  CHECK(ran.status == 0);
  CHECK(ran.errors.find("so vertices of its fits do not correspond") != std::string::npos);
}

TEST_CASE("several labels are taken together by every verb that takes one") {
  const TemporaryFolder folder;
  VolumeGeometry grid;
  grid.dims = {60, 60, 60};
  grid.origin_mm = Vec3::Constant(-29.5);
  const Mesh ball = icosphere(4, 20);
  Volume one = label_map(ball, grid, 3);
  REQUIRE(write_volume(one, folder.path / "one.nii.gz"));
  auto& voxels = std::get<std::vector<std::uint8_t>>(one.data);
  for (std::size_t v = 0; v < voxels.size(); ++v)  // its upper part is another label
    if (voxels[v] == 3 && v / 3600 > 36) voxels[v] = 5;
  REQUIRE(write_volume(one, folder.path / "two.nii.gz"));
  const std::string options = " -o T.ply --vertices 400 --json";
  const Ran whole = run(folder, "template one.nii.gz" + options);
  fs::rename(folder.path / "T.ply", folder.path / "one.ply");
  check_refused(run(folder, "template two.nii.gz" + options), "holds several labels (3, 5)");
  const Ran together = run(folder, "template two.nii.gz --label 5,3" + options);
  CHECK(together.json()["volume_ml"] == whole.json()["volume_ml"]);
  CHECK(run(folder, "info T.ply --mask two.nii.gz --label 3,5 --json").json()["distance_to_mask_mm"]["mean"] ==
        run(folder, "info one.ply --mask one.nii.gz --json").json()["distance_to_mask_mm"]["mean"]);
  CHECK(run(folder, "compare T.ply --mask two.nii.gz --label 3,5 --json").out ==
        run(folder, "compare one.ply --mask one.nii.gz --json").out);
  const auto fitted = [&](const std::string& mask) {
    Json report = run(folder, "fit one.ply --mask " + mask + " -o M.ply --json").json();
    report.erase("seconds");
    return report;
  };
  CHECK(fitted("two.nii.gz --label 3,5") == fitted("one.nii.gz"));
  CHECK(fitted("one.nii.gz --label 3,5") == fitted("one.nii.gz"));  // a kidney without a tumour
  check_refused(run(folder, "fit one.ply --mask two.nii.gz --label 7,8 -o M.ply"), "label 7+8 does not occur");
  check_refused(run(folder, "fit one.ply --mask one.ply -o M.ply"), "one.ply: is a mesh, where");
  for (const char* wrong : {"3,", ",3", "3;5", "0", "3,-5", "a,"})
    CHECK(run(folder, "fit one.ply --mask two.nii.gz -o M.ply --label " + std::string("'") + wrong + "'").status == 2);
}

namespace {

/// Landmarks as 3D Slicer wrote them before its .mrk.json.
void write_fcsv(const std::filesystem::path& path, const std::string& system, const std::string& rows) {
  std::ofstream(path) << "# Markups fiducial file version = 4.11\n# CoordinateSystem = " << system
                      << "\n# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n"
                      << rows;
}

}  // namespace

TEST_CASE("landmarks go into a template and come out of fits") {
  const NamedBallFolder folder;
  write_fcsv(folder.path / "places.fcsv", "LPS",
             "1,0,0,20,0,0,0,1,1,1,0,top,,\n2,20,0,0,0,0,0,1,1,1,0,\"left, outer\",,\n3,0,35,0,0,0,0,1,1,1,0,far,,\n");
  for (const std::string in : {"ball.ply", "good.nii.gz"}) {
    CAPTURE(in);
    const Ran made = run(folder, "template " + in + " -o T.ply --vertices 500 --landmarks places.fcsv --json");
    CHECK(made.status == 0);
    CHECK(made.json()["landmarks"] == Json({"top", "left, outer", "far"}));
    CHECK(made.errors.find("places.fcsv: \"far\" lies 15 mm from the template's surface") != std::string::npos);
    const Ran fitted = run(folder, "fit T.ply --mesh ball.ply -o M.ply --landmarks places.fcsv --json");
    CHECK(fitted.json()["landmarks_used"] >= 2);
  }
  // Those of the surface itself stay; one of the same name is replaced.
  CHECK(run(folder, "template named.ply -o T.ply --vertices 500 --landmarks places.fcsv --json").json()["landmarks"] ==
        Json({"left", "back", "top", "left, outer", "far"}));
  std::ofstream(folder.path / "away.json") << R"([{"id":"top","coordinates":[300,0,20]}])";
  check_refused(run(folder, "template ball.ply -o T.ply --landmarks away.json"), "mm and more from the surface");
  CHECK(run(folder, "template good.nii.gz -o U.ply --tube --landmarks places.fcsv --json").json()["landmarks"].size() ==
        3);
}

TEST_CASE("a folder of landmarks may lack some cases and hold others") {
  const NamedBallFolder folder;
  write_fcsv(folder.path / "places/good.fcsv", "RAS",
             "1,0,0,20,0,0,0,1,1,1,0,top,,\n2,-20,0,0,0,0,0,1,1,1,0,left,,\n3,0,-20,0,0,0,0,1,1,1,0,back,,\n");
  std::ofstream(folder.path / "places/godo.json") << "[]";
  const Ran many = run(folder, "fit named.ply --mask good.nii.gz other.nii.gz -o out --landmarks places --json");
  CHECK(many.status == 0);
  CHECK(many.json()["cases"][0]["landmarks_used"] == 3);
  CHECK(many.json()["cases"][1]["landmarks_used"] == 0);
  CHECK(many.errors.find("places: holds \"godo.json\", which belongs to no case") != std::string::npos);
  CHECK(many.errors.find("other.nii.gz: has no landmark file") != std::string::npos);
}

namespace {

/// A cup: a ball that is cut open above, `growth` times as large along x.
MeshFile cup(double growth, double radius_mm = 20) {
  Mesh ball = icosphere(4, radius_mm);
  ball.points.col(0) *= growth;
  const Mesh open = clipped(ball, Vec3(0.1, 0, 1).normalized(), radius_mm / 3).value();
  MeshFile file;
  file.points = open.points;
  file.triangles = open.topology->triangles();
  return file;
}

}  // namespace

TEST_CASE("a surface with a rim goes all the way from a template to a model and no cap is invented") {
  const TemporaryFolder folder;
  fs::create_directory(folder.path / "cups");
  for (int k = 0; k < 4; ++k)
    REQUIRE(write_mesh_file(cup(1.1 + 0.1 * k), folder.path / "cups" / ("c" + std::to_string(k) + ".ply")));
  REQUIRE(write_mesh_file(cup(1.3), folder.path / "open.ply"));

  const Ran made = run(folder, "template open.ply -o T.ply --vertices 800 --json");
  REQUIRE_MESSAGE(made.status == 0, made.errors);
  CHECK(made.errors.empty());
  CHECK(made.json()["closed"] == false);
  REQUIRE(made.json()["rims"].size() == 1);
  const double rim_mm = run(folder, "info open.ply --json").json()["rims"][0]["length_mm"].get<double>();
  CHECK(made.json()["rims"][0]["length_mm"].get<double>() == doctest::Approx(rim_mm).epsilon(0.01));
  CHECK(made.json()["mended"]["holes"] == 0);
  CHECK(run(folder, "template open.ply -o C.ply --vertices 800 --holes all --json").json()["closed"] == true);

  const Ran fits = run(folder, "fit T.ply --mesh cups -o fits --json");
  REQUIRE_MESSAGE(fits.status == 0, fits.errors);
  for (const Json& one : fits.json()["cases"]) {
    CHECK(one["rim_mm"]["mean"].get<double>() < 0.05);
    CHECK(one["assd_mm"].get<double>() < 0.1);
    CHECK(one["dice"].is_null());
    CHECK(one["turned_triangles"] == 0);
  }

  const Ran measured = run(folder, "measure fits/c0.ply fits/c3.ply --csv t.csv --json");
  REQUIRE_MESSAGE(measured.status == 0, measured.errors);
  const Json cases = measured.json()["cases"];
  CHECK(cases[0]["volume_ml"].is_null());
  CHECK(measured.json()["volume_ml"]["count"] == 0);
  CHECK(cases[1]["volume_capped_ml"].get<double>() / cases[0]["volume_capped_ml"].get<double>() ==
        doctest::Approx(1.4 / 1.1).epsilon(0.02));
  CHECK(cases[0]["area_mm2"].get<double>() ==
        doctest::Approx(run(folder, "info cups/c0.ply --json").json()["area_mm2"].get<double>()).epsilon(0.01));
  CHECK(read_whole_file(folder.path / "t.csv")->starts_with("case,volume_ml,volume_capped_ml,area_mm2"));

  const Ran model = run(folder, "model fits/*.ply -o m.h5 --json");
  REQUIRE_MESSAGE(model.status == 0, model.errors);
  const Ran evaluated = run(folder, "evaluate fits/*.ply --json");
  REQUIRE_MESSAGE(evaluated.status == 0, evaluated.errors);
}

TEST_CASE("an open template on a closed organ is doubtful and the sentence says what to give") {
  const TemporaryFolder folder;
  REQUIRE(write_mesh_file(cup(1.3), folder.path / "open.ply"));
  const Mesh ball = icosphere(4, 20);
  MeshFile whole;
  whole.points = ball.points;
  whole.points.col(0) *= 1.3;
  whole.triangles = ball.topology->triangles();
  REQUIRE(write_mesh_file(whole, folder.path / "whole.ply"));
  REQUIRE(run(folder, "template open.ply -o T.ply --vertices 800").status == 0);
  const Ran fit = run(folder, "fit T.ply --mesh whole.ply -o f.ply --json");
  REQUIRE(fit.status == 0);
  CHECK(fit.json()["doubtful"] == true);
  CHECK(fit.errors.find("the template is open and the target goes on beyond its rim") != std::string::npos);
}

TEST_CASE("what needs the inside of an open mesh says that its rim was closed flat and tetrahedra are refused") {
  const BallFolder folder;
  REQUIRE(write_mesh_file(cup(1.3), folder.path / "a.ply"));
  fs::create_directory(folder.path / "b");
  REQUIRE(write_mesh_file(cup(1.2), folder.path / "b" / "a.ply"));
  const std::string said = " is open, so its rim was closed flat to have an inside";
  const auto says = [&](const std::string& command, const std::string& name) {
    const Ran ran = run(folder, command);
    CAPTURE(command);
    CHECK(ran.status == 0);
    return ran.errors.find(name + said) != std::string::npos;
  };
  CHECK(says("label-map a.ply --like good.nii.gz -o l.nii", "a.ply:"));
  CHECK(says("compare a.ply --mask l.nii", "a.ply:"));
  CHECK(says("compare ball.ply --mesh a.ply", "a.ply:"));
  CHECK(says("observers a.ply b/a.ply", " of the second:"));
  CHECK_FALSE(says("label-map ball.ply --like good.nii.gz -o l.nii", "ball.ply:"));
  CHECK_FALSE(says("compare ball.ply --mask l.nii", "ball.ply:"));
  // Distances do not take the cap that Dice takes.
  const std::string open = "a.ply: dice counts it as closed, and the distances";
  CHECK(run(folder, "compare a.ply --mask l.nii").errors.find(open) != std::string::npos);
  CHECK(run(folder, "compare ball.ply --mesh a.ply").errors.find(open) != std::string::npos);
  CHECK(run(folder, "compare a.ply --mesh ball.ply").errors.find(open) != std::string::npos);
  CHECK(run(folder, "compare a.ply --mesh b/a.ply").errors.find("dice counts it as closed") == std::string::npos);
  CHECK(run(folder, "compare ball.ply --mask l.nii").errors.find("dice counts it as closed") == std::string::npos);
  const Json info = run(folder, "info a.ply --json").json();
  CHECK(info["volume_capped_ml"] == info["volume_ml"]);
  CHECK_FALSE(run(folder, "info ball.ply --json").json().contains("volume_capped_ml"));

  std::ofstream(folder.path / "t.vtu") << BallOfTetrahedra(folder.ball, 2).vtu();
  check_refused(run(folder, "tets t.vtu a.ply --template a.ply -o out"), "a.ply: is open");
}

TEST_CASE("a sheet's thickness over its bone is measured along the sheet's normals") {
  const TemporaryFolder folder;
  fs::create_directories(folder.path / "cases" / "k1");
  const Mesh bone = icosphere(4, 20);
  MeshFile file;
  file.points = bone.points;
  file.triangles = bone.topology->triangles();
  REQUIRE(write_mesh_file(file, folder.path / "cases" / "k1" / "bone.ply"));
  REQUIRE(write_mesh_file(cup(1, 22.5), folder.path / "cases" / "k1" / "cartilage.ply"));
  REQUIRE(write_whole_file(folder.path / "r.json", R"({"homolog_recipe": 1, "name": "Cartilage", "measurements": [
    {"name": "thickness", "kind": "thickness", "of": {"kind": "whole", "structure": "cartilage"},
     "to": {"kind": "whole", "structure": "bone"}, "at_most_mm": 8},
    {"name": "covered", "kind": "area", "of": {"kind": "whole", "structure": "cartilage"}}]})"));
  const Ran ran = run(folder, "measure cases --recipe r.json --json");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  const Json values = ran.json()["cases"][0]["values"];
  CHECK(values["thickness"].get<double>() == doctest::Approx(2.5).epsilon(0.01));
  const double height_mm = 22.5 + 22.5 / 3;
  CHECK(values["covered"].get<double>() == doctest::Approx(2 * 3.14159 * 22.5 * height_mm).epsilon(0.01));
}

namespace {

/// A ventricle (4) of these half axes, its atrium (2) above `base_mm`, and its wall (9) below.
void write_heart(const fs::path& path, const Vec3& half_axes_mm, double base_mm, bool named = true) {
  Volume heart;
  heart.geometry.dims = {48, 48, 56};
  heart.geometry.spacing_mm = Vec3::Constant(1.5);
  heart.geometry.origin_mm = Vec3(-35.25, -35.25, -41.25);
  std::vector<std::uint8_t> voxels(heart.geometry.voxels());
  for (int k = 0; k < 56; ++k)
    for (int j = 0; j < 48; ++j)
      for (int i = 0; i < 48; ++i) {
        const Vec3 p = heart.geometry.to_mm(Vec3(i, j, k));
        const double within = p.cwiseQuotient(half_axes_mm).norm(),
                     around = p.cwiseQuotient(half_axes_mm + Vec3::Constant(6)).norm();
        voxels[heart.geometry.index(i, j, k)] = static_cast<std::uint8_t>(within < 1        ? 4
                                                                          : around > 1      ? 0
                                                                          : p.z() > base_mm ? 2
                                                                                            : 9);
      }
  heart.data = std::move(voxels);
  REQUIRE(write_volume(heart, path));
  const std::string stem = path.string().substr(0, path.string().find(".nii"));
  if (named) REQUIRE(write_whole_file(stem + ".json", R"({"ventricle":4,"atrium":2,"wall":9})"));
}

}  // namespace

TEST_CASE("a template that ends at its neighbours in a label map is fitted to maps, and finds the same rim") {
  const TemporaryFolder folder;
  write_heart(folder.path / "a.nii.gz", {20, 18, 28}, 12);
  write_heart(folder.path / "b.nii.gz", {23, 19, 31}, 16);
  write_heart(folder.path / "plain.nii.gz", {23, 19, 31}, 16, false);
  const Ran made = run(folder, "template a.nii.gz --label ventricle --open-at atrium --vertices 600 -o T.ply --json");
  REQUIRE_MESSAGE(made.status == 0, made.errors);
  CHECK(made.errors.empty());
  REQUIRE(made.json()["rims"].size() == 1);
  CHECK(made.json()["vertices"] == 600);
  CHECK(made.json()["distance_to_mask_mm"]["mean"] < 0.2);
  // The rim is an ellipse at 12 of 28 mm.
  const double at_base = std::sqrt(1 - 12.0 * 12 / (28 * 28)), rim_mm = std::numbers::pi * at_base * (20 + 18);
  CHECK(made.json()["rims"][0]["length_mm"].get<double>() == doctest::Approx(rim_mm).epsilon(0.04));
  const Ran fitted = run(folder, "fit T.ply --mask b.nii.gz --label ventricle -o M.ply --json");
  REQUIRE_MESSAGE(fitted.status == 0, fitted.errors);
  CHECK(fitted.errors.empty());
  CHECK(fitted.json()["doubtful"] == false);
  CHECK(fitted.json()["rim_mm"]["mean"] < 0.5);
  CHECK(fitted.json()["assd_mm"] < 0.5);
  CHECK(fitted.json()["dice"].is_null());
  CHECK(fitted.json()["dice_raw"].is_null());
  const MeshFile mesh = read_mesh_file(folder.path / "M.ply").value();
  const auto topology = Topology::make(mesh.points.rows(), mesh.triangles).value();
  double height_mm = 0;
  for (const std::int32_t i : topology->rims().at(0))
    height_mm += mesh.points(i, 2) / static_cast<double>(topology->rims().at(0).size());
  CHECK(height_mm == doctest::Approx(16).epsilon(0.06));

  // The mesh of the fit is a template that ends there too. Numbers do where a map has no names.
  CHECK(run(folder, "fit M.ply --mask a.nii.gz --label 4 -o N.ply --json").json()["rim_mm"]["mean"] < 0.5);
  CHECK(run(folder, "template plain.nii.gz --label 4 --open-at 2 --vertices 600 -o U.ply").status == 0);
  CHECK(run(folder, "fit U.ply --mask a.nii.gz --label 4 -o N.ply --json").json()["rim_mm"]["mean"] < 0.5);
  const Ran atrium = run(folder, "template a.nii.gz --label ventricle --facing atrium,wall --vertices 600 -o U.ply");
  check_refused(atrium, "a.nii.gz: label 4 faces the labels that are named and no others; name some of them");
  const Ran whole = run(folder, "fit T.ply --mask plain.nii.gz --label 4 -o N.ply --json");
  CHECK(whole.errors.find("the template ends at its neighbours, and the map ") != std::string::npos);
  CHECK(whole.json()["doubtful"] == true);
  check_refused(run(folder, "template a.nii.gz --label 4 --open-at aorta -o U.ply"), "has no label named \"aorta\"");
  CHECK(run(folder, "template a.nii.gz --label 4 --open-at 2 --facing 9 -o U.ply").status == 2);
  CHECK(run(folder, "template a.nii.gz --label 4 --open-at 2 --opening-mm 1 -o U.ply").status == 2);
  CHECK(run(folder, "template --best-of a.nii.gz b.nii.gz --label 4 --open-at 2 -o U.ply").status == 2);
  check_refused(run(folder, "template a.nii.gz --label 4 --open-at ,2 -o U.ply"), "cannot be asked for \",2\"");
  check_refused(run(folder, "template M.ply --open-at 2 -o U.ply"), "--facing and --open-at have no effect");
}

TEST_CASE("a consensus of parts of labels ends at the neighbours of all") {
  const TemporaryFolder folder;
  for (int k = 0; k < 3; ++k)
    write_heart(folder.path / ("h" + std::to_string(k) + ".nii.gz"), {20.0 + 2 * k, 18.0 + k, 28.0 + 2 * k}, 12.0 + k);
  const std::string verb = "template --consensus h0.nii.gz h1.nii.gz h2.nii.gz --label ventricle --open-at ";
  const Ran made = run(folder, verb + "atrium --vertices 600 -o T.ply --json");
  REQUIRE_MESSAGE(made.status == 0, made.errors);
  CHECK(made.errors.find("could not be fitted") == std::string::npos);
  CHECK(made.json()["subjects"] == 3);
  REQUIRE(made.json()["rims"].size() == 1);
  // The rim of the middle one is an ellipse at 13 of 30 mm; a consensus is as large as its subjects are on average.
  const double at_base = std::sqrt(1 - 13.0 * 13 / (30 * 30)), rim_mm = std::numbers::pi * at_base * (22 + 19);
  CHECK(made.json()["rims"][0]["length_mm"].get<double>() == doctest::Approx(rim_mm).epsilon(0.08));
  CHECK(faced_in(read_mesh_file(folder.path / "T.ply").value().comments) == FacedNames{"atrium", false});
  const Ran fitted = run(folder, "fit T.ply --mask h2.nii.gz --label ventricle -o M.ply --json");
  CHECK(fitted.json()["rim_mm"]["mean"] < 0.5);
  check_refused(run(folder, verb + "aorta -o U.ply"), "has no label named \"aorta\"");
}

TEST_CASE("a set takes a template that ends at its neighbours, and says where a map lacks them") {
  const TemporaryFolder folder;
  write_heart(folder.path / "a.nii.gz", {20, 18, 28}, 12);
  write_heart(folder.path / "b.nii.gz", {23, 19, 31}, 16);
  write_heart(folder.path / "c.nii.gz", {23, 19, 31}, 16, false);
  REQUIRE(write_whole_file(folder.path / "c.json", R"({"ventricle":4,"wall":9})"));
  REQUIRE(run(folder, "template a.nii.gz --label ventricle --open-at atrium --vertices 600 -o T.ply").status == 0);
  REQUIRE(write_whole_file(folder.path / "heart.set.json", R"({"homolog_set": 1, "structures": [
    {"name": "ventricle", "value": 4, "template": "T.ply"}]})"));
  const Ran fitted = run(folder, "fit heart.set.json --mask b.nii.gz -o fits --json");
  REQUIRE_MESSAGE(fitted.status == 0, fitted.errors);
  CHECK(fitted.errors.find("whole surface") == std::string::npos);
  const Json row = fitted.json()["cases"][0]["structures"][0];
  CHECK(row["doubtful"] == false);
  CHECK(row["dice"].is_null());
  CHECK(row["rim_mm"]["mean"] < 0.5);
  const Ran whole = run(folder, "fit heart.set.json --mask c.nii.gz -o others --json");
  CHECK(whole.errors.find("c.nii.gz: ventricle: the template ends at its neighbours, and the map has no label named "
                          "\"atrium\"; the label's whole surface was taken") != std::string::npos);
  CHECK_FALSE(whole.json()["cases"][0]["structures"][0].contains("rim_mm"));
}

TEST_CASE("a model remembers which part of a label its shapes are of, and new maps are scored by it") {
  const TemporaryFolder folder;
  std::string meshes;
  for (int k = 0; k < 4; ++k) {
    const std::string name = "h" + std::to_string(k);
    write_heart(folder.path / (name + ".nii.gz"), {20.0 + k, 18 + 0.4 * k * k, 28.0 - k}, 12 + 0.5 * k);
    if (k == 0)
      REQUIRE(run(folder, "template h0.nii.gz --label ventricle --open-at atrium --vertices 600 -o T.ply").status == 0);
    REQUIRE(run(folder, "fit T.ply --mask " + name + ".nii.gz --label ventricle -o " + name + ".ply").status == 0);
    meshes += " " + name + ".ply";
  }
  const Ran made = run(folder, "model" + meshes + " -o m.h5");
  REQUIRE_MESSAGE(made.status == 0, made.errors);
  CHECK(made.errors.find("keeps neither") == std::string::npos);
  const Json info = run(folder, "info m.h5 --json").json();
  CHECK(info["open_at"] == "atrium");
  CHECK_FALSE(info.contains("facing"));
  write_heart(folder.path / "new.nii.gz", {21.5, 19, 26.5}, 12.7);
  const Ran scored = run(folder, "score new.nii.gz --model m.h5 --label ventricle --json");
  REQUIRE_MESSAGE(scored.status == 0, scored.errors);
  CHECK(scored.errors.find("whole surface") == std::string::npos);
  CHECK(scored.json()["subjects"][0]["doubt"].is_null());
  CHECK(scored.json()["subjects"][0]["residual_mm"] < 1);
  write_heart(folder.path / "plain.nii.gz", {21.5, 19, 26.5}, 12.7, false);
  const Ran whole = run(folder, "score plain.nii.gz --model m.h5 --label 4 --json");
  CHECK(whole.errors.find("plain.nii.gz: the template ends at its neighbours, and the map ") != std::string::npos);
  CHECK(whole.errors.find("the label's whole surface was taken") != std::string::npos);
  CHECK(whole.json()["subjects"][0]["doubt"].is_string());

  MeshFile other = read_mesh_file(folder.path / "h3.ply").value();
  std::erase_if(other.comments, [](const std::string& comment) { return faced_in({comment}).has_value(); });
  other.comments.push_back(faced_comment({"wall", true}));
  REQUIRE(write_mesh_file(other, folder.path / "h3.ply"));
  const Ran mixed = run(folder, "model" + meshes + " -o mixed.h5");
  CHECK(mixed.status == 0);
  CHECK(mixed.errors.find("h3.ply: faces \"wall\", and h0.ply ends at \"atrium\"; a model of both keeps neither") !=
        std::string::npos);
  CHECK_FALSE(run(folder, "info mixed.h5 --json").json().contains("open_at"));
}

TEST_CASE("a mirrored template ends at the neighbours of the other side") {
  const TemporaryFolder folder;
  for (const std::string side : {"left", "right"}) {
    write_heart(folder.path / (side + ".nii.gz"), {20, 18, 28}, 12, false);
    REQUIRE(write_whole_file(folder.path / (side + ".json"), R"({"ventricle":4,"wall":9,"atrium_)" + side + R"(":2})"));
  }
  REQUIRE(run(folder, "template left.nii.gz --label ventricle --open-at atrium_left --vertices 600 -o T.ply").status ==
          0);
  REQUIRE(run(folder, "mirror T.ply -o U.ply").status == 0);
  CHECK(faced_in(read_mesh_file(folder.path / "U.ply").value().comments) == FacedNames{"atrium_right", false});
  for (const char* fit : {"fit U.ply", "fit T.ply --mirror"}) {
    CAPTURE(fit);
    const Ran fitted = run(folder, std::string(fit) + " --mask right.nii.gz --label ventricle -o M.ply --json");
    REQUIRE_MESSAGE(fitted.status == 0, fitted.errors);
    CHECK(fitted.errors.find("ends at its neighbours") == std::string::npos);
    CHECK(fitted.json()["rim_mm"]["mean"] < 0.5);
    CHECK(faced_in(read_mesh_file(folder.path / "M.ply").value().comments) == FacedNames{"atrium_right", false});
  }
  const Ran own = run(folder, "fit T.ply --mask right.nii.gz --label ventricle -o M.ply --json");
  CHECK(own.errors.find("the template ends at its neighbours, and the map has no label named \"atrium_left\"") !=
        std::string::npos);
}

}  // namespace homolog
