#include <doctest/doctest.h>

#include "core/volume/volume_io.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

using namespace homolog;

namespace {

Result<VolumeRead> read_metaimage_of(const std::string& bytes) {
  const TemporaryFolder folder;
  write_bytes(folder.path / "v.mha", bytes);
  return read_volume(folder.path / "v.mha");
}

}  // namespace

TEST_CASE("MetaImage says its units in any case and unknown ones are named") {
  const auto in_units = [](const std::string& line) {
    return read_metaimage_of("NDims = 3\nDimSize = 2 1 1\nElementSpacing = 1 2 3\nOffset = 4 5 6\n" + line +
                             "ElementType = MET_UCHAR\nElementDataFile = LOCAL\nab");
  };
  const std::vector<std::pair<std::string, double>> units{
      {"", 1},     {"mm", 1},   {"cm", 10}, {"um", 1e-3},      {"CM", 10},      {"UM", 1e-3},
      {"m", 1000}, {"M", 1000}, {"?", 1},   {"microns", 1e-3}, {"Meter", 1000}, {"\xc2\xb5m", 1e-3}};
  for (const auto& [unit, mm] : units) {
    CAPTURE(unit);
    const auto read = in_units(unit.empty() ? "" : "DistanceUnits = " + unit + "\n");
    REQUIRE(read);
    CHECK((read->volume.geometry.spacing_mm - mm * Vec3(1, 2, 3)).norm() < 1e-9 * mm);
    CHECK((read->volume.geometry.origin_mm - mm * Vec3(4, 5, 6)).norm() < 1e-9 * mm);
    CHECK(read->warnings.empty());
  }
  const auto unknown = in_units("DistanceUnits = parsec\n");
  REQUIRE(unknown);
  REQUIRE(unknown->warnings.size() == 1);
  CHECK(unknown->warnings.front().find("lengths in parsec") != std::string::npos);
}

TEST_CASE("MetaImage's intensity function is applied") {
  const auto with = [](const std::string& lines) {
    return read_metaimage_of("NDims = 3\nDimSize = 2 1 1\nElementSpacing = 1 1 1\n" + lines +
                             "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n" + std::string("\0\7", 2));
  };
  const std::string slope = "ElementToIntensityFunctionSlope = ", offset = "ElementToIntensityFunctionOffset = ";
  const auto both = with(slope + "2\n" + offset + "-5\n");
  REQUIRE(both);
  CHECK(both->volume.data == VoxelData(std::vector<std::int16_t>{-5, 9}));
  CHECK(with(offset + "3\n")->volume.data == VoxelData(std::vector<std::uint8_t>{3, 10}));
  CHECK(with(slope + "0.5\n")->volume.range_max == 3.5);
  CHECK(with(slope + "1\n" + offset + "0\n")->volume.data == VoxelData(std::vector<std::uint8_t>{0, 7}));
  for (const std::string& lines : {slope + "0\n", slope + "nan\n", offset + "x\n", slope + "1 2\n"})
    CHECK(says(with(lines), "ElementToIntensityFunction"));
}

TEST_CASE("MetaImage's numbers are whole and its voxels are as many as its sizes say") {
  const auto with = [](const std::string& lines, const std::string& voxels = "ab") {
    return read_metaimage_of("NDims = 3\n" + lines + "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n" + voxels);
  };
  const std::string two = "DimSize = 2 1 1\n";
  REQUIRE(with(two + "Offset = -20 1.5 5\nElementSpacing = 2, 2.5, 2\n"));
  CHECK(says(with(two + "Offset = -20 1,5 5\n"), "Offset is \"-20 1,5 5\", and not 3 numbers"));
  CHECK(says(with(two + "ElementSpacing = 2 2,5 2\n"), "ElementSpacing is \"2 2,5 2\""));
  CHECK(says(with(two + "ElementSpacing = 2,5 2\n"), "ElementSpacing is"));
  CHECK(says(with("DimSize = 1,5 2 1\n"), "DimSize is"));
  CHECK(says(with(two + "Offset = 1e308 0 0\n"), "lies beyond 1,000,000,000 mm"));
  CHECK(says(with(two + "ElementSpacing = 4294967295 1 1\n"), "lies beyond 1,000,000,000 mm"));
  CHECK(says(with(two, "abc"), "holds more voxels than its header says"));
  CHECK(with("DimSize = 3 3 1\n", std::string("abcdefghi\0\0", 11)));                               // padding
  CHECK(says(with("DimSize = 3 3 1\n", std::string("abcdefghi\0\0\0", 12)), "holds more voxels"));  // a slice of zeros
  for (const char* offset : {"20-1 5", "1.5x 0 0", "1 2 3x", "1 2 3 4", "1+2 3"}) {
    CAPTURE(offset);
    CHECK(says(with(two + "Offset = " + offset + "\n"), "Offset is"));
  }
  CHECK(with(two + "Offset = +1, -2,\t3 ,\n"));
  CHECK(
      read_metaimage_of("NDims = 2\nDimSize = 2 1 \nElementSpacing = 1.0 1.0 1.0\nElementType = MET_UCHAR\n"
                        "ElementDataFile = LOCAL\nab"));  // as some programs write images
}
