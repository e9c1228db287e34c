#include "core/volume/labels/label_tables.h"

#include <doctest/doctest.h>

#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "core/base/files/files.h"
#include "core/base/pictures/colour.h"
#include "core/volume/labels/write_segmentation.h"
#include "core/volume/volume_io.h"
#include "tests/must.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace fs = std::filesystem;
using namespace homolog;

namespace {

/// "1=spleen#ff0000 2=liver"
std::string names_in(const Result<Segmentation>& labels) {  // and the colours that are not those of their names
  REQUIRE_MESSAGE(labels, labels.error().sentence());
  std::string all;
  for (const Segment& segment : labels->segments)
    all += (all.empty() ? "" : " ") + std::to_string(segment.value) + "=" + segment.name +
           (segment.colour && *segment.colour != colour_by_name(segment.name) ? hex_of(*segment.colour) : "");
  return all;
}

/// Two labels in a row of six voxels.
Volume two_labels() {
  Volume map;
  map.geometry.dims = {6, 1, 1};
  map.data = std::vector<std::uint8_t>{0, 1, 1, 2, 2, 2};
  map.range_max = 2;
  return map;
}

/// A map beside which `file` holds `text`, as it is read.
VolumeRead with_file_beside(const std::string& file, const std::string& text, const Volume& map = two_labels()) {
  const TemporaryFolder folder;
  REQUIRE(write_volume(map, folder.path / "a_seg.nii.gz"));
  write_bytes(folder.path / file, text);
  auto read = read_volume(folder.path / "a_seg.nii.gz");
  REQUIRE(read);
  return *read;
}

/// A .nii file's bytes with an extension behind its header, as nibabel writes it: padded to 16 bytes.
std::string with_extension(std::string nii, int code, std::string content) {
  content.resize((content.size() + 8 + 15) / 16 * 16 - 8, '\0');
  const auto size = static_cast<std::int32_t>(content.size() + 8);
  std::string extension(8, '\0');
  std::memcpy(extension.data(), &size, 4);
  std::memcpy(extension.data() + 4, &code, 4);
  float offset = 0;
  std::memcpy(&offset, nii.data() + 108, 4);
  offset += static_cast<float>(size);
  std::memcpy(nii.data() + 108, &offset, 4);
  nii[348] = 1;
  return nii.insert(352, extension + content);
}

/// As TotalSegmentator puts its class map into the header.
const std::string caret_table =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?> <CaretExtension>  <Date><![CDATA[2013-07-14T05:45:09]]></Date>   "
    "<VolumeInformation Index=\"0\">   <LabelTable>\n"
    "<Label Key=\"1\" Red=\"0.0\" Green=\"1.0\" Blue=\"0.0\" Alpha=\"1\"><![CDATA[spleen]]></Label>\n"
    "<Label Key=\"2\" Red=\"0.0\" Green=\"0.0\" Blue=\"1.0\" Alpha=\"1\">kidney &amp; right</Label>\n\n"
    "  </LabelTable>  <VolumeType><![CDATA[Label]]></VolumeType>   </VolumeInformation></CaretExtension>\n   ";

}  // namespace

TEST_CASE("names of labels are read from JSON in the forms that programs write") {
  CHECK(names_in(labels_of_json(R"({"1": "spleen", "2": "liver"})")) == "1=spleen 2=liver");
  CHECK(names_in(labels_of_json(R"({"background": 0, "spleen": 1, "liver": 2})")) == "1=spleen 2=liver");
  CHECK(names_in(labels_of_json(
            R"({"labels": {"background": 0, "all": [1, 2], "liver": 2}, "file_ending": ".nii"})")) == "2=liver");
  CHECK(names_in(labels_of_json(R"([{"id": 3, "name": "vein", "color": "#FF8000"}])")) == "3=vein#ff8000");
  // A sidecar of an image is about something else.
  CHECK(names_in(labels_of_json(R"({"EchoTime": 0.002, "SeriesNumber": 3, "Manufacturer": "x"})")).empty());
  CHECK(names_in(labels_of_json("[1, 2]")).empty());
  CHECK(says(labels_of_json(R"({"spleen": 1, "liver": 1})"), "two names (liver and spleen)"));
  CHECK(says(labels_of_json("{"), "is no JSON"));
  CHECK(says(labels_of_json(R"({"1": "spleen", "2": "vein", "1": "liver"})"), "has the key \"1\" twice"));
  CHECK(says(labels_of_json(R"({"labels": {"spleen": 1, "spleen": 2}})"), "has the key \"spleen\" twice"));
  CHECK(says(labels_of_json(R"([{"id": 3, "name": "vein", "name": "liver"}])"), "has the key \"name\" twice"));
  CHECK(names_in(labels_of_json(R"({"EchoTime": 0.002, "EchoTime": 0.003})")).empty());
  CHECK(with_file_beside("a_seg.json", R"({"1": "spleen", "1": "liver"})").warnings.size() == 1);
  CHECK(with_file_beside("a_seg.json", R"({"1": "spleen", "1": "liver"})").segmentation.segments.empty());
}

TEST_CASE("names of labels are read from the tables of ITK-SNAP and FreeSurfer and 3D Slicer") {
  CHECK(names_in(labels_of_lines("################\n# ITK-SnAP Label Description File\n# File format:\n"
                                 "# IDX   -R-  -G-  -B-  -A--  VIS MSH  LABEL\n################\n"
                                 "    0     0    0    0        0  0  0    \"Clear Label\"\n"
                                 "    1   255    0    0        1  1  1    \"Left kidney\"\n"
                                 "    2     0  255    0     0.50  1  1    \"Tumour 2\"\n")) ==
        "1=Left kidney#ff0000 2=Tumour 2#00ff00");
  CHECK(names_in(labels_of_lines("#$Id: FreeSurferColorLUT.txt $\n\n#No. Label Name:   R   G   B   A\n\n"
                                 "0   Unknown                                 0   0   0   0\n"
                                 "4   Left-Lateral-Ventricle                  120 18  134 0\r\n")) ==
        "4=Left-Lateral-Ventricle#781286");
  CHECK(names_in(labels_of_lines("# Color table file /tmp/a.ctbl\n# 2 values\n0 background 0 0 0 0\n"
                                 "1 left kidney 185 102 83 255\n")) == "1=left kidney#b96653");
  CHECK(names_in(labels_of_lines("1 spleen\n2 vertebrae L5\n")) == "1=spleen 2=vertebrae L5");
  CHECK(names_in(labels_of_lines("Scanned on 3 May.\nLeft knee.\n")).empty());
  CHECK(says(labels_of_lines("1 spleen\nliver\n"), "line 2 has no number and name"));
  CHECK(says(labels_of_lines("1 spleen\n1 liver\n"), "line 2 gives label 1 two names"));
}

TEST_CASE("names of labels are read from tables by the names of their columns") {
  CHECK(names_in(labels_of_table("name,value\nspleen,1\n\"left, kidney\",2\n")) == "1=spleen 2=left, kidney");
  CHECK(names_in(labels_of_table("index\tname\tcolor\n1\tspleen\t#00FF00\n")) == "1=spleen#00ff00");
  CHECK(names_in(labels_of_table("LabelValue;Name;Color_R;Color_G;Color_B;Color_A\n7;vein;0;151;206;255\n")) ==
        "7=vein#0097ce");
  CHECK(names_in(labels_of_table("1,spleen\n2,liver\n")) == "1=spleen 2=liver");
  CHECK(names_in(labels_of_table("spleen,1\nliver,2\n")) == "1=spleen 2=liver");
  CHECK(names_in(labels_of_table("subject,age\na,40\n")).empty());
  CHECK(says(labels_of_table("name,value\nspleen,x\n"), "line 2"));
}

TEST_CASE("names stand in the extension of a NIfTI header as TotalSegmentator writes them") {
  const TemporaryFolder folder;
  REQUIRE(write_volume(two_labels(), folder.path / "a.nii"));
  const std::string bytes = test::must(read_whole_file(folder.path / "a.nii"));
  const auto read_as = [&](int code, const std::string& content) {
    write_bytes(folder.path / "b.nii", with_extension(bytes, code, content));
    const auto read = read_volume(folder.path / "b.nii");
    REQUIRE_MESSAGE(read, read.error().sentence());
    CHECK(read->volume.data == two_labels().data);
    return names_in(read->segmentation);
  };
  CHECK(read_as(0, caret_table) == "1=spleen#00ff00 2=kidney & right#0000ff");
  CHECK(read_as(30, caret_table) == "1=spleen#00ff00 2=kidney & right#0000ff");
  CHECK(read_as(6, R"({"1": "spleen"})") == "1=spleen");
  CHECK(read_as(6, "a comment").empty());
  CHECK(read_as(0, "<Label Key=\"1\"").empty());
  // An extension that claims more than there is.
  std::string claims = with_extension(bytes, 0, caret_table);
  const std::int32_t huge = 0x7ffffff0;
  std::memcpy(claims.data() + 352, &huge, 4);
  write_bytes(folder.path / "b.nii", claims);
  CHECK(read_volume(folder.path / "b.nii"));
}

TEST_CASE("names stand in a file beside a label map and not beside an image") {
  CHECK(names_in(with_file_beside("a_seg.json", R"({"1": "spleen"})").segmentation) == "1=spleen");
  CHECK(names_in(with_file_beside("a_seg.csv", "1,spleen\n").segmentation) == "1=spleen");
  CHECK(names_in(with_file_beside("a_seg.label", "1 255 0 0 1 1 1 \"s\"\n").segmentation) == "1=s#ff0000");
  for (const char* file : {"a_seg.ctbl", "a_seg.ctab", "labels.ctab"})
    CHECK(names_in(with_file_beside(file, "1 s 255 0 0 0\n").segmentation) == "1=s#ff0000");
  CHECK(names_in(with_file_beside("dataset.json", R"({"labels": {"spleen": 1}})").segmentation) == "1=spleen");
  CHECK(with_file_beside("b_seg.json", R"({"1": "spleen"})").segmentation.segments.empty());
  const VolumeRead bad = with_file_beside("a_seg.json", R"({"spleen": 1, "liver": 1})");
  REQUIRE(bad.warnings.size() == 1);
  CHECK(bad.warnings.front().find("a_seg.json: gives label 1 two names (liver and spleen)") != std::string::npos);
  const auto asked = asked_segments("spleen", bad.segmentation);
  CHECK(says(asked, "a_seg.json gives label 1 two names"));
  CHECK(says(asked, "spleen cannot be found; correct that file"));
  Volume image = two_labels();
  image.data = std::vector<std::int16_t>{-1000, 40, 60, 20, 70, 3};
  image.range_min = -1000;
  CHECK(with_file_beside("a_seg.json", R"({"SeriesNumber": 3})", image).segmentation.segments.empty());
}

TEST_CASE("a header that is read without its voxels takes no names from a file beside it") {
  const TemporaryFolder folder;
  VolumeReadOptions header_alone;
  header_alone.without_voxels = true;
  write_bytes(folder.path / "a.json", R"({"1": "spleen"})");
  for (const char* name : {"a.nii.gz", "a.nrrd", "a.mha"}) {
    CAPTURE(std::string(name));
    REQUIRE(write_volume(two_labels(), folder.path / name));
    const auto read = read_volume(folder.path / name, header_alone);
    REQUIRE_MESSAGE(read, read.error().sentence());
    CHECK(read->volume.geometry.dims == two_labels().geometry.dims);
    CHECK(read->segmentation.segments.empty());
    CHECK(read->warnings.empty());
    CHECK(names_in(test::must(read_volume(folder.path / name)).segmentation) == "1=spleen");
  }
}

TEST_CASE("a map of real numbers is written with the extents of its rounded labels") {
  const TemporaryFolder folder;
  VolumeRead map;
  map.volume = two_labels();
  std::vector<float> voxels(map.volume.geometry.voxels(), 0);
  voxels[0] = std::numeric_limits<float>::quiet_NaN();
  voxels[1] = 0.9F;
  voxels[2] = 0.2F;
  map.volume.data = voxels;
  map.segmentation.add({.name = "spleen", .value = 1});
  REQUIRE(write_segmentation(map, folder.path / "a.seg.nrrd"));
  const std::string text = test::must(read_whole_file(folder.path / "a.seg.nrrd"));
  CHECK(text.find("Segment0_Extent:=1 1 0 0 0 0") != std::string::npos);
}

TEST_CASE("where the names of a label map cannot be written the map stays as it was, and the other way") {
  const TemporaryFolder folder;
  const fs::path file = folder.path / "a.nii", names = folder.path / "a.json";
  VolumeRead map;
  map.volume = two_labels();
  map.segmentation.add({.name = "spleen", .value = 1});
  REQUIRE(write_segmentation(map, file));
  const std::string first = test::must(read_whole_file(file)), first_names = test::must(read_whole_file(names));
  map.volume.data = std::vector<std::uint8_t>{2, 2, 2, 1, 1, 0};
  map.segmentation = {};
  map.segmentation.add({.name = "liver", .value = 1});
  fs::permissions(names, fs::perms::owner_read);
  CHECK(says(write_segmentation(map, file), "a.json: is write-protected"));
  CHECK(test::must(read_whole_file(file)) == first);
  fs::permissions(names, fs::perms::owner_read | fs::perms::owner_write);
  fs::permissions(file, fs::perms::owner_read);
  CHECK(says(write_segmentation(map, file), "a.nii: is write-protected"));
  CHECK(test::must(read_whole_file(names)) == first_names);
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
  REQUIRE(write_segmentation(map, file));
  CHECK(test::must(read_volume(file)).segmentation.find(1)->name == "liver");
}

TEST_CASE("a label map is written with names and colours and layers and read again") {
  const TemporaryFolder folder;
  VolumeRead map;
  map.volume = two_labels();
  map.segmentation.add({.name = "back\\slash", .value = 1, .layer = 0, .colour = {{255, 0, 51}}, .terminology = "a~b"});
  const auto again = [&](const char* name) {
    REQUIRE(write_segmentation(map, folder.path / name));
    auto read = read_volume(folder.path / name);
    REQUIRE_MESSAGE(read, read.error().sentence());
    return *read;
  };
  for (const char* name : {"a.nii.gz", "a.mha", "b.seg.nrrd"}) {
    CAPTURE(std::string(name));
    const VolumeRead read = again(name);
    CHECK(read.volume.data == map.volume.data);
    CHECK(read.segmentation.find(1)->name == "back\\slash");
    CHECK(read.segmentation.find(1)->colour == std::array<std::uint8_t, 3>{255, 0, 51});
  }
  CHECK(again("b.seg.nrrd").segmentation.find(1)->terminology == "a~b");
  CHECK(again("b.seg.nrrd").segmentation.find(2)->name == "Label 2");
  write_bytes(folder.path / "c.json", R"({"EchoTime": 0.1})");
  CHECK(says(write_segmentation(map, folder.path / "c.nii"), "something else"));

  map.other_layers.push_back(two_labels());
  map.segmentation.add({.name = "other", .value = 1, .layer = 1});
  CHECK(says(write_segmentation(map, folder.path / "d.nii"), "2 layers"));
  const VolumeRead layered = again("d.seg.nrrd");
  REQUIRE(layered.other_layers.size() == 1);
  CHECK(layered.other_layers.front().data == two_labels().data);
  CHECK(layered.segmentation.find(1, 1)->name == "other");
  const std::string text = test::must(read_whole_file(folder.path / "d.seg.nrrd"));
  CHECK(text.find("Segment0_Extent:=1 2 0 0 0 0") != std::string::npos);
}
