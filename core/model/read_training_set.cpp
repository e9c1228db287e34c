#include <algorithm>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "core/base/files/file_stem.h"
#include "core/base/text/listed.h"
#include "core/model/shapes/shape_files.h"
#include "core/model/shapes/study.h"
#include "core/model/training_set.h"

// A training set is read from files.

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// Takes shapes off a set again, as left out for this reason.
void leave_out(const std::vector<std::string>& names, const std::string& reason, TrainingSetRead& read) {
  TrainingSet& set = read.set;
  std::size_t kept = 0;
  for (std::size_t k = 0; k < set.names.size(); ++k) {
    if (std::find(names.begin(), names.end(), set.names[k]) != names.end()) {
      read.left_out.push_back({set.names[k], reason, read.study_keys[k]});
      continue;
    }
    if (kept != k) {
      set.names[kept] = std::move(set.names[k]);
      set.shapes.col(static_cast<Eigen::Index>(kept)) = set.shapes.col(static_cast<Eigen::Index>(k)).eval();
      read.study_keys[kept] = std::move(read.study_keys[k]);
      if (!read.groups.empty()) read.groups[kept] = std::move(read.groups[k]);
    }
    ++kept;
  }
  set.names.resize(kept);
  set.shapes.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(kept));
  read.study_keys.resize(kept);
  if (!read.groups.empty()) read.groups.resize(kept);
}

/// The domains of ShapeWorks' files SUBJECT_DOMAIN_local.particles, where each subject has the same two or more.
std::set<std::string> domains_among(const std::vector<ShapeSource>& sources) {
  std::map<std::string, std::set<std::string>> subjects_of;
  std::size_t files = 0;
  for (const ShapeSource& source : sources) {
    std::string stem = file_stem(source.file);
    if (source.file.extension() != ".particles" || !(stem.ends_with("_local") || stem.ends_with("_world"))) continue;
    stem.resize(stem.size() - std::string_view("_local").size());
    ++files;
    for (std::size_t at = stem.find('_'); at != stem.npos; at = stem.find('_', at + 1))
      subjects_of[stem.substr(at + 1)].insert(stem.substr(0, at));
  }
  for (const auto& [domain, subjects] : subjects_of) {
    std::set<std::string> alike;
    for (const auto& [other, others] : subjects_of)
      if (others == subjects) alike.insert(other);
    if (subjects.size() > 1 && alike.size() > 1 && alike.size() * subjects.size() == files) return alike;
  }
  return {};
}

/// What may be meant otherwise, where files have several structures and none is named.
std::vector<std::string> structure_warnings(const std::vector<ShapeSource>& sources,
                                            const std::map<std::string, std::vector<std::string>>& taken) {
  std::vector<std::string> found;
  if (const auto domains = domains_among(sources); !domains.empty()) {
    const std::vector<std::string> names(domains.begin(), domains.end());
    found.push_back(sources.front().file.parent_path().string() + ": each subject has files of " +
                    listed(names, " and ") +
                    ", which are mixed here; where they are structures, join them by --structures");
  }
  for (const auto& [structure, files] : taken)
    found.push_back(some_of(files, 5) + (files.size() == 1 ? ": has" : ": have") +
                    " several structures, of which the first is taken" + (structure.empty() ? "" : ", " + structure) +
                    "; name others by --structures");
  return found;
}

}  // namespace

Error too_small(Error error, const std::vector<std::string>& warnings) {
  if (!warnings.empty()) error.what += "; " + warnings.front();
  return error;
}

Result<TrainingSetRead> read_training_set(const std::vector<fs::path>& files, const TrainingOptions& options,
                                          Progress* progress) {
  const auto sources = shape_sources(files, options.group);
  if (!sources) return fail(sources.error());
  TrainingSetBuilder builder(sources->size());
  std::vector<DoubtfulShape> doubtful;
  std::vector<std::string> groups;
  std::vector<std::vector<std::string>> study_keys;
  std::map<std::string, VertexScalars> vertex_doubts;
  std::map<std::string, std::vector<std::string>> first_taken;
  const bool of_study = std::any_of(files.begin(), files.end(), is_study_file);
  const auto take = [&](ReadShape shape) {
    if (!of_study && !shape.others.empty() && shape.name.find(" structure ") == std::string::npos)
      first_taken[shape.structure].push_back(shape.name);
    const bool is_left_out = options.without_doubtful && !shape.doubt.empty();
    if (options.vertex_doubts && shape.mesh->doubt_mm) vertex_doubts[shape.name] = *shape.mesh->doubt_mm;
    if (!shape.doubt.empty()) doubtful.push_back({shape.name, std::move(shape.doubt), {shape.of->study_key()}});
    if (is_left_out) return Result<void>();
    groups.push_back(shape.of->group);
    study_keys.push_back({shape.of->study_key()});
    builder.add(std::move(shape.name), *shape.mesh);
    return Result<void>();
  };
  const auto warnings = read_shapes(*sources, {options.all_frames, true}, take, progress);
  if (!warnings) return fail(warnings.error());
  if (options.without_doubtful && builder.shapes() < 2 && !doubtful.empty())
    return fail(doubtful.front().name,
                "is in doubt" +
                    (doubtful.size() == 1 ? std::string()
                                          : " with " + std::to_string(doubtful.size() - 1) + " of the other shapes") +
                    ", so that fewer than two are left; repair some, or leave --without-doubtful out");
  auto read = builder.finish(options.flip_mirrored);
  if (!read) return fail(too_small(read.error(), *warnings));
  (options.without_doubtful ? read->left_out : read->doubtful) = std::move(doubtful);
  read->vertex_doubts = std::move(vertex_doubts);
  const bool any_group = std::ranges::any_of(groups, [](const std::string& group) { return !group.empty(); });
  if (any_group) read->groups = std::move(groups);
  read->study_keys = std::move(study_keys);
  for (std::string& sentence : structure_warnings(*sources, first_taken)) read->warnings.push_back(std::move(sentence));
  read->warnings.insert(read->warnings.begin(), warnings->begin(), warnings->end());
  if (options.without_doubtful && !options.flip_mirrored && !read->mirrored.empty()) {
    if (read->set.shapes.cols() - std::ssize(read->mirrored) < 2)
      return fail(read->mirrored.front(),
                  "is a mirror image of the other shapes, without which fewer than two are left; use --flip-mirrored");
    leave_out(read->mirrored, "a mirror image of the other shapes (left and right exchanged)", *read);
    read->mirrored.clear();
  }
  for (std::string& sentence : doubt_warnings(read->left_out, true)) read->warnings.push_back(std::move(sentence));
  for (std::string& sentence : doubt_warnings(read->doubtful, false)) read->warnings.push_back(std::move(sentence));
  if (!read->mirrored.empty())
    read->warnings.push_back(some_of(read->mirrored, 5) + (options.flip_mirrored
                                                               ? ": a mirror image of the other shapes; flipped"
                                                               : ": a mirror image of the other shapes (left and right "
                                                                 "exchanged); use --flip-mirrored to flip it"));
  return read;
}

}  // namespace homolog
