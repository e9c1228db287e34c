#include "core/session/case_lines.h"

#include <zlib.h>

#include <algorithm>

namespace homolog {

CaseLines::CaseLines(std::shared_ptr<const LineFile> file, std::uint64_t begin, std::uint64_t end, std::uint32_t check)
    : file_(std::move(file)), begin_(begin), end_(end), check_(check) {
  const auto last = end_ > 0 ? file_->read(end_ - 1, 1) : std::string("\n");
  open_ended_ = last && *last != "\n";
}

void CaseLines::write_to(std::unique_ptr<Journal> journal, std::uint64_t begin) {
  journal_ = std::move(journal);
  file_ = journal_->file();
  begin_ = begin;
  end_ = journal_->bytes();
  in_memory_.clear();
}

std::uint32_t CaseLines::checked(std::uint32_t before, std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

Result<std::uint64_t> CaseLines::append(std::string_view lines, bool sync) {
  std::string bytes(open_ended_ ? "\n" : "");
  bytes += lines;
  if (journal_) {
    if (auto done = journal_->append(bytes, sync); !done) return fail(done.error());
    end_ += bytes.size();
  } else {
    in_memory_ += bytes;
  }
  open_ended_ = false;
  check_ = checked(check_, bytes);
  return in_file() + in_memory_.size() - lines.size();
}

Result<std::string> CaseLines::read(const LinePlace& place) const {
  if (place.at >= in_file()) return in_memory_.substr(place.at - in_file(), place.bytes);
  const std::uint64_t at = begin_ + place.at;
  if (journal_ && at >= journal_->synced_bytes())
    return std::string(journal_->unsynced_lines().substr(at - journal_->synced_bytes(), place.bytes));
  return file_->read(at, place.bytes);
}

Result<std::string> CaseLines::first_line() const {
  return file_ ? file_->read(0, begin_) : std::string();
}

Result<void> CaseLines::copy_to(std::ostream& out) const {
  constexpr std::uint64_t piece = std::uint64_t{1} << 20;
  const std::uint64_t synced = journal_ ? journal_->synced_bytes() : end_;
  for (std::uint64_t at = begin_; at < synced; at += piece) {
    const auto bytes = file_->read(at, std::min(piece, synced - at));
    if (!bytes) return fail(bytes.error());
    out << *bytes;
  }
  if (journal_) out << journal_->unsynced_lines();  // after a sync that failed only memory holds them for certain
  out << in_memory_;
  return {};
}

}  // namespace homolog
