#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <string>

#include "core/base/pictures/picture_io.h"
#include "core/base/text/text.h"
#include "core/model/files/statismo.h"
#include "core/model/shapes/study.h"
#include "core/session/case_file.h"
#include "tests/readers.h"

// Reads files, each by the reader of its ending, and does nothing else with them, so that a test can measure what
// readers take (tests/app/verbs/reader_budget_test.cpp). A line for each file: the most memory that this process or a
// child of it had meanwhile (bytes), the processor's time (seconds), the bytes of the values that are kept (−1:
// refused), and the sentence of a refusal. `--picture`: files behind it are read as pictures and not as slices.
using namespace homolog;

namespace {

namespace fs = std::filesystem;

Result<double> read_a_model(const fs::path& path) {
  const auto model = read_model(path);
  if (!model) return fail(model.error());
  return 8.0 * static_cast<double>(model->mean.size() + model->basis.size());
}

Result<double> read_a_case(const fs::path& path) {
  const auto read = read_case(path);
  if (!read) return fail(read.error());
  return 0.0;  // what it edits is no part of the file
}

Result<double> read_a_study(const fs::path& path) {
  const auto read = read_study(path);
  if (!read) return fail(read.error());
  return static_cast<double>(read->study.cases.size() * sizeof(StudyCase));
}

Result<double> read_a_picture(const fs::path& path) {
  const auto picture = read_picture(path);
  if (!picture) return fail(picture.error());
  return static_cast<double>(picture->rgba.size());
}

Result<double> read_by_ending(const fs::path& path, bool as_picture) {
  const std::string name = lower_case(path.filename().string());
  const auto ends = [&name](const char* ending) { return name.ends_with(ending); };
  if (as_picture) return read_a_picture(path);
  if (ends(".h5") || ends(".h5.json")) return read_a_model(path);
  if (ends(".homolog")) return read_a_case(path);
  if (ends(".study.json")) return read_a_study(path);
  if (ends(".json") || ends(".fcsv")) return test::read_some_landmarks(path);
  if (is_mesh_name(path)) return test::read_a_mesh(path);
  return test::read_a_volume(path);
}

/// The peak of this process since it was last set back, in bytes [proc(5), "VmHWM"].
double peak_bytes() {
  std::ifstream in("/proc/self/status");
  double kilobytes = -1;
  for (std::string line; std::getline(in, line);)
    if (std::sscanf(line.c_str(), "VmHWM: %lf kB", &kilobytes) == 1) break;
  return 1024 * kilobytes;
}

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

double processor_seconds() {
  double seconds = 0;
  for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage used{};
    ::getrusage(who, &used);
    seconds += seconds_of(used.ru_utime) + seconds_of(used.ru_stime);
  }
  return seconds;
}

}  // namespace

int main(int count, char** arguments) {
  bool as_picture = false;
  for (int k = 1; k < count; ++k) {
    if (arguments[k] == std::string("--picture")) {
      as_picture = true;
      continue;
    }
    ::malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << 5 << std::flush;  // the peak starts anew
    const double before = processor_seconds();
    const auto bytes = read_by_ending(arguments[k], as_picture);
    rusage children{};
    ::getrusage(RUSAGE_CHILDREN, &children);
    std::printf("%.0f %.3f %.0f %s\n", std::max(peak_bytes(), 1024.0 * static_cast<double>(children.ru_maxrss)),
                processor_seconds() - before, bytes ? *bytes : -1.0, bytes ? "" : bytes.error().sentence().c_str());
    std::fflush(stdout);
  }
  return 0;
}
