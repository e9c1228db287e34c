#include <algorithm>
#include <memory>
#include <set>

#include "app/verbs/case_pool.h"
#include "app/verbs/read_image.h"
#include "app/verbs/template_job.h"
#include "app/verbs/verbs.h"
#include "core/base/file_stem.h"
#include "core/base/files.h"
#include "core/base/listed.h"
#include "core/base/paths.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/isosurface.h"
#include "core/structures/built_in_set.h"
#include "core/template/template.h"
#include "core/volume/read_labels.h"
#include "core/volume/segmentation.h"

// The verb `set`: templates of several structures that belong together.

namespace homolog {

namespace fs = std::filesystem;

namespace {

constexpr double near_mm = 5;  ///< structures whose surfaces come nearer are neighbours

struct SetJob {
  fs::path map, out;
  std::string labels;
  bool all = false;
  int vertices = 2500;

  /// Where templates go: NAME beside NAME.set.json.
  fs::path folder() const {
    const std::string name = out.filename().string();
    return out.parent_path() / name.substr(0, name.size() - std::string_view(".set.json").size());
  }
};

/// The structures of a map that are asked for.
Result<std::vector<Segment>> structures_of(const SetJob& job, Progress& progress) {
  VolumeReadOptions options;
  options.progress = &progress;
  auto read = read_labels(job.map, options);
  if (!read) return fail(read.error());
  if (!job.all) return choose_segments(job.map, job.labels, *read);
  std::vector<Segment> segments = read->segmentation.segments;
  for (const auto& [value, voxels] : labels_of(read->volume, 0))
    if (value != 0 && read->segmentation.find(value) == nullptr) segments.push_back({{}, value});
  if (segments.empty()) return fail(job.map.string(), "holds no label; give a label map");
  return segments;
}

/// What a segment is called in the set.
std::string name_of(const Segment& segment) {
  return segment.name.empty() ? "label " + std::to_string(segment.value) : segment.name;
}

/// What became of one structure.
struct MadeStructure {
  std::optional<TemplateOfSet> structure;  ///< none where no template could be made
  std::optional<Mesh> mesh;
  Json row;
  std::vector<std::string> warnings;
};

/// Errors: the disk; that no template can be made of it is none.
Result<MadeStructure> make_structure(const SetJob& job, const Segment& segment, Progress& progress) {
  TemplateJob making;
  making.in = job.map;
  making.label = segment.name.empty() ? std::to_string(segment.value) : segment.name;
  making.vertices = job.vertices;
  const std::string name = name_of(segment);
  making.out = job.folder() / (file_name_of_structure(name) + ".ply");
  MadeStructure done;
  done.row = {{"name", name}, {"value", segment.value}, {"vertices", 0}, {"genus", nullptr}, {"warning", nullptr}};
  auto made = make_template_of_one(making, true, progress);
  const auto topology =
      made ? Topology::make(made->file.points.rows(), made->file.triangles) : Result<std::shared_ptr<const Topology>>();
  if (!made || !topology) {
    const std::string why = made ? topology.error().what : made.error().sentence();
    done.row["warning"] = why;
    done.warnings.push_back(name + ": has no template in the set (" + why + ")");
    return done;
  }
  if (auto written = write_mesh_file(made->file, making.out); !written) return fail(written.error());
  done.row["vertices"] = made->file.points.rows();
  done.row["genus"] = (*topology)->genus();
  if (!made->warnings.empty()) done.row["warning"] = made->warnings.back();
  done.warnings = std::move(made->warnings);
  done.mesh = Mesh{*topology, made->file.points};
  TemplateOfSet structure;
  structure.name = name;
  structure.value = segment.value;
  structure.layer = segment.layer;
  structure.colour = segment.colour;
  structure.file = absolute_path(making.out);
  if (const Json& warning = done.row["warning"]; warning.is_string()) structure.other["warning"] = warning;
  done.structure = std::move(structure);
  return done;
}

Result<Report> make_set(const SetJob& job, Progress& progress) {
  const auto segments = structures_of(job, progress);
  if (!segments) return fail(segments.error());
  std::set<std::string> names;
  for (const Segment& segment : *segments)
    if (!names.insert(file_name_of_structure(name_of(segment))).second)
      return fail(job.map.string(),
                  "has two structures named \"" + segment.name + "\"; name them apart, or take some by --labels");
  const auto folder = ResultFolder::make(job.folder());
  if (!folder) return fail(folder.error());
  std::vector<MadeStructure> made(segments->size());
  const auto work = [&](std::size_t k, Progress& part) -> Result<Report> {
    auto one = make_structure(job, (*segments)[k], part);
    if (!one) return fail(one.error());
    made[k] = std::move(*one);
    return Report{};
  };
  const auto done = run_cases(segments->size(), work, progress);
  if (progress.cancelled()) return fail("", "was stopped; the templates made so far are kept");
  for (const auto& one : done)
    if (!one) return fail(one.error());
  TemplateSet set;
  std::vector<Mesh> meshes;
  Report report;
  Json rows = Json::array();
  for (MadeStructure& one : made) {
    rows.push_back(std::move(one.row));
    report.warnings.insert(report.warnings.end(), one.warnings.begin(), one.warnings.end());
    if (!one.structure) continue;
    set.structures.push_back(std::move(*one.structure));
    meshes.push_back(std::move(*one.mesh));
  }
  if (set.structures.empty())
    return fail(job.map.string(), "gives no template at all; the first reason: " + report.warnings.front());
  find_partners(set);
  find_neighbours(set, meshes, near_mm);
  if (auto written = write_template_set(set, job.out); !written) return fail(written.error());
  report.values = {{"set", job.out.string()}, {"structures", std::move(rows)}};
  return report;
}

Result<Mesh> mesh_of(const TemplateOfSet& one) {
  if (names_file(one.file.string())) return read_mesh(one.file);
  const auto built_in = load_template(one.file.string());
  if (!built_in) return fail(built_in.error());
  return Mesh{(*built_in)->topology, (*built_in)->points};
}

Result<Report> set_info(const std::string& source) {
  const auto set = load_template_set(source);
  if (!set) return fail(set.error());
  Report report;
  Json rows = Json::array();
  for (const TemplateOfSet& one : set->structures) {
    Json row{{"name", one.name}, {"value", one.value}, {"vertices", 0}, {"genus", nullptr}, {"warning", nullptr}};
    if (const auto warning = one.other.find("warning"); warning != one.other.end()) row["warning"] = *warning;
    const auto mesh = mesh_of(one);
    if (mesh) {
      row["vertices"] = mesh->points.rows();
      row["genus"] = mesh->topology->genus();
    } else {
      row["warning"] = mesh.error().sentence();
      report.warnings.push_back(mesh.error().sentence());
    }
    row["side"] = one.side == Side::left ? Json("left") : one.side == Side::right ? Json("right") : Json();
    row["partner"] = one.partner.empty() ? Json() : Json(one.partner);
    row["neighbours"] = one.neighbours;
    rows.push_back(std::move(row));
  }
  report.values = {{"set", source}, {"structures", std::move(rows)}};
  return report;
}

void add_set_make(CLI::App& set, CommandLine& asked) {
  auto job = std::make_shared<SetJob>();
  CLI::App* verb = add_verb(set, "make", "A template of each structure of a label map");
  verb->add_option("MAP", job->map, "A label map of several structures")->required();
  auto* labels = verb->add_option("--labels", job->labels, "Which structures, by name or number: liver,spleen,3");
  verb->add_flag("--all", job->all, "All structures of the map")->excludes(labels);
  verb->add_option("--vertices", job->vertices, "How many vertices each template has")
      ->check(CLI::Range(100, 200000))
      ->capture_default_str();
  verb->add_option("-o,--output", job->out, "The set to write, NAME.set.json; its templates go into NAME beside it")
      ->required()
      ->check([](const std::string& text) {
        return is_template_set(text) ? std::string() : text + " is no name of a set; use NAME.set.json";
      });
  verb->callback([job, &asked] {
    if (!job->all && job->labels.empty()) throw CLI::RequiredError("--labels with the structures wanted, or --all");
    asked.run = [job](Progress& progress) { return make_set(*job, progress); };
  });
}

void add_set_info(CLI::App& set, CommandLine& asked) {
  auto source = std::make_shared<std::string>();
  CLI::App* verb = add_verb(set, "info", "The structures of a template set");
  verb->add_option("SET", *source, "A template set, NAME.set.json, or " + built_in_set_source())->required();
  verb->callback([source, &asked] { asked.run = [source](Progress&) { return set_info(*source); }; });
}

}  // namespace

void add_set(CLI::App& app, CommandLine& asked) {
  CLI::App* set = app.add_subcommand("set", "Templates of several structures that belong together");
  set->require_subcommand(1);
  add_set_make(*set, asked);
  add_set_info(*set, asked);
}

}  // namespace homolog
