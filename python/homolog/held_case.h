#pragma once

#include <atomic>
#include <string>
#include <utility>

#include "core/session/session.h"

namespace homolog::python {

/// A case that Python holds.
struct HeldCase {
  HeldCase(EditSession held_session, std::string file) : session(std::move(held_session)), source(std::move(file)) {}

  EditSession session;
  std::string source;               ///< its file; empty: it has none
  std::atomic<bool> in_use{false};  ///< a call is at work on it, which may run without the interpreter's lock
};

}  // namespace homolog::python
