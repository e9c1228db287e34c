#include "app/editor/work/exports.h"

#include <utility>

namespace homolog {

void Exports::start(const std::filesystem::path& path, Write write, Then then, std::string remark) {
  worker_.queue(path.string(),
                [path, write = std::move(write), then = std::move(then),
                 remark = std::move(remark)](Progress& progress) -> Result<Written> {
                  auto result = guarded(path.string(), [&] { return write(progress); });
                  return Written{path, std::move(result), progress.cancelled(), then, remark};
                });
}

void Exports::cancel(const std::filesystem::path& path) {
  worker_.cancel_running(path.string());
}

std::vector<Exports::Written> Exports::take() {
  std::vector<Written> written;
  while (auto one = worker_.take()) {
    // A job gives a result always; only the worker's own fault comes as an error.
    if (*one)
      written.push_back(std::move(**one));
    else
      written.push_back({{}, fail(one->error()), false, {}, {}});
  }
  return written;
}

}  // namespace homolog
