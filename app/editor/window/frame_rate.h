#pragma once

#include <deque>
#include <optional>

namespace homolog {

/// How many pictures a second are drawn, counted over the last second. Nothing is said before a third of a second was
/// drawn without a stop, nor when drawing has stopped: a window at rest draws nothing.
class FrameRate {
 public:
  /// A picture is drawn at this second of the window's clock. Gives what to say in it: pictures a second, or 0.
  double drawn(double now) {
    if (!times_.empty() && now - times_.back() > stop_seconds) times_.clear();
    times_.push_back(now);
    while (now - times_.front() > 1) times_.pop_front();
    const double seconds = now - times_.front();
    said_ = seconds >= least_seconds ? static_cast<double>(times_.size() - 1) / seconds : 0;
    return said_;
  }
  /// When the last picture, which speaks of a rate, is no longer true; nothing where it speaks of none.
  std::optional<double> ends_at() const {
    return said_ > 0 ? std::optional(times_.back() + stop_seconds) : std::nullopt;
  }

 private:
  static constexpr double least_seconds = 0.3, stop_seconds = 0.25;
  std::deque<double> times_;
  double said_ = 0;
};

}  // namespace homolog
