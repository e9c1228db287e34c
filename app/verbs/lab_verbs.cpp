#include "app/verbs/lab_verbs.h"

#include "app/verbs/verbs.h"
#include "core/base/processes/process.h"

namespace homolog {

void add_lab_verb(CLI::App& app, const LabVerb& verb, CommandLine& asked) {
  CLI::App* added = app.add_subcommand(verb.name, verb.description);
  added->set_help_flag();
  added->prefix_command();
  added->callback([&asked] { asked.is_of_lab = true; });
}

Error become_lab(char** argv) {
  const std::filesystem::path lab = program_file().parent_path() / "homolog-lab";
  become_program(lab, argv);
  return {lab.string(), "is not beside this program, or cannot be run; install Homolog again"};
}

void add_bench(CLI::App& app, CommandLine& asked) {
  add_lab_verb(app, lab_bench, asked);
}

}  // namespace homolog
