#pragma once

namespace homolog::test {

/// After so many further allocations of more than 512 bytes by `new`, none of them succeeds on this thread while the
/// object lives.
class MemoryEndsAfter {
 public:
  explicit MemoryEndsAfter(int allocations);
  ~MemoryEndsAfter();
  MemoryEndsAfter(const MemoryEndsAfter&) = delete;
  MemoryEndsAfter& operator=(const MemoryEndsAfter&) = delete;
};

}  // namespace homolog::test
