#include "core/volume/volume_io.h"
#include "core/volume/formats/formats.h"

#include <doctest/doctest.h>
#include <sys/stat.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace fs = std::filesystem;
using namespace homolog;

namespace {

std::string gzipped(const std::string& bytes) {
  z_stream stream{};
  REQUIRE(deflateInit2(&stream, 1, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) == Z_OK);
  std::string packed(deflateBound(&stream, bytes.size()) + 32, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  REQUIRE(deflate(&stream, Z_FINISH) == Z_STREAM_END);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// A NIfTI-1 header written by its byte offsets [nifti1.h], little-endian, of a grid with spacing 1 and an sform.
struct Nifti {
  std::string bytes = std::string(352, '\0');

  explicit Nifti(std::vector<int> dims, int datatype, int bits) {
    put<std::int32_t>(0, 348);
    put(40, static_cast<std::int16_t>(dims.size()));
    for (std::size_t d = 0; d < dims.size(); ++d) put(42 + 2 * d, static_cast<std::int16_t>(dims[d]));
    put(70, static_cast<std::int16_t>(datatype));
    put(72, static_cast<std::int16_t>(bits));
    for (std::size_t d = 0; d < 8; ++d) put(76 + 4 * d, 1.0f);
    put(108, 352.0f);
    sform({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0});
    std::memcpy(&bytes[344], "n+1", 4);
  }
  template <class T>
  void put(std::size_t offset, T value) {
    std::memcpy(&bytes[offset], &value, sizeof value);
  }
  void sform(const std::array<float, 12>& rows) {
    put(254, std::int16_t{1});
    std::memcpy(&bytes[280], rows.data(), sizeof rows);
  }
  void pixdim(std::size_t axis, float value) { put(76 + 4 * axis, value); }
  void units(char value) { bytes[123] = value; }
  void scale(float slope, float intercept) {
    put(112, slope);
    put(116, intercept);
  }
};

/// Writes the bytes under the name into a folder of its own and reads them.
Result<VolumeRead> read_as(const std::string& name, const std::string& bytes) {
  const TemporaryFolder folder;
  write_bytes(folder.path / name, bytes);
  return read_volume(folder.path / name);
}

template <class T>
Volume ramp(const VolumeGeometry& geometry, int frames) {
  std::vector<T> values(geometry.voxels() * static_cast<std::size_t>(frames));
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<T>(i * 37);
  Volume volume;
  volume.geometry = geometry;
  volume.frames = frames;
  volume.frame_seconds = frames > 1 ? 0.04 : 0;
  volume.data = std::move(values);
  return volume;
}

VolumeGeometry grid(bool oblique, bool left_handed) {
  VolumeGeometry geometry;
  geometry.dims = {5, 4, 3};
  geometry.spacing_mm = {0.75, 1.5, 3.25};
  geometry.origin_mm = {-101.5, 22.25, 333.125};
  if (oblique) geometry.direction = Eigen::AngleAxisd(0.7, Vec3(-1, 0.5, 2).normalized()).toRotationMatrix();
  if (left_handed) geometry.direction.col(1) *= -1;
  return geometry;
}

}  // namespace

TEST_CASE("volumes of every type and direction survive being written and read in every format") {
  const TemporaryFolder folder;
  for (const std::string& ending : volume_format_endings(&VolumeFormat::written))
    for (const bool oblique : {false, true})
      for (const bool left_handed : {false, true})
        for (const int frames : {1, 3})
          for (int type = 0; type < 4; ++type) {
            const std::string name = "ä b" + ending;
            CAPTURE(name);
            CAPTURE(type);
            CAPTURE(frames);
            const VolumeGeometry geometry = grid(oblique, left_handed);
            const Volume volume = type == 0   ? ramp<std::uint8_t>(geometry, frames)
                                  : type == 1 ? ramp<std::int16_t>(geometry, frames)
                                  : type == 2 ? ramp<std::uint16_t>(geometry, frames)
                                              : ramp<float>(geometry, frames);
            REQUIRE(write_volume(volume, folder.path / name));
            const auto read = read_volume(folder.path / name);
            REQUIRE(read);
            CHECK(read->warnings.empty());
            const Volume& back = read->volume;
            CHECK(back.data == volume.data);
            CHECK(back.frames == frames);
            CHECK(back.frame_seconds == doctest::Approx(volume.frame_seconds));
            CHECK(same_grid(back.geometry, geometry));
            CHECK((back.geometry.direction - geometry.direction).norm() < 1e-6);
          }
}

TEST_CASE("only known formats are written and a failed write leaves nothing behind") {
  const TemporaryFolder folder;
  const Volume volume = ramp<std::uint8_t>(grid(false, false), 1);
  CHECK(!write_volume(volume, folder.path / "v.dcm"));
  CHECK(!write_volume(volume, folder.path / "absent" / "v.nii.gz"));
  CHECK(fs::is_empty(folder.path));
}

TEST_CASE("a grid beyond sixteen bits is written as NIfTI-2") {
  const TemporaryFolder folder;
  VolumeGeometry geometry;
  geometry.dims = {40000, 2, 1};
  const Volume volume = ramp<std::uint8_t>(geometry, 1);
  REQUIRE(write_volume(volume, folder.path / "v.nii.gz"));
  const auto read = read_volume(folder.path / "v.nii.gz");
  REQUIRE(read);
  CHECK(read->volume.data == volume.data);
}

TEST_CASE("a place that single precision does not hold is written as NIfTI-2") {
  const auto written = [](const Vec3& origin_mm, double spacing_mm) {
    const TemporaryFolder folder;
    VolumeGeometry geometry;
    geometry.dims = {4, 3, 2};
    geometry.origin_mm = origin_mm;
    geometry.spacing_mm = Vec3::Constant(spacing_mm);
    for (const char* name : {"v.nii", "v.nii.gz"}) {
      REQUIRE(write_volume(ramp<std::uint8_t>(geometry, 1), folder.path / name));
      const auto read = read_volume(folder.path / name);
      REQUIRE(read);
      CHECK((read->volume.geometry.origin_mm - origin_mm).norm() < 1e-3 * spacing_mm);
      CHECK(read->volume.geometry.spacing_mm[0] == doctest::Approx(spacing_mm));
    }
    std::ifstream in(folder.path / "v.nii", std::ios::binary);
    std::int32_t header_bytes = 0;
    in.read(reinterpret_cast<char*>(&header_bytes), sizeof header_bytes);
    return header_bytes;
  };
  constexpr std::int32_t first = 348, second = 540;
  CHECK(written(Vec3(-117.855, 35.7229, -7.2488), 0.7) == first);
  CHECK(written(Vec3(448251.3, -5411932.3, 300), 1) == second);
  CHECK(written(Vec3(0, 0, 20000.3), 0.5) == second);
  CHECK(written(Vec3(117.855, 0, 0), 0.001) == second);  // micrometres
  CHECK(written(Vec3::Zero(), 1e-50) == second);
}

TEST_CASE("integers go to the smallest type that holds them and floats stay floats") {
  const auto type_of = [](int datatype, auto values) {
    const int bits = static_cast<int>(8 * sizeof(values[0]));
    const auto read = read_as("v.nii", Nifti({2, 1, 1}, datatype, bits).bytes + bytes_of(values));
    REQUIRE(read);
    CHECK(read->volume.range_min == static_cast<double>(values[0]));
    CHECK(read->volume.range_max == static_cast<double>(values[1]));
    CHECK(read->volume.at(1, 0, 0) == static_cast<double>(values[1]));
    return std::string(voxel_type_name(read->volume.data));
  };
  CHECK(type_of(2, std::vector<std::uint8_t>{0, 255}) == "uint8");
  CHECK(type_of(4, std::vector<std::int16_t>{0, 5}) == "int16");
  CHECK(type_of(512, std::vector<std::uint16_t>{0, 5}) == "uint16");
  CHECK(type_of(256, std::vector<std::int8_t>{-3, 5}) == "int16");
  CHECK(type_of(8, std::vector<std::int32_t>{0, 200}) == "uint8");
  CHECK(type_of(8, std::vector<std::int32_t>{-1, 30000}) == "int16");
  CHECK(type_of(768, std::vector<std::uint32_t>{0, 65535}) == "uint16");
  CHECK(type_of(1024, std::vector<std::int64_t>{-1, 65535}) == "float32");
  CHECK(type_of(1280, std::vector<std::uint64_t>{0, 300}) == "int16");
  // The first that no longer fit.
  CHECK(type_of(8, std::vector<std::int32_t>{0, 255}) == "uint8");
  CHECK(type_of(8, std::vector<std::int32_t>{0, 256}) == "int16");
  CHECK(type_of(8, std::vector<std::int32_t>{-32768, 32767}) == "int16");
  CHECK(type_of(8, std::vector<std::int32_t>{-32769, 0}) == "float32");
  CHECK(type_of(8, std::vector<std::int32_t>{0, 32768}) == "uint16");
  CHECK(type_of(8, std::vector<std::int32_t>{0, 65536}) == "float32");
  CHECK(type_of(16, std::vector<float>{0, 1}) == "float32");
  CHECK(type_of(64, std::vector<double>{-1.5, 2.5}) == "float32");
}

TEST_CASE("integers that floats round are read with a warning and doubles beyond floats are refused") {
  const auto rounded = read_as("v.nii", Nifti({2, 1, 1}, 8, 32).bytes + bytes_of<std::int32_t>({-1, 100000001}));
  REQUIRE(rounded);
  CHECK(rounded->warnings.size() == 1);
  CHECK(says(read_as("v.nii", Nifti({2, 1, 1}, 64, 64).bytes + bytes_of<double>({0, 1e300})), "3.4e38"));
}

TEST_CASE("the range leaves out what is not finite") {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinite = std::numeric_limits<float>::infinity();
  std::vector<float> values(20, 1);
  values[0] = nan;
  values[3] = -infinite;
  values[11] = infinite;
  values[12] = -4;
  values[19] = 9;
  const auto read = read_as("v.nii", Nifti({20, 1, 1}, 16, 32).bytes + bytes_of(values));
  REQUIRE(read);
  CHECK(read->volume.range_min == -4);
  CHECK(read->volume.range_max == 9);
}

TEST_CASE("slope and intercept are applied and integers stay integers where they can") {
  Nifti header({2, 1, 1}, 512, 16);
  header.scale(1, -1024);
  const auto hounsfield = read_as("v.nii", header.bytes + bytes_of<std::uint16_t>({0, 4095}));
  REQUIRE(hounsfield);
  CHECK(hounsfield->volume.data == VoxelData(std::vector<std::int16_t>{-1024, 3071}));
  header.scale(0.5f, 1);
  const auto halves = read_as("v.nii", header.bytes + bytes_of<std::uint16_t>({0, 3}));
  REQUIRE(halves);
  CHECK(halves->volume.data == VoxelData(std::vector<float>{1, 2.5}));
  header.scale(0, 5);  // a slope of 0 means that there is none
  const auto plain = read_as("v.nii", header.bytes + bytes_of<std::uint16_t>({0, 3}));
  REQUIRE(plain);
  CHECK(plain->volume.data == VoxelData(std::vector<std::uint16_t>{0, 3}));
}

TEST_CASE("NIfTI goes from RAS to LPS in mm whatever its units") {
  Nifti header({1, 1, 1, 2}, 2, 8);
  header.sform({2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30});
  header.pixdim(4, 50);
  header.units(2 | 16);  // mm and milliseconds
  const auto read = read_as("v.nii", header.bytes + "ab");
  REQUIRE(read);
  const VolumeGeometry& g = read->volume.geometry;
  CHECK((g.origin_mm - Vec3(-10, -20, 30)).norm() < 1e-9);
  CHECK((g.direction - Mat3(Vec3(-1, -1, 1).asDiagonal())).norm() < 1e-9);
  CHECK((g.spacing_mm - Vec3(2, 3, 4)).norm() < 1e-9);
  CHECK(read->volume.frames == 2);
  CHECK(read->volume.frame_seconds == doctest::Approx(0.05));
  header.units(1 | 8);  // metres and seconds
  const auto metres = read_as("v.nii", header.bytes + "ab");
  REQUIRE(metres);
  CHECK((metres->volume.geometry.origin_mm - Vec3(-10000, -20000, 30000)).norm() < 1e-6);
  CHECK(metres->volume.frame_seconds == doctest::Approx(50));
}

TEST_CASE("a sheared sform is refused unless a qform stands in for it") {
  Nifti header({1, 1, 1}, 2, 8);
  header.sform({1, 0.3f, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0});
  CHECK(says(read_as("v.nii", header.bytes + "a"), "sheared"));
  header.put(252, std::int16_t{1});  // a qform: no rotation, shifted by 7
  header.put(268, 7.0f);
  const auto read = read_as("v.nii", header.bytes + "a");
  REQUIRE(read);
  CHECK(read->warnings.size() == 1);
  CHECK(read->volume.geometry.origin_mm[0] == doctest::Approx(-7));
}

TEST_CASE("both byte orders of NIfTI hold the same volume") {
  Nifti header({2, 1, 1}, 4, 16);
  std::string swapped = header.bytes + bytes_of<std::int16_t>({-2, 300});
  const auto swap = [&swapped](std::size_t begin, std::size_t end, std::size_t size) {
    for (std::size_t i = begin; i < end; i += size) std::reverse(&swapped[i], &swapped[i] + size);
  };
  swap(0, 4, 4);
  swap(40, 56, 2);
  swap(68, 76, 2);
  swap(76, 112, 4);
  swap(252, 256, 2);
  swap(280, 328, 4);
  swap(352, 356, 2);
  const auto little = read_as("v.nii", header.bytes + bytes_of<std::int16_t>({-2, 300})),
             big = read_as("v.nii", swapped);
  REQUIRE(little);
  REQUIRE(big);
  CHECK(big->volume.data == little->volume.data);
  CHECK(big->volume.geometry == little->volume.geometry);
}

TEST_CASE("pairs of header and voxels are found by either name and compressed or not") {
  Nifti header({2, 1, 1}, 2, 8);
  std::memcpy(&header.bytes[344], "ni1", 4);
  header.put(108, 0.0f);
  header.bytes.resize(348);
  const TemporaryFolder folder;
  write_bytes(folder.path / "a.hdr", header.bytes);
  CHECK(says(read_volume(folder.path / "a.hdr"), "a.img"));
  write_bytes(folder.path / "a.img", "xy");
  write_bytes(folder.path / "b.hdr.gz", gzipped(header.bytes));
  write_bytes(folder.path / "b.img.gz", gzipped("xy"));
  write_bytes(folder.path / "c.hdr", header.bytes);
  write_bytes(folder.path / "c.img.gz", gzipped("xy"));
  for (const char* name : {"a.hdr", "a.img", "b.hdr.gz", "b.img.gz", "c.hdr", "c.img.gz"}) {
    CAPTURE(std::string(name));
    const auto read = read_volume(folder.path / name);
    REQUIRE(read);
    CHECK(read->volume.data == VoxelData(std::vector<std::uint8_t>{'x', 'y'}));
  }
}

TEST_CASE("a compressed name never stands for its uncompressed neighbour") {
  const TemporaryFolder folder;
  const Nifti header({1, 1, 1}, 2, 8);
  write_bytes(folder.path / "a.nii", header.bytes + "p");
  CHECK(says(read_volume(folder.path / "a.nii.gz"), "does not exist"));
  write_bytes(folder.path / "a.nii.gz", gzipped(header.bytes + "q"));
  CHECK(read_volume(folder.path / "a.nii")->volume.range_max == 'p');
  CHECK(read_volume(folder.path / "a.nii.gz")->volume.range_max == 'q');
}

TEST_CASE("vectors and colours and five dimensions get a sentence") {
  CHECK(says(read_as("v.nii", Nifti({1, 1, 1, 1, 3}, 2, 8).bytes + "abc"), "four dimensions"));
  CHECK(says(read_as("v.nii", Nifti({1, 1, 1}, 128, 24).bytes + "abc"), "RGB"));
  CHECK(says(read_as("v.nii", Nifti({1, 1, 1}, 32, 64).bytes + "abcdefgh"), "COMPLEX"));
  const std::string nrrd =
      "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 3 1 1 1\nkinds: vector domain domain domain\n"
      "endian: little\nencoding: raw\n\nabc";
  CHECK(says(read_as("v.nrrd", nrrd), "several values"));
  const std::string meta =
      "NDims = 3\nDimSize = 1 1 1\nElementNumberOfChannels = 3\nElementType = MET_UCHAR\n"
      "ElementDataFile = LOCAL\nabc";
  CHECK(says(read_as("v.mha", meta), "several values"));
}

TEST_CASE("sizes that no file holds are refused before memory is taken for them") {
  const Nifti huge({32000, 32000, 32000}, 16, 32);
  CHECK(says(read_as("v.nii", huge.bytes + "abcd"), "cut short"));
  CHECK(says(read_as("v.nii.gz", gzipped(huge.bytes + "abcd")), "far too small"));
  CHECK(says(read_as("v.nii", Nifti({-4, 2, 2}, 2, 8).bytes + "abcd"), "NIfTI"));
  const std::string sizes = "sizes: 2000000000 2000000000 2000000000\n";
  const std::string nrrd = "NRRD0004\ntype: uint8\ndimension: 3\n" + sizes + "encoding: ";
  for (const char* encoding : {"raw", "gzip", "bzip2", "ascii"}) {
    CAPTURE(std::string(encoding));
    CHECK(!read_as("v.nrrd", nrrd + encoding + "\n\nabcd"));
  }
  const std::string meta = "NDims = 3\nDimSize = 2000000000 2000000000 2000000000\nElementType = MET_UCHAR\n";
  CHECK(!read_as("v.mha", meta + "ElementDataFile = LOCAL\nabcd"));
  CHECK(!read_as("v.mha", "NDims = 100\nDimSize = 1\nElementType = MET_UCHAR\nElementDataFile = LOCAL\nabcd"));
}

TEST_CASE("a volume larger than memory is refused with both sizes") {
  const TemporaryFolder folder;
  const fs::path path = folder.path / "large.nii";
  write_bytes(path, Nifti({30000, 30000, 5000}, 16, 32).bytes);
  std::error_code no_sparse_files;
  fs::resize_file(path, 352 + std::uintmax_t{4} * 30000 * 30000 * 5000, no_sparse_files);
  if (no_sparse_files) return;
  CHECK(says(read_volume(path), "needs 18000.0 GB"));
}

TEST_CASE("a cancelled reader says so and a finished one reports the whole") {
  const TemporaryFolder folder;
  VolumeGeometry geometry;
  geometry.dims = {64, 64, 64};
  REQUIRE(write_volume(ramp<float>(geometry, 1), folder.path / "v.nii.gz"));
  Progress progress;
  VolumeReadOptions options;
  options.progress = &progress;
  REQUIRE(read_volume(folder.path / "v.nii.gz", options));
  CHECK(progress.fraction() == 1);
  progress.cancel();
  CHECK(says(read_volume(folder.path / "v.nii.gz", options), "cancelled"));
}

TEST_CASE("every shortened copy of a volume is refused") {
  const TemporaryFolder folder;
  for (const char* name : {"v.nii", "v.nii.gz", "v.nrrd", "v.mha"}) {
    CAPTURE(std::string(name));
    REQUIRE(write_volume(ramp<std::int16_t>(grid(true, false), 2), folder.path / name));
    const std::uintmax_t size = fs::file_size(folder.path / name);
    for (std::uintmax_t left = size - 1; left < size; --left) {
      CAPTURE(left);
      fs::resize_file(folder.path / name, left);
      CHECK(!read_volume(folder.path / name));
    }
  }
}

TEST_CASE("a damaged gzip is noticed by its checksum") {
  std::string packed = gzipped(Nifti({4, 1, 1}, 2, 8).bytes + "abcd");
  packed[packed.size() - 6] ^= 1;
  CHECK(says(read_as("v.nii.gz", packed), "damaged"));
}

TEST_CASE("gzip streams behind one another are read as one") {
  const std::string whole = Nifti({4, 1, 1}, 2, 8).bytes + "abcd";
  const auto read = read_as("v.nii.gz", gzipped(whole.substr(0, 354)) + gzipped(whole.substr(354)));
  REQUIRE(read);
  CHECK(read->volume.range_max == 'd');
}

TEST_CASE("NRRD spaces are turned to LPS") {
  const auto read_in = [](const std::string& space) {
    return read_as("v.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nspace: " + space +
                                 "\nsizes: 1 1 1\nspace directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (5,6,7)\n"
                                 "encoding: raw\n\na");
  };
  const auto lps = read_in("left-posterior-superior"), ras = read_in("RAS"), las = read_in("LAS");
  REQUIRE(lps);
  REQUIRE(ras);
  REQUIRE(las);
  CHECK((lps->volume.geometry.to_mm({1, 1, 1}) - Vec3(7, 9, 11)).norm() < 1e-12);
  CHECK((ras->volume.geometry.to_mm({1, 1, 1}) - Vec3(-7, -9, 11)).norm() < 1e-12);
  CHECK((las->volume.geometry.to_mm({1, 1, 1}) - Vec3(7, -9, 11)).norm() < 1e-12);
  CHECK(lps->warnings.empty());
  CHECK(read_in("scanner-xyz")->warnings.size() == 1);
}

TEST_CASE("NRRD frames are found before or behind the axes of space") {
  const std::string start = "NRRD0004\ntype: uint8\ndimension: 4\nspace: LPS\n";
  const std::string directions = "(1,0,0) (0,1,0) (0,0,1)", end = "\nspace origin: (0,0,0)\nencoding: raw\n\n";
  const auto behind =
      read_as("v.nrrd", start + "sizes: 3 1 1 2\nkinds: domain domain domain time\nspace directions: " + directions +
                            " none" + end + "abcxyz");
  const auto before =
      read_as("v.seq.nrrd", start + "sizes: 2 3 1 1\nkinds: list domain domain domain\nspace directions: none " +
                                directions + end + "axbycz");
  REQUIRE(behind);
  REQUIRE(before);
  CHECK(behind->volume.frames == 2);
  CHECK(behind->volume.geometry.dims == std::array{3, 1, 1});
  CHECK(behind->volume.data == VoxelData(std::vector<std::uint8_t>{'a', 'b', 'c', 'x', 'y', 'z'}));
  CHECK(before->volume.data == behind->volume.data);
  CHECK(before->volume.geometry == behind->volume.geometry);
}

TEST_CASE("NRRD skips lines before and bytes within compressed voxels") {
  const TemporaryFolder folder;
  const std::string header = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 1 1\nencoding: ";
  write_bytes(folder.path / "v.dat", "a line\nanother\n" + gzipped("12345ab"));
  write_bytes(folder.path / "v.nhdr", header + "gzip\nline skip: 2\nbyte skip: 5\ndata file: v.dat\n");
  const auto read = read_volume(folder.path / "v.nhdr");
  REQUIRE(read);
  CHECK(read->volume.data == VoxelData(std::vector<std::uint8_t>{'a', 'b'}));
  write_bytes(folder.path / "w.dat", "12345ab");
  write_bytes(folder.path / "w.nhdr", header + "raw\nbyte skip: 5\ndata file: w.dat\n");
  CHECK(read_volume(folder.path / "w.nhdr")->volume.data == read->volume.data);
  write_bytes(folder.path / "x0.dat", "a");
  write_bytes(folder.path / "x1.dat", "b");
  write_bytes(folder.path / "x.nhdr",
              "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 1 1 2\nencoding: raw\ndata file: LIST\nx0.dat\nx1.dat\n");
  const auto from_list = read_volume(folder.path / "x.nhdr");
  REQUIRE(from_list);
  CHECK(from_list->volume.data == read->volume.data);
  fs::remove(folder.path / "w.dat");
  CHECK(!read_volume(folder.path / "w.nhdr"));
}

TEST_CASE("MetaImage takes voxels from the end of a file and in either byte order") {
  const TemporaryFolder folder;
  write_bytes(folder.path / "v.raw", std::string("12345") + '\1' + '\2');
  const std::string header = "NDims = 3\nDimSize = 1 1 1\nElementType = MET_USHORT\nHeaderSize = -1\n";
  write_bytes(folder.path / "l.mhd", header + "BinaryDataByteOrderMSB = False\nElementDataFile = v.raw\n");
  write_bytes(folder.path / "b.mhd", header + "BinaryDataByteOrderMSB = True\nElementDataFile = v.raw\n");
  CHECK(read_volume(folder.path / "l.mhd")->volume.range_max == 0x0201);
  CHECK(read_volume(folder.path / "b.mhd")->volume.range_max == 0x0102);
  write_bytes(folder.path / "t.mhd",
              "NDims = 3\nDimSize = 1 1 1\nElementType = MET_USHORT\nBinaryData = False\n"
              "ElementDataFile = v.raw\n");
  CHECK(says(read_volume(folder.path / "t.mhd"), "as text"));
}

TEST_CASE("a MetaImage that was cut off takes no voxels from its own header") {
  const std::string header =
      "NDims = 3\nDimSize = 2 2 1\nElementType = MET_UCHAR\nHeaderSize = -1\nElementDataFile = LOCAL\n";
  const auto whole = read_as("v.mha", header + "abcd");
  REQUIRE(whole);
  CHECK(whole->volume.data == VoxelData(std::vector<std::uint8_t>{'a', 'b', 'c', 'd'}));
  for (const char* cut : {"", "a", "abc"}) CHECK(says(read_as("v.mha", header + cut), "v.mha: is cut short"));
}

TEST_CASE("what is no volume is refused by name") {
  const TemporaryFolder folder;
  CHECK(says(read_volume(folder.path / "absent.nii"), "does not exist"));
  CHECK(says(read_volume(folder.path), "holds neither"));
  CHECK(says(read_as("text.txt", "hello"), "is not a volume"));
  for (const char* name :
       {"v.nii", "v.nii.gz", "v.hdr", "v.img", "v.nrrd", "v.nhdr", "v.mha", "v.mhd", "v.dcm", "v.png"})
    for (const std::string& content :
         {std::string(), std::string("hello"), std::string(1000, '\xff'), std::string(1000, '\0')}) {
      CAPTURE(std::string(name));
      CHECK(!read_as(name, content));
    }
  CHECK(
      says(read_as("v.nii.gz", "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n"), "git lfs pull"));
}

TEST_CASE("voxels of NIfTI begin where the header says or the file is refused") {
  const float infinite = std::numeric_limits<float>::infinity(), no_number = std::numeric_limits<float>::quiet_NaN();
  Nifti single({4, 1, 1}, 2, 8);
  for (const float begin : {0.0f, 1.0f, 344.0f, 347.0f, 348.0f, 351.0f, 352.5f, -1.0f, -352.0f, 1e9f, 1e30f, -1e30f,
                            infinite, -infinite, no_number}) {
    CAPTURE(begin);
    single.put(108, begin);
    CHECK(!read_as("v.nii", single.bytes + "abcdefgh"));
    CHECK(!read_as("v.nii.gz", gzipped(single.bytes + "abcdefgh")));
  }
  for (const float begin : {352.0f, 355.0f}) {
    single.put(108, begin);
    const std::size_t before = begin == 352 ? 0 : 3;
    const auto read = read_as("v.nii", single.bytes + std::string("abcdefgh").substr(0, before + 4));
    REQUIRE(read);
    CHECK(read->volume.range_min == (begin == 352 ? 'a' : 'd'));
  }
  CHECK(says(read_as("v.nii", Nifti({4, 1, 1}, 2, 8).bytes.substr(0, 108) + std::string(244, '\0') + "abcd"),
             "within its own header"));
}

TEST_CASE("voxels of a NIfTI pair begin anywhere in their own file") {
  const TemporaryFolder folder;
  Nifti header({2, 1, 1}, 2, 8);
  std::memcpy(&header.bytes[344], "ni1", 4);
  for (const float begin : {0.0f, 2.0f, 3.0f, -2.0f, 0.5f, std::numeric_limits<float>::quiet_NaN()}) {
    CAPTURE(begin);
    header.put(108, begin);
    write_bytes(folder.path / "v.hdr", header.bytes.substr(0, 348));
    write_bytes(folder.path / "v.img", begin == 0 ? "ab" : "abcd");
    const auto read = read_volume(folder.path / "v.hdr");
    CHECK(read.has_value() == (begin == 0 || begin == 2));
    if (read) CHECK(read->volume.range_min == (begin == 0 ? 'a' : 'c'));
  }
}

TEST_CASE("the voxels of NIfTI-2 begin behind its longer header") {
  VolumeGeometry geometry;
  geometry.dims = {40000, 1, 1};
  const TemporaryFolder folder;
  const fs::path path = folder.path / "v.nii";
  REQUIRE(write_volume(ramp<std::uint8_t>(geometry, 1), path));
  REQUIRE(read_volume(path));
  for (const std::int64_t begin :
       {std::int64_t{0}, std::int64_t{352}, std::int64_t{540}, std::int64_t{543}, std::int64_t{-544},
        std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::min()}) {
    CAPTURE(begin);
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(168);
    file.write(reinterpret_cast<const char*>(&begin), sizeof begin);
    file.close();
    CHECK(!read_volume(path));
  }
}

TEST_CASE("a voxel's size that is not said is assumed with a warning and one below zero refused") {
  const auto warns = [](const Result<VolumeRead>& read) {
    return read && std::any_of(read->warnings.begin(), read->warnings.end(), [](const std::string& warning) {
             return warning.find("1 mm is assumed") != std::string::npos;
           });
  };
  Nifti nifti({2, 2, 1}, 2, 8);
  nifti.pixdim(1, 0);
  CHECK_FALSE(warns(read_as("v.nii", nifti.bytes + "abcd")));  // its sform says it
  nifti.put(254, std::int16_t{0});
  CHECK(warns(read_as("v.nii", nifti.bytes + "abcd")));
  nifti.pixdim(1, 1);
  CHECK_FALSE(warns(read_as("v.nii", nifti.bytes + "abcd")));
  const std::string nrrd = "NRRD0004\ntype: uchar\ndimension: 3\nencoding: raw\nsizes: 2 2 1\n";
  CHECK(warns(read_as("v.nrrd", nrrd + "spacings: nan 1 1\n\nabcd")));
  CHECK_FALSE(warns(read_as("v.nrrd", nrrd + "spacings: 2 1 1\n\nabcd")));
  const std::string meta = "NDims = 3\nDimSize = 2 2 1\nElementType = MET_UCHAR\n",
                    end = "ElementDataFile = LOCAL\nabcd";
  CHECK(warns(read_as("v.mha", meta + end)));
  CHECK_FALSE(warns(read_as("v.mha", meta + "ElementSpacing = 1 1 1\n" + end)));
  CHECK(!read_as("v.mha", meta + "ElementSpacing = -1 1 1\n" + end));
}

TEST_CASE("headers that contradict themselves are refused") {
  Nifti bits({4, 1, 1}, 2, 64);
  CHECK(says(read_as("v.nii", bits.bytes + "abcd"), "64 bits"));
  Nifti scaled({4, 1, 1}, 2, 8);
  scaled.scale(std::numeric_limits<float>::infinity(), 0);
  CHECK(says(read_as("v.nii", scaled.bytes + "abcd"), "not finite"));
  scaled.scale(2, std::numeric_limits<float>::quiet_NaN());
  CHECK(says(read_as("v.nii", scaled.bytes + "abcd"), "not finite"));
  CHECK(!read_as("v.nrrd", "NRRD0004\ntype: uchar\ndimension: 1\nencoding: raw\nsizes: 4.5\n\nabcd"));
  for (const char* sizes : {"sizes: 2 2 1.5", "Sizes: 2 2 1.5", "SIZES:2 2 1e0", "sizes: 2 2 1x", "sizes: 0 2 1"}) {
    CAPTURE(std::string(sizes));
    const std::string header = "NRRD0004\ntype: uchar\ndimension: 3\nencoding: raw\n";
    CHECK(says(read_as("v.nrrd", header + sizes + "\n\nabcd"), "sizes that are no whole numbers above 0"));
  }
  const std::string meta = "NDims = 3\nDimSize = 2 2 1\nElementSpacing = 1 1 1\nElementType = MET_UCHAR\n";
  CHECK(!read_as("v.mha", meta + "DimSize = 1 2 1\nElementDataFile = LOCAL\nabcd"));
  CHECK(says(read_as("v.mha", meta + "HeaderSize = 4\nElementDataFile = LOCAL\nabcd"), "HeaderSize"));
}

TEST_CASE("numbers of MetaImage that are no numbers or no place are refused") {
  const std::string start = "NDims = 3\nDimSize = 2 1 1\nElementType = MET_UCHAR\n",
                    end = "ElementDataFile = LOCAL\nab";
  REQUIRE(read_as("v.mha", start + end));
  for (const char* line : {"ElementSpacing = 1 1", "ElementSpacing = 1 nan 1", "Offset = 1 2", "Offset = 0 0 inf",
                           "TransformMatrix = 1 0 0 0 1 0 0 0", "HeaderSize = 100000", "HeaderSize = -2",
                           "HeaderSize = nan", "HeaderSize = 1.5", "HeaderSize = x"}) {
    CAPTURE(std::string(line));
    CHECK(!read_as("v.mha", start + line + "\n" + end));
  }
  CHECK(!read_as("v.mha", "NDims = 3\nDimSize = 2.5 1 1\nElementType = MET_UCHAR\n" + end));
}

TEST_CASE("pipes and devices are refused at once and links that lead nowhere are not called absent") {
  const TemporaryFolder folder;
  for (const char* name :
       {"v.nii", "v.nii.gz", "v.hdr", "v.img", "v.nrrd", "v.nhdr", "v.mha", "v.mhd", "v.dcm", "v.png", "v.tif", "v"}) {
    CAPTURE(std::string(name));
    REQUIRE(::mkfifo((folder.path / name).c_str(), 0600) == 0);
    CHECK(says(read_volume(folder.path / name), "device or a pipe"));
    CHECK(!is_picture_stack(folder.path / name));
    fs::remove(folder.path / name);
    fs::create_symlink("/dev/zero", folder.path / name);
    CHECK(says(read_volume(folder.path / name), "device or a pipe"));
    fs::remove(folder.path / name);
    fs::create_symlink(name, folder.path / name);  // a circle
    CHECK(says(read_volume(folder.path / name), "cannot be read"));
    fs::remove(folder.path / name);
  }
  write_bytes(folder.path / "v.mhd", "NDims = 3\nDimSize = 2 1 1\nElementType = MET_UCHAR\nElementDataFile = voxels\n");
  Nifti header({2, 1, 1}, 2, 8);
  write_bytes(folder.path / "w.hdr", header.bytes);
  REQUIRE(::mkfifo((folder.path / "voxels").c_str(), 0600) == 0);
  REQUIRE(::mkfifo((folder.path / "w.img").c_str(), 0600) == 0);
  CHECK(says(read_volume(folder.path / "v.mhd"), "device or a pipe"));
  CHECK(says(read_volume(folder.path / "w.hdr"), "device or a pipe"));
}

TEST_CASE("what is packed behind the voxels without end is refused in time") {
  const std::string zeros(std::size_t{1} << 20, '\0');
  std::string streams;
  const std::string packed = gzipped(zeros);
  for (int i = 0; i < 300; ++i) streams += packed;
  CHECK(says(read_as("v.nii.gz", gzipped(Nifti({4, 1, 1}, 2, 8).bytes + "abcd") + streams),
             "more voxels than its header says"));
}

TEST_CASE("SPM's scale factor in an Analyze header is applied and said") {
  const TemporaryFolder folder;
  Nifti header({2, 1, 1}, 4, 16);
  std::memset(&header.bytes[252], 0, 96);  // the header of before NIfTI: no magic word and no sform
  header.put(108, 0.0f);
  write_bytes(folder.path / "v.img", bytes_of<std::int16_t>({-2, 300}));
  const auto read = [&] {
    write_bytes(folder.path / "v.hdr", header.bytes.substr(0, 348));
    return *read_volume(folder.path / "v.img");
  };
  CHECK(read().volume.range_max == 300);
  CHECK(read().warnings.size() == 1);
  header.put(112, 0.25f);
  CHECK(read().volume.range_max == 75);
  CHECK(read().volume.range_min == -0.5);
  const auto warnings = read().warnings;
  CHECK(std::any_of(warnings.begin(), warnings.end(), [](const std::string& warning) {
    return warning.find("multiplied by 0.25, the scale factor of SPM") != std::string::npos;
  }));
  header.put(112, 1.0f);
  CHECK(read().volume.range_max == 300);
  std::memcpy(&header.bytes[56], "cm", 2);
  CHECK(read().volume.geometry.spacing_mm == Vec3(10, 10, 10));
  header.put(112, std::numeric_limits<float>::infinity());
  write_bytes(folder.path / "v.hdr", header.bytes.substr(0, 348));
  CHECK(says(read_volume(folder.path / "v.img"), "not finite"));
}
