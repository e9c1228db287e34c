#include "app/verbs/set/set_making.h"

#include <algorithm>
#include <map>
#include <optional>

#include "app/verbs/case_pool.h"
#include "app/verbs/set/set_cases.h"
#include "app/verbs/template/template_job.h"
#include "core/base/files/file_stem.h"
#include "core/base/files/files.h"
#include "core/base/text/text.h"
#include "core/structures/fitting/fit_set.h"
#include "core/structures/fitting/neighbours_say.h"

// The making of template sets, of one map or of several.

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// What a structure's template is made of alone.
Result<MadeTemplate> template_of_one(const SetJob& job, const fs::path& map, const Segment& segment,
                                     Progress& progress) {
  TemplateJob making;
  making.in = map;
  making.label = segment.name.empty() ? std::to_string(segment.value) : segment.name;
  making.vertices = job.vertices;
  return make_template_of_one(making, true, progress);
}

/// Templates of one map's structures, where they lie there.
Result<std::vector<MadeStructure>> make_structures(const SetJob& job, const fs::path& map,
                                                   const std::vector<Segment>& segments, Progress& progress) {
  std::vector<MadeStructure> made;
  for (const Segment& segment : segments) made.push_back(without_template(segment));
  const auto work = [&](std::size_t k, Progress& part) -> Result<Report> {
    auto one = template_of_one(job, map, segments[k], part);
    if (!one) {
      take_template(fail(one.error()), job, made[k]);
      return Report{};
    }
    if (!one->warnings.empty()) made[k].row["warning"] = one->warnings.back();
    made[k].warnings = std::move(one->warnings);
    take_template(std::move(one->file), job, made[k]);
    return Report{};
  };
  const auto done = run_cases(segments.size(), work, progress);
  if (progress.cancelled()) return fail("", "was stopped; no set is written");
  for (const auto& one : done)
    if (!one) return fail(one.error());
  return made;
}

/// The segments of a map that the set lacks and that the map has voxels of.
std::vector<Segment> lacking(const std::vector<Segment>& asked, const VolumeRead& map, const SetInMap& subject) {
  std::vector<std::map<int, std::size_t>> held;
  for (std::size_t layer = 0; layer <= map.other_layers.size(); ++layer) {
    const auto [volume, frame] = layer_of(map, layer, 0);
    held.push_back(labels_of(*volume, frame));
  }
  std::vector<Segment> segments;
  for (const Segment& one : asked) {
    const std::size_t layer = map.other_layers.empty() ? 0 : one.layer;
    const bool known = std::ranges::any_of(subject.structures, [&](const StructureInMap& there) {
      return there.is_there() && there.segment.value == one.value && there.segment.layer == layer;
    });
    if (!known && layer < held.size() && held[layer].contains(one.value)) segments.push_back(one);
  }
  return segments;
}

/// How the structures of the set lie in a subject, to where their neighbours say.
void note_places(const FittedSet& fitted, SetInMaking& making) {
  for (std::size_t k = 0; k < fitted.structures.size(); ++k) {
    const FittedStructure& one = fitted.structures[k];
    if (!one.fit || one.judgement.doubtful) continue;
    if (const auto said = said_by_neighbours(making.made, fitted.structures, k))
      making.relative[k].push_back(said->inverse().after(one.fit->placement));
  }
}

/// Carries a template from the subject into the set. Without a neighbour that says where, it has none.
void place_by_neighbours(const FittedSet& fitted, const SetInMaking& making, const fs::path& map, const SetJob& job,
                         MadeStructure& one) {
  if (!one.is_there()) return;
  const Vec3 middle = one.file.points.colwise().mean();
  const auto said = said_by_neighbours_at(making.made, fitted.structures, middle);
  if (!said) {
    one.file = {};
    take_template(fail(map.string(),
                       "has no other structure that could be fitted well, so that none says where it belongs; give a "
                       "map with more of the set's structures"),
                  job, one);
    return;
  }
  one.file.points = said->inverse().apply(one.file.points);
  one.file.landmarks.clear();
}

/// The structure's value, or where another of its layer has it the smallest above those of the set and of its maps.
int free_value(const TemplateSet& set, int highest, const TemplateOfSet& structure) {
  bool taken = false;
  for (const TemplateOfSet& other : set.structures) {
    highest = std::max(highest, other.value);
    taken = taken || (other.value == structure.value && other.layer == structure.layer);
  }
  return taken ? highest + 1 : structure.value;
}

/// A file that no other structure of the set has as its template, as one that was renamed may.
fs::path free_file(const TemplateSet& set, const fs::path& file) {
  const auto taken = [&](const fs::path& path) {
    return std::ranges::any_of(set.structures, [&](const TemplateOfSet& other) {
      return lower_case(other.file.string()) == lower_case(path.string());
    });
  };
  fs::path free = file;
  for (int number = 2; taken(free); ++number)
    free = file.parent_path() / (file_stem(file) + "-" + std::to_string(number) + file.extension().string());
  return free;
}

}  // namespace

MadeStructure without_template(const Segment& segment) {
  MadeStructure made;
  made.structure.name = name_in_set(segment);
  made.structure.value = segment.value;
  made.structure.layer = segment.layer;
  made.structure.colour = segment.colour;
  made.row = {{"name", made.structure.name},
              {"value", segment.value},
              {"vertices", 0},
              {"genus", nullptr},
              {"warning", nullptr}};
  return made;
}

void take_template(Result<MeshFile> file, const SetJob& job, MadeStructure& made) {
  const auto topology =
      file ? Topology::make(file->points.rows(), file->triangles) : Result<std::shared_ptr<const Topology>>();
  if (!file || !topology) {
    const std::string why = file ? topology.error().what : file.error().sentence();
    made.row.update({{"vertices", 0}, {"genus", nullptr}, {"warning", why}});
    return;
  }
  made.file = std::move(*file);
  made.row["vertices"] = made.file.points.rows();
  made.row["genus"] = (*topology)->genus();
  made.structure.file = file_of_template(job, made.structure.name);
  if (const Json& warning = made.row["warning"]; warning.is_string()) made.structure.other["warning"] = warning;
}

void append(MadeStructure made, SetInMaking& making) {
  std::erase_if(making.rows, [&](const Json& row) { return row["name"] == made.row["name"]; });
  making.warnings.insert(making.warnings.end(), made.warnings.begin(), made.warnings.end());
  if (made.is_there()) {
    made.structure.file = free_file(making.made.set, made.structure.file);
    auto the_template = make_template(made.file, made.structure.file.string());
    const int value = free_value(making.made.set, making.highest_value, made.structure);
    if (value != made.structure.value)
      making.warnings.push_back(made.structure.name + ": has the value " + std::to_string(value) +
                                " in the set, since " + std::to_string(made.structure.value) +
                                " is another structure's");
    made.row["value"] = made.structure.value = value;
    making.made.set.structures.push_back(std::move(made.structure));
    making.made.templates.push_back(std::move(*the_template));  // its topology was made above
    making.files.push_back(std::move(made.file));
    making.relative.push_back({Similarity{}});
  }
  making.rows.push_back(std::move(made.row));
}

Result<void> add_map(const SetJob& job, const fs::path& map, const std::vector<Segment>& asked, SetInMaking& making,
                     Progress& progress) {
  if (making.made.templates.empty()) {
    auto made = make_structures(job, map, asked, progress);
    if (!made) return fail(made.error());
    for (MadeStructure& one : *made) {
      if (map != job.maps.front()) one.row["from"] = map.string();
      append(std::move(one), making);
    }
    return {};
  }
  auto subject = read_subject(map, std::nullopt, progress);
  if (!subject) return fail(subject.error());
  const SetInMap there = find_in_map(making.made.set, subject->read);
  std::optional<Progress> part(std::in_place, progress, 0.7);
  const auto fitted = fit_set(making.made, there, {.gap_mm = 0, .progress = &*part});
  if (!fitted) return fail(map.string(), fitted.error().what);
  note_places(*fitted, making);
  part.emplace(progress, 0.3);
  auto made = make_structures(job, map, lacking(asked, subject->read, there), *part);
  if (!made) return fail(made.error());
  for (MadeStructure& one : *made) {
    place_by_neighbours(*fitted, making, map, job, one);
    if (map != job.maps.front()) one.row["from"] = map.string();
  }
  for (MadeStructure& one : *made) append(std::move(one), making);
  return {};
}

Result<Report> make_set(const SetJob& job, Progress& progress) {
  SetInMaking making;
  const auto asked = structures_asked(job, making, progress);
  if (!asked) return fail(asked.error());
  if (auto is_free = check_templates_free(job, *asked, {}, progress); !is_free) return fail(is_free.error());
  const auto folder = ResultFolder::make(job.folder());
  if (!folder) return fail(folder.error());
  if (job.consensus) {
    if (auto added = add_consensus(job, *asked, making, progress); !added) return fail(added.error());
    return write_set(job, making, progress);
  }
  for (std::size_t m = 0; m < job.maps.size(); ++m) {
    Progress part(progress, 1 / static_cast<double>(job.maps.size()));
    if (auto added = add_map(job, job.maps[m], (*asked)[m], making, part); !added) return fail(added.error());
    if (progress.cancelled()) return fail("", "was stopped; no set is written");
  }
  return write_set(job, making, progress);
}

}  // namespace homolog
