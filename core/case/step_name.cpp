#include "core/case/step_name.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>

#include "core/base/files/file_stem.h"
#include "core/base/text/text.h"
#include "core/case/edit_words.h"
#include "core/template/template.h"

namespace homolog {

namespace {

/// The structure's own name, else its template's, else its id.
std::string called(const Document& before, const std::string& id) {
  const Structure* structure = before.structure(id);
  if (structure == nullptr) return id;
  if (!structure->name.empty()) return structure->name;
  const std::string stem = file_stem(structure->the_template->source);
  return stem.empty() ? structure->id : stem.substr(stem.find(':') + 1);  // of a built-in one
}

bool is_digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

/// A name without its numbers, and the first of them.
struct NumberedName {
  std::string words;
  std::optional<int> number;
};

NumberedName without_numbers(const std::string& name) {
  NumberedName found;
  for (std::size_t at = 0; at < name.size();) {
    std::size_t end = at;
    while (end < name.size() && is_digit(name[end])) ++end;
    if (end == at) {
      found.words += name[at++];
      continue;
    }
    if (!found.number) found.number = as_number<int>(name.substr(at, end - at));
    found.words += '#';
    at = end;
  }
  return found;
}

/// How much higher the number in a name becomes; none where more than numbers changes.
std::optional<int> number_change(const std::string& from, const std::string& to) {
  const NumberedName was = without_numbers(from), is = without_numbers(to);
  if (from == to || was.words != is.words || !was.number || !is.number) return std::nullopt;
  return *is.number - *was.number;
}

std::string levels_in_words(int levels) {
  const int count = std::abs(levels);
  return "names " + (count == 1 ? std::string("one level") : std::to_string(count) + " levels") +
         (levels < 0 ? " up" : " down");
}

EditName name_of_description(const SetStructure& action, const Document& before) {
  const Structure* own = before.structure(action.id);
  if (own == nullptr || !action.source.empty())
    return {"new structure " + action.name.value_or(action.id), true, false, {}};
  const std::string name = called(before, action.id);
  const SetStructure judged{.id = action.id, .confidence = 1, .doubt = ""};
  if (action == judged) return {name + " is right", true, false, {}};
  if (action.name && *action.name != name)
    return {name + " is named " + *action.name, true, true, number_change(name, *action.name)};
  return {"change of " + name, true, false, {}};
}

/// What found the points of an edit; `other` of an edit that sets none.
PointsFinder finder_of(const Action& action) {
  if (const auto* set = std::get_if<SetPoints>(&action)) return set->by;
  if (const auto* moved = std::get_if<MovePoints>(&action)) return moved->by;
  return FoundBy::other;
}

}  // namespace

EditName edit_name(const EditStep& step, const Document& before) {
  if (const auto* described = std::get_if<SetStructure>(&step.action)) return name_of_description(*described, before);
  if (const auto* removed = std::get_if<RemoveStructure>(&step.action))
    return {"removal of " + called(before, removed->id), true, false, {}};
  const PointsFinder by = finder_of(step.action);
  if (by == FoundBy::taken_back) return {called(before, step.of) + " " + by.word(), false, false, {}};
  const bool aside = std::holds_alternative<SetPlacement>(step.action) || by == FoundBy::start_of_cine;
  return {edit_words(step.action, before.view(step.of)), aside, false, {}};
}

bool is_renaming(const Action& action) {
  const auto* described = std::get_if<SetStructure>(&action);
  return described != nullptr && described->name && described->source.empty();
}

std::string step_name(std::span<const EditName> edits) {
  const auto deed = std::ranges::find(edits, false, &EditName::aside);
  if (deed != edits.end()) return deed->words;
  const auto numbered = std::ranges::find_if(edits, [](const EditName& edit) { return edit.levels.has_value(); });
  const bool all_rename = std::ranges::all_of(edits, &EditName::renames);
  return all_rename && numbered != edits.end() ? levels_in_words(*numbered->levels) : edits.front().words;
}

}  // namespace homolog
