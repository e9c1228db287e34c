#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/volume/dicom/dicom_series.h"
#include "core/volume/labels/map_on_grid.h"
#include "core/volume/labels/read_labels.h"
#include "core/volume/volume_io.h"
#include "tests/core/volume/dicom_slices.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

// Segmentations of a few voxels, byte by byte. tests/dicom makes larger ones, as programs of the field write them.
using namespace homolog;
namespace fs = std::filesystem;

namespace {

/// A frame of 3 × 5 pixels: its segment, its height, and the pixels that are set.
struct SegFrame {
  int segment = 1;
  double z = 0;
  std::vector<int> set;
};

/// A segmentation; members that tests change.
struct SegFile {
  std::string type = "BINARY", space = "1.2.9", spacing = "2.5", thickness, syntax = "1.2.840.10008.1.2.1";
  std::vector<std::string> names{"spleen", "liver"};
  std::vector<SegFrame> frames{{1, 5, {0, 14}}, {1, 10, {7}}, {2, 5, {1, 2}}};
  std::string more;             ///< elements of group 62 behind the segments
  int value = 0;                ///< of set pixels where they are bytes; 0: single bits
  std::string references;       ///< elements that name the images it was made on
  std::size_t groups_less = 0;  ///< frames without a description
  std::string pixels_more;      ///< behind those of all frames
  bool in_bytes = false;        ///< single bits of each frame begin with a byte of their own

  std::string pixels() const {
    if (value > 0) {
      std::string bytes(15 * frames.size(), '\0');
      for (std::size_t f = 0; f < frames.size(); ++f)
        for (const int p : frames[f].set) bytes[15 * f + static_cast<std::size_t>(p)] = static_cast<char>(value);
      return bytes;
    }
    const std::size_t bits = in_bytes ? 16 : 15;
    std::string bytes((bits * frames.size() + 7) / 8, '\0');
    for (std::size_t f = 0; f < frames.size(); ++f)
      for (const int p : frames[f].set) {
        const std::size_t bit = bits * f + static_cast<std::size_t>(p);
        bytes[bit / 8] = static_cast<char>(bytes[bit / 8] | 1 << bit % 8);
      }
    return bytes;
  }

  std::string bytes() const {
    std::string segments, groups;
    for (std::size_t s = 0; s < names.size(); ++s)
      segments += item(us(0x00620004, static_cast<std::uint32_t>(s + 1)) + element(0x00620005, "LO", names[s]));
    for (const SegFrame& frame : std::span(frames).first(frames.size() - groups_less))
      groups += item(sequence(0x00209113, item(position(1, 2, frame.z))) +
                     sequence(0x0062000a, item(us(0x0062000b, static_cast<std::uint32_t>(frame.segment)))));
    std::string measures = element(0x00280030, "DS", "0.5\\0.25");
    if (!spacing.empty()) measures = element(0x00180088, "DS", spacing) + measures;
    if (!thickness.empty()) measures = element(0x00180050, "DS", thickness) + measures;
    const std::string shared = item(sequence(0x00209116, item(element(0x00200037, "DS", "1\\0\\0\\0\\1\\0"))) +
                                    sequence(0x00289110, item(measures)));
    const std::uint32_t bits = value > 0 ? 8 : 1;
    const std::string data =
        element(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.66.4") + element(0x00080060, "CS", "SEG") + references +
        element(0x0020000e, "UI", "1.2.3") + (space.empty() ? "" : element(0x00200052, "UI", space)) +
        us(0x00280002, 1) + element(0x00280004, "CS", "MONOCHROME2") +
        element(0x00280008, "IS", std::to_string(frames.size())) + us(0x00280010, 3) + us(0x00280011, 5) +
        us(0x00280100, bits) + us(0x00280101, bits) + us(0x00280102, bits - 1) + us(0x00280103, 0) +
        element(0x00620001, "CS", type) + sequence(0x00620002, segments) + more + sequence(0x52009229, shared) +
        sequence(0x52009230, groups) + element(0x7fe00010, "OW", pixels() + pixels_more);
    const std::string meta = element(0x00020010, "UI", syntax);
    return std::string(128, '\0') + "DICM" +
           element(0x00020000, "UL", little_endian(static_cast<std::uint32_t>(meta.size()), 4)) + meta + data;
  }
};

Result<VolumeRead> read_seg(const SegFile& file, const VolumeReadOptions& options = {}) {
  const TemporaryFolder folder;
  write_bytes(folder.path / "seg.dcm", file.bytes());
  return read_volume(folder.path / "seg.dcm", options);
}

/// What refers to images of a series.
std::string references_to(const std::string& series, const std::vector<std::string>& instances) {
  std::string images;
  for (const std::string& uid : instances) images += item(element(0x00081155, "UI", uid));
  return sequence(0x00081115, item(sequence(0x0008114a, images) + element(0x0020000e, "UI", series)));
}

std::vector<int> voxels_with(const Volume& volume, double value) {
  std::vector<int> found;
  const auto& dims = volume.geometry.dims;
  for (int k = 0; k < dims[2]; ++k)
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i)
        if (volume.at(i, j, k) == value) found.push_back(i + dims[0] * (j + dims[1] * k));
  return found;
}

void seg_refused(const SegFile& file, const std::string& words) {
  const auto read = read_seg(file);
  REQUIRE_FALSE(read);
  INFO(read.error().sentence());
  CHECK(read.error().what.find(words) != std::string::npos);
  CHECK(read.error().subject.find("seg.dcm") != std::string::npos);
}

}  // namespace

TEST_CASE("frames that were left out of a segmentation are empty slices between those that are there") {
  const auto read = read_seg({});
  if (!read) FAIL(read.error().sentence());
  const Volume& map = read->volume;
  CHECK(map.geometry.dims == std::array{5, 3, 3});
  CHECK(map.geometry.spacing_mm.isApprox(Vec3(0.25, 0.5, 2.5), 1e-12));
  CHECK(map.geometry.origin_mm.isApprox(Vec3(1, 2, 5), 1e-12));
  CHECK(voxels_with(map, 1) == std::vector{0, 14, 37});
  CHECK(voxels_with(map, 2) == std::vector{1, 2});
  CHECK(read->other_layers.empty());
  CHECK(read->warnings.empty());
  REQUIRE(read->segmentation.segments.size() == 2);
  CHECK(read->segmentation.find(2)->name == "liver");
}

TEST_CASE("the slices of a segmentation lie as its spacing says or else its thickness or else its gaps") {
  const auto step = [](const std::string& spacing, const std::string& thickness, std::vector<SegFrame> frames) {
    SegFile file;
    file.spacing = spacing;
    file.thickness = thickness;
    if (!frames.empty()) file.frames = std::move(frames);
    const auto read = read_seg(file);
    if (!read) FAIL(read.error().sentence());
    return std::pair(read->volume.geometry.spacing_mm.z(), read->volume.geometry.dims[2]);
  };
  CHECK(step("1.25", "5", {}) == std::pair(1.25, 5));
  CHECK(step("-2.5", "", {}) == std::pair(2.5, 3));
  CHECK(step("", "2.5", {}) == std::pair(2.5, 3));
  CHECK(step("", "", {}) == std::pair(5.0, 2));
  CHECK(step("", "4", {}) == std::pair(5.0, 2));
  // Frames that follow one another tell more than their thickness.
  CHECK(step("", "1", {{1, 0, {0}}, {1, 2, {0}}, {1, 4, {0}}, {1, 6, {0}}, {1, 12, {0}}}) == std::pair(2.0, 7));
  const auto [common, slices] = step("", "", {{1, 10, {0}}, {1, 0, {1}}, {2, 4, {2}}});
  CHECK(common == doctest::Approx(2));
  CHECK(slices == 6);
}

TEST_CASE("a frame that lies between the slices that the file says is refused and not put on thinner ones") {
  SegFile file;
  file.frames = {{1, 0, {0}}, {1, 2.5, {0}}, {1, 5.75, {0}}, {1, 7.5, {0}}, {1, 10, {0}}};
  seg_refused(file,
              "says that its slices lie 2.50 mm apart, as most of its frames do, and its frame 3 lies 0.75 mm off");
  file.spacing.clear();
  file.thickness = "2.5";
  seg_refused(file, "has slices of 2.50 mm, as far as most of its frames lie apart, and its frame 3 lies 0.75 mm off");
  file.spacing = "2.5";
  file.frames[4].z = 11.25;
  file.frames.push_back({1, 12.5, {0}});
  file.frames.push_back({1, 15, {0}});
  seg_refused(file, "2 others (as frame 3) lie up to 1.25 mm off");
  // All frames lie nearer to one another than it says.
  file.spacing = "5";
  file.frames = {{1, 0, {0}}, {1, 2.5, {0}}, {1, 5, {0}}};
  const auto read = read_seg(file);
  if (!read) FAIL(read.error().sentence());
  CHECK(read->volume.geometry.dims == std::array{5, 3, 3});
  CHECK(read->warnings.size() == 1);
}

TEST_CASE("segments that overlap lie in layers and are chosen by name") {
  SegFile file;
  file.frames[2].set = {0, 1};
  auto read = read_seg(file);
  if (!read) FAIL(read.error().sentence());
  REQUIRE(read->other_layers.size() == 1);
  CHECK(voxels_with(read->volume, 1) == std::vector{0, 14, 37});
  CHECK(voxels_with(read->other_layers.front(), 2) == std::vector{0, 1});
  const auto chosen = choose_segments("seg.dcm", "liver", *read);
  REQUIRE(chosen);
  CHECK(voxels_with(read->volume, 2) == std::vector{0, 1});
  CHECK(voxels_with(read->volume, 1).empty());
}

TEST_CASE("a fractional segment is a soft mask and a label map has its values") {
  SegFile file;
  file.names = {"spleen"};
  file.frames.pop_back();
  file.type = "FRACTIONAL";
  file.more = us(0x0062000e, 200);
  file.value = 50;
  const auto soft = read_seg(file);
  if (!soft) FAIL(soft.error().sentence());
  CHECK(voxels_with(soft->volume, 0.25) == std::vector{0, 14, 37});
  file.value = 201;
  seg_refused(file, "above the one that it gives for a whole voxel");

  file.type = "LABELMAP";
  file.value = 1;
  const auto map = read_seg(file);
  if (!map) FAIL(map.error().sentence());
  CHECK(voxels_with(map->volume, 1) == std::vector{0, 14, 37});
  file.value = 7;
  const auto unnamed = read_seg(file);
  if (!unnamed) FAIL(unnamed.error().sentence());
  CHECK(voxels_with(unnamed->volume, 7).size() == 3);
  REQUIRE(unnamed->warnings.size() == 1);
  CHECK(unnamed->warnings.front().find("holds label 7, which it does not describe") != std::string::npos);
}

TEST_CASE("a segmentation without a place or with segments that do not exist is refused") {
  SegFile file;
  file.space.clear();
  seg_refused(file, "names no frame of reference");
  file = {};
  file.names.pop_back();
  seg_refused(file, "refers in its frame 3 to segment 2, which it does not describe");
  file = {};
  file.frames[1].z = 5;
  seg_refused(file, "two frames (1 and 2) of segment 1 at one place");
  file = {};
  file.frames.push_back({2, 7.3137, {}});
  file.spacing.clear();
  seg_refused(file, "lie on no even slices");
  file = {};
  file.type = "SURFACE";
  seg_refused(file, "of the type \"SURFACE\"");
  file = {};
  file.references = element(0x00209311, "CS", "TILED_FULL");
  file.groups_less = file.frames.size();
  seg_refused(file, "is tiled (TILED_FULL)");
}

TEST_CASE("a folder of images with a segmentation in it is the images and alone the segmentation is the folder") {
  const TemporaryFolder folder;
  Slice slice;
  slice.put(0x00200052, "UI", "1.2.9");
  save_series(folder.path, {0, 2.5, 5, 7.5, 10}, slice);
  write_bytes(folder.path / "seg.bin", SegFile{}.bytes());
  const auto images = read_volume(folder.path);
  if (!images) FAIL(images.error().sentence());
  CHECK(images->volume.modality == "CT");
  CHECK(images->volume.geometry.dims == std::array{3, 2, 5});
  const auto listed = list_series(folder.path);
  REQUIRE(listed);
  CHECK(listed->size() == 1);
  const TemporaryFolder alone;
  write_bytes(alone.path / "seg.bin", SegFile{}.bytes());
  const auto map = read_volume(alone.path);
  if (!map) FAIL(map.error().sentence());
  CHECK(map->volume.modality == "SEG");
  CHECK(map->segmentation.segments.size() == 2);
  write_bytes(alone.path / "other.bin", SegFile{}.bytes());
  const auto several = read_volume(alone.path);
  REQUIRE_FALSE(several);
  CHECK(several.error().what.find("name one of the files: other.bin, seg.bin") != std::string::npos);
}

TEST_CASE("a folder of several segmentations and no images gives each of them by name") {
  const TemporaryFolder folder;
  CHECK(segmentations_in(folder.path / "absent").empty());
  CHECK(segmentations_in(folder.path).empty());
  write_bytes(folder.path / "liver", SegFile{}.bytes());
  CHECK(segmentations_in(folder.path).empty());  // one alone is read as the folder
  write_bytes(folder.path / "heart.dcm", SegFile{}.bytes());
  write_bytes(folder.path / "notes.txt", "no DICOM");
  write_bytes(folder.path / "cut.dcm", SegFile{}.bytes().substr(0, 60));
  fs::create_directory(folder.path / "more");
  write_bytes(folder.path / "more" / "deeper.dcm", SegFile{}.bytes());
  const auto found = segmentations_in(folder.path);
  CHECK(found == std::vector<fs::path>{folder.path / "heart.dcm", folder.path / "liver"});
  for (const fs::path& file : found) {
    const auto read = read_volume(file);
    if (!read) FAIL(read.error().sentence());
    CHECK(read->segmentation.segments.size() == 2);
  }
  // Beside images they are what was segmented of these.
  save_series(folder.path, {0, 2.5});
  CHECK(segmentations_in(folder.path).empty());
}

TEST_CASE("a DICOM file whose line ends were converted is told so") {
  const TemporaryFolder folder;
  std::string bytes = SegFile{}.bytes();
  for (std::size_t at = bytes.find('\n'); at != std::string::npos; at = bytes.find('\n', at + 2))
    bytes.insert(at, "\r");
  write_bytes(folder.path / "seg.dcm", bytes);
  const auto read = read_volume(folder.path / "seg.dcm");
  REQUIRE_FALSE(read);
  INFO(read.error().sentence());
  CHECK(read.error().what.find("line ends were converted") != std::string::npos);
}

TEST_CASE("slices beyond the first and last frame of a segmentation are empty unless it keeps empty ones") {
  SegFile file;
  const auto sparse = read_seg(file);
  if (!sparse) FAIL(sparse.error().sentence());
  CHECK(sparse->volume.empty_beyond_slices);
  file.frames.push_back({2, 12.5, {}});
  const auto keeps = read_seg(file);
  if (!keeps) FAIL(keeps.error().sentence());
  CHECK_FALSE(keeps->volume.empty_beyond_slices);
  CHECK(keeps->volume.geometry.dims == std::array{5, 3, 4});
}

TEST_CASE("a segmentation lies on the grid of the image beside which it is read") {
  const auto whole = read_seg({});
  if (!whole) FAIL(whole.error().sentence());
  VolumeReadOptions options;
  options.image = ImageGrid{whole->volume.geometry, "1.2.9"};
  options.image->geometry.origin_mm.z() = -2.5;
  options.image->geometry.dims[2] = 7;
  SegFile file;
  file.spacing.clear();  // the image tells it
  const auto placed = read_seg(file, options);
  if (!placed) FAIL(placed.error().sentence());
  CHECK(placed->volume.geometry.dims == std::array{5, 3, 7});
  CHECK(placed->volume.geometry.origin_mm.z() == doctest::Approx(-2.5));
  CHECK_FALSE(placed->volume.empty_beyond_slices);
  CHECK(voxels_with(placed->volume, 1) == std::vector{45, 59, 82});
  CHECK(placed->warnings.empty());
  options.image->frame_of_reference = "1.2.10";  // elsewhere
  CHECK(read_seg({}, options)->volume.geometry.dims == std::array{5, 3, 3});
  options.image->frame_of_reference = "1.2.9";
  options.image->geometry.origin_mm.z() += 1;  // between its slices
  CHECK(read_seg({}, options)->volume.geometry.dims == std::array{5, 3, 3});
}

TEST_CASE("a label map is put on the grid of which its voxels are voxels") {
  auto read = read_seg({});
  if (!read) FAIL(read.error().sentence());
  VolumeGeometry grid = read->volume.geometry;
  grid.dims = {6, 3, 5};
  grid.origin_mm = read->volume.geometry.to_mm(Vec3(5, 0, -1));
  grid.direction.col(0) *= -1;  // the other way round
  VolumeRead map = *read;
  REQUIRE(put_on_grid(map, grid));
  CHECK(map.volume.geometry == grid);
  // Of voxels (0, 0, 0), (4, 2, 0) and (2, 1, 2) of five columns.
  CHECK(voxels_with(map.volume, 1) == std::vector{18 + 5, 18 + 2 * 6 + 1, 3 * 18 + 6 + 3});
  CHECK_FALSE(map.volume.empty_beyond_slices);
  grid.origin_mm.x() += 0.1;
  CHECK_FALSE(put_on_grid(map = *read, grid));
  CHECK(map.volume.geometry == read->volume.geometry);
}

TEST_CASE("a distance between slices that nothing tells is said to be assumed") {
  SegFile file;
  file.spacing.clear();
  const auto read = read_seg(file);
  if (!read) FAIL(read.error().sentence());
  CHECK(read->volume.geometry.spacing_mm.z() == doctest::Approx(5));
  REQUIRE(read->warnings.size() == 1);
  CHECK(read->warnings.front().find("does not say how far its slices lie apart; 5.00 mm") != std::string::npos);
  CHECK(read_seg({})->warnings.empty());
  file.frames = {{1, 0, {0}}, {1, 2, {0}}, {1, 4, {0}}, {1, 6, {0}}};  // they follow one another
  CHECK(read_seg(file)->warnings.empty());
  file.thickness = "5";  // slices that overlap
  CHECK(read_seg(file)->warnings.empty());
  file.thickness = "1";  // every second slice
  const auto sparse = read_seg(file);
  if (!sparse) FAIL(sparse.error().sentence());
  CHECK(sparse->volume.geometry.spacing_mm.z() == doctest::Approx(2));
  REQUIRE(sparse->warnings.size() == 1);
  CHECK(sparse->warnings.front().find("2.00 mm, as far as its frames do, was taken, though its slices are 1.00 mm "
                                      "thick") != std::string::npos);
}

TEST_CASE("frames lie on slices whose places are rounded or uneven by little") {
  SegFile file;
  file.spacing = "0.625";
  file.frames = {{1, 5.6, {0}}, {1, 6.3, {0}}, {1, 8.1, {7}}};  // of 5.625, 6.25 and 8.125
  const auto alone = read_seg(file);
  if (!alone) FAIL(alone.error().sentence());
  CHECK(alone->volume.geometry.dims == std::array{5, 3, 5});
  CHECK(alone->volume.geometry.spacing_mm.z() == doctest::Approx(0.625));
  CHECK(alone->warnings.empty());
  VolumeReadOptions options;
  options.image = ImageGrid{alone->volume.geometry, "1.2.9"};
  options.image->geometry.origin_mm = Vec3(1, 2, 5);
  options.image->geometry.dims[2] = 7;
  const auto placed = read_seg(file, options);
  if (!placed) FAIL(placed.error().sentence());
  CHECK(placed->volume.geometry == options.image->geometry);
  CHECK(voxels_with(placed->volume, 1) == std::vector{15, 30, 82});
  VolumeRead map = *alone;
  REQUIRE(put_on_grid(map, options.image->geometry));
  CHECK(voxels_with(map.volume, 1) == std::vector{15, 30, 82});
  file.frames[1].z = 6.05;  // between two slices of the image
  const auto beside = read_seg(file, options);
  if (!beside) FAIL(beside.error().sentence());
  CHECK_FALSE(beside->volume.geometry == options.image->geometry);
}

TEST_CASE("fractional segments of one name are told apart by their numbers") {
  SegFile file;
  file.type = "FRACTIONAL";
  file.more = us(0x0062000e, 200);
  file.value = 50;
  file.names = {"lesion", "lesion"};
  auto read = read_seg(file);
  if (!read) FAIL(read.error().sentence());
  REQUIRE(read->segmentation.segments.size() == 2);
  CHECK(read->segmentation.segments[0].name == "lesion (segment 1)");
  const auto chosen = choose_segments("seg.dcm", "lesion (segment 2)", *read);
  REQUIRE(chosen);
  CHECK(voxels_with(read->volume, 0.25) == std::vector{1, 2});
}

TEST_CASE("more segments than are read are refused by their number") {
  SegFile file;
  file.names.assign(16385, "s");
  seg_refused(file, "describes more than 16,384 segments");
}

TEST_CASE("frames and their descriptions and their pixels are equally many") {
  SegFile file;
  file.groups_less = 1;
  seg_refused(file, "has 3 frames and describes 2 (functional groups)");
  file = {};
  file.value = 1;
  file.type = "LABELMAP";
  file.frames.pop_back();
  CHECK(read_seg(file));
  file.pixels_more = std::string(16, '\0');
  seg_refused(file, "says that it has 2 frames, and has the pixels of 3");
}

TEST_CASE("frames that each begin with a byte of their own are read so and said and other lengths are refused") {
  SegFile file;
  file.frames.clear();
  for (int k = 0; k < 32; ++k) file.frames.push_back({1, 2.5 * k, {k % 15, 14}});
  const auto joined = read_seg(file);
  if (!joined) FAIL(joined.error().sentence());
  CHECK(joined->warnings.empty());
  file.in_bytes = true;
  const auto apart = read_seg(file);
  if (!apart) FAIL(apart.error().sentence());
  CHECK(voxels_with(apart->volume, 1) == voxels_with(joined->volume, 1));
  REQUIRE(apart->warnings.size() == 1);
  CHECK(apart->warnings.front().find("each of its frames begins with a byte of its own") != std::string::npos);
  file.in_bytes = false;
  file.pixels_more = std::string(2, '\0');
  seg_refused(file, "holds 62 bytes of pixels, where its 32 frames take 60");
}

TEST_CASE("a part of a segmentation that lies in several files is refused") {
  SegFile file;
  file.more = us(0x00209162, 2) + us(0x00209163, 3);
  seg_refused(file, "is part 2 of 3 of a segmentation that lies in several files");
  file.more = us(0x00209162, 1) + us(0x00209163, 1);
  CHECK(read_seg(file));
}

TEST_CASE("a segmentation that does not fit the image it is read with lies on its own series beside it") {
  const TemporaryFolder folder;
  Slice slice;
  slice.put(0x00200052, "UI", "1.2.9");
  slice.columns = 5;
  for (int k = 0; k < 7; ++k) {
    slice.x = 1, slice.y = 2, slice.z = 2.5 * k - 2.5;
    slice.put(0x00080018, "UI", "1.2.3." + std::to_string(k));
    slice.put(0x00280010, "US", little_endian(3, 2));
    slice.pixels.assign(15, 7);
    write_bytes(folder.path / (std::to_string(k) + ".bin"), slice.bytes());
  }
  SegFile file;
  file.references = references_to("1.2.3", {});
  write_bytes(folder.path / "seg.bin", file.bytes());
  const auto read = [&](const std::optional<ImageGrid>& image) {
    VolumeReadOptions options;
    options.image = image;
    const auto map = read_volume(folder.path / "seg.bin", options);
    if (!map) FAIL(map.error().sentence());
    return map->volume.geometry;
  };
  const VolumeGeometry on_series = read(std::nullopt);
  CHECK(on_series.dims == std::array{5, 3, 7});
  VolumeGeometry other = on_series;
  other.origin_mm.z() += 1;  // between its slices
  CHECK(read(ImageGrid{other, "1.2.9"}) == on_series);
  CHECK(read(ImageGrid{on_series, "1.2.10"}) == on_series);  // elsewhere
}

TEST_CASE("a segmentation of other images than those beside it says so") {
  const auto warnings = [](const SegFile& file) {
    const TemporaryFolder folder;
    Slice slice;
    slice.put(0x00200052, "UI", "1.2.9");
    for (int k = 0; k < 3; ++k) {
      slice.z = 2.5 * k;
      slice.put(0x00080018, "UI", "1.2.3." + std::to_string(k));
      write_bytes(folder.path / (std::to_string(k) + ".bin"), slice.bytes());
    }
    write_bytes(folder.path / "seg.bin", file.bytes());
    const auto read = read_volume(folder.path / "seg.bin");
    if (!read) FAIL(read.error().sentence());
    return read->warnings;
  };
  SegFile file;
  file.references = references_to("1.2.3", {"1.2.3.0", "1.2.3.2"});
  CHECK(warnings(file).empty());
  file.references = references_to("1.2.3", {"1.2.3.0", "1.2.3.7"});
  REQUIRE(warnings(file).size() == 1);
  CHECK(warnings(file).front().find("refers to 2 images, 1 of which is not in the image beside it") !=
        std::string::npos);
  file.references = references_to("1.2.4", {});
  REQUIRE(warnings(file).size() == 1);
  CHECK(warnings(file).front().find("refers to the series 1.2.4, and the image beside it is series 1.2.3") !=
        std::string::npos);
}

TEST_CASE("of several series in a folder the one is read that a segmentation was made on") {
  const TemporaryFolder folder;
  const fs::path flat = folder.path / "flat", study = folder.path / "study";
  for (const auto& one : {flat, study / "a", study / "b"}) fs::create_directories(one);
  Slice slice;
  for (const char* series : {"1.2.3", "1.2.4"})
    for (int k = 0; k < (series == std::string("1.2.3") ? 3 : 2); ++k) {
      slice.series = series;
      slice.z = 2.5 * k;
      slice.put(0x00080018, "UI", series + ("." + std::to_string(k)));
      const std::string name = series + ("-" + std::to_string(k) + ".dcm");
      write_bytes(flat / name, slice.bytes());
      write_bytes(study / (series == std::string("1.2.3") ? "a" : "b") / name, slice.bytes());
    }
  SegFile file;
  file.references = references_to("1.2.9", {"1.2.4.0", "1.2.4.1", "1.2.3.0"});
  write_bytes(flat / "seg.dcm", file.bytes());
  const ReferencedImages made_on = images_made_on(flat / "seg.dcm");
  CHECK(made_on.instances.size() == 3);
  CHECK(images_made_on(flat / "1.2.3-0.dcm").series.empty());
  const auto slices_of = [&](const ReferencedImages& images) {
    VolumeReadOptions options;
    options.of_images = images;
    const auto read = read_volume(flat, options);
    if (!read) FAIL(read.error().sentence());
    return read->volume.geometry.dims[2];
  };
  CHECK(slices_of(made_on) == 2);
  CHECK(slices_of({{"1.2.3"}, {}, {}}) == 3);
  VolumeReadOptions options;
  options.names_no_series = true;
  CHECK(says(read_volume(flat, options), "holds 2 series; copy the files of one to a folder of their own"));
  CHECK(folder_of_series(study, {"1.2.4"}) == study / "b");
  CHECK(folder_of_series(study, {"1.2.5"}) == study);
  CHECK(folder_of_series(flat, {"1.2.4"}) == flat);
}
