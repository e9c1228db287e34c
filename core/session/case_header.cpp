#include "core/session/case_header.h"

#include <cstdio>
#include <filesystem>
#include <string_view>

#include "core/base/encoding/json.h"
#include "core/base/files/file_record.h"
#include "core/base/files/paths.h"
#include "core/base/numbers/limits.h"
#include "core/base/text/text.h"
#include "core/case/action_json.h"
#include "core/catalogue/catalogue.h"
#include "core/template/template_mark.h"

namespace homolog {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// A case of one structure is of the first format, which every version of Homolog reads.
constexpr int one_structure = 1, several_structures = 2;
constexpr const char* templates_folder_key = "templates_folder";
constexpr const char* mark_key = "template_mark";
/// "landmarks" in the header, by LandmarkRule; the oldest cases have none.
constexpr std::array landmark_rules{"", "weighed", "by size"};

/// Refuses with both values where the header holds `key` and what was loaded differs.
template <class Value>
Result<void> check(const Json& header, const char* key, const Value& loaded, const std::string& of) {
  if (!header.contains(key)) return {};
  Value expected{};
  try {
    expected = header.at(key).get<Value>();
  } catch (const Json::exception&) {
    return fail("", std::string("line 1: \"") + key + "\" is of the wrong kind; correct it in a text editor");
  }
  if (expected == loaded) return {};
  const Json both = {expected, loaded};
  return fail("", "was made for " + of + " with " + key + " " + excerpt(both[0].dump()) + " but this one has " +
                      both[1].dump() + "; put the original back or start a new case");
}

/// "128 × 128 × 90 voxels of 1.5 × 1.5 × 3 mm"
std::string grid_in_words(const Json& voxels, const Json& spacing_mm) {
  std::string words;
  for (std::size_t axis = 0; axis < 3; ++axis)
    words += (axis > 0 ? " × " : "") + std::to_string(voxels.at(axis).get<int>());
  words += " voxels of ";
  for (std::size_t axis = 0; axis < 3; ++axis) {
    char number[32];
    std::snprintf(number, sizeof number, "%.4g", spacing_mm.at(axis).get<double>());
    words += (axis > 0 ? " × " : "") + std::string(number);
  }
  return words + " mm";
}

/// Refuses an image on another grid than the case was made on.
Result<void> check_grid(const Json& header, const Volume& volume, const std::string& source) {
  const std::string here = geometry_hash(volume.geometry);
  try {
    if (header.value("geometry", here) == here) return {};
    const VolumeGeometry& g = volume.geometry;
    std::string made_on = "another grid", is;
    if (header.contains("voxels") && header.contains("spacing_mm")) {
      made_on = grid_in_words(header["voxels"], header["spacing_mm"]);
      is = grid_in_words(g.dims, {g.spacing_mm[0], g.spacing_mm[1], g.spacing_mm[2]});
      if (is == made_on) is = "the same voxels at another place or angle";
    }
    return fail("", "was made on an image of " + made_on + " (geometry " +
                        excerpt(header["geometry"].get<std::string>()) + "), and " + source + " has " +
                        (is.empty() ? "" : is + " ") + "(geometry " + here +
                        "); open the case together with its own image, or start a new case");
  } catch (const Json::exception&) {
    return fail("",
                "line 1: \"geometry\", \"voxels\" or \"spacing_mm\" is of the wrong kind; correct it in a text editor");
  }
}

/// Names the files of a case in its header. Errors: a name that is no UTF-8.
Result<void> name_files(const Document& document, const fs::path& labels, const fs::path& folder, Json& header) {
  const Structure* first = document.structure();
  const std::string the_template = first != nullptr ? first->the_template->source : "";
  for (const auto& [key, source] :
       {std::pair("volume", document.scan.source), {"template", the_template}, {"labels", labels.string()}}) {
    const std::string name = source.empty() ? source : relative_source(folder, source);
    if (!is_utf8(name))
      return fail(source, "has a name that is no UTF-8, so a case cannot hold it; rename that file or folder");
    if (!name.empty())
      header[key] = name;
    else if (key == std::string_view("labels"))
      header.erase(key);
  }
  return {};
}

/// Refuses a template whose vertices lie elsewhere than in the one that the header keeps the mark of.
Result<void> check_mark(const Json& header, const Template& loaded, std::vector<std::string>& warnings) {
  const auto found = header.find(mark_key);
  if (found == header.end()) return {};
  TemplateMark kept{};
  try {
    kept = found->get<TemplateMark>();
  } catch (const Json::exception&) {
    return fail("", "line 1: \"" + std::string(mark_key) + "\" is not four numbers; correct it in a text editor");
  }
  auto same = check_template_mark(kept, loaded);
  if (!same) return fail(same.error());
  if (!same->empty()) warnings.push_back(std::move(*same));
  return {};
}

LandmarkRules landmark_rules_in(const Json& header) {
  LandmarkRules rules;
  // Homolog always wrote "connectivity"; without it the header was written by a person, and nothing is to be kept to.
  const auto landmarks = header.find("landmarks");
  if (landmarks != header.end() || header.contains("connectivity")) {
    rules.rule = LandmarkRule::closed_form;
    for (std::size_t rule = 1; rule < landmark_rules.size(); ++rule)
      if (landmarks != header.end() && *landmarks == landmark_rules[rule]) rules.rule = static_cast<LandmarkRule>(rule);
  }
  const auto held = header.find("held_landmarks");
  rules.hold = held != header.end() && *held == true;
  return rules;
}

}  // namespace

Result<fs::path> labels_in_header(const Json& header, const fs::path& folder) {
  const auto found = header.find("labels");
  if (found == header.end()) return fs::path();
  if (!found->is_string()) return fail("", "\"labels\" is no file name; correct it in a text editor");
  return fs::path(resolved_source(folder, found->get<std::string>()));
}

Result<Document> read_header(const Json& header, const fs::path& folder, const ImageOfHeader& image, Progress* progress,
                             std::vector<std::string>& warnings) {
  if (!header.is_object() || !header.contains("homolog")) {
    return fail("", "is not a Homolog case: its first line is no header; open a .homolog file that Homolog wrote");
  }
  if (header["homolog"] != one_structure && header["homolog"] != several_structures) {
    return fail("", "is of case format " + excerpt(header["homolog"].dump()) +
                        "; this Homolog reads formats 1 and 2, so open it with a newer one");
  }
  std::shared_ptr<const Volume> volume;
  std::string volume_source, template_source;
  VolumeReadOptions options;
  options.progress = progress;
  options.without_voxels = !image.voxels;
  try {
    volume_source = image.source.empty() ? resolved_source(folder, header.value("volume", "")) : image.source;
    template_source = resolved_source(folder, header.value("template", ""));
    options.series_uid = header.value("series", "");
    options.resample = header.value("resampled", false);
    if (const auto spacing = header.find("spacing_mm"); spacing != header.end() && spacing->size() == 3) {
      options.stack_spacing_mm =
          Vec3((*spacing)[0].get<double>(), (*spacing)[1].get<double>(), (*spacing)[2].get<double>());
    }
  } catch (const Json::exception&) {
    return fail("", "line 1: a value is of the wrong kind; correct it in a text editor");
  }
  if (options.stack_spacing_mm && !all_in_reach(*options.stack_spacing_mm))
    return fail("", std::string("line 1: \"spacing_mm\" ") + beyond_farthest + "; correct it in a text editor");
  if (image.read && !volume_source.empty()) {
    std::error_code ignored;
    if (names_file(volume_source) && !fs::exists(volume_source, ignored))
      return fail("", "its image " + excerpt(volume_source) +
                          " does not exist; put it back, or open the case together with the image where it is now");
    auto read = load_volume(volume_source, options);
    if (!read) return fail(read.error());
    warnings.insert(warnings.end(), read->warnings.begin(), read->warnings.end());
    volume = std::make_shared<const Volume>(std::move(read->volume));
    if (auto same = check_grid(header, *volume, volume_source); !same) return fail(same.error());
    if (auto same = check(header, "series", volume->series_uid, "a volume"); !same) return fail(same.error());
  }
  std::shared_ptr<const Template> the_template;
  if (!template_source.empty()) {
    auto loaded = load_template(template_source);
    if (!loaded) return fail(loaded.error());
    the_template = *loaded;
    const auto vertices = static_cast<std::int64_t>(the_template->topology->vertices());
    if (auto same = check(header, "vertices", vertices, "a template"); !same) return fail(same.error());
    if (auto same = check(header, "connectivity", the_template->topology->hash(), "a template"); !same) {
      return fail(same.error());
    }
    if (auto same = check_mark(header, *the_template, warnings); !same) return fail(same.error());
  }
  Document document = new_document(volume_source, std::move(volume), std::move(the_template));
  if (!document.structures.empty())
    document.change({}, [&](Structure& first) { first.landmarks = landmark_rules_in(header); });
  return document;
}

Result<std::string> case_header(const Document& document, const fs::path& folder, const std::string& record) {
  Json header{{"homolog", one_structure}};
  if (auto named = name_files(document, {}, folder, header); !named) return fail(named.error());
  if (const auto first = document.view()) header["placement"] = to_json(first->shape.placement);
  const Structure* first = document.structure();
  const LandmarkRules rules = first != nullptr ? first->landmarks : LandmarkRules{};
  if (rules.rule != LandmarkRule::closed_form)
    header["landmarks"] = landmark_rules[static_cast<std::size_t>(rules.rule)];
  if (rules.hold) header["held_landmarks"] = true;
  if (first != nullptr) {
    header["vertices"] = first->the_template->topology->vertices();
    header["connectivity"] = first->the_template->topology->hash();
    header[mark_key] = template_mark(*first->the_template);
  }
  if (document.scan.image) {
    const Volume& volume = *document.scan.image;
    header["geometry"] = geometry_hash(volume.geometry);
    header["voxels"] = volume.geometry.dims;
    if (!volume.series_uid.empty()) header["series"] = volume.series_uid;
    if (volume.resampled) header["resampled"] = true;
    const Vec3& spacing = volume.geometry.spacing_mm;
    header["spacing_mm"] = Json::array({spacing[0], spacing[1], spacing[2]});
  }
  if (auto made = read_json<Json>(record); made) header[std::string(record_key)] = std::move(*made);
  return dumped(header);
}

Result<CaseTemplates> templates_in_header(const Json& header, const fs::path& folder) {
  CaseTemplates templates;
  templates.set_named(header.value("homolog", Json()) == several_structures);
  const auto found = header.find(templates_folder_key);
  if (found != header.end() && !found->is_string())
    return fail("", "\"" + std::string(templates_folder_key) + "\" is no folder's name; correct it in a text editor");
  const fs::path here = absolute_path(folder.empty() ? fs::path(".") : folder);
  templates.set_case_folder(here);
  templates.set_folder(found == header.end() ? here : (here / found->get<std::string>()).lexically_normal());
  return templates;
}

Result<std::string> moved_header(const std::string& line, const Document& document, const fs::path& labels,
                                 const CaseTemplates& templates, const fs::path& folder) {
  Json header = read_json<Json>(line).value_or(Json());
  if (!header.is_object()) return fail("", "has lost its first line; export the mesh instead");
  if (auto named = name_files(document, labels, folder, header); !named) return fail(named.error());
  header.erase(templates_folder_key);
  if (!templates.named()) return dumped(header);
  header["homolog"] = several_structures;
  if (!templates.folder()) return dumped(header);
  const std::string from_here = relative_source(folder, templates.folder()->string());
  if (!is_utf8(from_here))
    return fail(*templates.folder(), "has a name that is no UTF-8, so a case cannot hold it; rename that folder");
  if (from_here != ".") header[templates_folder_key] = from_here;
  return dumped(header);
}

}  // namespace homolog
