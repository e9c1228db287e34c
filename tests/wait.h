#pragma once

#include <chrono>
#include <thread>

namespace homolog::test {

/// Waits until `done`; false where that takes longer than a loaded machine needs, under a sanitizer too.
template <class Done>
bool wait_until(const Done& done) {
  const auto begin = std::chrono::steady_clock::now();
  while (!done()) {
    if (std::chrono::steady_clock::now() - begin > std::chrono::seconds(180)) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace homolog::test
