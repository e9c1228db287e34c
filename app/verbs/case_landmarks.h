#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/template/template.h"

namespace homolog {

/// "case_1" of "folder/case_1.nii.gz": what a case is called in reports, and the files beside it.
std::string case_name_of(const std::filesystem::path& path);

/// The file with a case's landmarks in a folder, one of landmark_extensions; empty where there is none.
std::filesystem::path landmark_file_in(const std::filesystem::path& folder, const std::string& case_name);

/// The sources of a run's landmarks.
struct LandmarkFiles {
  std::filesystem::path given;  ///< one case's file, or a folder with a file of each case's name; empty: none
  std::string template_source;  ///< the template's name in messages
  bool several = false;         ///< cases: what is an error for one alone is a warning
};

/// The landmarks of a case, by the template's names, LPS mm.
struct CaseLandmarks {
  std::map<std::string, Vec3> places;
  std::vector<std::string> warnings;
};

/// Errors, where one case is fitted: no points, names that the template lacks, several points at one place. Among
/// several cases these are warnings. A file that cannot be read is always an error.
Result<CaseLandmarks> read_case_landmarks(const LandmarkFiles& files, const Template& the_template,
                                          const std::filesystem::path& path);

/// A warning that names files of the landmark folder that belong to no case: most often their names were written
/// differently. None where all belong to one.
std::vector<std::string> landmarks_of_no_case(const LandmarkFiles& files,
                                              const std::vector<std::filesystem::path>& cases);

}  // namespace homolog
