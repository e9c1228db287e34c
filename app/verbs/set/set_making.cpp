#include "app/verbs/set/set_making.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "app/verbs/case_pool.h"
#include "app/verbs/set/set_cases.h"
#include "app/verbs/template/template_job.h"
#include "core/base/files/file_record.h"
#include "core/base/files/files.h"
#include "core/base/files/paths.h"
#include "core/base/text/listed.h"
#include "core/base/text/text.h"
#include "core/catalogue/catalogue.h"
#include "core/structures/fitting/fit_set.h"
#include "core/structures/fitting/neighbours_say.h"

// The making of template sets, of one map or of several.

namespace homolog {

namespace fs = std::filesystem;

namespace {

constexpr double near_mm = 5;  ///< structures whose surfaces come nearer are neighbours

/// The labels between the commas.
std::vector<std::string> labels_between_commas(const std::string& labels) {
  std::vector<std::string> parts;
  std::size_t from = 0;
  while (from <= labels.size()) {
    const std::size_t to = std::min(labels.find(',', from), labels.size());
    parts.emplace_back(trimmed(std::string_view(labels).substr(from, to - from)));
    from = to + 1;
  }
  return parts;
}

/// Labels that are asked for, and which of them a map so far had; why not, of the first.
struct AskedLabels {
  std::vector<std::string> parts;
  std::vector<char> found;
  std::vector<std::optional<Error>> why_not;
};

/// Those that the map has. Errors: that it has none is none.
std::vector<Segment> named_in(const VolumeRead& read, const std::string& labels, const fs::path& map,
                              AskedLabels& asked) {
  std::vector<Segment> segments;
  const auto add = [&](const std::vector<Segment>& more) {  // two names may mean one label
    for (const Segment& segment : more) {
      const auto same = [&](const Segment& s) { return s.value == segment.value && s.layer == segment.layer; };
      if (std::ranges::none_of(segments, same)) segments.push_back(segment);
    }
  };
  if (const auto whole = asked_segments(labels, read.segmentation)) {
    std::ranges::fill(asked.found, 1);
    add(*whole);
    return segments;
  }
  for (std::size_t k = 0; k < asked.parts.size(); ++k) {
    auto one = asked_segments(asked.parts[k], read.segmentation);
    if (one) add(*one);
    if (one) asked.found[k] = 1;
    if (!one && !asked.why_not[k]) asked.why_not[k] = Error{map.string(), one.error().what};
  }
  return segments;
}

std::vector<Segment> all_of(const VolumeRead& read) {
  std::vector<Segment> segments = read.segmentation.segments;
  for (const auto& [value, voxels] : labels_of(read.volume, 0))
    if (value != 0 && read.segmentation.find(value) == nullptr) segments.push_back({{}, value});
  return segments;
}

/// Takes out the segments whose name others have too, as the set would give it, and tells of each such name.
std::vector<std::string> take_doubled(std::vector<Segment>& segments, bool has_layers) {
  std::map<std::string, std::vector<Segment>> by_name;
  const auto key = [](const Segment& segment) { return lower_case(file_name_of_structure(name_in_set(segment))); };
  for (const Segment& segment : segments) by_name[key(segment)].push_back(segment);
  std::vector<std::string> words;
  for (const auto& [name, doubled] : by_name) {
    if (doubled.size() < 2) continue;
    std::vector<std::string> labels;
    for (const Segment& segment : doubled) labels.push_back(value_and_layer(segment, has_layers));
    words.push_back("has " + std::to_string(doubled.size()) + " structures named \"" + name_in_set(doubled.front()) +
                    "\", the labels " + listed(labels, " and "));
  }
  std::erase_if(segments, [&](const Segment& segment) { return by_name[key(segment)].size() > 1; });
  return words;
}

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
    free = file.parent_path() / (file.stem().string() + "-" + std::to_string(number) + file.extension().string());
  return free;
}

fs::path file_of_template(const SetJob& job, const std::string& structure) {
  return absolute_path(job.folder() / (file_name_of_structure(structure) + ".ply"));
}

bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code not_there;
  return a == b || fs::equivalent(a, b, not_there);
}

/// The templates that the set has which is there already under the name that is to be written.
std::vector<fs::path> templates_of_old_set(const SetJob& job) {
  std::vector<fs::path> files;
  if (const auto old = read_template_set(job.out))
    for (const TemplateOfSet& one : old->structures)
      if (names_file(one.file.string())) files.push_back(absolute_path(one.file));
  return files;
}

/// Whether the same command made a file before, and was stopped before it wrote its set.
bool is_of_same_command(const SetJob& job, const fs::path& file, Progress& progress) {
  const auto there = read_record(file);
  if (!there || !*there) return false;
  const auto record = record_of(job.command, progress);
  return record && **there == record_of_made(*record, job.out, file);
}

/// Errors: a file that is to be written is there, and is no template of the old set.
Result<void> check_own(const SetJob& job, const std::vector<fs::path>& to_write, Progress& progress) {
  const auto own = templates_of_old_set(job);
  for (const fs::path& file : to_write) {
    std::error_code ignored;
    if (!fs::exists(fs::symlink_status(file, ignored))) continue;
    if (std::ranges::none_of(own, [&](const fs::path& one) { return is_same_file(one, file); }) &&
        !is_of_same_command(job, file, progress))
      return fail(file.string(), "is there, is no template of " + job.out.string() +
                                     ", and would be written over; move it away, or give the set another name");
  }
  return {};
}

/// Files of one run that were not there before: gone again, unless the run keeps them in the end.
struct FilesOfRun {
  std::vector<fs::path> files;

  FilesOfRun() = default;
  FilesOfRun(const FilesOfRun&) = delete;
  FilesOfRun& operator=(const FilesOfRun&) = delete;
  ~FilesOfRun() {
    std::error_code ignored;
    for (const fs::path& file : files) fs::remove(file, ignored);
  }
};

/// Names the templates in the set's folder that only the old set had. They stay: cases and other sets may need them.
void name_left_over(const SetJob& job, const std::vector<fs::path>& old_files, const TemplateSet& set,
                    std::vector<std::string>& warnings) {
  const fs::path folder = absolute_path(job.folder() / "x").parent_path();
  std::vector<std::string> left;
  for (const fs::path& file : old_files) {
    const bool is_used = std::ranges::any_of(
        set.structures, [&](const TemplateOfSet& one) { return is_same_file(absolute_path(one.file), file); });
    if (!is_used && file.parent_path() == folder && fs::exists(file)) left.push_back(file.filename().string());
  }
  if (!left.empty())
    warnings.push_back(job.folder().string() + ": holds " + some_of(left) +
                       ", which only the set before had; delete them if no case and no other set has them");
}

}  // namespace

fs::path SetJob::folder() const {
  const std::string name = out.filename().string();
  return out.parent_path() / name.substr(0, name.size() - std::string_view(".set.json").size());
}

void add_structure_options(CLI::App& verb, SetJob& job) {
  auto* labels = verb.add_option("--labels", job.labels, "Which structures, by name or number: liver,spleen,3");
  verb.add_flag("--all", job.all, "All structures of the maps")->excludes(labels);
  verb.add_option("--vertices", job.vertices, "How many vertices each template has")
      ->check(CLI::Range(100, 200000))
      ->capture_default_str();
}

CLI::Option* is_name_of_set(CLI::Option* output) {
  return output->check([](const std::string& text) {
    return is_template_set(text) ? std::string() : text + " is no name of a set; use NAME.set.json";
  });
}

std::string name_in_set(const Segment& segment) {
  return segment.name.empty() ? "label " + std::to_string(segment.value) : segment.name;
}

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

Result<std::vector<std::vector<Segment>>> structures_asked(const SetJob& job, SetInMaking& making, Progress& progress) {
  AskedLabels labels;
  labels.parts = labels_between_commas(job.labels);
  labels.found.resize(labels.parts.size());
  labels.why_not.resize(labels.parts.size());
  std::vector<std::vector<Segment>> asked;
  std::set<fs::path> met;
  for (const fs::path& map : job.maps) {
    std::error_code ignored;
    if (!met.insert(fs::weakly_canonical(map, ignored)).second)
      return fail(map.string(), "is given twice, and would count as two subjects; name each map once");
    const auto subject = read_subject(map, std::nullopt, progress, false);
    if (!subject) return fail(subject.error());
    const VolumeRead& read = subject->read;
    making.warnings.insert(making.warnings.end(), read.warnings.begin(), read.warnings.end());
    for (const Segment& segment : all_of(read)) making.highest_value = std::max(making.highest_value, segment.value);
    asked.push_back(job.all ? all_of(read) : named_in(read, job.labels, map, labels));
    if (job.all && asked.back().empty()) return fail(map.string(), "holds no label; give a label map");
    for (const std::string& what : take_doubled(asked.back(), !read.other_layers.empty())) {
      if (!job.all) return fail(map.string(), what + "; name them apart");
      making.warnings.push_back(map.string() + ": " + what + "; they are left out; give one of them another name");
    }
    if (job.all && asked.back().empty())
      return fail(map.string(), "has no structure with a name of its own; give each another name");
  }
  for (std::size_t k = 0; k < labels.parts.size() && !job.all; ++k)
    if (labels.found[k] == 0) return fail(*labels.why_not[k]);
  return asked;
}

Result<void> check_templates_free(const SetJob& job, const std::vector<std::vector<Segment>>& asked,
                                  const TemplateSet& known, Progress& progress) {
  std::vector<fs::path> to_write;
  for (const auto& segments : asked)
    for (const Segment& segment : segments)
      if (const std::string name = name_in_set(segment); known.find(name) == nullptr)
        to_write.push_back(file_of_template(job, name));
  return check_own(job, to_write, progress);
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

Result<Report> write_set(const SetJob& job, SetInMaking& making, Progress& progress) {
  SetOfTemplates& made = making.made;
  for (const Json& row : making.rows)
    if (row["vertices"] == 0)
      making.warnings.push_back(row["name"].get<std::string>() + ": has no template in the set (" +
                                row["warning"].get<std::string>() + ")");
  if (made.templates.empty())
    return fail(
        job.maps.front().string(),
        "gives no template at all; the first reason: " +
            (making.rows.empty() ? making.warnings.front() : making.rows.front()["warning"].get<std::string>()));
  // Of what is there now: the set itself may be changed.
  const auto record = record_of(job.command, progress);
  if (!record) return fail(record.error());
  const auto old_files = templates_of_old_set(job);
  std::vector<fs::path> to_write;
  for (std::size_t k = 0; k < made.templates.size(); ++k)
    if (making.files[k].triangles.rows() > 0) to_write.push_back(made.set.structures[k].file);
  if (auto own = check_own(job, to_write, progress); !own) return fail(own.error());
  std::vector<Mesh> meshes;
  FilesOfRun new_files;
  for (std::size_t k = 0; k < made.templates.size(); ++k) {
    const Template& one = *made.templates[k];
    meshes.push_back({one.topology, one.points});
    if (making.files[k].triangles.rows() > 0) {
      making.files[k].record = record_of_made(*record, job.out, made.set.structures[k].file);
      if (std::error_code ignored; !fs::exists(made.set.structures[k].file, ignored))
        new_files.files.push_back(made.set.structures[k].file);
      if (auto written = write_mesh_file(making.files[k], made.set.structures[k].file); !written)
        return fail(written.error());
    }
    if (making.relative[k].empty() || made.templates.size() < 2) continue;
    made.set.structures[k].pose = relative_pose(making.relative[k], one.points.colwise().mean());
  }
  find_partners(made.set);
  find_neighbours(made.set, meshes, near_mm);
  if (auto written = write_template_set(made.set, job.out, job.in_place ? "" : *record); !written)
    return fail(written.error());
  new_files.files.clear();
  name_left_over(job, old_files, made.set, making.warnings);
  for (Json& row : making.rows)
    if (const TemplateOfSet* one = made.set.find(row["name"].get<std::string>()); one != nullptr && one->pose)
      row["pose"] = json_of_pose(*one->pose);
  Report report;
  report.warnings = std::move(making.warnings);
  report.values = {{"set", job.out.string()}, {"structures", making.rows}};
  return report;
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
