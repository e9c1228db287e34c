#include "app/lab/schemes.h"

#include <algorithm>
#include <cmath>

#include "core/assist/assist.h"
#include "core/deform/fold_guard.h"
#include "core/measure/compare.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/mesh/voxels/label_map.h"

namespace homolog {

namespace {

constexpr double near_mm = 1, near_dice = 0.95;
constexpr std::string_view refined = "+refine";  // at the end of a scheme's name

/// Mean distance from where landmarks or vertices are known to belong.
std::optional<double> landmark_error(const Document& document, const ExperimentSubject& subject) {
  const Points& points = *document.view()->shape.points;
  if (subject.truth) return (points - *subject.truth).rowwise().norm().mean();
  const Template& the_template = *document.structure()->the_template;
  double sum = 0;
  int known = 0;
  for (const Landmark& landmark : subject.hidden) {
    for (std::size_t k = 0; k < the_template.landmarks.size(); ++k) {
      if (the_template.landmarks[k].name != landmark.name) continue;
      sum += (carried_landmark(the_template, k, points) - landmark.position).norm();
      ++known;
    }
  }
  return known > 0 ? std::optional(sum / known) : std::nullopt;
}

double edge_spread(const Topology& topology, const Points& the_template, const Points& points) {
  Eigen::ArrayXd ratios(static_cast<Eigen::Index>(topology.edges().size()));
  Eigen::Index k = 0;
  for (const auto& [a, b] : topology.edges())
    ratios[k++] = (points.row(a) - points.row(b)).norm() / (the_template.row(a) - the_template.row(b)).norm();
  return std::sqrt((ratios - ratios.mean()).square().mean()) / ratios.mean();
}

Agreement agreement_with(const EditSession& session, const Mesh& target) {
  return compare_meshes(capped(session.document().view()->mesh()), target);
}

Result<void> set_up(EditSession& session, const WorkingScheme& scheme) {
  if (auto done = session.apply(SetScheme{scheme.scheme, scheme.paper_events}); !done) return fail(done.error());
  if (auto done = session.apply(SetEvenSpacing{scheme.even_spacing}); !done) return fail(done.error());
  return {};
}

Result<int> show_landmarks(EditSession& session, const std::vector<Landmark>& features, LandmarkUse use) {
  if (use == LandmarkUse::none) return 0;
  if (use == LandmarkUse::grab) return grab_landmarks(session, features);
  const auto clicked = click_landmarks(session, features);
  if (!clicked || use == LandmarkUse::warp) return clicked;
  if (auto held = confirm_landmarks(session, features); !held) return fail(held.error());
  return 2 * *clicked;
}

Result<void> adapt_without_hand(EditSession& session, const Mesh& target, Adaptation adaptation, Progress* progress) {
  const Document& document = session.document();
  SetPoints result;
  if (adaptation == Adaptation::projection) {
    result = points_edit(*document.view(), closest_places(target, *document.view()->shape.points), FoundBy::projection,
                         document.view()->shape.placement);
  } else {
    FitOptions options;
    options.progress = progress;
    auto fit = fit_shape(*document.view(), mesh_boundary(target), true, options);
    if (!fit) return fail(fit.error());
    result = std::move(fit->action);
  }
  auto done = session.apply(result);
  return done ? Result<void>{} : fail(done.error());
}

void measure(const EditSession& session, const ExperimentSubject& subject, SchemeRun& run) {
  const Document& document = session.document();
  const Agreement agreement = agreement_with(session, subject.target);
  run.assd = agreement.assd_mm;
  run.hd95 = agreement.hd95_mm;
  run.dice = agreement.dice;
  run.landmarks = landmark_error(document, subject);
  const Topology& topology = *document.structure()->the_template->topology;
  const Shape& shape = document.view()->shape;
  run.points = *shape.points;
  run.edge_spread = edge_spread(topology, *shape.placed, run.points);
  run.turned_triangles = turned_triangles(topology, *shape.placed, run.points).size();
  const Mesh mesh = document.view()->mesh();
  run.min_angle_deg = 180;
  for (Eigen::Index f = 0; f < topology.triangles().rows(); ++f)
    run.min_angle_deg = std::min(run.min_angle_deg, smallest_angle_deg(mesh, f));
}

}  // namespace

Result<WorkingScheme> working_scheme(const std::string& name) {
  WorkingScheme made;
  made.name = name;
  made.refine = name.ends_with(refined);
  const std::string before = name.substr(0, name.size() - (made.refine ? refined.size() : 0));
  const auto plus = before.find('+');
  const std::string moving = before.substr(0, plus), features = plus == std::string::npos ? "" : before.substr(plus);
  bool known = true;
  if (moving == "fit")
    made.adaptation = Adaptation::fit;
  else if (moving == "projection")
    made.adaptation = Adaptation::projection;
  else if (moving == "raw")
    made.scheme = Scheme::raw;
  else if (moving == "paper-1" || moving == "paper-10") {
    made.scheme = Scheme::paper;
    made.paper_events = moving == "paper-1" ? 1 : 10;
  } else if (moving == "spacing")
    made.even_spacing = 1;
  else
    known = moving == "anchored";
  if (made.adaptation == Adaptation::projection)
    known = features.empty();
  else if (made.adaptation == Adaptation::fit && features != "+warp")
    known = features.empty();
  else if (features == "+grab")
    made.features = LandmarkUse::grab;
  else if (features == "+warp")
    made.features = LandmarkUse::warp;
  else if (features == "+hold")
    made.features = LandmarkUse::hold;
  else
    known = known && features.empty();
  if (made.refine) known = known && made.adaptation == Adaptation::pulls;
  if (!known)
    return fail(
        name,
        "is no scheme; choose raw, paper-1, paper-10, anchored or spacing, alone or with +grab, +warp or +hold, each "
        "also with +refine; fit, alone or with +warp; or projection");
  return made;
}

std::vector<std::string> compared_schemes(bool with_features) {
  const std::vector<std::string> moving{"raw", "paper-1", "paper-10", "anchored", "spacing"};
  std::vector<std::string> names;
  if (with_features) {
    names.emplace_back("anchored");
    for (const char* features : {"+grab", "+warp"})
      for (const std::string& one : moving) names.push_back(one + features);
    names.insert(names.end(), {"anchored+hold", "anchored+warp+refine", "fit", "fit+warp"});
  } else {
    names = moving;
    names.insert(names.end(), {"anchored+refine", "fit", "projection"});
  }
  return names;
}

std::string default_scheme(bool with_features) {
  return pulling_scheme(with_features) + std::string(refined);
}

std::string pulling_scheme(bool with_features) {
  return with_features ? "anchored+warp" : "anchored";
}

ExperimentSubject phantom_experiment_subject(Organ organ, int number) {
  const MeshFile made = phantom_truth(organ, number).front();
  const Mesh truth{Topology::make(made.points.rows(), made.triangles).value(), made.points};
  VolumeGeometry grid;
  const Box box = bounds_of(made.points);
  grid.origin_mm = box.min() - Vec3::Constant(4);
  for (int axis = 0; axis < 3; ++axis) grid.dims[axis] = static_cast<int>(std::ceil(box.sizes()[axis])) + 9;
  ExperimentSubject subject;
  subject.name = std::string(organ_name(organ)) + "-" + std::to_string(number);
  subject.target = mask_surface(label_map(truth, grid), 1).value();
  subject.visible_mm = grid.spacing_mm.maxCoeff();
  subject.shown = made.landmarks;
  subject.truth = made.points;
  return subject;
}

Result<SchemeRun> run_scheme(EditSession& session, const ExperimentSubject& subject, const WorkingScheme& scheme,
                             const SchemeRunOptions& options) {
  SchemeRun run;
  if (auto done = set_up(session, scheme); !done) return fail(done.error());
  if (auto done = place_on(session, subject.target); !done) return fail(done.error());
  if (options.seed)
    if (auto done = disturb_placement(session, *options.seed); !done) return fail(done.error());
  run.assd_placed = agreement_with(session, subject.target).assd_mm;
  run.landmarks_placed = landmark_error(session.document(), subject);

  const auto strokes = show_landmarks(session, subject.shown, scheme.features);
  if (!strokes) return fail(strokes.error());
  run.feature_strokes = *strokes;
  run.landmarks_after_features = landmark_error(session.document(), subject);

  const auto note_when_near = [&](int pulls) {
    const Agreement agreement = agreement_with(session, subject.target);
    if (agreement.assd_mm <= near_mm && agreement.dice >= near_dice) run.pulls_to_1mm = pulls;
  };
  if (scheme.adaptation != Adaptation::pulls) {
    if (auto done = adapt_without_hand(session, subject.target, scheme.adaptation, options.progress); !done)
      return fail(done.error());
    note_when_near(0);
    measure(session, subject, run);
    return run;
  }
  PullingOptions pulling;
  pulling.visible_mm = subject.visible_mm;
  pulling.most_pulls = options.most_pulls;
  pulling.progress = options.progress;
  pulling.watch = [&](int pulls, const std::vector<Deviation>& seen) {
    // The exact distance takes long to compute. While the mesh is far from 1 mm, what the user sees is enough.
    if (!run.pulls_to_1mm && mean_mm(seen) < 1.2 * near_mm) note_when_near(pulls);
  };
  note_when_near(0);
  const auto pulled = pull_to_target(session, subject.target, pulling);
  if (!pulled) return fail(pulled.error());
  run.pulls = pulled->pulls;
  if (scheme.refine) {
    auto refinement = refine_shape(*session.document().view(), options.progress);
    if (!refinement) return fail(refinement.error());
    if (auto done = session.apply(std::move(refinement->action)); !done) return fail(done.error());
  }
  measure(session, subject, run);
  return run;
}

}  // namespace homolog
