#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "core/base/progress.h"
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
  std::uintmax_t offset = 0;  ///< where the (compressed) bytes begin
  std::uintmax_t skip = 0;    ///< bytes to pass over after decompression
  Compression compression = Compression::None;
};

/// Deflate where the file begins as gzip does, whatever its name, else None.
Compression compression_of(const std::filesystem::path& file);

/// Fails unless the file is large enough to hold `bytes` (compressed at the best ratio its compression reaches) and
/// the machine has `memory_bytes` free. Call before allocating what a header claims.
Result<void> check_claim(const ByteBlock& block, double bytes, double memory_bytes);

/// Fills `bytes` from the block while reporting and asking for cancellation every few megabytes. Fails where the block
/// is shorter, damaged (a gzip's checksum included) or the reader was cancelled.
Result<void> read_block(const ByteBlock& block, std::span<std::byte> bytes, Progress* progress);

/// Everything up to the block's end, decompressed; fails beyond `limit_bytes`.
Result<std::string> read_to_end(const ByteBlock& block, std::uintmax_t limit_bytes);

/// The first bytes of a file, decompressed where it is a gzip; fewer where it is shorter.
Result<std::string> read_head(const std::filesystem::path& file, std::size_t count);

/// Memory that the system can still give, in bytes; infinite where it does not say.
double available_memory_bytes();

/// Fails where `needed_bytes` exceed the memory that is available.
Result<void> check_memory(const std::filesystem::path& file, double needed_bytes);

}  // namespace homolog
