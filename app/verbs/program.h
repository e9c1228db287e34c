#pragma once

#include <span>
#include <string>
#include <vector>

#include "app/verbs/verbs.h"

namespace homolog {

/// A program of this project.
struct Program {
  const char* description;
  std::span<AddVerb* const> verbs;               ///< in the order in which `--help` lists them
  int (*edits)(const EditorOptions&) = nullptr;  ///< without a verb; null: a verb is needed
};

/// The whole of main(): reads the command line, does what it asks for and says what went wrong. Gives the exit status.
int run_program(int argc, char** argv, const Program& program);

/// Does a verb in the process of another program, which shows its progress and cancels it: `arguments` are those of the
/// command line without "homolog"; --jobs, --json and --quiet have no effect. Errors: `wrong_command_line` (becomes
/// true), with whose --help says more; a verb that opens a window; the verb's.
Result<Report> run_verb_here(const std::vector<std::string>& arguments, Progress& progress, bool& wrong_command_line);

}  // namespace homolog
