#include "core/mesh/formats/space.h"

#include <algorithm>
#include <cctype>

#include "core/base/text/text.h"
#include "core/mesh/formats/text.h"

namespace homolog::formats {
namespace {

constexpr std::string_view space_key = "space";

bool continues_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
}

std::size_t after_blanks(std::string_view text, std::size_t at) {
  while (at < text.size() && (text[at] == ' ' || text[at] == '\t')) ++at;
  return at;
}

bool is_known(const std::string& name) {
  return lower_case(name) == "lps" || lower_case(name) == "ras";
}

}  // namespace

bool SpaceNames::look_in(std::string_view text) {
  const std::size_t before = names_.size();
  const std::string lower = lower_case(std::string(text));
  for (std::size_t key = lower.find(space_key); key != std::string::npos; key = lower.find(space_key, key + 1)) {
    if (key > 0 && continues_word(lower[key - 1])) continue;
    std::size_t at = after_blanks(text, key + space_key.size());
    if (at == text.size() || text[at] != '=') continue;
    at = after_blanks(text, at + 1);
    std::size_t end = at;
    while (end < text.size() && continues_word(text[end])) ++end;
    const std::string name(text.substr(at, end - at));
    // In lower case it may be any other remark.
    if (text.substr(key, space_key.size()) == "SPACE" || is_known(name)) add(name);
  }
  return names_.size() > before;
}

void SpaceNames::add(std::string_view name) {
  while (!name.empty() && is_space(name.front())) name.remove_prefix(1);
  while (!name.empty() && is_space(name.back())) name.remove_suffix(1);
  if (!name.empty()) names_.emplace_back(name);
}

void SpaceNames::apply_to(MeshFile& mesh) const {
  if (names_.empty()) return;
  const auto found = std::find_if(names_.begin(), names_.end(), is_known);
  const std::string taken = found == names_.end() ? "LPS" : lower_case(*found) == "ras" ? "RAS" : "LPS";
  for (const std::string& name : names_)
    if (!is_known(name)) {
      mesh.warnings.push_back("gives its space as \"" + excerpt(name) +
                              "\", which is neither LPS nor RAS; its coordinates are taken as " + taken +
                              ", so check where it lies");
      break;
    }
  const bool both = std::any_of(names_.begin(), names_.end(), [&](const std::string& name) {
    return is_known(name) && lower_case(name) != lower_case(taken);
  });
  if (both)
    mesh.warnings.push_back("names both LPS and RAS as its space; its coordinates are taken as " + taken +
                            ", which it names first, so check where it lies");
  if (taken != "RAS") return;
  mesh.points.leftCols<2>() *= -1;
  for (Landmark& landmark : mesh.landmarks) landmark.position.head<2>() *= -1;
}

}  // namespace homolog::formats
