#include <doctest/doctest.h>
#include <zlib.h>

#include "core/volume/volume_io.h"
#include "core/volume/voxel_stream.h"
#include "tests/peak_memory.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace fs = std::filesystem;
using namespace homolog;

namespace {

/// A header of four slices of 2 × 1 voxels without its empty line at the end.
std::string header_of(const std::string& encoding, const std::string& type = "uint8") {
  return "NRRD0004\ntype: " + type + "\ndimension: 3\nsizes: 2 1 4\nspace: LPS\nspace directions: (1,0,0) (0,1,0) " +
         "(0,0,1)\nspace origin: (0,0,0)\nendian: little\nencoding: " + encoding + "\n";
}

const VoxelData letters = std::vector<std::uint8_t>{'a', 'b', 'c', 'd', 'e', 'f', 'g', 'h'};

/// Writes four slices under the names and the header with `data_file`, and reads it.
Result<VolumeRead> read_slices(const std::vector<std::string>& names, const std::string& data_file) {
  const TemporaryFolder folder;
  for (std::size_t s = 0; s < names.size(); ++s)
    write_bytes(folder.path / names[s], std::string{static_cast<char>('a' + 2 * s), static_cast<char>('b' + 2 * s)});
  write_bytes(folder.path / "v.nhdr", header_of("raw") + "data file: " + data_file + "\n");
  return read_volume(folder.path / "v.nhdr");
}

Result<VolumeRead> read_text(const std::string& encoding, const std::string& text, const std::string& type = "uint8") {
  const TemporaryFolder folder;
  write_bytes(folder.path / "v.nrrd", header_of(encoding, type) + "\n" + text);
  return read_volume(folder.path / "v.nrrd");
}

}  // namespace

TEST_CASE("slices in numbered files are read by their format") {
  struct Form {
    std::vector<std::string> names;
    std::string data_file;
  };
  for (const Form& form : {Form{{"s1.raw", "s2.raw", "s3.raw", "s4.raw"}, "s%d.raw 1 4 1"},
                           Form{{"s009.raw", "s010.raw", "s011.raw", "s012.raw"}, "s%03d.raw 9 12 1"},
                           Form{{" 8", "10", "12", "14"}, "%2d 8 15 2 2"},
                           Form{{"s40.raw", "s30.raw", "s20.raw", "s10.raw"}, "s%d.raw 40 10 -10"},
                           Form{{"s1.raw", "s2.raw", "s3.raw", "s4.raw"}, "LIST\ns1.raw\ns2.raw\ns3.raw\ns4.raw"},
                           Form{{"s1.raw", "s2.raw", "s3.raw", "s4.raw"}, "LIST 2\ns1.raw\ns2.raw\ns3.raw\ns4.raw"}}) {
    CAPTURE(form.data_file);
    const auto read = read_slices(form.names, form.data_file);
    REQUIRE(read);
    CHECK(read->volume.data == letters);
  }
}

TEST_CASE("what a format of file names could do besides numbering is refused") {
  for (const char* format : {"%3000d.raw 1 4 1",
                             "%9999999d.raw 1 4 1",
                             "%0150d.raw 1 4 1",
                             "%100d.raw 1 4 1",
                             "%d%s%s%s.raw 1 4 1",
                             "%d%n.raw 1 4 1",
                             "%s.raw 1 4 1",
                             "%d%d.raw 1 4 1",
                             "%-3d.raw 1 4 1",
                             "%*d.raw 1 4 1",
                             "%x.raw 1 4 1",
                             "%%d.raw 1 4 1",
                             "%hd.raw 1 4 1",
                             "%1$d.raw 1 4 1",
                             "% d.raw 1 4 1",
                             "50%.raw",
                             "%d.raw",
                             "%d.raw 1 4",
                             "%d.raw 1 4 0",
                             "%d.raw 4 1 1",
                             "%d.raw 1 4 1 -2",
                             "%d.raw 1 4 1 2 2",
                             "%d.raw 1 x 1",
                             "%d.raw -2147483648 2147483647 1",
                             "%d.raw 1 99999999999 1"}) {
    CAPTURE(std::string(format));
    CHECK(says(read_slices({}, format), "cannot be followed"));
  }
}

TEST_CASE("voxels are not looked for on the standard input or in a pipe or twice") {
  CHECK(says(read_slices({}, "-"), "cannot be followed"));
  CHECK(says(read_slices({}, ""), "cannot be followed"));
  CHECK(says(read_slices({"a"}, "a\nDatafile: b"), "cannot be followed"));
  CHECK(says(read_slices({}, "/dev/zero"), "device or a pipe"));
  CHECK(says(read_slices({}, "LIST\n/dev/zero\n/dev/zero\n/dev/zero\n/dev/zero"), "device or a pipe"));
}

TEST_CASE("a header whose numbers are half numbers or whose sizes are too small is refused") {
  const auto read = [](std::string header, const std::string& from, const std::string& to, const std::string& voxels) {
    const TemporaryFolder folder;
    header.replace(header.find(from), from.size(), to);
    write_bytes(folder.path / "v.nrrd", header + "\n" + voxels);
    return read_volume(folder.path / "v.nrrd");
  };
  const std::string raw = header_of("raw"), origin = "space origin: (0,0,0)";
  REQUIRE(read(raw, origin, "space origin: ( -20, +1.5,5e0)", "abcdefgh"));
  for (const char* damaged : {"(-20,1.5x,5)", "(-20,1 5,5)", "(-20,,5)", "(-20,1,5", "(-20,1;5,5)"})
    CHECK(says(read(raw, origin, std::string("space origin: ") + damaged, "abcdefgh"), "space origin"));
  CHECK(says(read(raw, "(0,1,0)", "(0,1.x,0)", "abcdefgh"), "space directions"));
  CHECK(says(read(raw, origin, "space origin: (1e10,0,0)", "abcdefgh"), "lies beyond 1,000,000,000 mm"));
  CHECK(says(read(raw, "dimension: 3", "dimension: 3x", "abcdefgh"), "as its dimension what is no number (3x)"));
  CHECK(says(read(raw, origin, origin + "\nbyte skip: 0x", "abcdefgh"), "as its byte skip"));
  CHECK(says(read(raw, "sizes: 2 1 4", "sizes: 2 1 3", "abcdefgh"), "holds more voxels than its header says"));
  CHECK(says(read(raw, "sizes: 2 1 4", "sizes: 2 1 3", std::string("abcdef\0\0", 8)), "holds more voxels"));
  CHECK(says(read(header_of("ascii"), "sizes: 2 1 4", "sizes: 2 1 3", "1 2 3 4 5 6 7 8\n"), "holds more voxels"));
  CHECK(says(read(header_of("hex"), "sizes: 2 1 4", "sizes: 2 1 3", "0102030405060708\n"), "holds more voxels"));
}

TEST_CASE("files that are too many or too few for the sizes or too short are refused") {
  CHECK(says(read_slices({"s1", "s2", "s3"}, "s%d 1 3 1"), "names 3 files"));
  CHECK(says(read_slices({"s1", "s2", "s3", "s4", "s5"}, "s%d 1 5 1"), "names 5 files"));
  CHECK(says(read_slices({"s1", "s2", "s3"}, "s%d 1 4 1"), "s4"));
  CHECK(says(read_slices({"s1", "s2"}, "s%d 1 2 1 3"), "cut short"));
}

TEST_CASE("slabs of several slices in each file are read one behind the other") {
  const TemporaryFolder folder;
  write_bytes(folder.path / "1.raw", "abcd");
  write_bytes(folder.path / "2.raw", "efgh");
  write_bytes(folder.path / "v.nhdr", header_of("raw") + "data file: %d.raw 1 2 1 3\n");
  const auto read = read_volume(folder.path / "v.nhdr");
  REQUIRE(read);
  CHECK(read->volume.data == letters);
}

TEST_CASE("lines and bytes are skipped in each of several files") {
  const TemporaryFolder folder;
  write_bytes(folder.path / "1.raw", "line\n12abcd");
  write_bytes(folder.path / "2.raw", "longer line\n34efgh");
  const std::string by_lines = header_of("raw") + "line skip: 1\nbyte skip: 2\ndata file: %d.raw 1 2 1 3\n",
                    from_the_end = header_of("raw") + "byte skip: -1\ndata file: %d.raw 1 2 1 3\n";
  for (const std::string& header : {by_lines, from_the_end}) {
    write_bytes(folder.path / "v.nhdr", header);
    const auto read = read_volume(folder.path / "v.nhdr");
    REQUIRE(read);
    CHECK(read->volume.data == letters);
  }
  for (const char* skip : {"line skip: 3", "byte skip: -2", "byte skip: 1000000000000"}) {
    CAPTURE(std::string(skip));
    write_bytes(folder.path / "v.nhdr", header_of("raw") + skip + "\ndata file: %d.raw 1 2 1 3\n");
    CHECK(!read_volume(folder.path / "v.nhdr"));
  }
}

TEST_CASE("voxels written as numbers or hexadecimal digits are read") {
  const auto numbers = read_text("ascii", "97 98,99\n\t100 101 +102 103.0 104");
  REQUIRE(numbers);
  CHECK(numbers->volume.data == letters);
  const auto hex = read_text("hex", "6162 63\n6465 66\n67 6 8");
  REQUIRE(hex);
  CHECK(hex->volume.data == letters);
  const auto words = read_text("hex", "0100ff7f 0000 0000 0000 0000 0000 0080", "int16");
  REQUIRE(words);
  CHECK(words->volume.data == VoxelData(std::vector<std::int16_t>{1, 32767, 0, 0, 0, 0, 0, -32768}));
  const auto reals = read_text("ascii", "0.5 -1e3 nan 0 0 0 0 1", "float");
  REQUIRE(reals);
  CHECK(reals->volume.range_min == -1000);
  for (const char* text : {"1 2 3 4 5 6 7", "1 2 3 4 5 6 7 x", "1 2 3 4 5 6 7 256", "1 2 3 4 5 6 7 -1",
                           "1 2 3 4 5 6 7 1.5", "1 2 3 4 5 6 7 1e300", ""}) {
    CAPTURE(std::string(text));
    CHECK(!read_text("ascii", text));
  }
  CHECK(!read_text("hex", "61626364656667"));
  CHECK(!read_text("hex", "616263646566676g"));
}

TEST_CASE("headers that end or begin otherwise than NRRD's are refused") {
  const TemporaryFolder folder;
  const std::string whole = header_of("raw");
  for (const std::string& text :
       std::vector<std::string>{whole, whole.substr(0, 30), "NRRD0004\n\nabcdefgh", "type: uint8\n\nabcdefgh",
                                "NRRD0004\n" + std::string(5000, 'x'), whole + "sizes: 2 1 4\n\nabcdefgh",
                                header_of("nonsense") + "\nabcdefgh", header_of("raw", "block") + "\nabcdefgh"}) {
    CAPTURE(text);
    write_bytes(folder.path / "v.nrrd", text);
    CHECK(!read_volume(folder.path / "v.nrrd"));
  }
  write_bytes(folder.path / "v.nrrd", whole + "# a" + std::string(1, '\0') + "b\n\nabcdefgh");
  CHECK(says(read_volume(folder.path / "v.nrrd"), "its header is damaged"));
  // The library would leak 88 bytes over each of these.
  write_bytes(folder.path / "v.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nencoding: raw\n\nabcdefgh");
  CHECK(says(read_volume(folder.path / "v.nrrd"), "lacks the field sizes"));
  write_bytes(folder.path / "v.nrrd", "NRRD0004\ntype: uint8\nencoding: raw\n\nabcdefgh");
  CHECK(says(read_volume(folder.path / "v.nrrd"), "lacks the field dimension"));
  std::string with_returns;
  for (const char c : whole + "\n") with_returns += c == '\n' ? std::string("\r\n") : std::string(1, c);
  write_bytes(folder.path / "v.nrrd", with_returns + "abcdefgh");
  const auto read = read_volume(folder.path / "v.nrrd");
  REQUIRE(read);
  CHECK(read->volume.data == letters);
}

TEST_CASE("a header may have long remarks and no long fields") {
  const TemporaryFolder folder;
  const std::string longest(100'000, '9');
  const auto read_with = [&](const std::string& line) {
    write_bytes(folder.path / "v.nrrd", header_of("raw") + line + "\n\nabcdefgh");
    return read_volume(folder.path / "v.nrrd");
  };
  for (const std::string start : {"# ", "key:=", "content: "}) {
    CAPTURE(start);
    const auto read = read_with(start + longest);
    REQUIRE_MESSAGE(read, read.error().sentence());
    CHECK(read->volume.data == letters);
  }
  // The library would write beyond its buffers over each of these.
  for (const std::string start : {"", "kinds: ", "units: ", "space: ", "spacings: 1 1 ", "labels: \"a\" "})
    CHECK(says(read_with(start + longest), "characters"));
}

TEST_CASE("packed voxels do not begin hundreds of megabytes behind a header") {
  const TemporaryFolder folder;
  write_bytes(folder.path / "v.raw.gz", std::string(1'000'000, 'x'));
  ByteBlock block{.file = folder.path / "v.raw.gz", .skip = 200'000'000, .compression = Compression::Deflate};
  CHECK(check_claim(block, 1));
  block.skip = 300'000'000;  // a file of 10 MB could ask for 10 GB to be unpacked and passed over
  CHECK(says(check_claim(block, 1), "far behind its header"));
}

TEST_CASE("memory for compressed voxels is taken as they arrive") {
  std::string bytes(600000, '\0');
  unsigned random = 1;
  for (char& byte : bytes) byte = static_cast<char>((random = random * 1664525 + 1013904223) >> 24);
  std::string packed(compressBound(bytes.size()), '\0');
  uLongf size = packed.size();
  REQUIRE(compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                   bytes.size()) == Z_OK);
  const TemporaryFolder folder;
  const std::string claim = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 800 800 800\nencoding: gzip\n\n";
  write_bytes(folder.path / "v.nrrd", claim + packed.substr(0, size));
  const double taken = memory_taken_by([&] { CHECK(says(read_volume(folder.path / "v.nrrd"), "cut short")); });
  CHECK(taken < 50e6);  // of the 512 MB claimed
}
