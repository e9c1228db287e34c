#include "render/label_colours.h"

#include <cmath>

namespace homolog {

Rgb label_colour(int label) {
  if (label <= 0) return {0, 0, 0};
  const int turn = (label - 1) % label_colour_count;
  // Golden-ratio steps never bring two early labels near each other on the hue circle; the start makes label 1 teal,
  // which neither bone nor vessels nor the hues of the planes suggest.
  return hsv_to_rgb(std::fmod(0.47f + 0.618034f * static_cast<float>(turn), 1.0f), turn % 2 == 0 ? 0.75f : 0.6f, 1);
}

Rgb label_colour(int label, const std::map<int, Rgb>* own) {
  if (own == nullptr) return label_colour(label);
  const auto found = own->find(label);
  return found == own->end() ? label_colour(label) : found->second;
}

}  // namespace homolog
