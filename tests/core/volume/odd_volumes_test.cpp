#include <doctest/doctest.h>

#include <algorithm>

#include "core/volume/labels/read_labels.h"
#include "core/volume/volume_io.h"
#include "tests/real_data.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

// Honest files that say in an odd way what they hold, as other programs wrote them.
namespace fs = std::filesystem;
using namespace homolog;

namespace {

Volume odd_volume(const fs::path& path) {
  auto result = read_volume(path);
  if (!result) FAIL(result.error().sentence());
  return std::move(result->volume);
}

}  // namespace

TEST_CASE("odd volumes of other programs are read as they are meant or refused") {
  const fs::path folder = real_data() / "odd";
  if (!fs::is_directory(folder)) return;
  for (const char* cine : {"cine_trigger0", "cine_midnight"}) {
    CAPTURE(std::string(cine));
    const Volume volume = odd_volume(folder / cine);
    REQUIRE(volume.frames == 3);
    for (int frame = 0; frame < 3; ++frame) CHECK(volume.at(0, 0, 0, frame) == 1000 * frame);
  }
  CHECK(odd_volume(folder / "units_m.nrrd").geometry.spacing_mm == Vec3(1, 1, 1));
  const Volume twice = odd_volume(folder / "every_slice_twice");
  CHECK(twice.frames == 1);
  CHECK(twice.geometry.dims[2] == 3);
  const Volume stack = odd_volume(folder / "multiframe_one_position.dcm");
  CHECK(stack.frames == 1);
  CHECK(stack.geometry.dims[2] == 6);
  CHECK(stack.geometry.spacing_mm[2] == doctest::Approx(2.5));
  CHECK(says(read_volume(folder / "dual_echo"), "echo times (2.3 and 4.6 ms)"));
  CHECK(says(read_volume(folder / "slice_shifted_sideways"), "shifted sideways"));
  CHECK(says(read_volume(folder / "two_frames_of_reference"), "frames of reference"));
  CHECK(says(read_volume(folder / "modality_lut.dcm"), "Modality LUT"));
  CHECK(odd_volume(folder / "positions_rounded_to_0.1").geometry.spacing_mm[2] == doctest::Approx(7.6 / 3));
  const Volume rescaled = odd_volume(folder / "intensity_function.mha");
  CHECK(rescaled.range_min == -5);
  CHECK(rescaled.range_max == 9);
  auto layers = read_labels(folder / "overlap.seg.nrrd");
  REQUIRE(layers);
  CHECK(layers->volume.frames == 1);
  CHECK(labels_of(layers->volume).contains(1));
  REQUIRE(choose_segments("overlap", "2", *layers));
  CHECK(labels_of(layers->volume).contains(2));
  const TemporaryFolder own;
  const Volume far = odd_volume(folder / "far_origin.nrrd");
  REQUIRE(write_volume(far, own.path / "far.nii"));
  CHECK(odd_volume(own.path / "far.nii").geometry.origin_mm == far.geometry.origin_mm);
}
