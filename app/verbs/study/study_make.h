#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/verbs/verb.h"
#include "core/model/shapes/study.h"

namespace homolog {

/// Adds `study make`.
void add_study_make(CLI::App& study, CommandLine& asked);

/// Writes a study of cases: those that it has already keep their groups, notes and what else is known of them. Gives
/// how many were new. `record`: of the command, which the study carries where it holds what these cases alone give, so
/// that the command makes it anew. Errors: read_study's, write_study's.
Result<std::size_t> write_cases_into(const std::filesystem::path& study_file, const std::filesystem::path& the_template,
                                     std::vector<StudyCase> cases, const std::string& record);

}  // namespace homolog
