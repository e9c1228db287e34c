#include "core/catalogue/catalogue.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <optional>
#include <string_view>

#include "core/base/text/listed.h"
#include "core/base/text/nearest_names.h"
#include "core/base/text/text.h"
#include "core/phantom/phantom_scene.h"

// assets/recipes, embedded by core/CMakeLists.txt.
extern const unsigned char homolog_recipe_femur[], homolog_recipe_vertebra[], homolog_recipe_ventricle[];
extern const std::size_t homolog_recipe_femur_size, homolog_recipe_vertebra_size, homolog_recipe_ventricle_size;

namespace homolog {

namespace {

constexpr std::string_view built_in_prefix = "built-in:";
constexpr std::string_view phantom_prefix = "phantom:";
constexpr std::string_view spine = "spine";

/// The structure that a source names of the built-in set; empty: the set. None: the source is of another kind.
std::optional<std::string> structure_of_set(const std::string& source) {
  const std::string set = built_in_set_source();
  if (source == set) return std::string();
  if (!source.starts_with(set + ":")) return std::nullopt;
  return source.substr(set.size() + 1);
}

/// "built-in:spine" for "spine", "phantom:spine" or "builtin:spine" where there is no such file; else empty.
std::string built_in_that_is_meant(const std::string& source) {
  std::error_code ignored;
  if (std::filesystem::exists(source, ignored)) return {};
  const std::string name = source.substr(source.find(':') + 1);
  if (name == spine) return built_in_set_source();
  const auto organ = organ_from_name(name);
  return organ ? built_in_source(*organ) : std::string();
}

Result<MeshFile> built_in_of_set(const std::string& source, const std::string& structure) {
  if (structure.empty())
    return fail(source, "is a set of templates; name one of them, such as " + built_in_set_source("vertebrae_L3"));
  for (SceneStructure& one : spine_phantom_truth(0))
    if (one.name == structure) return std::move(one.truth);
  return fail(source, "is no template of the built-in set; homolog set info " + built_in_set_source() + " lists them");
}

/// A recipe that ships.
struct ShippedRecipe {
  const char* name;
  std::string_view text;
};
std::array<ShippedRecipe, 3> recipes() {
  const auto text = [](const unsigned char* bytes, std::size_t size) {
    return std::string_view(reinterpret_cast<const char*>(bytes), size);
  };
  return {{{"femur", text(homolog_recipe_femur, homolog_recipe_femur_size)},
           {"vertebra", text(homolog_recipe_vertebra, homolog_recipe_vertebra_size)},
           {"ventricle", text(homolog_recipe_ventricle, homolog_recipe_ventricle_size)}}};
}

}  // namespace

std::string built_in_source(Organ organ) {
  return std::string(built_in_prefix) + organ_name(organ);
}

std::string phantom_source(Organ organ, int subject) {
  return std::string(phantom_prefix) + organ_name(organ) + ":" + std::to_string(subject);
}

std::string built_in_set_source(const std::string& structure) {
  return std::string(built_in_prefix) + std::string(spine) + (structure.empty() ? "" : ":" + structure);
}

bool is_built_in(const std::string& source) {
  return source.starts_with(built_in_prefix);
}

bool is_phantom(const std::string& source) {
  return source.starts_with(phantom_prefix);
}

bool names_file(const std::string& source) {
  return !source.empty() && !is_built_in(source) && !is_phantom(source);
}

std::string relative_source(const std::filesystem::path& folder, const std::string& source) {
  if (!names_file(source)) return source;
  // Textual, as resolved_source is: following links here and not there would name another file.
  std::error_code error;
  const std::filesystem::path from =
      std::filesystem::absolute(folder.empty() ? std::filesystem::path(".") : folder, error);
  const std::filesystem::path to = std::filesystem::absolute(source, error);
  return error ? source : to.lexically_normal().lexically_proximate(from.lexically_normal()).generic_string();
}

std::string resolved_source(const std::filesystem::path& folder, const std::string& name) {
  return names_file(name) ? (folder / name).lexically_normal().string() : name;
}

Result<Organ> built_in_organ(const std::string& source) {
  if (!is_built_in(source))
    return fail(source, "is no built-in template; choose one, such as " + built_in_source(Organ::kidney));
  auto organ = organ_from_name(source.substr(built_in_prefix.size()));
  if (!organ)
    return fail(source, "is no built-in template; there are " + built_in_source(Organ::kidney) + ", " +
                            built_in_source(Organ::vertebra) + ", " + built_in_source(Organ::ventricle) +
                            " and the set " + built_in_set_source());
  return organ;
}

std::string template_sources() {
  return "Template mesh, or " + built_in_source(Organ::kidney) + ", " + built_in_source(Organ::vertebra) + " …";
}

Result<MeshFile> load_mesh(const std::string& source) {
  if (const auto structure = structure_of_set(source)) return built_in_of_set(source, *structure);
  if (!is_built_in(source)) return read_mesh_file(source);
  const auto organ = built_in_organ(source);
  return organ ? Result<MeshFile>(built_in_template(*organ)) : fail(organ.error());
}

Result<std::shared_ptr<const Template>> load_template(const std::string& source) {
  if (auto meant = built_in_that_is_meant(source); !is_built_in(source) && !meant.empty())
    return fail(source, "is neither a file nor a built-in template; " + meant + " is one");
  auto file = load_mesh(source);
  if (!file) return fail(file.error());
  return make_template(std::move(*file), source);
}

std::vector<std::string> shipped_recipes() {
  std::vector<std::string> names;
  for (const ShippedRecipe& one : recipes()) names.emplace_back(one.name);
  return names;
}

Result<Recipe> load_recipe(const std::string& source) {
  for (const ShippedRecipe& one : recipes())
    if (source == one.name) {
      auto recipe = parse_recipe(one.text);
      if (!recipe) return fail(source, recipe.error().what);
      return recipe;
    }
  std::error_code ignored;
  const bool is_word = source.find_first_of("./") == std::string::npos;
  if (!is_word || std::filesystem::exists(source, ignored)) return read_recipe(source);
  const auto near = nearest_names(source, shipped_recipes(), 1);
  return fail(excerpt(source), "is neither a file nor a recipe that ships (" + listed(shipped_recipes(), ", ") + ")" +
                                   (near.empty() ? "" : "; " + near.front() + " is the nearest"));
}

std::string recipe_of_template(const std::string& template_source) {
  if (is_built_in(template_source)) {
    const auto organ = built_in_organ(template_source);
    const std::string name = organ ? organ_name(*organ) : "";
    const std::vector<std::string> shipped = shipped_recipes();
    return std::ranges::find(shipped, name) == shipped.end() ? std::string() : name;
  }
  std::filesystem::path beside = template_source;
  beside.replace_extension(".recipe.json");
  std::error_code ignored;
  return std::filesystem::exists(beside, ignored) ? beside.string() : std::string();
}

Result<VolumeRead> load_volume(const std::string& source, const VolumeReadOptions& options) {
  if (!is_phantom(source)) return read_volume(source, options);
  const std::string rest = source.substr(phantom_prefix.size());
  const std::size_t colon = rest.find(':');
  const std::string name = rest.substr(0, colon);
  const auto organ = organ_from_name(name);
  if (!organ && name != spine) return fail(organ.error());
  int number = 0;
  const char* end = rest.data() + rest.size();
  const auto numbered = [&] {
    const auto [stop, error] = std::from_chars(rest.data() + colon + 1, end, number);
    return error == std::errc() && stop == end && number >= 0;
  };
  if (colon == std::string::npos || !numbered())
    return fail(excerpt(source), "needs a subject number from 0 to " + std::to_string(std::numeric_limits<int>::max()) +
                                     ", for instance " + std::string(phantom_prefix) + name + ":1");
  VolumeRead read;
  read.volume = organ ? make_phantom(*organ, number).image : make_spine_phantom(number).image;
  return read;
}

}  // namespace homolog
