#include "core/volume/contours.h"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "core/volume/contour_labels.h"
#include "core/volume/dicom/dicom_text.h"
#include "core/volume/volume_io.h"
#include "tests/core/volume/structure_set_file.h"
#include "tests/must.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

using namespace homolog;

namespace {

Result<Contours> read_rt(const RtFile& file) {
  const TemporaryFolder folder;
  write_bytes(folder.path / "rt.dcm", file.bytes());
  return read_contours(folder.path / "rt.dcm");
}

/// A grid of 10 × 10 × 4 voxels of 1 × 1 × 2 mm, turned about the x axis.
Volume turned_image() {
  Volume image;
  image.geometry.dims = {10, 10, 4};
  image.geometry.spacing_mm = {1, 1, 2};
  image.geometry.origin_mm = {-3, 4, 50};
  image.geometry.direction = Eigen::AngleAxisd(0.4, Vec3::UnitX()).toRotationMatrix();
  image.frame_of_reference = "1.2.9";
  image.data = std::vector<std::uint8_t>(400);
  return image;
}

/// Points, given in voxels, as the file holds them.
std::string in_mm(const Volume& image, const std::vector<Vec3>& voxels) {
  std::string text;
  for (const Vec3& voxel : voxels) {
    const Vec3 p = image.geometry.to_mm(voxel);
    for (int a = 0; a < 3; ++a) text += (text.empty() ? "" : "\\") + std::to_string(p[a]);
  }
  return text;
}

std::vector<Vec3> square(double from, double to, double k) {
  return {{from, from, k}, {to, from, k}, {to, to, k}, {from, to, k}};
}

std::size_t count_of(const Result<VolumeRead>& read, int label) {
  if (!read) FAIL(read.error().sentence());
  const auto held = labels_of(read->volume);
  return held.contains(label) ? held.at(label) : 0;
}

bool warned(const std::vector<std::string>& warnings, const std::string& of) {
  return std::any_of(warnings.begin(), warnings.end(),
                     [&](const std::string& warning) { return warning.find(of) != std::string::npos; });
}

}  // namespace

TEST_CASE("a hole in contours stays a hole whether it is a keyhole or cut out by exclusive or") {
  const Volume image = turned_image();
  RtFile file;
  // Outer 7 × 7 voxels, inner 3 × 3; the keyhole goes in and out along one line.
  std::vector<Vec3> keyhole = square(0.5, 7.5, 1);
  keyhole.insert(keyhole.end(),
                 {{0.5, 0.5, 1}, {2.5, 2.5, 1}, {2.5, 5.5, 1}, {5.5, 5.5, 1}, {5.5, 2.5, 1}, {2.5, 2.5, 1}});
  file.drawn = {{1, "CLOSED_PLANAR", in_mm(image, keyhole)}};
  auto contours = read_rt(file);
  if (!contours) FAIL(contours.error().sentence());
  CHECK(contours->warnings.empty());
  CHECK(contours->rois.front().planes() == 1);
  auto read = labels_of_contours("rt.dcm", *contours, "image", image);
  CHECK(count_of(read, 1) == 49 - 9);
  CHECK(read->volume.at(4, 4, 1) == 0);
  CHECK(read->volume.at(1, 1, 1) == 1);
  CHECK(read->volume.at(7, 7, 1) == 1);
  CHECK(read->volume.at(1, 1, 0) == 0);
  CHECK(read->warnings.empty());

  file.drawn = {{1, "CLOSEDPLANAR_XOR", in_mm(image, square(0.5, 7.5, 1))},
                {1, "CLOSEDPLANAR_XOR", in_mm(image, square(2.5, 5.5, 1))}};
  contours = read_rt(file);
  REQUIRE(contours);
  read = labels_of_contours("rt.dcm", *contours, "image", image);
  CHECK(count_of(read, 1) == 40);
  CHECK(read->warnings.empty());
  for (ContourItem& one : file.drawn) one.kind = "CLOSED_PLANAR";
  contours = read_rt(file);
  REQUIRE(contours);
  read = labels_of_contours("rt.dcm", *contours, "image", image);
  CHECK(count_of(read, 1) == 40);
  CHECK(warned(read->warnings, "within one another on 1 plane"));
}

TEST_CASE("a gap between contours stays a gap and structures that overlap lie in layers") {
  const Volume image = turned_image();
  RtFile file;
  file.names = {"spleen", "liver", "marks"};
  file.drawn = {{1, "CLOSED_PLANAR", in_mm(image, square(0.5, 2.5, 0))},
                {1, "CLOSED_PLANAR", in_mm(image, square(0.5, 2.5, 3))},
                {2, "CLOSED_PLANAR", in_mm(image, square(1.5, 3.5, 3))},
                {3, "POINT", in_mm(image, {{5, 5, 2}})}};
  const auto contours = read_rt(file);
  if (!contours) FAIL(contours.error().sentence());
  const auto& rois = contours->rois;
  REQUIRE(rois.size() == 3);
  CHECK(rois[0].planes() == 2);
  CHECK(rois[2].contours.empty());
  REQUIRE(rois[2].points.size() == 1);
  CHECK((rois[2].points.front() - image.geometry.to_mm({5, 5, 2})).norm() < 1e-5);
  CHECK(rois[0].colour == std::array<std::uint8_t, 3>{255, 128, 0});
  const auto roi = roi_of(*contours, "LIVER");
  REQUIRE(roi);
  CHECK((*roi)->number == 2);
  CHECK(says(roi_of(*contours, "livver"), "liver"));
  CHECK(says(roi_of(*contours, "9"), "has no structure \"9\""));
  const auto read = labels_of_contours("rt.dcm", *contours, "image", image);
  CHECK(count_of(read, 1) == 8);
  CHECK(read->volume.at(1, 1, 0) == 1);
  CHECK(read->volume.at(1, 1, 1) == 0);
  CHECK(read->volume.at(1, 1, 2) == 0);
  CHECK(read->volume.at(1, 1, 3) == 1);
  REQUIRE(read->other_layers.size() == 1);
  CHECK(labels_of(read->other_layers.front()).at(2) == 4);
  CHECK(warned(read->warnings, "structure 3 (marks) has points or lines alone"));
}

TEST_CASE("contours on every second slice are said to be stripes and one gap is none") {
  Volume image = turned_image();
  image.geometry.dims[2] = 8;
  image.data = std::vector<std::uint8_t>(800);
  RtFile file;
  const auto drawn_on = [&](const std::vector<int>& slices) {
    file.drawn.clear();
    for (const int k : slices) file.drawn.push_back({1, "CLOSED_PLANAR", in_mm(image, square(0.5, 2.5, k))});
    return test::must(read_rt(file));
  };
  const auto warnings = [&](const Contours& contours) {
    return test::must(labels_of_contours("rt.dcm", contours, "image", image)).warnings;
  };
  Contours striped = drawn_on({5, 1, 3});
  CHECK(warned(warnings(striped),
               "its structure 1 (spleen) is drawn on 3 planes, mostly 4.00 mm apart, and the slices lie "
               "2.00 mm apart, so that those between its planes stay empty"));
  CHECK(striped.rois.front().planes_apart_mm().value() == doctest::Approx(4));
  CHECK(warnings(drawn_on({1, 2, 3, 6, 7})).empty());
  CHECK(warnings(drawn_on({1, 2, 5})).empty());
  CHECK(warnings(drawn_on({1, 5})).empty());
  CHECK_FALSE(drawn_on({1}).rois.front().planes_apart_mm().has_value());
}

TEST_CASE("a contour that is there again in the other direction or from another point on counts once") {
  const Volume image = turned_image();
  const std::vector<Vec3> once = square(0.5, 3.5, 1);
  const std::vector<Vec3> reversed(once.rbegin(), once.rend()), later{once[2], once[3], once[0], once[1]},
      crossed{once[0], once[2], once[1], once[3]};
  for (const auto& again : {once, reversed, later}) {
    RtFile file;
    file.drawn = {{1, "CLOSED_PLANAR", in_mm(image, once)}, {1, "CLOSED_PLANAR", in_mm(image, again)}};
    const Contours contours = test::must(read_rt(file));
    CHECK(contours.rois.front().contours.size() == 1);
    CHECK(warned(contours.warnings, "1 contour twice; one of each was taken"));
    CHECK(count_of(labels_of_contours("rt.dcm", contours, "image", image), 1) == 9);
    for (ContourItem& one : file.drawn) one.kind = "CLOSEDPLANAR_XOR";
    CHECK(test::must(read_rt(file)).rois.front().contours.size() == 2);
    for (ContourItem& one : file.drawn) one.kind = "OPEN_PLANAR";
    CHECK(test::must(read_rt(file)).rois.front().contours.size() == (again == later ? 2 : 1));
  }
  RtFile file;
  file.drawn = {{1, "CLOSED_PLANAR", in_mm(image, once)}, {1, "CLOSED_PLANAR", in_mm(image, crossed)}};
  CHECK(test::must(read_rt(file)).rois.front().contours.size() == 2);
}

TEST_CASE("contours that cross themselves and structures without points are named") {
  const Volume image = turned_image();
  RtFile file;
  file.names = {"bow", "nothing"};
  file.drawn = {{1, "CLOSED_PLANAR", in_mm(image, {{0, 0, 1}, {4, 4, 1}, {4, 0, 1}, {0, 4, 1}})}};
  const auto contours = read_rt(file);
  if (!contours) FAIL(contours.error().sentence());
  CHECK(warned(contours->warnings, "has 1 of 1 contours of its structure 1 (bow) that cross themselves"));
  CHECK(warned(contours->warnings, "has no points in its structure 2 (nothing)"));
}

TEST_CASE("contours of another scan or between its slices or of no structure are refused") {
  Volume image = turned_image();
  RtFile file;
  file.drawn = {{1, "CLOSED_PLANAR", in_mm(image, square(0.5, 2.5, 1.4))}};
  auto contours = read_rt(file);
  if (!contours) FAIL(contours.error().sentence());
  CHECK(says(labels_of_contours("rt.dcm", *contours, "image", image), "on planes that are no slices of image"));
  // One that is drawn on slices is written all the same.
  RtFile two = file;
  two.names = {"between", "on"};
  two.drawn.push_back({2, "CLOSED_PLANAR", in_mm(image, square(0.5, 2.5, 2))});
  const auto both = test::must(labels_of_contours("rt.dcm", test::must(read_rt(two)), "image", image));
  REQUIRE(both.segmentation.segments.size() == 1);
  CHECK(both.segmentation.segments.front().name == "on");
  CHECK(both.volume.at(1, 1, 2) == 2);
  CHECK(warned(both.warnings,
               "draws its structure 1 (between) on planes that are no slices of image; give the series "
               "that it was drawn on by --like, and not resampled (left out)"));
  image.frame_of_reference = "1.2.10";
  CHECK(says(labels_of_contours("rt.dcm", *contours, "image", image), "was drawn on another scan than image"));
  image.frame_of_reference.clear();
  image.study_uid = "1.2.11";
  Contours of_other = test::must(read_rt(two));
  of_other.referenced = {.study = "1.2.12"};
  CHECK(warned(test::must(labels_of_contours("rt.dcm", of_other, "image", image)).warnings,
               "is of the study 1.2.12, and image of the study 1.2.11; it names no image that it was made on"));
  of_other.referenced.study = "1.2.11";
  CHECK_FALSE(warned(test::must(labels_of_contours("rt.dcm", of_other, "image", image)).warnings, "of the study"));
  file.drawn.front().roi = 4;
  CHECK(says(read_rt(file), "has contours of structure 4, which it does not describe"));
  file.drawn.front() = {1, "CLOSED_PLANAR", "1\\2\\3\\4"};
  CHECK(says(read_rt(file), "in its structure 1 (spleen) has a contour whose points are missing or no numbers"));
  file.drawn.clear();
  file.space.clear();
  CHECK(says(read_rt(file), "names no frame of reference"));
}

TEST_CASE("contours between slices are left out and the structure keeps the others") {
  const Volume image = turned_image();
  RtFile file;
  file.drawn = {{1, "CLOSED_PLANAR", in_mm(image, square(0.5, 2.5, 0))},
                {1, "CLOSED_PLANAR", in_mm(image, square(0.5, 2.5, 1.4))},
                {1, "CLOSED_PLANAR", in_mm(image, square(0.5, 2.5, 3))}};
  const auto read = labels_of_contours("rt.dcm", test::must(read_rt(file)), "image", image);
  CHECK(count_of(read, 1) == 8);
  CHECK(read->volume.at(1, 1, 0) == 1);
  CHECK(read->volume.at(1, 1, 3) == 1);
  CHECK(warned(read->warnings, "draws 1 of 3 contours of its structure 1 (spleen) on planes that are no slices"));
}

TEST_CASE("contours on planes of one file are not said to refer to others and one that does is") {
  Volume image = turned_image();
  for (int k = 0; k < 4; ++k) image.images.push_back({.uid = "1.5", .slice = 3 - k, .frame = k + 1});
  RtFile file;
  for (const double k : {1, 2}) file.drawn.push_back({1, "CLOSED_PLANAR", in_mm(image, square(0.5, 2.5, k))});
  Contours contours = test::must(read_rt(file));
  auto& drawn = contours.rois.front().contours;
  const auto words = [&] { return test::must(labels_of_contours("rt.dcm", contours, "image", image)).warnings; };
  drawn[0].image = drawn[1].image = "1.5";
  CHECK_FALSE(warned(words(), "refers to the image of another slice"));
  drawn[0].image = "1.5:3";
  drawn[1].image = "1.5:2";
  CHECK_FALSE(warned(words(), "refers to the image of another slice"));
  drawn[1].image = "1.5:4";
  CHECK(warned(words(), "it lies on slice 3 of its series and refers to the image of slice 1"));
}

TEST_CASE("voxels whose centres lie on a contour belong to its structure and around a hole too") {
  const Volume image = turned_image();
  RtFile file;
  file.drawn = {{1, "CLOSED_PLANAR", in_mm(image, square(2, 6, 1))}};
  auto read = labels_of_contours("rt.dcm", test::must(read_rt(file)), "image", image);
  CHECK(count_of(read, 1) == 25);
  CHECK(read->volume.at(6, 6, 1) == 1);
  CHECK(read->volume.at(7, 6, 1) == 0);
  // A diamond, whose edges go through centres too.
  file.drawn = {{1, "CLOSED_PLANAR", in_mm(image, {{4, 1, 1}, {7, 4, 1}, {4, 7, 1}, {1, 4, 1}})}};
  read = labels_of_contours("rt.dcm", test::must(read_rt(file)), "image", image);
  CHECK(count_of(read, 1) == 25);
  file.drawn = {{1, "CLOSEDPLANAR_XOR", in_mm(image, square(0.5, 7.5, 1))},
                {1, "CLOSEDPLANAR_XOR", in_mm(image, square(2, 6, 1))}};
  read = labels_of_contours("rt.dcm", test::must(read_rt(file)), "image", image);
  CHECK(count_of(read, 1) == 49 - 9);
  CHECK(read->volume.at(6, 6, 1) == 1);
  CHECK(read->volume.at(5, 5, 1) == 0);
}

TEST_CASE("a structure is chosen by its number before a name that is one") {
  Contours contours;
  contours.rois = {{.name = "5", .number = 0, .type = {}}, {.name = "GTV", .number = 5, .type = {}}};
  CHECK(test::must(roi_of(contours, "0"))->number == 0);
  CHECK(test::must(roi_of(contours, " 5 "))->number == 5);
}

TEST_CASE("names of structures are read in the alphabets of their file") {
  const auto name_in = [](const std::string& alphabet, const std::string& name) {
    DicomItem data;
    data[0x00080005].value = alphabet;
    return DicomAlphabets(data).read(name).value_or("unread");
  };
  CHECK(name_in("", "spleen") == "spleen");
  CHECK(name_in("",
                "Gr\xf6\xdf"
                "e") == "Größe");
  CHECK(name_in("ISO_IR 144", "\xbf\xde\xe7\xda\xd0") == "Почка");
  CHECK(name_in("ISO_IR 101", "Dvo\xf8\xe1k") == "Dvořák");
  CHECK(name_in("ISO_IR 13", "\xd4\xcf\xc0\xde") == "ﾔﾏﾀﾞ");
  CHECK(name_in("GB18030", "\xb8\xce\xd4\xe0") == "肝脏");
  CHECK(name_in("\\ISO 2022 IR 87", "liver \x1b$B4NB!\x1b(B 1") == "liver 肝臓 1");
  CHECK(name_in("\\ISO 2022 IR 149", "\x1b$)C\xb0\xa3") == "간");
  CHECK(name_in("ISO 2022 IR 100\\ISO 2022 IR 144", "\xe9 \x1b-L\xbf") == "é П");
  CHECK(name_in("ISO_IR 144", "plain") == "plain");
  CHECK(name_in("ISO_IR 999", "\xbf") == "unread");
  CHECK(name_in("\\ISO 2022 IR 87", "\x1b$B4\x1b(B") == "unread");
}
