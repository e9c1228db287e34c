#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <fstream>
#include <limits>
#include <set>

#include "core/volume/labels/map_on_grid.h"
#include "core/volume/labels/read_labels.h"
#include "core/volume/labels/write_segmentation.h"
#include "core/volume/volume_io.h"
#include "core/volume/voxel_stream.h"
#include "core/volume/write_voxels.h"
#include "tests/must.h"
#include "tests/real_data.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

// Files that other programs wrote.
namespace fs = std::filesystem;
using namespace homolog;

namespace {

VolumeRead read(const fs::path& path) {
  auto result = read_volume(path);
  INFO(path.string());
  if (!result) FAIL(result.error().sentence());
  return std::move(*result);
}

/// Equal in voxels, place and frames.
void check_same(const fs::path& a, const fs::path& b) {
  CAPTURE(a.string());
  CAPTURE(b.string());
  const Volume first = read(a).volume, second = read(b).volume;
  CHECK(first.data == second.data);
  CHECK(first.geometry.dims == second.geometry.dims);
  CHECK(same_grid(first.geometry, second.geometry));
  CHECK(first.frames == second.frames);
  CHECK(first.range_min == second.range_min);
  CHECK(first.range_max == second.range_max);
}

struct Expected {
  const char* file;
  const char* type;
  std::array<int, 3> dims;
  int frames;
  Vec3 spacing_mm, origin_mm;
};

void check_expected(const fs::path& folder, const Expected& expected) {
  CAPTURE(std::string(expected.file));
  const Volume volume = read(folder / expected.file).volume;
  CHECK(std::string(voxel_type_name(volume.data)) == expected.type);
  CHECK(volume.geometry.dims == expected.dims);
  CHECK(volume.frames == expected.frames);
  CHECK((volume.geometry.spacing_mm - expected.spacing_mm).norm() < 1e-4);
  CHECK((volume.geometry.origin_mm - expected.origin_mm).norm() < 1e-3);
  CHECK(volume.range_max > volume.range_min);
}

bool refused(const fs::path& path, const std::string& what) {
  const auto result = read_volume(path);
  if (result) return false;
  INFO(result.error().sentence());
  return result.error().sentence().find(what) != std::string::npos &&
         result.error().sentence().find(path.filename().string()) != std::string::npos;
}

std::set<fs::path> files_in(const fs::path& folder) {
  std::set<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file()) files.insert(entry.path());
  return files;
}

}  // namespace

TEST_CASE("NIfTI files of other programs are read with their place") {
  const fs::path data = real_data();
  if (data.empty()) return;
  const fs::path folder = data / "formats/nifti";
  for (const Expected& expected : {
           Expected{"air.hdr.gz", "float32", {79, 67, 64}, 1, {2.38975, 2.36649, 2.38523}, {75.7625, 110.763, 84.4256}},
           Expected{"avg152T1_LR_nifti2.nii.gz", "float32", {91, 109, 91}, 1, {2, 2, 2}, {-90, 126, -72}},
           Expected{"big.nii.gz", "float32", {64, 64, 21}, 1, {4, 4, 6}, {0, 0, 0}},
           Expected{"nibabel_anatomical.nii", "int16", {33, 41, 25}, 1, {2, 2, 2}, {-32, 40, -16}},
           Expected{"nibabel_example4d.nii.gz", "int16", {128, 96, 24}, 2, {2, 2, 2.2}, {-117.855, 35.7229, -7.2488}},
           Expected{"nibabel_functional.nii", "float32", {17, 21, 3}, 20, {4, 4, 8}, {-32, 40, 0}},
           Expected{"nibabel_standard.nii.gz", "uint8", {4, 5, 7}, 1, {1, 3, 2}, {0, 0, 0}},
           Expected{"vtkdata_minimal_bigendian_noqs.nii.gz", "uint8", {64, 64, 10}, 1, {3, 3, 3}, {0, 0, 0}},
       })
    check_expected(folder, expected);
  check_same(folder / "big.nii.gz", folder / "little.nii.gz");
  check_same(folder / "air.hdr.gz", folder / "air.img.gz");
  CHECK(read(folder / "nibabel_functional.nii").volume.frame_seconds == doctest::Approx(2));
  CHECK(read(folder / "vtkdata_minimal_bigendian_noqs.nii.gz").warnings.size() == 1);
  CHECK(refused(folder / "5D_small.nii", "four dimensions"));
}

TEST_CASE("NRRD files of other programs are read with their place") {
  const fs::path data = real_data();
  if (data.empty()) return;
  const fs::path folder = data / "formats/nrrd";
  for (const char* form : {"BallBinary30x30x30.nhdr", "BallBinary30x30x30_byteskip_minus_one.nhdr",
                           "BallBinary30x30x30_gz.nrrd", "BallBinary30x30x30_bz2.nrrd", "BallBinary30x30x30.nii.gz"}) {
    if (std::string(form).ends_with(".nii.gz")) {  // the same numbers, but RAS
      const Volume nrrd = read(folder / "BallBinary30x30x30.nrrd").volume, nifti = read(folder / form).volume;
      CHECK(nrrd.data == nifti.data);
      CHECK(same_grid(nrrd.geometry, nifti.geometry));
    } else {
      check_same(folder / "BallBinary30x30x30.nrrd", folder / form);
    }
  }
  check_expected(folder,
                 {"brain1_image.nrrd", "int16", {256, 256, 25}, 1, {0.78125, 0.78125, 6.5}, {-99.6094, 99.6094, -78}});
  check_expected(folder,
                 {"brain1_label.nrrd", "uint8", {256, 256, 25}, 1, {0.78125, 0.78125, 6.5}, {-99.6094, 99.6094, -78}});
  CHECK(same_grid(read(folder / "brain1_image.nrrd").volume.geometry,
                  read(folder / "brain1_label.nrrd").volume.geometry));
  check_expected(folder, {"beach.nrrd", "uint8", {3, 100, 100}, 1, {1, 1, 1}, {0, 0, 0}});
  check_expected(folder, {"beach.ascii.nhdr", "float32", {100, 100, 1}, 1, {1, 1, 1}, {0, 0, 0}});
}

TEST_CASE("MetaImage files of other programs are read with their place") {
  const fs::path data = real_data();
  if (data.empty()) return;
  const fs::path folder = data / "formats/metaimage";
  for (const Expected& expected : {
           Expected{"3DCT_lung_baseline_mask.mha",
                    "uint8",
                    {115, 157, 129},
                    1,
                    {1.366, 1.366, 2.5},
                    {-153.827, -150.352, -1434.5}},
           Expected{"3DCT_lung_baseline_small.mha",
                    "int16",
                    {57, 78, 64},
                    1,
                    {2.732, 2.732, 5},
                    {-152.461, -148.986, -1432}},
           Expected{"BrainProtonDensity3Slices.mha", "uint8", {181, 217, 3}, 1, {1, 1, 1}, {0, 0, 0}},
           Expected{"BrainT1SliceBorder20DirectionPlus30.mhd", "uint8", {221, 257, 1}, 1, {1, 1, 1}, {0, 0, 0}},
           Expected{"foot.mha", "uint8", {256, 256, 1}, 1, {1, 1, 1}, {0, 0, 0}},
           Expected{"frogtissue.mhd", "uint8", {500, 470, 136}, 1, {1, 1, 1.5}, {0, 0, 0}},
       })
    check_expected(folder, expected);
  const Volume raw = read(folder / "BrainProtonDensitySliceBorder20.mhd").volume;
  const Volume plus = read(folder / "BrainProtonDensitySliceBorder20DirectionPlus30.mhd").volume;
  const Volume minus = read(folder / "BrainProtonDensitySliceBorder20DirectionMinus30.mhd").volume;
  const Volume nrrd = read(data / "formats/nrrd/BrainProtonDensitySliceBorder20DirectionPlus30.nhdr").volume;
  CHECK(raw.data == plus.data);  // stored raw and compressed
  CHECK(raw.data == minus.data);
  CHECK(raw.data == nrrd.data);
  CHECK(same_grid(plus.geometry, nrrd.geometry));
  CHECK((plus.geometry.direction * minus.geometry.direction - Mat3::Identity()).norm() < 1e-6);
  CHECK(plus.geometry.direction(1, 0) == doctest::Approx(0.5));
}

TEST_CASE("DICOM files in every encoding hold the same image") {
  const fs::path data = real_data();
  if (data.empty()) return;
  const fs::path folder = data / "formats/dicom_single";
  check_same(folder / "pydicom_MR_small.dcm", folder / "pydicom_MR_small_RLE.dcm");
  check_same(folder / "pydicom_MR_small.dcm", folder / "pydicom_MR_small_bigendian.dcm");
  check_same(folder / "emri_small.dcm", folder / "emri_small_RLE.dcm");
  check_same(folder / "emri_small.dcm", folder / "emri_small_jpeg_ls_lossless.dcm");
  for (const Expected& expected : {
           Expected{"pydicom_MR_small.dcm", "int16", {64, 64, 1}, 1, {0.3125, 0.3125, 0.8}, {-83.9063, -91.2, 6.6406}},
           Expected{"pydicom_CT_small.dcm",
                    "int16",
                    {128, 128, 1},
                    1,
                    {0.661468, 0.661468, 5},
                    {-158.1358, -179.0358, -75.7}},
           Expected{"emri_small.dcm", "uint16", {64, 64, 10}, 1, {1, 1, 1.2}, {0, 0, 0}},
           Expected{
               "explicit_big.dcm", "int16", {256, 256, 1}, 1, {0.859375, 0.859375, 2}, {-110.5, -89.6063, 10.5425}},
           Expected{"implicit_little.dcm", "int16", {256, 256, 1}, 1, {0.859375, 0.859375, 6}, {-110, -109.8, -47.5}},
           Expected{"jpeg_lossless_sel1.dcm", "int16", {512, 400, 1}, 1, {1, 1, 1}, {-256, 0, 50}},
           Expected{"deflated.dcm", "uint8", {512, 512, 1}, 1, {1, 1, 1}, {0, 0, 0}},
       })
    check_expected(folder, expected);
  const Volume slice = read(folder / "pydicom_MR_small.dcm").volume;
  CHECK(slice.modality == "MR");
  CHECK(slice.file_window == std::pair(600.0, 1600.0));
  CHECK(slice.range_min == 127);
  CHECK(slice.range_max == 2145);
  CHECK(!read(folder / "explicit_big.dcm").volume.file_window);  // its window is 0 wide
  CHECK(refused(folder / "pydicom_rtstruct.dcm", "holds no image"));
}

TEST_CASE("a CT series lies on the grid of its label map") {
  const fs::path data = real_data();
  if (data.empty()) return;
  const fs::path folder = data / "formats/dicom_series";
  const Volume ct = read(folder / "totalseg_ct_20").volume,
               labels = read(folder / "totalseg_ct_20_label.nii.gz").volume;
  CHECK(ct.geometry.dims == std::array{512, 512, 20});
  CHECK(std::string(voxel_type_name(ct.data)) == "int16");
  CHECK(ct.range_min == -1024);
  CHECK(ct.modality == "CT");
  REQUIRE(ct.file_window);
  // The label map counts its rows the other way, but covers the same box.
  CHECK((ct.geometry.bounds_mm().min() - labels.geometry.bounds_mm().min()).norm() < 1e-3);
  CHECK((ct.geometry.bounds_mm().max() - labels.geometry.bounds_mm().max()).norm() < 1e-3);
  const auto labels_found = labels_of(labels);
  REQUIRE(!labels_found.empty());
  CHECK(labels_found.begin()->first > 0);
}

TEST_CASE("scans and masks and cines are read") {
  const fs::path data = real_data();
  if (data.empty()) return;
  for (const Expected& expected : {
           Expected{"ct/chaos_ct_both_kidneys.nii.gz",
                    "int16",
                    {280, 190, 52},
                    1,
                    {0.726562, 0.726562, 2},
                    {-97.8125, 72.7422, 1536.5}},
           Expected{
               "ct/totalseg_example_ct_3mm.nii.gz", "int16", {122, 101, 112}, 1, {3, 3, 3}, {177.956, -11.319, 94.302}},
           Expected{"ct/tptbox_L3_ct.nii.gz", "int16", {73, 47, 73}, 1, {1.5, 1.5, 1.5}, {78, 135, -34.2}},
           Expected{"lv_cine/sunnybrook_SC-HF-I-1_cine4d.nii.gz",
                    "int16",
                    {128, 128, 12},
                    20,
                    {1.36719, 1.36719, 9.99997},
                    {154.974, -71.4243, 8.75846}},
           Expected{"lv_cine/bivme_patient1_sax_cine4d.nii.gz",
                    "int16",
                    {145, 125, 6},
                    25,
                    {1.40625, 1.40625, 17.7},
                    {-91.0598, -95.6931, -111.065}},
       })
    check_expected(data, expected);
  CHECK(read(data / "lv_cine/sunnybrook_SC-HF-I-1_cine4d.nii.gz").volume.frame_seconds == doctest::Approx(0.0375));
  CHECK(same_grid(read(data / "ct/totalseg_example_ct_3mm.nii.gz").volume.geometry,
                  read(data / "ct/totalseg_example_ct_3mm_label.nii.gz").volume.geometry));
  CHECK(same_grid(read(data / "lv_cine/sunnybrook_SC-HF-I-1_cine4d.nii.gz").volume.geometry,
                  read(data / "lv_cine/sunnybrook_SC-HF-I-1_ED_label.nii.gz").volume.geometry));
  for (const char* mask : {"case_00000_left_healthy_thin.nii.gz", "case_00036_right_healthy_thick.nii.gz"})
    CHECK(labels_of(read(data / "kidney_masks" / mask).volume).size() == 1);
}

TEST_CASE("malformed files get a sentence or are mended with a warning") {
  const fs::path data = real_data();
  if (data.empty()) return;
  const fs::path folder = data / "formats/malformed";
  CHECK(refused(folder / "emri_small_jpeg_2k_lossless_too_short.dcm", "cut short"));
  CHECK(refused(folder / "git_lfs_pointer_named.nii.gz", "git lfs pull"));
  CHECK(refused(folder / "header_without_img_nibabel_nifti1.hdr", ".img"));
  CHECK(refused(folder / "mhd_missing_raw_labels.mhd", "labels.raw"));
  CHECK(refused(folder / "not-nifti.nii", "not a NIfTI"));
  CHECK(refused(folder / "pydicom_MR_truncated.dcm", "cut short"));
  CHECK(refused(folder / "pydicom_meta_missing_tsyntax.dcm", "transfer syntax"));
  CHECK(refused(folder / "pydicom_no_meta.dcm", "not a DICOM"));  // its first byte is missing too
  CHECK(refused(folder / "pydicom_rtplan_truncated.dcm", "cut short"));
  const VolumeRead dose = read(folder / "pydicom_badVR.dcm");
  CHECK(!dose.warnings.empty());
  CHECK(dose.volume.geometry.dims == std::array{10, 10, 15});
  CHECK(dose.volume.geometry.spacing_mm[2] == doctest::Approx(5));
}

TEST_CASE("shortened copies of good files never yield a volume with voxels missing") {
  const fs::path data = real_data();
  if (data.empty()) return;
  for (const char* kind : {"nifti", "nrrd", "metaimage", "dicom_single"}) {
    const TemporaryFolder folder;
    const auto sources = files_in(data / "formats" / kind);
    for (const fs::path& source : sources) {
      fs::copy_file(source, folder.path / source.filename());
      fs::permissions(folder.path / source.filename(), fs::perms::owner_write, fs::perm_options::add);
    }
    for (const fs::path& source : sources) {
      if (!looks_like_volume(source) && source.extension() != ".raw" && source.extension() != ".zraw") continue;
      const fs::path copy = folder.path / source.filename();
      // Volumes whose voxels lie in this file: itself, or the headers that name it.
      std::vector<fs::path> volumes;
      if (looks_like_volume(source))
        volumes.push_back(copy);
      else
        for (const fs::path& other : files_in(folder.path))
          if (other.extension() == ".mhd" || other.extension() == ".nhdr" || other.extension() == ".mha") {
            std::ifstream in(other, std::ios::binary);
            const std::string head(std::istreambuf_iterator<char>(in), {});
            if (head.find(source.filename().string()) != std::string::npos) volumes.push_back(other);
          }
      const std::uintmax_t size = fs::file_size(source);
      for (const fs::path& volume : volumes) {
        const auto whole = read_volume(volume);
        for (const double part : {0.999, 0.97, 0.6, 0.2, 0.02}) {
          CAPTURE(source.string());
          CAPTURE(part);
          fs::resize_file(copy, static_cast<std::uintmax_t>(part * static_cast<double>(size)));
          const auto shortened = read_volume(volume);
          if (shortened) {  // nothing but what follows the voxels was cut off
            REQUIRE(whole);
            CHECK(shortened->volume.data == whole->volume.data);
          }
        }
        fs::copy_file(source, copy, fs::copy_options::overwrite_existing);
        fs::permissions(copy, fs::perms::owner_write, fs::perm_options::add);
      }
    }
  }
}

namespace {

/// A file as FreeSurfer and nibabel write it: 3 × 2 × 1 voxels of 2 × 3 × 4 mm, whose axes run to the left, down and to
/// the front; the voxel at (1.5, 1, 0.5) lies at (10, 20, 30) in RAS.
std::string mgh_bytes(int type, const std::string& voxels, bool placed = true) {
  const auto big = [](std::uint32_t value, std::size_t bytes) {
    const std::string little = little_endian(value, bytes);
    return std::string(little.rbegin(), little.rend());
  };
  std::string bytes;
  for (const int number : {1, 3, 2, 1, 1, type, 0}) bytes += big(static_cast<std::uint32_t>(number), 4);
  bytes += big(placed ? 1 : 0, 2);
  for (const float number : {2.F, 3.F, 4.F, -1.F, 0.F, 0.F, 0.F, 0.F, -1.F, 0.F, 1.F, 0.F, 10.F, 20.F, 30.F})
    bytes += big(std::bit_cast<std::uint32_t>(number), 4);
  bytes.resize(284, '\0');
  return bytes + voxels;
}

}  // namespace

TEST_CASE("a NIfTI header whose sizes are smaller than its voxels is refused") {
  const TemporaryFolder folder;
  Volume volume;
  volume.geometry.dims = {4, 5, 6};
  volume.data = std::vector<std::uint8_t>(volume.geometry.voxels(), 1);
  for (const char* name : {"v.nii", "v.nii.gz"}) {
    CAPTURE(name);
    const fs::path file = folder.path / name, sheared = folder.path / (std::string("s") + name);
    REQUIRE(write_volume(volume, file));
    auto bytes = read_to_end({.file = file, .compression = compression_of(file)}, 1 << 20).value();
    bytes[44] = 4;  // dim[2] of 5
    write_bytes(sheared, bytes);
    CHECK(says(read_volume(sheared), "holds more voxels than its header says"));
    CHECK(read_volume(file));
  }
}

TEST_CASE("MGH volumes of FreeSurfer are read with the place of their header") {
  const TemporaryFolder folder;
  write_bytes(folder.path / "a.mgh", mgh_bytes(4, std::string("\0\1\1\0\0\3\xff\xff\0\5\0\6", 12)));
  const auto read = read_volume(folder.path / "a.mgh");
  REQUIRE_MESSAGE(read, read.error().sentence());
  CHECK(read->volume.data == VoxelData(std::vector<std::int16_t>{1, 256, 3, -1, 5, 6}));
  const VolumeGeometry& g = read->volume.geometry;
  CHECK(g.spacing_mm == Vec3(2, 3, 4));
  CHECK((g.to_mm(Vec3(1.5, 1, 0.5)) - Vec3(-10, -20, 30)).norm() < 1e-9);
  CHECK((g.to_mm(Vec3(0.5, 0, 0)) - Vec3(-12, -18, 33)).norm() < 1e-9);
  write_bytes(folder.path / "b.mgh", mgh_bytes(0, "abcdef", false));
  const auto unplaced = read_volume(folder.path / "b.mgh");
  REQUIRE(unplaced);
  CHECK(unplaced->volume.geometry.spacing_mm == Vec3(1, 1, 1));
  CHECK(unplaced->warnings.size() == 1);
  const auto refused = [&](const std::string& bytes, const std::string& what) {
    write_bytes(folder.path / "c.mgz", bytes);
    return says(read_volume(folder.path / "c.mgz"), what);
  };
  CHECK(refused(mgh_bytes(0, "abc"), "c.mgz"));  // cut
  CHECK(refused(mgh_bytes(2, "abcdef"), "MGH type 2"));
  CHECK(refused("no header", "is not an MGH file"));
  std::string huge = mgh_bytes(0, "abcdef");
  huge.replace(4, 12, std::string(12, '\x7f'));
  CHECK(refused(huge, "c.mgz"));
  huge.replace(4, 4, std::string(4, '\xff'));
  CHECK(refused(huge, "size of -1"));
}

TEST_CASE("an MGH header whose sizes are smaller than its voxels is seen") {
  const TemporaryFolder folder;
  const std::string scan(20, '\0');
  for (const std::string& more : {std::string(60, '\0'), std::string(60, 'x')}) {
    write_bytes(folder.path / "a.mgh", mgh_bytes(0, "abcdef") + more);
    const auto plain = read_volume(folder.path / "a.mgh");
    REQUIRE(plain);
    REQUIRE(plain->warnings.size() == 1);
    CHECK(plain->warnings[0].find("holds more voxels than its header says") != std::string::npos);
  }
  write_bytes(folder.path / "a.mgh", mgh_bytes(0, "abcdef") + scan);
  CHECK(test::must(read_volume(folder.path / "a.mgh")).warnings.empty());
  VolumeRead map;
  map.volume.geometry.dims = {8, 8, 8};
  map.volume.data = std::vector<std::uint8_t>(512, 0);
  const fs::path file = folder.path / "b.mgz";
  REQUIRE(write_segmentation(map, file));
  CHECK(test::must(read_volume(file)).warnings.empty());
  auto bytes = read_to_end({.file = file, .compression = compression_of(file)}, 1 << 20).value();
  bytes[11] = 7;  // the second size
  std::ostringstream packed;
  REQUIRE(write_compressed(packed, bytes, VoxelData(std::vector<std::uint8_t>()), nullptr));
  write_bytes(file, packed.str());
  CHECK(says(read_volume(file), "holds more voxels than its header says"));
}

TEST_CASE("the colour table that FreeSurfer embeds in a label map names its labels") {
  const TemporaryFolder folder;
  const auto big = [](std::uint64_t value, std::size_t bytes) {
    std::string text;
    for (std::size_t b = bytes; b-- > 0;) text += static_cast<char>(value >> (8 * b) & 255);
    return text;
  };
  const auto named = [&](const std::string& name) { return big(name.size() + 1, 4) + name + std::string(1, '\0'); };
  const std::string colour = big(220, 4) + big(216, 4) + big(20, 4) + big(0, 4);
  const std::string scan(20, '\0');
  // A command line before it, as mri_convert writes one.
  const std::string before = big(3, 4) + big(5, 8) + "abcd" + std::string(1, '\0');
  const std::string second = big(1, 4) + big(std::uint32_t(-2), 4) + big(54, 4) + named("lut.txt") + big(2, 4) +
                             big(17, 4) + named("Left-Hippocampus") + colour + big(53, 4) + named("Right-Hippocampus") +
                             colour;
  const std::string first =
      big(1, 4) + big(3, 4) + named("lut.txt") + named("Unknown") + colour + named("a") + colour + named("b") + colour;
  const std::string voxels("\0\x11\0\x35\0\0\0\x11\0\0\0\0", 12);
  write_bytes(folder.path / "aseg.mgh", mgh_bytes(4, voxels) + scan + before + second);
  const auto read = read_volume(folder.path / "aseg.mgh");
  REQUIRE_MESSAGE(read, read.error().sentence());
  REQUIRE(read->segmentation.segments.size() == 2);
  CHECK(read->segmentation.segments[0].value == 17);
  CHECK(read->segmentation.segments[0].name == "Left-Hippocampus");
  CHECK(read->segmentation.segments[1].name == "Right-Hippocampus");
  CHECK(read->segmentation.segments[0].colour == std::array<std::uint8_t, 3>{220, 216, 20});
  write_bytes(folder.path / "old.mgh", mgh_bytes(4, voxels) + scan + first);
  const auto old = read_volume(folder.path / "old.mgh");
  REQUIRE(old->segmentation.segments.size() == 2);
  CHECK(old->segmentation.segments[1].name == "b");
  CHECK(old->segmentation.segments[1].value == 2);
  CHECK(old->warnings.empty());
  // Torn at any byte, or with sizes that are not so, it is a map without names, and that is said.
  for (std::size_t length = 0; length < second.size(); ++length) {
    CAPTURE(length);
    write_bytes(folder.path / "torn.mgh", mgh_bytes(4, voxels) + scan + second.substr(0, length));
    const auto torn = read_volume(folder.path / "torn.mgh");
    REQUIRE(torn);
    CHECK(torn->segmentation.segments.empty());
    CHECK(torn->warnings.size() == (length == 0 ? 0 : 1));
  }
  write_bytes(folder.path / "huge.mgh", mgh_bytes(4, voxels) + scan + big(3, 4) + big(std::uint64_t(-1), 8) + second);
  CHECK(read_volume(folder.path / "huge.mgh")->segmentation.segments.empty());
}

TEST_CASE("a label map is written as FreeSurfer has it and read again with its place and its names and its colours") {
  const TemporaryFolder folder;
  VolumeRead map;
  map.volume.geometry.dims = {3, 2, 2};
  map.volume.geometry.spacing_mm = {0.75, 1.5, 3.25};
  map.volume.geometry.origin_mm = {-101.5, 22.25, 333.125};
  map.volume.geometry.direction = Eigen::AngleAxisd(0.7, Vec3(-1, 0.5, 2).normalized()).toRotationMatrix();
  map.volume.geometry.direction.col(1) *= -1;
  map.volume.data = std::vector<std::uint8_t>{0, 1, 17, 0, 0, 17, 1, 1, 0, 0, 17, 0};
  map.volume.range_max = 17;
  map.segmentation.add({.name = "Left-Hippocampus", .value = 17, .colour = std::array<std::uint8_t, 3>{220, 216, 20}});
  map.segmentation.add({.name = "Niere, groß", .value = 1});
  for (const char* name : {"a.mgz", "a.mgh", "a.mgh.gz"}) {
    CAPTURE(std::string(name));
    REQUIRE(write_segmentation(map, folder.path / name));
    const VolumeRead back = test::must(read_volume(folder.path / name));
    CHECK(back.warnings.empty());
    CHECK(back.volume.data == map.volume.data);
    CHECK(same_grid(back.volume.geometry, map.volume.geometry));
    REQUIRE(back.segmentation.segments.size() == 2);
    CHECK(back.segmentation.find(1)->name == "Niere, groß");
    CHECK(back.segmentation.find(1)->colour == colour_by_name("Niere, groß"));
    CHECK(back.segmentation.find(17)->colour == std::array<std::uint8_t, 3>{220, 216, 20});
  }
  CHECK_FALSE(fs::exists(folder.path / "a.json"));
  map.volume.data = std::vector<std::uint16_t>{0, 1, 40000, 0, 0, 17, 1, 1, 0, 0, 17, 0};
  map.volume.range_max = 40000;
  REQUIRE(write_segmentation(map, folder.path / "large.mgz"));
  CHECK(test::must(read_volume(folder.path / "large.mgz")).volume.data == map.volume.data);
  // Images are not, nor layers, nor what has no place there.
  Volume image = map.volume;
  image.data = std::vector<float>(12, 0.25F);
  image.range_max = 0.25;
  CHECK(says(write_volume(image, folder.path / "image.mgz"), "of a label map also in"));
  map.volume.geometry.origin_mm.x() = 1e9;
  CHECK(says(write_segmentation(map, folder.path / "far.mgz"), "single precision"));
  map.other_layers.push_back(map.volume);
  CHECK(says(write_segmentation(map, folder.path / "layers.mgz"), "end its name in .seg.nrrd"));
}

TEST_CASE("what is no number in a single mask is background and a share above one half is the structure's") {
  const TemporaryFolder folder;
  Volume mask;
  mask.geometry.dims = {6, 1, 1};
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  mask.data = std::vector<float>{1, nan, infinity, 0.5F, 0.75F, 0.25F};
  REQUIRE(write_volume(mask, folder.path / "liver.nii.gz"));
  mask.data = std::vector<float>{0, 1, 0, 0, 0, 0};
  REQUIRE(write_volume(mask, folder.path / "aorta.nii.gz"));
  const auto read = read_labels(folder.path);
  REQUIRE_MESSAGE(read, read.error().sentence());
  CHECK(read->other_layers.empty());
  CHECK(read->volume.data == VoxelData(std::vector<std::uint16_t>{2, 1, 0, 0, 2, 0}));
  CHECK(read->warnings.empty());
  REQUIRE(read->soft.size() == 1);
  CHECK(read->soft.front().value == 2);
  mask.data = std::vector<float>{0, 1.25F, 0, 0, 0, 0};  // no share
  REQUIRE(write_volume(mask, folder.path / "aorta.nii.gz"));
  const VolumeRead rounded = test::must(read_labels(folder.path));
  REQUIRE(rounded.warnings.size() == 1);
  CHECK(rounded.warnings.front().find("aorta.nii.gz") != std::string::npos);
}

TEST_CASE("masks of one name go back into the files that they come from") {
  const TemporaryFolder folder, again;
  const auto write = [&](const std::string& name, std::vector<std::uint8_t> voxels) {
    Volume mask;
    mask.geometry.dims = {static_cast<int>(voxels.size()), 1, 1};
    mask.data = std::move(voxels);
    mask.range_max = 1;
    REQUIRE(write_volume(mask, folder.path / name));
  };
  write("aorta.nii.gz", {1, 1, 0, 0});
  write("liver.nii.gz", {0, 1, 1, 0});  // overlaps the first one, so that it is in the second layer
  write("liver.nrrd", {0, 0, 0, 1});
  REQUIRE(write_single_masks(test::must(read_labels(folder.path)), again.path, folder.path));
  for (const char* name : {"aorta.nii.gz", "liver.nii.gz", "liver.nrrd"})
    CHECK(test::must(read_volume(folder.path / name)).volume.data ==
          test::must(read_volume(again.path / name)).volume.data);
}

TEST_CASE("a folder of single masks is one label map with the names of its files") {
  const TemporaryFolder folder;
  const auto write = [&](const std::string& name, std::vector<std::uint8_t> voxels, double from = 0) {
    Volume mask;
    mask.geometry.dims = {static_cast<int>(voxels.size()), 1, 1};
    mask.geometry.origin_mm = Vec3(from, 0, 0);
    mask.data = std::move(voxels);
    mask.range_max = 1;
    REQUIRE(write_volume(mask, folder.path / (name + ".nii.gz")));
  };
  write("aorta", {1, 1, 0, 0});
  write("liver", {0, 0, 1, 1});
  write("lung", {0, 1, 1, 0});
  write("spleen", {1, 1}, 9.5);
  write("vein", {0, 0, 0, 0});
  const auto read = read_labels(folder.path);
  REQUIRE_MESSAGE(read, read.error().sentence());
  CHECK(read->volume.data == VoxelData(std::vector<std::uint16_t>{1, 1, 2, 2}));
  REQUIRE(read->other_layers.size() == 2);
  CHECK(read->segmentation.segments.size() == 5);
  VolumeRead spleen = *read;
  REQUIRE(choose_segments(folder.path, "spleen", spleen));
  CHECK(spleen.volume.geometry.origin_mm.x() == 9.5);
  VolumeRead both = *read;
  REQUIRE(choose_segments(folder.path, "lung,aorta", both));
  CHECK(both.volume.data == VoxelData(std::vector<std::uint16_t>{1, 1, 3, 0}));
  VolumeRead apart = *read;
  CHECK(says(choose_segments(folder.path, "lung,spleen", apart), "on grids of their own"));
  // Voxels that coincide are of one grid, which holds them all.
  write("spleen", {1, 1}, -3);
  const auto grown = read_labels(folder.path);
  REQUIRE_MESSAGE(grown, grown.error().sentence());
  CHECK(grown->other_layers.size() == 1);
  CHECK(grown->volume.geometry.origin_mm.x() == -3);
  CHECK(grown->volume.data == VoxelData(std::vector<std::uint16_t>{4, 4, 0, 1, 1, 2, 2}));
  const TemporaryFolder again;
  REQUIRE(write_single_masks(*grown, again.path, folder.path));
  for (const char* name : {"aorta.nii.gz", "spleen.nii.gz", "lung.nii.gz", "vein.nii.gz"}) {
    const auto before = read_volume(folder.path / name), after = read_volume(again.path / name);
    REQUIRE(before);
    REQUIRE(after);
    CHECK(same_grid(before->volume.geometry, after->volume.geometry));
    CHECK(before->volume.data == after->volume.data);
  }
  // Its layers lie on grids of their own, and each is put on the grid of an image.
  VolumeRead placed = test::must(read_labels(folder.path));
  VolumeGeometry image = placed.volume.geometry;
  image.origin_mm.x() = -5;
  image.dims[0] = 20;
  REQUIRE(put_on_grid(placed, image));
  CHECK(placed.other_layers[0].geometry == image);
  CHECK(std::get<std::vector<std::uint16_t>>(placed.other_layers[0].data)[6] == 3);
  write("zz-all", {1, 2, 3, 0});
  CHECK(says(read_labels(folder.path), "zz-all.nii.gz"));
}
