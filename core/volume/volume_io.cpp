#include "core/volume/volume_io.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <new>

#include "core/volume/readers.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

std::string lower_name(const fs::path& path) {
  std::string name = path.filename().string();
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name;
}

template <std::size_t N>
bool ends_with_any(const std::string& name, const std::array<const char*, N>& ends) {
  return std::any_of(ends.begin(), ends.end(), [&](const char* end) { return name.ends_with(end); });
}

constexpr std::array nifti_ends{".nii", ".nii.gz", ".hdr", ".hdr.gz", ".img", ".img.gz"};
constexpr std::array nrrd_ends{".nrrd", ".nhdr"};
constexpr std::array meta_ends{".mha", ".mhd"};

Result<VolumeRead> read_any(const fs::path& path, const VolumeReadOptions& options) {
  const std::string name = lower_name(path);
  if (ends_with_any(name, nifti_ends)) return read_nifti(path, options.progress);
  if (ends_with_any(name, nrrd_ends)) return read_nrrd(path, options.progress);
  if (ends_with_any(name, meta_ends)) return read_metaimage(path, options.progress);
  if (fs::is_directory(path)) return read_dicom_folder(path, options.series_uid, options.progress);
  return read_dicom_file(path, options.progress);
}

}  // namespace

Result<VolumeRead> read_volume(const fs::path& path, const VolumeReadOptions& options) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return fail(path.string(), "does not exist; check the name");
  try {
    return read_any(path, options);
  } catch (const std::bad_alloc&) {
    return fail(path.string(), "does not fit into memory; close other programs, or crop or resample the volume");
  } catch (const std::exception& error) {
    return fail(path.string(), std::string("cannot be read (") + error.what() + ")");
  }
}

bool looks_like_volume(const fs::path& path) {
  const std::string name = lower_name(path);
  return ends_with_any(name, nifti_ends) || ends_with_any(name, nrrd_ends) || ends_with_any(name, meta_ends);
}

}  // namespace homolog
