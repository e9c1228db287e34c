#pragma once

#include <string>
#include <vector>

#include "app/verbs/fit/fit_case.h"
#include "core/adapt/contours/contour_samples.h"

namespace homolog {

/// The drawn curves of an organ.
struct DrawnOrgan {
  std::vector<DrawnContour> contours;
  std::vector<std::string> structures, warnings;
};

/// Reads the contours of `options` and chooses the structure. `scan`: the volume (of `scan_path`) that is used with
/// them; null where there is none. Errors: the readers'; several structures and none named; a structure without
/// contours; contours of two scans, of another one than the image, or beside it.
Result<DrawnOrgan> read_organ(const FitJob& options, const std::filesystem::path& scan_path, const Volume* scan);

/// Says in a report what a fit to contours came to. `path`: what its warnings are about. `alone`: there was no label
/// map and no image beside the contours.
void describe_contour_fit(const DrawnOrgan& organ, const Template& the_template, const FitResult& fit, double seconds,
                          const std::filesystem::path& path, bool alone, Report& report);

/// Fits to contours that somebody drew, alone, or together with a label map or an image: these say where the boundary
/// lies between the contours. Writes the mesh and reports `contours_mm`. Errors: the readers'; several structures and
/// none named; a structure without contours; contours of another scan than the image; the fit's, the writer's.
Result<Report> fit_contours(const FitJob& options, const FitShared& shared, Progress& progress);

}  // namespace homolog
