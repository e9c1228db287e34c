#pragma once

#include <fstream>
#include <string>

namespace homolog {

/// "VmRSS:" or "VmHWM:" of this process in MB; 0 where the system does not say.
inline double memory_mb(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kb = 0;
    if (word == key && status >> kb) return kb / 1000;
  }
  return 0;
}

/// "VmHWM:" starts anew.
inline void forget_peak_memory() {
  std::ofstream("/proc/self/clear_refs") << 5;
}

}  // namespace homolog
