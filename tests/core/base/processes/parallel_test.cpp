#include "core/base/processes/parallel.h"

#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/thread_limit.h"

using namespace homolog;

namespace {

/// A sum range by range, in single precision: its bits depend on the ranges.
std::vector<float> range_sums(std::size_t count) {
  std::vector<float> sums(count);
  in_parallel(count, [&](std::size_t first, std::size_t last) {
    float sum = 0;
    for (std::size_t i = first; i < last; ++i) sums[i] = sum += 1.0f / static_cast<float>(i + 1);
  });
  return sums;
}

}  // namespace

TEST_CASE("ranges and with them sums are the same whatever the number of threads") {
  for (const std::size_t count : {0, 1, 63, 64, 65, 1000, 12345}) {
    std::vector<std::vector<float>> sums;
    for (const int threads : {1, 2, 7}) {
      const ThreadLimit limit(threads);
      sums.push_back(range_sums(count));
    }
    CHECK(sums[0] == sums[1]);
    CHECK(sums[0] == sums[2]);
  }
}

TEST_CASE("ranges cover everything once and are multiples of the grain") {
  std::vector<std::atomic<int>> seen(1000);
  in_parallel(
      1000,
      [&](int first, int last) {
        if (last < 1000) CHECK((last - first) % 48 == 0);
        for (int i = first; i < last; ++i) ++seen[static_cast<std::size_t>(i)];
      },
      48);
  for (const auto& count : seen) CHECK(count == 1);
}

TEST_CASE("loops within loops use no more threads than the limit") {
  for (const int threads : {1, 2, 4}) {
    const ThreadLimit limit(threads);
    std::atomic<int> working = 0, most = 0;
    for_each_in_parallel(6, [&](std::size_t) {
      for_each_in_parallel(6, [&](std::size_t) {
        const int now = ++working;
        for (int before = most; before < now && !most.compare_exchange_weak(before, now);) continue;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        --working;
      });
    });
    CHECK(most <= threads);
  }
}

TEST_CASE("pieces that nobody has begun are left out once one has thrown") {
  for (const int threads : {1, 3}) {
    const ThreadLimit limit(threads);
    std::atomic<int> begun = 0;
    const auto work = [&](std::size_t k) {
      ++begun;
      if (k == 2) throw std::runtime_error("broke");
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    };
    CHECK_THROWS_AS(for_each_in_parallel(200, work), std::runtime_error);
    CHECK(begun < 100);
  }
}

TEST_CASE("the exception of the first piece that throws is passed on") {
  const ThreadLimit limit(3);
  std::string caught;
  try {
    for_each_in_parallel(50, [](std::size_t k) {
      if (k % 10 == 7) throw std::runtime_error(std::to_string(k));
    });
  } catch (const std::runtime_error& error) {
    caught = error.what();
  }
  CHECK(caught == "7");
}
