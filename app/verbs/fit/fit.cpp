#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>

#include "app/verbs/case_landmarks.h"
#include "app/verbs/case_of_fit.h"
#include "app/verbs/describe.h"
#include "app/verbs/fit/fit_case.h"
#include "app/verbs/fit/fit_contours.h"
#include "app/verbs/fit/fit_many.h"
#include "app/verbs/fit/fit_sets.h"
#include "app/verbs/fit/snap_arguments.h"
#include "app/verbs/input_folders.h"
#include "app/verbs/read_image.h"
#include "app/verbs/verb.h"
#include "core/adapt/image/fit_to_image.h"
#include "core/adapt/judge_fit.h"
#include "core/adapt/labels/choose_closing.h"
#include "core/base/encoding/json.h"
#include "core/base/files/files.h"
#include "core/base/files/paths.h"
#include "core/base/numbers/statistics.h"
#include "core/case/action_json.h"
#include "core/case/placing.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/construction/mirror.h"
#include "core/mesh/files/mesh_frame.h"
#include "core/model/files/statismo.h"
#include "core/model/model_prior.h"
#include "core/model/shapes/doubtful_shapes.h"
#include "core/placement/similarity_fit.h"
#include "core/structures/built_in_set.h"
#include "core/template/template_warnings.h"

// The verb `fit`: a template to one label map or surface, to many [fit_many.h], or to the boundary that an image shows.

namespace homolog {

namespace fs = std::filesystem;

namespace {

Result<Report> fit_image(const FitJob& options, const FitShared& shared, Progress& progress) {
  const auto landmarks = read_case_landmarks(options.landmark_files(), *shared.the_template, options.image);
  if (!landmarks) return fail(landmarks.error());
  if (!shared.fit.placement && landmarks->places.empty())
    return fail(options.image.string(),
                "needs --placement, or --landmarks with at least three of the template's landmarks");
  const auto placement = shared.fit.placement ? Result<Similarity>(*shared.fit.placement)
                                              : placement_by_landmarks(*shared.the_template, landmarks->places);
  if (!placement) return fail(options.image.string(), placement.error().what);
  auto image = read_image(options.image, options.snap.frame, progress, options.resample);
  if (!image) return fail(image.error());
  const Template& the_template = *shared.the_template;
  auto snapping = snap_options(options.snap, the_template.points.rows(), progress);
  if (!snapping) return fail(snapping.error());
  snapping->progress = &progress;

  const auto started = FitClock::now();
  auto drawn = fit_to_image(the_template, image->volume, options.snap.frame, *placement, landmarks->places, *snapping,
                            shared.fit.allowed.get(), options.beyond);
  if (!drawn) return fail(options.image.string(), drawn.error().what);
  const double seconds = std::chrono::duration<double>(FitClock::now() - started).count();
  const Mesh& mesh = drawn->mesh;
  const SnapResult& snapped = drawn->snapped;
  FitResult fit;
  fit.mesh = mesh;
  fit.unseen = snapped.unseen;
  fit.landmarks = carried_landmarks(the_template, mesh.points);
  MeshFile file = fitted_file(the_template, fit, false);
  if (image->volume.frames > 1) note_frame(file, options.snap.frame);
  auto record = record_of(options.command, progress);
  if (!record) return fail(record.error());
  file.record = std::move(*record);
  if (auto written = write_mesh_file(file, options.out); !written) return fail(written.error());
  Report report = snap_report(snapped, mesh, drawn->placed, options.image);
  report.values["placement"] = to_json(nearest_similarity(the_template.points, mesh.points, *placement));
  report.values["landmarks_used"] = shared.fit.placement ? 0 : landmarks->places.size();
  if (shared.fit.allowed) {
    const VertexScalars beyond_mm = (mesh.points - drawn->placed).rowwise().norm();
    report.values["model"] = {{"beyond_mm", {{"mean", beyond_mm.mean()}, {"max", beyond_mm.maxCoeff()}}}};
  }
  report.values["seconds"] = seconds;
  if (const std::size_t far = landmarks->places.size() - drawn->held_landmarks; far > 0 && !shared.fit.placement)
    report.warnings.push_back(
        options.image.string() + ": " + std::to_string(far) + (far == 1 ? " landmark" : " landmarks") +
        " beyond --reach-mm of the placed template and not held; check " + (far == 1 ? "its place" : "their places"));
  report_image(options, *image, report);
  return report;
}

Result<Report> fit(const FitJob& options, Progress& progress) {
  if (names_set(options.template_source)) return fit_sets(options, progress);
  const auto shared = shared_of_fits(options);
  if (!shared) return fail(shared.error());
  auto report = !options.contours.empty() ? fit_contours(options, *shared, progress)
                : !options.image.empty()  ? fit_image(options, *shared, progress)
                : !is_mesh_name(options.out)
                    ? fit_many(options, *shared, progress)
                    : fit_case(options, *shared, options.cases().front(), options.out, progress);
  if (!report) return report;
  const auto warnings = template_warnings(*shared->the_template);
  report->warnings.insert(report->warnings.begin(), warnings.begin(), warnings.end());
  return report;
}

/// Refuses options that were given and do nothing for what is fitted to.
void check_effect(const FitJob& options, const CLI::App& verb) {
  const bool image = !options.image.empty();
  if (!options.contours.empty()) {
    for (const char* name : {"--partial", "--model", "--by-others", "--parts"})
      refuse_without_effect(verb, name, "a fit without --contours");
    if (options.masks.empty() && !image) refuse_without_effect(verb, "--frame", "images and label maps");
    if (options.masks.empty())
      for (const char* name : {"--label", "--closing-mm"}) refuse_without_effect(verb, name, "label maps");
    if (!image)
      for (const char* name : {"--reach-mm", "--strength", "--polarity", "--done", "--resample"})
        refuse_without_effect(verb, name, "an --image");
    if (!options.placement.empty()) refuse_without_effect(verb, "--orientation", "a fit without --placement");
    return;
  }
  for (const char* name : {"--structure", "--off-mm", "--outside"}) refuse_without_effect(verb, name, "--contours");
  if (image) {
    refuse_without_effect(verb, "--partial", "label maps and surfaces");
    refuse_without_effect(verb, "--orientation", "label maps and surfaces");
    if (!options.placement.empty()) refuse_without_effect(verb, "--landmarks", "a fit without --placement");
    refuse_without_effect(verb, "--by-others", "several cases");
    return;
  }
  for (const char* name : {"--reach-mm", "--strength", "--polarity", "--done", "--resample"})
    refuse_without_effect(verb, name, "an --image");
  if (options.to_meshes()) refuse_without_effect(verb, "--frame", "images and label maps");
  if (options.cases().size() < 2 && !options.of_folder) refuse_without_effect(verb, "--by-others", "several cases");
  if (!options.placement.empty() && !options.partial)
    refuse_without_effect(verb, "--orientation", "a fit without --placement");
}

/// A set goes to label maps, into a folder, and takes few options.
void check_set(const FitJob& options, const CLI::App& verb) {
  for (const char* name :
       {"--mesh", "--image", "--contours", "--label", "--level", "--closing-mm", "--parts", "--placement",
        "--landmarks", "--orientation", "--model", "--beyond", "--partial", "--mirror", "--by-others"})
    refuse_without_effect(verb, name, "a single template, not for a set");
  if (options.masks.empty()) throw CLI::RequiredError("--mask with the label maps to fit the set to");
  if (is_mesh_name(options.out))
    throw CLI::ValidationError("--output", "must be a folder, since a set gives a mesh for each structure");
}

/// Contours are of one case, alone or with a label map or an image.
void check_contours(const FitJob& options) {
  if (!options.meshes.empty()) throw CLI::ValidationError("--contours", "go with --mask or --image, not with --mesh");
  if (options.masks.size() > 1 || options.of_folder || (!options.masks.empty() && !options.image.empty()))
    throw CLI::ValidationError("--contours", "go with one label map or one image");
  if (!is_mesh_name(options.out))
    throw CLI::ValidationError("--output", "must be a mesh, since contours are of one case");
}

void check(const FitJob& options) {
  if (!options.contours.empty()) return check_contours(options);
  const int kinds = !options.masks.empty() + !options.meshes.empty() + !options.image.empty();
  if (kinds != 1) throw CLI::RequiredError("--contours, or exactly one of --mask, --mesh and --image");
  if (!options.image.empty()) return;
  if (options.cases().size() == 1 && !options.of_folder) return;
  if (is_mesh_name(options.out))
    throw CLI::ValidationError("--output", "must be a folder, since several cases are given");
  if (!options.placement.empty()) throw CLI::ValidationError("--placement", "is for one case only");
  if (!options.landmarks.empty() && !fs::is_directory(options.landmarks))
    throw CLI::ValidationError("--landmarks",
                               "must be a folder with a file CASE.mrk.json for a case, since several cases are given");
}

}  // namespace

void add_fit(CLI::App& app, CommandLine& asked) {
  auto options = std::make_shared<FitJob>();
  CLI::App* verb = add_verb(app, "fit", "Fits a template to label maps, surfaces, contours or an image");
  verb->add_option("TEMPLATE", options->template_source,
                   template_sources() + "; or a template set, NAME.set.json or " + built_in_set_source())
      ->required();
  auto* mask = verb->add_option("--mask", options->masks,
                                "The label map to fit to. Several, or a folder of them, go into a folder");
  verb->add_option("--mesh", options->meshes, "The surface to fit to. Several, or a folder of them, go into a folder")
      ->excludes(mask);
  verb->add_option("--image", options->image,
                   "The grey-value image to fit to; needs --placement, --landmarks or --contours");
  auto* contours =
      verb->add_option("--contours", options->contours,
                       "Contours to fit to: a DICOM structure set (RTSTRUCT), curves of 3D Slicer (.mrk.json) or lines "
                       "(.vtp), in any planes; alone, or with a --mask or an --image for what lies between them");
  verb->add_option("--structure", options->structure, "Of contours of several structures this one, by number or name")
      ->needs(contours);
  verb->add_option("--off-mm", options->off_mm, "How far the contours may lie off the boundary (mm)")
      ->check(CLI::Range(0.0, 100.0))
      ->needs(contours)
      ->capture_default_str();
  verb->add_flag("--outside", options->outside,
                 "The contours are not the boundary: the organ lies inside of them, as in loose strokes")
      ->needs(contours);
  keeps_correspondence(
      verb->add_option(
              "-o,--output", options->out,
              "The mesh to write, or a folder: it gets for each case its mesh and a case on its label map, and "
              "a study of all")
          ->required(),
      true);
  add_label_option(*verb, options->label,
                   "Which label of the mask, where it holds several, by number or name; 1,2: both together")
      ->needs(mask);
  add_level_option(*verb, options->level)->needs(mask);
  add_ball_option(*verb, "--closing-mm", options->closing_mm, "")
      ->description(
          "Clefts narrower than twice this radius (mm) are filled; without it what the template keeps, else 0.00625 "
          "of the organ's size, and wider where the fit is doubtful and that costs nothing")
      ->needs(mask);
  verb->add_option(
          "--parts", options->parts,
          "Of a label in several parts: largest, or of those of about one size the one most like the template; "
          "or all of them, as where this is not given and the template has several pieces")
      ->check(CLI::IsMember({"largest", "all"}))
      ->needs(mask);
  verb->add_option("--placement", options->placement,
                   "Where to start: a JSON file with rotation, scale and translation, as in a case file");
  verb->add_option("--landmarks", options->landmarks,
                   "Named places on the organ (.mrk.json, .fcsv, .json), or a folder with a file of each case's name");
  verb->add_option("--orientation", options->orientation,
                   "patient: rotations near the patient's axes; any: all rotations")
      ->check(CLI::IsMember({"patient", "any"}))
      ->capture_default_str();
  auto* model = verb->add_option("--model", options->model,
                                 "A shape model (.h5, .h5.json) of the template's numbering: first the shape that it "
                                 "allows nearest to the target, then beyond it");
  verb->add_option("--beyond", options->beyond,
                   "How far beyond the model's shape: 0 stays with it, 1 goes all the way to the target")
      ->check(CLI::Range(0.0, 1.0))
      ->needs(model)
      ->capture_default_str();
  add_snap_arguments(*verb, options->snap);
  add_resample_option(*verb, options->resample);
  verb->add_flag("--partial", options->partial,
                 "Parts of the organ may be missing: they are found, left to the template's shape or the model's, and "
                 "marked as outlier in the mesh");
  verb->add_option("--by-others", options->by_others,
                   "By way of how many other cases each is fitted again, so that their spread tells where it is in "
                   "doubt; each takes as long as the fit")
      ->check(CLI::Range(0, 100))
      ->capture_default_str();
  verb->add_option("--gap-mm", options->gap_mm, "Of a set: how far neighbours are kept apart (mm); 0: they may touch")
      ->check(CLI::Range(0.0, 20.0))
      ->capture_default_str();
  verb->add_flag("--mirror", options->mirror, "Use the template of the other side (left for right)");
  verb->callback([options, verb, &asked] {
    options->command = given_command(*verb);
    if (verb->count("--frame") > 0) options->frame = options->snap.frame;
    bool masks = false, meshes = false;
    const bool to_set = names_set(options->template_source);
    if (!to_set) options->masks = with_folders_opened(options->masks, volumes_in, masks);
    options->meshes = with_folders_opened(options->meshes, surfaces_in, meshes);
    options->of_folder = masks || meshes;
    if (to_set) {
      check_set(*options, *verb);
    } else {
      refuse_without_effect(*verb, "--gap-mm", "a set");
      check(*options);
    }
    check_effect(*options, *verb);
    asked.run = [options](Progress& progress) { return fit(*options, progress); };
  });
}

}  // namespace homolog
