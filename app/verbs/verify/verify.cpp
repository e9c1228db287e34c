#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <sstream>

#include "app/verbs/help_page.h"
#include "app/verbs/record.h"
#include "app/verbs/verbs.h"
#include "app/verbs/verify/verify_compare.h"
#include "app/verbs/verify/verify_inputs.h"
#include "app/version.h"
#include "core/base/encoding/json.h"
#include "core/base/files/file_record.h"
#include "core/base/files/paths.h"
#include "core/base/processes/process.h"
#include "core/base/text/listed.h"
#include "core/base/text/text.h"
#include "core/catalogue/catalogue.h"
#include "core/model/files/statismo.h"
#include "core/session/case_file.h"

// The verb `verify`: makes a file anew, as its record says, and compares.

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct VerifyJob {
  fs::path file, inputs;

  fs::path folder() const { return inputs.empty() ? absolute_path(file).parent_path() : inputs; }
};

/// What a record says, its form checked.
struct ReadRecord {
  std::string version, output;
  std::optional<std::string> beside;  ///< how what the command writes ends, where the output is named from beside it
  const RecordedVerb* verb = nullptr;
  Json options;
};

Result<Json> record_json(const fs::path& file) {
  const auto text = is_model_name(file) ? read_model_record(file) : read_record(file);
  if (!text) return fail(text.error());
  if (!*text && is_case_file(file))
    return fail(file.string(),
                "is a case without a record of how it began; its edits are how its mesh was made, so verify the mesh "
                "that replay wrote of it");
  if (!*text)
    return fail(file.string(),
                "carries no record of how it was made; only what a verb of this version or a newer one wrote can be "
                "verified, and not what the window or another program wrote");
  auto json = read_json<Json>(**text);
  if (!json) return fail(file.string(), damaged_record().what);
  return json;
}

Result<ReadRecord> record_in(const fs::path& file) {
  const auto json = record_json(file);
  if (!json) return fail(json.error());
  const auto text = [&](const char* key) {
    const auto found = json->find(key);
    return json->is_object() && found != json->end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  ReadRecord record{text("version"), text("output"), {}, recorded_verb(text("command")), Json::object()};
  if (record.version.empty() || !json->contains("options") || !(*json)["options"].is_object())
    return fail(file.string(), damaged_record().what);
  if (record.verb == nullptr)
    return fail(file.string(), "was made by \"" + excerpt(text("command")) + "\" of version " +
                                   excerpt(record.version) + ", which this version " + version +
                                   " cannot do again; use that version");
  record.options = (*json)["options"];
  if (json->contains("beside")) record.beside = text("beside");
  return record;
}

/// A value of an option as the command line has it. An input becomes the path where it was laid; any other path is
/// refused, since a record may come from anywhere. `folder`: of this value alone.
Result<std::string> argument_of(const Json& value, bool of_input, const FoundInputs& inputs, const fs::path& folder,
                                const fs::path& room) {
  if (value.is_object()) {
    // Deep, so that what a file names may lie above it.
    const auto path = inputs.lay(value, folder / "1/2/3/4/5/6/7/8", room);
    return path ? Result<std::string>(path->string()) : fail(path.error());
  }
  if (!value.is_string()) return fail(damaged_record());
  auto text = value.get<std::string>();
  if (text.empty() || (of_input && names_file(text))) return fail(damaged_record());
  return text;
}

/// Whether a name is that of an option that a record may give: nothing that writes, and no value in the name.
bool may_be_given(const std::string& name, const RecordedVerb& verb) {
  return !verb.writes(name) && name.find('=') == std::string::npos &&
         (!name.starts_with('-') || name.starts_with("--"));
}

bool is_shipped_recipe(const std::string& name) {
  const std::vector<std::string> shipped = shipped_recipes();
  return std::ranges::find(shipped, name) != shipped.end();
}

/// Adds an option of a record to a command line.
Result<void> add_option(const std::string& name, const Json& values, const ReadRecord& record,
                        const FoundInputs& inputs, const fs::path& room, std::vector<std::string>& arguments) {
  if (!may_be_given(name, *record.verb)) return fail(damaged_record());
  std::vector<std::string> given;
  for (const Json& value : values.is_array() ? values : Json::array()) {
    const fs::path folder = room / std::to_string(arguments.size()) / std::to_string(given.size());
    const bool ships = name == "--recipe" && value.is_string() && is_shipped_recipe(value.get<std::string>());
    auto one = argument_of(value, record.verb->reads(name) && !ships, inputs, folder, room);
    if (!one) return fail(one.error());
    given.push_back(std::move(*one));
  }
  if (name.starts_with("--") && given.size() == 1) {
    arguments.push_back(name + "=" + given.front());
    return {};
  }
  for (const std::string& value : given)
    if (value.starts_with('-')) return fail(damaged_record());  // it would be another option
  if (name.starts_with("--")) arguments.push_back(name);
  arguments.insert(arguments.end(), given.begin(), given.end());
  return {};
}

/// The command line of a record that writes to `out`. Positional arguments come before all options.
Result<std::vector<std::string>> command_line_of(const ReadRecord& record, const FoundInputs& inputs,
                                                 const fs::path& room, const fs::path& out) {
  std::vector<std::string> arguments;
  std::istringstream words{std::string(record.verb->name)};
  for (std::string word; words >> word;) arguments.push_back(word);
  for (const bool positional : {true, false}) {
    for (const auto& [name, values] : record.options.items())
      if (name.starts_with("--") != positional)
        if (auto added = add_option(name, values, record, inputs, room, arguments); !added) return fail(added.error());
    const std::string output(record.verb->output);
    if (output.starts_with("--") == positional) continue;
    arguments.push_back(positional ? out.string() : output + "=" + out.string());
  }
  return arguments;
}

/// Does a verb's work in this process.
Result<Report> do_again(std::vector<std::string> arguments, Progress& progress) {
  CLI::App app("", "homolog");
  CommandLine asked;
  for (AddVerb* const add : all_verbs) add(app, asked);
  app.require_subcommand(1, 1);  // a value that is called like a verb is none
  std::reverse(arguments.begin(), arguments.end());
  try {
    app.parse(std::move(arguments));
  } catch (const CLI::Error& error) {
    return fail("", std::string("its command cannot be done again by this version: ") + error.what());
  }
  if (!asked.run) return fail("", "its command cannot be done again by this version");
  return run_recorded(asked.run, *verb_given(app), progress);
}

/// The file that is made anew: of a folder that one which the record says.
Result<fs::path> made_anew(const ReadRecord& record, const FoundInputs& inputs, const fs::path& file,
                           const fs::path& scratch, Progress& progress) {
  const fs::path room = scratch / "in", folder = scratch / "out";
  fs::path anew = folder / file.filename(), out = anew;
  if (!record.output.empty()) {
    const std::string called = "made";
    fs::path output;
    for (const fs::path& part : fs::path(record.output))
      output /= record.beside && part.string().starts_with('*') ? called + part.string().substr(1) : part.string();
    for (const fs::path& part : output)
      if (!is_file_name(part.string())) return fail(damaged_record());
    if (record.beside && !is_file_name(called + *record.beside)) return fail(damaged_record());
    out = record.beside ? folder / (called + *record.beside) : folder;
    anew = folder / output;
  }
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return fail(folder.string(), "cannot be made (" + error.message() + "); free some space");
  const auto arguments = command_line_of(record, inputs, room, out);
  if (!arguments) return fail(arguments.error());
  const auto done = do_again(*arguments, progress);
  if (!done) return fail(done.error());
  return anew;
}

/// Why a file is not the same, as a sentence.
std::string sentence_of(const FileDifference& difference, const ReadRecord& record) {
  char amount[96] = "";
  std::string what = difference.in_words;
  if (what.empty() && difference.voxels && *difference.voxels > 0)
    what = std::to_string(*difference.voxels) + " voxels differ";
  if (what.empty() && difference.largest_mm && *difference.largest_mm > 0) {
    std::snprintf(amount, sizeof amount, "they differ by up to %.3g mm", *difference.largest_mm);
    what = amount;
  }
  if (what.empty()) what = "only what is said beside the shape differs";
  const bool other = record.version != version;
  return "is not what its inputs give: " + what +
         (other ? "; it was made by version " + excerpt(record.version) + ", and this is " + version
                : "; it was changed after it was written, or made by another build");
}

Json json_of_inputs(const FoundInputs& inputs) {
  Json list = Json::array();
  for (const FoundInput& one : inputs.all())
    list.push_back({{"name", one.name}, {"sha256", one.sha256}, {"path", one.path.string()}});
  return list;
}

Result<Report> verify(const VerifyJob& job, Progress& progress) {
  const auto record = record_in(job.file);
  if (!record) return fail(record.error());
  progress.part(0, 0.2);
  const auto inputs = FoundInputs::find(record->options, job.folder(), progress);
  if (!inputs)
    return fail(inputs.error().subject.empty() ? job.file.string() : inputs.error().subject, inputs.error().what);
  if (const auto missing = inputs->missing(); !missing.empty())
    return fail(job.file.string(), "was made of " + listed(missing, " and ") + ", which " + job.folder().string() +
                                       " does not hold in the same state; name the folder that does with --inputs");
  progress.part(0.2, 1);
  const ScratchFolder scratch("homolog-verify");
  Progress again(progress, 0.75);
  const auto anew = made_anew(*record, *inputs, job.file, scratch.path, again);
  if (!anew) return fail(job.file.string(), "cannot be made anew: " + anew.error().sentence());
  const auto difference = difference_of_files(job.file, *anew, again);
  if (!difference) return fail(difference.error());
  Report report;
  const bool same = difference->same_bytes || (record->version != version && difference->same_content);
  report.values = {{"same", same},
                   {"largest_mm", difference->largest_mm ? Json(*difference->largest_mm) : Json()},
                   {"command", record->verb->name},
                   {"made_by", record->version},
                   {"verified_by", version},
                   {"inputs", json_of_inputs(*inputs)}};
  if (difference->voxels) report.values["different_voxels"] = *difference->voxels;
  if (difference->lines_since) report.values["lines_since"] = *difference->lines_since;
  if (!same) report.refusal = Error{job.file.string(), sentence_of(*difference, *record)};
  return report;
}

}  // namespace

void add_verify(CLI::App& app, CommandLine& asked) {
  auto job = std::make_shared<VerifyJob>();
  CLI::App* verb = add_verb(app, "verify", "Makes a file anew from its inputs, as its record says, and compares");
  verb->add_option("FILE", job->file,
                   "What a verb wrote: a mesh, an image, a model, a case, a study, a table, a page or a picture")
      ->required();
  verb->add_option("--inputs", job->inputs,
                   "The folder in which its inputs lie, however deep and under whatever name (default: FILE's folder)");
  verb->callback([job, &asked] { asked.run = [job](Progress& progress) { return verify(*job, progress); }; });
}

}  // namespace homolog
