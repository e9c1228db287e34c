#include "app/editor/model_help.h"

#include <utility>

#include "core/model/conditional.h"

namespace homolog {

namespace {

/// How far a confirmed landmark may be off, a coordinate.
constexpr double confirmed_noise_mm = 0.5;
constexpr double share_kept = 0.99;

/// The model of all shapes but one; of all where `left_out` is −1. Errors: too few are left.
Result<ShapeModel> model_without(const StudyModel& study, std::ptrdiff_t left_out) {
  const Eigen::Index count = std::ssize(study.shapes) - (left_out < 0 ? 0 : 1);
  if (count < 2) return fail("", "The model needs at least two other cases of this template.");
  ShapeMatrix shapes(3 * study.landmarks(), count);
  Eigen::Index column = 0;
  for (std::ptrdiff_t k = 0; k < std::ssize(study.shapes); ++k) {
    if (k == left_out) continue;
    const Points& points = *study.shapes[static_cast<std::size_t>(k)];
    shapes.col(column++) = Eigen::Map<const Eigen::VectorXd>(points.data(), points.size());
  }
  return make_model(principal_components(std::move(shapes)), share_kept, study.topology, {});
}

Result<Points> completed_by(const StudyModel& study, std::ptrdiff_t left_out, const Document& document) {
  const auto model = model_without(study, left_out);
  if (!model) return fail(model.error());
  const Shape& shape = document.shape();
  const Eigen::Index landmarks = shape.points->rows();
  const VertexScalars known = shape.confirmed ? *shape.confirmed : VertexScalars(VertexScalars::Zero(landmarks));
  ShapeSolver solver(document.reference->topology);
  const VertexScalars stiffness = document.stiffness_base * *document.stiffness;
  auto done = completed(*model, *shape.points, known, confirmed_noise_mm, 1, stiffness, solver);
  if (!done) return fail(done.error());
  return std::move(done->points);
}

}  // namespace

void ModelHelp::ask(std::shared_ptr<const Document> document, std::shared_ptr<const StudyModel> model,
                    const std::string& name) {
  if (document_ == document && model_ == model) return;
  document_ = document;
  model_ = model;
  completed_.reset();
  work_.start([document = std::move(document), model = std::move(model), name](Progress&) {
    return completed_by(*model, model->index_of(name), *document);
  });
}

std::shared_ptr<const Points> ModelHelp::at(double strength) const {
  if (!completed_) return nullptr;
  const Points& now = *document_->shape().points;
  return std::make_shared<const Points>(now + strength * (*completed_ - now));
}

std::optional<std::string> ModelHelp::update() {
  auto done = work_.take();
  if (!done) return std::nullopt;
  if (!*done) return done->error().sentence();
  completed_ = std::make_shared<const Points>(std::move(**done));
  return std::nullopt;
}

}  // namespace homolog
