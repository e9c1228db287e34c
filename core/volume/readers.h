#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/volume/stored_voxels.h"
#include "core/volume/volume_io.h"
#include "core/volume/voxel_stream.h"

/// What the readers behind read_volume share; each library has a file of its own.
namespace homolog {

Result<VolumeRead> read_nifti(const std::filesystem::path& path, Progress* progress);
Result<VolumeRead> read_nrrd(const std::filesystem::path& path, Progress* progress);
Result<VolumeRead> read_metaimage(const std::filesystem::path& path, Progress* progress);
Result<VolumeRead> read_dicom_file(const std::filesystem::path& path, Progress* progress);
/// `series_uid` chooses where the folder holds several series.
Result<VolumeRead> read_dicom_folder(const std::filesystem::path& folder, const std::string& series_uid,
                                     Progress* progress);

/// The grid whose axis a steps by the vector `steps_mm.col(a)`. Fails on sizes that are none, on axes that are not at
/// right angles and on steps of length zero.
Result<VolumeGeometry> make_geometry(const std::filesystem::path& path, const std::array<std::int64_t, 3>& dims,
                                     const Mat3& steps_mm, const Vec3& origin_mm);

/// Voxels that lie in one run of bytes.
struct VoxelRun {
  ByteBlock block;
  StoredType type = StoredType::Uint8;
  bool other_byte_order = false;
};

/// Reads all voxels of a geometry and its frames; the claim is checked against the file and the memory first.
Result<StoredVoxels> read_run(const VoxelRun& run, const VolumeGeometry& geometry, std::int64_t frames, bool rescaled,
                              Progress* progress);

/// Whether this machine stores the most significant byte first.
bool native_big_endian();

}  // namespace homolog
