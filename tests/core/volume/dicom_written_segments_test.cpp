#include "core/volume/dicom/dicom_written_segments.h"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "tests/core/volume/dicom_slices.h"

// How the segments of a label map are described in a DICOM segmentation.
using namespace homolog;

namespace {

struct Described {
  std::vector<std::string> bytes, warnings;

  bool holds(std::size_t segment, const std::string& element_bytes) const {
    return bytes.at(segment).find(element_bytes) != std::string::npos;
  }
};

Described described(const std::vector<Segment>& segments) {
  std::vector<WrittenSegment> written;
  for (const Segment& one : segments) written.push_back({one, static_cast<int>(written.size()) + 1});
  Described result;
  for (const DicomElements& one : described_segments("seg.dcm", written, result.warnings))
    result.bytes.push_back(one.bytes());
  return result;
}

std::string label(const std::string& text) {
  return element(0x00620005, "LO", text);
}

const std::string description_mark = little_endian(0x62, 2) + little_endian(6, 2) + "ST";
const std::string general = element(0x00080100, "SH", "91723000");

}  // namespace

TEST_CASE("names of segments that DICOM has no room for stay different and whole in the descriptions") {
  const std::string long_name(80, 'L');
  const Described made = described(
      {{.name = "spleen"}, {.name = long_name}, {.name = long_name + "x"}, {.name = "a\\b"}, {.name = "a/b"}});
  REQUIRE(made.bytes.size() == 5);
  CHECK(made.holds(0, label("spleen")));
  CHECK_FALSE(made.holds(0, description_mark));
  CHECK(made.holds(1, label(std::string(64, 'L'))));
  CHECK(made.holds(1, element(0x00620006, "ST", long_name)));
  CHECK(made.holds(2, label(std::string(60, 'L') + " (3)")));
  CHECK(made.holds(2, element(0x00620006, "ST", long_name + "x")));
  CHECK(made.holds(3, label("a/b (4)")));
  CHECK(made.holds(3, element(0x00620006, "ST", "a\\b")));
  CHECK(made.holds(4, label("a/b")));
  REQUIRE(made.warnings.size() == 1);
  CHECK(made.warnings.front().find("seg.dcm: \"" + long_name + "\" became \"" + std::string(64, 'L') +
                                   "\", and 2 others, since names of segments") == 0);
  // 64 letters of two bytes each fit; segments of one name keep it.
  std::string letters;
  for (int k = 0; k < 64; ++k) letters += "ü";
  const Described fit = described({{.name = letters}, {.name = "Lesion"}, {.name = "Lesion"}, {.value = 7}});
  CHECK(fit.warnings.empty());
  CHECK(fit.holds(0, label(letters)));
  CHECK(fit.holds(2, label("Lesion")));
  CHECK(fit.holds(3, label("Label 7")));
}

TEST_CASE("the terminology of a segment is written as codes and one without room is said") {
  const std::string kidney =
      "Segmentation category and type - 3D Slicer General Anatomy list~SCT^123037004^Anatomical Structure~"
      "SCT^64033007^Kidney~SCT^7771000^Left~Anatomic codes - DICOM master list~^^~^^";
  Described made = described({{.name = "kidney", .terminology = kidney}, {.name = "liver"}});
  CHECK(made.warnings.empty());
  CHECK_FALSE(made.holds(0, general));
  CHECK(made.holds(0, element(0x00080100, "SH", "123037004")));
  CHECK(made.holds(0, element(0x00080100, "SH", "64033007") + element(0x00080102, "SH", "SCT") +
                          element(0x00080104, "LO", "Kidney")));
  CHECK(made.holds(0, element(0x00080104, "LO", "Left")));
  CHECK(made.holds(1, general));
  made = described({{.name = "mass",
                     .terminology = "c~SCT^49755003^Morphologically Altered Structure~SCT^4147007^Mass~^^~"
                                    "Anatomic codes~SCT^64033007^Kidney~SCT^24028007^Right"}});
  CHECK(made.holds(0, element(0x00080104, "LO", "Mass")));
  CHECK(made.holds(0, element(0x00080104, "LO", "Right")));
  for (const char* codes : {"c~SCT^123037004^Anatomical Structure~SCT^12345678901234567^Kidney~^^~~^^~^^",
                            "c~SCT^123037004^Anatomical Structure", "c~SCT^1^A~SCT^2^B~^^~~SCT^3~^^"}) {
    CAPTURE(codes);
    made = described({{.name = "liver"}, {.name = "kidney", .value = 2, .terminology = codes}});
    CHECK(made.holds(1, general));
    REQUIRE(made.warnings.size() == 1);
    CHECK(made.warnings.front().find("seg.dcm: says of label 2 (kidney) only that it is an anatomical structure") == 0);
  }
}
