#include "core/volume/voxel_stream.h"

#include <bzlib.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <memory>
#include <vector>

#include "core/base/files/files.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t chunk_bytes = std::size_t{4} << 20;  ///< bytes of output between two questions for cancellation
constexpr std::size_t input_bytes = std::size_t{256} << 10;
constexpr std::size_t much_behind = std::size_t{1} << 28;  ///< bytes that other programs write behind the voxels

tl::unexpected<Error> damaged(const fs::path& file) {
  return fail(file.string(), "is damaged: its compressed voxels do not decode; copy or download it again");
}

tl::unexpected<Error> cut_short(const fs::path& file, double got, double wanted) {
  char text[160];
  std::snprintf(text, sizeof text, "is cut short: it holds %.0f of %.0f bytes of voxels; copy or download it again",
                got, wanted);
  return fail(file.string(), text);
}

tl::unexpected<Error> far_too_long(const fs::path& file) {
  return fail(file.string(), "holds far more than the voxels of its header; export it again");
}

/// Bytes in order; fewer than asked for only at the end.
class Source {
 public:
  Source(const ByteBlock& block) : file_(block.file), in_(block.file, std::ios::binary) {
    in_.seekg(static_cast<std::streamoff>(block.offset));
  }
  virtual ~Source() = default;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;

  bool open() const { return in_.is_open(); }
  virtual Result<std::size_t> read(std::span<std::byte> out) { return take(out); }
  /// Reads what a compressed stream holds behind the bytes asked for, so that its end and checksum are seen. Fails
  /// where that is more than `most` bytes.
  virtual Result<void> finish(std::size_t /*most*/) { return {}; }

 protected:
  std::size_t take(std::span<std::byte> out) {
    in_.read(reinterpret_cast<char*>(out.data()), static_cast<std::streamsize>(out.size()));
    return static_cast<std::size_t>(in_.gcount());
  }
  const fs::path& file() const { return file_; }

 private:
  fs::path file_;
  std::ifstream in_;
};

/// A decoder of zlib or bzip2, fed from a buffer; it may find several streams behind one another.
class CompressedSource : public Source {
 public:
  using Source::Source;

  Result<std::size_t> read(std::span<std::byte> out) override {
    std::size_t got = 0;
    while (got < out.size() && !ended_) {
      if (unread_.empty()) {
        unread_ = std::span(buffer_).first(take(buffer_));
        if (unread_.empty()) {
          if (started_)
            return fail(file().string(), "is cut short within its compressed voxels; copy or download it again");
          ended_ = true;  // between two streams: nothing follows
          break;
        }
      }
      if (!started_ && !begin(unread_)) {
        if (got_any_)
          ended_ = true;  // padding behind the last stream
        else
          return damaged(file());
        break;
      }
      started_ = got_any_ = true;
      bool stream_ended = false;
      if (!decode(unread_, out, got, stream_ended)) return damaged(file());
      if (stream_ended) started_ = false;
    }
    return got;
  }

  Result<void> finish(std::size_t most) override {
    std::vector<std::byte> rest(input_bytes);
    for (std::size_t read_on = 0; read_on <= most;) {
      const auto got = read(rest);
      if (!got) return fail(got.error());
      if (*got == 0) return {};
      read_on += *got;
    }
    return far_too_long(file());
  }

 protected:
  /// Prepares for a stream that begins with `input`; false where it is none.
  virtual bool begin(std::span<const std::byte> input) = 0;
  /// Decodes from the front of `input` (and shortens it) into out[got…]; false where the stream is damaged.
  virtual bool decode(std::span<std::byte>& input, std::span<std::byte> out, std::size_t& got, bool& stream_ended) = 0;

 private:
  std::vector<std::byte> buffer_ = std::vector<std::byte>(input_bytes);
  std::span<std::byte> unread_;
  bool started_ = false, got_any_ = false, ended_ = false;
};

constexpr unsigned at_most_unsigned(std::size_t n) {
  return static_cast<unsigned>(std::min<std::size_t>(n, 1u << 30));
}

class DeflateSource final : public CompressedSource {
 public:
  DeflateSource(const ByteBlock& block) : CompressedSource(block) {
    constexpr int gzip_or_zlib = 15 + 32, raw = -15;
    ready_ = inflateInit2(&stream_, block.compression == Compression::RawDeflate ? raw : gzip_or_zlib) == Z_OK;
  }
  ~DeflateSource() override { inflateEnd(&stream_); }

 private:
  bool begin(std::span<const std::byte> input) override {
    // Only gzip streams may follow one another (bgzip and pigz write such files).
    const bool first = std::exchange(first_, false);
    return ready_ && (first || input[0] == std::byte{0x1f}) && inflateReset(&stream_) == Z_OK;
  }
  bool decode(std::span<std::byte>& input, std::span<std::byte> out, std::size_t& got, bool& stream_ended) override {
    stream_.next_in = reinterpret_cast<Bytef*>(input.data());
    stream_.avail_in = at_most_unsigned(input.size());
    stream_.next_out = reinterpret_cast<Bytef*>(out.data() + got);
    stream_.avail_out = at_most_unsigned(out.size() - got);
    const int status = inflate(&stream_, Z_NO_FLUSH);
    input = input.subspan(input.size() - stream_.avail_in);
    got = static_cast<std::size_t>(reinterpret_cast<std::byte*>(stream_.next_out) - out.data());
    stream_ended = status == Z_STREAM_END;
    return status == Z_OK || status == Z_STREAM_END || status == Z_BUF_ERROR;
  }

  z_stream stream_{};
  bool ready_ = false, first_ = true;
};

class Bzip2Source final : public CompressedSource {
 public:
  using CompressedSource::CompressedSource;
  ~Bzip2Source() override { BZ2_bzDecompressEnd(&stream_); }

 private:
  bool begin(std::span<const std::byte> input) override {
    BZ2_bzDecompressEnd(&stream_);
    stream_ = {};
    return input[0] == std::byte{'B'} && BZ2_bzDecompressInit(&stream_, 0, 0) == BZ_OK;
  }
  bool decode(std::span<std::byte>& input, std::span<std::byte> out, std::size_t& got, bool& stream_ended) override {
    stream_.next_in = reinterpret_cast<char*>(input.data());
    stream_.avail_in = at_most_unsigned(input.size());
    stream_.next_out = reinterpret_cast<char*>(out.data() + got);
    stream_.avail_out = at_most_unsigned(out.size() - got);
    const int status = BZ2_bzDecompress(&stream_);
    input = input.subspan(input.size() - stream_.avail_in);
    got = static_cast<std::size_t>(reinterpret_cast<std::byte*>(stream_.next_out) - out.data());
    stream_ended = status == BZ_STREAM_END;
    return status == BZ_OK || status == BZ_STREAM_END;
  }

  bz_stream stream_{};
};

Result<std::unique_ptr<Source>> open_source(const ByteBlock& block) {
  // Asked first, since opening a pipe waits for ever.
  if (const auto size = size_of_file(block.file); !size) return fail(size.error());
  std::unique_ptr<Source> source;
  if (block.compression == Compression::None)
    source = std::make_unique<Source>(block);
  else if (block.compression == Compression::Bzip2)
    source = std::make_unique<Bzip2Source>(block);
  else
    source = std::make_unique<DeflateSource>(block);
  if (!source->open()) return fail(block.file.string(), "cannot be read; check its permissions");
  std::vector<std::byte> passed_over(static_cast<std::size_t>(std::min<std::uintmax_t>(block.skip, input_bytes)));
  for (std::uintmax_t left = block.skip; left > 0;) {
    const auto step = static_cast<std::size_t>(std::min<std::uintmax_t>(left, passed_over.size()));
    const auto got = source->read(std::span(passed_over).first(step));
    if (!got) return fail(got.error());
    if (*got < step) return fail(block.file.string(), "ends within its header; copy or download it again");
    left -= step;
  }
  return source;
}

/// Fails where anything but a few zeros follows.
Result<void> check_end(Source& source, const ByteBlock& block) {
  std::vector<std::byte> rest(input_bytes);
  for (std::uintmax_t read_on = 0;;) {
    const auto got = source.read(rest);
    if (!got) return fail(got.error());
    if (*got == 0) return {};
    read_on += *got;
    const auto is_zero = [](std::byte byte) { return byte == std::byte{0}; };
    if (read_on > block.most_zeros || !std::ranges::all_of(std::span(rest).first(*got), is_zero))
      return fail(block.file.string(), more_voxels_than_said);
  }
}

}  // namespace

Compression compression_of(const fs::path& file) {
  if (!size_of_file(file)) return Compression::None;
  std::ifstream in(file, std::ios::binary);
  return in.get() == 0x1f && in.get() == 0x8b ? Compression::Deflate : Compression::None;
}

Result<void> check_claim(const ByteBlock& block, double bytes) {
  const auto size = size_of_file(block.file);
  if (!size) return fail(size.error());
  const double present = std::max(0.0, static_cast<double>(*size) - static_cast<double>(block.offset));
  const double skip = static_cast<double>(block.skip);
  constexpr double longest_skip = 256 << 20;  // bytes that have to be unpacked to be passed over: a second's work
  if (block.compression != Compression::None && skip > longest_skip)
    return fail(block.file.string(), "says that its voxels begin far behind its header; export it again");
  // Deflate reaches 1032 : 1 at most (zlib's technical details); bzip2 packs 45,899,235 equal bytes into 46.
  const double best_ratio = block.compression == Compression::None    ? 1
                            : block.compression == Compression::Bzip2 ? 1e6
                                                                      : 1032;
  if (skip + bytes > present * best_ratio) {
    if (block.compression == Compression::None) return cut_short(block.file, std::max(0.0, present - skip), bytes);
    return fail(block.file.string(), "is far too small for the size its header claims; copy or download it again");
  }
  return {};
}

Result<void> read_block(const ByteBlock& block, std::size_t bytes, const Room& room, Progress* progress) {
  const auto source = open_source(block);
  if (!source) return fail(source.error());
  for (std::size_t done = 0; done < bytes;) {
    if (progress) {
      if (progress->cancelled()) return fail(block.file.string(), "was not read: cancelled");
      progress->report(static_cast<double>(done) / static_cast<double>(bytes));
    }
    const std::size_t step = std::min(chunk_bytes, bytes - done);
    const auto got = (*source)->read(room(step));
    if (!got) return fail(got.error());
    done += *got;
    if (*got < step) return cut_short(block.file, static_cast<double>(done), static_cast<double>(bytes));
  }
  if (block.ends_file)
    if (auto ended = check_end(**source, block); !ended) return ended;
  constexpr std::size_t much = std::size_t{1} << 28;  // bytes that other programs write behind the voxels
  return (*source)->finish(bytes + much);
}

Result<void> read_block(const ByteBlock& block, std::span<std::byte> bytes, Progress* progress) {
  std::span<std::byte> left = bytes;
  const auto room = [&left](std::size_t count) {
    const auto next = left.first(count);
    left = left.subspan(count);
    return next;
  };
  return read_block(block, bytes.size(), room, progress);
}

Result<std::string> read_to_end(const ByteBlock& block, std::uintmax_t limit_bytes) {
  const auto source = open_source(block);
  if (!source) return fail(source.error());
  std::string text;
  std::vector<std::byte> chunk(input_bytes);
  for (;;) {
    const auto got = (*source)->read(chunk);
    if (!got) return fail(got.error());
    if (*got == 0) return text;
    text.append(reinterpret_cast<const char*>(chunk.data()), *got);
    if (text.size() > limit_bytes) return fail(block.file.string(), "is too large to be a file of this kind");
  }
}

Result<std::string> read_head(const fs::path& file, std::size_t count) {
  const auto source = open_source({.file = file, .compression = compression_of(file)});
  if (!source) return fail(source.error());
  std::string head(count, '\0');
  const auto got = (*source)->read(std::as_writable_bytes(std::span(head)));
  if (!got) return fail(got.error());
  head.resize(*got);
  return head;
}

}  // namespace homolog
