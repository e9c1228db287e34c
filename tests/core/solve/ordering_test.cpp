#include "core/solve/ordering.h"

#include <doctest/doctest.h>
#include <signal.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <numeric>
#include <thread>

#include "core/base/numbers/index.h"
#include "core/mesh/construction/icosphere.h"

using namespace homolog;

namespace {

SparsityGraph graph_of(const Topology& topology) {
  SparsityGraph graph{{0}, {}};
  for (Eigen::Index i = 0; i < topology.vertices(); ++i) {
    for (const std::int32_t j : topology.one_ring(i)) graph.neighbour.push_back(j);
    graph.start.push_back(static_cast<int>(graph.neighbour.size()));
  }
  return graph;
}

}  // namespace

TEST_CASE("an order of elimination numbers every unknown once") {
  const SparsityGraph graph = graph_of(*icosphere(3).topology);
  const Ordering ordering = nested_dissection(graph);
  std::vector<int> sorted = ordering.order;
  std::sort(sorted.begin(), sorted.end());
  std::vector<int> all(graph.start.size() - 1);
  std::iota(all.begin(), all.end(), 0);
  CHECK(sorted == all);
  for (const int i : all) CHECK(ordering.order[index(ordering.position[index(i)])] == i);
}

TEST_CASE("orders made at the same time as others and as anything that draws random numbers are the same") {
  const SparsityGraph graph = graph_of(*icosphere(4).topology);
  const Ordering alone = nested_dissection(graph);
  std::atomic<bool> done = false;
  std::atomic<int> different = 0;
  std::jthread draws([&] {  // as a graphics driver may
    while (!done) {
      std::srand(1);
      std::rand();
    }
  });
  std::srand(17);  // no matter what this thread did before
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 3; ++t) {
      threads.emplace_back([&] {
        for (int k = 0; k < 10; ++k) different += nested_dissection(graph) == alone ? 0 : 1;
      });
    }
  }
  done = true;
  CHECK(different == 0);
}

TEST_CASE("orders made at the same time leave the process its signal handlers") {
  const SparsityGraph graph = graph_of(*icosphere(4).topology);
  const auto handler = [](int) {};
  const auto before = std::signal(SIGTERM, handler);
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 3; ++t) {
      threads.emplace_back([&] {
        for (int k = 0; k < 16; ++k) nested_dissection(graph);
      });
    }
  }
  const bool kept = std::signal(SIGTERM, before) == static_cast<void (*)(int)>(handler);
  CHECK(kept);
}

TEST_CASE("an order leaves the process the flags of its signal handlers") {
  struct sigaction own {};
  own.sa_sigaction = [](int, siginfo_t*, void*) {};
  own.sa_flags = SA_SIGINFO | SA_RESTART;
  struct sigaction before {
  }, after{};
  REQUIRE(::sigaction(SIGTERM, &own, &before) == 0);
  nested_dissection(graph_of(*icosphere(2).topology));
  REQUIRE(::sigaction(SIGTERM, &before, &after) == 0);
  const bool same = after.sa_sigaction == own.sa_sigaction;
  CHECK(same);
  CHECK((after.sa_flags & (SA_SIGINFO | SA_RESTART)) == own.sa_flags);
  CHECK((after.sa_flags & (SA_RESETHAND | SA_NODEFER)) == 0);
}

#ifndef HOMOLOG_SANITIZED
TEST_CASE("an order leaves the random numbers of the process as they were") {
  const SparsityGraph graph = graph_of(*icosphere(3).topology);
  std::srand(17);
  const int first = std::rand(), second = std::rand();
  std::srand(17);
  CHECK(std::rand() == first);
  nested_dissection(graph);
  CHECK(std::rand() == second);
}
#endif
