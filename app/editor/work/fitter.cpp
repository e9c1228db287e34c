#include "app/editor/work/fitter.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

#include "app/editor/state/label_map_layer.h"
#include "app/editor/work/models/model_help.h"
#include "core/adapt/labels/label_fit.h"
#include "core/assist/assist.h"
#include "core/mesh/construction/mirror.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/model/model_prior.h"

namespace homolog {

namespace {

/// The model mirrored left for right. A template of the other side has its faces turned too.
ShapeModel of_other_side(ShapeModel model, const Topology& of_template) {
  for (Eigen::Index row = 0; row < model.mean.size(); row += 3) {
    model.mean[row] *= -1;
    model.basis.row(row) *= -1;
  }
  if (model.topology && turned_faces(model.topology->triangles(), of_template.triangles()))
    if (auto turned = Topology::make(of_template.vertices(), of_template.triangles())) model.topology = *turned;
  return model;
}

/// The shapes that a fit of this template keeps to at first; null where it keeps to none.
Result<std::shared_ptr<const AllowedShapes>> allowed_shapes(const Template& the_template, const ModelOfFit& of_fit,
                                                            double beyond) {
  if (!of_fit.model && !of_fit.study) return nullptr;
  auto model = of_fit.model ? Result<ShapeModel>(*of_fit.model)
                            : model_without(*of_fit.study, of_fit.study->index_of(of_fit.left_out));
  if (!model) return fail(model.error());
  if (!of_fit.model && of_fit.flipped) *model = of_other_side(std::move(*model), *the_template.topology);
  auto allowed = allowed_by(*model, the_template);
  if (!allowed) return fail("The model", allowed.error().what);
  allowed->beyond = beyond;
  return std::make_shared<const AllowedShapes>(std::move(*allowed));
}

/// What a person may want to know of a fit beside its figures.
std::vector<std::string> remarks_on_fit(const LabelFit& fitted, bool partial) {
  std::vector<std::string> remarks;
  const auto add = [&](const char* format, double first, double second) {
    char remark[200];
    std::snprintf(remark, sizeof remark, format, first, second);
    remarks.emplace_back(remark);
  };
  if (fitted.widened)
    add("Clefts were closed by %.2f mm, since the fit was doubtful with %.2f mm.", fitted.closing_mm,
        fitted.tried.front().closing_mm);
  const FitResult& fit = fitted.fit;
  if (fit.allowed.size() > 0)
    add("The model alone comes within %.2f mm of the label. The mesh lies %.2f mm beyond it on average.",
        mean_surface_distance_mm({fit.mesh.topology, fit.allowed}, fitted.boundary.surface),
        (fit.mesh.points - fit.allowed).rowwise().norm().mean());
  if (fitted.judgement.beyond_share > 0 && !partial) {
    char remark[160];
    std::snprintf(
        remark, sizeof remark,
        "%.0f %% of the mesh lies beyond the scan, where it follows the template. The figures are of the rest.",
        100 * fitted.judgement.beyond_share);
    remarks.emplace_back(remark);
  }
  return remarks;
}

Result<Fitted> refined(const Document& document, const std::string& of, Progress& progress) {
  const auto shown = shape_to("refine", document, of);
  if (!shown) return fail(shown.error());
  auto refinement = refine_shape(*shown, &progress);
  if (!refinement) return fail(refinement.error());
  Fitted done;
  done.edit = std::move(refinement->action);
  const auto moved_mm = (*done.edit.points - *shown->shape.points).rowwise().norm();
  const auto off = surface_distance({shown->the_template().topology, *done.edit.points}, shown->mesh());
  const auto smallest_deg = [&](const Points& points) {
    const Mesh mesh{shown->the_template().topology, points};
    double least = 180;
    for (Eigen::Index face = 0; face < mesh.topology->triangles().rows(); ++face)
      least = std::min(least, smallest_angle_deg(mesh, face));
    return least;
  };
  char remark[300];
  std::snprintf(remark, sizeof remark,
                "Refined: vertices moved along the surface by %.2f mm on average, at most %.1f mm. The smallest angle "
                "was %.1f\xc2\xb0 and is %.1f\xc2\xb0. The surface moved at most %.2f mm.",
                moved_mm.mean(), moved_mm.maxCoeff(), smallest_deg(*shown->shape.points),
                smallest_deg(*done.edit.points), off.max_mm);
  done.figures.remarks = std::move(refinement->warnings);
  done.figures.remarks.emplace_back(remark);
  return done;
}

}  // namespace

int label_at_mesh(const Volume& labels, int frame, const Points& points) {
  constexpr Eigen::Index most_samples = 2000;
  const Eigen::Index step = std::max<Eigen::Index>(1, points.rows() / most_samples);
  const Eigen::RowVector3d middle = points.colwise().mean();
  std::map<int, int> votes;
  for (Eigen::Index i = 0; i < points.rows(); i += step) {
    const Vec3 at = ((points.row(i) + middle) / 2).transpose();
    const Vec3 voxel = labels.geometry.to_voxel(at).array().round();
    const auto& dims = labels.geometry.dims;
    bool inside = true;
    for (int axis = 0; axis < 3; ++axis) inside = inside && voxel[axis] >= 0 && voxel[axis] < dims[axis];
    if (!inside) continue;
    const int value = rounded_label(labels.at(static_cast<int>(voxel.x()), static_cast<int>(voxel.y()),
                                              static_cast<int>(voxel.z()), frame_of_map(labels, frame)));
    if (value != 0) ++votes[value];
  }
  int best = 0, most = 0;
  for (const auto& [label, count] : votes)
    if (count > most) best = label, most = count;
  return best;
}

Result<Fitted> fit_to_labels(const ShapeView& shown, const NamedLabels& labels, const FitSettings& settings,
                             const ModelOfFit& model, FitOptions options) {
  const Template& the_template = shown.the_template();
  auto allowed = allowed_shapes(the_template, model, settings.beyond);
  if (!allowed) return fail(allowed.error());
  options.allowed = *allowed;
  options.partial = settings.partial;
  options.landmarks = shown.shape.landmarks;
  if (settings.as_placed) options.placement = shown.shape.placement;
  const LabelFitOptions how{.closing_mm = settings.closing_mm,
                            .kept_closing_mm = closing_kept_with(the_template.source)};
  const auto fitted = fit_to_label(the_template,
                                   {*labels.volume, settings.all_labels ? every_label : settings.label,
                                    frame_of_map(*labels.volume, shown.frame), labels.known},
                                   how, options);
  if (!fitted) return fail(labels.name, fitted.error().what);
  Fitted done;
  done.edit = edit_of_fit(shown, fitted->fit, settings.partial);
  done.figures = figures_of_fit(fitted->judgement, fitted->fit, settings.partial);
  done.figures.mesh = mesh_hash(*done.edit.points);
  done.doubtful = fitted->judgement.doubtful;
  for (std::string& remark : remarks_on_fit(*fitted, settings.partial))
    done.figures.remarks.push_back(std::move(remark));
  return done;
}

void Fitter::start_fit(std::shared_ptr<const Document> document, NamedLabels labels, const FitSettings& settings,
                       const ModelOfFit& model, std::string of) {
  document_ = document;
  of_ = of;
  refining_ = false;
  steps_ = std::make_shared<Steps>();
  work_.start(labels.name, [=, steps = steps_, wake = wake_](Progress& progress) {
    FitOptions options;
    options.progress = &progress;
    options.show = [&](const Points& points) {
      steps->put(std::make_shared<const Points>(points));
      wake();
    };
    const auto shown = shape_to("fit", *document, of);
    return shown ? fit_to_labels(*shown, labels, settings, model, options) : fail(shown.error());
  });
}

void Fitter::start_refinement(std::shared_ptr<const Document> document, std::string of) {
  document_ = document;
  of_ = of;
  refining_ = true;
  steps_ = std::make_shared<Steps>();
  work_.start("The refinement", [=](Progress& progress) { return refined(*document, of, progress); });
}

void Fitter::cancel() {
  work_.cancel();
  document_.reset();
  steps_ = std::make_shared<Steps>();
}

std::shared_ptr<const Points> Fitter::take_step() {
  return steps_->take().value_or(nullptr);
}

std::optional<Result<Fitted>> Fitter::take() {
  auto done = work_.take();
  if (done) document_.reset();
  return done;
}

}  // namespace homolog
