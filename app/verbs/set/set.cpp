#include <algorithm>
#include <memory>

#include "app/verbs/set/set_edit.h"
#include "app/verbs/set/set_making.h"
#include "app/verbs/verbs.h"
#include "core/base/files/paths.h"
#include "core/catalogue/catalogue.h"
#include "core/structures/built_in_set.h"
#include "core/template/template.h"

// The verb `set`: templates of several structures that belong together.

namespace homolog {

namespace {

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
    if (one.pose) row["pose"] = json_of_pose(*one.pose);
    rows.push_back(std::move(row));
  }
  report.values = {{"set", source}, {"structures", std::move(rows)}};
  return report;
}

void add_set_make(CLI::App& set, CommandLine& asked) {
  auto job = std::make_shared<SetJob>();
  CLI::App* verb = add_verb(set, "make", "A template of each structure of a label map, or of several maps");
  verb->add_option("MAP", job->maps, "Label maps of several structures; templates are made from the first")->required();
  add_structure_options(*verb, *job);
  auto* like = verb->add_option("--like", job->like, "The map that templates are made from, else the first");
  verb->add_flag("--consensus", job->consensus, "Templates of the mean shapes, which no one subject decides")
      ->excludes(like);
  is_name_of_set(
      verb->add_option("-o,--output", job->out, "The set to write, NAME.set.json; its templates go into NAME beside it")
          ->required());
  verb->callback([job, verb, &asked] {
    job->command = given_command(*verb);
    if (!job->all && job->labels.empty()) throw CLI::RequiredError("--labels with the structures wanted, or --all");
    if (job->consensus && job->maps.size() < 2)
      throw CLI::ValidationError("--consensus", "is a mean of several subjects; name two maps or more");
    if (!job->like.empty()) {
      std::erase_if(job->maps, [&](const auto& map) { return absolute_path(map) == absolute_path(job->like); });
      job->maps.insert(job->maps.begin(), job->like);
    }
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
  add_set_edits(*set, asked);
}

}  // namespace homolog
