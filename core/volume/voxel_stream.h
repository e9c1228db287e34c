#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "core/base/processes/progress.h"
#include "core/base/result.h"

namespace homolog {

enum class Compression {
  None,
  Deflate,     ///< gzip or zlib, told apart by their first bytes
  RawDeflate,  ///< without any header (DICOM's deflated transfer syntax)
  Bzip2
};

/// A run of bytes within a file, as it lies there.
struct ByteBlock {
  std::filesystem::path file;
  std::uintmax_t offset = 0;  ///< the place of the first (compressed) byte
  std::uintmax_t skip = 0;    ///< bytes to pass over after decompression
  Compression compression = Compression::None;
  bool ends_file = false;  ///< nothing but a few zeros may follow: else the header's sizes are smaller than the voxels
  std::uintmax_t most_zeros = 0;  ///< bytes of padding, of which some programs write a few
};

/// Of a file whose voxels are more than its header's sizes.
inline constexpr const char* more_voxels_than_said =
    "holds more voxels than its header says, so that they would lie in wrong places; export it again";

/// Deflate where the file begins as gzip does, whatever its name, else None.
Compression compression_of(const std::filesystem::path& file);

/// Fails unless the block's file is large enough to hold `bytes`, compressed at the best ratio its compression reaches.
Result<void> check_claim(const ByteBlock& block, double bytes);

/// A function that says where the next bytes of a block go: it is called with how many there may be, returns as much
/// room.
using Room = std::function<std::span<std::byte>(std::size_t bytes)>;

/// Reads `bytes` bytes of the block into room that is asked for as they arrive, a few megabytes at a time (a multiple
/// of 8 but for the last); reports and asks for cancellation as often. Fails where the block is shorter, damaged (a
/// gzip's checksum included), or not the end of its file though it should be, or the reader was cancelled.
Result<void> read_block(const ByteBlock& block, std::size_t bytes, const Room& room, Progress* progress);

/// The same into room that is there already.
Result<void> read_block(const ByteBlock& block, std::span<std::byte> bytes, Progress* progress);

/// Everything up to the block's end, decompressed; fails beyond `limit_bytes`.
Result<std::string> read_to_end(const ByteBlock& block, std::uintmax_t limit_bytes);

/// The first bytes of a file, decompressed where it is a gzip; fewer where it is shorter.
Result<std::string> read_head(const std::filesystem::path& file, std::size_t count);

}  // namespace homolog
