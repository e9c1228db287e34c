#include "core/volume/write_voxels.h"

#include <zlib.h>

#include <algorithm>
#include <limits>
#include <locale>
#include <span>
#include <vector>

namespace homolog {

namespace {

using Bytes = std::span<const std::byte>;

Bytes bytes_of(const VoxelData& data) {
  return std::visit([](const auto& values) { return std::as_bytes(std::span(values)); }, data);
}

void write_bytes(std::ostream& out, Bytes bytes) {
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

/// The voxels in pieces, each handed to `write`. Errors: cancelled.
template <class Write>
Result<void> in_pieces(const VoxelData& data, Progress* progress, const Write& write) {
  constexpr std::size_t piece = std::size_t{4} << 20;
  const Bytes all = bytes_of(data);
  for (std::size_t at = 0; at < all.size(); at += piece) {
    write(all.subspan(at, std::min(piece, all.size() - at)));
    if (progress == nullptr) continue;
    progress->report(static_cast<double>(at) / static_cast<double>(all.size()));
    if (progress->cancelled()) return fail("", "was not written: cancelled");
  }
  return {};
}

/// One gzip stream made of several pieces.
class GzipWriter {
 public:
  explicit GzipWriter(std::ostream& out) : out_(out), chunk_(std::size_t{256} << 10) {
    constexpr int gzip = 15 + 16, fast = 3, memory = 8;
    ready_ = deflateInit2(&stream_, fast, Z_DEFLATED, gzip, memory, Z_DEFAULT_STRATEGY) == Z_OK;
  }
  ~GzipWriter() { deflateEnd(&stream_); }
  GzipWriter(const GzipWriter&) = delete;
  GzipWriter& operator=(const GzipWriter&) = delete;

  /// At most 4 GB: zlib counts in 32 bits.
  void write(Bytes bytes) { push(bytes, Z_NO_FLUSH); }
  bool finish() {
    push({}, Z_FINISH);
    return ready_;
  }

 private:
  void push(Bytes bytes, int flush) {
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes.data()));
    stream_.avail_in = static_cast<uInt>(bytes.size());
    int status = Z_OK;
    do {
      stream_.next_out = reinterpret_cast<Bytef*>(chunk_.data());
      stream_.avail_out = static_cast<uInt>(chunk_.size());
      status = deflate(&stream_, flush);
      write_bytes(out_, Bytes(chunk_).first(chunk_.size() - stream_.avail_out));
    } while (stream_.avail_out == 0 && out_);
    ready_ = ready_ && status != Z_STREAM_ERROR;
  }

  std::ostream& out_;
  std::vector<std::byte> chunk_;
  z_stream stream_{};
  bool ready_ = false;
};

}  // namespace

Result<void> write_plain(std::ostream& out, const VoxelData& data, Progress* progress) {
  return in_pieces(data, progress, [&](Bytes bytes) { write_bytes(out, bytes); });
}

Result<void> write_compressed(std::ostream& out, const std::string& begin, const VoxelData& data, Progress* progress) {
  GzipWriter gzip(out);
  gzip.write(std::as_bytes(std::span(begin)));
  if (auto written = in_pieces(data, progress, [&](Bytes bytes) { gzip.write(bytes); }); !written) return written;
  if (!gzip.finish()) return fail("", "could not be compressed; save it as .nii");
  return {};
}

std::ostringstream exact_text() {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(std::numeric_limits<double>::max_digits10);
  return text;
}

}  // namespace homolog
