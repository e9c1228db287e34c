#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/adapt/image/appearance.h"
#include "core/adapt/image/edge_search.h"
#include "core/template_making/faced_part.h"
#include "core/template_making/mask_template.h"
#include "core/template_making/tube_template.h"
#include "core/volume/contours.h"

namespace homolog {

// The panels' settings of the automatic steps.

/// Which shape model a fit keeps to at first.
enum class FitModel { none, study, file };

/// The panel's settings of a fit.
struct FitSettings {
  int label = 0;                     ///< 0: the label map's first
  bool all_labels = false;           ///< all labels together, in place of `label`
  std::optional<double> closing_mm;  ///< radius: narrower clefts are filled; without: ball_share of the label's size
  bool as_placed = false;            ///< starts where the template is; else its place is found
  bool partial = false;              ///< the scan cuts the organ, or parts of it are missing: FitOptions::partial
  FitModel model = FitModel::none;
  double beyond = 1;  ///< 0…1: how far the fit leaves the model's shape for the label
};

/// The settings of a template to be made, as the panel holds them.
struct TemplateSettings {
  int label = 0;                    ///< 0: the label map's first
  bool all_labels = false;          ///< all labels together, in place of `label`
  bool tube = false, part = false;  ///< neither: the whole surface of an organ
  FacedLabels faced;                ///< the labels that a part faces
  MaskTemplateOptions mask;
  TubeTemplateOptions tube_options;
  int outer_label = 0;  ///< 0: one sheet
  bool axis_by_ruler = false;
};

/// How a snap looks for the boundary.
struct SnapSettings {
  double strength = 1, reach_mm = 10;
  Polarity polarity = Polarity::automatic;
  bool with_strokes = false;  ///< the part under the tool is snapped while a stroke is dragged
  bool show_confidence = true;
  bool learn = false;                         ///< learns from the study's cases that are done
  std::shared_ptr<const Appearance> learned;  ///< the look that was learned; null where none was
};

/// The source that says where the boundary lies between contours.
enum class BetweenCurves { shape, image, label };

/// The structures of a file of contours, to choose from; none where no file is open.
struct OfferedContours {
  std::string file;                      ///< its name
  std::shared_ptr<const Contours> read;  ///< null: none
};

}  // namespace homolog
