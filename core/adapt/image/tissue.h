#pragma once

#include <Eigen/Core>

#include "core/adapt/image/profiles.h"

namespace homolog {

/// How much more an intensity belongs to the organ than to what surrounds it, by the intensities on both sides of a
/// mesh that lies about right.
class Tissue {
 public:
  /// `profiles` of the mesh: what lies between 3 and 12 mm within and without is counted.
  explicit Tissue(const Profiles& profiles);

  /// (p_in − p_out) / (p_in + p_out): −1 never in the organ … 1 only there; 0 where nothing is known.
  float belongs(float intensity) const;

 private:
  float low_ = 0, high_ = 1;
  Eigen::ArrayXf balance_;  ///< one value for each bin of intensity
};

}  // namespace homolog
