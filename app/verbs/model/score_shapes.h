#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/mesh/formats/formats.h"
#include "core/model/shape_model.h"

namespace homolog {

/// The shapes to score against a model, as they were asked for.
struct NewShapes {
  std::vector<std::filesystem::path> files;
  std::filesystem::path model;
  std::filesystem::path landmarks;  ///< in the images that the files are: one's, or a folder with one of each name
  std::filesystem::path the_template;
  std::string label;
  std::optional<int> frame;
  bool flip_mirrored = false;
};

/// A shape to score, in the model's numbering.
struct NewShape {
  std::string name;  ///< the file's
  MeshFile mesh;
  std::string doubt;        ///< why the fit is in doubt; empty: it is not, or it was none
  std::size_t from = 0;     ///< which of the files that were named
  double beyond_share = 0;  ///< of a fit: the share of its area beyond the scan's borders, where it follows the model
};

/// The same with folders of label maps opened; folders with shapes stay.
NewShapes with_maps_opened(NewShapes asked);

/// All shapes, in the order in which they were named: a label map as `fit --model` fits the model's mean to it, an
/// image as `fit --image --landmarks --model` does, a mesh or a case as it is. A shape that cannot be read becomes a
/// warning, and so does what looks wrong beside the model's mean. Errors: a model that nothing can be fitted with;
/// cancelled.
Result<std::vector<NewShape>> read_new_shapes(const NewShapes& asked, const ShapeModel& model,
                                              std::vector<std::string>& warnings, Progress& progress);

}  // namespace homolog
