#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/base/numbers/scalar.h"
#include "core/base/result.h"
#include "core/volume/volume.h"

namespace homolog {

/// Voxels in the type in which a file stores them, native byte order.
using StoredVoxels =
    std::variant<std::vector<std::uint8_t>, std::vector<std::int8_t>, std::vector<std::uint16_t>,
                 std::vector<std::int16_t>, std::vector<std::uint32_t>, std::vector<std::int32_t>,
                 std::vector<std::uint64_t>, std::vector<std::int64_t>, std::vector<float>, std::vector<double>>;

/// The most bytes that a volume of `voxels` occupies while it is read: the stored and, where another type is kept, the
/// kept voxels.
double bytes_while_reading(Scalar type, double voxels, bool rescaled);

/// `count` voxels of value 0.
StoredVoxels make_stored_voxels(Scalar type, std::size_t count);

std::span<std::byte> bytes_of(StoredVoxels& voxels);

/// Prepares for `count` voxels in all, so that none is copied as more are added. Memory that is only reserved is not
/// yet taken: what a damaged header claims costs nothing before voxels for it arrive.
void reserve_voxels(StoredVoxels& voxels, std::size_t count);

/// Adds `count` voxels behind those that are there, and returns their bytes.
std::span<std::byte> add_voxels(StoredVoxels& voxels, std::size_t count);

/// Turns voxels of the other byte order into native ones.
void swap_byte_order(StoredVoxels& voxels);

/// Intensity = slope · stored value + intercept.
struct Rescale {
  double slope = 1, intercept = 0;
  bool identity() const { return slope == 1 && intercept == 0; }
  bool operator==(const Rescale&) const = default;
};

/// Stored voxels as intensities in the type that a Volume keeps, with their range. uint8, int16, uint16 and float32
/// that need no rescaling are moved, not copied; other integers go to the smallest of uint8, int16 and uint16 that
/// holds every value, everything else to float32. Fails where a finite value exceeds float32; warns where integers are
/// rounded. `subject` is the file that the sentences name.
Result<void> keep_voxels(StoredVoxels voxels, const Rescale& rescale, const std::string& subject, Volume& volume,
                         std::vector<std::string>& warnings);

}  // namespace homolog
