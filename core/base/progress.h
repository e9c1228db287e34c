#pragma once

#include <atomic>

namespace homolog {

/// Shared between one worker, which reports and asks, and one observer, which shows and cancels. Any thread may call
/// any member.
class Progress {
 public:
  /// `fraction` of the work done, 0…1.
  void report(double fraction) { fraction_.store(static_cast<float>(fraction), std::memory_order_relaxed); }
  double fraction() const { return fraction_.load(std::memory_order_relaxed); }
  void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
  bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

 private:
  std::atomic<float> fraction_{0};
  std::atomic<bool> cancelled_{false};
};

}  // namespace homolog
