#include "render/volume_textures.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace homolog {
namespace {

constexpr std::uint64_t budget_bytes = std::uint64_t{1} << 30;
/// The driver copies what it is given: a slab at a time, it never holds a second whole volume.
constexpr std::size_t slab_bytes = std::size_t{16} << 20;

struct Format {
  GLint internal;
  GLenum type;
  float value_scale;
};
constexpr Format format_of(std::uint8_t) {
  return {GL_R8, GL_UNSIGNED_BYTE, 255};
}
constexpr Format format_of(std::int16_t) {
  return {GL_R16_SNORM, GL_SHORT, 32767};
}
constexpr Format format_of(std::uint16_t) {
  return {GL_R16, GL_UNSIGNED_SHORT, 65535};
}
constexpr Format format_of(float) {
  return {GL_R32F, GL_FLOAT, 1};
}

int divided_up(int value, int by) {
  return (value + by - 1) / by;
}

/// Makes the storage of the bound 3-D texture; false where the driver or its memory refuses the size.
bool allocate(const Format& format, const std::array<int, 3>& dims) {
  glTexImage3D(GL_PROXY_TEXTURE_3D, 0, format.internal, dims[0], dims[1], dims[2], 0, GL_RED, format.type, nullptr);
  GLint accepted = 0;
  glGetTexLevelParameteriv(GL_PROXY_TEXTURE_3D, 0, GL_TEXTURE_WIDTH, &accepted);
  while (glGetError() != GL_NO_ERROR) {
  }
  if (accepted == 0) return false;
  glTexImage3D(GL_TEXTURE_3D, 0, format.internal, dims[0], dims[1], dims[2], 0, GL_RED, format.type, nullptr);
  return glGetError() == GL_NO_ERROR;
}

/// Storage for the bound texture: one texel a voxel, or the smallest whole number of voxels a texel along each axis
/// that the driver accepts. False where none is.
bool allocate_reduced(const Format& format, const std::array<int, 3>& voxels, VolumeTexture& texture) {
  GLint limit = 0;
  glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &limit);
  for (std::size_t axis = 0; axis < 3; ++axis) texture.voxels_per_texel[axis] = divided_up(voxels[axis], limit);
  for (;;) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      texture.dims[axis] = divided_up(voxels[axis], texture.voxels_per_texel[axis]);
    }
    if (allocate(format, texture.dims)) return true;
    const auto longest = std::max_element(texture.dims.begin(), texture.dims.end());
    if (*longest == 1) return false;
    ++texture.voxels_per_texel[longest - texture.dims.begin()];
  }
}

/// Linear interpolation would spread a NaN to its neighbours: it is drawn as the lowest value instead.
float displayable(float value, float lowest) {
  return std::isfinite(value) ? value : lowest;
}

/// Uploads a frame whose texels each take the voxel in the middle of their block.
template <class T>
void upload_picked(const Volume& volume, const T* frame, const VolumeTexture& texture, const Format& format) {
  const auto& voxels = volume.geometry.dims;
  const auto& step = texture.voxels_per_texel;
  const auto middle = [&](int texel, std::size_t axis) {
    return static_cast<std::size_t>(std::min(texel * step[axis] + step[axis] / 2, voxels[axis] - 1));
  };
  const auto width = static_cast<std::size_t>(voxels[0]), height = static_cast<std::size_t>(voxels[1]);
  std::vector<T> slice(static_cast<std::size_t>(texture.dims[0]) * static_cast<std::size_t>(texture.dims[1]));
  for (int k = 0; k < texture.dims[2]; ++k) {
    auto out = slice.begin();
    for (int j = 0; j < texture.dims[1]; ++j) {
      const T* row = frame + (middle(k, 2) * height + middle(j, 1)) * width;
      for (int i = 0; i < texture.dims[0]; ++i) {
        const T value = row[middle(i, 0)];
        if constexpr (std::is_same_v<T, float>) {
          *out++ = displayable(value, static_cast<float>(volume.range_min));
        } else {
          *out++ = value;
        }
      }
    }
    glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, k, texture.dims[0], texture.dims[1], 1, GL_RED, format.type, slice.data());
  }
}

template <class T>
void upload_whole(const T* frame, const VolumeTexture& texture, const Format& format) {
  const std::size_t slice = static_cast<std::size_t>(texture.dims[0]) * static_cast<std::size_t>(texture.dims[1]);
  const int slab = std::max(1, static_cast<int>(slab_bytes / (slice * sizeof(T))));
  for (int k = 0; k < texture.dims[2]; k += slab) {
    glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, k, texture.dims[0], texture.dims[1], std::min(slab, texture.dims[2] - k),
                    GL_RED, format.type, frame + slice * static_cast<std::size_t>(k));
  }
}

template <class T>
std::optional<VolumeTexture> make_texture(const Volume& volume, const std::vector<T>& data, int frame) {
  const Format format = format_of(T{});
  VolumeTexture made;
  made.texture = gl::Texture::make();
  made.value_scale = format.value_scale;
  glBindTexture(GL_TEXTURE_3D, made.texture.name());
  if (!allocate_reduced(format, volume.geometry.dims, made)) return std::nullopt;
  made.bytes = sizeof(T);
  for (const int texels : made.dims) made.bytes *= static_cast<std::uint64_t>(texels);
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R}) {
    glTexParameteri(GL_TEXTURE_3D, axis, GL_CLAMP_TO_EDGE);
  }
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  const T* voxels = data.data() + volume.geometry.voxels() * static_cast<std::size_t>(frame);
  if (made.reduced() || std::is_same_v<T, float>) {
    upload_picked(volume, voxels, made, format);
  } else {
    upload_whole(voxels, made, format);
  }
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  return made;
}

std::string size_text(const std::array<int, 3>& dims) {
  return std::to_string(dims[0]) + " × " + std::to_string(dims[1]) + " × " + std::to_string(dims[2]);
}

std::string complaint_about(const Volume& volume, const std::optional<VolumeTexture>& texture) {
  const std::string start = "the volume (" + size_text(volume.geometry.dims) +
                            " voxels) is larger than the graphics memory or the 3-D textures of this driver hold";
  if (!texture) return start + " and is not shown; crop or resample it";
  return start + "; of every " + size_text(texture->voxels_per_texel) +
         " voxels one is shown, and it is edited at full resolution all the same (crop it to see every voxel)";
}

}  // namespace

const VolumeTexture* VolumeTextures::of(const std::shared_ptr<const Volume>& volume, int frame) {
  frame = std::clamp(frame, 0, std::max(0, volume->frames - 1));
  entries_.remove_if([](const Entry& entry) { return entry.volume.expired(); });
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.address == volume.get() && entry.frame == frame;
  });
  if (found != entries_.end()) {
    entries_.splice(entries_.begin(), entries_, found);
    return found->texture ? &*found->texture : nullptr;
  }
  const bool known =
      std::any_of(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.address == volume.get(); });
  Entry entry{volume, volume.get(), frame, std::nullopt};
  std::visit([&](const auto& data) { entry.texture = make_texture(*volume, data, frame); }, volume->data);
  if (!known && (!entry.texture || entry.texture->reduced()))
    complaint_ = (complaint_ ? *complaint_ + ' ' : "") + complaint_about(*volume, entry.texture);
  entries_.push_front(std::move(entry));
  make_room();
  return entries_.front().texture ? &*entries_.front().texture : nullptr;
}

void VolumeTextures::make_room() {
  std::uint64_t bytes = 0;
  std::size_t seen = 0;
  entries_.remove_if([&](const Entry& entry) {
    bytes += entry.texture ? entry.texture->bytes : 0;
    const bool in_use = ++seen <= 2;  // the image and its label map
    return !in_use && bytes > budget_bytes;
  });
}

std::optional<std::string> VolumeTextures::take_complaint() {
  return std::exchange(complaint_, std::nullopt);
}

}  // namespace homolog
