#include "app/verbs/fit/fit_contours.h"

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "app/verbs/read_image.h"
#include "core/adapt/contours/contour_fit.h"
#include "core/adapt/image/fit_to_image.h"
#include "core/adapt/labels/label_fit.h"
#include "core/base/text/listed.h"
#include "core/base/text/text.h"
#include "core/case/action_json.h"
#include "core/deform/fold_guard.h"
#include "core/mesh/files/curve_io.h"
#include "core/mesh/files/mesh_frame.h"
#include "core/mesh/mesh_quality.h"
#include "core/placement/similarity_fit.h"
#include "core/volume/dicom/dicom_series.h"
#include "core/volume/referenced_images.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// The structure of a file that is meant.
Result<const ContourRoi*> structure_of(const fs::path& path, const Contours& read, const std::string& asked) {
  if (asked.empty() && read.rois.size() > 1) {
    std::vector<std::string> names;
    for (const ContourRoi& roi : read.rois)
      names.push_back(std::to_string(roi.number) + " (" + excerpt(roi.name) + ")");
    return fail(path.string(), "holds the structures " + listed(names, " and ") + "; name one by --structure");
  }
  if (asked.empty()) return &read.rois.front();
  auto roi = roi_of(read, asked);
  if (!roi) return fail(path.string(), roi.error().what);
  return roi;
}

/// What a fit to contours is made of.
struct ContourFitInput {
  const FitJob& options;
  const FitShared& shared;
  const FitOptions& fitting;
  const DrawnOrgan& organ;
  const MaskRead* mask;     ///< null: there is none
  const VolumeRead* image;  ///< null: there is none
};

/// Goes on from a fit to contours to the boundary that an image shows; the contours stay where they are, and so do the
/// landmarks that the fit believed.
Result<void> snap_between(const ContourFitInput& input, FitResult& fit, Report& report, Progress& progress) {
  const FitJob& options = input.options;
  const Template& the_template = *input.shared.the_template;
  auto snapping = snap_options(options.snap, the_template.points.rows(), progress);
  if (!snapping) return fail(snapping.error());
  snapping->progress = &progress;
  SnapStart start{fit.mesh, fit.mesh.points, the_template.stiffness, VertexScalars::Ones(fit.mesh.points.rows())};
  start.pins = contour_pins(input.organ.contours, fit.mesh);
  std::map<std::string, Vec3> believed;
  for (const std::string& name : fit.believed) believed.emplace(name, input.fitting.landmarks.at(name));
  const auto held = landmark_pins(the_template, fit.mesh.points, believed, options.snap.reach_mm);
  start.pins.insert(start.pins.end(), held.begin(), held.end());
  const auto snapped = snap(input.image->volume, options.snap.frame, start, *snapping);
  if (!snapped) return fail(options.image.string(), snapped.error().what);
  fit.mesh.points = snapped->points;
  fit.unseen = snapped->unseen;
  fit.turned_triangles =
      turned_triangles(*the_template.topology, fit.placement.apply(the_template.points), fit.mesh.points).size();
  report = snap_report(*snapped, fit.mesh, start.placed, options.image);
  return {};
}

/// The fit to what is there: contours alone, with a label map, or with an image.
Result<FitResult> fit_to_all(const ContourFitInput& input, Report& report, Progress& progress) {
  const auto& [options, shared, fitting, organ, mask, image] = input;
  const Template& the_template = *shared.the_template;
  if (mask != nullptr) {
    const MapLabel target{mask->volume, mask->label, mask->frame, mask->segmentation};
    const LabelFitOptions how{
        .closing_mm = options.closing_mm, .kept_closing_mm = shared.kept_closing_mm, .largest_part = true};
    const auto boundary = boundary_to_fit(the_template, target, how, first_closing_mm(target, how), fitting);
    if (!boundary) return fail(options.masks.front().string(), mask->named(boundary.error().what));
    auto fit = fit_to_contours_and_boundary(the_template, organ.contours, *boundary, fitting);
    if (!fit) return fail(options.masks.front().string(), fit.error().what);
    fit->warnings = mask->named(std::move(fit->warnings));
    report.warnings = mask->warnings;
    return fit;
  }
  auto fit = fit_to_contours(the_template, organ.contours, fitting);
  if (!fit) return fail(options.contours.front().string(), fit.error().what);
  if (image == nullptr) return fit;
  if (auto done = snap_between(input, *fit, report, progress); !done) return fail(done.error());
  return fit;
}

/// Whether all curves lie in one plane, so that nothing says how far the organ goes on beside it.
bool in_one_plane(const std::vector<DrawnContour>& contours) {
  constexpr std::size_t few = 8;  // planes are asked for alone
  const ContourSamples cut = sampled_contours(contours, few * contours.size());
  return cut.planes.size() == 1 && std::ranges::none_of(cut.samples, [](const auto& one) { return one.plane < 0; });
}

}  // namespace

void describe_contour_fit(const DrawnOrgan& organ, const Template& the_template, const FitResult& fit, double seconds,
                          const fs::path& path, bool alone, Report& report) {
  constexpr double off_share = 0.01, doubt_share = 0.06;
  const ContourDistance off = contour_distance(organ.contours, fit.mesh);
  const double diagonal_mm = bounds_of(fit.mesh.points).diagonal().norm();
  const bool off_contours = off.mean_mm > off_share * diagonal_mm,
             in_doubt = fit.doubt_mm.mean() > doubt_share * std::sqrt(surface_area_mm2(fit.mesh)) ||
                        (alone && in_one_plane(organ.contours)),
             before = report.values.value("doubtful", false);
  if (off_contours) {
    char text[160];
    std::snprintf(text, sizeof text,
                  ": the mesh lies off the contours by %.1f mm on average; check that they are of the template's organ",
                  off.mean_mm);
    report.warnings.push_back(path.string() + text);
  }
  if (in_doubt)
    report.warnings.push_back(path.string() +
                              ": the contours say too little of where the organ lies between them; "
                              "draw more of them");
  for (const std::string& warning : organ.warnings) report.warnings.push_back(warning);
  for (const std::string& warning : fit.warnings) report.warnings.push_back(path.string() + ": " + warning);
  report.values.update(
      Json{{"contours_mm", {{"mean", off.mean_mm}, {"p95", off.p95_mm}}},
           {"contours", organ.contours.size()},
           {"structures", organ.structures},
           {"turned_triangles", fit.turned_triangles},
           {"self_intersections", self_intersections(fit.mesh).size()},
           {"doubtful", before || off_contours || in_doubt},
           {"landmarks_used", fit.landmarks_used},
           {"landmarks_place", fit.landmarks_place},
           {"placement", to_json(nearest_similarity(the_template.points, fit.mesh.points, fit.placement))},
           {"seconds", seconds}});
  report.values["doubt_mm"] = described_doubt(the_template, fit);
}

Result<DrawnOrgan> read_organ(const FitJob& options, const fs::path& scan_path, const Volume* scan) {
  DrawnOrgan organ;
  std::string space;
  fs::path of_space;
  for (const fs::path& path : options.contours) {
    const auto read = read_curves(path);
    if (!read) return fail(read.error());
    const std::string& own = read->frame_of_reference;
    if (!space.empty() && !own.empty() && own != space)
      return fail(path.string(), "was drawn on another scan than " + of_space.string() + " (frames of reference " +
                                     excerpt(own) + " and " + excerpt(space) +
                                     "); fit to the contours of one scan at a time");
    if (space.empty()) {
      space = own;
      of_space = path;
    }
    if (scan != nullptr) {
      auto other = check_scan(path, read->frame_of_reference, read->referenced, scan_path, *scan);
      if (!other) return fail(other.error());
      if (*other) organ.warnings.push_back(std::move(**other));
    }
    const auto roi = structure_of(path, *read, options.structure);
    if (!roi) return fail(roi.error());
    if ((*roi)->contours.empty())
      return fail(path.string(), "has no contours in its structure " + std::to_string((*roi)->number) + " (" +
                                     excerpt((*roi)->name) + "); draw it, or name another by --structure");
    organ.structures.push_back((*roi)->name);
    // Doubts about the structures that are not meant are left out.
    const auto of_all = doubts_about(path, read->rois);
    for (const std::string& warning : read->warnings)
      if (std::find(of_all.begin(), of_all.end(), warning) == of_all.end()) organ.warnings.push_back(warning);
    for (const std::string& doubt : doubts_about(path, {**roi})) organ.warnings.push_back(doubt);
    for (const Contour& curve : (*roi)->contours)
      organ.contours.push_back({.curve = curve, .off_mm = options.off_mm, .outside = options.outside});
  }
  if (scan != nullptr && std::none_of(organ.contours.begin(), organ.contours.end(), [&](const DrawnContour& one) {
        return std::any_of(one.curve.points.begin(), one.curve.points.end(),
                           [&](const Vec3& p) { return scan->geometry.holds(p); });
      }))
    return fail(options.contours.front().string(),
                "lies outside of " + scan_path.string() + "; give the scan that it was drawn on");
  return organ;
}

Result<Report> fit_contours(const FitJob& options, const FitShared& shared, Progress& progress) {
  std::optional<MaskRead> mask;
  std::optional<VolumeRead> image;
  if (!options.masks.empty()) {
    auto read = read_mask(options.masks.front(), options.label,
                          {options.frame, {}, options.level, false, shared.the_template->faced.has_value()}, progress);
    if (!read) return fail(read.error());
    mask = std::move(*read);
  }
  if (!options.image.empty()) {
    auto read = read_image(options.image, options.snap.frame, progress, options.resample,
                           images_made_on(options.contours.front()));
    if (!read) return fail(read.error());
    image = std::move(*read);
  }
  const auto organ = read_organ(options, mask ? options.masks.front() : options.image,
                                mask    ? &mask->volume
                                : image ? &image->volume
                                        : nullptr);
  if (!organ) return fail(organ.error());
  auto landmarks = read_case_landmarks(options.landmark_files(), *shared.the_template, options.contours.front());
  if (!landmarks) return fail(landmarks.error());
  const auto started = std::chrono::steady_clock::now();
  FitOptions fitting = shared.fit;
  fitting.landmarks = std::move(landmarks->places);
  fitting.progress = &progress;
  Report report;
  auto fit = fit_to_all({.options = options,
                         .shared = shared,
                         .fitting = fitting,
                         .organ = *organ,
                         .mask = mask ? &*mask : nullptr,
                         .image = image ? &*image : nullptr},
                        report, progress);
  if (!fit) return fail(fit.error());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  MeshFile file = fitted_file(*shared.the_template, *fit, false);
  file.landmarks = carried_landmarks(*shared.the_template, fit->mesh.points);
  if (mask && mask->volume.frames > 1) note_frame(file, mask->frame);
  if (image && image->volume.frames > 1) note_frame(file, options.snap.frame);
  auto record = record_of(options.command, progress);
  if (!record) return fail(record.error());
  file.record = std::move(*record);
  if (auto written = write_mesh_file(file, options.out); !written) return fail(written.error());
  describe_contour_fit(*organ, *shared.the_template, *fit, seconds, options.contours.front(), !mask && !image, report);
  report.warnings.insert(report.warnings.begin(), landmarks->warnings.begin(), landmarks->warnings.end());
  if (image) report_image(options, *image, report);
  return report;
}

}  // namespace homolog
