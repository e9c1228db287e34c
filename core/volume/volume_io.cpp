#include "core/volume/volume_io.h"

#include <new>

#include "core/base/files/file_record.h"
#include "core/base/files/files.h"
#include "core/base/files/freesurfer_files.h"
#include "core/base/text/listed.h"
#include "core/volume/check_volume.h"
#include "core/volume/formats/formats.h"
#include "core/volume/labels/label_tables.h"
#include "core/volume/readers.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

/// A folder is of the first format of which a file lies in it; whatever else lies there does not matter.
const VolumeFormat* format_of_folder(const fs::path& folder) {
  for (const VolumeFormat* format : volume_formats) {
    if (format->in_folder.empty()) continue;
    std::error_code error;
    for (auto entry = fs::directory_iterator(folder, error); !error && entry != fs::directory_iterator();
         entry.increment(error)) {
      const fs::path& file = entry->path();
      if (!entry->is_regular_file(error) || is_hidden(file)) continue;
      if (format->recognises ? format->recognises(file) : has_ending(file, format->endings)) return format;
    }
  }
  return nullptr;
}

/// The format of a file or folder; null where it is none.
const VolumeFormat* format_of(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return format_of_folder(path);
  for (const VolumeFormat* format : volume_formats)
    if (!format->recognises && has_ending(path, format->endings)) return format;
  for (const VolumeFormat* format : volume_formats)
    if (format->recognises && format->recognises(path)) return format;
  return nullptr;
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
    const fs::directory_iterator listed(path, error);
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
  if (const VolumeFormat* format = format_of(path)) {
    auto read = format->read(path, options);
    if (read && !options.without_voxels && fs::is_regular_file(path, ignored)) take_names_beside(path, *read);
    if (read && !read->about_layers.empty() && !options.all_layers) read->warnings.push_back(read->about_layers);
    if (read) read->about_layers.clear();
    if (read) colour_by_names(read->segmentation);
    return read;
  }
  if (std::string words = freesurfer_words(path); !words.empty()) return fail(path.string(), std::move(words));
  const bool folder = fs::is_directory(path, ignored);
  std::vector<std::string> known;
  for (const VolumeFormat* format : volume_formats)
    if (const std::string& name = folder ? format->in_folder : format->name;
        !name.empty() && (folder || !format->endings.empty()))
      known.push_back(name);
  return fail(path.string(),
              folder ? "holds neither " + listed(known, " nor ") + "; choose the folder that does, or name a file"
                     : "is not a volume; open " + listed(known, ", or "));
}

/// By the format that the name's ending chooses. Errors that do not depend on the file name none.
Result<void> write_any(const Volume& volume, const fs::path& path, const std::string& record, Progress* progress) {
  for (const VolumeFormat* format : volume_formats)
    if (has_ending(path, format->written)) {
      if (auto written = format->write(volume, path, record, progress); !written) return written;
      return write_record_file(path, format->keeps_record ? "" : record);
    }
  return fail("", "is not a kind of volume that can be written; end its name in " +
                      listed(volume_format_endings(&VolumeFormat::written), " or ") +
                      ", of a label map also in .seg.nrrd, .mgz or .dcm");
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

Result<void> write_volume(const Volume& volume, const fs::path& path, Progress* progress, const std::string& record) {
  if (auto sound = check_volume(volume); !sound) return fail(path.string(), sound.error().what);
  auto written = write_any(volume, path, record, progress);
  if (!written && written.error().subject.empty()) return fail(path.string(), written.error().what);
  return written;
}

bool is_picture_stack(const fs::path& path) {
  return format_of(path) == &formats::stack && check_path(path);
}

bool looks_like_volume(const fs::path& path) {
  return format_of(path) != nullptr;
}

}  // namespace homolog
