#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

// Colours as eyes see them.

namespace homolog::test {

/// Red, green and blue light, 0…1, linear.
using Light = std::array<double, 3>;

/// The light of a colour in sRGB, 0…1.
inline Light light_of(const std::array<double, 3>& srgb) {
  Light light{};
  for (std::size_t k = 0; k < 3; ++k)
    light[k] = srgb[k] <= 0.04045 ? srgb[k] / 12.92 : std::pow((srgb[k] + 0.055) / 1.055, 2.4);
  return light;
}

/// CIE L*a*b* for D65.
inline std::array<double, 3> lab_of(const Light& light) {
  const auto [r, g, b] = light;
  const std::array<double, 3> share{(0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505,
                                    0.2126 * r + 0.7152 * g + 0.0722 * b,
                                    (0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089};
  std::array<double, 3> f{};
  for (std::size_t k = 0; k < 3; ++k) f[k] = share[k] > 0.008856 ? std::cbrt(share[k]) : 7.787 * share[k] + 16.0 / 116;
  return {116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])};
}

/// The distance in L*a*b*; from about 2 on two colours that touch are told apart.
inline double colour_difference(const Light& a, const Light& b) {
  const auto p = lab_of(a), q = lab_of(b);
  return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
}

/// How light is seen: by all three kinds of cones, or without the one for long, middle or short waves [Machado,
/// Oliveira and Fernandes 2009, A Physiologically-based Model for Simulation of Color Vision Deficiency, severity 1].
struct ColourVision {
  const char* name;
  std::array<Light, 3> rows;

  Light seen(const Light& light) const {
    Light result{};
    for (std::size_t k = 0; k < 3; ++k)
      result[k] = std::clamp(rows[k][0] * light[0] + rows[k][1] * light[1] + rows[k][2] * light[2], 0.0, 1.0);
    return result;
  }
};
inline constexpr std::array<ColourVision, 4> colour_visions{{
    {"all cones", {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}},
    {"protanopia",
     {{{0.152286, 1.052583, -0.204868}, {0.114503, 0.786281, 0.099216}, {-0.003882, -0.048116, 1.051998}}}},
    {"deuteranopia",
     {{{0.367322, 0.860646, -0.227968}, {0.280085, 0.672501, 0.047413}, {-0.011820, 0.042940, 0.968881}}}},
    {"tritanopia",
     {{{1.255528, -0.076749, -0.178779}, {-0.078411, 0.930809, 0.147602}, {0.004733, 0.691367, 0.303900}}}},
}};

}  // namespace homolog::test
