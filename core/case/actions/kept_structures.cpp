#include "core/case/actions/kept_structures.h"

#include <cmath>
#include <span>

#include "core/case/actions/fields.h"
#include "core/case/moved_points.h"
#include "core/case/packed.h"

namespace homolog {

namespace {

constexpr std::size_t largest_count = std::size_t{1} << 28;

/// Numbers with their count, since packed ones do not say how many they are.
void spell_packed(Fields line, std::vector<std::uint32_t>& numbers) {
  std::size_t count = numbers.size();
  std::string text = line.reads() ? std::string() : packed<std::uint32_t>(numbers);
  line.member("count", count);
  line.member("packed", text);
  if (!line.reads()) return;
  if (count > largest_count) throw Unreadable{"\"count\" is out of range"};
  auto read = unpacked<std::uint32_t>(text, count);
  if (!read) throw Unreadable{read.error().what};
  numbers = std::move(*read);
}

/// Coordinates in steps of the grid of computed points.
void spell_coordinates(Fields& line, const char* key, std::vector<double>& coordinates) {
  if (line.reads() ? !line.has(key) : coordinates.empty()) return;
  std::vector<std::uint32_t> steps;
  for (const double mm : coordinates)
    steps.push_back(static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(mm * steps_per_mm))));
  spell_packed(line.object(key), steps);
  if (!line.reads()) return;
  coordinates.clear();
  for (const std::uint32_t step : steps) coordinates.push_back(static_cast<std::int32_t>(step) / steps_per_mm);
}

void spell_in_map(Fields line, std::string& id, InFittedMap& in) {
  line.member("id", id);
  line.member("name", in.name);
  line.member("layer", in.layer);
  line.member("value", in.value);
  line.member("mesh", in.mesh);
  line.member("p_named", in.p_named);
  line.optional("was_missing", in.was_missing, in.was_missing);
  spell_coordinates(line, "as_read", in.as_read);
}

}  // namespace

void spell_looks(Fields line, KeptLooks& looks) {
  line.optional("active", looks.active, !looks.active.empty());
  line.optional("hidden", looks.hidden, !looks.hidden.empty());
  line.optional("locked", looks.locked, !looks.locked.empty());
  Fields::Json opacity = looks.opacity;
  line.optional("opacity", opacity, !looks.opacity.empty());
  if (line.reads() && line.has("opacity")) looks.opacity = opacity.get<std::map<std::string, double>>();
  line.optional("as_read_hidden", looks.as_read_hidden, looks.as_read_hidden);
  line.optional("set", looks.set, !looks.set.empty());
  line.optional("recipe", looks.recipe, !looks.recipe.empty());
  line.optional("measured", looks.measured, !looks.measured.empty());
  line.optional("model", looks.model, !looks.model.empty());
}

void spell_map_fit(Fields line, KeptMapFit& fit) {
  line.member("frame", fit.frame);
  Fields::Json all = Fields::Json::array();
  for (const auto& [known, kept] : fit.structures) {
    Fields::Json one = Fields::Json::object();
    std::string id = known;
    InFittedMap in = kept;
    spell_in_map(Fields::writer(one), id, in);
    all.push_back(std::move(one));
  }
  line.member("structures", all);
  if (line.reads()) {
    fit.structures.clear();
    for (const Fields::Json& one : all) {
      std::string id;
      InFittedMap in;
      spell_in_map(Fields::reader(one), id, in);
      fit.structures.emplace(std::move(id), std::move(in));
    }
  }
  if (line.reads() ? line.has("changes") : !fit.changes.empty()) spell_packed(line.object("changes"), fit.changes);
}

}  // namespace homolog
