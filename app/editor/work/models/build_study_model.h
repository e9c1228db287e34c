#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "app/editor/state/models/study_model.h"
#include "core/base/processes/progress.h"
#include "core/model/training_set.h"

namespace homolog {

/// How much of the variance of a study's shapes the modes of its model hold.
inline constexpr double share_of_variance = 0.95;

struct StudyModelRequest {
  std::vector<StudyCase> cases;
  std::filesystem::path template_file;  ///< gives shapes of points alone their faces; may be empty
  Alignment alignment = Alignment::similarity;
  ReadFiles known;
  /// The case on the screen, as it is now, for the study's case of that file; null without one.
  std::shared_ptr<const Document> open_document;
  std::filesystem::path open_file;
};

struct StudyModelBuilt {
  std::shared_ptr<const StudyModel> model;                        ///< null where there is none
  std::map<std::string, std::shared_ptr<const MeshFile>> shapes;  ///< the shape of every case that has one, as it lies
  std::map<std::string, ShapeSizes> sizes;  ///< sizes of every such case whose faces are a surface
  std::vector<std::string> mirrored;        ///< cases that are mirror images of most others
  std::vector<std::string> refusals;        ///< a sentence for each case that is left out
  std::vector<std::string> warnings;
  std::string error;  ///< why there is no model
  ReadFiles known;
};

/// Reads what is not known yet and builds the model. A case that cannot be read, has no mesh yet, or is not in
/// correspondence with the rest is left out and said so.
StudyModelBuilt build_study_model(const StudyModelRequest& request, Progress& progress);

/// The model of shapes in correspondence, each of one of `groups`; `doubts`: what the study says of each, or none.
/// Errors: they differ by pose alone; cancelled.
Result<std::shared_ptr<const StudyModel>> make_study_model(TrainingSet set, std::vector<std::string> groups,
                                                           Alignment alignment, const Progress& progress,
                                                           std::vector<std::string> doubts = {});

/// Why a person has to look at meshes, of those that were asked for before [doubt_of_shape].
using KnownDoubts = std::map<std::shared_ptr<const MeshFile>, std::string>;
/// Finds what is suspicious in a model whose shapes were read as `meshes`, one for each; null where it is not known.
/// `known` becomes what is known of these. Errors: cancelled.
Result<Suspicions> find_suspicions(const StudyModel& model, const std::vector<std::shared_ptr<const MeshFile>>& meshes,
                                   KnownDoubts& known, Progress& progress);

}  // namespace homolog
