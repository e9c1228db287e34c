#pragma once

#include <atomic>

namespace homolog {

/// Shared between one worker, which reports and asks, and one observer, which shows and cancels. Any thread may call
/// any member.
class Progress {
 public:
  Progress() = default;
  /// Follows a part of a larger work, whose own progress outlives this one. The part is `share` of the whole, or of
  /// that part of it which is under way. The whole can cancel it too.
  Progress(Progress& whole, double share) : whole_(&whole), share_(static_cast<float>(share)) {}

  /// `fraction` of the work (or of its part) done, 0…1.
  void report(double fraction) {
    const float from = from_.load(std::memory_order_relaxed), to = to_.load(std::memory_order_relaxed);
    const float now = from + (to - from) * static_cast<float>(fraction);
    const float before = fraction_.exchange(now, std::memory_order_relaxed);
    if (whole_ != nullptr) whole_->grow(share_ * (now - before));
  }
  /// Makes reports from now on count for the part of the work between these fractions; 0 and 1: for the whole.
  void part(double from, double to) {
    from_.store(static_cast<float>(from), std::memory_order_relaxed);
    to_.store(static_cast<float>(to), std::memory_order_relaxed);
  }
  double fraction() const { return fraction_.load(std::memory_order_relaxed); }
  void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
  bool cancelled() const {
    return cancelled_.load(std::memory_order_relaxed) || (whole_ != nullptr && whole_->cancelled());
  }

 private:
  /// By what a part of it reports.
  void grow(float fraction) {
    const float more = fraction * (to_.load(std::memory_order_relaxed) - from_.load(std::memory_order_relaxed));
    fraction_.fetch_add(more, std::memory_order_relaxed);
    if (whole_ != nullptr) whole_->grow(share_ * more);
  }

  std::atomic<float> fraction_{0}, from_{0}, to_{1};
  std::atomic<bool> cancelled_{false};
  Progress* whole_ = nullptr;
  float share_ = 1;
};

}  // namespace homolog
