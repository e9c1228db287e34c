#include <doctest/doctest.h>

#include <random>

#include "core/base/files/files.h"
#include "core/mesh/files/landmark_io.h"
#include "core/mesh/formats/formats.h"
#include "core/model/files/statismo.h"
#include "core/model/shape_model.h"
#include "core/volume/formats/formats.h"
#include "tests/shapes.h"
#include "tests/temporary_folder.h"

// Whole and right, or refused: every format that says how much it holds, cut short at fifty places, and images with
// bits turned over. (.particles and .fcsv do not say it, nor does OBJ of other programs: what is cut off between two
// lines of theirs is missed by nobody.)

namespace fs = std::filesystem;
using namespace homolog;

namespace {

Volume small_volume() {
  Volume volume;
  volume.geometry.dims = {7, 5, 3};
  volume.geometry.spacing_mm = Vec3(0.5, 0.75, 2);
  volume.geometry.origin_mm = Vec3(-10, 20, 5.5);
  std::vector<std::int16_t> voxels(7 * 5 * 3);
  std::mt19937 random(3);
  for (auto& voxel : voxels) voxel = static_cast<std::int16_t>(random());
  volume.data = std::move(voxels);
  return volume;
}

/// Cuts the file at fifty places. `same_or_refused` reads what is left and is true where it is refused or whole.
template <class Check>
void cut(const fs::path& path, const Check& same_or_refused) {
  CAPTURE(path.filename().string());
  const std::string whole = read_whole_file(path).value();
  constexpr std::size_t places = 50;
  for (std::size_t k = 0; k < places; ++k) {
    const std::size_t left = whole.size() * k / places;
    CAPTURE(left);
    write_bytes(path, whole.substr(0, left));
    CHECK(same_or_refused());
  }
  write_bytes(path, whole);
  CHECK(same_or_refused());
}

/// Writes what `write` writes under each name, reads it and cuts it: what is left is refused or `same` as the whole.
template <class Write, class Read, class Same>
void cut_each(const std::vector<std::string>& names, const Write& write, const Read& read, const Same& same) {
  const TemporaryFolder folder;
  for (const std::string& name : names) {
    const fs::path path = folder.path / name;
    REQUIRE(write(path));
    const auto whole = read(path);
    REQUIRE(whole);
    cut(path, [&] {
      const auto left = read(path);
      return !left || same(*left, *whole);
    });
  }
}

}  // namespace

TEST_CASE("an image that is cut short is refused or whole") {
  const Volume volume = small_volume();
  std::vector<std::string> names;
  for (const std::string& ending : volume_format_endings(&VolumeFormat::written)) names.push_back("v" + ending);
  cut_each(
      names, [&](const fs::path& path) { return write_volume(volume, path); },
      [](const fs::path& path) { return read_volume(path); },
      [&](const VolumeRead& left, const VolumeRead&) {
        return left.volume.data == volume.data && same_grid(left.volume.geometry, volume.geometry);
      });
}

TEST_CASE("images of formats that are only read are refused or whole when they are cut short") {
  const TemporaryFolder folder;
  const VolumeReadOptions options{.stack_spacing_mm = Vec3(1, 1, 1)};
  for (const char* seed :
       {"dcm/plain.dcm", "dcm/rle.dcm", "png/grey.png", "png/deep.png", "tif/plain.tif", "tif/zip.tif",
        "tif/packbits.tif", "nrrd/text.nrrd", "nrrd/raw.nrrd", "mha/plain.mha", "mha/packed.mha"}) {
    const fs::path path = folder.path / fs::path(seed).filename();
    fs::copy_file(fs::path(HOMOLOG_SOURCE_DIR) / "tests/fuzz/seeds" / seed, path);
    const auto whole = read_volume(path, options);
    REQUIRE_MESSAGE(whole, whole.error().sentence());
    cut(path, [&] {
      const auto read = read_volume(path, options);
      return !read ||
             (read->volume.data == whole->volume.data && same_grid(read->volume.geometry, whole->volume.geometry));
    });
    fs::remove(path);
  }
}

TEST_CASE("a mesh as OBJ without its last digit is refused") {
  const TemporaryFolder folder;
  const fs::path path = folder.path / "m.obj";
  REQUIRE(write_mesh(icosphere(1, 40), path));
  const std::string whole = read_whole_file(path).value();
  for (const std::size_t lost : {1u, 2u}) {  // the line break, and a digit of the last face
    write_bytes(path, whole.substr(0, whole.size() - lost));
    CHECK(!read_mesh_file(path));
  }
}

TEST_CASE("a bit that is turned over in the voxels of an image changes that voxel alone") {
  const TemporaryFolder folder;
  const Volume volume = small_volume();
  const auto& voxels = std::get<std::vector<std::int16_t>>(volume.data);
  const fs::path path = folder.path / "v.nii";
  REQUIRE(write_volume(volume, path));
  const std::string whole = read_whole_file(path).value();
  const std::size_t block = 2 * voxels.size();
  for (std::size_t k = 0; k < 40; ++k) {
    const std::size_t voxel = k * voxels.size() / 40, bit = k % 16;
    std::string bytes = whole;
    char& changed = bytes[whole.size() - block + 2 * voxel + bit / 8];
    changed = static_cast<char>(changed ^ 1 << bit % 8);
    write_bytes(path, bytes);
    auto expected = voxels;
    expected[voxel] = static_cast<std::int16_t>(expected[voxel] ^ 1 << bit);
    const auto read = read_volume(path);
    REQUIRE(read);
    CHECK(read->volume.data == VoxelData(expected));
  }
}

TEST_CASE("a mesh that is cut short is refused or whole") {
  const Mesh ball = icosphere(1, 40);
  std::vector<std::string> names;
  for (const MeshFormat* format : mesh_formats)
    if (format != &formats::particles) names.push_back(std::string("m") + format->extension);
  cut_each(
      names, [&](const fs::path& path) { return write_mesh(ball, path); },
      [](const fs::path& path) { return read_mesh_file(path); },
      [](const MeshFile& left, const MeshFile& whole) {
        return left.points == whole.points && left.triangles == whole.triangles;
      });
}

TEST_CASE("landmarks and models that are cut short are refused or whole") {
  const std::vector<Landmark> landmarks{{"apex", Vec3(1, 2, 3)}, {"base", Vec3(-4, 5.5, 6)}};
  cut_each(
      {"l.mrk.json", "l.json"}, [&](const fs::path& path) { return write_landmarks(landmarks, path); },
      [](const fs::path& path) { return read_landmarks(path); },
      [&](const std::vector<Landmark>& left, const std::vector<Landmark>&) { return left == landmarks; });
  ShapeMatrix shapes(3 * 12, 3);
  std::mt19937 random(5);
  for (Eigen::Index i = 0; i < shapes.size(); ++i) shapes(i) = static_cast<double>(random() % 1000) / 8;
  const ShapeModel model = make_model(principal_components(shapes), 1, nullptr, {"a", "b", "c"});
  cut_each(
      {"m.h5", "m.h5.json"}, [&](const fs::path& path) { return write_model(model, path); },
      [](const fs::path& path) { return read_model(path); },
      [](const ShapeModel& left, const ShapeModel& whole) {
        return left.mean == whole.mean && left.basis == whole.basis && left.variances == whole.variances;
      });
}
