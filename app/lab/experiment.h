#pragma once

#include <filesystem>
#include <optional>

#include "app/lab/schemes.h"
#include "app/verbs/lab_verbs.h"
#include "app/verbs/verb.h"
#include "core/case/document.h"

// Things that the experiments share.

namespace homolog {

/// Which label of a mask is the target, and how it is worked on.
struct TargetOptions {
  std::string label;                 ///< none: the only one
  std::optional<int> frame;          ///< the frame of a label map with several; none: the first
  std::optional<double> closing_mm;  ///< as in `fit`
};
void add_target_options(CLI::App& verb, TargetOptions& options);

/// A label map as the organ to adapt `the_template` to, without landmarks. `warnings`: the reader's. Errors: the
/// reader's, the label's.
Result<ExperimentSubject> mask_subject(const std::filesystem::path& path, const TargetOptions& options,
                                       const Template& the_template, std::vector<std::string>& warnings,
                                       Progress& progress);

/// The figures of a run by name, lengths in mm; null where there is none.
Json json_of(const SchemeRun& run);

void add_lab_bench(CLI::App& app, CommandLine& asked);
void add_lab_corrupt(CLI::App& app, CommandLine& asked);
void add_lab_repairs(CLI::App& app, CommandLine& asked);
void add_study_user(CLI::App& study, CommandLine& asked);
void add_study_schemes(CLI::App& study, CommandLine& asked);
void add_study_bias(CLI::App& study, CommandLine& asked);
void add_study_contours(CLI::App& study, CommandLine& asked);
void add_study_experts(CLI::App& study, CommandLine& asked);

}  // namespace homolog
