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

/// The work of a verb.
using VerbRun = std::function<Result<Report>(Progress&)>;

/// What the command line asks for.
struct CommandLine {
  VerbRun run;           ///< of the verb that was given; empty where the editor is to be opened
  EditorOptions editor;  ///< what the editor opens
};

/// Adds a verb that reports: its `--json` flag and its `--jobs` are read by main.
inline CLI::App* add_verb(CLI::App& app, const char* name, const char* description) {
  CLI::App* verb = app.add_subcommand(name, description);
  verb->add_flag("--json")->description("Print one JSON object on stdout and nothing else there");
  verb->add_option("--jobs", "How many threads to use at most; results do not depend on it")
      ->check(CLI::Range(1, 1024));
  return verb;
}

/// Refuses an option that was given where it does nothing. `why`: what it is for.
inline void refuse_without_effect(const CLI::App& verb, const char* option, const char* why) {
  if (verb.count(option) > 0) throw CLI::ValidationError(option, std::string("has no effect here: it is for ") + why);
}

}  // namespace homolog
