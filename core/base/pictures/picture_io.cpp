#include "core/base/pictures/picture_io.h"

#include "core/base/files/files.h"
#include "core/base/pictures/picture_module.h"
#include "core/base/processes/process.h"
#include "core/base/processes/system_modules.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

fs::path chosen_module;

/// From the program's own folder or the place that it named, and no other, since what is loaded is run.
Result<const PictureModule*> load_module() {
  std::error_code error;
  const fs::path beside = program_file().parent_path() / HOMOLOG_PICTURES;
  const fs::path file = chosen_module.empty() ? beside : chosen_module;
  std::string reason = "not found";
  if (fs::exists(file, error)) {
    if (void* entry = in_module(file.c_str(), picture_module_entry, reason))
      return reinterpret_cast<PictureModuleEntry>(entry)();
  }
  return fail(file.string(), "cannot be loaded (" + reason +
                                 "), so neither pictures nor DICOM pixels in JPEG can be read or written; build or "
                                 "install the program again");
}

}  // namespace

void use_picture_module(const fs::path& file) {
  chosen_module = file;
}

Result<const PictureModule*> picture_module() {
  static const Result<const PictureModule*> module = load_module();
  return module;
}

Result<void> write_picture(const Picture& picture, const fs::path& path) {
  const auto module = picture_module();
  if (!module) return fail(module.error());
  const auto bytes = (*module)->encode(picture, path);
  if (!bytes) return fail(bytes.error());
  return write_whole_file(path, {reinterpret_cast<const char*>(bytes->data()), bytes->size()});
}

Result<void> can_write_picture(const fs::path& path) {
  const auto module = picture_module();
  if (!module) return fail(module.error());
  const auto bytes = (*module)->encode({1, 1, std::vector<std::uint8_t>(4)}, path);
  return bytes ? Result<void>() : fail(bytes.error());
}

Result<void> write_gif(const std::vector<Picture>& frames, int hundredths, const fs::path& path) {
  const auto module = picture_module();
  if (!module) return fail(module.error());
  const auto bytes = (*module)->encode_gif(frames, hundredths, path);
  if (!bytes) return fail(bytes.error());
  return write_whole_file(path, {reinterpret_cast<const char*>(bytes->data()), bytes->size()});
}

Result<Picture> read_picture(const fs::path& path) {
  if (const auto size = size_of_file(path); !size) return fail(size.error());
  const auto module = picture_module();
  if (!module) return fail(module.error());
  return (*module)->read(path);
}

}  // namespace homolog
