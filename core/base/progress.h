#pragma once

#include <atomic>

namespace homolog {

/// Shared between one worker, which reports and asks, and one observer, which shows and cancels. Any thread may call
/// any member.
class Progress {
 public:
  /// `fraction` of the work (or of its part) done, 0…1.
  void report(double fraction) {
    const float from = from_.load(std::memory_order_relaxed), to = to_.load(std::memory_order_relaxed);
    fraction_.store(from + (to - from) * static_cast<float>(fraction), std::memory_order_relaxed);
  }
  /// What is reported from now on counts for the part of the work between these fractions; 0 and 1: for the whole.
  void part(double from, double to) {
    from_.store(static_cast<float>(from), std::memory_order_relaxed);
    to_.store(static_cast<float>(to), std::memory_order_relaxed);
  }
  double fraction() const { return fraction_.load(std::memory_order_relaxed); }
  void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
  bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

 private:
  std::atomic<float> fraction_{0}, from_{0}, to_{1};
  std::atomic<bool> cancelled_{false};
};

}  // namespace homolog
