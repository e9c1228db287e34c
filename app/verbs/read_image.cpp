#include "app/verbs/read_image.h"

#include "core/measure/compare.h"

namespace homolog {

Result<VolumeRead> read_image(const std::filesystem::path& path, int frame, Progress& progress) {
  VolumeReadOptions reading;
  reading.progress = &progress;
  auto read = read_volume(path, reading);
  if (read && frame >= read->volume.frames)
    return fail(path.string(),
                "has " + std::to_string(read->volume.frames) + " frames, counted from 0; choose --frame among them");
  return read;
}

Result<MaskRead> read_mask(const std::filesystem::path& path, int label, int frame, Progress& progress) {
  auto read = read_image(path, frame, progress);
  if (!read) return fail(read.error());
  const auto chosen = label != 0 ? Result<int>(label) : only_label(read->volume, frame);
  if (!chosen) return fail(path.string(), chosen.error().what + " by --label");
  return MaskRead{std::move(*read), *chosen};
}

}  // namespace homolog
