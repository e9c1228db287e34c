#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "app/editor/state/files/file_browser.h"
#include "app/editor/state/open_request.h"
#include "app/editor/state/view_geometry.h"
#include "core/volume/labels/segmentation.h"
#include "core/volume/volume_io.h"

namespace homolog {

/// The content of a study's picture, in a grid: its shapes, or the model's modes.
enum class StudyPicture { gallery, modes };

/// Which part of the window a picture shows, and how large it is.
struct PictureOptions {
  std::optional<ViewKind> view;  ///< the whole window, as it is on the screen, where none
  int width = 1600, height = 1200;
  bool transparent = false;           ///< clear where nothing is drawn; of a view
  bool light = false;                 ///< a light ground; of a view
  bool captions = true;               ///< letters, scale bar, names; of a view
  std::optional<StudyPicture> study;  ///< a picture of the study, in place of a view
};

// The dialogs that cover the window; one at a time.

struct KeysDialog {};

/// The purpose that a file is wanted for. Each has a row in app/editor/update/file_purposes.cpp.
enum class FilePurpose {
  open,
  open_template,
  open_labels,
  open_landmarks,
  open_contours,
  open_stiffness,
  open_template_landmarks,
  open_model,
  open_score_model,
  open_recipe,
  open_set,
  open_study,
  open_study_template,
  add_shapes,
  add_scans,
  save_case,
  export_mesh,
  export_label_map,
  export_structures_map,
  export_mended_map,
  export_mended_masks,
  export_structures_meshes,
  export_landmarks,
  export_template,
  export_template_landmarks,
  use_made_template,
  make_study_template,
  export_picture,
  export_volumes,
  export_measurements,
  new_study,
  save_study,
  export_model,
  export_measures,
  export_plots,
  export_report,
  export_sizes,
  export_landmark_table,
  open_observer,
  export_observers,
  export_shapes
};
struct FileDialog {
  FilePurpose purpose = FilePurpose::open;
  FileBrowser browser;
};
/// A file of that name is there already.
struct ReplaceDialog {
  FileDialog files;  ///< the dialog to go back to
  std::filesystem::path path;
  std::filesystem::path there;  ///< the first file that is there of those to be written under that name
};
/// Several series in a DICOM folder: one is chosen.
struct SeriesDialog {
  OpenRequest request;
  std::vector<SeriesInfo> series;
};
/// A template whose own coordinates lie beside the volume, and in it with left-right and front-back exchanged.
struct FlipDialog {
  std::string name;
  Similarity placement;  ///< the placement then
  Box bounds_mm;         ///< the template's box there
};
/// Cases that were never saved.
struct RecoverDialog {
  struct Found {
    std::filesystem::path journal;
    std::string name;     ///< "ct.nii.gz"
    std::string details;  ///< "12 edits, 14 March 2026, 16:02"
  };
  std::vector<Found> found;
  std::filesystem::path to_discard;  ///< the one whose deletion waits for a second word
};
/// The window is closed over a case that was never saved, or over a study whose file could not be written.
struct QuitDialog {
  std::filesystem::path study;  ///< the study's file; empty: the case is asked about
};
/// The stack's voxel size, which PNG and TIFF do not tell.
struct SpacingDialog {
  OpenRequest request;
  Vec3 spacing_mm = Vec3::Ones();
};

/// The slices of a DICOM series are no even stack.
struct ResampleDialog {
  OpenRequest request;
  std::string why;  ///< "slices that are shifted sideways …"
};

/// Label maps hold several labels: one is chosen for all cases that wait, or for their template.
struct LabelDialog {
  std::string map;  ///< name of the first such file
  std::vector<Segment> labels;
  std::filesystem::path template_file;  ///< the file that the template goes to; empty: cases are to be fitted
};

using Dialog = std::variant<KeysDialog, FileDialog, ReplaceDialog, SeriesDialog, FlipDialog, RecoverDialog, QuitDialog,
                            SpacingDialog, ResampleDialog, LabelDialog>;

}  // namespace homolog
