#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

#include "core/volume/dicom/dicom_clocks.h"
#include "core/volume/volume_io.h"
#include "tests/core/volume/dicom_slices.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

// Series whose files say in many ways how they belong together, or that they do not.
namespace fs = std::filesystem;
using namespace homolog;

namespace {

constexpr std::uint32_t image_type = 0x00080008, instance_uid = 0x00080018, acquisition_date = 0x00080022,
                        acquisition_time = 0x00080032, content_time = 0x00080033, slice_thickness = 0x00180050,
                        inversion_time = 0x00180082, echo_time = 0x00180081, spacing_between = 0x00180088,
                        frame_time = 0x00181063, flip_angle = 0x00181314, b_value = 0x00189087,
                        acquisition_number = 0x00200012, frame_of_reference = 0x00200052,
                        temporal_position = 0x00200100, increment_pointer = 0x00280009,
                        frame_reference_time = 0x00541300;

std::string fd_bytes(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  return little_endian(static_cast<std::uint32_t>(bits), 4) + little_endian(static_cast<std::uint32_t>(bits >> 32), 4);
}

/// Writes slices, whose pixels hold their number, under names that tell nothing of the order, and reads them.
/// `describe` gives the k-th of them what it is to say.
Result<VolumeRead> read_described(int count, const std::function<void(Slice&, int)>& describe) {
  const TemporaryFolder folder;
  for (int k = 0; k < count; ++k) {
    Slice slice;
    slice.modality = "MR";
    slice.instance = count - k;
    std::fill(slice.pixels.begin(), slice.pixels.end(), static_cast<std::int16_t>(k));
    describe(slice, k);
    write_bytes(folder.path / (std::to_string((7 * k + 3) % 31) + ".dcm"), slice.bytes());
  }
  return read_volume(folder.path);
}

/// The numbers of the slices in the order in which they became frames.
std::vector<int> dicom_frames_of(const Result<VolumeRead>& read) {
  if (!read) FAIL(read.error().sentence());
  std::vector<int> order;
  for (int frame = 0; frame < read->volume.frames; ++frame)
    order.push_back(static_cast<int>(read->volume.at(0, 0, 0, frame)));
  return order;
}

bool dicom_warns(const Result<VolumeRead>& read, const std::string& what) {
  return read && std::any_of(read->warnings.begin(), read->warnings.end(),
                             [&](const std::string& warning) { return warning.find(what) != std::string::npos; });
}

const std::vector<int> in_their_order{0, 1, 2};

/// Three frames at one place, which say their time by the tag.
Result<VolumeRead> read_times(std::uint32_t tag, const std::string& type, const std::vector<std::string>& times,
                              bool numbers_agree = false) {
  return read_described(3, [&](Slice& slice, int k) {
    if (numbers_agree) slice.instance = k;
    if (const auto& time = times[static_cast<std::size_t>(k)]; !time.empty()) slice.put(tag, type, time);
  });
}

}  // namespace

TEST_CASE("a time of 0 is a time by whatever tag frames give it") {
  const auto trigger = read_described(3, [](Slice& slice, int k) {
    slice.trigger_ms = 40.0 * k;
    slice.put(acquisition_time, "TM", "101530.25");
  });
  CHECK(dicom_frames_of(trigger) == in_their_order);
  CHECK(trigger->volume.frame_seconds == doctest::Approx(0.04));
  CHECK(trigger->warnings.size() == 1);  // no slice thickness
  CHECK(dicom_frames_of(read_times(temporal_position, "IS", {"0", "1", "2"})) == in_their_order);
  const auto reference = read_times(frame_reference_time, "DS", {"0", "2000", "5000"});
  CHECK(dicom_frames_of(reference) == in_their_order);
  CHECK(reference->volume.frame_seconds == doctest::Approx(2));
  CHECK(dicom_frames_of(read_times(acquisition_time, "TM", {"000000", "000001", "000002.5"})) == in_their_order);
  CHECK(dicom_frames_of(read_times(content_time, "TM", {"000000.00", "000000.10", "000000.20"})) == in_their_order);
}

TEST_CASE("clock times are read as hours and minutes and seconds") {
  const auto minutes = read_times(acquisition_time, "TM", {"095958", "095959.5", "100001"});
  CHECK(dicom_frames_of(minutes) == in_their_order);
  CHECK(minutes->volume.frame_seconds == doctest::Approx(1.5));
  CHECK(ms_of_day("13") == 13 * 3'600'000.0);
  CHECK(ms_of_day("0102") == 3'720'000.0);
  CHECK(ms_of_day("01:02:03.5") == 3'723'500.0);
  for (const char* none : {"", "1", "240000", "126000", "12x000", "-10000", "120000.1x"}) {
    CAPTURE(std::string(none));
    CHECK(!ms_of_day(none));
  }
  CHECK(*days_of_date("20240301") - *days_of_date("20240228") == 2);
  CHECK(days_of_date("1997.08.22") == days_of_date("19970822"));
  for (const char* none : {"", "00000000", "20240230", "2024", "2024030x"}) CHECK(!days_of_date(none));
}

TEST_CASE("frames that pass midnight keep their order") {
  for (const std::uint32_t tag : {acquisition_time, content_time}) {
    const auto read = read_times(tag, "TM", {"235959", "000000", "000001"});
    CHECK(dicom_frames_of(read) == in_their_order);
    CHECK(dicom_warns(read, "midnight") == (tag == acquisition_time));
    if (tag == acquisition_time) CHECK(read->volume.frame_seconds == doctest::Approx(1));
  }
  const auto dated = read_described(3, [](Slice& slice, int k) {
    slice.put(acquisition_date, "DA", k == 0 ? "20231231" : "20240101");
    slice.put(acquisition_time, "TM",
              std::vector<std::string>{"235959", "000001", "130000"}[static_cast<std::size_t>(k)]);
  });
  CHECK(dicom_frames_of(dated) == in_their_order);
  CHECK(dated->volume.frame_seconds == doctest::Approx(2));
  CHECK(!dicom_warns(dated, "midnight"));
  const auto undated = read_described(3, [](Slice& slice, int k) {  // the date of all is the day's beginning
    slice.put(acquisition_date, "DA", "20231231");
    slice.put(acquisition_time, "TM",
              std::vector<std::string>{"235958", "235959", "000002"}[static_cast<std::size_t>(k)]);
  });
  CHECK(dicom_frames_of(undated) == in_their_order);
  CHECK(dicom_frames_of(read_times(acquisition_time, "TM", {"080000", "120000", "170000"})) == in_their_order);
}

TEST_CASE("a time that some slices lack does not order the frames") {
  const auto read = read_described(3, [](Slice& slice, int k) {
    slice.instance = k;
    if (k > 0) slice.trigger_ms = 100.0 - 40 * k;  // the wrong way
    slice.put(acquisition_time, "TM", "101530.25");
  });
  CHECK(dicom_frames_of(read) == in_their_order);
  CHECK(dicom_warns(read, "only some of its slices give a trigger time"));
  CHECK(dicom_warns(read, "in the order of their numbers"));
  CHECK(read->volume.frame_seconds == 0);
}

TEST_CASE("equal times leave the order to the next clock and then to the numbers") {
  const auto clock = read_described(3, [](Slice& slice, int k) {
    slice.trigger_ms = 0;
    slice.put(acquisition_time, "TM", "10153" + std::to_string(k));
  });
  CHECK(dicom_frames_of(clock) == in_their_order);
  CHECK(clock->volume.frame_seconds == doctest::Approx(1));
  const auto numbers = read_described(3, [](Slice& slice, int k) {
    slice.trigger_ms = 0;
    slice.instance = k + 9;  // as numbers, not as text
  });
  CHECK(dicom_frames_of(numbers) == in_their_order);
  CHECK(dicom_warns(numbers, "give no times"));
  const auto two_alike = read_described(3, [](Slice& slice, int k) {
    slice.trigger_ms = k < 2 ? 0 : 40;
    slice.instance = k;
  });
  CHECK(dicom_frames_of(two_alike) == in_their_order);
}

TEST_CASE("a count of moments goes before times within the heart beat") {
  const auto perfusion = read_described(3, [](Slice& slice, int k) {
    slice.put(temporal_position, "IS", std::to_string(k + 1));
    slice.trigger_ms = std::vector<double>{101, 99, 100}[static_cast<std::size_t>(k)];
  });
  CHECK(dicom_frames_of(perfusion) == in_their_order);
}

TEST_CASE("slices of two echo times or in two spaces are refused with both") {
  const auto echoes = read_described(4, [](Slice& slice, int k) {
    slice.z = 2.5 * (k % 2);
    slice.put(echo_time, "DS", k < 2 ? "2.3" : "4.6");
    slice.trigger_ms = 10 * k;
  });
  CHECK(says(echoes, "echo times (2.3 and 4.6 ms)"));
  const auto spaces = read_described(4, [](Slice& slice, int k) {
    slice.z = 2.5 * k;
    slice.put(frame_of_reference, "UI", k < 2 ? "1.2.3" : "1.2.4");
  });
  CHECK(says(spaces, "frames of reference"));
  const auto one_space = read_described(4, [](Slice& slice, int k) {
    slice.z = 2.5 * k;
    if (k < 2) slice.put(frame_of_reference, "UI", "1.2.3");
    slice.put(echo_time, "DS", "2.3");
  });
  CHECK(one_space);
}

TEST_CASE("images of one place that differ in what is no time are refused by what differs") {
  struct Difference {
    std::uint32_t tag;
    const char* type;
    std::string one, other;
    const char* named;
  };
  for (const Difference& d : {Difference{image_type, "CS", "ORIGINAL\\PRIMARY\\M", "ORIGINAL\\PRIMARY\\P",
                                         "image types (ORIGINAL\\PRIMARY\\M"},
                              Difference{flip_angle, "DS", "5", "20", "flip angles (5 and 20)"},
                              Difference{inversion_time, "DS", "100", "900", "inversion times"},
                              Difference{b_value, "FD", fd_bytes(0), fd_bytes(1000), "b-values (0 and 1000)"},
                              Difference{acquisition_number, "IS", "1", "2", "acquisitions (number 1 and number 2)"}}) {
    CAPTURE(std::string(d.named));
    const auto describe = [&](Slice& slice, int k) {
      slice.z = 2.5 * (k / 2);
      slice.instance = k;
      slice.put(d.tag, d.type, k % 2 == 0 ? d.one : d.other);
    };
    const auto refused = read_described(4, describe);
    CHECK(says(refused, d.named));
    CHECK(says(refused, "keep the slices of one"));
    const auto in_time = read_described(4, [&](Slice& slice, int k) {
      describe(slice, k);
      slice.put(temporal_position, "IS", std::to_string(k % 2));
    });
    CHECK(dicom_frames_of(in_time) == std::vector<int>{0, 1});
    const auto made_later = read_described(4, [&](Slice& slice, int k) {
      describe(slice, k);
      slice.put(content_time, "TM", "10000" + std::to_string(k % 2));
    });
    CHECK(made_later.has_value() == (d.tag == acquisition_number));  // dynamic scans count their moments so
    const auto each_place_its_own = read_described(2, [&](Slice& slice, int k) {
      describe(slice, k);
      slice.z = 2.5 * k;
    });
    CHECK(each_place_its_own);
  }
}

TEST_CASE("slices that are there twice are read once") {
  const auto saved = [](const fs::path& folder, const std::string& name, Slice slice, int k) {
    slice.z = 2.5 * k;
    slice.instance = k;
    slice.put(instance_uid, "UI", "1.2.3." + std::to_string(k));
    std::fill(slice.pixels.begin(), slice.pixels.end(), static_cast<std::int16_t>(k));
    write_bytes(folder / name, slice.bytes());
  };
  const TemporaryFolder folder;
  for (int k = 0; k < 3; ++k) {
    saved(folder.path, std::to_string(k) + ".dcm", {}, k);
    if (k != 1) saved(folder.path, std::to_string(k) + " (1).dcm", {}, k);
  }
  const auto read = read_volume(folder.path);
  REQUIRE_MESSAGE(read, read.error().sentence());
  CHECK(read->volume.frames == 1);
  CHECK(read->volume.geometry.dims[2] == 3);
  CHECK(read->volume.at(0, 0, 2) == 2);
  CHECK(dicom_warns(read, "holds 2 slices twice"));
  CHECK(dicom_warns(read, "0.dcm is a copy of 0 (1).dcm"));
  Slice remade;  // a header that was written anew
  remade.description = "copied by another program";
  saved(folder.path, "1 (1).dcm", remade, 1);
  CHECK(read_volume(folder.path)->volume.frames == 1);
}

TEST_CASE("copies that nothing tells apart but that are no copies are refused") {
  const auto twice = read_described(4, [](Slice& slice, int k) {  // without an identifier
    slice.z = 2.5 * (k % 2);
    slice.instance = k % 2;
  });
  CHECK(says(twice, "nothing tells them apart"));
  const auto other_pixels = read_described(4, [](Slice& slice, int k) {
    slice.z = 2.5 * (k % 2);
    slice.instance = k % 2;
    slice.put(instance_uid, "UI", "1.2.3." + std::to_string(k % 2));
  });
  CHECK(says(other_pixels, "nothing tells them apart"));
}

TEST_CASE("slices that share one identifier by careless anonymising are all kept") {
  const auto slices = read_described(3, [](Slice& slice, int k) {
    slice.z = 2.5 * k;
    slice.put(instance_uid, "UI", "1.2.3");
    std::fill(slice.pixels.begin(), slice.pixels.end(), std::int16_t{7});
  });
  REQUIRE(slices);
  CHECK(slices->volume.geometry.dims[2] == 3);
  CHECK(slices->warnings.empty());
  const auto frames = read_described(3, [](Slice& slice, int k) {
    slice.put(instance_uid, "UI", "1.2.3");
    slice.trigger_ms = 40 * k;
    std::fill(slice.pixels.begin(), slice.pixels.end(), std::int16_t{7});
  });
  REQUIRE(frames);
  CHECK(frames->volume.frames == 3);
}

TEST_CASE("a slice that lies to the side is named with how far") {
  for (const int odd : {0, 3, 5}) {
    CAPTURE(odd);
    const auto read = read_described(6, [&](Slice& slice, int k) {
      slice.z = 2.5 * k;
      slice.x = k == odd ? 8 : 0;
    });
    CHECK(says(read, "shifted sideways"));
    CHECK(says(read, std::to_string((7 * odd + 3) % 31) + ".dcm"));
    CHECK(says(read, "8.00 mm to the side"));
  }
  const auto zigzag = read_described(6, [](Slice& slice, int k) {
    slice.z = 2.5 * k;
    slice.y = k % 2 == 0 ? 0 : 5;
  });
  CHECK(says(zigzag, "shifted sideways"));
  const auto frame = read_described(4, [](Slice& slice, int k) {
    slice.z = 2.5 * (k % 2);
    slice.x = k == 2 ? 8 : 0;
    slice.trigger_ms = 40 * (k / 2);
  });
  CHECK(says(frame, "shifted sideways"));
  const auto side_by_side = read_described(2, [](Slice& slice, int k) { slice.x = 100 * k; });
  CHECK(says(side_by_side, "shifted sideways"));
  const auto tilted = read_described(6, [](Slice& slice, int k) {
    slice.z = 2.5 * k;
    slice.y = 0.4 * k;
  });
  CHECK(says(tilted, "tilted gantry"));
  const auto little = read_described(6, [](Slice& slice, int k) {  // less than half a pixel of 0.25 mm
    slice.z = 2.5 * k;
    slice.y = k == 3 ? 0.1 : 0;
  });
  CHECK(little);
}

namespace {

/// Slices at multiples of `step` along the normal, with every coordinate rounded.
Result<VolumeRead> read_rounded(const std::string& orientation, const Vec3& step, int count, int left_out = -1) {
  return read_described(count, [&](Slice& slice, int k) {
    const Vec3 exact = step * (k + (left_out >= 0 && k >= left_out ? 1 : 0));
    slice.orientation = orientation;
    std::string text;
    for (const double coordinate : exact) {
      char number[32];
      std::snprintf(number, sizeof number, "%s%.1f", text.empty() ? "" : "\\", coordinate);
      text += number;
    }
    slice.put(0x00200032, "DS", text);
  });
}

}  // namespace

TEST_CASE("places that are rounded to tenths of a millimetre are read") {
  const std::string axial = "1\\0\\0\\0\\1\\0", oblique = "0.707107\\-0.707107\\0\\0.408248\\0.408248\\-0.816497";
  const auto rounded = read_rounded(axial, Vec3(0, 0, 7.6 / 3), 4);
  REQUIRE_MESSAGE(rounded, rounded.error().sentence());
  CHECK(rounded->volume.geometry.spacing_mm[2] == doctest::Approx(7.6 / 3));
  const Vec3 normal = Vec3::Ones().normalized();
  for (const double step : {0.35, 1.2345, 2.5333, 3.3}) {
    CAPTURE(step);
    const auto turned = read_rounded(oblique, step * normal, 30);
    REQUIRE_MESSAGE(turned, turned.error().sentence());
    CHECK(turned->volume.geometry.dims[2] == 30);
    CHECK(turned->volume.geometry.spacing_mm[2] == doctest::Approx(step).epsilon(0.02));
  }
  const auto thin = read_rounded(axial, Vec3(0, 0, 0.25), 11);
  REQUIRE_MESSAGE(thin, thin.error().sentence());
  CHECK(thin->volume.geometry.spacing_mm[2] == doctest::Approx(0.25));
  CHECK(says(read_rounded(axial, Vec3(0, 0, 7.6 / 3), 12, 5), "lacks slices"));
  CHECK(says(read_rounded(oblique, 1.5 * normal, 12, 5), "lacks slices"));
  CHECK(says(read_rounded(axial, Vec3(0, 0, 0.3), 12, 5), "lacks slices"));
}

TEST_CASE("planes of one file with one position are a stack where it says how far they lie apart") {
  Slice slice;
  slice.frames = "3";
  slice.z = 10;
  slice.pixels = {0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2};
  slice.put(slice_thickness, "DS", "4");
  const auto neither = read_slice(slice);
  CHECK(says(neither, "one position for its 3 planes"));
  slice.put(spacing_between, "DS", "2.5");
  const auto stack = read_slice(slice);
  REQUIRE_MESSAGE(stack, stack.error().sentence());
  CHECK(stack->volume.frames == 1);
  CHECK(stack->volume.geometry.dims[2] == 3);
  CHECK(stack->volume.geometry.spacing_mm[2] == doctest::Approx(2.5));
  CHECK(stack->volume.geometry.origin_mm[2] == doctest::Approx(10));
  CHECK(stack->volume.at(0, 0, 2) == 2);
  slice.put(spacing_between, "DS", "-2.5");  // against the normal
  const auto reversed = read_slice(slice);
  REQUIRE(reversed);
  CHECK(reversed->volume.geometry.origin_mm[2] == doctest::Approx(5));
  CHECK(reversed->volume.at(0, 0, 0) == 2);
  slice.put(frame_time, "DS", "40");
  slice.put(increment_pointer, "AT", little_endian(0x0018, 2) + little_endian(0x1063, 2));
  const auto cine = read_slice(slice);
  REQUIRE(cine);
  CHECK(cine->volume.frames == 3);
  CHECK(cine->volume.frame_seconds == doctest::Approx(0.04));
  slice.more.erase(frame_time);
  slice.put(0x00181065, "DS", "0\\50\\50");
  slice.put(increment_pointer, "AT", little_endian(0x0018, 2) + little_endian(0x1065, 2));
  CHECK(read_slice(slice)->volume.frame_seconds == doctest::Approx(0.05));
}

TEST_CASE("frames of an enhanced file at one position are ordered by their own times") {
  Slice slice;
  slice.frames = "3";
  slice.pixels = {0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2};
  const auto delays = [](std::initializer_list<double> ms) {
    std::string frames;
    for (const double delay : ms)
      frames += item(sequence(0x00189118, item(element(0x00209153, "FD", fd_bytes(delay)))));
    return sequence(0x52009230, frames);
  };
  slice.put(spacing_between, "DS", "2.5");
  slice.before_pixels = delays({80, 0, 40});
  const auto read = read_slice(slice);
  CHECK(dicom_frames_of(read) == std::vector<int>{1, 2, 0});
  CHECK(read->volume.frame_seconds == doctest::Approx(0.04));
  const auto echoes = [](std::initializer_list<double> ms) {
    std::string frames;
    for (const double echo : ms) frames += item(sequence(0x00189114, item(element(0x00189082, "FD", fd_bytes(echo)))));
    return sequence(0x52009230, frames);
  };
  slice.before_pixels = echoes({2.3, 4.6, 6.9});
  CHECK(says(read_slice(slice), "echo times (2.3 and 4.6 ms)"));
}

TEST_CASE("planes of nuclear medicine that are no stack are refused by what they are of") {
  Slice slice;
  slice.frames = "3";
  slice.orientation = "";
  slice.pixels.resize(18);
  slice.put(spacing_between, "DS", "2.5");
  const auto vector = [](std::initializer_list<std::uint32_t> values) {
    std::string bytes;
    for (const std::uint32_t value : values) bytes += little_endian(value, 2);
    return bytes;
  };
  slice.put(increment_pointer, "AT", vector({0x0054, 0x0070, 0x0054, 0x0080}));
  slice.put(0x00540080, "US", vector({1, 2, 3}));
  slice.put(0x00540070, "US", vector({1, 1, 1}));
  const auto stack = read_slice(slice);
  REQUIRE_MESSAGE(stack, stack.error().sentence());
  CHECK(stack->volume.geometry.dims[2] == 3);
  slice.put(0x00540070, "US", vector({1, 2, 2}));
  CHECK(says(read_slice(slice), "several time slots"));
}

TEST_CASE("a table of values in place of a slope is refused") {
  Slice slice;
  const std::string table =
      element(0x00283002, "US", little_endian(16, 2) + little_endian(300, 2) + little_endian(16, 2)) +
      element(0x00283006, "OW", std::string(32, '\1'));
  slice.before_pixels = sequence(0x00283000, item(table));
  CHECK(says(read_slice(slice), "Modality LUT"));
  slice.before_pixels = sequence(0x00283000, "");
  CHECK(read_slice(slice));
}

namespace {

/// A value that grows evenly in space.
double ramp(const Vec3& p) {
  return 100 + 8 * p.x() - 4 * p.y() + 2 * p.z();
}

/// Slices at the places, whose pixels hold the ramp, resampled.
Result<VolumeRead> read_ramp(const std::vector<Vec3>& places) {
  const TemporaryFolder folder;
  for (std::size_t s = 0; s < places.size(); ++s) {
    Slice slice;
    slice.x = places[s].x();
    slice.y = places[s].y();
    slice.z = places[s].z();
    for (int p = 0; p < 6; ++p)
      slice.pixels[static_cast<std::size_t>(p)] =
          static_cast<std::int16_t>(std::lround(ramp(places[s] + Vec3(0.25 * (p % 3), 0.5 * (p / 3), 0))));
    write_bytes(folder.path / (std::to_string(s) + ".dcm"), slice.bytes());
  }
  VolumeReadOptions options;
  options.resample = true;
  return read_volume(folder.path, options);
}

/// How many rows of voxels of a slice hold the ramp; the other voxels hold the least of all values.
std::vector<int> rows_on_ramp(const Volume& volume) {
  std::vector<int> rows;
  const auto& dims = volume.geometry.dims;
  for (int k = 0; k < dims[2]; ++k) {
    rows.push_back(0);
    for (int j = 0; j < dims[1]; ++j) {
      int held = 0;
      for (int i = 0; i < dims[0]; ++i) {
        const bool holds = std::abs(volume.at(i, j, k) - ramp(volume.geometry.to_mm(Vec3(i, j, k)))) < 1e-3;
        if (!holds) CHECK(volume.at(i, j, k) == volume.range_min);
        held += holds ? 1 : 0;
      }
      rows.back() += held == dims[0] ? 1 : 0;
    }
  }
  return rows;
}

}  // namespace

TEST_CASE("tilted slices are resampled to a rectangular grid where asked and a ramp stays one") {
  std::vector<Vec3> places;
  for (int s = 0; s < 4; ++s) places.emplace_back(3, 1 + 0.75 * s, -2 + 2.5 * s);
  const auto read = read_ramp(places);
  if (!read) FAIL(read.error().sentence());
  const VolumeGeometry& grid = read->volume.geometry;
  CHECK(grid.dims == std::array{3, 2 + 5, 4});
  CHECK(grid.spacing_mm.isApprox(Vec3(0.25, 0.5, 2.5), 1e-9));
  CHECK(grid.origin_mm.isApprox(Vec3(3, 1, -2), 1e-9));
  CHECK(rows_on_ramp(read->volume) == std::vector{2, 1, 2, 1});  // every other slice lies between rows
  REQUIRE(read->resampled);
  CHECK(read->resampled->why.find("tilted gantry") != std::string::npos);
  CHECK(read->resampled->from_slices == 4);
  CHECK(read->resampled->shifted_mm == doctest::Approx(2.25));
  REQUIRE(dicom_warns(read, "4 slices were resampled to a rectangular grid of 4, 2.50 mm apart"));
}

TEST_CASE("unevenly spaced slices are resampled where asked by the median of their distances") {
  std::vector<Vec3> places;
  for (const double z : {0.0, 2.0, 4.0, 7.0, 9.0, 14.0}) places.emplace_back(0, 0, z);
  const auto read = read_ramp(places);
  if (!read) FAIL(read.error().sentence());
  CHECK(read->volume.geometry.dims == std::array{3, 2, 8});
  CHECK(read->volume.geometry.spacing_mm.z() == doctest::Approx(2));
  CHECK(rows_on_ramp(read->volume) == std::vector<int>(8, 2));
  REQUIRE(read->resampled);
  CHECK(read->resampled->least_mm == doctest::Approx(2));
  CHECK(read->resampled->most_mm == doctest::Approx(5));
  CHECK(read->resampled->why.find("lie") != std::string::npos);
  const auto even = read_ramp({{0, 0, 0}, {0, 0, 2}, {0, 0, 4}});
  if (!even) FAIL(even.error().sentence());
  CHECK_FALSE(even->resampled);
  CHECK(std::string(voxel_type_name(even->volume.data)) == "int16");
}
