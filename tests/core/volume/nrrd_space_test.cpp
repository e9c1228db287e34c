#include <doctest/doctest.h>

#include <algorithm>

#include "core/volume/volume_io.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

// Where NRRD files lie, in which units, and what their axes are.
namespace fs = std::filesystem;
using namespace homolog;

namespace {

/// Reads a header without its first lines, of 8-bit voxels, with the bytes behind it.
Result<VolumeRead> read_nrrd_of(const std::string& fields, const std::string& voxels,
                                const std::string& name = "v.nrrd") {
  const TemporaryFolder folder;
  write_bytes(folder.path / name, "NRRD0005\ntype: uint8\nencoding: raw\n" + fields + "\n" + voxels);
  return read_volume(folder.path / name);
}

bool nrrd_warns(const Result<VolumeRead>& read, const std::string& what) {
  return read && std::any_of(read->warnings.begin(), read->warnings.end(),
                             [&](const std::string& warning) { return warning.find(what) != std::string::npos; });
}

const std::string voxels_2_2_2 = "abcdefgh";

Result<VolumeRead> read_in_space(const std::string& units) {
  return read_nrrd_of(
      "dimension: 3\nspace: left-posterior-superior\nsizes: 2 2 2\nspace directions: (2,0,0) (0,3,0) "
      "(0,0,4)\nspace origin: (5,6,7)\n" +
          units,
      voxels_2_2_2);
}

Result<VolumeRead> read_without_space(const std::string& fields) {
  return read_nrrd_of("dimension: 3\nsizes: 2 2 2\n" + fields, voxels_2_2_2);
}

void check_nrrd_grid(const Result<VolumeRead>& read, const Vec3& spacing_mm, const Vec3& origin_mm) {
  if (!read) FAIL(read.error().sentence());
  const VolumeGeometry& g = read->volume.geometry;
  CHECK((g.spacing_mm - spacing_mm).norm() < 1e-9 * spacing_mm.norm());
  CHECK((g.origin_mm - origin_mm).norm() < 1e-9 * (1 + origin_mm.norm()));
}

}  // namespace

TEST_CASE("space units of NRRD scale the grid to mm however they are written") {
  struct Form {
    std::string units;
    double mm;
  };
  for (const Form& form : {Form{"\"m\" \"m\" \"m\"", 1000},
                           Form{"\"M\" \"M\" \"M\"", 1000},
                           Form{"\"cm\" \"cm\" \"cm\"", 10},
                           Form{"\"um\" \"um\" \"um\"", 1e-3},
                           Form{"\"\xc2\xb5m\" \"\xc2\xb5m\" \"\xc2\xb5m\"", 1e-3},
                           Form{"\"microns\" \"microns\" \"microns\"", 1e-3},
                           Form{"\"mm\" \"mm\" \"mm\"", 1},
                           Form{"\"MM\" \"Mm\" \"mM\"", 1},
                           Form{"mm mm mm", 1},
                           Form{"m m m", 1000},
                           Form{"m, m, m", 1000},
                           Form{"\"m\",\"m\",\"m\"", 1000},
                           Form{"['m', 'm', 'm']", 1000},
                           Form{"\" m \" \"m\"  \"m \"", 1000},
                           Form{"\"Meters\" \"meter\" \"metres\"", 1000},
                           Form{"\"inch\" \"inches\" \"in\"", 25.4},
                           Form{"\"millimeters\" \"millimetre\" \"mm\"", 1},
                           Form{"\"\" \"\" \"\"", 1},
                           Form{"\"???\" \"???\" \"???\"", 1},
                           Form{"\"m\"", 1000}}) {
    CAPTURE(form.units);
    const auto read = read_in_space("space units: " + form.units + "\n");
    check_nrrd_grid(read, form.mm * Vec3(2, 3, 4), form.mm * Vec3(5, 6, 7));
    CHECK(read->warnings.empty());
  }
  check_nrrd_grid(read_in_space("Space Units:\"m\" \"mm\" \"cm\"\n"), Vec3(2000, 3, 40), Vec3(5000, 6, 70));
  check_nrrd_grid(read_in_space("units: \"cm\" \"cm\" \"cm\"\n"), Vec3(20, 30, 40), Vec3(50, 60, 70));
  check_nrrd_grid(read_in_space("space units: \"mm\" \"mm\" \"mm\"\nunits: \"cm\" \"cm\" \"cm\"\n"), Vec3(2, 3, 4),
                  Vec3(5, 6, 7));
}

TEST_CASE("units of NRRD that nobody knows are named and wrong counts refused") {
  const auto unknown = read_in_space("space units: \"furlong\" \"furlong\" \"furlong\"\n");
  check_nrrd_grid(unknown, Vec3(2, 3, 4), Vec3(5, 6, 7));
  CHECK(unknown->warnings.size() == 1);
  CHECK(nrrd_warns(unknown, "lengths in furlong"));
  CHECK(says(read_in_space("space units: \"m\" \"m\"\n"), "2 units for 3 directions"));
  CHECK(says(read_without_space("spacings: 1 1 1\nunits: \"m\" \"m\"\n"), "2 units for 3 directions"));
}

TEST_CASE("NRRD without a space is placed by its spacings and ends and units") {
  check_nrrd_grid(read_without_space("spacings: 1 2 3\nunits: \"cm\" \"m\" \"um\"\n"), Vec3(10, 2000, 3e-3),
                  Vec3::Zero());
  const std::string ends = "spacings: 1 2 3\naxis mins: 10 20 30\n";
  const auto cells = read_without_space(ends + "centerings: cell cell cell\n");
  check_nrrd_grid(cells, Vec3(1, 2, 3), Vec3(10.5, 21, 31.5));
  CHECK(!nrrd_warns(cells, "centerings"));
  check_nrrd_grid(read_without_space(ends + "centerings: node node node\n"), Vec3(1, 2, 3), Vec3(10, 20, 30));
  const auto unsaid = read_without_space(ends);
  check_nrrd_grid(unsaid, Vec3(1, 2, 3), Vec3(10.5, 21, 31.5));  // as ITK has it
  CHECK(nrrd_warns(unsaid, "centerings"));
  const std::string both = "axis mins: 10 20 30\naxis maxs: 14 28 42\n";
  check_nrrd_grid(read_without_space(both + "centerings: cell cell cell\n"), Vec3(2, 4, 6), Vec3(11, 22, 33));
  check_nrrd_grid(read_without_space(both + "centerings: node node node\n"), Vec3(4, 8, 12), Vec3(10, 20, 30));
  const auto metres = read_without_space(ends + "centerings: cell cell cell\nunits: \"m\" \"m\" \"m\"\n");
  check_nrrd_grid(metres, Vec3(1000, 2000, 3000), Vec3(10500, 21000, 31500));
}

TEST_CASE("spacings of NRRD below 0 turn their axes and say so") {
  const auto read = read_without_space("spacings: 1 -2 3\naxis mins: 0 10 0\ncenterings: node node node\n");
  check_nrrd_grid(read, Vec3(1, 2, 3), Vec3(0, 10, 0));
  CHECK((read->volume.geometry.to_mm(Vec3(0, 1, 0)) - Vec3(0, 8, 0)).norm() < 1e-9);
  CHECK(nrrd_warns(read, "spacings below 0"));
}

TEST_CASE("an axis of NRRD for time or a list makes frames and one for vectors or colours none") {
  const std::string start = "dimension: 4\nspace: LPS\nspace origin: (0,0,0)\n", one = "(1,0,0) (0,1,0) (0,0,1)";
  const std::string front = "sizes: 3 2 1 1\nspace directions: none " + one + "\n",
                    back = "sizes: 2 1 1 3\nspace directions: " + one + " none\n";
  struct Form {
    std::string fields, voxels;
  };
  const std::vector<Form> cines{{front + "kinds: time domain domain domain\n", "abcxyz"},
                                {front + "kinds: list domain domain domain\n", "abcxyz"},
                                {front + "kinds: list space space space\n", "abcxyz"},
                                {front + "kinds: ??? domain domain domain\n", "abcxyz"},
                                {front, "abcxyz"},
                                {back + "kinds: domain domain domain time\n", "axbycz"},
                                {back + "kinds: space space space list\n", "axbycz"},
                                {back, "axbycz"}};
  for (const Form& form : cines) {
    CAPTURE(form.fields);
    const auto read = read_nrrd_of(start + form.fields, form.voxels);
    REQUIRE_MESSAGE(read, read.error().sentence());
    CHECK(read->volume.frames == 3);
    CHECK(read->volume.data == VoxelData(std::vector<std::uint8_t>{'a', 'x', 'b', 'y', 'c', 'z'}));
    CHECK(read->other_layers.empty());
  }
  for (const char* kind : {"vector", "covariant-vector", "point", "RGB-color", "3-color", "3-vector", "HSV-color"}) {
    CAPTURE(std::string(kind));
    CHECK(says(read_nrrd_of(start + front + "kinds: " + kind + " domain domain domain\n", "abcxyz"), "several values"));
    CHECK(says(read_nrrd_of(start + back + "kinds: domain domain domain " + kind + "\n", "axbycz"), "several values"));
  }
  const auto without_space = read_nrrd_of(
      "dimension: 4\nsizes: 3 2 1 1\nkinds: time domain domain domain\nspacings: 40 1 1 1\nunits: \"ms\" "
      "\"cm\" \"cm\" \"cm\"\n",
      "abcxyz");
  REQUIRE(without_space);
  CHECK(without_space->volume.frames == 3);
  CHECK(without_space->volume.frame_seconds == doctest::Approx(0.04));
  CHECK(without_space->volume.geometry.spacing_mm[0] == doctest::Approx(10));
}

TEST_CASE("a space of NRRD with time has the frames along it") {
  const auto read = read_nrrd_of(
      "dimension: 4\nspace: right-anterior-superior-time\nsizes: 2 1 1 3\nspace directions: (2,0,0,0) (0,3,0,0) "
      "(0,0,4,0) (0,0,0,40)\nspace origin: (5,6,7,0)\nspace units: \"cm\" \"cm\" \"cm\" \"ms\"\n",
      "axbycz");
  check_nrrd_grid(read, Vec3(20, 30, 40), Vec3(-50, -60, 70));
  CHECK(read->volume.frames == 3);
  CHECK(read->volume.frame_seconds == doctest::Approx(0.04));
}

TEST_CASE("gradients of a diffusion scan are not called frames in time") {
  const auto read = read_nrrd_of(
      "dimension: 4\nspace: LPS\nsizes: 3 2 1 1\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\nkinds: list domain "
      "domain domain\nmodality:=DWMRI\nDWMRI_b-value:=800\n",
      "abcxyz");
  CHECK(nrrd_warns(read, "gradient"));
}
