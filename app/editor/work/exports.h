#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "app/editor/work/worker.h"

namespace homolog {

/// Writes files beside the window, one after the other; none is dropped. Called from the window's thread only.
class Exports {
 public:
  using Write = std::function<Result<void>(Progress&)>;
  /// The work to do in the window once the file is written.
  using Then = std::function<void()>;
  struct Written {
    std::filesystem::path path;
    Result<void> result;
    bool cancelled = false;
    Then then;           ///< may be empty
    std::string remark;  ///< a sentence on what the file does not keep; empty: none
  };

  /// `wake` is called from the thread when a file is done.
  explicit Exports(std::function<void()> wake) : worker_(std::move(wake)) {}
  /// Finishes what is asked for.
  ~Exports() { finish(); }

  /// `write` must own all that it needs. `then` and `remark` come back with the result; the caller that takes the
  /// result runs `then`.
  void start(const std::filesystem::path& path, Write write, Then then = {}, std::string remark = {});
  /// Gives up `path` where that is being written; those after it are written all the same.
  void cancel(const std::filesystem::path& path);
  /// The job that writes now; its subject is the path.
  std::optional<RunningJob> running() const { return worker_.running(); }
  bool busy() const { return worker_.busy(); }
  /// The writing done since the last call.
  std::vector<Written> take();
  void finish() { worker_.finish(); }

 private:
  Worker<Written> worker_;
};

}  // namespace homolog
