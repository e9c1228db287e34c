#include "app/verbs/verify/verify_compare.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "app/verbs/files_named.h"
#include "app/verbs/record.h"
#include "core/base/encoding/json.h"
#include "core/base/files/file_record.h"
#include "core/base/files/files.h"
#include "core/base/files/paths.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/mesh_io.h"
#include "core/model/files/statismo.h"
#include "core/model/shapes/study.h"
#include "core/session/case_file.h"
#include "core/session/line_kind.h"
#include "core/structures/template_set.h"
#include "core/volume/formats/formats.h"
#include "core/volume/readers.h"
#include "core/volume/volume_io.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// The longest of the distances between points that lie behind one another in two vectors.
double largest_distance_mm(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return (points_of(a) - points_of(b)).rowwise().norm().maxCoeff();
}

Result<FileDifference> difference_of_meshes(const fs::path& file, const fs::path& anew) {
  const auto a = read_mesh_file(file), b = read_mesh_file(anew);
  if (!a) return fail(a.error());
  if (!b) return fail(b.error());
  FileDifference difference;
  if (a->points.rows() != b->points.rows()) {
    difference.in_words = "it has " + std::to_string(a->points.rows()) + " vertices, and the new one has " +
                          std::to_string(b->points.rows());
    return difference;
  }
  difference.largest_mm = (a->points - b->points).rowwise().norm().maxCoeff();
  const bool faces = a->triangles.rows() == b->triangles.rows() && a->triangles == b->triangles;
  difference.same_content = faces && *difference.largest_mm == 0;
  if (!faces) difference.in_words = "its faces are others";
  return difference;
}

Result<FileDifference> difference_of_models(const fs::path& file, const fs::path& anew) {
  const auto a = read_model(file), b = read_model(anew);
  if (!a) return fail(a.error());
  if (!b) return fail(b.error());
  FileDifference difference;
  if (a->mean.size() != b->mean.size() || a->modes() != b->modes()) {
    difference.in_words = "it has " + std::to_string(a->mean.size() / 3) + " vertices and " +
                          std::to_string(a->modes()) + " modes, and the new one has " +
                          std::to_string(b->mean.size() / 3) + " and " + std::to_string(b->modes());
    return difference;
  }
  double largest_mm = largest_distance_mm(a->mean, b->mean);
  for (Eigen::Index k = 0; k < a->modes(); ++k)
    largest_mm = std::max(largest_mm, largest_distance_mm(a->basis.col(k) * std::sqrt(a->variances[k]),
                                                          b->basis.col(k) * std::sqrt(b->variances[k])));
  difference.largest_mm = largest_mm;
  difference.same_content = largest_mm == 0;
  return difference;
}

Result<FileDifference> difference_of_volumes(const fs::path& file, const fs::path& anew, Progress& progress) {
  VolumeReadOptions options;
  options.progress = &progress;
  const auto a = read_volume(file, options), b = read_volume(anew, options);
  if (!a) return fail(a.error());
  if (!b) return fail(b.error());
  FileDifference difference;
  if (!same_grid(a->volume.geometry, b->volume.geometry) || a->volume.frames != b->volume.frames) {
    difference.in_words = "its grid is another";
    return difference;
  }
  std::size_t differ = 0;
  std::visit(
      [&](const auto& first, const auto& second) {
        for (std::size_t v = 0; v < std::min(first.size(), second.size()); ++v)
          if (static_cast<double>(first[v]) != static_cast<double>(second[v])) ++differ;
      },
      a->volume.data, b->volume.data);
  difference.voxels = differ;
  difference.same_content = differ == 0;
  if (differ == 0) difference.largest_mm = 0;
  return difference;
}

/// Of tables, pages and pictures.
FileDifference difference_of_bytes(std::string_view a, std::string_view b) {
  FileDifference difference;
  const auto differ = std::ranges::mismatch(a, b);
  difference.same_content = a == b;
  const std::string_view same = a.substr(0, static_cast<std::size_t>(differ.in1 - a.begin()));
  const bool is_text = a.find('\0') == a.npos;
  if (difference.same_content) return difference;
  difference.in_words =
      is_text ? "line " + std::to_string(1 + std::ranges::count(same, '\n')) + " is another" : "its bytes are others";
  return difference;
}

/// Names of files by their last part.
void shorten(Json& json, std::initializer_list<const char*> keys) {
  for (const char* key : keys)
    if (const auto found = json.find(key); found != json.end() && found->is_string())
      *found = fs::path(found->get<std::string>()).filename().string();
}

/// What a study or a template set holds wherever it lies, without its record; null where it is damaged.
Json content_of_list(const std::string& text) {
  auto json = read_json<Json>(text);
  if (!json || !json->is_object()) return {};
  json->erase(std::string(record_key));
  shorten(*json, {"template"});
  for (const char* list : {"cases", "structures"})
    if (const auto found = json->find(list); found != json->end() && found->is_array())
      for (Json& one : *found)
        if (one.is_object()) shorten(one, {"file", "labels", "imported", "template"});
  return std::move(*json);
}

/// What a case's first line says of how the case begins: of its files only what they have to be like.
Json content_of_header(const std::string& line) {
  auto json = read_json<Json>(line);
  if (!json || !json->is_object()) return {};
  for (const char* key : {"homolog", "volume", "template", "labels", "templates_folder"}) json->erase(key);
  json->erase(std::string(record_key));
  return std::move(*json);
}

/// The lines of a case behind the first. Checkpoints are left out, which hold what the others give; so are empty ones.
struct LinesOfCase {
  std::string header;
  std::vector<std::string> lines;
  std::size_t checkpoints = 0;
};

LinesOfCase lines_of_case(const std::string& text) {
  LinesOfCase all;
  std::istringstream in(text);
  std::getline(in, all.header);
  for (std::string line; std::getline(in, line);) {
    const LineKind::Kind kind = kind_of(line).kind;
    all.checkpoints += kind == LineKind::checkpoint ? 1 : 0;
    if (kind != LineKind::checkpoint && kind != LineKind::empty) all.lines.push_back(std::move(line));
  }
  return all;
}

/// A line as it is wherever the case lies: one that adds a structure names its template.
std::string content_of_line(const std::string& line) {
  constexpr const char* adds = "structure";
  if (!line.starts_with("{\"structure\"")) return line;
  auto json = read_json<Json>(line);
  if (!json || !json->is_object() || !(*json)[adds].is_object()) return line;
  shorten((*json)[adds], {"template"});
  return json->dump();
}

/// How far the shapes that all lines of a case give are from those that it opens with. Errors: it cannot be played.
Result<double> played_apart_mm(const fs::path& file, Progress& progress) {
  ReplayOptions options;
  options.shapes_alone = true;
  options.progress = &progress;
  const auto opened = read_case(file, options);
  if (!opened) return fail(opened.error());
  options.from_checkpoint = false;
  const auto played = read_case(file, options);
  if (!played) return fail(played.error());
  double largest_mm = 0;
  for (const auto& structure : played->session.document().structures) {
    const Structure* there = opened->session.document().structure(structure->id);
    for (const auto& [frame, shape] : structure->shapes) {
      const Shape* other = there != nullptr ? there->shape(frame) : nullptr;
      if (other == nullptr || other->points->rows() != shape->points->rows())
        return fail(file.string(), "opens with other meshes than its lines give; take a copy of it from before");
      largest_mm = std::max(largest_mm, (*other->points - *shape->points).rowwise().norm().maxCoeff());
    }
  }
  return largest_mm;
}

Result<FileDifference> difference_of_cases(const fs::path& file, const std::string& a, const std::string& b,
                                           Progress& progress) {
  const LinesOfCase there = lines_of_case(a), anew = lines_of_case(b);
  FileDifference difference;
  difference.lines_since = there.lines.size() - std::min(there.lines.size(), anew.lines.size());
  if (content_of_header(there.header) != content_of_header(anew.header)) {
    difference.in_words = "line 1 is another";
    return difference;
  }
  for (std::size_t k = 0; k < anew.lines.size(); ++k)
    if (k == there.lines.size() || content_of_line(there.lines[k]) != content_of_line(anew.lines[k])) {
      difference.in_words = "edit " + std::to_string(k + 1) + " of those that it began with is another";
      return difference;
    }
  difference.largest_mm = 0;
  if (*difference.lines_since > 0 || there.checkpoints > 0) {
    const auto apart_mm = played_apart_mm(file, progress);
    if (!apart_mm) return fail(apart_mm.error());
    difference.largest_mm = *apart_mm;
  }
  difference.same_content = *difference.largest_mm == 0;
  return difference;
}

/// What two studies or sets say, whose files may lie elsewhere.
FileDifference difference_of_lists(const std::string& a, const std::string& b) {
  const Json there = content_of_list(a), anew = content_of_list(b);
  if (there.is_null()) return difference_of_bytes(a, b);
  constexpr auto replace = Json::error_handler_t::replace;
  return difference_of_bytes(there.dump(2, ' ', false, replace), anew.dump(2, ' ', false, replace));
}

/// Whether what two files name holds the same; a sentence's part where one of them does not. What is not there says
/// nothing, nor does a case, which goes on, nor the slices of a scan.
Result<std::string> difference_of_named(const fs::path& file, const fs::path& anew, Progress& progress) {
  const auto here = files_named_in(file), again = files_named_in(anew);
  for (std::size_t k = 0; k < std::min(here.size(), again.size()); ++k) {
    const fs::path a = resolved_source(absolute_path(file).parent_path(), here[k]);
    const fs::path b = resolved_source(absolute_path(anew).parent_path(), again[k]);
    std::error_code none;
    if (is_case_file(a) || !fs::is_regular_file(a, none) || !fs::is_regular_file(b, none)) continue;
    const auto difference = difference_of_files(a, b, progress);
    if (!difference) return fail(difference.error());
    if (!difference->same_content) return a.filename().string() + ", which it names, is another";
  }
  return std::string();
}

/// Whether two files carry the same record.
bool same_record(const fs::path& file, const fs::path& anew) {
  const auto a = read_record(file), b = read_record(anew);
  return a && b && *a == *b;
}

}  // namespace

Result<FileDifference> difference_of_files(const fs::path& file, const fs::path& anew, Progress& progress) {
  const auto a = read_whole_file(file), b = read_whole_file(anew);
  if (!a) return fail(a.error());
  if (!b) return fail(b.error());
  const bool is_case = is_case_file(file);
  const bool names_others = is_case || is_study_file(file) || is_template_set(file);
  if (*a == *b && !names_others) return FileDifference{true, true, 0, std::nullopt, {}};
  if (names_others) {
    auto difference = is_case ? difference_of_cases(file, *a, *b, progress) : difference_of_lists(*a, *b);
    if (!difference || !difference->same_content) return difference;
    auto named = difference_of_named(file, anew, progress);
    if (!named) return fail(named.error());
    difference->in_words = std::move(*named);
    difference->same_content = difference->in_words.empty();
    difference->same_bytes = difference->same_content && same_record(file, anew);
    if (difference->same_content) difference->largest_mm = 0;
    return difference;
  }
  if (is_mesh_name(file)) return difference_of_meshes(file, anew);
  if (is_model_name(file)) return difference_of_models(file, anew);
  if (has_ending(file, label_map_endings())) return difference_of_volumes(file, anew, progress);
  return difference_of_bytes(without_record(file, *a), without_record(anew, *b));
}

}  // namespace homolog
