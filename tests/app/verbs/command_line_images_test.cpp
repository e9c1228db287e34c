#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>

#include "core/mesh/mesh_io.h"
#include "core/volume/volume_io.h"
#include "tests/ball_folder.h"
#include "tests/case_folder.h"
#include "tests/command_line.h"
#include "tests/core/volume/structure_set_file.h"
#include "tests/real_data.h"
#include "tests/tiff_bytes.h"

// Images through the program: a refusal is one line and exit 1, whatever the file.
using namespace homolog;

namespace {

/// `info` and `convert` of a file, ended after 30 s; a crash or a time-out is no refusal.
void check_image_refused(const TemporaryFolder& folder, const fs::path& file) {
  CAPTURE(file.string());
  const std::string program = "'" HOMOLOG_PROGRAM "'";
  for (const std::string& verb : {"info '" + file.string() + "' --spacing 1,1,1 --json",
                                  "convert '" + file.string() + "' out.nrrd --spacing 1,1,1"}) {
    CAPTURE(verb);
    const Ran ran = run(folder, "--version >/dev/null && timeout 30 " + program + " " + verb);
    check_refused(ran, file.filename().string());
    CHECK(!fs::exists(folder.path / "out.nrrd"));
  }
}

}  // namespace

TEST_CASE("the program refuses hostile image files in one line and does not take the memory they claim") {
  const fs::path data = real_data();
  if (data.empty()) return;
  const TemporaryFolder folder;
  for (const auto& entry : fs::directory_iterator(data / "hostile")) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("dicom_") || name.starts_with("nrrd_") || name.starts_with("tiff_"))
      check_image_refused(folder, entry.path());
  }
  rusage children{};
  ::getrusage(RUSAGE_CHILDREN, &children);
  CHECK(children.ru_maxrss < 800 * 1024);  // kB
}

TEST_CASE("the program refuses damaged and mislabelled images that are made here") {
  const TemporaryFolder folder;
  const auto check = [&](const std::string& name, const std::string& bytes) {
    write_bytes(folder.path / name, bytes);
    check_image_refused(folder, folder.path / name);
  };
  TiffBytes tiff;
  tiff.pages = {{"abcdefgh"}, {"ijklmnop"}};
  const std::string whole = tiff.bytes();
  check("cut.tif", whole.substr(0, whole.size() - 1));
  check("cut pages.tif", whole.substr(0, whole.size() / 2 + 20));
  check("jpeg.tif", "\xff\xd8\xff\xe0" + std::string(100, 'x'));
  check("upper.PNG", "\x89PNG\r\n\x1a\n" + std::string(100, 'x'));
  check("format.nhdr",
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 4\nencoding: raw\ndata file: %3000d.raw 1 4 1\n");
  REQUIRE(::mkfifo((folder.path / "pipe.nii").c_str(), 0600) == 0);
  check_image_refused(folder, folder.path / "pipe.nii");
}

namespace {

/// A segmentation as 3D Slicer saves it: a cube of 6 mm in each of two layers, the second 4 mm to the left of the first
/// and over it.
void put_layers(const fs::path& file, char first, char second, const std::string& names = "") {
  constexpr int n = 16;
  std::string voxels;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        for (const int layer : {0, 1}) {
          const int from = 4 + 4 * layer;
          const bool within = i >= from && i < from + 6 && j >= 4 && j < 10 && k >= 4 && k < 10;
          voxels += !within ? '\0' : layer == 0 ? first : second;
        }
  const std::string header =
      "NRRD0004\n# Complete NRRD file format specification at:\n# http://teem.sourceforge.net/nrrd/format.html\n"
      "type: unsigned char\ndimension: 4\nspace: left-posterior-superior\nsizes: 2 16 16 16\n"
      "space directions: none (1,0,0) (0,1,0) (0,0,1)\nkinds: list domain domain domain\nencoding: raw\n"
      "space origin: (0,0,0)\nSegment0_ID:=Segment_1\nSegment0_LabelValue:=" +
      std::to_string(first) +
      "\nSegment0_Layer:=0\n"
      "Segment1_ID:=Segment_2\nSegment1_LabelValue:=" +
      std::to_string(second) + "\nSegment1_Layer:=1\n" + names +
      "Segmentation_ContainedRepresentationNames:=Binary labelmap|\n\n";
  write_bytes(file, header + voxels);
}

}  // namespace

TEST_CASE("verbs find a label in any layer of a segmentation and say that there are layers") {
  const TemporaryFolder folder;
  put_layers(folder.path / "two.seg.nrrd", 1, 2);
  put_layers(folder.path / "same.seg.nrrd", 1, 1);
  const Ran info = run(folder, "info two.seg.nrrd --json");
  CHECK(info.status == 0);
  CHECK(info.json()["layers"] == 2);
  CHECK(info.json()["frames"] == 1);
  CHECK(info.errors.find("2 layers, not frames") != std::string::npos);
  for (const int label : {1, 2}) {
    const Ran made = run(folder, "template two.seg.nrrd --vertices 300 -o t.ply --label " + std::to_string(label));
    INFO(made.errors);
    REQUIRE(made.status == 0);
    CHECK(made.errors.find("2 layers") != std::string::npos);
    const auto mesh = read_mesh(folder.path / "t.ply");
    REQUIRE(mesh);
    CHECK(mesh->points.col(0).mean() == doctest::Approx(label == 1 ? 6.5 : 10.5).epsilon(0.05));
  }
  const Ran both = run(folder, "template two.seg.nrrd --vertices 300 -o t.ply --label 1,2");
  CHECK(both.status == 0);
  CHECK(read_mesh(folder.path / "t.ply")->points.col(0).mean() == doctest::Approx(8.5).epsilon(0.05));
  check_refused(run(folder, "template two.seg.nrrd --vertices 300 -o u.ply"), "label 2 in layer 1");
  check_refused(run(folder, "template two.seg.nrrd --vertices 300 -o u.ply --label 3"), "label 3");
  check_refused(run(folder, "template same.seg.nrrd --vertices 300 -o u.ply --label 1"), "label 1 in layers 0 and 1");
  check_refused(run(folder, "template same.seg.nrrd --vertices 300 -o u.ply"), "label 1 in layers 0 and 1");
  check_refused(run(folder, "convert two.seg.nrrd u.nii"), "2 layers");
  CHECK(!fs::exists(folder.path / "u.nii"));
  CHECK(run(folder, "info t.ply --mask two.seg.nrrd --label 2").status == 0);
}

TEST_CASE("a label has its name in the report and is taken by it") {
  const TemporaryFolder folder;
  put_layers(folder.path / "named.seg.nrrd", 1, 1,
             "Segment0_Name:=Left Kidney\nSegment0_Color:=1 0 0\nSegment1_Name:=tumour\n");
  const Json labels = run(folder, "info named.seg.nrrd --json").json()["labels"];
  REQUIRE(labels.size() == 2);
  CHECK(labels[0]["name"] == "Left Kidney");
  CHECK(labels[0]["colour"] == "#ff0000");
  CHECK(labels[1]["name"] == "tumour");
  CHECK(labels[1]["value"] == 1);
  CHECK(labels[1]["layer"] == 1);
  const Ran made = run(folder, "template named.seg.nrrd --vertices 300 -o t.ply --label 'left kidney'");
  INFO(made.errors);
  REQUIRE(made.status == 0);
  CHECK(read_mesh(folder.path / "t.ply")->points.col(0).mean() == doctest::Approx(6.5).epsilon(0.05));
  CHECK(run(folder, "compare t.ply --mask named.seg.nrrd --label TUMOUR --json").json()["dice"] < 0.9);
  CHECK(run(folder, "template named.seg.nrrd --vertices 300 -o t.ply --label 'left kidney,tumour'").status == 0);
  CHECK(read_mesh(folder.path / "t.ply")->points.col(0).mean() == doctest::Approx(8.5).epsilon(0.05));
  check_refused(run(folder, "template named.seg.nrrd -o u.ply --label tumor"),
                "the nearest names in it are \"tumour\"");
}

TEST_CASE("every verb that takes a label map says that its values are no whole numbers") {
  const TemporaryFolder folder;
  Volume soft;
  soft.geometry.dims = {16, 16, 16};
  std::vector<float> voxels;
  for (int v = 0; v < 16 * 16 * 16; ++v) {
    const int i = v % 16, j = v / 16 % 16, k = v / 256;
    const bool within = i >= 4 && i < 12 && j >= 4 && j < 12 && k >= 4 && k < 12;
    voxels.push_back(within ? 1.9882f : 0.0f);
  }
  soft.data = voxels;
  REQUIRE(write_volume(soft, folder.path / "soft.nii"));
  for (const char* verb :
       {"template soft.nii --vertices 300 -o t.ply", "compare t.ply --mask soft.nii", "info t.ply --mask soft.nii",
        "fit t.ply --mask soft.nii -o f.ply", "study user t.ply --mask soft.nii -o c.homolog --pulls 1"}) {
    CAPTURE(std::string(verb));
    const Ran ran = run(folder, verb);
    INFO(ran.errors);
    CHECK(ran.status == 0);
    CHECK(ran.errors.find("soft.nii: holds values that are no whole numbers, as 1.988") != std::string::npos);
  }
}

TEST_CASE("a soft mask is a surface at its level for the verbs that take a mask") {
  const BallFolder folder;
  const auto put = [&](const char* name, auto top) {
    Volume mask;
    mask.geometry = folder.grid;
    std::vector<decltype(top)> values;
    for (int k = 0; k < 30; ++k)
      for (int j = 0; j < 30; ++j)
        for (int i = 0; i < 30; ++i) {
          const double share = std::clamp(0.5 + (20 - folder.grid.to_mm(Vec3(i, j, k)).norm()) / 3, 0.0, 1.0);
          values.push_back(static_cast<decltype(top)>(top * share));
        }
    mask.data = std::move(values);
    REQUIRE(write_volume(mask, folder.path / name));
  };
  put("soft.nii.gz", 1.0F);
  put("grey.nii.gz", std::uint8_t{255});
  const Json by_voxels = run(folder, "compare ball.ply --mask good.nii.gz --json").json();
  CHECK(!by_voxels.contains("soft"));
  for (const char* arguments : {"compare ball.ply --mask soft.nii.gz", "compare ball.ply --mask soft.nii.gz --label 1",
                                "compare ball.ply --mask grey.nii.gz --level 127.5"}) {
    CAPTURE(arguments);
    const Ran ran = run(folder, std::string(arguments) + " --json");
    REQUIRE(ran.status == 0);
    CHECK(ran.errors.empty());
    CHECK(ran.json()["soft"] == true);
    CHECK(ran.json()["level"].get<double>() > 0);
    CHECK(ran.json()["assd_mm"].get<double>() < 0.5 * by_voxels["assd_mm"].get<double>());
  }
  const Json fitted = run(folder, "fit ball.ply --mask soft.nii.gz -o fitted.ply --json").json();
  CHECK(fitted["soft"] == true);
  CHECK(fitted["level"] == 0.5);
  CHECK(fitted["assd_mm"].get<double>() < 0.2);
  const Json higher = run(folder, "template soft.nii.gz --vertices 500 --level 0.8 -o t.ply --json").json();
  CHECK(higher["level"] == 0.8);
  CHECK(higher["volume_ml"] < run(folder, "info ball.ply --json").json()["volume_ml"]);
  CHECK(run(folder, "info ball.ply --mask soft.nii.gz --json").json()["soft"] == true);
  check_refused(run(folder, "compare ball.ply --mask soft.nii.gz --label 2"), "label 2 does not occur");
  check_refused(run(folder, "compare ball.ply --mask grey.nii.gz --level 0.5"), "above 1 for those from 0 to 255");
  check_refused(run(folder, "compare ball.ply --mask grey.nii.gz"), "holds several labels");
  CHECK(run(folder, "template good.nii.gz --tube --level 0.5 -o out.ply").status == 2);
}

TEST_CASE("all structures of a case become a label map and a DICOM segmentation of a series") {
  const CaseFolder made;
  made.create();
  made.append(
      R"({"structure":{"id":"s2","name":"other","template":"ball.ply","placement":{"rotation":[1,0,0,0],"scale":1,"translation":[60,0,0]}}})"
      "\n");
  const TemporaryFolder& folder = made.folder;
  Volume image;
  image.geometry.dims = {40, 20, 20};
  image.geometry.spacing_mm = Vec3::Constant(5);
  image.geometry.origin_mm = Vec3::Constant(-50);
  image.data = std::vector<std::uint8_t>(image.geometry.voxels());
  REQUIRE(write_volume(image, folder.path / "image.nii.gz"));
  const Ran all = run(folder, "label-map ball.homolog --like image.nii.gz -o map.seg.nrrd --json");
  REQUIRE_MESSAGE(all.status == 0, all.errors);
  const auto map = read_volume(folder.path / "map.seg.nrrd");
  REQUIRE(map);
  REQUIRE(map->segmentation.segments.size() == 2);
  CHECK(map->segmentation.find(1)->name == "ball");
  CHECK(map->segmentation.find(2)->name == "other");
  const auto voxels = labels_of(map->volume);
  const double ball_voxels = 4.0 / 3 * 3.14159 * 8 * 8 * 8;
  CHECK(static_cast<double>(voxels.at(1)) == doctest::Approx(ball_voxels).epsilon(0.03));
  REQUIRE(map->other_layers.size() == 1);  // both keep what both hold
  const std::size_t other_voxels = labels_of(map->other_layers.front()).at(2);
  CHECK(static_cast<double>(other_voxels) == doctest::Approx(ball_voxels).epsilon(0.03));
  CHECK(all.json()["structures"][1]["voxels"] == other_voxels);
  CHECK(all.errors.find("voxels that two of them hold belong to both, in layers") != std::string::npos);
  const Ran flat = run(folder, "label-map ball.homolog --like image.nii.gz -o map.nii.gz --json");
  REQUIRE_MESSAGE(flat.status == 0, flat.errors);
  const auto one_layer = read_volume(folder.path / "map.nii.gz");
  REQUIRE(one_layer);
  CHECK(labels_of(one_layer->volume).at(1) == voxels.at(1));
  CHECK(labels_of(one_layer->volume).at(2) < other_voxels);  // what both hold went to the first
  CHECK(flat.errors.find("voxels that two of them hold went to the first") != std::string::npos);
  check_refused(run(folder, "label-map ball.homolog --like image.nii.gz -o x.nrrd --value 3"), "--value has no effect");

  Slice slice;
  slice.put(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2");
  slice.put(0x0020000d, "UI", "1.2.1");
  slice.put(0x00200052, "UI", "1.2.9");
  fs::create_directory(folder.path / "ct");
  for (int k = 0; k < 4; ++k) {
    slice.z = 2.5 * k;
    slice.put(0x00080018, "UI", "1.2.3." + std::to_string(k));
    write_bytes(folder.path / "ct" / (std::to_string(k) + ".dcm"), slice.bytes());
  }
  const Ran dicom = run(folder, "label-map ball.homolog --like ct -o case.dcm");
  REQUIRE_MESSAGE(dicom.status == 0, dicom.errors);
  CHECK(dicom.errors.find("its structure other lies outside of ct") != std::string::npos);
  const auto read = read_volume(folder.path / "case.dcm");
  REQUIRE(read);
  REQUIRE(read->segmentation.segments.size() == 1);
  CHECK(read->segmentation.find(1)->name == "ball");
  CHECK(labels_of(read->volume).at(1) == 3 * 2 * 4);
  CHECK(read->referenced.series == std::vector<std::string>{"1.2.3"});
  CHECK(read->referenced.instances.size() == 8);  // of the series, and of each frame

  // A case beside its slices names its own folder: nothing is read without end.
  const std::string lines = read_whole_file(folder.path / "ball.homolog").value();
  Json header = Json::parse(lines.substr(0, lines.find('\n')));
  header["volume"] = ".";
  header["template"] = "../" + header["template"].get<std::string>();
  write_bytes(folder.path / "ct/own.homolog", header.dump() + lines.substr(lines.find('\n')));
  for (const char* command : {"measure ct/own.homolog --csv own.csv", "replay ct/own.homolog -o own.ply",
                              "label-map ct/own.homolog --like ct -o own.dcm"}) {
    const Ran beside = run(folder, command);
    REQUIRE_MESSAGE(beside.status == 0, command << ": " << beside.errors);
  }
  CHECK(read_volume(folder.path / "own.dcm")->volume.data == read->volume.data);

  // A mesh names its segment by its file without what says the format.
  REQUIRE(write_mesh(icosphere(3, 40), folder.path / "left.surf.gii"));
  const Ran of_mesh = run(folder, "label-map left.surf.gii --like ct -o left.dcm");
  REQUIRE_MESSAGE(of_mesh.status == 0, of_mesh.errors);
  const auto left = read_volume(folder.path / "left.dcm");
  REQUIRE(left);
  REQUIRE(left->segmentation.find(1) != nullptr);
  CHECK(left->segmentation.find(1)->name == "left");
}

TEST_CASE("--resample is refused where there are no DICOM slices") {
  const TemporaryFolder folder;
  Volume image;
  image.geometry.dims = {2, 2, 2};
  image.data = std::vector<std::uint8_t>(8);
  REQUIRE(write_volume(image, folder.path / "image.nii.gz"));
  check_refused(run(folder, "convert image.nii.gz out.nrrd --resample"), "--resample has no effect");
  check_refused(run(folder, "info image.nii.gz --resample"), "--resample has no effect");
}

TEST_CASE("contours in a folder of several series become a label map on the one that they were drawn on") {
  const TemporaryFolder folder;
  fs::create_directories(folder.path / "study/thick");
  fs::create_directories(folder.path / "flat");
  Slice slice;
  slice.put(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2");
  slice.put(0x0020000d, "UI", "1.2.1");
  slice.put(0x00200052, "UI", "1.2.9");
  for (const char* series : {"1.2.3", "1.2.4"})
    for (int k = 0; k < 3; ++k) {
      slice.series = series;
      slice.z = (series == std::string("1.2.3") ? 2.5 : 5) * k;
      slice.put(0x00080018, "UI", series + ("." + std::to_string(k)));
      const std::string name = series + ("-" + std::to_string(k) + ".dcm");
      write_bytes(folder.path / "flat" / name, slice.bytes());
      if (series == std::string("1.2.4")) write_bytes(folder.path / "study/thick" / name, slice.bytes());
    }
  RtFile file;
  file.series = "1.2.4";
  file.drawn = {{1, "CLOSED_PLANAR", "-1\\-1\\5\\1\\-1\\5\\1\\1\\5\\-1\\1\\5"}};
  write_bytes(folder.path / "rt.dcm", file.bytes());
  const auto slices_mm = [&](const std::string& how) {
    const Ran ran = run(folder, "convert rt.dcm o.seg.nrrd --json --like " + how);
    REQUIRE_MESSAGE(ran.status == 0, ran.errors);
    return ran.json()["spacing_mm"][2].get<double>();
  };
  CHECK(slices_mm("flat") == 5);
  CHECK(slices_mm("study") == 5);
  CHECK(slices_mm("flat --series 1.2.3") == 2.5);
  REQUIRE(run(folder, "convert rt.dcm o.dcm --like flat").status == 0);
  CHECK(read_volume(folder.path / "o.dcm")->referenced.series == std::vector<std::string>{"1.2.4"});
  // Written as a segmentation it finds its series too, and a verb without --series offers none.
  CHECK(run(folder, "convert o.dcm again.seg.nrrd --like flat").status == 0);
  REQUIRE(run(folder, "convert built-in:kidney k.ply").status == 0);
  check_refused(run(folder, "label-map k.ply --like flat -o o.nii.gz"),
                "copy the files of one to a folder of their own");
  check_refused(run(folder, "convert rt.dcm o.seg.nrrd --series 1.2.3"), "--series has no effect");
}

TEST_CASE("an empty mask of a folder is listed with 0 voxels and named as empty") {
  const TemporaryFolder folder;
  fs::create_directory(folder.path / "masks");
  Volume mask;
  mask.geometry.dims = {4, 4, 4};
  mask.data = std::vector<std::uint8_t>(64);
  REQUIRE(write_volume(mask, folder.path / "masks/kidney_left.nii.gz"));
  std::vector<std::uint8_t> filled(64);
  filled[21] = filled[22] = 1;
  mask.data = filled;
  mask.range_max = 1;
  REQUIRE(write_volume(mask, folder.path / "masks/liver.nii.gz"));
  filled = std::vector<std::uint8_t>(64);
  filled[42] = 1;
  mask.data = filled;
  REQUIRE(write_volume(mask, folder.path / "masks/spleen.nii.gz"));
  const Json labels = run(folder, "info masks --json").json()["labels"];
  REQUIRE(labels.size() == 3);
  CHECK(labels[2]["name"] == "kidney_left");
  CHECK(labels[2]["value"] == 1);
  CHECK(labels[2]["voxels"] == 0);
  check_refused(run(folder, "template masks -o t.ply --label kidney_left"),
                "label 1 does not occur in the label map; it holds 2 (liver) and 3 (spleen); kidney_left is empty");
  check_refused(run(folder, "template masks -o t.ply"), "; kidney_left is empty");
  // Names alone, as a table gives them, are no structures of the file.
  REQUIRE(write_volume(mask, folder.path / "map.nii.gz"));
  REQUIRE(write_whole_file(folder.path / "map.json", R"({"1": "spleen", "2": "liver"})"));
  CHECK(run(folder, "info map.nii.gz --json").json()["labels"].size() == 1);
}
