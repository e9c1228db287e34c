#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/editor_options.h"
#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/base/text/listed.h"
#include "core/mesh/formats/formats.h"

namespace homolog {

using Json = nlohmann::ordered_json;

/// The report of a verb: the JSON object of docs/commands.md, which `--json` prints as it is and which is otherwise
/// printed as lines, and sentences for `homolog: warning: …`.
struct Report {
  Json values = Json::object();
  std::vector<std::string> warnings;
  std::vector<std::filesystem::path> made{};  ///< files that still have to get the record of the command [record.h]
  std::optional<Error> refusal{};  ///< why what was reported is no success: printed after it, with exit status 1
};

/// The work of a verb.
using VerbRun = std::function<Result<Report>(Progress&)>;

/// The requests of the command line.
struct CommandLine {
  VerbRun run;             ///< the work of the verb that was given; empty where the editor is to be opened
  EditorOptions editor;    ///< the editor's options
  bool is_of_lab = false;  ///< a verb of the laboratory was given [lab_verbs.h]
};

/// Adds a verb that reports: run_program reads its `--json`, `--quiet` and `--jobs`.
inline CLI::App* add_verb(CLI::App& app, const char* name, const char* description) {
  CLI::App* verb = app.add_subcommand(name, description);
  verb->add_flag("--json")->description("Print one JSON object on stdout and nothing else there");
  verb->add_flag("--quiet")->description("Print nothing but warnings, errors and what --json asks for");
  verb->add_option("--jobs", "How many threads to use at most; results do not depend on it")
      ->check(CLI::Range(1, 1024));
  return verb;
}

/// Refuses an option that was given where it does nothing. `why`: what it is for.
inline void refuse_without_effect(const CLI::App& verb, const char* option, const char* why) {
  if (verb.count(option) > 0) throw CLI::ValidationError(option, std::string("has no effect here: it is for ") + why);
}

/// A folder, whether it is there already or not: it has no ending, or a slash behind it.
inline bool is_folder_name(const std::filesystem::path& path) {
  std::error_code ignored;
  return !path.has_filename() || !path.has_extension() || std::filesystem::is_directory(path, ignored);
}

/// Refuses a name under which a mesh would lose its correspondence: STL keeps no vertices, and other endings are of no
/// mesh at all. `or_folder`: a folder is taken too.
inline CLI::Option* keeps_correspondence(CLI::Option* output, bool or_folder = false) {
  return output->check([or_folder](const std::string& text) -> std::string {
    const std::filesystem::path path = text;
    if (text.empty() || keeps_numbers(path) || (or_folder && is_folder_name(path))) return {};
    const std::string use = "use " + listed(mesh_format_extensions(&MeshFormat::keeps_numbers), " or ") +
                            (or_folder ? ", or a folder" : "");
    if (is_mesh_name(path))
      return text + " would keep no vertices and so no correspondence (convert makes STL of a mesh); " + use;
    return text + (path.has_extension() ? " has an ending of no mesh format; " : " has no ending; ") + use +
           (or_folder ? " (with a / behind a name that has a dot)" : "");
  });
}

}  // namespace homolog
