#pragma once

#include <memory>

namespace homolog {

/// Keeps what the process does on SIGABRT and SIGTERM, and puts it back at the end of its life: for a library that sets
/// handlers of its own meanwhile and gives the old ones back without their flags.
class KeptSignalHandlers {
 public:
  KeptSignalHandlers();
  ~KeptSignalHandlers();
  KeptSignalHandlers(const KeptSignalHandlers&) = delete;
  KeptSignalHandlers& operator=(const KeptSignalHandlers&) = delete;

 private:
  struct Kept;
  std::unique_ptr<Kept> kept_;
};

}  // namespace homolog
