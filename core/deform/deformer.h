#pragma once

#include <memory>

namespace homolog {

/// Keeps what is worth keeping between edits: the factorisation and the running gesture. Never changes a result.
class Deformer {
 public:
  Deformer();
  ~Deformer();
  Deformer(Deformer&&) noexcept;
  Deformer& operator=(Deformer&&) noexcept;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace homolog
