#include "core/volume/segmentation.h"

#include <doctest/doctest.h>

#include "tests/refusal.h"

using namespace homolog;

namespace {

Segmentation three_segments() {
  Segmentation known;
  known.add({.name = "spleen", .value = 1});
  known.add({.name = "kidney_left", .value = 3});
  known.add({.name = "Kidney_Left", .value = 4, .layer = 1});
  known.add({.name = {}, .value = 5});
  known.add({.name = {}, .value = 5, .layer = 1});
  return known;
}

std::vector<int> values_asked(const std::string& asked) {
  const auto segments = asked_segments(asked, three_segments());
  REQUIRE_MESSAGE(segments, segments.error().sentence());
  std::vector<int> values;
  for (const Segment& segment : *segments) values.push_back(segment.value);
  return values;
}

}  // namespace

TEST_CASE("segments are asked for by value or by name in any case") {
  CHECK(values_asked("1") == std::vector{1});
  CHECK(values_asked("7") == std::vector{7});
  CHECK(values_asked(" SPLEEN ") == std::vector{1});
  CHECK(values_asked("kidney_left") == std::vector{3});  // in the same case there is one
  CHECK(values_asked("Kidney_Left, 1,spleen") == std::vector{4, 1, 1});
  const Segmentation known = three_segments();
  CHECK(says(asked_segments("KIDNEY_LEFT", known), "to several segments (label 3 (kidney_left) and label 4"));
  CHECK(says(asked_segments("spleem", known), "has no label named \"spleem\"; the nearest names in it are \"spleen\""));
  CHECK(says(asked_segments("5", known), "label 5 in layers 0 and 1"));
  CHECK(says(asked_segments("spleen", {}), "names none of its labels"));
}

TEST_CASE("what is neither a label value nor a name of a segment is known beforehand") {
  for (const char* bad : {"", "0", "-1", "1,", ",1", "1;2", "1.5", "a,,b"}) CHECK(is_bad_label(bad));
  for (const char* good : {"1", "1,2", "L3", "left kidney", "a,b", "1,a"}) CHECK(!is_bad_label(good));
}

TEST_CASE("a segment's name is UTF-8 without control characters") {
  CHECK(segment_name(" Milz\n") == "Milz");
  CHECK(segment_name("N\xe4he\x1b[2J") == "N\xc3\xa4he?[2J");
  CHECK(segment_name("N\xc3\xa4he") == "N\xc3\xa4he");
}

TEST_CASE("a structure without a colour has one by its name that both sides share") {
  CHECK(colour_by_name("Kidney_Left") == colour_by_name("right kidney"));
  CHECK(colour_by_name("kidney") != colour_by_name("aorta"));
  CHECK(colour_by_name("vertebrae_L1") != colour_by_name("vertebrae_L2"));
}

TEST_CASE("a segmentation holds one segment of each value and layer") {
  Segmentation known = three_segments();
  CHECK(!known.add({.name = "again", .value = 1}));
  CHECK(known.find(1, 0)->name == "spleen");
  CHECK(known.find(4, 0) == nullptr);
  CHECK(known.find(4)->layer == 1);
}
