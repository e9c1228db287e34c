#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"

namespace homolog {

/// Writes files on a thread of its own, one after the other; none is dropped. Called from the window's thread only.
class Exports {
 public:
  using Write = std::function<Result<void>(Progress&)>;
  struct Running {
    std::filesystem::path path;
    double fraction = 0, seconds = 0;
  };
  struct Written {
    std::filesystem::path path;
    Result<void> result;
    bool cancelled = false;
  };

  /// `wake` is called from the thread when a file is done.
  explicit Exports(std::function<void()> wake);
  /// Finishes what is asked for.
  ~Exports();
  Exports(const Exports&) = delete;
  Exports& operator=(const Exports&) = delete;

  /// `write` gets all that it needs with it.
  void start(std::filesystem::path path, Write write);
  /// Gives up `path` where that is being written; those after it are written all the same.
  void cancel(const std::filesystem::path& path);
  std::optional<Running> running() const;
  bool busy() const { return running().has_value(); }
  /// What was done since the last call.
  std::vector<Written> take();
  void finish();

 private:
  struct Job {
    std::filesystem::path path;
    Write write;
    std::shared_ptr<Progress> progress = std::make_shared<Progress>();
    std::chrono::steady_clock::time_point asked = std::chrono::steady_clock::now();
  };
  void run();

  std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_;  ///< the first is being written
  std::vector<Written> written_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace homolog
