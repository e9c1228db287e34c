#include "core/volume/labels/slicer_segments.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>

#include "core/base/text/text.h"

namespace homolog {

namespace {

using SegmentKeys = std::map<std::string, std::string>;

/// The value of a pair: a line break and a backslash are escaped there.
std::string unescaped(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool escape = text[i] == '\\' && i + 1 < text.size() && (text[i + 1] == 'n' || text[i + 1] == '\\');
    if (escape) ++i;
    plain += escape && text[i] == 'n' ? '\n' : text[i];
  }
  return plain;
}

/// Three numbers from 0 to 1 with blanks between them.
std::optional<std::array<std::uint8_t, 3>> colour_of(std::string_view text) {
  std::array<std::uint8_t, 3> colour{};
  for (std::uint8_t& channel : colour) {
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
    double share = 0;
    const auto [after, error] = std::from_chars(text.data(), text.data() + text.size(), share);
    if (error != std::errc() || !(share >= 0 && share <= 1)) return {};
    channel = static_cast<std::uint8_t>(std::lround(255 * share));
    text.remove_prefix(static_cast<std::size_t>(after - text.data()));
  }
  return colour;
}

/// The terminology's one of the tags "KEY:VALUE|KEY:VALUE|".
std::string terminology_of(std::string_view tags) {
  constexpr std::string_view key = "TerminologyEntry:";
  while (!tags.empty()) {
    const auto bar = std::min(tags.find('|'), tags.size());
    if (tags.substr(0, bar).starts_with(key)) return segment_name(tags.substr(key.size(), bar - key.size()));
    tags.remove_prefix(std::min(bar + 1, tags.size()));
  }
  return {};
}

/// Each segment's keys by its number: "Segment12_Name" is key "Name" of segment 12.
std::map<int, SegmentKeys> keys_by_segment(const std::vector<std::pair<std::string, std::string>>& pairs) {
  constexpr std::string_view begin = "Segment";
  std::map<int, SegmentKeys> segments;
  for (const auto& [key, value] : pairs) {
    const std::string_view rest = std::string_view(key).substr(std::min(begin.size(), key.size()));
    const auto line = std::min(rest.find('_'), rest.size());
    const auto number = as_number<int>(rest.substr(0, line));
    if (number && *number >= 0 && line < rest.size())
      segments[*number].try_emplace(std::string(rest.substr(line + 1)), unescaped(value));
  }
  return segments;
}

}  // namespace

Segmentation slicer_segments(const std::filesystem::path& path,
                             const std::vector<std::pair<std::string, std::string>>& pairs, std::size_t layers,
                             std::vector<std::string>& warnings) {
  Segmentation result;
  std::size_t left_out = 0;
  for (auto& [number, keys] : keys_by_segment(pairs)) {
    const bool old = !keys.contains("LabelValue") && !keys.contains("Layer");
    const auto value = keys.contains("LabelValue") ? as_number<int>(keys["LabelValue"]) : 1;
    const auto layer = keys.contains("Layer") ? as_number<int>(keys["Layer"]) : old && layers > 1 ? number : 0;
    const bool there = value && layer && *layer >= 0 && static_cast<std::size_t>(*layer) < layers;
    if (!there || !result.add({.name = segment_name(keys["Name"]),
                               .value = *value,
                               .layer = static_cast<std::size_t>(*layer),
                               .colour = colour_of(keys["Color"]),
                               .terminology = terminology_of(keys["Tags"])})) {
      if (++left_out > 1) continue;
      const std::string name = keys["Name"].empty() ? keys["ID"] : keys["Name"];
      warnings.push_back(
          path.string() + ": describes its segment " + std::to_string(number) +
          (name.empty() ? "" : " (" + excerpt(segment_name(name)) + ")") +
          " by a label or a layer that it lacks or gives twice, so that it has no name; save it again in "
          "3D Slicer");
    }
  }
  if (left_out > 1) warnings.back() += "; " + std::to_string(left_out) + " segments are like this";
  return result;
}

}  // namespace homolog
