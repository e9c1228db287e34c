#pragma once

#include <cstdio>
#include <fstream>
#include <string>

namespace homolog {

/// The most memory that this process has had since the last reset, in bytes [proc(5), "VmHWM"]; 0 where the system does
/// not say.
inline double peak_memory_bytes() {
  std::ifstream in("/proc/self/status");
  for (std::string line; std::getline(in, line);) {
    double kilobytes = 0;
    if (std::sscanf(line.c_str(), "VmHWM: %lf kB", &kilobytes) == 1) return kilobytes * 1024;
  }
  return 0;
}

/// How much more memory `work` takes at its peak than there was before, in bytes.
template <class Work>
double memory_taken_by(const Work& work) {
  std::ofstream("/proc/self/clear_refs") << 5;  // the peak starts anew
  const double before = peak_memory_bytes();
  work();
  return peak_memory_bytes() - before;
}

}  // namespace homolog
