#pragma once

#include <array>

#include "app/verbs/verb.h"

// The experiments and the figures of speed are a program of their own, homolog-lab [app/lab], which lies beside this
// one.

namespace homolog {

/// A verb of the laboratory, as both programs call it.
struct LabVerb {
  const char* name;
  const char* description;
};
inline constexpr LabVerb lab_user{"user", "A scripted user adapts a template to a label map and writes a case file"};
inline constexpr LabVerb lab_schemes{"schemes", "Compares ways of working: every scheme on every case, as tables"};
inline constexpr LabVerb lab_bias{"bias", "How much results depend on the subject that the template is made from"};
inline constexpr LabVerb lab_contours{"contours",
                                      "Fits to a few contours of label maps against shape-based interpolation"};
inline constexpr LabVerb lab_experts{"experts", "Fits, closest points and point drift against experts' landmarks"};
inline constexpr LabVerb lab_bench{"bench", "Times the solver, models, slices and pictures on this machine (medians)"};

/// Adds a verb that the laboratory does, whatever its options are.
void add_lab_verb(CLI::App& app, const LabVerb& verb, CommandLine& asked);
/// Goes on as the laboratory, with the same command line. Returns only where it is not there: the error says so.
Error become_lab(char** argv);

}  // namespace homolog
