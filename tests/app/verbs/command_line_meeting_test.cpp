#include <array>

#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/volume/volume_io.h"
#include "tests/command_line.h"

using namespace homolog;

namespace {

/// An egg with a bump, far from the origin as in a scan; `scale` 1: 54 mm by 38 mm by 86 mm.
Mesh organ(double scale) {
  Mesh mesh = icosphere(4, 27 * scale);
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i) {
    Vec3 p = Vec3(mesh.points.row(i)).cwiseProduct(Vec3(1, 0.7, 1.6));
    if (p.z() > 20) p.x() += 0.5 * (p.z() - 20);
    mesh.points.row(i) = p + Vec3(60, -90, 140);
  }
  return mesh;
}

VolumeGeometry grid() {
  VolumeGeometry grid;
  grid.dims = {36, 32, 56};
  grid.spacing_mm.setConstant(2);
  grid.origin_mm = Vec3(60, -90, 140) - Vec3(35, 31, 55);
  return grid;
}

/// Frame 0 the organ, frame 1 a smaller one; `other.nii.gz` the other way round.
void put_cine(const fs::path& folder) {
  for (const bool other : {false, true}) {
    Volume cine;
    std::vector<std::uint8_t> voxels;
    for (const double scale : other ? std::array{0.75, 1.0} : std::array{1.0, 0.75}) {
      cine = label_map(organ(scale), grid(), 1);
      const auto& frame = std::get<std::vector<std::uint8_t>>(cine.data);
      voxels.insert(voxels.end(), frame.begin(), frame.end());
    }
    cine.data = std::move(voxels);
    cine.frames = 2;
    REQUIRE(write_volume(cine, folder / (other ? "other.nii.gz" : "cine.nii.gz")));
  }
}

void put_times(const fs::path& file, const Vec3& by) {
  Mesh mesh = organ(1);
  mesh.points = mesh.points * by.asDiagonal();
  REQUIRE(write_mesh(mesh, file));
}

}  // namespace

TEST_CASE("every verb that takes a label map with frames takes the one that is asked for and reports which") {
  const TemporaryFolder folder;
  put_cine(folder.path);
  REQUIRE(write_mesh(organ(0.75), folder.path / "small.ply"));
  const auto compared = [&](const std::string& option) {
    const Ran ran = run(folder, "compare small.ply --mask cine.nii.gz --json " + option);
    INFO(ran.errors);
    REQUIRE(ran.status == 0);
    return ran;
  };
  CHECK(compared("--frame 1").json()["dice"] > 0.97);
  CHECK(compared("--frame 1").json()["frame"] == 1);
  CHECK(compared("--frame 0").json()["dice"] < 0.65);
  const Ran unasked = compared("");
  CHECK(unasked.json()["frame"] == 0);
  CHECK(unasked.errors.find("cine.nii.gz: ") != std::string::npos);
  CHECK(unasked.errors.find("--frame") != std::string::npos);
  CHECK(compared("--frame 1").errors.empty());
  check_refused(run(folder, "compare small.ply --mask cine.nii.gz --frame 2"), "cine.nii.gz");

  const Ran info = run(folder, "info small.ply --mask cine.nii.gz --frame 1 --json");
  REQUIRE(info.status == 0);
  CHECK(info.json()["frame"] == 1);
  CHECK(info.json()["distance_to_mask_mm"]["mean"] < 0.5);

  const Ran made = run(folder, "template cine.nii.gz --frame 1 --vertices 800 -o t.ply --json");
  INFO(made.errors);
  REQUIRE(made.status == 0);
  CHECK(made.json()["frame"] == 1);
  CHECK(run(folder, "compare t.ply --mesh small.ply --json").json()["assd_mm"] < 0.6);
  const Ran fitted = run(folder, "fit t.ply --mask cine.nii.gz --frame 0 -o f.ply --json");
  INFO(fitted.errors);
  REQUIRE(fitted.status == 0);
  CHECK(fitted.json()["frame"] == 0);
  // The mesh keeps the frame that it was fitted to, and meets that one from then on.
  const Ran met = run(folder, "compare f.ply --mask other.nii.gz --json");
  CHECK(met.json()["frame"] == 0);
  const Ran later = run(folder, "fit t.ply --mask other.nii.gz --frame 1 -o g.ply --json");
  REQUIRE(later.status == 0);
  const Ran kept = run(folder, "compare g.ply --mask other.nii.gz --json");
  CHECK(kept.json()["frame"] == 1);
  CHECK(kept.json()["dice"] > 0.95);

  const Ran mean =
      run(folder, "template --consensus cine.nii.gz other.nii.gz --frame 1 --vertices 500 -o c.ply --json");
  INFO(mean.errors);
  REQUIRE(mean.status == 0);
  CHECK(mean.json()["frames"] == Json{{"cine", 1}, {"other", 1}});
}

TEST_CASE("a mesh that is inside out is said by every verb that computes a volume") {
  const TemporaryFolder folder;
  Mesh inward = organ(1);
  Triangles faces = inward.topology->triangles();
  faces.col(1).swap(faces.col(2));
  REQUIRE(write_mesh_file({inward.points, faces}, folder.path / "inward.ply"));
  REQUIRE(write_mesh(organ(1), folder.path / "organ.ply"));
  REQUIRE(write_volume(label_map(organ(1), grid(), 1), folder.path / "map.nii"));
  const Ran info = run(folder, "info inward.ply");
  CHECK(info.errors.find("inward.ply: repair-mesh would mend it: 5120 faces turned outward") != std::string::npos);
  for (const char* verb :
       {"measure inward.ply", "compare inward.ply --mesh organ.ply", "compare organ.ply --mesh inward.ply",
        "compare inward.ply --mask map.nii", "label-map inward.ply --like map.nii -o out.nii"}) {
    CAPTURE(std::string(verb));
    const Ran ran = run(folder, verb);
    INFO(ran.errors);
    CHECK(ran.status == 0);
    CHECK(ran.errors.find("inward") < ran.errors.find(": its faces look inward"));
    CHECK(ran.errors.find(": its faces look inward") != std::string::npos);
  }
  CHECK(run(folder, "measure organ.ply").errors.empty());
}

TEST_CASE("lengths in another unit and RAS for LPS are said where a mesh meets a label map") {
  const TemporaryFolder folder;
  REQUIRE(write_volume(label_map(organ(1), grid(), 1), folder.path / "map.nii"));
  put_times(folder.path / "metres.ply", {1e-3, 1e-3, 1e-3});
  put_times(folder.path / "ras.ply", {-1, -1, 1});
  put_times(folder.path / "right.ply", {1, 1, 1});
  for (const std::string verb :
       {"compare M.ply --mask map.nii", "info M.ply --mask map.nii", "fit M.ply --mask map.nii -o out.ply"}) {
    CAPTURE(verb);
    const auto said = [&](const std::string& name) {
      std::string with = verb;
      return run(folder, with.replace(with.find("M.ply"), 5, name)).errors;
    };
    CHECK(said("metres.ply").find("metres.ply: is 1,000 times smaller than map.nii; are its lengths in metres?") !=
          std::string::npos);
    CHECK(said("ras.ply").find("ras.ply: would lie in map.nii if its coordinates were RAS") != std::string::npos);
    CHECK(said("right.ply").find("right.ply: ") == std::string::npos);
  }
  REQUIRE(run(folder, "convert metres.ply back.ply --times 1000").status == 0);
  CHECK(run(folder, "compare back.ply --mesh right.ply --json").json()["vertex_distance_mm"]["max"] < 1e-3);
  REQUIRE(run(folder, "convert ras.ply turned.ply --from-ras").status == 0);
  CHECK(run(folder, "compare turned.ply --mesh right.ply --json").json()["vertex_distance_mm"]["max"] < 1e-3);
}

TEST_CASE("a cohort of cines gets cases whose meshes lie at the frame that was fitted") {
  const TemporaryFolder folder;
  put_cine(folder.path);
  REQUIRE(write_mesh(organ(1), folder.path / "t.ply"));
  const Ran fitted = run(folder, "fit t.ply --mask cine.nii.gz other.nii.gz --frame 1 -o fits --json");
  INFO(fitted.errors);
  REQUIRE(fitted.status == 0);
  const auto study = Json::parse(read_whole_file(folder.path / "fits" / "fits.study.json").value());
  REQUIRE(study["cases"].size() == 2);
  CHECK(study["cases"][0]["frame"] == 1);
  REQUIRE(run(folder, "replay fits/cine.homolog --frame 1 -o replayed.ply").status == 0);
  CHECK(run(folder, "compare replayed.ply --mesh fits/cine.ply --json").json()["assd_mm"] < 1e-4);
  CHECK(run(folder, "compare replayed.ply --mask cine.nii.gz --frame 1 --json").json()["dice"] > 0.95);
  const Ran model = run(folder, "model fits/fits.study.json -o m.h5.json --keep-scale --json");
  INFO(model.errors);
  REQUIRE(model.status == 0);
  CHECK(model.json()["shapes"] == 2);
}

TEST_CASE("a model of a mesh and of the same in another unit says so") {
  const TemporaryFolder folder;
  REQUIRE(write_mesh(icosphere(2, 40), folder.path / "a.ply"));
  REQUIRE(run(folder, "convert a.ply b.ply --times 1000").status == 0);
  const Ran ran = run(folder, "model a.ply b.ply -o m.h5.json");
  check_refused(ran, "b");
  CHECK(ran.errors.find("1,000 times larger") != std::string::npos);
}
