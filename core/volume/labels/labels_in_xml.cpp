#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/base/text/text.h"
#include "core/volume/labels/label_tables.h"
#include "core/volume/labels/named_labels.h"

namespace homolog {

namespace {

/// The text of an attribute of an XML element, without entities.
std::optional<std::string_view> attribute(std::string_view element, std::string_view name) {
  for (std::size_t at = 0; (at = element.find(name, at)) != element.npos; at += name.size()) {
    const std::string_view rest = element.substr(at + name.size());
    const bool begins = at > 0 && (element[at - 1] == ' ' || element[at - 1] == '\t' || element[at - 1] == '\n');
    if (!begins || rest.size() < 2 || rest[0] != '=' || (rest[1] != '"' && rest[1] != '\'')) continue;
    const auto end = rest.find(rest[1], 2);
    return end == rest.npos ? std::nullopt : std::optional(rest.substr(2, end - 2));
  }
  return {};
}

std::string without_entities(std::string_view text) {
  static constexpr std::array<std::pair<std::string_view, char>, 5> entities{
      {{"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}, {"&amp;", '&'}}};
  std::string plain;
  while (!text.empty()) {
    const auto* entity = std::find_if(entities.begin(), entities.end(),
                                      [&](const auto& known) { return text.starts_with(known.first); });
    plain += entity == entities.end() ? text.front() : entity->second;
    text.remove_prefix(entity == entities.end() ? 1 : entity->first.size());
  }
  return plain;
}

/// The text of an element, which may be given as CDATA.
std::string element_text(std::string_view text) {
  text = trimmed(text);
  constexpr std::string_view begin = "<![CDATA[";
  if (!text.starts_with(begin)) return without_entities(text);
  return std::string(text.substr(begin.size(), text.find("]]>") - begin.size()));
}

}  // namespace

Segmentation labels_of_xml(std::string_view text) {
  Segmentation labels;
  constexpr std::string_view begin = "<Label", end = "</Label>";
  for (std::size_t at = 0; (at = text.find(begin, at)) != text.npos;) {
    at += begin.size();
    if (at >= text.size() || (text[at] != ' ' && text[at] != '\t' && text[at] != '\n')) continue;  // <LabelTable>
    const auto close = text.find('>', at);
    if (close == text.npos) break;
    const std::string_view element = text.substr(at - 1, close - at + 1);
    const auto behind = text.find(end, close);
    if (behind == text.npos) break;
    const auto key = attribute(element, "Key");
    const std::array channels{attribute(element, "Red"), attribute(element, "Green"), attribute(element, "Blue")};
    std::optional<LabelColour> colour;
    LabelColour shares{};
    bool coloured = true;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto share = channels[c] ? as_number<double>(trimmed(*channels[c])) : std::nullopt;
      coloured = coloured && share && *share >= 0 && *share <= 1;
      if (coloured) shares[c] = static_cast<std::uint8_t>(std::lround(255 * *share));
    }
    if (coloured) colour = shares;
    if (const auto value = key ? label_in(*key) : std::nullopt)
      std::ignore = add_name(*value, element_text(text.substr(close + 1, behind - close - 1)), colour, labels);
    at = behind;
  }
  return labels;
}

}  // namespace homolog
