#include <doctest/doctest.h>

#include <cstring>

#include "core/base/pictures/picture_io.h"
#include "core/volume/volume_io.h"
#include "tests/cpu_time.h"
#include "tests/peak_memory.h"
#include "tests/refusal.h"
#include "tests/tiff_bytes.h"

namespace fs = std::filesystem;
using namespace homolog;

namespace {

const VolumeReadOptions even_spacing{.stack_spacing_mm = Vec3(1, 1, 1)};
constexpr std::uint32_t by_lzw = 5, by_deflate = 8, by_packbits = 32773;

Result<VolumeRead> read_tiff(const std::string& bytes) {
  const TemporaryFolder folder;
  write_bytes(folder.path / "v.tif", bytes);
  return read_volume(folder.path / "v.tif", even_spacing);
}

/// The file with one page of these strips or tiles.
std::string with_pieces(TiffBytes file, std::vector<std::string> pieces) {
  file.pages = {std::move(pieces)};
  return file.bytes();
}

/// LZW without any compression: a clear code, the bytes, an end code, of nine bits each [TIFF 6.0, §13]; up to 200
/// bytes.
std::string lzw_packed(const std::string& bytes) {
  std::string packed;
  unsigned held = 0, bits = 0;
  const auto add = [&](unsigned code) {
    held = held << 9 | code;
    for (bits += 9; bits >= 8; bits -= 8) packed += static_cast<char>(held >> (bits - 8) & 0xff);
  };
  constexpr unsigned clear = 256, end = 257;
  add(clear);
  for (const char c : bytes) add(static_cast<unsigned char>(c));
  add(end);
  if (bits > 0) packed += static_cast<char>(held << (8 - bits) & 0xff);
  return packed;
}

template <class T>
std::string stored(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

template <class T>
void check_values(const Result<VolumeRead>& read, const std::vector<T>& expected) {
  if (!read) FAIL_CHECK(read.error().sentence());
  if (read) CHECK(read->volume.data == VoxelData(expected));
}

const std::string eight = "abcdefgh";
const std::vector<std::uint8_t> eight_values(eight.begin(), eight.end());

}  // namespace

TEST_CASE("every shortened copy of a TIFF of three pages is refused alone and as a slice") {
  TiffBytes file;
  file.rows_per_strip = 1;
  file.pages = {{"abcd", "efgh"}, {"ijkl", "mnop"}, {"qrst", "uvwx"}};
  const std::string whole = file.bytes();
  REQUIRE(read_tiff(whole));
  const TemporaryFolder stack;
  file.pages = {{"abcd", "efgh"}};
  write_bytes(stack.path / "1.tif", file.bytes());
  REQUIRE(read_volume(stack.path, even_spacing));
  for (std::size_t left = 0; left < whole.size(); ++left) {
    CAPTURE(left);
    CHECK(!read_tiff(whole.substr(0, left)));
    if (left % 7 != 0) continue;
    write_bytes(stack.path / "2.tif", whole.substr(0, left));
    CHECK(!read_volume(stack.path, even_spacing));
  }
}

TEST_CASE("the last page of a TIFF says that it is the last one") {
  TiffBytes file;
  file.pages = {{eight}, {eight}};
  REQUIRE(read_tiff(file.bytes()));
  for (const std::uint32_t link : {8u, 9u, 100u, 4000000000u}) {  // a circle, odd bytes, behind the file
    CAPTURE(link);
    file.last_link = link;
    CHECK(!read_tiff(file.bytes()));
  }
}

TEST_CASE("damaged strips of a TIFF are refused in every compression") {
  TiffBytes file;
  std::string pixels(64, '\0');
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<char>(37 * i * i % 251);
  file.width = file.height = 8;
  const std::vector<std::uint8_t> values(pixels.begin(), pixels.end());
  const std::string runs = '\x3f' + pixels;  // 64 bytes as they are
  struct Packed {
    std::uint32_t compression;
    std::string strip;
  };
  for (const Packed& packed :
       {Packed{by_lzw, lzw_packed(pixels)}, Packed{by_deflate, deflated(pixels)}, Packed{by_packbits, runs}}) {
    CAPTURE(packed.compression);
    file.compression = packed.compression;
    check_values(read_tiff(with_pieces(file, {packed.strip})), values);
    CHECK(!read_tiff(with_pieces(file, {packed.strip.substr(0, packed.strip.size() / 2)})));
    if (packed.compression == by_packbits) continue;
    std::string damaged = packed.strip;
    if (packed.compression == by_deflate) damaged[2] = 7;  // a block of no known type
    for (std::size_t i = damaged.size() / 2; i < damaged.size() / 2 + 8; ++i) damaged[i] = '\xff';
    CHECK(says(read_tiff(with_pieces(file, {damaged})), "do not decode"));
  }
}

TEST_CASE("pixels of every type are read as they are stored") {
  TiffBytes file;
  file.width = 2;
  file.height = 1;
  const auto read_as = [&](std::uint32_t bits, std::uint32_t format, const std::string& strip) {
    file.bits = bits;
    file.format = format;
    return read_tiff(with_pieces(file, {strip}));
  };
  constexpr std::uint32_t whole = 1, with_sign = 2, real = 3;
  check_values<std::uint8_t>(read_as(8, whole, "\x01\xff"), {1, 255});
  check_values<std::int16_t>(read_as(8, with_sign, "\x01\xff"), {1, -1});
  check_values<std::uint16_t>(read_as(16, whole, stored<std::uint16_t>({1, 60000})), {1, 60000});
  check_values<std::int16_t>(read_as(16, with_sign, stored<std::int16_t>({-1, 30000})), {-1, 30000});
  check_values<float>(read_as(32, whole, stored<std::uint32_t>({1, 100000})), {1, 100000});
  check_values<float>(read_as(32, with_sign, stored<std::int32_t>({-100000, 5})), {-100000, 5});
  check_values<float>(read_as(32, real, stored<float>({0.5f, -2})), {0.5f, -2});
  check_values<float>(read_as(64, real, stored<double>({0.5, -2})), {0.5f, -2});
  check_values<std::uint8_t>(read_as(1, whole, "\x40"), {0, 255});
  check_values<std::uint8_t>(read_as(4, whole, "\x1f"), {17, 255});
  check_values<std::uint16_t>(read_as(12, whole, "\x12\x3f\xff"), {0x123, 0xfff});
  CHECK(says(read_as(16, real, "abcd"), "16 bits"));
  CHECK(says(read_as(7, whole, "ab"), "7 bits"));
}

TEST_CASE("strips and tiles and planes and alpha give the same picture") {
  TiffBytes file;
  check_values(read_tiff(with_pieces(file, {eight})), eight_values);
  TiffBytes rows = file;
  rows.rows_per_strip = 1;
  check_values(read_tiff(with_pieces(rows, {"abcd", "efgh"})), eight_values);
  TiffBytes three = file;  // the last strip is shorter
  three.height = 3;
  three.rows_per_strip = 2;
  std::vector<std::uint8_t> twelve = eight_values;
  twelve.insert(twelve.end(), {'i', 'j', 'k', 'l'});
  check_values(read_tiff(with_pieces(three, {eight, "ijkl"})), twelve);
  TiffBytes tiles = file;
  tiles.width = 20;
  tiles.height = 17;
  tiles.tile_width = tiles.tile_height = 16;
  std::vector<std::uint8_t> page(20 * 17);
  std::vector<std::string> pieces(4, std::string(256, '?'));
  for (std::size_t y = 0; y < 17; ++y)
    for (std::size_t x = 0; x < 20; ++x) {
      page[20 * y + x] = static_cast<std::uint8_t>(13 * x + 7 * y);
      pieces[2 * (y / 16) + x / 16][16 * (y % 16) + x % 16] = static_cast<char>(page[20 * y + x]);
    }
  check_values(read_tiff(with_pieces(tiles, pieces)), page);
  pieces[3].pop_back();
  CHECK(says(read_tiff(with_pieces(tiles, pieces)), "outside of the file"));
  TiffBytes opaque = file;
  opaque.samples = 2;
  opaque.alpha = true;
  check_values(read_tiff(with_pieces(opaque, {"a.b.c.d.e.f.g.h."})), eight_values);
  opaque.alpha = false;
  CHECK(says(read_tiff(with_pieces(opaque, {"a.b.c.d.e.f.g.h."})), "several values"));
}

TEST_CASE("rows and columns that run the other way are turned and white may be zero") {
  TiffBytes file;
  const auto read_as = [&](std::uint32_t orientation) {
    file.orientation = orientation;
    return read_tiff(with_pieces(file, {eight}));
  };
  check_values<std::uint8_t>(read_as(2), {'d', 'c', 'b', 'a', 'h', 'g', 'f', 'e'});
  check_values<std::uint8_t>(read_as(3), {'h', 'g', 'f', 'e', 'd', 'c', 'b', 'a'});
  check_values<std::uint8_t>(read_as(4), {'e', 'f', 'g', 'h', 'a', 'b', 'c', 'd'});
  CHECK(says(read_as(6), "rows stored as columns"));
  file.orientation = 1;
  file.photometric = 0;
  std::vector<std::uint8_t> inverted;
  for (const std::uint8_t value : eight_values) inverted.push_back(static_cast<std::uint8_t>(255 - value));
  check_values(read_tiff(with_pieces(file, {eight})), inverted);
}

TEST_CASE("a name decides which reader a picture gets") {
  const TemporaryFolder folder;
  REQUIRE(write_picture(Picture{2, 2, std::vector<std::uint8_t>(16, 200)}, folder.path / "a.png"));
  fs::copy_file(folder.path / "a.png", folder.path / "b.tif");
  CHECK(says(read_volume(folder.path / "b.tif", even_spacing), "is no TIFF"));
  write_bytes(folder.path / "c.png", with_pieces(TiffBytes(), {eight}));
  CHECK(says(read_volume(folder.path / "c.png", even_spacing), "is no PNG"));
  // A whole JPEG of 8 × 8 grey pixels would be needed to see another reader take it; its first bytes decide.
  write_bytes(folder.path / "d.TIFF", "\xff\xd8\xff\xe0" + std::string(500, '\1'));
  CHECK(says(read_volume(folder.path / "d.TIFF", even_spacing), "is no TIFF"));
}

TEST_CASE("a TIFF of thousands of pages is read in seconds") {
  TiffBytes file;
  file.width = file.height = 8;
  for (int page = 0; page < 8000; ++page) file.pages.push_back({std::string(64, static_cast<char>(page % 250))});
  const std::string bytes = file.bytes();
  const double seconds = test::cpu_seconds_of([&] {
    const auto read = read_tiff(bytes);
    REQUIRE(read);
    CHECK(read->volume.geometry.dims == std::array{8, 8, 8000});
    CHECK(read->volume.at(3, 3, 7999) == 7999 % 250);
  });
  CHECK(seconds < 15);
}

TEST_CASE("pages that claim the same pixels or more than their strips hold are refused without taking memory") {
  TiffBytes file;
  REQUIRE(read_tiff(with_pieces(file, {eight})));  // the first picture loads the libraries
  file.width = file.height = 4000;
  file.compression = by_deflate;
  const double taken =
      memory_taken_by([&] { CHECK(says(read_tiff(with_pieces(file, {deflated(eight)})), "outside of the file")); });
  CHECK(taken < 10e6);  // of 16 MB
  TiffBytes shared;
  shared.width = shared.height = 100;
  const std::string strip(10000, 'x');
  shared.pages = {{strip}, {strip}};
  std::string bytes = shared.bytes();
  REQUIRE(read_tiff(bytes));
  const std::size_t first = bytes.find(strip), second = bytes.rfind(strip);
  bytes.replace(bytes.rfind(little_endian(static_cast<std::uint32_t>(second), 4)), 4,
                little_endian(static_cast<std::uint32_t>(first), 4));
  bytes.resize(second);
  CHECK(says(read_tiff(bytes), "share their pixels"));
}

TEST_CASE("what ImageJ says of a stack is believed") {
  TiffBytes file;
  file.pages = {{eight}, {eight}};
  const auto described = [&](const std::string& text) {
    file.description = "ImageJ=1.53t\n" + text;
    return read_tiff(file.bytes());
  };
  CHECK(described("images=2\nslices=2\n"));
  CHECK(described("images=2\nframes=2\n"));
  CHECK(says(described("images=500\nslices=500\n"), "500 slices of which it lists only 2"));
  CHECK(says(described("images=2\nchannels=2\n"), "several channels"));
}
