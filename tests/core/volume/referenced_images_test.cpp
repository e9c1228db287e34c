#include "core/volume/referenced_images.h"

#include <doctest/doctest.h>

#include <optional>
#include <string>

#include "tests/must.h"
#include "tests/refusal.h"

// What a segmentation or contours say of the images that they were made on.
using namespace homolog;

namespace {

/// Three slices of a series.
Volume image_of_series() {
  Volume image;
  image.frame_of_reference = "1.2.9";
  image.series_uid = "1.2.3";
  image.study_uid = "1.2.8";
  image.images = {{.uid = "1.1"}, {.uid = "1.2"}, {.uid = "1.3"}};
  return image;
}

/// The warning; empty: none.
std::string warning_of(const ReferencedImages& referenced, const Volume& image, const std::string& space = "1.2.9") {
  return test::must(check_scan("seg.dcm", space, referenced, "ct", image)).value_or("");
}

}  // namespace

TEST_CASE("what was drawn in another frame of reference is refused with both") {
  Volume image = image_of_series();
  const ReferencedImages same{{"1.2.3"}, {}, {}};
  const auto other = check_scan("seg.dcm", "1.2.10", same, "ct", image, " by --like");
  REQUIRE_FALSE(other);
  CHECK(
      other.error().sentence() ==
      "seg.dcm: was drawn on another scan than ct (frames of reference 1.2.10 and 1.2.9); give the series that it was "
      "drawn on by --like");
  image.modality = "SEG";
  CHECK(says(check_scan("seg.dcm", "1.2.10", same, "ct", image), "was drawn on another scan"));
  // One that says none is taken for the same.
  image.modality.clear();
  CHECK(warning_of(same, image, "").empty());
  image.frame_of_reference.clear();
  CHECK(warning_of(same, image, "1.2.10").empty());
}

TEST_CASE("another series or other images of the same space are a warning") {
  Volume image = image_of_series();
  CHECK(warning_of({}, image).empty());
  CHECK(warning_of({{"1.2.3"}, {"1.1", "1.3"}, {}}, image).empty());
  CHECK(warning_of({{"1.2.4", "1.2.3"}, {}, {}}, image).empty());
  CHECK(warning_of({{"1.2.4"}, {}, {}}, image) ==
        "seg.dcm: refers to the series 1.2.4, and ct is series 1.2.3 in the same space; check that it was made on that "
        "image");
  const auto lacks = [&](const std::vector<std::string>& instances, const std::string& words) {
    const std::string warning = warning_of({{}, instances, {}}, image);
    CAPTURE(warning);
    CHECK(warning.find("seg.dcm: refers to " + words + " in ct; check that") == 0);
  };
  lacks({"1.1", "9.9"}, "2 images, 1 of which is not");
  lacks({"1.1", "9.9", "9.9", "9.8"}, "3 images, 2 of which are not");
  lacks({"9.8", "9.9"}, "2 images, none of which is");
  lacks({"9.9"}, "1 image, none of which is");
  // Where the image does not say what it was read from, or is a segmentation itself, nothing is known.
  image.images.clear();
  CHECK(warning_of({{}, {"9.9"}, {}}, image).empty());
  image.series_uid.clear();
  CHECK(warning_of({{"1.2.4"}, {}, {}}, image).empty());
  image = image_of_series();
  image.modality = "SEG";
  CHECK(warning_of({{"1.2.4"}, {"9.9"}, {}}, image).empty());
}

TEST_CASE("the study counts where no image is named") {
  Volume image = image_of_series();
  CHECK(warning_of({{}, {}, "1.2.8"}, image).empty());
  CHECK(warning_of({{}, {}, "1.2.7"}, image).find("seg.dcm: is of the study 1.2.7, and ct of the study 1.2.8") == 0);
  CHECK(warning_of({{"1.2.3"}, {}, "1.2.7"}, image).empty());
  image.study_uid.clear();
  CHECK(warning_of({{}, {}, "1.2.7"}, image).empty());
}

TEST_CASE("a plane of a file of several is named by its number and a file of one with and without") {
  DicomItem reference;
  CHECK(named_image(reference).empty());
  reference[0x00081155].value = "1.5";
  const std::string whole = named_image(reference);
  const auto plane = [&](const std::string& number) {
    reference[0x00081160].value = number;
    return named_image(reference);
  };
  const std::vector<SourceImage> images{{.uid = "1.5", .slice = 2, .frame = 1},
                                        {.uid = "1.5", .slice = 0, .frame = 2},
                                        {.uid = "1.6", .slice = 1},
                                        {.uid = "1.7", .slice = 1},
                                        {.uid = "1.7", .slice = 2}};
  const auto by_name = images_by_name(images);
  const auto slice_of = [&](const std::string& name) {
    const auto found = by_name.find(name);
    return found == by_name.end() || found->second == nullptr ? -1 : found->second->slice;
  };
  CHECK(slice_of(whole) == -1);
  CHECK(slice_of(plane("1")) == 2);
  CHECK(slice_of(plane("2 ")) == 0);
  CHECK(slice_of(plane("3")) == -1);
  CHECK(plane("1\\2").empty());
  reference[0x00081155].value = "1.6";
  CHECK(slice_of(plane("1")) == 1);
  CHECK(slice_of(plane("")) == 1);
  reference[0x00081155].value = "1.7";
  CHECK(slice_of(plane("")) == -1);
}
