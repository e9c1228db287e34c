#include "app/verbs/set/set_edit.h"

#include <algorithm>
#include <cstdio>
#include <memory>

#include "app/verbs/set/set_cases.h"
#include "app/verbs/set/set_making.h"
#include "core/base/files/files.h"
#include "core/base/text/text.h"
#include "core/catalogue/catalogue.h"
#include "core/structures/built_in_set.h"
#include "core/structures/fitting/share_vertices.h"

// The verbs that change a template set: `set add`, `set rename`, `set share`.

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// A change of a set.
struct SetEdit {
  std::string set, first, second;
  fs::path out;  ///< empty: in place
  double within_mm = 0.5;
  GivenCommand command;
};

/// Where a changed set is written. Errors: a set that is built in has no place of its own.
Result<fs::path> place_of_changed(const std::string& set, const fs::path& out) {
  if (!out.empty()) return out;
  if (is_built_in(set)) return fail(set, "is built in and stays as it is; give the changed set a name with -o");
  return fs::path(set);
}

/// Whether a set is changed itself. What it was is gone then, so it gets no record of how it was made.
bool is_in_place(const std::string& set, const fs::path& out) {
  std::error_code not_there;
  return fs::equivalent(set, out, not_there);
}

/// The record of a set that is written to `out`; empty where it is changed itself.
Result<std::string> record_of_edit(const SetEdit& edit, const fs::path& out, Progress& progress) {
  return is_in_place(edit.set, out) ? Result<std::string>(std::string()) : record_of(edit.command, progress);
}

Result<Report> rename_in_set(const SetEdit& edit, Progress& progress) {
  const auto out = place_of_changed(edit.set, edit.out);
  if (!out) return fail(out.error());
  auto set = load_template_set(edit.set);
  if (!set) return fail(set.error());
  if (auto renamed = rename_structure(*set, edit.first, edit.second); !renamed)
    return fail(edit.set, renamed.error().what);
  const auto record = record_of_edit(edit, *out, progress);
  if (!record) return fail(record.error());
  if (auto written = write_template_set(*set, *out, *record); !written) return fail(written.error());
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
  job.in_place = is_in_place(source, *out);
  auto set = load_set_of_templates(source);
  if (!set) return fail(set.error());
  if (std::ranges::find(set->templates, nullptr) != set->templates.end())
    return fail(source, "has a template that cannot be read (" + set->warnings.front() +
                            "); bring it back, or take its structure out");
  SetInMaking making;
  const auto asked = structures_asked(job, making, progress);
  if (!asked) return fail(asked.error());
  if (auto is_new = check_new(job, source, set->set, asked->front()); !is_new) return fail(is_new.error());
  if (auto is_free = check_templates_free(job, *asked, set->set, progress); !is_free) return fail(is_free.error());
  const auto folder = ResultFolder::make(job.folder());
  if (!folder) return fail(folder.error());
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
  return write_set(job, making, progress);
}

Result<Report> share_in_set(const SetEdit& edit, Progress& progress) {
  const auto out = place_of_changed(edit.set, edit.out);
  if (!out) return fail(out.error());
  auto loaded = load_set_of_templates(edit.set);
  if (!loaded) return fail(loaded.error());
  TemplateSet& set = loaded->set;
  std::array<std::size_t, 2> which{};
  for (const std::string* name : {&edit.first, &edit.second}) {
    const TemplateOfSet* one = set.find(*name);
    if (one == nullptr)
      return fail(edit.set, "has no structure \"" + excerpt(*name) + "\"; it has " + names_in_set(set));
    which[name == &edit.first ? 0 : 1] = static_cast<std::size_t>(one - set.structures.data());
    if (loaded->templates[one - set.structures.data()] == nullptr)
      return fail(edit.set, "has no template of \"" + one->name + "\" that can be read; bring its file back");
  }
  if (which[0] == which[1])
    return fail(edit.set, "shares vertices between two structures; name another one beside \"" + edit.first + "\"");
  const Points &a = loaded->templates[which[0]]->points, &b = loaded->templates[which[1]]->points;
  SharedVertices shared{set.structures[which[0]].name, set.structures[which[1]].name,
                        coinciding_vertices(a, b, edit.within_mm)};
  if (shared.vertices.empty())
    return fail(edit.set, "has no vertices of " + shared.a + " and " + shared.b +
                              " that coincide; allow more with --within-mm, or take templates that share vertices");
  Report report;
  report.warnings = loaded->warnings;
  double farthest_mm = 0;
  for (const auto& [of_a, of_b] : shared.vertices)
    farthest_mm = std::max(farthest_mm, (a.row(of_a) - b.row(of_b)).norm());
  constexpr double one_place_mm = 1e-3;
  if (farthest_mm > one_place_mm) {
    char text[160];
    std::snprintf(text, sizeof text,
                  ": vertices that lie up to %.3g mm apart become one; give a smaller --within-mm if they are not",
                  farthest_mm);
    report.warnings.push_back(shared.a + " and " + shared.b + text);
  }
  report.values = {{"set", out->string()},
                   {"structures", {shared.a, shared.b}},
                   {"shared", shared.vertices.size()},
                   {"farthest_mm", farthest_mm}};
  std::erase_if(set.shared, [&](const SharedVertices& one) {
    return (one.a == shared.a && one.b == shared.b) || (one.a == shared.b && one.b == shared.a);
  });
  set.shared.push_back(std::move(shared));
  const auto record = record_of_edit(edit, *out, progress);
  if (!record) return fail(record.error());
  if (auto written = write_template_set(set, *out, *record); !written) return fail(written.error());
  return report;
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
  add->callback([job, source, add, &asked] {
    if (!job->all && job->labels.empty()) throw CLI::RequiredError("--labels with the structures wanted, or --all");
    job->command = given_command(*add);
    asked.run = [job, source](Progress& progress) { return add_to_set(*job, *source, progress); };
  });

  auto naming = std::make_shared<SetEdit>();
  CLI::App* rename = add_edit(set, "rename", "Gives a structure of a template set another name", naming->set);
  rename->add_option("OLD", naming->first, "The structure's name")->required();
  rename->add_option("NEW", naming->second, "Its new name")->required();
  add_output(*rename, naming->out);
  rename->callback([naming, rename, &asked] {
    naming->command = given_command(*rename);
    asked.run = [naming](Progress& progress) { return rename_in_set(*naming, progress); };
  });

  auto sharing = std::make_shared<SetEdit>();
  CLI::App* share =
      add_edit(set, "share", "Vertices that two structures have in common, so that fits do too", sharing->set);
  share->add_option("A", sharing->first, "A structure")->required();
  share->add_option("B", sharing->second, "Another one that touches it")->required();
  share->add_option("--within-mm", sharing->within_mm, "How far apart vertices that coincide may lie")
      ->check(CLI::Range(1e-9, 100.0))
      ->capture_default_str();
  add_output(*share, sharing->out);
  share->callback([sharing, share, &asked] {
    sharing->command = given_command(*share);
    asked.run = [sharing](Progress& progress) { return share_in_set(*sharing, progress); };
  });
}

}  // namespace homolog
