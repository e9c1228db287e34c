#include <doctest/doctest.h>

#include <algorithm>

#include "core/volume/volume_io.h"
#include "tests/cpu_time.h"
#include "tests/peak_memory.h"
#include "tests/real_data.h"

// Files that have crashed, hung or misled a reader of images.
namespace fs = std::filesystem;
using namespace homolog;

TEST_CASE("hostile image files are refused with a sentence and in bounded memory and time") {
  const fs::path data = real_data();
  if (data.empty()) return;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(data / "hostile"))
    if (looks_like_volume(entry.path())) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  CHECK(files.size() >= 18);
  VolumeReadOptions options;
  options.stack_spacing_mm = Vec3(1, 1, 1);
  for (const fs::path& file : files) {
    CAPTURE(file.string());
    const auto refuse = [&] {
      const auto read = read_volume(file, options);
      CHECK(!read);
      if (!read) CHECK(read.error().sentence().starts_with(file.string() + ": "));
    };
    double taken = 0;
    const double seconds = test::cpu_seconds_of([&] { taken = memory_taken_by(refuse); });
    CHECK(taken < 300e6);
    CHECK(seconds < 20);
  }
}
