#include <array>

#include "app/lab/experiment.h"
#include "app/verbs/program.h"

namespace {

using namespace homolog;

void add_experiments(CLI::App& app, CommandLine& asked) {
  CLI::App* study = app.add_subcommand("study", "Experiments: a scripted user, templates, experts' landmarks");
  study->require_subcommand(1);
  add_study_user(*study, asked);
  add_study_schemes(*study, asked);
  add_study_bias(*study, asked);
  add_study_contours(*study, asked);
  add_study_experts(*study, asked);
}

constexpr std::array<AddVerb*, 4> lab_verbs{add_experiments, add_lab_bench, add_lab_corrupt, add_lab_repairs};

}  // namespace

int main(int argc, char** argv) {
  return run_program(argc, argv, {"The laboratory of Homolog: experiments and speed. `homolog` calls it.", lab_verbs});
}
