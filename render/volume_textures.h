#pragma once

#include <array>
#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <string>

#include "core/volume/volume.h"
#include "render/gl.h"

namespace homolog {

/// One frame of a volume on the GPU.
struct VolumeTexture {
  gl::Texture texture;  ///< clamped to its edge; who binds it chooses nearest or linear
  /// Voxels along each axis that one texel stands for; 1 where the volume fits.
  std::array<int, 3> voxels_per_texel{1, 1, 1};
  std::array<int, 3> dims{0, 0, 0};  ///< texels
  float value_scale = 1;             ///< intensity = value_scale · what the shader samples

  std::uint64_t bytes = 0;

  bool reduced() const { return voxels_per_texel != std::array<int, 3>{1, 1, 1}; }
};

/// Frames of volumes on the GPU, uploaded when first asked for and kept while their volume lives, the least recently
/// used given up beyond a budget: a cine that fits plays without uploads.
class VolumeTextures {
 public:
  /// Null where the GPU's memory does not hold even a reduced frame. `frame` is clamped to those there are. The
  /// pointer is good through the next call, so that an image and its label map can be held together.
  const VolumeTexture* of(const std::shared_ptr<const Volume>& volume, int frame);

  /// The sentence about a volume that is shown reduced or not at all; given once a volume.
  std::optional<std::string> take_complaint();

 private:
  struct Entry {
    std::weak_ptr<const Volume> volume;  ///< keeps the address from being another volume's, not the voxels in memory
    const Volume* address = nullptr;
    int frame = 0;
    std::optional<VolumeTexture> texture;  ///< none: it does not fit the GPU
  };
  void make_room();

  std::list<Entry> entries_;  ///< most recently used first
  std::optional<std::string> complaint_;
};

}  // namespace homolog
