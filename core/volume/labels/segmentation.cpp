#include "core/volume/labels/segmentation.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "core/base/text/listed.h"
#include "core/base/text/nearest_names.h"
#include "core/base/text/text.h"

namespace homolog {

namespace {

std::vector<std::string> comma_separated(std::string_view text) {
  std::vector<std::string> parts;
  while (true) {
    const auto comma = std::min(text.find(','), text.size());
    parts.emplace_back(trimmed(text.substr(0, comma)));
    if (comma == text.size()) return parts;
    text.remove_prefix(comma + 1);
  }
}

/// A whole number above 0.
std::optional<int> label_value(std::string_view text) {
  const auto value = as_number<int>(text);
  return value && *value > 0 ? value : std::nullopt;
}

/// In lower case and sorted.
std::vector<std::string> sorted_words(const std::string& name) {
  std::vector<std::string> words;
  bool within = false;
  for (const char c : lower_case(name)) {
    const bool parts = std::string_view(" _-.").find(c) != std::string_view::npos;
    if (!parts && !within) words.emplace_back();
    if (!parts) words.back() += c;
    within = !parts;
  }
  std::ranges::sort(words);
  return words;
}

/// All whose names are likest to that one.
std::vector<Segment> segments_named(const std::string& name, const Segmentation& known) {
  std::vector<Segment> found;
  NameLikeness most = NameLikeness::none;
  for (const Segment& segment : known.segments) {
    const NameLikeness likeness = name_likeness(segment.name, name);
    if (likeness == NameLikeness::none || likeness < most) continue;
    if (likeness > most) found.clear();
    most = likeness;
    found.push_back(segment);
  }
  return found;
}

/// "label 1 in layers 0 and 1"
std::string in_layers(int value, const std::vector<Segment>& segments) {
  std::vector<std::string> numbers;
  for (const Segment& segment : segments) numbers.push_back(std::to_string(segment.layer));
  return "label " + std::to_string(value) + " in layers " + listed(numbers, " and ");
}

Result<Segment> segment_of_value(int value, const Segmentation& known) {
  std::vector<Segment> found;
  std::vector<std::string> names;
  for (const Segment& segment : known.segments) {
    if (segment.value != value) continue;
    found.push_back(segment);
    if (!segment.name.empty()) names.push_back(segment.name);
  }
  if (found.empty()) return Segment{.name = {}, .value = value};
  if (found.size() == 1) return found.front();
  return fail("", "has " + in_layers(value, found) + ", so that it does not tell which segment is meant; " +
                      (names.size() == found.size() ? "give its name (" + listed(names, " or ") + ")"
                                                    : "export that segment alone as a label map"));
}

Result<Segment> segment_of_name(const std::string& name, const Segmentation& known) {
  const auto found = segments_named(name, known);
  if (found.size() == 1) return found.front();
  if (found.size() > 1) {
    std::vector<std::string> all;
    for (const Segment& segment : found) all.push_back(label_words(segment));
    return fail("", "gives the name " + excerpt(name) + " to several segments (" + listed(all, " and ") +
                        "); give the number of the one that is meant");
  }
  std::vector<std::string> names;
  for (const Segment& segment : known.segments)
    if (!segment.name.empty()) names.push_back(segment.name);
  if (names.empty() && !known.unread.empty())
    return fail("", "names none of its labels, since " + known.unread + ", so that " + excerpt(name) +
                        " cannot be found; correct that file, or give the label's number");
  if (names.empty())
    return fail("", "names none of its labels, so that " + excerpt(name) + " cannot be found; give its number");
  constexpr std::size_t most = 3;
  std::vector<std::string> nearest;
  for (const std::string& near : nearest_names(name, names, most)) nearest.push_back('"' + excerpt(near) + '"');
  return fail("",
              "has no label named \"" + excerpt(name) + "\"; the nearest names in it are " + listed(nearest, " and "));
}

bool before(const Segment& segment, const std::pair<std::size_t, int>& place) {
  return std::pair(segment.layer, segment.value) < place;
}

}  // namespace

const Segment* Segmentation::find(int value, std::size_t layer) const {
  const auto at = std::lower_bound(segments.begin(), segments.end(), std::pair(layer, value), before);
  return at == segments.end() || at->layer != layer || at->value != value ? nullptr : &*at;
}

const Segment* Segmentation::find(int value) const {
  const auto found = std::find_if(segments.begin(), segments.end(), [&](const Segment& s) { return s.value == value; });
  return found == segments.end() ? nullptr : &*found;
}

bool Segmentation::add(Segment segment) {
  constexpr std::size_t most = 16384;
  if (segments.size() >= most || find(segment.value, segment.layer)) return false;
  const auto at = std::lower_bound(segments.begin(), segments.end(), std::pair(segment.layer, segment.value), before);
  segments.insert(at, std::move(segment));
  return true;
}

NameLikeness name_likeness(const std::string& a, const std::string& b) {
  if (a == b) return NameLikeness::same;
  if (lower_case(a) == lower_case(b)) return NameLikeness::any_case;
  const auto words = sorted_words(a);
  return !words.empty() && words == sorted_words(b) ? NameLikeness::words : NameLikeness::none;
}

std::string label_words(const Segment& segment) {
  const std::string number = "label " + std::to_string(segment.value);
  return segment.name.empty() ? number : number + " (" + excerpt(segment.name) + ")";
}

std::string segment_name(std::string_view text) {
  text = trimmed(text);
  if (is_utf8(text)) return printable(text);
  std::string name;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x80) name += static_cast<char>(0xc0 | (byte >> 6));
    name += static_cast<char>(byte < 0x80 ? byte : 0x80 | (byte & 0x3f));
  }
  return printable(name);
}

Result<std::vector<Segment>> asked_segments(const std::string& asked, const Segmentation& known) {
  const std::string whole(trimmed(asked));
  const bool one_name = !label_value(whole) && !segments_named(whole, known).empty();  // it may hold a comma
  std::vector<Segment> segments;
  for (const std::string& part : one_name ? std::vector{whole} : comma_separated(whole)) {
    const auto value = label_value(part);
    auto segment = value ? segment_of_value(*value, known) : segment_of_name(part, known);
    if (!segment) return fail(segment.error());
    segments.push_back(std::move(*segment));
  }
  return segments;
}

bool is_bad_label(const std::string& asked) {
  const auto parts = comma_separated(asked);
  if (std::any_of(parts.begin(), parts.end(), [](const std::string& part) { return part.empty(); })) return true;
  const bool numbers = asked.find_first_not_of("0123456789 ,;.+-") == asked.npos;
  return numbers && !std::all_of(parts.begin(), parts.end(), [](const std::string& p) { return label_value(p); });
}

}  // namespace homolog
