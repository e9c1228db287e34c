#pragma once

#include <cstdio>
#include <string>

namespace homolog::test {

/// Says on a line of its own that a test, or the rest of it, is not run; the test returns then. ctest counts it as
/// skipped, and scripts/test.sh fails where the reason is anything else than real data that is not there.
inline void skip(const std::string& reason) {
  std::printf("SKIPPED: %s\n", reason.c_str());
  std::fflush(stdout);
}

}  // namespace homolog::test
