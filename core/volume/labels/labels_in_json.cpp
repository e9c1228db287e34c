#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/encoding/json.h"
#include "core/base/pictures/colour.h"
#include "core/base/text/text.h"
#include "core/volume/labels/label_tables.h"
#include "core/volume/labels/named_labels.h"

namespace homolog {

namespace {

using Json = nlohmann::json;

std::optional<int> label_in_json(const Json& value) {
  if (value.is_string()) return label_in(value.get<std::string>());
  if (!value.is_number()) return {};
  const double number = value.get<double>();
  if (!(number >= 0 && number <= 1e9) || number != std::floor(number)) return {};
  return static_cast<int>(number);
}

const Json* member_of(const Json& object, std::span<const char* const> names) {
  for (const char* name : names)
    if (const auto found = object.find(name); found != object.end()) return &*found;
  return nullptr;
}

/// A list of objects, one a label.
Result<Segmentation> labels_of_list(const Json& list) {
  static constexpr std::array values{"value", "label", "labelValue", "id", "index"};
  static constexpr std::array names{"name", "structure"}, colours{"colour", "color"};
  Segmentation labels;
  for (const Json& one : list) {
    const Json* value = one.is_object() ? member_of(one, values) : nullptr;
    const Json* name = value ? member_of(one, names) : nullptr;
    if (!name || !label_in_json(*value)) return Segmentation();
    if (!name->is_string()) continue;  // null: it has none
    const Json* colour = member_of(one, colours);
    const bool hex = colour != nullptr && colour->is_string();
    if (auto added = add_name(*label_in_json(*value), name->get<std::string>(),
                              hex ? colour_from_hex(lower_case(colour->get<std::string>())) : std::nullopt, labels);
        !added)
      return fail(added.error());
  }
  return labels;
}

/// Labels of members all of which are value and name; `lists`: values may be lists of values (nnU-Net's regions), which
/// name no label.
Result<Segmentation> labels_of_members(const Json& object, bool lists) {
  Segmentation labels;
  for (const auto& [key, value] : object.items()) {
    const auto value_first = label_in(std::string_view(key));
    const auto value_last = value.is_number() ? label_in_json(value) : std::nullopt;
    if (lists && value.is_array()) continue;
    if (!(value_first && value.is_string()) && !value_last) return Segmentation();
    auto added = value_last ? add_name(*value_last, key, {}, labels)
                            : add_name(*value_first, value.get<std::string>(), {}, labels);
    if (!added) return fail(added.error());
  }
  return labels;
}

Result<Segmentation> labels_in_json(const Json& json) {
  if (json.is_array()) return labels_of_list(json);
  if (!json.is_object()) return Segmentation();
  const auto labels = json.find("labels");
  if (labels == json.end()) return labels_of_members(json, false);
  if (labels->is_array()) return labels_of_list(*labels);
  return labels->is_object() ? labels_of_members(*labels, true) : Segmentation();
}

}  // namespace

Result<Segmentation> labels_of_json(std::string_view text) {
  const auto json = read_json<Json>(text);
  if (!json) return fail("", "is no JSON (" + json.error().what + ")");
  auto labels = labels_in_json(*json);
  if (!labels || labels->segments.empty()) return labels;
  // The parser keeps one of two values of a key, so that the other name would be lost.
  if (const auto twice = doubled_key(text)) return fail("", "has the key \"" + excerpt(*twice) + "\" twice");
  return labels;
}

}  // namespace homolog
