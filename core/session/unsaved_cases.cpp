#include "core/session/unsaved_cases.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdlib>

#include "core/base/files/files.h"
#include "core/base/processes/process.h"
#include "core/session/case_file.h"

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// The time in milliseconds, or later than that: two unsaved cases of one millisecond need two names.
std::int64_t next_stamp() {
  static std::atomic<std::int64_t> last = 0;
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const std::int64_t now_ms = std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
  std::int64_t before = last, stamp = 0;
  do stamp = std::max(now_ms, before + 1);
  while (!last.compare_exchange_weak(before, stamp));
  return stamp;
}

}  // namespace

fs::path unsaved_folder() {
  if (const char* state = std::getenv("XDG_STATE_HOME"); state != nullptr && *state != '\0') {
    return fs::path(state) / "homolog";
  }
  return home_folder() / ".local" / "state" / "homolog";
}

Result<fs::path> new_unsaved_path() {
  const fs::path folder = unsaved_folder();
  if (auto made = make_folder(folder, Readers::user_alone); !made)
    return fail(made.error().subject,
                made.error().what +
                    (made.error().subject == "HOME" ? " or XDG_STATE_HOME" : ", for instance by XDG_STATE_HOME"));
  return folder / ("unsaved-" + std::to_string(next_stamp()) + "-" + std::to_string(process_number()) + case_extension);
}

Result<EditSession> create_unsaved_case(Document initial) {
  const auto path = new_unsaved_path();
  if (!path) return fail(path.error());
  return create_case(std::move(initial), *path);
}

std::optional<UnsavedCase> unsaved_case(const fs::path& journal) {
  const auto file = LineFile::open(journal);
  if (!file) return std::nullopt;
  UnsavedCase found{journal, {}, false};
  const auto read = (*file)->for_each_line([&](std::string_view line, std::uint64_t at, bool) -> Result<void> {
    if (at == 0) {
      found.header = line;
      return {};
    }
    const LineKind kind = kind_of(line);
    found.edited = kind.kind != LineKind::empty && kind.kind != LineKind::look && !kind.keeps;
    return found.edited ? fail("", "enough was read") : Result<void>();
  });
  return read || found.edited ? std::optional(std::move(found)) : std::nullopt;
}

std::vector<UnsavedCase> unsaved_cases() {
  std::vector<UnsavedCase> found;
  std::error_code error;
  for (fs::directory_iterator entry(unsaved_folder(), error), end; !error && entry != end; entry.increment(error)) {
    const fs::path& path = entry->path();
    if (path.extension() != case_extension || Journal::in_use(path)) continue;
    if (auto one = unsaved_case(path)) found.push_back(std::move(*one));
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.journal > b.journal; });
  return found;
}

std::size_t count_steps(const fs::path& journal) {
  std::size_t steps = 0, undone = 0;
  if (const auto file = LineFile::open(journal))
    (void)(*file)->for_each_line([&](std::string_view line, std::uint64_t at, bool) -> Result<void> {
      const LineKind kind = kind_of(line);
      if (at == 0) return {};
      if (kind.kind == LineKind::step) {
        steps += kind.joined ? 0 : 1;
        undone = 0;
      } else if (kind.kind == LineKind::undo && steps > 0) {
        --steps, ++undone;
      } else if (kind.kind == LineKind::redo && undone > 0) {
        ++steps, --undone;
      }
      return {};
    });
  return steps;
}

}  // namespace homolog
