#include <doctest/doctest.h>

#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <fstream>
#include <numeric>

#include "core/base/pictures/picture_module.h"
#include "core/volume/dicom/codestream.h"
#include "core/volume/dicom/dicom_header.h"
#include "core/volume/dicom/dicom_rle.h"
#include "core/volume/dicom/dicom_set.h"
#include "core/volume/volume_io.h"
#include "tests/core/volume/dicom_slices.h"
#include "tests/peak_memory.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace fs = std::filesystem;
using namespace homolog;

TEST_CASE("a series is sorted by place and becomes one volume") {
  const TemporaryFolder folder;
  save_series(folder.path, {5, -2.5, 0, 7.5, 2.5});
  write_bytes(folder.path / "notes.txt", "not DICOM");
  const auto read = read_volume(folder.path);
  REQUIRE(read);
  const Volume& volume = read->volume;
  CHECK(read->warnings.empty());
  CHECK(volume.geometry.dims == std::array{3, 2, 5});
  CHECK((volume.geometry.spacing_mm - Vec3(0.25, 0.5, 2.5)).norm() < 1e-9);
  CHECK((volume.geometry.origin_mm - Vec3(0, 0, -2.5)).norm() < 1e-9);
  for (int k = 0; k < 5; ++k) CHECK(volume.at(2, 1, k) == 10 * (-2.5 + 2.5 * k));
  CHECK(volume.modality == "CT");
  CHECK(volume.series_uid == "1.2.3");
}

TEST_CASE("slices stacked along an oblique normal are placed there") {
  const TemporaryFolder folder;
  Slice slice;
  slice.orientation = "0\\1\\0\\0\\0\\-1";  // sagittal; the normal points to the right
  for (int s = 0; s < 3; ++s) {
    slice.x = -4 * s;
    write_bytes(folder.path / (std::to_string(s) + ".dcm"), slice.bytes());
  }
  const auto read = read_volume(folder.path);
  REQUIRE(read);
  const VolumeGeometry& g = read->volume.geometry;
  CHECK((g.direction.col(0) - Vec3::UnitY()).norm() < 1e-9);
  CHECK((g.direction.col(1) + Vec3::UnitZ()).norm() < 1e-9);
  CHECK((g.direction.col(2) + Vec3::UnitX()).norm() < 1e-9);
  CHECK(g.spacing_mm[2] == doctest::Approx(4));
}

TEST_CASE("a missing slice is refused with its neighbours' names") {
  const TemporaryFolder folder;
  save_series(folder.path, {0, 2.5, 5, 10, 12.5});
  const auto read = read_volume(folder.path);
  CHECK(says(read, "lacks slices: "));
  CHECK(says(read, "1.2.3-14.dcm (5.00 mm)"));
  CHECK(says(read, "1.2.3-21.dcm (10.00 mm)"));
}

TEST_CASE("uneven and doubled and shifted and mixed slices are refused") {
  {
    const TemporaryFolder folder;
    save_series(folder.path, {0, 2.5, 5, 8.5, 11});
    CHECK(says(read_volume(folder.path), "unevenly"));
  }
  {
    const TemporaryFolder folder;
    save_series(folder.path, {0, 2.5, 2.5, 5});
    CHECK(says(read_volume(folder.path), "1 slice at"));
  }
  {
    const TemporaryFolder folder;
    Slice slice;
    for (int s = 0; s < 3; ++s) {
      slice.z = s;
      slice.y = 0.3 * s;  // a tilted gantry
      write_bytes(folder.path / (std::to_string(s) + ".dcm"), slice.bytes());
    }
    CHECK(says(read_volume(folder.path), "tilted"));
  }
  {
    const TemporaryFolder folder;
    Slice slice;
    write_bytes(folder.path / "a.dcm", slice.bytes());
    slice.orientation = "1\\0\\0\\0\\0\\-1";
    write_bytes(folder.path / "b.dcm", slice.bytes());
    CHECK(says(read_volume(folder.path), "different directions"));
  }
}

TEST_CASE("several series are listed and one is chosen") {
  const TemporaryFolder folder;
  save_series(folder.path, {0, 1, 2});
  Slice other;
  other.series = "1.2.4";
  other.description = "thick";
  save_series(folder.path, {0, 5}, other);
  Slice structures;
  structures.series = "1.2.5";
  structures.modality = "RTSTRUCT";
  std::string no_pixels = structures.bytes();
  write_bytes(folder.path / "structures.dcm", no_pixels.substr(0, no_pixels.find("OW") - 4));
  const auto unchosen = read_volume(folder.path);
  CHECK(says(unchosen, "holds 2 series"));
  CHECK(says(unchosen, "--series"));
  CHECK(says(unchosen, "1.2.4 (CT \"thick\", 2 files)"));
  VolumeReadOptions options;
  options.series_uid = "1.2.4";
  const auto chosen = read_volume(folder.path, options);
  REQUIRE(chosen);
  CHECK(chosen->volume.geometry.dims[2] == 2);
  options.series_uid = "9";
  CHECK(says(read_volume(folder.path, options), "holds no series 9"));
  const auto list = list_series(folder.path);
  REQUIRE(list);
  REQUIRE(list->size() == 2);
  CHECK((*list)[1].uid == "1.2.4");
  CHECK((*list)[1].description == "thick");
  CHECK((*list)[1].files == 2);
}

TEST_CASE("several slices at every place are the frames of a cine") {
  const TemporaryFolder folder;
  Slice slice;
  int name = 0;
  for (const double time : {80.0, 40.0, 120.0})
    for (const double z : {8.0, 0.0}) {
      slice.z = z;
      slice.trigger_ms = time;
      for (auto& pixel : slice.pixels) pixel = static_cast<std::int16_t>(time + z);
      write_bytes(folder.path / (std::to_string(name++) + ".dcm"), slice.bytes());
    }
  const auto read = read_volume(folder.path);
  REQUIRE(read);
  CHECK(read->volume.frames == 3);
  CHECK(read->volume.frame_seconds == doctest::Approx(0.04));
  for (int frame = 0; frame < 3; ++frame) {
    CHECK(read->volume.at(0, 0, 0, frame) == 40 * (frame + 1));
    CHECK(read->volume.at(0, 0, 1, frame) == 40 * (frame + 1) + 8);
  }
}

TEST_CASE("rescaling and the window come from the file and may differ from slice to slice") {
  Slice slice;
  slice.before_pixels = element(0x00281050, "DS", "40\\300") + element(0x00281051, "DS", "400\\1500") +
                        element(0x00281052, "DS", "-1024") + element(0x00281053, "DS", "1");
  const auto read = read_slice(slice);
  REQUIRE(read);
  CHECK(read->volume.data == VoxelData(std::vector<std::int16_t>{-1024, -1023, -1022, -1021, -1020, -1019}));
  CHECK(read->volume.file_window == std::pair(40.0, 400.0));
  const TemporaryFolder folder;
  for (int s = 0; s < 2; ++s) {
    slice.z = s;
    slice.before_pixels =
        element(0x00281052, "DS", s == 0 ? "10" : "-3.5") + element(0x00281053, "DS", s == 0 ? "0.5" : "2");
    write_bytes(folder.path / (std::to_string(s) + ".dcm"), slice.bytes());
  }
  const auto each = read_volume(folder.path);
  REQUIRE(each);
  CHECK(each->volume.at(0, 0, 0) == 10);
  CHECK(each->volume.at(2, 1, 0) == 12.5);
  CHECK(each->volume.at(0, 0, 1) == -3.5);
  CHECK(each->volume.at(2, 1, 1) == 6.5);
}

TEST_CASE("only the stored bits of a pixel count") {
  Slice slice;
  slice.bits_stored = 12;
  slice.pixels = {0x0fff, 0x07ff, 0x1001, static_cast<std::int16_t>(0xf800), 0, 1};
  const auto with_sign = read_slice(slice);
  REQUIRE(with_sign);
  CHECK(with_sign->volume.data == VoxelData(std::vector<std::int16_t>{-1, 2047, 1, -2048, 0, 1}));
  slice.is_signed = 0;
  const auto without = read_slice(slice);
  REQUIRE(without);
  CHECK(without->volume.data == VoxelData(std::vector<std::uint16_t>{4095, 2047, 1, 2048, 0, 1}));
}

namespace {

/// An enhanced file whose frames lie at these heights; its pixels count on from frame to frame. `shared`: what else all
/// frames share, beside their orientation.
Slice enhanced_at(const std::vector<double>& heights_mm, const std::string& shared = "") {
  Slice slice;
  slice.orientation = "";
  slice.frames = std::to_string(heights_mm.size());
  slice.pixels.resize(6 * heights_mm.size());
  std::iota(slice.pixels.begin(), slice.pixels.end(), std::int16_t{0});
  std::string places;
  for (const double z : heights_mm) places += item(sequence(0x00209113, item(position(1, 2, z))));
  const std::string orientation = sequence(0x00209116, item(element(0x00200037, "DS", "1\\0\\0\\0\\1\\0")));
  slice.before_pixels = sequence(0x52009229, item(orientation + shared)) + sequence(0x52009230, places);
  return slice;
}

}  // namespace

TEST_CASE("frames of an enhanced file are put in the order of their places") {
  const auto read = read_slice(enhanced_at({10, 4, 7}, sequence(0x00289110, item(element(0x00280030, "DS", "2\\3")))));
  REQUIRE(read);
  const Volume& volume = read->volume;
  CHECK((volume.geometry.spacing_mm - Vec3(3, 2, 3)).norm() < 1e-9);
  CHECK((volume.geometry.origin_mm - Vec3(1, 2, 4)).norm() < 1e-9);
  CHECK(volume.at(0, 0, 0) == 6);
  CHECK(volume.at(0, 0, 1) == 12);
  CHECK(volume.at(0, 0, 2) == 0);
}

TEST_CASE("a damaged number of frames is mended by what the pixels hold") {
  Slice slice;
  slice.frames = "1A";
  slice.orientation = "";
  slice.pixels.resize(12);
  const auto read = read_slice(slice);
  REQUIRE(read);
  CHECK(read->volume.geometry.dims[2] * read->volume.frames == 2);
  CHECK(!read->warnings.empty());
}

TEST_CASE("colours and contradictory sizes are refused") {
  Slice colour;
  colour.photometric = "RGB";
  colour.samples = 3;
  CHECK(says(read_slice(colour), "colour"));
  Slice wide;
  wide.columns = 60000;
  CHECK(says(read_slice(wide), "pixels are missing"));
  Slice frames;
  frames.frames = "100000";
  CHECK(says(read_slice(frames), "pixels are missing"));
}

TEST_CASE("a count far below zero is taken as if it were not there") {
  Slice slice;  // the samples of a pixel once more, as -2.7e300; one where nothing is said
  slice.before_pixels = element(0x00280002, "FD", "\x42\xfa\xff\x26\xe7\xff\x4f\xfe");
  CHECK(read_slice(slice));
}

TEST_CASE("every shortened copy of a DICOM file is refused and never crashes") {
  const TemporaryFolder folder;
  Slice slice;
  slice.before_pixels =
      sequence(0x52009229, item(sequence(0x00209116, item(element(0x00200037, "DS", "1\\0\\0\\0\\1\\0")))));
  const std::string whole = slice.bytes();
  REQUIRE(read_slice(slice));
  for (std::size_t left = 0; left < whole.size(); ++left) {
    CAPTURE(left);
    write_bytes(folder.path / "slice.dcm", whole.substr(0, left));
    CHECK(!read_volume(folder.path / "slice.dcm"));
  }
}

TEST_CASE("a damaged file in a folder is named rather than left out") {
  const TemporaryFolder folder;
  save_series(folder.path, {0, 1, 2});
  write_bytes(folder.path / "empty.dcm", "");
  CHECK(says(read_volume(folder.path), "empty.dcm"));
}

TEST_CASE("a damaged file is named whatever the case of its name") {
  for (const char* name : {"9.DCM", "NOTES.DCM"}) {
    const TemporaryFolder folder;
    save_series(folder.path, {0, 1, 2});
    write_bytes(folder.path / name, "");
    CHECK(says(read_volume(folder.path), name));
  }
  const TemporaryFolder folder;
  Slice slice;
  for (int s = 0; s < 3; ++s) {
    slice.z = s;
    write_bytes(folder.path / ("im" + std::to_string(s)), slice.bytes());
  }
  write_bytes(folder.path / "IM3", slice.bytes().substr(0, 100));
  CHECK(says(read_volume(folder.path), "IM3"));
}

TEST_CASE("files that macOS leaves beside those of a series do not count") {
  const TemporaryFolder folder;
  save_series(folder.path, {0, 1, 2});
  const std::string leftover = std::string("\0\5\26\7", 4) + std::string(200, 'x');
  for (const char* name : {"._1.2.3-0.dcm", "._1.2.3-7.dcm"}) write_bytes(folder.path / name, leftover);
  const auto read = read_volume(folder.path);
  if (!read) FAIL(read.error().sentence());
  CHECK(read->volume.geometry.dims[2] == 3);
  CHECK(list_series(folder.path)->size() == 1);
  const TemporaryFolder nothing_else;
  write_bytes(nothing_else.path / "._1.dcm", leftover);
  CHECK_FALSE(looks_like_volume(nothing_else.path));
}

TEST_CASE("a file is opened once to see whether it is DICOM") {
  const TemporaryFolder folder;
  write_bytes(folder.path / "slice", Slice().bytes());
  const int watch = ::inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
  if (watch < 0 || ::inotify_add_watch(watch, folder.path.c_str(), IN_OPEN | IN_CLOSE) < 0) {
    MESSAGE("not tested: the system does not tell who opens files");
    return;
  }
  CHECK(looks_like_dicom(folder.path / "slice"));
  alignas(inotify_event) std::array<char, 4096> events;
  const ssize_t size = ::read(watch, events.data(), events.size());
  ::close(watch);
  int opened = 0;
  for (ssize_t at = 0; at < size;) {
    const auto& event = *reinterpret_cast<const inotify_event*>(events.data() + at);
    opened += (event.mask & IN_OPEN) != 0;
    at += static_cast<ssize_t>(sizeof(inotify_event) + event.len);
  }
  CHECK(opened == 1);
}

TEST_CASE("a folder is cancelled while its files are told apart") {
  const TemporaryFolder folder;
  save_series(folder.path, {0, 1, 2});
  fs::create_symlink("nowhere", folder.path / "lost.dcm");
  CHECK(says(read_volume(folder.path), "lost.dcm"));
  Progress progress;
  progress.cancel();
  VolumeReadOptions options;
  options.progress = &progress;
  CHECK(says(read_volume(folder.path, options), "cancelled"));
}

TEST_CASE("a file named like the slices that is no DICOM is named rather than left out") {
  const TemporaryFolder folder;
  Slice slice;
  const auto file = [&](int s) { return folder.path / ("CT.1.2." + std::to_string(100 + s)); };
  for (int s = 0; s < 4; ++s) {
    slice.z = s;
    write_bytes(file(s), slice.bytes());
  }
  write_bytes(folder.path / "README", "of the scan");
  REQUIRE(read_volume(folder.path));
  const std::string whole = slice.bytes();
  for (const std::string& damaged : {std::string(), std::string(whole.size(), '\0'), whole.substr(0, 100)}) {
    write_bytes(file(3), damaged);
    CHECK(says(read_volume(folder.path), "CT.1.2.103"));
  }
  fs::remove(file(3));
  fs::create_symlink("nowhere", file(3));
  CHECK(says(read_volume(folder.path), "CT.1.2.103"));
}

TEST_CASE("a data set without preamble and meta information is read") {
  const TemporaryFolder folder;
  const std::string whole = Slice().bytes();
  write_bytes(folder.path / "IM0001", whole.substr(whole.find(element(0x00080060, "CS", "CT"))));
  CHECK(looks_like_volume(folder.path / "IM0001"));
  const auto read = read_volume(folder.path / "IM0001");
  REQUIRE(read);
  CHECK(read->volume.range_max == 5);
}

namespace {

constexpr const char* rle_syntax = "1.2.840.10008.1.2.5";

/// A run-length header [DICOM PS3.5, §G.5] and what follows it.
std::string rle(std::uint32_t segments, const std::vector<std::uint32_t>& begins, const std::string& content) {
  std::string header = little_endian(segments, 4);
  for (const std::uint32_t begin : begins) header += little_endian(begin, 4);
  header.resize(64, '\0');
  return header + content;
}

/// Six values of 16 bits: the high bytes as a run of 1, the low ones as they are.
const std::string high_bytes = std::string("\xfb\x01", 2), low_bytes = std::string("\x05\0\1\2\3\4\5\0", 8);

Result<VolumeRead> read_rle(const std::vector<std::string>& fragments) {
  Slice slice;
  slice.syntax = rle_syntax;
  slice.fragments = fragments;
  return read_slice(slice);
}

}  // namespace

TEST_CASE("run-length encoded planes are decoded") {
  const auto read = read_rle({rle(2, {64, 66}, high_bytes + low_bytes)});
  REQUIRE(read);
  CHECK(read->volume.data == VoxelData(std::vector<std::int16_t>{256, 257, 258, 259, 260, 261}));
  Slice slice;
  slice.syntax = rle_syntax;
  slice.frames = "2";
  slice.put(0x00180088, "DS", "2.5");  // how far its planes lie apart
  slice.fragments = {rle(2, {64, 66}, high_bytes + low_bytes), rle(2, {64, 66}, high_bytes + low_bytes)};
  slice.bits_stored = 8;  // the high byte holds something else
  slice.is_signed = 0;
  const auto planes = read_slice(slice);
  REQUIRE(planes);
  CHECK(planes->volume.data == VoxelData(std::vector<std::uint16_t>{0, 1, 2, 3, 4, 5, 0, 1, 2, 3, 4, 5}));
}

TEST_CASE("run lengths whose header or content does not fit the plane are refused") {
  const std::string content = high_bytes + low_bytes;
  for (const std::uint32_t segments : {0u, 1u, 3u, 15u, 16u, 40000000u, 4294967295u}) {
    CAPTURE(segments);
    CHECK(!read_rle({rle(segments, {64, 66}, content)}));
  }
  for (const auto& begins : {std::vector<std::uint32_t>{66, 64},
                             {64, 64},
                             {0, 66},
                             {63, 66},
                             {64, 74},
                             {64, 4294967295u},
                             {4294967295u, 66},
                             {64, 73},
                             {65, 66}}) {
    CAPTURE(begins[0]);
    CAPTURE(begins[1]);
    CHECK(!read_rle({rle(2, begins, content)}));
  }
  CHECK(!read_rle({rle(2, {64, 66}, high_bytes + low_bytes.substr(0, 6))}));     // a value is missing
  CHECK(!read_rle({rle(2, {64, 66}, std::string("\xfa\x01", 2) + low_bytes)}));  // a run too long
  CHECK(!read_rle({rle(2, {64, 66}, std::string("\xfc\x01", 2) + low_bytes)}));  // a run too short
  CHECK(!read_rle({rle(2, {64, 66}, content).substr(0, 40), rle(2, {64, 66}, content)}));
  CHECK(!read_rle({std::string(10, '\0')}));
  std::array<std::byte, 4> out;
  CHECK(!decode_rle({}, 2, out));
}

TEST_CASE("a file that claims more frames than it has pixels costs no memory") {
  const TemporaryFolder folder;
  Slice slice;
  slice.frames = "999999";
  for (int file = 0; file < 10; ++file) write_bytes(folder.path / (std::to_string(file) + ".dcm"), slice.bytes());
  const double taken = memory_taken_by([&] { CHECK(says(read_volume(folder.path), "pixels are missing")); });
  CHECK(taken < 20e6);  // of 2.2 GB
  slice.syntax = rle_syntax;
  slice.fragments = {rle(2, {64, 66}, high_bytes + low_bytes)};
  CHECK(says(read_slice(slice), "pixels are missing"));
  slice.bits_stored = 0;
  slice.columns = 0;
  CHECK(!read_slice(slice));
}

TEST_CASE("pictures within a file say their own size and are believed only where it is the header's") {
  const std::string jpeg = std::string("\xff\xd8\xff\xe0\0\4ab\xff\xff\xc3\0\x0b\x10\0\2\0\3\1\1\x11\0", 23);
  CHECK(jpeg_size(jpeg) == CodestreamSize{3, 2, 1});
  for (std::size_t left = 0; left < 19; ++left) CHECK(!jpeg_size(std::string_view(jpeg).substr(0, left)));
  CHECK(!jpeg_size(std::string("\xff\xd8\xff\xda\0\4ab", 8)));  // pixels without a header
  const auto big = [](std::uint32_t value, std::size_t bytes) {
    const std::string little = little_endian(value, bytes);
    return std::string(little.rbegin(), little.rend());
  };
  const std::string jpeg_2000 = "\xff\x4f\xff\x51" + big(41, 2) + big(0, 2) + big(13, 4) + big(22, 4) + big(10, 4) +
                                big(20, 4) + std::string(16, '\0') + big(1, 2) + std::string(3, '\7');
  CHECK(jpeg2000_size(jpeg_2000) == CodestreamSize{3, 2, 1});
  for (std::size_t left = 0; left < 42; ++left) CHECK(!jpeg2000_size(std::string_view(jpeg_2000).substr(0, left)));
  REQUIRE(picture_module());  // the libraries of its decoders take memory of their own, once
  Slice slice;
  slice.columns = 30000;
  for (const char* syntax : {"1.2.840.10008.1.2.4.70", "1.2.840.10008.1.2.4.80", "1.2.840.10008.1.2.4.90"}) {
    CAPTURE(std::string(syntax));
    slice.syntax = syntax;
    slice.fragments = {jpeg + std::string(20000, '\1') + "\xff\xd9"};
    const double taken = memory_taken_by([&] { CHECK(says(read_slice(slice), "do not decode")); });
    CHECK(taken < 20e6);
  }
}

TEST_CASE("planes of one file that share their places are refused unless times tell them apart") {
  CHECK(says(read_slice(enhanced_at({4, 4, 7, 7})), "several planes of one place"));
}

TEST_CASE("frames that lie in another order than in their file are put in place without a second volume") {
  const auto read = read_slice(enhanced_at({4, 0, 3, 1, 2}));
  REQUIRE(read);
  const std::array<int, 5> first_at{6, 18, 24, 12, 0};  // of z = 0…4
  for (int k = 0; k < 5; ++k) CHECK(read->volume.at(0, 0, k) == first_at[static_cast<std::size_t>(k)]);
}

TEST_CASE("a transfer syntax that is not known is refused by its name and those of the standard are followed") {
  Slice slice;
  for (const char* uid :
       {"1.2.840.113619.5.2", "1.2.840.10008.1.20", "1.2.840.10008.1.2.99", "1.3.46.670589.33.1.4.1"}) {
    CAPTURE(uid);
    slice.syntax = uid;
    CHECK(says(read_slice(slice), "is encoded in the transfer syntax " + std::string(uid)));
  }
  slice.syntax = "1.2.840.113619.5.2";
  CHECK(says(read_slice(slice), "(a private one of GE), which cannot be read; export it uncompressed"));
  slice.syntax = "1.2.840.10008.1.2.1";
  CHECK(read_slice(slice).has_value());
  slice.fragments = {"no picture"};
  for (const char* uid : {"1.2.840.10008.1.2.4.50", "1.2.840.10008.1.2.4.90", "1.2.840.10008.1.2.4.201",
                          "1.2.840.10008.1.2.5", "1.2.840.10008.1.2.8.1"}) {
    CAPTURE(uid);
    slice.syntax = uid;
    const auto read = read_slice(slice);
    REQUIRE_FALSE(read);
    CHECK(read.error().what.find("is encoded in the transfer syntax") == std::string::npos);
  }
}
