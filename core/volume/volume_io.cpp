#include "core/volume/volume_io.h"

#include <algorithm>
#include <array>
#include <new>

#include "core/base/files.h"
#include "core/volume/dicom_set.h"
#include "core/volume/readers.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

template <std::size_t N>
bool ends_with_any(const std::string& name, const std::array<const char*, N>& ends) {
  return std::any_of(ends.begin(), ends.end(), [&](const char* end) { return name.ends_with(end); });
}

enum class Kind { None, Nifti, Nrrd, MetaImage, Dicom, DicomFolder, Stack };

/// A folder with a DICOM file holds DICOM, one with pictures and no DICOM file a stack; whatever else lies there does
/// not matter.
Kind kind_of_folder(const fs::path& folder) {
  Kind kind = Kind::None;
  std::error_code error;
  for (auto entry = fs::directory_iterator(folder, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    if (!entry->is_regular_file(error) || is_hidden(entry->path())) continue;
    if (looks_like_dicom(entry->path())) return Kind::DicomFolder;
    if (is_picture_name(entry->path())) kind = Kind::Stack;
  }
  return kind;
}

Kind kind_of(const fs::path& path) {
  constexpr std::array nifti{".nii", ".nii.gz", ".hdr", ".hdr.gz", ".img", ".img.gz"};
  constexpr std::array nrrd{".nrrd", ".nhdr"};
  constexpr std::array metaimage{".mha", ".mhd"};
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return kind_of_folder(path);
  const std::string name = lower_case_name(path);
  if (ends_with_any(name, nifti)) return Kind::Nifti;
  if (ends_with_any(name, nrrd)) return Kind::Nrrd;
  if (ends_with_any(name, metaimage)) return Kind::MetaImage;
  if (is_picture_name(path)) return Kind::Stack;
  return looks_like_dicom(path) ? Kind::Dicom : Kind::None;
}

/// Large files are often kept elsewhere and stand in as a few lines of text.
bool is_lfs_pointer(const fs::path& path) {
  const auto head = read_head(path, 40);
  return head && head->starts_with("version https://git-lfs.github.com");
}

/// Whether there is something at the path that may be read. A pipe is refused, since it may never end.
Result<void> check_path(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) {
    fs::directory_iterator(path, error);
    if (error) return fail(path.string(), "cannot be listed (" + error.message() + "); check its permissions");
    return {};
  }
  const auto size = size_of_file(path);
  if (!size) return fail(size.error());
  return {};
}

Result<VolumeRead> read_any(const fs::path& path, const VolumeReadOptions& options) {
  if (const auto readable = check_path(path); !readable) return fail(readable.error());
  std::error_code ignored;
  if (fs::is_regular_file(path, ignored) && is_lfs_pointer(path))
    return fail(path.string(), "is a Git LFS pointer, not the image itself; fetch it with `git lfs pull`");
  switch (kind_of(path)) {
    case Kind::Nifti:
      return read_nifti(path, options.progress);
    case Kind::Nrrd:
      return read_nrrd(path, options.progress);
    case Kind::MetaImage:
      return read_metaimage(path, options.progress);
    case Kind::Dicom:
      return read_dicom_file(path, options.progress);
    case Kind::DicomFolder:
      return read_dicom_folder(path, options.series_uid, options.progress);
    case Kind::Stack:
      return read_stack(path, options.stack_spacing_mm, options.progress);
    case Kind::None:
      break;
  }
  return fail(path.string(),
              fs::is_directory(path, ignored)
                  ? "holds neither DICOM files nor PNG or TIFF slices; choose the folder that does"
                  : "is not a volume; open DICOM, NIfTI, NRRD, MetaImage, or a stack of PNG or TIFF slices");
}

}  // namespace

Result<VolumeRead> read_volume(const fs::path& path, const VolumeReadOptions& options) {
  try {
    auto read = read_any(path, options);
    if (read && options.progress) options.progress->report(1);
    return read;
  } catch (const std::bad_alloc&) {
    return fail(path.string(), "does not fit into memory; close other programs, or crop or resample the volume");
  } catch (const std::exception& error) {
    return fail(path.string(), std::string("cannot be read (") + error.what() + "); check the file or export it again");
  }
}

bool is_picture_stack(const fs::path& path) {
  return kind_of(path) == Kind::Stack && check_path(path);
}

bool looks_like_volume(const fs::path& path) {
  return kind_of(path) != Kind::None;
}

}  // namespace homolog
