#include "core/base/pictures/picture_io.h"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>

#include <fstream>

#include "core/base/files/files.h"
#include "core/volume/volume_io.h"
#include "tests/refusal.h"
#include "tests/small_files.h"
#include "tests/temporary_folder.h"

namespace fs = std::filesystem;
using namespace homolog;

namespace {

/// An uncompressed greyscale TIFF of 16 bits with one strip a page [TIFF 6.0, §2].
std::string tiff(std::uint32_t width, std::uint32_t height, const std::vector<std::vector<std::uint16_t>>& pages) {
  std::string bytes = "II" + little_endian(42, 2) + little_endian(8, 4);
  for (std::size_t p = 0; p < pages.size(); ++p) {
    constexpr std::uint32_t entries = 8;
    const auto begin = static_cast<std::uint32_t>(bytes.size());
    const std::uint32_t strip = begin + 2 + 12 * entries + 4, strip_bytes = 2 * width * height;
    bytes += little_endian(entries, 2);
    const auto entry = [&bytes](std::uint32_t tag, std::uint32_t type, std::uint32_t value) {
      bytes += little_endian(tag, 2) + little_endian(type, 2) + little_endian(1, 4) + little_endian(value, 4);
    };
    constexpr std::uint32_t is_short = 3, is_long = 4;
    entry(256, is_long, width);
    entry(257, is_long, height);
    entry(258, is_short, 16);
    entry(259, is_short, 1);
    entry(262, is_short, 1);
    entry(273, is_long, strip);
    entry(278, is_long, height);
    entry(279, is_long, strip_bytes);
    bytes += little_endian(p + 1 < pages.size() ? strip + strip_bytes : 0, 4);
    for (const std::uint16_t value : pages[p]) bytes += little_endian(value, 2);
  }
  return bytes;
}

const VolumeReadOptions with_spacing{.stack_spacing_mm = Vec3(0.5, 0.5, 3)};

/// Writes a slice of one voxel for each number, and reads the folder.
Result<VolumeRead> stack(const TemporaryFolder& folder, const std::vector<std::int64_t>& numbers) {
  for (const std::int64_t number : numbers)
    write_bytes(folder.path / ("s" + std::to_string(number) + ".tif"), tiff(1, 1, {{1}}));
  return read_volume(folder.path, with_spacing);
}

std::string big_endian(std::uint32_t value) {
  const std::string bytes = little_endian(value, 4);
  return {bytes.rbegin(), bytes.rend()};
}

/// A chunk with its checksum [PNG, §5.3].
std::string chunk(const std::string& name, const std::string& content) {
  const std::string checked = name + content;
  const uLong checksum = crc32_z(0, reinterpret_cast<const Bytef*>(checked.data()), checked.size());
  return big_endian(static_cast<std::uint32_t>(content.size())) + checked +
         big_endian(static_cast<std::uint32_t>(checksum));
}

/// A greyscale PNG; `rows` are its pixels as they are before Deflate, each row behind its filter.
std::string png(std::uint32_t width, std::uint32_t height, char bits, const std::string& rows,
                const std::string& before_pixels = {}) {
  std::string packed(compressBound(rows.size()), '\0');
  uLongf size = packed.size();
  REQUIRE(compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(rows.data()),
                   rows.size()) == Z_OK);
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", big_endian(width) + big_endian(height) + bits + std::string(4, '\0')) +
         before_pixels + chunk("IDAT", packed.substr(0, size)) + chunk("IEND", "");
}

Result<VolumeRead> read_picture_bytes(const std::string& name, const std::string& bytes) {
  const TemporaryFolder folder;
  write_bytes(folder.path / name, bytes);
  return read_volume(folder.path / name, with_spacing);
}

/// What `work` prints on stderr, whoever prints it.
template <class Work>
std::string printed_by(const Work& work) {
  const TemporaryFolder folder;
  const int before = ::dup(STDERR_FILENO), file = ::open((folder.path / "e").c_str(), O_WRONLY | O_CREAT, 0600);
  ::dup2(file, STDERR_FILENO);
  work();
  ::dup2(before, STDERR_FILENO);
  ::close(before);
  ::close(file);
  return read_whole_file(folder.path / "e").value_or("unreadable");
}

}  // namespace

TEST_CASE("a picture survives being written and read with its transparency") {
  const TemporaryFolder folder;
  Picture picture{3, 2, {}};
  for (int i = 0; i < 24; ++i) picture.rgba.push_back(static_cast<std::uint8_t>(i * 10));
  REQUIRE(write_picture(picture, folder.path / "ö.png"));
  const auto read = read_picture(folder.path / "ö.png");
  REQUIRE(read);
  CHECK(read->width == 3);
  CHECK(read->height == 2);
  CHECK(read->rgba == picture.rgba);
}

TEST_CASE("a picture on a full disk is refused and the old one stays") {
  const TemporaryFolder folder;
  Picture picture{100, 100, std::vector<std::uint8_t>(40000)};
  std::uint32_t noise = 1;
  for (auto& value : picture.rgba) value = static_cast<std::uint8_t>((noise = noise * 1664525 + 1013904223) >> 24);
  for (const char* name : {"a.png", "a.tif", "a.jpg", "a.bmp", "a.tga", "a.exr"}) {
    CAPTURE(name);
    write_bytes(folder.path / name, "old");
    Result<void> written;
    {
      const SmallFilesOnly full(4096);
      written = write_picture(picture, folder.path / name);
    }
    CHECK(says(written, "cannot be written"));
    CHECK(read_whole_file(folder.path / name).value() == "old");
    REQUIRE(write_picture(picture, folder.path / name));
    CHECK(fs::file_size(folder.path / name) > 4096);
  }
  CHECK(says(write_picture(picture, folder.path / "a.txt"), "no kind of picture"));
}

TEST_CASE("pictures that are damaged or absent or of no known kind get a sentence") {
  const TemporaryFolder folder;
  Picture picture{40, 40, std::vector<std::uint8_t>(6400)};
  for (std::size_t i = 0; i < picture.rgba.size(); ++i) picture.rgba[i] = static_cast<std::uint8_t>(i * i % 251);
  CHECK(!write_picture(picture, folder.path / "a.unknown"));
  CHECK(!read_picture(folder.path / "absent.png"));
  REQUIRE(write_picture(picture, folder.path / "a.png"));
  for (std::uintmax_t left = fs::file_size(folder.path / "a.png") * 3 / 4; left > 0; left /= 2) {
    fs::resize_file(folder.path / "a.png", left);
    CHECK(!read_picture(folder.path / "a.png"));
  }
}

TEST_CASE("slices in a folder are stacked in the order of the numbers in their names") {
  const TemporaryFolder folder;
  for (std::uint16_t s = 1; s <= 11; ++s)
    write_bytes(folder.path / ("slice" + std::to_string(s) + ".tif"), tiff(2, 2, {{s, 0, 0, 60000}}));
  CHECK(looks_like_volume(folder.path));
  CHECK(says(read_volume(folder.path), "--spacing"));
  const auto read = read_volume(folder.path, with_spacing);
  REQUIRE(read);
  const Volume& volume = read->volume;
  CHECK(volume.geometry.dims == std::array{2, 2, 11});
  CHECK(volume.geometry.spacing_mm == Vec3(0.5, 0.5, 3));
  CHECK(std::string(voxel_type_name(volume.data)) == "uint16");
  for (int k = 0; k < 11; ++k) CHECK(volume.at(0, 0, k) == k + 1);
}

TEST_CASE("the pages of one TIFF are the slices of a volume") {
  const TemporaryFolder folder;
  const std::string bytes = tiff(2, 1, {{1, 2}, {3, 4}, {5, 6}});
  write_bytes(folder.path / "stack.tiff", bytes);
  const auto read = read_volume(folder.path / "stack.tiff", with_spacing);
  REQUIRE(read);
  CHECK(read->volume.data == VoxelData(std::vector<std::uint16_t>{1, 2, 3, 4, 5, 6}));
  write_bytes(folder.path / "short.tiff", bytes.substr(0, bytes.size() - 2));
  CHECK(!read_volume(folder.path / "short.tiff", with_spacing));
}

TEST_CASE("stacks with colours or slices of different sizes are refused") {
  const TemporaryFolder folder;
  write_bytes(folder.path / "a.tif", tiff(2, 1, {{1, 2}}));
  write_bytes(folder.path / "b.tif", tiff(1, 1, {{1}}));
  CHECK(says(read_volume(folder.path, with_spacing), "different sizes"));
  fs::remove(folder.path / "b.tif");
  REQUIRE(write_picture(Picture{2, 1, std::vector<std::uint8_t>(8)}, folder.path / "b.png"));
  CHECK(says(read_volume(folder.path, with_spacing), "named differently"));
  fs::remove(folder.path / "a.tif");
  CHECK(says(read_volume(folder.path, with_spacing), "colours"));
}

TEST_CASE("a stack whose names tell of a missing slice is refused") {
  for (const std::vector<std::int64_t>& numbers :
       {std::vector<std::int64_t>{0, 2, 3}, {1, 2, 3, 5}, {10, 20, 40}, {1, 2, 3, 4, 6, 7, 8, 9, 11}}) {
    const TemporaryFolder folder;
    CHECK(says(stack(folder, numbers), "lacks slices"));
  }
  const TemporaryFolder begins_with_the_gap;
  CHECK(says(stack(begins_with_the_gap, {1, 3, 4, 5, 6}), "from s1.tif to s3.tif"));
  const TemporaryFolder every_fifth;
  CHECK(stack(every_fifth, {5, 10, 15, 20}));
  const TemporaryFolder folder;
  REQUIRE(stack(folder, {1, 2, 3}));
  write_bytes(folder.path / "overview1.tif", tiff(1, 1, {{1}}));
  CHECK(says(read_volume(folder.path, with_spacing), "named differently"));
  fs::remove(folder.path / "overview1.tif");
  fs::create_symlink("nowhere", folder.path / "s4.tif");
  CHECK(says(read_volume(folder.path, with_spacing), "s4.tif"));
}

TEST_CASE("a stack whose names are times is read in their order") {
  for (const std::vector<std::int64_t>& times :
       {std::vector<std::int64_t>{120001, 120003, 120006, 120008, 120010, 120015},
        {100, 200, 300, 400, 550},                                                        // by no multiple
        {20240101120000001, 20240101120000002, 20240101120000003, 20240101120000005}}) {  // too long for a count
    const TemporaryFolder folder;
    const auto read = stack(folder, times);
    if (!read) FAIL(read.error().sentence());
    CHECK(read->volume.geometry.dims[2] == static_cast<int>(times.size()));
  }
}

TEST_CASE("slices of a stack are ordered whatever the case of their names") {
  const TemporaryFolder folder;
  for (const auto& [name, value] : {std::pair<const char*, std::uint16_t>{"s1.tif", 1}, {"S2.TIF", 2}, {"s10.tif", 10}})
    write_bytes(folder.path / name, tiff(1, 1, {{value}}));
  for (int k = 3; k < 10; ++k)
    write_bytes(folder.path / ("S" + std::to_string(k) + ".tif"), tiff(1, 1, {{static_cast<std::uint16_t>(k)}}));
  const auto read = read_volume(folder.path, with_spacing);
  if (!read) FAIL(read.error().sentence());
  for (int k = 0; k < 10; ++k) CHECK(read->volume.at(0, 0, k) == k + 1);
}

TEST_CASE("files that macOS leaves beside the slices of a stack do not count") {
  const TemporaryFolder folder;
  REQUIRE(stack(folder, {1, 2, 3}));
  for (const char* name : {"._s1.tif", "._s2.tif", "._notes.dcm"})
    write_bytes(folder.path / name, std::string("\0\5\26\7", 4) + std::string(200, 'x'));
  const auto read = read_volume(folder.path, with_spacing);
  if (!read) FAIL(read.error().sentence());
  CHECK(read->volume.geometry.dims[2] == 3);
}

TEST_CASE("greys of a PNG are read as they are") {
  using Bytes = std::vector<std::uint8_t>;
  const std::string no_filter(1, '\0');
  const auto one_bit = read_picture_bytes("v.png", png(3, 1, 1, no_filter + "\x40"));
  REQUIRE(one_bit);
  CHECK(one_bit->volume.data == VoxelData(Bytes{0, 255, 0}));
  const auto sixteen = read_picture_bytes("v.PNG", png(2, 1, 16, no_filter + std::string("\0\1\xea\x60", 4)));
  REQUIRE(sixteen);
  CHECK(sixteen->volume.data == VoxelData(std::vector<std::uint16_t>{1, 60000}));
  const std::string gamma = chunk("gAMA", big_endian(100000)), profile = chunk("iCCP", "a damaged profile");
  const auto eight = read_picture_bytes("v.png", png(2, 1, 8, no_filter + "ab", gamma + profile));
  REQUIRE(eight);
  CHECK(eight->volume.data == VoxelData(Bytes{'a', 'b'}));
}

TEST_CASE("damaged pictures are refused without a line of the library and whatever the case of the name") {
  const std::string rows = std::string(1, '\0') + "abcdefgh", whole = png(8, 1, 8, rows);
  REQUIRE(read_picture_bytes("v.png", whole));
  const std::vector<std::string> bad{whole.substr(0, whole.size() - 1),
                                     whole.substr(0, whole.size() - 14),
                                     png(8, 2, 8, rows),                             // a row is missing
                                     png(8, 1, 8, '\x9' + rows.substr(1)),           // filtered in no known way
                                     png(8, 1, 7, rows),                             // no such type
                                     png(30000, 30000, 8, rows),                     // a claim
                                     whole.substr(0, 45) + "?" + whole.substr(46)};  // a checksum
  for (const std::string& bytes : bad)
    for (const char* name : {"v.png", "v.PNG"}) {
      CAPTURE(bytes.size());
      CAPTURE(std::string(name));
      bool refused = false;
      CHECK(printed_by([&] { refused = !read_picture_bytes(name, bytes); }).empty());
      CHECK(refused);
    }
}
