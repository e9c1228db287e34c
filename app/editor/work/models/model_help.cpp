#include "app/editor/work/models/model_help.h"

#include <utility>

#include "app/editor/work/models/build_study_model.h"
#include "core/base/numbers/index.h"
#include "core/model/conditional.h"
#include "core/model/measures/leave_one_out.h"

namespace homolog {

namespace {

/// How far a known vertex may be off, in each coordinate.
constexpr double known_noise_mm = 2;
constexpr double share_kept = 0.99;

ShapeModel with_distances(ShapeModel model, const PrincipalComponents& components) {
  model.left_out_distances = left_out_distances(components, model.modes());
  return model;
}

Result<PrincipalComponents> components_without(const StudyModel& study, std::ptrdiff_t left_out) {
  const Eigen::Index count = std::ssize(study.names) - (left_out < 0 ? 0 : 1);
  if (count < 2) return fail("", "The model needs at least two other cases of this template.");
  ShapeMatrix shapes(3 * study.vertices(), count);
  Eigen::Index column = 0;
  for (std::ptrdiff_t k = 0; k < std::ssize(study.names); ++k) {
    if (k == left_out) continue;
    const Points points = study.shape(index(k));
    const double size_mm = centroid_size_mm(points);
    const double own_size = size_mm > 0 ? study.sizes_mm[k] / size_mm : 1;
    shapes.col(column++) = own_size * Eigen::Map<const Eigen::VectorXd>(points.data(), points.size());
  }
  align(shapes, study.alignment);  // the one that is left out has no part in where the others lie
  return principal_components(std::move(shapes));
}

}  // namespace

Result<ShapeModel> model_without(const StudyModel& study, std::ptrdiff_t left_out) {
  return components_without(study, left_out).map([&](const PrincipalComponents& components) {
    return make_model(components, share_kept, study.topology, {});
  });
}

Result<ShapeModel> model_of_others(const StudyModel& study, std::ptrdiff_t left_out) {
  if (left_out < 0) return with_distances(study.model, *study.components);
  const auto components = components_without(study, left_out);
  if (!components) return fail(components.error());
  ShapeModel model = make_model(*components, share_of_variance, study.topology, {});
  model.alignment = study.alignment;
  model.faced = study.model.faced;
  return with_distances(std::move(model), *components);
}

/// The model with the solver that it completes shapes by. The solver belongs to the session's thread.
struct ModelHelp::Completer {
  ShapeModel model;      ///< with_pose
  bool flipped = false;  ///< the case has the other side, and the study holds it flipped
  std::optional<ShapeSolver> solver{};

  Result<std::optional<Action>> complete(const Document& document, const std::string& of, double strength) {
    const auto shown = document.view(of);
    if (!shown) return std::optional<Action>();
    const auto& topology = shown->the_template().topology;
    if (!solver || solver->topology() != topology) solver.emplace(topology);
    const Shape& shape = shown->shape;
    const VertexScalars stiffness = shown->paint().base * *shown->paint().stiffness;
    Points unaided = unaided_points(shape);
    if (flipped) unaided.col(0) *= -1;
    auto done = completed(model, unaided, known_vertices(shape), known_noise_mm, strength, stiffness, *solver);
    if (!done) return fail(done.error());
    if (flipped) done->points.col(0) *= -1;
    return std::optional<Action>(points_edit(*shown, done->points, FoundBy::model));
  }
};

void ModelHelp::ask(std::shared_ptr<const StudyModel> study, const std::string& name, bool flipped) {
  if (study_ == study && name_ == name && flipped_ == flipped) return;
  study_ = study;
  name_ = name;
  flipped_ = flipped;
  completer_.reset();
  work_.start("The model of the other cases", [study = std::move(study), name](Progress&) {
    return model_without(*study, study->index_of(name)).map(with_pose);
  });
}

Compute ModelHelp::completion(double strength) const {
  if (!completer_ || !(strength > 0)) return {};
  return [completer = completer_, strength](const Document& document, const std::string& of) {
    return completer->complete(document, of, strength);
  };
}

std::optional<std::string> ModelHelp::update() {
  auto done = work_.take();
  if (!done) return std::nullopt;
  if (!*done) return done->error().sentence();
  completer_ = std::make_shared<Completer>(Completer{std::move(**done), flipped_});
  return std::nullopt;
}

}  // namespace homolog
