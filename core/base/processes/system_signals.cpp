#include <signal.h>

#include <array>

#include "core/base/processes/signal_handlers.h"

namespace homolog {

namespace {

constexpr std::array kept_signals{SIGABRT, SIGTERM};

}  // namespace

struct KeptSignalHandlers::Kept {
  std::array<struct sigaction, kept_signals.size()> actions{};
};

KeptSignalHandlers::KeptSignalHandlers() : kept_(std::make_unique<Kept>()) {
  for (std::size_t k = 0; k < kept_signals.size(); ++k) ::sigaction(kept_signals[k], nullptr, &kept_->actions[k]);
}

KeptSignalHandlers::~KeptSignalHandlers() {
  for (std::size_t k = 0; k < kept_signals.size(); ++k) ::sigaction(kept_signals[k], &kept_->actions[k], nullptr);
}

}  // namespace homolog
