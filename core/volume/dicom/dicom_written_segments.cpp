#include "core/volume/dicom/dicom_written_segments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <string_view>

#include "core/base/numbers/geometry.h"
#include "core/base/text/text.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t longest_label = 64, longest_description = 1024, longest_code = 16;

/// sRGB as CIELab in 16 bits with the white point that is read too.
std::vector<std::uint16_t> lab_of(const std::array<std::uint8_t, 3>& colour) {
  Vec3 rgb;
  for (int c = 0; c < 3; ++c) {
    const double share = colour[c] / 255.0;
    rgb[c] = share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
  }
  Mat3 to_xyz;
  to_xyz << 0.4124564, 0.3575761, 0.1804375, 0.2126729, 0.7151522, 0.0721750, 0.0193339, 0.1191920, 0.9503041;
  const Vec3 xyz = (to_xyz * rgb).cwiseQuotient(Vec3(0.950456, 1, 1.088754));
  const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; };
  const double l = 116 * f(xyz.y()) - 16, a = 500 * (f(xyz.x()) - f(xyz.y())), b = 200 * (f(xyz.y()) - f(xyz.z()));
  const auto stored = [](double share) {
    return static_cast<std::uint16_t>(std::lround(65535 * std::clamp(share, 0.0, 1.0)));
  };
  return {stored(l / 100), stored((a + 128) / 255), stored((b + 128) / 255)};
}

/// The first characters of a text in UTF-8.
std::string first_characters(const std::string& text, std::size_t most) {
  std::size_t characters = 0, end = 0;
  for (; end < text.size(); ++end)
    if ((static_cast<unsigned char>(text[end]) & 0xc0) != 0x80 && ++characters > most) break;
  return text.substr(0, end);
}

std::string name_of(const Segment& segment) {
  return segment.name.empty() ? "Label " + std::to_string(segment.value) : segment.name;
}

/// The labels of segments. A backslash divides values, so that none may hold it. Names that are alike stay so; others
/// that would become so get their segment's number.
std::vector<std::string> labels_for(const std::vector<WrittenSegment>& segments) {
  std::vector<std::string> labels;
  std::set<std::string> names, taken;
  for (const WrittenSegment& one : segments) names.insert(name_of(one.segment));
  for (const WrittenSegment& one : segments) {
    const std::string name = name_of(one.segment);
    std::string whole = name;
    std::replace(whole.begin(), whole.end(), '\\', '/');
    std::string label = first_characters(whole, longest_label);
    if (label != name) {
      const std::string number = " (" + std::to_string(one.number) + ")";
      if (names.contains(label) || taken.contains(label))
        label = first_characters(whole, longest_label - number.size()) + number;
      taken.insert(label);
    }
    labels.push_back(std::move(label));
  }
  return labels;
}

std::vector<std::string_view> parts_of(std::string_view text, char between) {
  std::vector<std::string_view> parts;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(between, at), text.size());
    parts.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return parts;
}

/// A code "SCHEME^VALUE^MEANING"; nothing where it is none, or DICOM has no place for it.
std::optional<DicomElements> code_of(std::string_view text) {
  const auto parts = parts_of(text, '^');
  if (parts.size() != 3) return {};
  const std::string scheme(trimmed(parts[0])), value(trimmed(parts[1])), meaning(trimmed(parts[2]));
  if (scheme.empty() || value.empty() || meaning.empty() || text.find('\\') != std::string_view::npos) return {};
  if (scheme.size() > longest_code || value.size() > longest_code) return {};
  if (first_characters(meaning, longest_label) != meaning) return {};
  return coded(value, scheme, meaning);
}

/// What a segment is of.
struct SegmentCodes {
  DicomElements category, type;
  std::optional<DicomElements> region;
};

/// Of 3D Slicer's entry "CONTEXT~CATEGORY~TYPE~MODIFIER~CONTEXT~REGION~MODIFIER"; nothing where a code of it has no
/// place.
std::optional<SegmentCodes> codes_of(const std::string& terminology) {
  auto parts = parts_of(terminology, '~');
  parts.resize(std::max<std::size_t>(parts.size(), 7));
  const auto is_there = [](std::string_view code) { return code.find_first_not_of("^ ") != std::string_view::npos; };
  /// A code with another that modifies it.
  const auto read = [&](std::size_t at, std::size_t modifier, DicomTag tag) -> std::optional<DicomElements> {
    auto code = code_of(parts[at]);
    if (!code || !is_there(parts[modifier])) return code;
    const auto modified = code_of(parts[modifier]);
    if (!modified) return {};
    return code->put_items(tag, {*modified});
  };
  const auto category = code_of(parts[1]);
  const auto type = read(2, 3, 0x00620011);
  if (!category || !type) return {};
  SegmentCodes codes{*category, *type, {}};
  if (!is_there(parts[5])) return codes;
  codes.region = read(5, 6, 0x00082220);
  return codes.region ? std::optional(codes) : std::nullopt;
}

SegmentCodes some_structure() {
  const DicomElements structure = coded("91723000", "SCT", "Anatomical Structure");
  return {structure, structure, {}};
}

}  // namespace

DicomElements coded(const std::string& value, const std::string& scheme, const std::string& meaning) {
  DicomElements code;
  code.put(0x00080100, "SH", value).put(0x00080102, "SH", scheme).put(0x00080104, "LO", meaning);
  return code;
}

std::vector<DicomElements> described_segments(const fs::path& path, const std::vector<WrittenSegment>& segments,
                                              std::vector<std::string>& warnings) {
  const std::vector<std::string> labels = labels_for(segments);
  std::vector<DicomElements> described;
  std::string first_changed, first_without_codes;
  std::size_t changed = 0, without_codes = 0;
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const WrittenSegment& one = segments[s];
    const std::string name = name_of(one.segment);
    const auto own = one.segment.terminology.empty() ? std::nullopt : codes_of(one.segment.terminology);
    const SegmentCodes codes = own ? *own : some_structure();
    DicomElements segment;
    segment.put_items(0x00620003, {codes.category})
        .put_shorts(0x00620004, {static_cast<std::uint16_t>(one.number)})
        .put(0x00620005, "LO", labels[s])
        .put(0x00620008, "CS", "SEMIAUTOMATIC")
        .put(0x00620009, "LO", "Homolog")
        .put_items(0x0062000f, {codes.type});
    if (codes.region) segment.put_items(0x00082218, {*codes.region});
    if (labels[s] != name) {
      segment.put(0x00620006, "ST", first_characters(name, longest_description));
      if (changed++ == 0) first_changed = "\"" + excerpt(name) + "\" became \"" + excerpt(labels[s]) + "\"";
    }
    if (!own && !one.segment.terminology.empty() && without_codes++ == 0)
      first_without_codes = label_words(one.segment);
    if (one.segment.colour) segment.put_shorts(0x0062000d, lab_of(*one.segment.colour));
    described.push_back(std::move(segment));
  }
  const auto others = [](std::size_t count) {
    return count < 2 ? std::string() : ", and " + std::to_string(count - 1) + (count == 2 ? " other" : " others");
  };
  if (changed > 0)
    warnings.push_back(path.string() + ": " + first_changed + others(changed) +
                       ", since names of segments have up to 64 characters and no backslash; whole names are in the "
                       "descriptions (SegmentDescription)");
  if (without_codes > 0)
    warnings.push_back(path.string() + ": says of " + first_without_codes + others(without_codes) +
                       " only that it is an anatomical structure, since a code of its terminology is damaged or too "
                       "long (16 characters, 64 of its meaning)");
  return described;
}

}  // namespace homolog
