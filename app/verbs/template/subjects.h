#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/verbs/verb.h"
#include "core/groupwise/template_bias.h"
#include "core/template/template.h"

namespace homolog {

/// Organs to make a template of or to study: surfaces, or label maps.
struct SubjectFiles {
  std::vector<std::filesystem::path> files;  ///< see subject_paths
  std::filesystem::path landmarks;           ///< a folder with a file for each [landmark_file_in]; empty: none
  std::string label;                         ///< the label of label maps: see read_mask
  std::optional<int> frame;                  ///< the frame of label maps with several: see read_mask
  std::optional<double> level;               ///< the level of soft masks: see read_mask
  std::optional<double> closing_mm;          ///< see label_boundary
  std::optional<FacedNames> faced;           ///< the part of the label's surface to take, of label maps
  int vertices = 2500;
  bool flip_mirrored = false;
};

struct SubjectsRead {
  std::vector<BiasSubject> subjects;         ///< by name
  std::vector<std::filesystem::path> paths;  ///< the path of each subject's file
  std::vector<std::string> flipped;
  std::map<std::string, int> frames;  ///< which was taken, of each whose label map holds several
  std::vector<std::string> warnings;

  /// Says in a report which frames were taken.
  void report_frames(Json& values) const {
    if (!frames.empty()) values["frames"] = frames;
  }
};

/// The files in the order of their subjects' names; a folder stands for the surfaces in it, else for its label maps.
std::vector<std::filesystem::path> subject_paths(const std::vector<std::filesystem::path>& files);

/// Reads all, several at a time, in the order of their names. With `flip_mirrored` those that look like mirror images
/// of most others are flipped with their landmarks; without it, warnings name them. Errors: a file that cannot be read,
/// two of one name, a folder without surfaces, labels or a closing for surfaces only, cancelled.
Result<SubjectsRead> read_subjects(const SubjectFiles& files, Progress& progress);

}  // namespace homolog
