#pragma once

#include <filesystem>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/phantom/phantom.h"

namespace homolog {

/// The folder of studies that were not given a place.
std::filesystem::path studies_folder();
/// Subjects of a phantom study as in the paper: 10 vertebrae, 16 kidneys, the 20 phases of one ventricle.
int phantom_shapes(Organ organ);
/// Writes the phantoms' true surfaces and their study into a folder, and gives the study's path; what is there already
/// is kept.
Result<std::filesystem::path> make_phantom_study(Organ organ, const std::filesystem::path& folder, Progress& progress);

}  // namespace homolog
