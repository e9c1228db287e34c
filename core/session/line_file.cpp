#include "core/session/line_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace homolog {

namespace {

constexpr std::size_t first_piece = std::size_t{1} << 16, largest_piece = std::size_t{1} << 20;
constexpr std::size_t longest_line = std::size_t{1} << 30;

}  // namespace

Result<std::shared_ptr<const LineFile>> LineFile::open(const std::filesystem::path& path) {
  auto opened = OpenFile::open(path, OpenFile::For::reading);
  if (!opened) {
    const bool absent = opened.error() == ENOENT || opened.error() == ENOTDIR;
    return fail(path.string(), absent ? "does not exist; check the name" : "cannot be read; check its permissions");
  }
  auto file = std::make_shared<const LineFile>(path, std::move(*opened));
  const auto kind = file->file().status().value_or(FileStatus{}).kind;
  if (kind != FileStatus::Kind::file) return fail(not_a_file(path, kind));
  return file;
}

Result<std::size_t> LineFile::read_some(char* into, std::size_t most, std::uint64_t at) const {
  const auto got = file_.read_at(into, most, at);
  if (!got)
    return fail(path_.string(), std::string("cannot be read (") + std::strerror(got.error()) + "); check the disk");
  return *got;
}

Result<std::string> LineFile::read(std::uint64_t at, std::uint64_t bytes) const {
  std::string text(bytes, '\0');
  for (std::size_t done = 0; done < text.size();) {
    const auto got = read_some(text.data() + done, text.size() - done, at + done);
    if (!got) return fail(got.error());
    if (*got == 0)
      return fail(path_.string(),
                  "was cut short by another program, so its lines cannot be read; restore it from a copy");
    done += *got;
  }
  return text;
}

Result<void> LineFile::for_each_line(const Visit& visit) const {
  std::string buffer(first_piece, '\0');
  std::size_t filled = 0, searched = 0;  // bytes of the buffer, which begins at a line's begin
  std::uint64_t at = 0;                  // its place in the file
  for (;;) {
    if (filled == buffer.size()) {
      if (buffer.size() >= longest_line)
        return fail(path_.string(), "has a line larger than 1 GiB, so it is not a case; check the name");
      buffer.resize(2 * buffer.size());
    }
    const auto got = read_some(buffer.data() + filled, buffer.size() - filled, at + filled);
    if (!got) return fail(got.error());
    filled += *got;
    std::size_t begin = 0;
    while (const void* found = std::memchr(buffer.data() + searched, '\n', filled - searched)) {
      const auto end = static_cast<std::size_t>(static_cast<const char*>(found) - buffer.data());
      if (auto done = visit({buffer.data() + begin, end - begin}, at + begin, true); !done) return done;
      begin = searched = end + 1;
    }
    if (*got == 0) {
      if (filled == begin) return {};
      return visit({buffer.data() + begin, filled - begin}, at + begin, false);
    }
    buffer.erase(0, begin);
    buffer.resize(std::max(buffer.size(), std::min(2 * (buffer.size() + begin), largest_piece)));
    at += begin;
    filled -= begin;
    searched = filled;
  }
}

}  // namespace homolog
