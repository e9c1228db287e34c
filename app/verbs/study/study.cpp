#include "app/verbs/lab_verbs.h"
#include "app/verbs/study/study_make.h"
#include "app/verbs/verbs.h"

namespace homolog {

void add_study(CLI::App& app, CommandLine& asked) {
  CLI::App* study = app.add_subcommand(
      "study", "Makes a study of many cases. Experiments: a scripted user, templates, experts' landmarks");
  study->require_subcommand(1);
  add_study_make(*study, asked);
  for (const LabVerb& verb : {lab_user, lab_schemes, lab_bias, lab_contours, lab_experts})
    add_lab_verb(*study, verb, asked);
}

}  // namespace homolog
