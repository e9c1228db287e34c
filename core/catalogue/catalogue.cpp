#include "core/catalogue/catalogue.h"

#include <charconv>
#include <limits>
#include <string_view>

#include "core/base/text.h"

namespace homolog {

namespace {

constexpr std::string_view built_in_prefix = "built-in:";
constexpr std::string_view phantom_prefix = "phantom:";

}  // namespace

std::string built_in_source(Organ organ) {
  return std::string(built_in_prefix) + organ_name(organ);
}

std::string phantom_source(Organ organ, int subject) {
  return std::string(phantom_prefix) + organ_name(organ) + ":" + std::to_string(subject);
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
  return organ_from_name(source.substr(built_in_prefix.size()));
}

std::string template_sources() {
  return "Template mesh, or " + built_in_source(Organ::kidney) + ", " + built_in_source(Organ::vertebra) + " …";
}

Result<std::shared_ptr<const Template>> load_template(const std::string& source) {
  if (is_built_in(source)) {
    const auto organ = built_in_organ(source);
    if (!organ) return fail(organ.error());
    return make_template(built_in_template(*organ), source);
  }
  auto file = read_mesh_file(source);
  if (!file) return fail(file.error());
  return make_template(std::move(*file), source);
}

Result<VolumeRead> load_volume(const std::string& source, const VolumeReadOptions& options) {
  if (!is_phantom(source)) return read_volume(source, options);
  const std::string rest = source.substr(phantom_prefix.size());
  const std::size_t colon = rest.find(':');
  const auto organ = organ_from_name(rest.substr(0, colon));
  if (!organ) return fail(organ.error());
  int number = 0;
  const char* end = rest.data() + rest.size();
  const auto numbered = [&] {
    const auto [stop, error] = std::from_chars(rest.data() + colon + 1, end, number);
    return error == std::errc() && stop == end && number >= 0;
  };
  if (colon == std::string::npos || !numbered())
    return fail(excerpt(source), "needs a subject number from 0 to " + std::to_string(std::numeric_limits<int>::max()) +
                                     ", for instance " + phantom_source(*organ, 1));
  VolumeRead read;
  read.volume = make_phantom(*organ, number).image;
  return read;
}

}  // namespace homolog
