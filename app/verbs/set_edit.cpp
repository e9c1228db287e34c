#include "app/verbs/set_edit.h"

#include <algorithm>
#include <memory>

#include "app/verbs/set_cases.h"
#include "app/verbs/set_making.h"
#include "core/base/files.h"
#include "core/base/text.h"
#include "core/catalogue/catalogue.h"
#include "core/structures/built_in_set.h"

// The verbs that change a template set: `set add` and `set rename`.

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// A change of a set.
struct SetEdit {
  std::string set, first, second;
  fs::path out;  ///< empty: in place
};

/// Where a changed set is written. Errors: a set that is built in has no place of its own.
Result<fs::path> place_of_changed(const std::string& set, const fs::path& out) {
  if (!out.empty()) return out;
  if (is_built_in(set)) return fail(set, "is built in and stays as it is; give the changed set a name with -o");
  return fs::path(set);
}

Result<Report> rename_in_set(const SetEdit& edit) {
  const auto out = place_of_changed(edit.set, edit.out);
  if (!out) return fail(out.error());
  auto set = load_template_set(edit.set);
  if (!set) return fail(set.error());
  if (auto renamed = rename_structure(*set, edit.first, edit.second); !renamed)
    return fail(edit.set, renamed.error().what);
  if (auto written = write_template_set(*set, *out); !written) return fail(written.error());
  Report report;
  report.values = {{"set", out->string()}, {"old", edit.first}, {"new", edit.second}};
  return report;
}

/// What the set knows already of what is asked for by its labels. Errors: it has one of them.
Result<void> check_new(const SetJob& job, const std::string& source, const TemplateSet& set,
                       const std::vector<Segment>& asked) {
  for (const Segment& segment : asked)
    if (!job.all && set.find(name_in_set(segment)) != nullptr)
      return fail(source, "has a structure named \"" + excerpt(name_in_set(segment)) +
                              "\" already; rename it with set rename, or ask for others");
  return {};
}

Result<Report> add_to_set(SetJob job, const std::string& source, Progress& progress) {
  const auto out = place_of_changed(source, job.out);
  if (!out) return fail(out.error());
  job.out = *out;
  auto set = load_set_of_templates(source);
  if (!set) return fail(set.error());
  if (std::ranges::find(set->templates, nullptr) != set->templates.end())
    return fail(source, "has a template that cannot be read (" + set->warnings.front() +
                            "); bring it back, or take its structure out");
  const auto asked = structures_asked(job, progress);
  if (!asked) return fail(asked.error());
  if (auto is_new = check_new(job, source, set->set, asked->front()); !is_new) return fail(is_new.error());
  const auto folder = ResultFolder::make(job.folder());
  if (!folder) return fail(folder.error());
  SetInMaking making;
  making.made = std::move(*set);
  const std::size_t known = making.made.templates.size();
  making.files.resize(known);
  making.relative.resize(known);
  if (auto added = add_map(job, job.maps.front(), asked->front(), making, progress); !added) return fail(added.error());
  if (progress.cancelled()) return fail("", "was stopped; the set is as it was");
  if (making.rows.empty())
    return fail(job.maps.front().string(),
                "has no voxel of a structure that the set lacks; homolog info says what it "
                "has");
  if (making.made.templates.size() == known)
    return fail(job.maps.front().string(),
                "gives the set no template; the first reason: " + making.rows.front()["warning"].get<std::string>());
  // One more subject says nothing of the spread among those that the set was made of.
  for (std::size_t k = 0; k < known; ++k) making.relative[k].clear();
  return write_set(job, making);
}

CLI::App* add_edit(CLI::App& set, const char* name, const char* description, std::string& source) {
  CLI::App* verb = add_verb(set, name, description);
  verb->add_option("SET", source, "A template set, NAME.set.json, or " + built_in_set_source())->required();
  return verb;
}

void add_output(CLI::App& verb, fs::path& out) {
  is_name_of_set(verb.add_option("-o,--output", out, "The set to write, NAME.set.json; else SET itself is changed"));
}

}  // namespace

void add_set_edits(CLI::App& set, CommandLine& asked) {
  auto job = std::make_shared<SetJob>();
  auto source = std::make_shared<std::string>();
  job->maps.resize(1);
  CLI::App* add = add_edit(set, "add", "Adds structures of another label map to a template set", *source);
  add->add_option("MAP", job->maps.front(), "A label map with them and with structures of the set beside them")
      ->required();
  add_structure_options(*add, *job);
  add_output(*add, job->out);
  add->callback([job, source, &asked] {
    if (!job->all && job->labels.empty()) throw CLI::RequiredError("--labels with the structures wanted, or --all");
    asked.run = [job, source](Progress& progress) { return add_to_set(*job, *source, progress); };
  });

  auto naming = std::make_shared<SetEdit>();
  CLI::App* rename = add_edit(set, "rename", "Gives a structure of a template set another name", naming->set);
  rename->add_option("OLD", naming->first, "The structure's name")->required();
  rename->add_option("NEW", naming->second, "Its new name")->required();
  add_output(*rename, naming->out);
  rename->callback([naming, &asked] { asked.run = [naming](Progress&) { return rename_in_set(*naming); }; });
}

}  // namespace homolog
