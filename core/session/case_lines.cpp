#include "core/session/case_lines.h"

#include <zlib.h>

#include <algorithm>

namespace homolog {

CaseLines::CaseLines(std::shared_ptr<const LineFile> file, std::uint64_t begin, std::uint64_t end, std::uint32_t check)
    : file_(std::move(file)), begin_(begin), end_(end), check_(check) {
  const auto last = end_ > 0 ? file_->read(end_ - 1, 1) : std::string("\n");
  open_ended_ = last && *last != "\n";
}

Result<void> CaseLines::write_to(std::unique_ptr<Journal> journal, std::string first_line) {
  if (in_file() > 0) {
    auto lines = file_->read(begin_, in_file());
    if (!lines) return fail(lines.error());
    in_memory_.insert(0, *lines);
  }
  file_.reset();
  begin_ = end_ = 0;
  journal_ = std::move(journal);
  first_line_ = std::move(first_line);
  return {};
}

void CaseLines::close_journal() {
  journal_.reset();
}

std::uint32_t CaseLines::checked(std::uint32_t before, std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

Result<std::uint64_t> CaseLines::append(std::string_view lines, bool sync) {
  std::string bytes(open_ended_ ? "\n" : "");
  bytes += lines;
  in_memory_.reserve(in_memory_.size() + bytes.size());  // memory that is short is noticed before the file changes
  if (journal_)
    if (auto done = journal_->append(bytes, sync); !done) return fail(done.error());
  in_memory_ += bytes;
  open_ended_ = false;
  check_ = checked(check_, bytes);
  return in_file() + in_memory_.size() - lines.size();
}

Result<std::string> CaseLines::read(const LinePlace& place) const {
  if (place.at >= in_file()) return in_memory_.substr(place.at - in_file(), place.bytes);
  return file_->read(begin_ + place.at, place.bytes);
}

Result<std::string> CaseLines::first_line() const {
  return file_ ? file_->read(0, begin_) : first_line_;
}

Result<void> CaseLines::copy_to(std::ostream& out) const {
  constexpr std::uint64_t piece = std::uint64_t{1} << 20;
  for (std::uint64_t at = begin_; at < end_; at += piece) {
    const auto bytes = file_->read(at, std::min(piece, end_ - at));
    if (!bytes) return fail(bytes.error());
    out << *bytes;
  }
  out << in_memory_;
  return {};
}

bool CaseLines::are_all_of(const std::filesystem::path& path) const {
  const auto file = LineFile::open(path);
  if (!file) return false;
  const std::uint64_t bytes = first_line_.size() + in_memory_.size();
  const auto ended = (*file)->read(bytes, 1);  // nothing may follow
  const auto held = (*file)->read(0, bytes);
  const std::string_view text = held ? std::string_view(*held) : std::string_view();
  return held && !ended && text.substr(0, first_line_.size()) == first_line_ &&
         text.substr(first_line_.size()) == in_memory_;
}

}  // namespace homolog
