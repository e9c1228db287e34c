#pragma once

#include <sys/resource.h>

#include <csignal>

namespace homolog {

/// As long as it lives, no file of this process grows beyond `most_bytes`: what a full disk does, without a disk. The
/// test's own output must wait.
class SmallFilesOnly {
 public:
  explicit SmallFilesOnly(rlim_t most_bytes) {
    std::signal(SIGXFSZ, SIG_IGN);  // as the program does
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit small{most_bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &small);
  }
  ~SmallFilesOnly() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, SIG_DFL);
  }
  SmallFilesOnly(const SmallFilesOnly&) = delete;
  SmallFilesOnly& operator=(const SmallFilesOnly&) = delete;

 private:
  rlimit before_{};
};

}  // namespace homolog
