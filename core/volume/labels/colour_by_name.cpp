#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
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

/// For structures of one map that would have the same: they differ by 11 or more from one another and from those above,
/// for everybody, the first by the most.
constexpr std::array<Colour, 24> further_colours{
    {{96, 255, 255},  {144, 64, 48},   {0, 80, 128},    {255, 64, 64},   {128, 32, 176},  {128, 0, 255},
     {255, 160, 144}, {255, 48, 240},  {240, 240, 112}, {96, 208, 208},  {144, 255, 144}, {208, 96, 176},
     {0, 128, 112},   {112, 64, 0},    {176, 176, 96},  {192, 208, 255}, {144, 128, 48},  {224, 64, 128},
     {192, 160, 160}, {192, 240, 176}, {160, 96, 80},   {160, 0, 64},    {160, 192, 48},  {128, 96, 176}}};

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

/// The place that a structure known here has.
std::optional<std::size_t> known_place(const Words& words) {
  const std::string key = words.joined();
  if (const auto level = level_of_spine(words)) return *level + (key.starts_with("dis") ? colours.size() / 2 : 0);
  for (const Known& known : known_structures)
    if (key == known.name || key == std::string(known.name) + "s") return known.colour;
  return {};
}

std::size_t place_of(const Words& words) {
  if (const auto known = known_place(words)) return *known % colours.size();
  std::string key = words.joined();
  const auto number = number_behind(key);  // neighbours in a row, as ribs are, differ
  return (hashed(key) + number.value_or(0)) % colours.size();
}

Colour shaded(Colour colour, Side side) {
  constexpr int share = 5;  // a part of the way to white or black
  for (std::uint8_t& channel : colour)
    if (side == Side::left)
      channel = static_cast<std::uint8_t>(channel + (255 - channel) / share);
    else if (side == Side::right)
      channel = static_cast<std::uint8_t>(channel - channel / share);
  return colour;
}

}  // namespace

Colour colour_by_name(const std::string& name) {
  const Words words(name);
  return shaded(colours[place_of(words)], words.side);
}

void colour_by_names(Segmentation& segmentation) {
  // Both of a pair are one entry. Structures that are known come first; the order in the map does not matter.
  std::map<std::pair<bool, std::string>, std::size_t> places;
  const auto key_of = [](const Words& words) { return std::pair(!known_place(words).has_value(), words.joined()); };
  for (const Segment& segment : segmentation.segments)
    if (const Words words(segment.name); !segment.colour && !segment.name.empty())
      places.emplace(key_of(words), place_of(words));
  std::array<std::size_t, colours.size() + further_colours.size()> uses{};
  std::vector<std::size_t*> rivals;
  for (auto& [key, place] : places)
    if (uses[place] == 0)
      uses[place] = 1;
    else
      rivals.push_back(&place);
  for (std::size_t* const place : rivals) {
    *place = static_cast<std::size_t>(std::ranges::min_element(uses) - uses.begin());
    ++uses[*place];
  }
  for (Segment& segment : segmentation.segments) {
    if (segment.colour || segment.name.empty()) continue;
    const Words words(segment.name);
    const std::size_t place = places.at(key_of(words));
    segment.colour =
        shaded(place < colours.size() ? colours[place] : further_colours[place - colours.size()], words.side);
  }
}

}  // namespace homolog
