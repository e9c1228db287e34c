#include "core/volume/labels/segmentation.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/base/numbers/geometry.h"
#include "tests/refusal.h"
#include "tests/seen_colours.h"

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

/// A colour of sRGB in CIELAB, as seen by an eye that mixes the linear channels.
Vec3 lab_of(const std::array<std::uint8_t, 3>& colour, const Mat3& eye) {
  Vec3 linear;
  for (Eigen::Index c = 0; c < 3; ++c) {
    const double share = colour[static_cast<std::size_t>(c)] / 255.0;
    linear[c] = share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
  }
  const Mat3 to_xyz =
      (Mat3() << 0.4124564, 0.3575761, 0.1804375, 0.2126729, 0.7151522, 0.0721750, 0.0193339, 0.1191920, 0.9503041)
          .finished();
  Vec3 f = (to_xyz * (eye * linear).cwiseMax(0).cwiseMin(1)).cwiseQuotient(Vec3(0.95047, 1, 1.08883));
  for (double& v : f) v = v > 0.008856 ? std::cbrt(v) : 7.787 * v + 16.0 / 116;
  return {116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])};
}

}  // namespace

TEST_CASE("segments are asked for by value or by name in any case") {
  CHECK(values_asked("1") == std::vector{1});
  CHECK(values_asked("7") == std::vector{7});
  CHECK(values_asked(" SPLEEN ") == std::vector{1});
  CHECK(values_asked("kidney_left") == std::vector{3});  // in the same case there is one
  CHECK(values_asked("Kidney_Left, 1,spleen") == std::vector{4, 1, 1});
  Segmentation of_slicer;
  for (const char* name : {"Left kidney", "Right kidney", "kidney-left.cyst"})
    of_slicer.add({.name = name, .value = static_cast<int>(of_slicer.segments.size()) + 1});
  CHECK(asked_segments("kidney_left", of_slicer)->front().value == 1);
  CHECK(asked_segments("kidney right", of_slicer)->front().value == 2);
  CHECK(asked_segments("Cyst kidney left", of_slicer)->front().value == 3);
  CHECK(says(asked_segments("kidneyleft", of_slicer), "has no label named"));
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

TEST_CASE("organs of the abdomen have colours that everybody tells apart") {
  // CIELAB as all cones see it, and without those for long, middle or short waves [Machado et al. 2009].
  const std::array<Mat3, 4> eyes{
      Mat3::Identity(),
      (Mat3() << 0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998)
          .finished(),
      (Mat3() << 0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940, 0.968881).finished(),
      (Mat3() << 1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.303900)
          .finished()};
  const std::vector<std::string> organs{"liver",    "bladder",  "gallbladder", "spleen",
                                        "aorta",    "kidney",   "colon",       "inferior_vena_cava",
                                        "duodenum", "pancreas", "stomach",     "adrenal_gland"};
  for (std::size_t a = 0; a < organs.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      for (const Mat3& eye : eyes) {
        CAPTURE(organs[a] + " and " + organs[b]);
        CHECK((lab_of(colour_by_name(organs[a]), eye) - lab_of(colour_by_name(organs[b]), eye)).norm() > 20);
      }
}

TEST_CASE("the left and the right of a pair have a lighter and a darker colour of one hue") {
  const auto colour = colour_by_name("kidney");
  const auto left = colour_by_name("Kidney_Left"), right = colour_by_name("right kidney");
  for (std::size_t c = 0; c < 3; ++c) {
    CHECK(left[c] >= colour[c]);
    CHECK(right[c] <= colour[c]);
  }
  CHECK((lab_of(left, Mat3::Identity()) - lab_of(right, Mat3::Identity())).norm() > 15);
  for (const char* same : {"kidney_left", "Left-Kidney", "LeftKidney", "kidney.l", "L kidneys"})
    CHECK(colour_by_name(same) == left);
  for (const char* same : {"ctx-rh-cuneus", "ctx cuneus right"})
    CHECK(colour_by_name(same) == colour_by_name("ctx_R_cuneus"));
}

TEST_CASE("neighbours along the spine and in a numbered row have unlike colours") {
  const std::vector<std::string> spine{"vertebrae_C7", "vertebrae_T1", "vertebrae_T12", "vertebrae_L1",
                                       "vertebrae_L4", "vertebrae_L5", "sacrum"};
  for (std::size_t k = 1; k < spine.size(); ++k) CHECK(colour_by_name(spine[k - 1]) != colour_by_name(spine[k]));
  CHECK(colour_by_name("vertebrae_L1") == colour_by_name("L1"));
  CHECK(colour_by_name("disc_L4_L5") != colour_by_name("vertebrae_L4"));
  CHECK(colour_by_name("disc_L4_L5") != colour_by_name("vertebrae_L5"));
  CHECK(colour_by_name("rib_left_3") != colour_by_name("rib_left_4"));
  CHECK(colour_by_name("something else") == colour_by_name("Something-Else"));
  CHECK(colour_by_name("") == colour_by_name("_"));
  CHECK(colour_by_name("Label_99999999999999999999") == colour_by_name("label 99999999999999999999"));
}

TEST_CASE("structures of one map that would have the same colour get ones that everybody tells apart") {
  Segmentation spine, turned;
  const std::vector<std::string> names{"vertebrae_T11", "disc_T11_T12", "vertebrae_T12", "disc_T12_L1",  "vertebrae_L1",
                                       "disc_L1_L2",    "vertebrae_L2", "disc_L2_L3",    "vertebrae_L3", "disc_L3_L4",
                                       "vertebrae_L4",  "disc_L4_L5",   "vertebrae_L5",  "disc_L5_S1",   "sacrum",
                                       "kidney_left",   "kidney_right"};
  const auto count = static_cast<int>(names.size());
  for (int k = 0; k < count; ++k) {
    spine.add({.name = names[static_cast<std::size_t>(k)], .value = k + 1});
    turned.add({.name = names[static_cast<std::size_t>(k)], .value = count - k});
  }
  colour_by_names(spine);
  colour_by_names(turned);
  const std::array<test::ColourVision, 4>& eyes = test::colour_visions;
  const auto light_of = [](const Segment& segment) {
    const auto& [r, g, b] = *segment.colour;
    return test::light_of({r / 255.0, g / 255.0, b / 255.0});
  };
  for (int a = 1; a <= count; ++a) {
    CHECK(turned.find(count + 1 - a)->colour == spine.find(a)->colour);
    for (int b = 1; b < a && a <= count - 2; ++b)  // but for the kidneys, which are shades of one colour
      for (const auto& eye : eyes) {
        CAPTURE(names[static_cast<std::size_t>(a - 1)] + " and " + names[static_cast<std::size_t>(b - 1)]);
        CHECK(test::colour_difference(eye.seen(light_of(*spine.find(a))), eye.seen(light_of(*spine.find(b)))) > 10);
      }
  }
  CHECK(spine.find(count - 1)->colour != spine.find(count)->colour);
  // Who has no rival, or is given a colour, keeps it.
  Segmentation few;
  few.add({.name = "liver", .value = 1});
  few.add({.name = "spleen", .value = 2, .colour = std::array<std::uint8_t, 3>{1, 2, 3}});
  few.add({.name = "", .value = 3});
  colour_by_names(few);
  CHECK(few.find(1)->colour == colour_by_name("liver"));
  CHECK(few.find(2)->colour == std::array<std::uint8_t, 3>{1, 2, 3});
  CHECK_FALSE(few.find(3)->colour);
}

TEST_CASE("a segmentation holds one segment of each value and layer") {
  Segmentation known = three_segments();
  CHECK(!known.add({.name = "again", .value = 1}));
  CHECK(known.find(1, 0)->name == "spleen");
  CHECK(known.find(4, 0) == nullptr);
  CHECK(known.find(4)->layer == 1);
}
