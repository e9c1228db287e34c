#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/volume/stored_voxels.h"
#include "core/volume/volume_io.h"
#include "core/volume/voxel_stream.h"

/// The parts that the formats in core/volume/formats share.
namespace homolog {

/// The grid whose axis a steps by the vector `steps_mm.col(a)`. Fails on sizes that are none, on axes that are not at
/// right angles and on steps of length zero.
Result<VolumeGeometry> make_geometry(const std::filesystem::path& path, const std::array<std::int64_t, 3>& dims,
                                     const Mat3& steps_mm, const Vec3& origin_mm);

/// Voxels that lie in one run of bytes, or in several of equal length behind one another (slices in files of their
/// own).
struct VoxelRun {
  std::vector<ByteBlock> blocks;
  Scalar type = Scalar::uint8;
  bool other_byte_order = false;
};

/// Reads all voxels of a geometry and its frames. The header's claims are checked against the files and the memory
/// first, and memory is taken as the voxels arrive. Fails where the voxels do not divide among the blocks.
Result<StoredVoxels> read_run(const VoxelRun& run, const VolumeGeometry& geometry, std::int64_t frames, bool rescaled,
                              Progress* progress);

/// The voxels of a geometry and its frames, in floating point, since what a header claims may overflow any integer.
double claimed_voxels(const VolumeGeometry& geometry, std::int64_t frames);

/// A file's name without its folder, in lower case: what extensions are compared with.
std::string lower_case_name(const std::filesystem::path& path);

/// Whether a file's name ends in one of these, in any case.
bool has_ending(const std::filesystem::path& path, const std::vector<std::string>& endings);

/// A file's name in lower case with # for every run of digits: files of one series are named alike.
std::string name_without_numbers(const std::filesystem::path& path);

/// Whether a file in a folder is no part of a scan: beside each file, macOS leaves one named `._NAME` on other disks.
bool is_hidden(const std::filesystem::path& path);

/// The files of a folder of single masks, in the order in which they are read: label k + 1 is that of file k.
std::vector<std::filesystem::path> mask_files(const std::filesystem::path& folder);

/// Whether this machine stores the most significant byte first.
bool native_big_endian();

}  // namespace homolog
