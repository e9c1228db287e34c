#pragma once

#include <span>

#include "app/verbs/verbs.h"

namespace homolog {

/// What a program of this project does.
struct Program {
  const char* description;
  std::span<AddVerb* const> verbs;               ///< in the order in which `--help` lists them
  int (*edits)(const EditorOptions&) = nullptr;  ///< without a verb; null: a verb is needed
};

/// The whole of main(): reads the command line, does what it asks for and says what went wrong. Gives the exit status.
int run_program(int argc, char** argv, const Program& program);

}  // namespace homolog
