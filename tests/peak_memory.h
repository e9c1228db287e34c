#pragma once

#include <doctest/doctest.h>

#include <cstdio>
#include <fstream>
#include <string>

namespace homolog {

/// The most memory that this process has had since the last reset, in bytes [proc(5), "VmHWM"]; fails the test where
/// the system does not say.
inline double peak_memory_bytes() {
  std::ifstream in("/proc/self/status");
  for (std::string line; std::getline(in, line);) {
    double kilobytes = 0;
    if (std::sscanf(line.c_str(), "VmHWM: %lf kB", &kilobytes) == 1) return kilobytes * 1024;
  }
  FAIL("the system does not say how much memory is taken (no VmHWM in /proc/self/status)");
  return 0;
}

/// How much more memory `work` takes at its peak than there was before, in bytes; fails the test where that cannot be
/// measured.
template <class Work>
double memory_taken_by(const Work& work) {
  std::ofstream reset("/proc/self/clear_refs");
  reset << 5 << std::flush;  // the peak starts anew
  REQUIRE_MESSAGE(reset, "the peak of memory cannot be measured anew (/proc/self/clear_refs is not writable)");
  const double before = peak_memory_bytes();
  work();
  return peak_memory_bytes() - before;
}

}  // namespace homolog
