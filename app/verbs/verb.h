#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/editor/window/editor.h"
#include "core/base/progress.h"
#include "core/base/result.h"

namespace homolog {

using Json = nlohmann::ordered_json;

/// What a verb reports: the JSON object of docs/commands.md, which `--json` prints as it is and which is otherwise
/// printed as lines, and sentences for `homolog: warning: …`.
struct Report {
  Json values = Json::object();
  std::vector<std::string> warnings;
};

/// The work of the verb that was given on the command line; empty where none was.
using VerbRun = std::function<Result<Report>(Progress&)>;

// Each adds one verb with its options; once the command line is parsed, `run` holds the work of the one chosen.
void add_bench(CLI::App& app, VerbRun& run);
void add_compare(CLI::App& app, VerbRun& run);
void add_convert(CLI::App& app, VerbRun& run);
/// With a display the demo is the editor: then `editor` says what to open and `run` stays empty.
void add_demo(CLI::App& app, VerbRun& run, EditorOptions& editor);
void add_evaluate(CLI::App& app, VerbRun& run);
void add_fit(CLI::App& app, VerbRun& run);
void add_info(CLI::App& app, VerbRun& run);
void add_label_map(CLI::App& app, VerbRun& run);
void add_mirror(CLI::App& app, VerbRun& run);
void add_model(CLI::App& app, VerbRun& run);
void add_phantom(CLI::App& app, VerbRun& run);
void add_picture(CLI::App& app, VerbRun& run);
void add_propagate(CLI::App& app, VerbRun& run);
void add_refine(CLI::App& app, VerbRun& run);
void add_replay(CLI::App& app, VerbRun& run);
void add_snap(CLI::App& app, VerbRun& run);
void add_study(CLI::App& app, VerbRun& run);
void add_template(CLI::App& app, VerbRun& run);

/// Adds a verb that reports: its `--json` flag and its `--jobs` are read by main.
inline CLI::App* add_verb(CLI::App& app, const char* name, const char* description) {
  CLI::App* verb = app.add_subcommand(name, description);
  verb->add_flag("--json")->description("Print one JSON object on stdout and nothing else there");
  verb->add_option("--jobs", "How many threads to use at most; results do not depend on it")
      ->check(CLI::Range(1, 1024));
  return verb;
}

}  // namespace homolog
