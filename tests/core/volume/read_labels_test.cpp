#include "core/volume/read_labels.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace fs = std::filesystem;
using namespace homolog;

namespace {

/// A segmentation as 3D Slicer saves it, of a row of three voxels in layers. `voxels`: layer by layer for each voxel.
std::string slicer_bytes(int layers, const std::string& voxels,
                         const std::string& keys =
                             "Segment0_LabelValue:=1\n"
                             "Segment0_Layer:=0\n") {
  return "NRRD0004\ntype: uint8\ndimension: 4\nspace: left-posterior-superior\nsizes: " + std::to_string(layers) +
         " 3 1 1\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\nkinds: list domain domain domain\nencoding: raw\n"
         "space origin: (0,0,0)\n" +
         keys + "\n" + voxels;
}

Result<VolumeRead> read_labels_as(const std::string& name, const std::string& bytes) {
  const TemporaryFolder folder;
  write_bytes(folder.path / name, bytes);
  return read_labels(folder.path / name);
}

const std::string overlapping_layers{1, 0, 1, 2, 0, 2};  // label 1 in voxels 0 and 1, label 2 in voxels 1 and 2

VoxelData layer_row(std::vector<std::uint8_t> voxels) {
  return voxels;
}

bool label_warns(const VolumeRead& read, const std::string& what) {
  return std::any_of(read.warnings.begin(), read.warnings.end(),
                     [&](const std::string& warning) { return warning.find(what) != std::string::npos; });
}

}  // namespace

TEST_CASE("layers of a segmentation are no frames and a label is found in any of them") {
  for (const char* name : {"a.seg.nrrd", "renamed.nrrd"}) {
    CAPTURE(std::string(name));
    const auto read = read_labels_as(name, slicer_bytes(2, overlapping_layers));
    REQUIRE_MESSAGE(read, read.error().sentence());
    CHECK(read->volume.frames == 1);
    CHECK(read->volume.data == layer_row({1, 1, 0}));
    REQUIRE(read->other_layers.size() == 1);
    CHECK(read->other_layers.front().data == layer_row({0, 2, 2}));
    CHECK(label_warns(*read, "2 layers, not frames: label 1 in layer 0, label 2 in layer 1"));
    for (const int label : {1, 2}) {
      VolumeRead chosen = *read;
      REQUIRE(choose_layer(name, std::span(&label, 1), chosen));
      CHECK(chosen.volume.data ==
            layer_row(label == 1 ? std::vector<std::uint8_t>{1, 1, 0} : std::vector<std::uint8_t>{0, 2, 2}));
      CHECK(chosen.other_layers.empty());
    }
    VolumeRead both = *read;
    const std::vector<int> labels{1, 2};
    REQUIRE(choose_layer(name, labels, both));
    unite_labels(both.volume, labels);
    CHECK(both.volume.data == layer_row({1, 1, 1}));
    VolumeRead none = *read;
    CHECK(says(choose_layer(name, {}, none), "label 2 in layer 1"));
  }
  // A sequence of 3D Slicer looks alike but for its keys.
  const auto sequence =
      read_labels_as("a.seq.nrrd", slicer_bytes(2, overlapping_layers, "axis 0 index type:=numeric\n"));
  REQUIRE(sequence);
  CHECK(sequence->volume.frames == 2);
  CHECK(sequence->other_layers.empty());
}

TEST_CASE("a label that lies in two layers is refused and one that does not is found") {
  const auto read = read_labels_as("a.seg.nrrd", slicer_bytes(3, {1, 0, 0, 1, 1, 0, 0, 1, 5}));
  REQUIRE(read);
  CHECK(label_warns(*read, "label 1 in layer 0 and 1"));
  const int one = 1, five = 5, absent = 4;
  VolumeRead chosen = *read;
  CHECK(says(choose_layer("a", std::span(&one, 1), chosen), "has label 1 in layers 0 and 1"));
  CHECK(choose_layer("a", std::span(&absent, 1), chosen));  // said where the label is looked for
  CHECK(says(choose_layer("a", {}, chosen), "holds its segments in layers"));
  REQUIRE(choose_layer("a", std::span(&five, 1), chosen));
  CHECK(chosen.volume.data == layer_row({0, 0, 5}));
  const auto only = read_labels_as("a.seg.nrrd", slicer_bytes(2, {1, 0, 1, 1, 0, 1}));
  VolumeRead ambiguous = *only;
  CHECK(says(choose_layer("a", {}, ambiguous), "has label 1 in layers 0 and 1"));
}

TEST_CASE("layers that nowhere overlap become one label map") {
  const auto read = read_labels_as("a.seg.nrrd", slicer_bytes(2, {1, 0, 0, 2, 0, 0}));
  REQUIRE(read);
  CHECK(read->volume.data == layer_row({1, 2, 0}));
  CHECK(read->volume.range_max == 2);
  CHECK(read->other_layers.empty());
  CHECK(label_warns(*read, "nowhere overlap"));
}

TEST_CASE("values that are no labels are said with the first of them") {
  const auto soft = [](float value) {
    const TemporaryFolder folder;
    Volume volume;
    volume.geometry.dims = {4, 1, 1};
    volume.data = std::vector<float>{0, 1, value, 0.5f};
    REQUIRE(write_volume(volume, folder.path / "m.nii"));
    return *read_labels(folder.path / "m.nii");
  };
  CHECK(label_warns(soft(0.9882f), "no whole numbers, as 0.9882"));
  CHECK(label_warns(soft(2.0001f), "as 0.5"));  // one that rescaling left
  Volume whole;
  whole.geometry.dims = {3, 1, 1};
  whole.data = std::vector<float>{0, std::numeric_limits<float>::quiet_NaN(), 7};
  std::vector<std::string> warnings;
  warn_of_soft_labels("m", whole, 0, warnings);
  CHECK(warnings.empty());
}
