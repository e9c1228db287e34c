#include "core/measure/recipe/recipe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "core/base/encoding/json.h"
#include "core/base/files/files.h"
#include "core/base/text/in_quotes.h"
#include "core/base/text/listed.h"
#include "core/base/text/nearest_names.h"
#include "core/base/text/text.h"
#include "core/measure/recipe/step_kinds.h"

namespace homolog {

namespace {

using RecipeJson = nlohmann::ordered_json;

constexpr int recipe_version = 1;
constexpr std::size_t most_steps = 2000;

/// "the unknown word "raduis"; the nearest that fits is "radius"".
Error unknown_word(const std::string& where, const std::string& word, const std::vector<std::string>& known) {
  const auto near = nearest_names(word, known, 1);
  std::vector<std::string> all;
  for (const std::string& one : known) all.push_back(excerpt_in_quotes(one));
  return {"", where + " has the unknown word " + excerpt_in_quotes(word) +
                  (near.empty() ? "; use " + listed(all, " or ")
                                : "; the nearest that fits is " + excerpt_in_quotes(near.front()))};
}

std::string what_it_gives(unsigned accepts) {
  static constexpr std::array<std::pair<Gives, const char*>, 8> words{{{Gives::point, "a point"},
                                                                       {Gives::line, "a line"},
                                                                       {Gives::plane, "a plane"},
                                                                       {Gives::sphere, "a sphere"},
                                                                       {Gives::cylinder, "a cylinder"},
                                                                       {Gives::part, "a part of the surface"},
                                                                       {Gives::section, "a section"},
                                                                       {Gives::number, "a number"}}};
  std::vector<std::string> all;
  for (const auto& [gives, word] : words)
    if ((accepts & bits(gives)) != 0) all.emplace_back(word);
  return listed(all, " or ");
}

class RecipeReader {
 public:
  Result<Recipe> read(const RecipeJson& json) {
    if (auto known = check_head(json); !known) return fail(known.error());
    if (const auto name = json.find("name"); name != json.end() && name->is_string())
      recipe_.name = name->get<std::string>();
    for (const char* list : {"elements", "measurements"})
      if (auto named = take_names(json, list); !named) return fail(named.error());
    if (recipe_.measurements.empty()) return fail("", "names no measurement; add one to \"measurements\"");
    const std::size_t named = recipe_.steps.size();
    for (std::size_t k = 0; k < named; ++k)
      if (auto read = read_step(k, *sources_[k]); !read) return fail(read.error());
    if (auto ordered = find_cycles(); !ordered) return fail(ordered.error());
    for (std::size_t k = 0; k < recipe_.steps.size(); ++k)
      if (auto fits = check_given(k); !fits) return fail(fits.error());
    for (const std::size_t k : recipe_.measurements)
      if (const StepKind& kind = *recipe_.steps[k].kind; kind.gives != Gives::number)
        return fail("", excerpt_in_quotes(recipe_.steps[k].name) + " is " + what_it_gives(bits(kind.gives)) +
                            ", not a number; put it under \"elements\"");
    return std::move(recipe_);
  }

 private:
  static Result<void> check_head(const RecipeJson& json) {
    const auto stamp = json.is_object() ? json.find("homolog_recipe") : json.end();
    if (!json.is_object() || stamp == json.end() || !stamp->is_number_integer())
      return fail("", "is no recipe; a recipe is an object that starts with \"homolog_recipe\": 1");
    if (*stamp < 1)
      return fail("", "says that it is of recipe version " + excerpt(stamp->dump()) +
                          ", which there is none of; correct it to 1");
    if (*stamp > recipe_version)
      return fail("", "was written for a newer version of this program (recipe version " + excerpt(stamp->dump()) +
                          "); update it");
    const std::vector<std::string> known{"homolog_recipe", "name", "note", "elements", "measurements"};
    for (const auto& [key, unused] : json.items())
      if (std::ranges::find(known, key) == known.end()) return fail(unknown_word("the recipe", key, known));
    return {};
  }

  /// Makes a step of each entry of a list, so that entries can refer to later ones.
  Result<void> take_names(const RecipeJson& json, const char* list) {
    const auto found = json.find(list);
    if (found == json.end()) return {};
    if (!found->is_array()) return fail("", std::string("has \"") + list + "\" that is no list; write [ … ]");
    for (const RecipeJson& entry : *found) {
      const std::string where = std::string(list) + " number " + std::to_string(&entry - &found->front() + 1);
      const auto name = entry.is_object() ? entry.find("name") : entry.end();
      if (!entry.is_object() || name == entry.end() || !name->is_string() || name->get<std::string>().empty())
        return fail("", where + " has no \"name\"; give each a name of its own");
      RecipeStep step;
      step.name = name->get<std::string>();
      if (!numbers_.try_emplace(step.name, recipe_.steps.size()).second)
        return fail("", "uses the name " + excerpt_in_quotes(step.name) + " twice; rename one of them");
      if (std::string_view(list) == "measurements") recipe_.measurements.push_back(recipe_.steps.size());
      if (recipe_.steps.size() >= most_steps) return too_many();
      recipe_.steps.push_back(std::move(step));
      sources_.push_back(&entry);
    }
    return {};
  }

  static tl::unexpected<Error> too_many() {
    return fail("", "has more than " + std::to_string(most_steps) + " steps; make several recipes of it");
  }

  Result<void> read_step(std::size_t number, const RecipeJson& json) {
    const std::string where = excerpt_in_quotes(recipe_.steps[number].name);
    const auto word = json.find("kind");
    if (word == json.end() || !word->is_string())
      return fail("", where + " has no \"kind\"; write what it is, such as \"kind\": \"distance\"");
    const auto kind = choose_kind(where, word->get<std::string>(), json);
    if (!kind) return fail(kind.error());
    recipe_.steps[number].kind = *kind;
    std::vector<std::string> known{"name", "kind", "structure", "optional", "note"};
    for (const StepMember& member : (*kind)->members) known.emplace_back(member.key);
    if (const auto structure = json.find("structure"); structure != json.end()) {
      if (!structure->is_string()) return fail("", where + " has a \"structure\" that is no name");
      recipe_.steps[number].structure = structure->get<std::string>();
    }
    if (const auto optional = json.find("optional"); optional != json.end()) {
      if (!optional->is_boolean()) return fail("", where + " has \"optional\" that is neither true nor false");
      recipe_.steps[number].optional = optional->get<bool>();
    }
    for (const auto& [key, value] : json.items()) {
      if (std::ranges::find(known, key) == known.end()) return fail(unknown_word(where, key, known));
      const auto member = std::ranges::find_if((*kind)->members,
                                               [&, &called = key](const StepMember& one) { return called == one.key; });
      if (member == (*kind)->members.end()) continue;
      if (auto read = read_member(number, *member, value); !read) return read;
    }
    return {};
  }

  /// The kind of a word, of several the one whose keys are there; the one with the most of these.
  static Result<const StepKind*> choose_kind(const std::string& where, const std::string& word,
                                             const RecipeJson& json) {
    std::vector<std::string> words, forms;
    const StepKind* chosen = nullptr;
    std::size_t most = 0;
    for (const StepKind* kind : step_kinds()) {
      if (std::ranges::find(words, kind->word) == words.end()) words.emplace_back(kind->word);
      if (word != kind->word) continue;
      std::vector<std::string> missing;
      std::string form;
      std::size_t needed = 0;
      for (const StepMember& member : kind->members) {
        if (member.least == 0) continue;
        ++needed;
        form += (form.empty() ? "" : " with ") + excerpt_in_quotes(member.key);
        if (!json.contains(member.key)) missing.emplace_back(member.key);
      }
      if (missing.empty() && (chosen == nullptr || needed > most)) chosen = kind, most = needed;
      forms.push_back(form);
    }
    if (chosen != nullptr) return chosen;
    if (forms.empty()) return fail(unknown_word(where, word, words));
    return fail("", where + " is a " + excerpt_in_quotes(word) + " and needs " + listed(forms, ", or "));
  }

  Result<void> read_member(std::size_t number, const StepMember& member, const RecipeJson& json) {
    const std::string where = excerpt_in_quotes(member.key) + " of " + excerpt_in_quotes(recipe_.steps[number].name);
    StepGiven given;
    if (member.takes == Takes::flag) {
      if (!json.is_boolean()) return fail("", where + " is neither true nor false");
      given.flag = json.get<bool>();
      recipe_.steps[number].given[member.key] = std::move(given);
      return {};
    }
    const bool is_length = member.takes == Takes::length && json.is_object();
    if (is_length) {
      if (auto read = read_length(number, where, json, given); !read) return read;
      recipe_.steps[number].given[member.key] = std::move(given);
      return {};
    }
    const RecipeJson all = json.is_array() ? json : RecipeJson::array({json});
    if (all.size() < std::max<std::size_t>(member.least, 1) || all.size() > std::max<std::size_t>(member.most, 1))
      return fail("", where + " lists " + std::to_string(all.size()) + " and takes " + how_many(member));
    for (const RecipeJson& one : all)
      if (auto read = read_one(number, member, where, one, given); !read) return read;
    recipe_.steps[number].given[member.key] = std::move(given);
    return {};
  }

  static std::string how_many(const StepMember& member) {
    const std::size_t least = std::max<std::size_t>(member.least, 1), most = std::max<std::size_t>(member.most, 1);
    if (least == most) return std::to_string(least);
    return most >= many ? "at least " + std::to_string(least) : std::to_string(least) + " to " + std::to_string(most);
  }

  Result<void> read_one(std::size_t number, const StepMember& member, const std::string& where, const RecipeJson& json,
                        StepGiven& given) {
    switch (member.takes) {
      case Takes::steps: {
        const auto step = step_of(number, member.key, where, json);
        if (!step) return fail(step.error());
        given.steps.push_back(*step);
        return {};
      }
      case Takes::text:
      case Takes::texts: {
        if (!json.is_string()) return fail("", where + " is no text; write it in quotes");
        const std::string text = json.get<std::string>();
        const std::vector<std::string> words(member.words.begin(), member.words.end());
        if (!words.empty() && std::ranges::find(words, text) == words.end())
          return fail(unknown_word(where, text, words));
        given.texts.push_back(text);
        return {};
      }
      default:
        break;
    }
    if (!json.is_number() || !std::isfinite(json.get<double>()))
      return fail("", where + " is no number" + (member.takes == Takes::length ? " of mm" : ""));
    const double value = json.get<double>();
    constexpr double most_number = 1e9;
    if (std::abs(value) > most_number) return fail("", where + " is beyond 1,000,000,000; correct it");
    if (member.takes == Takes::whole_numbers && (value < 0 || value != std::floor(value)))
      return fail("", where + " is no whole number from 0 on");
    given.numbers.push_back(value);
    return {};
  }

  /// {"times": 2, "of": "head radius"}
  Result<void> read_length(std::size_t number, const std::string& where, const RecipeJson& json, StepGiven& given) {
    const std::vector<std::string> known{"times", "of"};
    for (const auto& [key, unused] : json.items())
      if (std::ranges::find(known, key) == known.end()) return fail(unknown_word(where, key, known));
    const auto times = json.find("times"), of = json.find("of");
    if (times == json.end() || !times->is_number() || !std::isfinite(times->get<double>()) || of == json.end())
      return fail("", where + " needs a number of mm, or {\"times\": 2, \"of\": \"a measurement\"}");
    const auto step = step_of(number, "of", where, *of);
    if (!step) return fail(step.error());
    given.numbers.push_back(times->get<double>());
    given.steps.push_back(*step);
    return {};
  }

  /// A step by its name, or one written in its place.
  Result<std::size_t> step_of(std::size_t number, const char* key, const std::string& where, const RecipeJson& json) {
    if (json.is_string()) {
      const auto name = json.get<std::string>();
      if (const auto found = numbers_.find(name); found != numbers_.end()) return found->second;
      std::vector<std::string> known;
      for (const auto& [one, unused] : numbers_) known.push_back(one);
      return fail(unknown_word(where, name, known));
    }
    if (!json.is_object()) return fail("", where + " is neither a name nor an element");
    if (json.contains("name"))
      return fail("", where + " is an element with a name of its own; put it under \"elements\"");
    if (recipe_.steps.size() >= most_steps) return too_many();
    RecipeStep step;
    step.name = std::string(key) + " of " + recipe_.steps[number].name;
    step.structure = recipe_.steps[number].structure;
    const std::size_t place = recipe_.steps.size();
    recipe_.steps.push_back(std::move(step));
    if (auto read = read_step(place, json); !read) return fail(read.error());
    return place;
  }

  /// Looks through all that each step needs, and what that needs.
  Result<void> find_cycles() {
    enum class Seen { no, above, done };
    std::vector<Seen> seen(recipe_.steps.size(), Seen::no);
    std::vector<std::string> way;
    const auto visit = [&](const auto& self, std::size_t step) -> Result<void> {
      if (seen[step] == Seen::done) return {};
      way.push_back(excerpt_in_quotes(recipe_.steps[step].name));
      if (seen[step] == Seen::above) {
        way.erase(way.begin(), std::ranges::find(way, way.back()));
        std::string sentence = way.front() + " needs ";
        for (std::size_t k = 1; k < way.size(); ++k) sentence += (k > 1 ? ", which needs " : "") + way[k];
        return fail("", "goes in a circle: " + sentence + "; take one of these out");
      }
      seen[step] = Seen::above;
      for (const auto& [key, given] : recipe_.steps[step].given)
        for (const std::size_t needed : given.steps)
          if (auto sound = self(self, needed); !sound) return sound;
      seen[step] = Seen::done;
      way.pop_back();
      if (recipe_.steps[step].kind->gives == Gives::number) set_unit(recipe_.steps[step]);
      return {};
    };
    for (std::size_t step = 0; step < recipe_.steps.size(); ++step)
      if (auto sound = visit(visit, step); !sound) return sound;
    return {};
  }

  void set_unit(RecipeStep& step) const {
    step.unit = step.kind->unit;
    if (!step.unit.empty()) return;
    if (const auto of = step.given.find("of"); of != step.given.end() && !of->second.steps.empty())
      step.unit = recipe_.steps[of->second.steps.front()].unit;
  }

  /// Whether what a step was given is of a kind that it takes.
  Result<void> check_given(std::size_t number) const {
    const RecipeStep& step = recipe_.steps[number];
    for (const StepMember& member : step.kind->members) {
      const auto given = step.given.find(member.key);
      if (given == step.given.end()) continue;
      const unsigned accepts = member.takes == Takes::length ? bits(Gives::number) : member.accepts;
      for (const std::size_t of : given->second.steps) {
        const RecipeStep& other = recipe_.steps[of];
        const std::string where = excerpt_in_quotes(member.key) + " of " + excerpt_in_quotes(step.name);
        if ((bits(other.kind->gives) & accepts) == 0)
          return fail("", where + " is " + what_it_gives(bits(other.kind->gives)) + " (" +
                              excerpt_in_quotes(other.kind->word) + "); give " + what_it_gives(accepts));
        if (member.takes == Takes::length && other.unit != "mm")
          return fail("", where + " is a number of " + excerpt_in_quotes(other.unit) + "; give one of mm");
        if (accepts == bits(Gives::number) && other.unit != recipe_.steps[given->second.steps.front()].unit)
          return fail("", where + " has numbers of different units; give numbers of one");
      }
    }
    return {};
  }

  Recipe recipe_;
  std::map<std::string, std::size_t> numbers_;  ///< numbers of the named steps
  std::vector<const RecipeJson*> sources_;
};

}  // namespace

std::vector<std::string> Recipe::structures() const {
  std::vector<std::string> names;
  for (const RecipeStep& step : steps)
    if (!step.structure.empty() && std::ranges::find(names, step.structure) == names.end())
      names.push_back(step.structure);
  return names;
}

std::string kind_word(const RecipeStep& step) {
  return step.kind->word;
}

std::string value_with_unit(double value, const std::string& unit) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), unit == "1" ? "%.3f" : unit == "mm2" ? "%.0f" : "%.1f", value);
  if (unit == "1" || unit == "image") return text.data();
  if (unit == "deg") return std::string(text.data()) + "\xc2\xb0";
  return std::string(text.data()) + ' ' + (unit == "mm2" ? "mm\xc2\xb2" : unit);
}

Result<Recipe> parse_recipe(std::string_view text) {
  const auto json = read_json<RecipeJson>(text);
  if (!json) return fail("", json.error().what + "; correct it in an editor");
  return RecipeReader().read(*json);
}

Result<Recipe> read_recipe(const std::filesystem::path& path) {
  constexpr std::uintmax_t most_bytes = std::uintmax_t{1} << 24;
  const auto text = read_whole_file(path, most_bytes);
  if (!text) return fail(text.error());
  auto recipe = parse_recipe(*text);
  if (!recipe) return fail(path.string(), recipe.error().what);
  return recipe;
}

}  // namespace homolog
