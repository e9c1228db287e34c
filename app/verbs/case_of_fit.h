#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "core/case/actions/history_marks.h"
#include "core/model/shapes/study.h"
#include "core/template/template.h"
#include "core/volume/volume.h"

namespace homolog {

/// A fitted shape, to be repaired on its scan.
struct FittedCase {
  std::string name;
  std::filesystem::path image, labels;               ///< the scan, and the label map over it; empty: none
  std::shared_ptr<const Volume> grid;                ///< the image's grid; no voxels are needed; null without one
  std::shared_ptr<const Template> template_of_file;  ///< as its file has it
  bool mirrored = false;                             ///< it was fitted as that of the other side
  Points points;                                     ///< n×3, mm
  std::optional<int> frame;                          ///< the frame of a cine to which the shape belongs
  std::optional<Similarity> placement;
  VertexScalars doubt_mm, outlier;  ///< empty: none
  std::string doubt;                ///< why a person has to look at it, as a sentence; empty: no doubt
  std::optional<FitFigures> figures;
  std::string record{};  ///< the record of how the case is made [record.h]
};

/// Writes NAME.homolog into a folder that is there, whose one edit is the fit, and gives its entry in a study. One that
/// somebody worked on stays as it is, with a warning. Errors: create_case's, another numbering than the
/// template's.
Result<StudyCase> write_case_of_fit(const FittedCase& fitted, const std::filesystem::path& folder,
                                    std::vector<std::string>& warnings);

/// The grid of a volume without its voxels.
std::shared_ptr<const Volume> grid_of(const Volume& volume);

}  // namespace homolog
