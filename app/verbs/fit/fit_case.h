#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/verbs/case_landmarks.h"
#include "app/verbs/fit/snap_arguments.h"
#include "app/verbs/read_image.h"
#include "app/verbs/record.h"
#include "app/verbs/verb.h"
#include "core/adapt/judge_fit.h"
#include "core/adapt/labels/label_fit.h"
#include "core/model/shapes/study.h"
#include "core/volume/volume_io.h"

namespace homolog {

/// The job that the verb `fit` is asked for.
struct FitJob {
  std::string template_source, orientation = "patient", parts;  ///< parts: empty where nobody said
  std::vector<std::filesystem::path> masks, meshes;
  std::filesystem::path image, out, placement, landmarks, model;
  std::vector<std::filesystem::path> contours;
  std::string structure;  ///< the contours' structure
  double off_mm = 0;      ///< how far contours may lie off the boundary
  bool outside = false;   ///< contours only lie outside of the organ
  double beyond = 1;
  SnapArguments snap;        ///< the snap to an image
  std::optional<int> frame;  ///< the label map's frame, as asked
  std::string label;
  std::optional<double> level;  ///< a soft mask's level
  std::optional<double> closing_mm;
  bool resample = false;  ///< the image's slices, where they are no even stack
  bool mirror = false, partial = false;
  bool of_folder = false;  ///< cases were named by their folder

  int by_others = 0;  ///< third subjects
  double gap_mm = 0;  ///< the gap between neighbours of a set

  GivenCommand command;  ///< the command, for the records of its files

  bool to_meshes() const { return !meshes.empty(); }
  const std::vector<std::filesystem::path>& cases() const { return to_meshes() ? meshes : masks; }
  /// By how many third subjects each case is fitted too. None unless asked for: a case's files do not hang on what
  /// else is fitted.
  std::size_t ways_by_others() const {
    return cases().empty() ? 0 : std::min(cases().size() - 1, static_cast<std::size_t>(by_others));
  }
  LandmarkFiles landmark_files() const { return {landmarks, template_source, cases().size() > 1 || of_folder}; }
};

/// The record of a case's files: of the command that makes them alone, whatever else is fitted in the same run. With
/// --by-others the other cases count too, and each is one file of a folder. Errors: record_of's.
Result<std::string> record_of_fit(const FitJob& options, const std::filesystem::path& path, Progress& progress);

/// Data that all cases of a run share, read once.
struct FitShared {
  std::shared_ptr<const Template> the_template;
  std::shared_ptr<const Template> template_of_file;  ///< the same, not mirrored
  FitOptions fit;
  std::optional<double> kept_closing_mm;  ///< the closing kept with the template
};

/// Reads the template, the placement and the model. Errors: theirs.
Result<FitShared> shared_of_fits(const FitJob& options);

using FitClock = std::chrono::steady_clock;

/// One case's target: a boundary, which is made of the mask where there is one.
struct FitTarget {
  FitClock::time_point started = FitClock::now();  ///< once the file was read
  Boundary boundary;
  std::optional<MaskRead> mask;

  MapLabel label() const { return {mask->volume, mask->label, mask->frame, mask->segmentation}; }
};

/// The verb's report of a fit, without the closing radius and without warnings.
Report report_of_fit(const FitTarget& target, const Template& the_template, const FitResult& fit,
                     const FitJudgement& judgement, bool partial, double seconds);

/// The closing radius for the report.
Json described_closing(const LabelFit& fitted, const LabelFitOptions& how);

/// The target that was fitted to a case.
struct FittedTarget {
  FitResult fit;
  FitJudgement judgement;
  Json closing;                       ///< the closing's part of the report
  std::vector<std::string> warnings;  ///< warnings of its landmarks
  double seconds = 0;
};

/// A case among others: what is kept of its fit, or the fit that was kept, whose doubt now takes in the others.
struct AmongCases {
  std::optional<FittedTarget>* keep = nullptr;
  const FittedTarget* again = nullptr;
  std::vector<const Points*> others;   ///< third subjects [spread_by_others_mm2]
  VertexScalars* off_share = nullptr;  ///< gets how far the fit is off by vertex [off_at_same_place]
  StudyCase* of_study = nullptr;       ///< gets a case for the study of a cohort; null: none is written
};

/// Fits to one label map or surface, writes the mesh to `out` and reports it. Errors: the readers', the fit's, the
/// writer's.
Result<Report> fit_case(const FitJob& options, const FitShared& shared, const std::filesystem::path& path,
                        const std::filesystem::path& out, Progress& progress, const AmongCases& among = {});

/// How far vertices and landmarks of a fit may lie from where they belong, for the report.
Json described_doubt(const Template& the_template, const FitResult& fit);

/// Says in a report of a fit to an image what was done to read it, and which frame was taken.
void report_image(const FitJob& options, const VolumeRead& image, Report& report);

/// The template's file with the fitted shape; `partial`: with the outliers marked.
MeshFile fitted_file(const Template& the_template, const FitResult& fit, bool partial);

}  // namespace homolog
