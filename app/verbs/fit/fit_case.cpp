#include "app/verbs/fit/fit_case.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <span>

#include "app/verbs/case_landmarks.h"
#include "app/verbs/case_of_fit.h"
#include "app/verbs/case_pool.h"
#include "app/verbs/describe.h"
#include "app/verbs/fit/snap_arguments.h"
#include "app/verbs/input_folders.h"
#include "app/verbs/read_image.h"
#include "app/verbs/study/study_make.h"
#include "app/verbs/verb.h"
#include "core/adapt/judge_fit.h"
#include "core/adapt/labels/label_fit.h"
#include "core/assist/assist.h"
#include "core/base/encoding/json.h"
#include "core/base/files/files.h"
#include "core/base/files/paths.h"
#include "core/base/numbers/statistics.h"
#include "core/case/action_json.h"
#include "core/case/placing.h"
#include "core/catalogue/catalogue.h"
#include "core/groupwise/cohort_doubt.h"
#include "core/groupwise/same_place.h"
#include "core/mesh/files/mesh_frame.h"
#include "core/mesh/parts/rims.h"
#include "core/model/files/statismo.h"
#include "core/model/model_prior.h"
#include "core/model/shapes/doubtful_shapes.h"
#include "core/placement/likely_similarity.h"
#include "core/placement/similarity_fit.h"
#include "core/session/case_file.h"
#include "core/template/other_side.h"
#include "core/template/template_warnings.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

Result<std::shared_ptr<const Template>> template_of_fits(const FitJob& options,
                                                         const std::shared_ptr<const Template>& of_file) {
  if (!options.mirror) return of_file;
  return make_template(mirrored_with_names(to_mesh_file(*of_file)), options.template_source);
}

Result<Similarity> read_placement(const fs::path& path) {
  const auto text = read_whole_file(path, 1 << 20);
  if (!text) return fail(text.error());
  const auto json = read_json<Json>(*text);
  if (!json) return fail(path.string(), json.error().what + "; save the placement again");
  auto placement =
      similarity_from_json(json->is_object() && json->contains("placement") ? (*json)["placement"] : *json);
  if (!placement) return fail(path.string(), placement.error().what);
  if (auto usable = check_placement(*placement); !usable)
    return fail(path.string(), "the placement " + usable.error().what + "; save the placement again");
  return placement;
}

/// How a label map is fitted to.
LabelFitOptions how_to_fit(const FitJob& options, const FitShared& shared) {
  LabelFitOptions how{.closing_mm = options.closing_mm, .kept_closing_mm = shared.kept_closing_mm};
  if (!options.parts.empty()) how.all_parts = options.parts == "all";
  return how;
}

/// Reads a surface, or a label map, of which the boundary is still to be made.
Result<FitTarget> read_fit_target(const FitJob& options, const FitShared& shared, const fs::path& path,
                                  Progress& progress) {
  if (!options.to_meshes()) {
    const bool among_others = shared.the_template->faced.has_value();
    auto mask = read_mask(path, options.label, {options.frame, {}, options.level, false, among_others}, progress);
    if (!mask) return fail(mask.error());
    return FitTarget{FitClock::now(), {}, std::move(*mask)};
  }
  const auto file = read_mesh_to_mend(path);
  if (!file) return fail(file.error());
  const auto started = FitClock::now();
  auto boundary = surface_boundary(*file, shared.the_template->points.rows(), &progress, options.partial,
                                   long_rims({shared.the_template->topology, shared.the_template->points}).size());
  if (!boundary) return fail(path.string(), boundary.error().what);
  boundary->warnings.insert(boundary->warnings.begin(), file->warnings.begin(), file->warnings.end());
  return FitTarget{started, std::move(*boundary), std::nullopt};
}

/// The first `count` of these sentences are about the mask's labels: they name them, and what reading it said comes
/// before them.
void put_names(const MaskRead& mask, std::ptrdiff_t count, std::vector<std::string>& sentences) {
  for (std::string& sentence : std::span(sentences).first(static_cast<std::size_t>(count)))
    sentence = mask.named(std::move(sentence));
  sentences.insert(sentences.begin(), mask.warnings.begin(), mask.warnings.end());
}

/// What the model alone came to, and how far the mesh lies beyond it.
Json described_allowed(const Points& allowed, const Mesh& mesh, const Mesh& boundary) {
  const auto beyond_mm = (mesh.points - allowed).rowwise().norm();
  return {{"assd_mm", mean_surface_distance_mm({mesh.topology, allowed}, boundary)},
          {"beyond_mm", {{"mean", beyond_mm.mean()}, {"max", beyond_mm.maxCoeff()}}}};
}

}  // namespace

Report report_of_fit(const FitTarget& target, const Template& the_template, const FitResult& fit,
                     const FitJudgement& judgement, bool partial, double seconds) {
  const Agreement& agreement = judgement.agreement;
  Report report;
  const auto dice_of = [&](const Agreement& one) { return judgement.rim ? Json() : Json(one.dice); };
  report.values = {{"assd_mm", agreement.assd_mm}, {"hd95_mm", agreement.hd95_mm}, {"dice", dice_of(agreement)}};
  if (judgement.rim) report.values["rim_mm"] = {{"mean", judgement.rim->mean_mm}, {"p95", judgement.rim->p95_mm}};
  const Agreement& inside = judgement.inside_scan;
  report.values["inside_scan"] = {{"assd_mm", inside.assd_mm}, {"hd95_mm", inside.hd95_mm}, {"dice", dice_of(inside)}};
  report.values["beyond_share"] = judgement.beyond_share;
  if (target.mask) {
    const MaskRead& mask = *target.mask;
    // A part of the label's surface encloses nothing.
    report.values["dice_raw"] =
        the_template.faced ? Json() : Json(dice_with_mask(fit.mesh, mask.volume, mask.label, mask.frame));
    mask.report(report.values);
    report.values["parts_left_out"] = {{"count", target.boundary.parts_left_out},
                                       {"share", target.boundary.share_left_out}};
  }
  report.values.update(Json{{"turned_triangles", fit.turned_triangles},
                            {"self_intersections", fit.self_intersections},
                            {"unseen_vertices", fit.unseen.size()},
                            {"doubtful", judgement.doubtful},
                            {"mirrored", fit.mirrored},
                            {"landmarks_used", fit.landmarks_used},
                            {"landmarks_place", fit.landmarks_place},
                            {"placement", to_json(fit.placement)},
                            {"seconds", seconds}});
  report.values["doubt_mm"] = described_doubt(the_template, fit);
  if (partial) {
    report.values["outliers"] = fit.outliers.size();
    report.values["sound_mm"] = std::ssize(fit.outliers) < fit.mesh.points.rows() ? Json(judgement.sound_mm) : Json();
    report.values["target_mm"] = {{"mean", judgement.target.mean_mm}, {"p95", judgement.target.p95_mm}};
  }
  if (fit.allowed.size() > 0)
    report.values["model"] = described_allowed(fit.allowed, fit.mesh, target.boundary.surface);
  return report;
}

namespace {

/// What a case of a study keeps of a fit.
FittedCase case_of(const FitJob& options, const FitShared& shared, const fs::path& path, const FitTarget& target,
                   const FitResult& fit, const FitJudgement& judgement) {
  FittedCase fitted{case_name_of(path), {}, {}, nullptr, shared.template_of_file, options.mirror, fit.mesh.points};
  fitted.placement = fit.placement;
  if (target.mask) {
    fitted.image = fitted.labels = path;
    fitted.grid = grid_of(target.mask->volume);
    if (target.mask->volume.frames > 1) fitted.frame = target.mask->frame;
  }
  fitted.doubt_mm = fit.doubt_mm;
  if (options.partial) fitted.outlier = outlier_marks(fit);
  if (judgement.doubtful) fitted.doubt = reason_of_doubt(judgement.warnings);
  fitted.figures = figures_of_fit(judgement, fit, options.partial);
  return fitted;
}

}  // namespace

Json described_closing(const LabelFit& fitted, const LabelFitOptions& how) {
  Json closing{{"closing_mm", fitted.closing_mm},
               {"closing_chosen", !how.closing_mm.has_value()},
               {"closing_why", why_closing(fitted, how)}};
  if (how.closing_mm) return closing;
  Json tried = Json::array();
  for (const TriedClosing& one : fitted.tried)
    tried.push_back({{"closing_mm", one.closing_mm}, {"dice_raw", one.dice_raw}, {"doubtful", one.doubtful}});
  closing["closing_tried"] = tried;
  return closing;
}

namespace {

/// Fits to what was read of a case, and judges that.
Result<FittedTarget> fitted_to(const FitJob& options, const FitShared& shared, const FitOptions& fitting,
                               FitTarget& target) {
  const Template& the_template = *shared.the_template;
  FittedTarget fitted;
  if (target.mask) {
    const LabelFitOptions how = how_to_fit(options, shared);
    auto found = fit_to_label(the_template, target.label(), how, fitting);
    if (!found) return fail("", target.mask->named(found.error().what));
    fitted.closing = described_closing(*found, how);
    const auto of_labels = std::ssize(found->boundary.warnings);
    fitted.judgement = std::move(found->judgement);
    put_names(*target.mask, of_labels, fitted.judgement.warnings);
    target.boundary = std::move(found->boundary);
    fitted.fit = std::move(found->fit);
  } else {
    auto fit = fit_to_boundary(the_template, target.boundary, fitting);
    if (!fit) return fail(fit.error());
    fitted.judgement = judge_fit(the_template, target.boundary, fitting, *fit);
    fitted.fit = std::move(*fit);
    fitted.closing = Json::object();
  }
  fitted.seconds = std::chrono::duration<double>(FitClock::now() - target.started).count();
  return fitted;
}

/// A fit that was kept, whose doubt takes in the other cases.
Result<FittedTarget> fitted_again(const FitJob& options, const FitShared& shared, const FitOptions& fitting,
                                  const AmongCases& among, FitTarget& target) {
  const Template& the_template = *shared.the_template;
  FittedTarget fitted = *among.again;
  if (target.mask) {
    const double closing_mm = fitted.closing["closing_mm"].get<double>();
    auto boundary = boundary_to_fit(the_template, target.label(), how_to_fit(options, shared), closing_mm, fitting);
    if (!boundary) return fail("", target.mask->named(boundary.error().what));
    target.boundary = std::move(*boundary);
    put_names(*target.mask, std::ssize(target.boundary.warnings), target.boundary.warnings);
  }
  const auto spread = spread_by_others_mm2(the_template, among.others, target.boundary, fitting, fitted.fit);
  if (!spread) return fail(spread.error());
  fitted.fit.doubt_mm = doubt_among_others_mm(fitted.fit.doubt_mm, *spread);
  fitted.judgement = judge_fit(the_template, target.boundary, fitting, fitted.fit);
  return fitted;
}

}  // namespace

Json described_doubt(const Template& the_template, const FitResult& fit) {
  const std::vector<double> each(fit.doubt_mm.begin(), fit.doubt_mm.end());
  Json doubt{{"mean", fit.doubt_mm.mean()}, {"p95", quantile(each, 0.95)}, {"max", fit.doubt_mm.maxCoeff()}};
  if (the_template.landmarks.empty()) return doubt;
  Json of_landmarks = Json::object();
  for (std::size_t k = 0; k < the_template.landmarks.size(); ++k) {
    of_landmarks[the_template.landmarks[k].name] = value_at_landmark(the_template, k, fit.doubt_mm);
  }
  doubt["landmarks"] = std::move(of_landmarks);
  return doubt;
}

Result<std::string> record_of_fit(const FitJob& options, const fs::path& path, Progress& progress) {
  const char* const option = options.to_meshes() ? "--mesh" : "--mask";
  if (options.ways_by_others() > 0) return record_of(options.command.with(option, options.cases()), progress);
  GivenCommand alone = options.command.with(option, {path});
  if (fs::is_directory(options.landmarks)) {
    const fs::path own = landmark_file_in(options.landmarks, case_name_of(path));
    alone = alone.with("--landmarks", own.empty() ? std::vector<fs::path>() : std::vector{own});
  }
  return record_of(alone, progress);
}

Result<FitShared> shared_of_fits(const FitJob& options) {
  auto of_file = load_template(options.template_source);
  if (!of_file) return fail(of_file.error());
  auto the_template = template_of_fits(options, *of_file);
  if (!the_template) return fail(the_template.error());
  FitShared shared{*the_template, *of_file, {}, closing_kept_with(options.template_source)};
  shared.fit.orientation = options.orientation == "any" ? Orientation::any : Orientation::patient;
  if (!options.placement.empty()) {
    auto placement = read_placement(options.placement);
    if (!placement) return fail(placement.error());
    shared.fit.placement = *placement;
  }
  shared.fit.partial = options.partial;
  if (options.model.empty()) return shared;
  const auto model = read_model(options.model);
  if (!model) return fail(model.error());
  auto allowed = allowed_by(*model, **the_template);
  if (!allowed) return fail(options.model.string(), allowed.error().what);
  allowed->beyond = options.beyond;
  shared.fit.allowed = std::make_shared<const AllowedShapes>(std::move(*allowed));
  return shared;
}

void report_image(const FitJob& options, const VolumeRead& image, Report& report) {
  std::vector<std::string> warnings = image.warnings;
  if (image.volume.frames > 1) {
    report.values["frame"] = options.snap.frame;
    if (!options.frame) warnings.push_back(frame_taken(options.image, image.volume.frames, options.snap.frame));
  }
  report_resampled(image, report.values);
  report.warnings.insert(report.warnings.begin(), warnings.begin(), warnings.end());
}

MeshFile fitted_file(const Template& the_template, const FitResult& fit, bool partial) {
  MeshFile file = to_mesh_file(the_template);
  file.points = fit.mesh.points;
  file.landmarks = fit.landmarks;
  if (fit.doubt_mm.size() > 0) file.doubt_mm = fit.doubt_mm;
  if (partial) file.outlier = outlier_marks(fit);
  if (!fit.unseen.empty()) file.comments.push_back("homolog.unseen " + Json(fit.unseen).dump());
  return file;
}

Result<Report> fit_case(const FitJob& options, const FitShared& shared, const fs::path& path, const fs::path& out,
                        Progress& progress, const AmongCases& among) {
  auto target = read_fit_target(options, shared, path, progress);
  if (!target) return fail(target.error());
  auto landmarks = read_case_landmarks(options.landmark_files(), *shared.the_template, path);
  if (!landmarks) return fail(landmarks.error());
  FitOptions fitting = shared.fit;
  fitting.landmarks = std::move(landmarks->places);
  fitting.progress = &progress;
  auto done = among.again == nullptr ? fitted_to(options, shared, fitting, *target)
                                     : fitted_again(options, shared, fitting, among, *target);
  if (!done) return fail(path.string(), done.error().what);
  FittedTarget fitted = std::move(*done);
  if (among.again == nullptr) {
    fitted.warnings = std::move(landmarks->warnings);
    if (among.off_share != nullptr && !options.partial)
      *among.off_share =
          off_target_mm(fitted.fit.mesh, target->boundary) / bounds_of(fitted.fit.mesh.points).diagonal().norm();
  }
  MeshFile file = fitted_file(*shared.the_template, fitted.fit, options.partial);
  const bool of_cine = target->mask && target->mask->volume.frames > 1;
  if (of_cine) note_frame(file, target->mask->frame);
  if (fitted.judgement.doubtful) file.comments.push_back(doubt_comment(reason_of_doubt(fitted.judgement.warnings)));
  auto record = record_of_fit(options, path, progress);
  if (!record) return fail(record.error());
  file.record = options.ways_by_others() > 0 ? record_of_output(*record, out.filename().string()) : *record;
  if (auto written = write_mesh_file(file, out); !written) return fail(written.error());
  std::vector<std::string> kept;
  if (among.of_study != nullptr) {
    FittedCase of_study = case_of(options, shared, path, *target, fitted.fit, fitted.judgement);
    of_study.record = record_of_output(*record, of_study.name + case_extension);
    auto one = write_case_of_fit(of_study, out.parent_path(), kept);
    if (!one) return fail(one.error());
    *among.of_study = std::move(*one);
  }
  Report report =
      report_of_fit(*target, *shared.the_template, fitted.fit, fitted.judgement, options.partial, fitted.seconds);
  report.values.update(fitted.closing);
  report.warnings = fitted.warnings;
  report.warnings.insert(report.warnings.end(), fitted.judgement.warnings.begin(), fitted.judgement.warnings.end());
  report.warnings = about(path, std::move(report.warnings));
  report.warnings.insert(report.warnings.end(), kept.begin(), kept.end());
  // The template may be of the same scan: then its axes can be told too.
  const Mesh own{shared.the_template->topology, shared.the_template->points};
  if (const auto misfit = misfit_in_scan(own, target->boundary.surface))
    report.warnings.insert(report.warnings.begin(),
                           misfit_sentence(*misfit, meeting_of(options.template_source, own.points),
                                           meeting_of(path, target->boundary.surface.points)));
  if (!among.others.empty()) report.values["doubt_mm"]["by_others"] = among.others.size();
  if (among.keep != nullptr) *among.keep = std::move(fitted);
  return report;
}

}  // namespace homolog
