#pragma once

#include <memory>

#include "core/base/result.h"

namespace homolog {

/// A picture with depth of the meshes that are seen through, made and laid in by Renderer. It saves drawing them again
/// while only other things move. It is laid in as one surface: what lies between two of its meshes is covered by both.
class FaintLayer {
 public:
  /// Errors: the graphics memory has no room for it.
  static Result<FaintLayer> make(int width_px, int height_px);
  FaintLayer(FaintLayer&& other) noexcept;
  FaintLayer& operator=(FaintLayer&& other) noexcept;
  ~FaintLayer();
  int width_px() const;
  int height_px() const;

 private:
  friend class Renderer;
  struct Parts;
  explicit FaintLayer(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace homolog
