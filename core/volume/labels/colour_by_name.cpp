#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/text/text.h"
#include "core/volume/labels/segmentation.h"

namespace homolog {
namespace {

using Colour = std::array<std::uint8_t, 3>;

/// Twelve that differ by 20 or more in CIELAB for everybody: as seen with all cones, and without those for long, middle
/// or short waves [Machado et al. 2009].
constexpr std::array<Colour, 12> colours{{{128, 96, 0},
                                          {192, 160, 224},
                                          {192, 224, 0},
                                          {96, 64, 224},
                                          {192, 0, 96},
                                          {224, 128, 0},
                                          {128, 160, 96},
                                          {96, 128, 224},
                                          {160, 224, 192},
                                          {224, 192, 96},
                                          {192, 128, 160},
                                          {192, 0, 160}}};

struct Known {
  std::string_view name;  ///< its letters and digits, without the side
  std::size_t colour;
};

/// Structures that are often in one map have colours of their own; those of another part of the body may share them.
constexpr Known known_structures[] = {
    // abdomen and pelvis
    {"liver", 0},
    {"urinarybladder", 1},
    {"bladder", 1},
    {"gallbladder", 2},
    {"spleen", 3},
    {"aorta", 4},
    {"kidney", 5},
    {"colon", 6},
    {"inferiorvenacava", 7},
    {"postcava", 7},
    {"duodenum", 8},
    {"pancreas", 9},
    {"stomach", 10},
    {"adrenalgland", 11},
    {"prostate", 5},
    {"rectum", 10},
    {"uterus", 11},
    {"tumor", 2},
    {"tumour", 2},
    {"cyst", 8},
    // chest
    {"lung", 1},
    {"lungupperlobe", 1},
    {"lunglowerlobe", 3},
    {"lungmiddlelobe", 8},
    {"trachea", 2},
    {"esophagus", 9},
    {"oesophagus", 9},
    {"pulmonaryartery", 7},
    {"heart", 11},
    {"heartatrium", 10},
    {"heartventricle", 5},
    {"ventricle", 5},
    {"atrium", 10},
    {"heartmyocardium", 0},
    {"myocardium", 0},
    // bones
    {"humerus", 0},
    {"ulna", 1},
    {"patella", 2},
    {"tibia", 3},
    {"radius", 4},
    {"femur", 5},
    {"sternum", 6},
    {"scapula", 7},
    {"fibula", 8},
    {"hip", 9},
    {"pelvis", 9},
    {"skull", 9},
    {"mandible", 10},
    {"clavicle", 11},
    {"clavicula", 11},
    // brain
    {"pallidum", 0},
    {"lateralventricle", 1},
    {"putamen", 2},
    {"caudate", 3},
    {"amygdala", 4},
    {"thalamus", 5},
    {"brainstem", 6},
    {"3rdventricle", 7},
    {"accumbensarea", 8},
    {"accumbens", 8},
    {"hippocampus", 9},
    {"cerebralcortex", 10},
    {"cerebellum", 11},
    {"cerebellumcortex", 11},
};

enum class Side { none, left, right };

/// The words of a name in lower case, without that of the side.
struct Words {
  std::vector<std::string> list;
  Side side = Side::none;

  explicit Words(const std::string& name) {
    std::string word;
    for (const char c : lower_case(name) + " ") {
      if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'))
        word += c;
      else if (!word.empty())
        take(std::exchange(word, ""));
    }
  }
  std::string joined() const {
    std::string all;
    for (const std::string& word : list) all += word;
    return all;
  }

 private:
  void take(std::string word) {
    static constexpr struct {
      std::string_view word;
      Side side;
    } sides[] = {{"left", Side::left},   {"l", Side::left},  {"lh", Side::left},
                 {"right", Side::right}, {"r", Side::right}, {"rh", Side::right}};
    for (const auto& one : sides) {
      const bool whole = word == one.word;
      const bool part = one.word.size() > 2 && (word.starts_with(one.word) || word.ends_with(one.word));
      if (side != Side::none || (!whole && !part)) continue;
      side = one.side;
      word.erase(word.starts_with(one.word) ? 0 : word.size() - one.word.size(), one.word.size());
    }
    if (!word.empty()) list.push_back(std::move(word));
  }
};

/// The number at the end of a text, which is taken off it.
std::optional<std::size_t> number_behind(std::string& text) {
  const std::size_t digits = text.size() - (text.find_last_not_of("0123456789") + 1);
  if (digits == 0 || digits > 4) return {};
  const std::size_t number = std::stoul(text.substr(text.size() - digits));
  text.resize(text.size() - digits);
  return number;
}

/// Counted down the spine from the first vertebra of the neck, from names such as "vertebrae_L1", "L1" and
/// "disc_L1_L2": of a disc that of the vertebra above it.
std::optional<std::size_t> level_of_spine(const Words& words) {
  static constexpr struct {
    std::string_view part;
    std::size_t before;
  } parts[] = {{"c", 0}, {"t", 7}, {"l", 19}, {"s", 24}};
  const std::string all = words.joined();
  const bool spinal = words.list.size() == 1 || all.starts_with("vert") || all.starts_with("dis");
  if (all == "sacrum") return 25;
  for (std::string word : words.list)
    if (const auto number = number_behind(word); number && spinal)
      for (const auto& one : parts)
        if (word == one.part) return one.before + *number;
  return {};
}

std::size_t hashed(const std::string& key) {
  std::uint32_t hash = 2166136261;  // FNV-1a: the same on every machine
  for (const char c : key) hash = (hash ^ static_cast<std::uint8_t>(c)) * 16777619;
  return hash;
}

std::size_t place_of(const Words& words) {
  std::string key = words.joined();
  if (const auto level = level_of_spine(words)) return *level + (key.starts_with("dis") ? colours.size() / 2 : 0);
  for (const Known& known : known_structures)
    if (key == known.name || key == std::string(known.name) + "s") return known.colour;
  const auto number = number_behind(key);  // neighbours in a row, as ribs are, differ
  return hashed(key) + number.value_or(0);
}

}  // namespace

Colour colour_by_name(const std::string& name) {
  const Words words(name);
  Colour colour = colours[place_of(words) % colours.size()];
  constexpr int share = 5;  // of the way to white or black
  for (std::uint8_t& channel : colour)
    if (words.side == Side::left)
      channel = static_cast<std::uint8_t>(channel + (255 - channel) / share);
    else if (words.side == Side::right)
      channel = static_cast<std::uint8_t>(channel - channel / share);
  return colour;
}

}  // namespace homolog
