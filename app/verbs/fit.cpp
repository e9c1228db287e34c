#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <memory>

#include "app/verbs/case_landmarks.h"
#include "app/verbs/case_of_fit.h"
#include "app/verbs/case_pool.h"
#include "app/verbs/describe.h"
#include "app/verbs/fit_parts.h"
#include "app/verbs/input_folders.h"
#include "app/verbs/read_image.h"
#include "app/verbs/snap_arguments.h"
#include "app/verbs/study_make.h"
#include "app/verbs/verb.h"
#include "core/adapt/choose_closing.h"
#include "core/adapt/judge_fit.h"
#include "core/base/files.h"
#include "core/base/json.h"
#include "core/base/paths.h"
#include "core/base/statistics.h"
#include "core/case/action_json.h"
#include "core/case/placing.h"
#include "core/catalogue/catalogue.h"
#include "core/groupwise/cohort_doubt.h"
#include "core/mesh/mesh_frame.h"
#include "core/mesh/mirror.h"
#include "core/model/doubtful_shapes.h"
#include "core/model/model_prior.h"
#include "core/model/statismo.h"
#include "core/placement/likely_similarity.h"
#include "core/placement/similarity_fit.h"
#include "core/template/template_warnings.h"

// The verb `fit`: a template to one label map or surface, or to many, or to the boundary that an image shows.

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct Options {
  std::string template_source, orientation = "patient", parts = "largest";
  std::vector<fs::path> masks, meshes;
  fs::path image, out, placement, landmarks, model;
  double beyond = 1;
  SnapArguments snap;        ///< for an image
  std::optional<int> frame;  ///< of a label map: as asked
  std::vector<int> labels;
  std::optional<double> closing_mm;
  bool mirror = false, partial = false;
  bool of_folder = false;  ///< cases were named by their folder

  int by_others = 0;  ///< third subjects

  bool to_meshes() const { return !meshes.empty(); }
  const std::vector<fs::path>& cases() const { return to_meshes() ? meshes : masks; }
  /// By how many third subjects each case is fitted too. None unless asked for: a case's files do not hang on what
  /// else is fitted.
  std::size_t ways_by_others() const {
    return cases().empty() ? 0 : std::min(cases().size() - 1, static_cast<std::size_t>(by_others));
  }
  LandmarkFiles landmark_files() const { return {landmarks, template_source, cases().size() > 1 || of_folder}; }
};

/// What all cases of a run share, read once.
struct Shared {
  std::shared_ptr<const Template> the_template;
  std::shared_ptr<const Template> template_of_file;  ///< the same, not mirrored
  FitOptions fit;
  std::optional<double> kept_closing_mm;  ///< with the template
};

Result<std::shared_ptr<const Template>> template_of(const Options& options,
                                                    const std::shared_ptr<const Template>& of_file) {
  if (!options.mirror) return of_file;
  return make_template(mirrored(to_mesh_file(*of_file)), options.template_source);
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

Result<Shared> shared_of(const Options& options) {
  auto of_file = load_template(options.template_source);
  if (!of_file) return fail(of_file.error());
  auto the_template = template_of(options, *of_file);
  if (!the_template) return fail(the_template.error());
  Shared shared{*the_template, *of_file, {}, closing_kept_with(options.template_source)};
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

using Clock = std::chrono::steady_clock;

/// One case's target, and the mask it comes from where there is one.
struct Target {
  Clock::time_point started = Clock::now();  ///< once the file was read
  Boundary boundary;
  std::optional<MaskRead> mask;
};

/// `closing_mm`: where --closing-mm says none.
Result<Target> read_target(const Options& options, const Shared& shared, const fs::path& path,
                           std::optional<double> closing_mm, Progress& progress) {
  const Eigen::Index vertices = shared.the_template->points.rows();
  if (options.to_meshes()) {
    const auto file = read_mesh_to_mend(path);
    if (!file) return fail(file.error());
    const auto started = Clock::now();
    auto boundary = surface_boundary(*file, vertices, &progress);
    if (!boundary) return fail(path.string(), boundary.error().what);
    boundary->warnings.insert(boundary->warnings.begin(), file->warnings.begin(), file->warnings.end());
    return Target{started, std::move(*boundary), std::nullopt};
  }
  auto mask = read_mask(path, options.labels, {options.frame, {}}, progress);
  if (!mask) return fail(mask.error());
  const auto started = Clock::now();
  const auto part = [&](std::size_t rank) {
    return label_boundary(mask->volume, mask->label, mask->frame, options.closing_mm ? options.closing_mm : closing_mm,
                          vertices, {options.parts == "all", rank});
  };
  auto boundary = part(0);
  if (boundary && options.parts == "largest" && !options.partial)
    boundary = likeliest_part(*shared.the_template, std::move(*boundary), part, shared.fit);
  if (!boundary) return fail(path.string(), mask->named(boundary.error().what));
  boundary->warnings = mask->named(std::move(boundary->warnings));
  boundary->warnings.insert(boundary->warnings.begin(), mask->warnings.begin(), mask->warnings.end());
  return Target{started, std::move(*boundary), std::move(*mask)};
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

/// What the model alone came to, and how far the mesh lies beyond it.
Json described_allowed(const Points& allowed, const Mesh& mesh, const Mesh& boundary) {
  const auto beyond_mm = (mesh.points - allowed).rowwise().norm();
  return {{"assd_mm", mean_surface_distance_mm({mesh.topology, allowed}, boundary)},
          {"beyond_mm", {{"mean", beyond_mm.mean()}, {"max", beyond_mm.maxCoeff()}}}};
}

/// How far vertices and landmarks may lie from where they belong.
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

Report report_of(const Target& target, const Template& the_template, const FitResult& fit,
                 const FitJudgement& judgement, bool partial, double seconds) {
  const Agreement& agreement = judgement.agreement;
  Report report;
  report.values = {{"assd_mm", agreement.assd_mm}, {"hd95_mm", agreement.hd95_mm}, {"dice", agreement.dice}};
  const Agreement& inside = judgement.inside_scan;
  report.values["inside_scan"] = {{"assd_mm", inside.assd_mm}, {"hd95_mm", inside.hd95_mm}, {"dice", inside.dice}};
  report.values["beyond_share"] = judgement.beyond_share;
  if (target.mask) {
    const MaskRead& mask = *target.mask;
    report.values["dice_raw"] = dice_with_mask(fit.mesh, mask.volume, mask.label, mask.frame);
    mask.report_frame(report.values);
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

/// What a case of a study keeps of a fit.
FittedCase case_of(const Options& options, const Shared& shared, const fs::path& path, const Target& target,
                   const FitResult& fit, const FitJudgement& judgement) {
  FittedCase fitted{case_name_of(path), {}, {}, nullptr, shared.template_of_file, options.mirror, fit.mesh.points};
  fitted.placement = fit.placement;
  if (target.mask) {
    fitted.image = fitted.labels = path;
    fitted.grid = grid_of(target.mask->volume);
  }
  fitted.doubt_mm = fit.doubt_mm;
  if (options.partial) fitted.outlier = outlier_marks(fit);
  if (judgement.doubtful) fitted.doubt = reason_of_doubt(judgement.warnings);
  FitFigures figures;
  figures.mean_mm = options.partial ? judgement.target.mean_mm : judgement.inside_scan.assd_mm;
  figures.p95_mm = options.partial ? judgement.target.p95_mm : judgement.inside_scan.hd95_mm;
  if (!options.partial) figures.dice = judgement.inside_scan.dice;
  if (options.partial)
    figures.missing_share = static_cast<double>(fit.outliers.size()) / static_cast<double>(fit.mesh.points.rows());
  for (const std::string& warning : judgement.warnings) figures.warnings.push_back(reason_of_doubt({warning}));
  fitted.figures = std::move(figures);
  return fitted;
}

/// Of a fit to a label map: the closing radius for the report. Where nobody asked for one and the fit is doubtful,
/// wider ones are tried, and a fit that is sound takes the first one's place.
Json close_better(const Options& options, const Shared& shared, const FitOptions& fitting, Target& target,
                  FitResult& fit, FitJudgement& judgement) {
  if (!target.mask) return Json::object();
  const MaskRead& mask = *target.mask;
  const double usual_mm = usual_closing_mm(mask.volume, mask.label, mask.frame);
  const double first_mm = options.closing_mm.value_or(shared.kept_closing_mm.value_or(usual_mm));
  if (options.closing_mm) return {{"closing_mm", first_mm}, {"closing_chosen", false}, {"closing_why", "as asked for"}};
  const bool other_part = options.parts == "all" || target.boundary.parts_alike > 1;  // which closing would not know
  OtherClosing first{first_mm, std::move(target.boundary), std::move(fit), std::move(judgement)};
  MoreClosing more;
  if (!other_part) more = try_more_closing(*shared.the_template, mask.volume, mask.label, mask.frame, fitting, first);
  const std::string why = why_closing(more, shared.kept_closing_mm.has_value());
  if (!more.better && !more.tried.empty()) first.judgement.warnings.push_back(tried_in_vain(more));
  OtherClosing& taken = more.better ? *more.better : first;
  if (more.better) {  // the label map's own warnings stand before those of the boundary, which were named by its labels
    auto& said = taken.judgement.warnings;
    said.erase(said.begin(), said.begin() + std::ssize(taken.boundary.warnings));
    said.insert(said.begin(), first.boundary.warnings.begin(), first.boundary.warnings.end());
    taken.boundary.warnings = first.boundary.warnings;
  }
  target.boundary = std::move(taken.boundary);
  fit = std::move(taken.fit);
  judgement = std::move(taken.judgement);
  Json tried = Json::array();
  for (const TriedClosing& one : more.tried)
    tried.push_back({{"closing_mm", one.closing_mm}, {"dice_raw", one.dice_raw}, {"doubtful", one.doubtful}});
  return {{"closing_mm", taken.closing_mm}, {"closing_chosen", true}, {"closing_why", why}, {"closing_tried", tried}};
}

/// What was fitted to a case.
struct Fitted {
  FitResult fit;
  FitJudgement judgement;
  Json closing;                       ///< for the report
  std::vector<std::string> warnings;  ///< of its landmarks
  double seconds = 0;
};

/// A case among others: what is kept of its fit, or the fit that was kept, whose doubt now takes in the others.
struct Among {
  std::optional<Fitted>* keep = nullptr;
  const Fitted* again = nullptr;
  std::vector<const Points*> others;  ///< third subjects [spread_by_others_mm2]
  StudyCase* of_study = nullptr;      ///< gets a case for the study of a cohort; null: none is written
};

/// The closing radius that a kept fit ended with, else the one that is kept with the template.
std::optional<double> closing_of(const Shared& shared, const Among& among) {
  if (among.again == nullptr || !among.again->closing.contains("closing_mm")) return shared.kept_closing_mm;
  return among.again->closing["closing_mm"].get<double>();
}

Result<Report> fit_case(const Options& options, const Shared& shared, const fs::path& path, const fs::path& out,
                        Progress& progress, const Among& among = {}) {
  auto target = read_target(options, shared, path, closing_of(shared, among), progress);
  if (!target) return fail(target.error());
  auto landmarks = read_case_landmarks(options.landmark_files(), *shared.the_template, path);
  if (!landmarks) return fail(landmarks.error());
  FitOptions fitting = shared.fit;
  fitting.landmarks = std::move(landmarks->places);
  fitting.progress = &progress;
  Fitted fitted;
  if (among.again == nullptr) {
    fitted.warnings = std::move(landmarks->warnings);
    auto fit = fit_to_boundary(*shared.the_template, target->boundary, fitting);
    if (!fit) return fail(path.string(), fit.error().what);
    fitted.fit = std::move(*fit);
    fitted.judgement = judge_fit(*shared.the_template, target->boundary, fitting, fitted.fit);
    fitted.closing = close_better(options, shared, fitting, *target, fitted.fit, fitted.judgement);
    fitted.seconds = std::chrono::duration<double>(Clock::now() - target->started).count();
  } else {
    fitted = *among.again;
    const auto spread = spread_by_others_mm2(*shared.the_template, among.others, target->boundary, fitting, fitted.fit);
    if (!spread) return fail(path.string(), spread.error().what);
    fitted.fit.doubt_mm = doubt_among_others_mm(fitted.fit.doubt_mm, *spread);
    fitted.judgement = judge_fit(*shared.the_template, target->boundary, fitting, fitted.fit);
  }
  MeshFile file = fitted_file(*shared.the_template, fitted.fit, options.partial);
  const bool of_cine = target->mask && target->mask->volume.frames > 1;
  if (of_cine) note_frame(file, target->mask->frame);
  if (fitted.judgement.doubtful) file.comments.push_back(doubt_comment(reason_of_doubt(fitted.judgement.warnings)));
  if (auto written = write_mesh_file(file, out); !written) return fail(written.error());
  std::vector<std::string> kept;
  if (among.of_study != nullptr && !of_cine) {
    auto one = write_case_of_fit(case_of(options, shared, path, *target, fitted.fit, fitted.judgement),
                                 out.parent_path(), kept);
    if (!one) return fail(one.error());
    *among.of_study = std::move(*one);
  }
  Report report =
      report_of(*target, *shared.the_template, fitted.fit, fitted.judgement, options.partial, fitted.seconds);
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

/// Where the template starts in an image: as the placement says, or on three named places.
Result<Similarity> start_in_image(const Shared& shared, const CaseLandmarks& landmarks) {
  if (shared.fit.placement) return *shared.fit.placement;
  const auto [from, to] = matched_landmarks(*shared.the_template, landmarks.places);
  if (from.rows() < fewest_placing_landmarks)
    return fail("", "needs --placement, or --landmarks with at least three of the template's landmarks");
  const Similarity placement =
      likely_similarity(from, to, PlacementPrior{}, bounds_of(shared.the_template->points).diagonal().norm());
  if (!(placement.scale > 0))
    return fail("", "cannot be placed: the landmarks contradict each other; check their places and names");
  return placement;
}

Result<Report> fit_image(const Options& options, const Shared& shared, Progress& progress) {
  const auto landmarks = read_case_landmarks(options.landmark_files(), *shared.the_template, options.image);
  if (!landmarks) return fail(landmarks.error());
  const auto placement = start_in_image(shared, *landmarks);
  if (!placement) return fail(options.image.string(), placement.error().what);
  auto image = read_image(options.image, options.snap.frame, progress);
  if (!image) return fail(image.error());
  const Template& the_template = *shared.the_template;
  auto snapping = snap_options(options.snap, the_template.points.rows(), progress);
  if (!snapping) return fail(snapping.error());
  snapping->progress = &progress;

  const auto started = Clock::now();
  Mesh mesh{the_template.topology, placement->apply(the_template.points)};
  if (shared.fit.allowed) {
    auto allowed = snap_allowed(image->volume, options.snap.frame, *shared.fit.allowed, the_template.topology,
                                *placement, *snapping);
    if (!allowed) return fail(options.image.string(), allowed.error().what);
    mesh.points = std::move(allowed->points);
    snapping->strength *= options.beyond;
  }
  const Points placed = mesh.points;
  SnapStart start{mesh, placed, the_template.stiffness, VertexScalars::Ones(mesh.points.rows())};
  for (std::size_t l = 0; l < the_template.landmarks.size(); ++l) {
    const auto there = landmarks->places.find(the_template.landmarks[l].name);
    if (there == landmarks->places.end()) continue;
    if ((carried_landmark(the_template, l, mesh.points) - there->second).norm() <= snapping->edges.reach_mm)
      start.pins.push_back({the_template.landmark_points[l], there->second});
  }
  const auto snapped = snap(image->volume, options.snap.frame, start, *snapping);
  if (!snapped) return fail(options.image.string(), snapped.error().what);
  const double seconds = std::chrono::duration<double>(Clock::now() - started).count();
  mesh.points = snapped->points;
  FitResult fit;
  fit.mesh = mesh;
  fit.unseen = snapped->unseen;
  fit.landmarks = carried_landmarks(the_template, mesh.points);
  MeshFile file = fitted_file(the_template, fit, false);
  if (image->volume.frames > 1) note_frame(file, options.snap.frame);
  if (auto written = write_mesh_file(file, options.out); !written) return fail(written.error());
  Report report = snap_report(*snapped, mesh, placed, options.image);
  report.values["placement"] = to_json(nearest_similarity(the_template.points, mesh.points, *placement));
  report.values["landmarks_used"] = shared.fit.placement ? 0 : landmarks->places.size();
  if (shared.fit.allowed) {
    const auto beyond_mm = (mesh.points - placed).rowwise().norm();
    report.values["model"] = {{"beyond_mm", {{"mean", beyond_mm.mean()}, {"max", beyond_mm.maxCoeff()}}}};
  }
  report.values["seconds"] = seconds;
  report.warnings.insert(report.warnings.begin(), image->warnings.begin(), image->warnings.end());
  return report;
}

/// The mesh to write for each case. Errors: two cases of one name.
Result<std::vector<fs::path>> outputs_of(const Options& options) {
  std::map<std::string, fs::path> taken;
  std::vector<fs::path> outputs;
  for (const fs::path& path : options.cases()) {
    const auto [other, is_new] = taken.emplace(case_name_of(path), path);
    if (!is_new)
      return fail(path.string(), "would be written to the same file as " + other->second.string() + "; rename one");
    outputs.push_back(options.out / (other->first + ".ply"));
  }
  return outputs;
}

/// The study of a folder of fits: "fits/fits.study.json".
fs::path study_in(const fs::path& folder) {
  const fs::path whole = absolute_path(folder / "x").parent_path();
  return folder / (whole.filename().string() + ".study.json");
}

Result<Report> fit_many(Options options, const Shared& shared, Progress& progress) {
  if (options.of_folder && !options.to_meshes()) {
    options.masks = label_maps_among(options.masks);
    if (options.masks.empty())
      return fail("", "the folder holds images, and no label map; name a folder of label maps by --mask");
  }
  const auto outputs = outputs_of(options);
  if (!outputs) return fail(outputs.error());
  const auto folder = ResultFolder::make(options.out);
  if (!folder) return fail(folder.error());
  const auto& paths = options.cases();
  std::vector<std::optional<Fitted>> fitted(paths.size());
  std::vector<StudyCase> cases_made(paths.size());
  const std::size_t by_others = options.ways_by_others();
  progress.part(0, 1 / (1 + static_cast<double>(by_others)));
  auto results = run_cases(
      paths.size(),
      [&](std::size_t i, Progress& own) {
        set_case_in_work(case_name_of(paths[i]));
        Among among;
        if (by_others > 0)
          among.keep = &fitted[i];
        else
          among.of_study = &cases_made[i];
        return fit_case(options, shared, paths[i], (*outputs)[i], own, among);
      },
      progress);
  if (by_others > 0 && !progress.cancelled()) {
    progress.part(1 / (1 + static_cast<double>(by_others)), 1);
    std::vector<const FitResult*> fits;
    for (const auto& one : fitted) fits.push_back(one ? &one->fit : nullptr);
    const auto third = third_subjects(fits, by_others + 1);
    auto again = run_cases(
        paths.size(),
        [&](std::size_t i, Progress& own) -> Result<Report> {
          if (fits[i] == nullptr) return fail("", "was not fitted");
          set_case_in_work(case_name_of(paths[i]));
          Among among{nullptr, &*fitted[i], {}, &cases_made[i]};
          for (const std::size_t k : third)
            if (k != i && among.others.size() < by_others) among.others.push_back(&fits[k]->mesh.points);
          return fit_case(options, shared, paths[i], (*outputs)[i], own, among);
        },
        progress);
    for (std::size_t i = 0; i < again.size(); ++i)
      if (again[i]) results[i] = std::move(again[i]);
  }
  if (progress.cancelled()) return fail("", "the fit was cancelled; the meshes finished so far are kept");
  Report report;
  report.warnings = landmarks_of_no_case(options.landmark_files(), options.cases());
  Json cases = Json::array();
  std::size_t failed = 0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    Json line{{"case", paths[i].string()}};
    if (results[i]) {
      line["mesh"] = (*outputs)[i].string();
      line.update(results[i]->values);
      report.warnings.insert(report.warnings.end(), results[i]->warnings.begin(), results[i]->warnings.end());
    } else {
      ++failed;
      line["error"] = results[i].error().sentence();
      report.warnings.push_back(results[i].error().sentence());
    }
    cases.push_back(std::move(line));
  }
  if (failed == results.size())
    return fail(options.out.string(), "none of the " + std::to_string(failed) +
                                          " cases could be fitted; the first: " + results.front().error().sentence());
  std::size_t doubtful = 0;
  for (const auto& result : results) doubtful += result && result->values["doubtful"] == true ? 1 : 0;
  report.values = {{"fitted", results.size() - failed}, {"failed", failed}, {"doubtful", doubtful}};
  std::erase_if(cases_made, [](const StudyCase& one) { return one.name.empty(); });
  if (!cases_made.empty()) {
    const fs::path study = study_in(options.out);
    if (auto written = write_cases_into(study, options.template_source, std::move(cases_made)); !written)
      return fail(written.error());
    report.values["study"] = study.string();
  }
  report.values["cases"] = std::move(cases);
  return report;
}

Result<Report> fit(const Options& options, Progress& progress) {
  const auto shared = shared_of(options);
  if (!shared) return fail(shared.error());
  auto report = !options.image.empty() ? fit_image(options, *shared, progress)
                : !is_mesh_name(options.out)
                    ? fit_many(options, *shared, progress)
                    : fit_case(options, *shared, options.cases().front(), options.out, progress);
  if (!report) return report;
  const auto warnings = template_warnings(*shared->the_template);
  report->warnings.insert(report->warnings.begin(), warnings.begin(), warnings.end());
  return report;
}

/// Refuses options that were given and do nothing for what is fitted to.
void check_effect(const Options& options, const CLI::App& verb) {
  const bool image = !options.image.empty();
  if (image) {
    refuse_without_effect(verb, "--partial", "label maps and surfaces");
    refuse_without_effect(verb, "--orientation", "label maps and surfaces");
    if (!options.placement.empty()) refuse_without_effect(verb, "--landmarks", "a fit without --placement");
    return;
  }
  for (const char* name : {"--reach-mm", "--strength", "--polarity", "--done"})
    refuse_without_effect(verb, name, "an --image");
  if (options.to_meshes()) refuse_without_effect(verb, "--frame", "images and label maps");
  if (!options.placement.empty() && !options.partial)
    refuse_without_effect(verb, "--orientation", "a fit without --placement");
}

void check(const Options& options) {
  const int kinds = !options.masks.empty() + !options.meshes.empty() + !options.image.empty();
  if (kinds != 1) throw CLI::RequiredError("exactly one of --mask, --mesh and --image");
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
  auto options = std::make_shared<Options>();
  CLI::App* verb = add_verb(app, "fit", "Fits a template to label maps, surfaces or an image");
  verb->add_option("TEMPLATE", options->template_source, template_sources())->required();
  auto* mask = verb->add_option("--mask", options->masks,
                                "The label map to fit to. Several, or a folder of them, go into a folder");
  verb->add_option("--mesh", options->meshes, "The surface to fit to. Several, or a folder of them, go into a folder")
      ->excludes(mask);
  verb->add_option("--image", options->image, "The grey-value image to fit to; needs --placement or --landmarks");
  keeps_correspondence(
      verb->add_option(
              "-o,--output", options->out,
              "The mesh to write, or a folder: it gets for each case its mesh and a case on its label map, and "
              "a study of all")
          ->required(),
      true);
  add_label_option(*verb, options->labels, "Which label of the mask, where it holds several; 1,2: both together")
      ->needs(mask);
  add_ball_option(*verb, "--closing-mm", options->closing_mm, "Clefts narrower than twice this radius (mm) are filled")
      ->needs(mask);
  verb->add_option(
          "--parts", options->parts,
          "Of a label in several parts: largest, or of those of about one size the one most like the template; "
          "or all of them")
      ->check(CLI::IsMember({"largest", "all"}))
      ->needs(mask)
      ->capture_default_str();
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
  verb->add_flag("--partial", options->partial,
                 "Parts of the organ may be missing: they are found, left to the template's shape or the model's, and "
                 "marked as outlier in the mesh");
  verb->add_option("--by-others", options->by_others,
                   "By way of how many other cases each is fitted again, so that their spread tells where it is in "
                   "doubt; each takes as long as the fit")
      ->check(CLI::Range(0, 100))
      ->capture_default_str();
  verb->add_flag("--mirror", options->mirror, "Use the template of the other side (left for right)");
  verb->callback([options, verb, &asked] {
    if (verb->count("--frame") > 0) options->frame = options->snap.frame;
    bool masks = false, meshes = false;
    options->masks = with_folders_opened(options->masks, volumes_in, masks);
    options->meshes = with_folders_opened(options->meshes, surfaces_in, meshes);
    options->of_folder = masks || meshes;
    check(*options);
    check_effect(*options, *verb);
    asked.run = [options](Progress& progress) { return fit(*options, progress); };
  });
}

}  // namespace homolog
