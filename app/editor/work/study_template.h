#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "app/editor/state/settings.h"
#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/model/shapes/study.h"
#include "core/volume/labels/segmentation.h"

namespace homolog {

/// The outcome of making the template of a study's label maps.
struct StudyTemplate {
  std::filesystem::path file;  ///< the file that was written; empty: a label has to be chosen first
  std::size_t subjects = 0;
  std::size_t begun = 0;           ///< cases that wait and begin with it now
  std::vector<std::string> stays;  ///< names of waiting cases that somebody worked on: they keep their template
  std::string map;                 ///< the map of which a label has to be chosen; empty: none has
  std::vector<Segment> labels;     ///< labels that this map holds
  std::vector<std::string> warnings;
};

/// Makes a consensus template of the label maps of a study's cases, writes it, and begins the cases that wait anew with
/// it. The closing radius is tried on three of the maps. Errors: fewer than two label maps; a map that cannot be read;
/// `file` is there already; no sound template comes of them; the file cannot be written; cancelled.
Result<StudyTemplate> make_study_template(const std::vector<StudyCase>& cases, const FitSettings& settings,
                                          const std::filesystem::path& file, Progress& progress);

}  // namespace homolog
