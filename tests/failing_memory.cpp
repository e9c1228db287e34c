#include "tests/failing_memory.h"

#include <cstdlib>
#include <new>

namespace {

constexpr long endless = -1;
/// The JSON library needs a few bytes even to give memory back; what ends first is room for large things.
constexpr std::size_t small_bytes = 512;
thread_local long allocations_left = endless;

}  // namespace

// All of this program's; those with an alignment of their own, and the C library's, stay.
void* operator new(std::size_t bytes) {
  if (bytes > small_bytes && allocations_left == 0) throw std::bad_alloc();
  if (bytes > small_bytes && allocations_left > 0) --allocations_left;
  if (void* memory = std::malloc(bytes > 0 ? bytes : 1)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  try {
    return operator new(bytes);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace homolog::test {

MemoryEndsAfter::MemoryEndsAfter(int allocations) {
  allocations_left = allocations;
}
MemoryEndsAfter::~MemoryEndsAfter() {
  allocations_left = endless;
}

}  // namespace homolog::test
