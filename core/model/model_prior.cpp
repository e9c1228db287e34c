#include "core/model/model_prior.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <string>
#include <vector>

#include "core/base/files/file_stem.h"
#include "core/model/conditional.h"

namespace homolog {

namespace {

constexpr double independent = 200;     ///< so many vertices' worth a boundary says: neighbours say the same
constexpr double across_factor = 5;     ///< times the noise: where along the surface a vertex belongs is hardly known
constexpr Eigen::Index pose_modes = 7;  ///< the modes that with_pose appends

/// The model moved by a similarity.
ShapeModel moved(ShapeModel model, const Similarity& by) {
  const Points mean = by.apply(Points(points_of(model.mean)));
  model.mean = Eigen::Map<const Eigen::VectorXd>(mean.data(), mean.size());
  const Mat3 turn = by.rotation.toRotationMatrix();
  for (Eigen::Index row = 0; row < model.basis.rows(); row += 3)
    model.basis.middleRows(row, 3) = (turn * model.basis.middleRows(row, 3)).eval();
  model.variances *= by.scale * by.scale;
  model.noise_variance *= by.scale * by.scale;
  return model;
}

/// Least squares with the prior b ~ N(0, λ), in units of √λ; the noise along a normal and across it differ.
Eigen::VectorXd nearest_coefficients(const ShapeModel& posed, const Points& targets, const Points& normals,
                                     const VertexScalars& weights, double noise) {
  const Eigen::Index modes = posed.modes();
  const Eigen::VectorXd deviation = posed.variances.cwiseSqrt();
  const double repeated = std::max(1.0, static_cast<double>(targets.rows()) / independent);
  const double along = 1 / (noise * noise * repeated), across = along / (across_factor * across_factor);
  // Each vertex in its own axes, the normal's row apart: W^½ (I + (√(along/across) − 1) n nᵀ).
  const double lift = std::sqrt(along / across) - 1;
  Eigen::MatrixXd seen(posed.basis.rows(), modes);
  Eigen::VectorXd wanted(posed.basis.rows());
  for (Eigen::Index i = 0; i < targets.rows(); ++i) {
    const Vec3 normal = normals.row(i);
    const Mat3 axes = std::sqrt(weights[i] * across) * (Mat3::Identity() + lift * normal * normal.transpose());
    seen.middleRows(3 * i, 3) = axes * posed.basis.middleRows(3 * i, 3) * deviation.asDiagonal();
    wanted.segment(3 * i, 3) = axes * (targets.row(i).transpose() - posed.mean.segment(3 * i, 3));
  }
  Eigen::MatrixXd precision = Eigen::MatrixXd::Identity(modes, modes);
  precision.noalias() += seen.transpose() * seen;
  return deviation.cwiseProduct(precision.llt().solve(seen.transpose() * wanted));
}

}  // namespace

namespace {

bool has_numbering(const ShapeModel& model, const StructurePart& part, const Template& the_template) {
  if (part.vertices != the_template.points.rows()) return false;
  return !model.topology || triangles_of(part, model.topology->triangles()) == the_template.topology->triangles();
}

/// The model of the structure that a template is of.
Result<ShapeModel> model_for(const ShapeModel& model, const Template& the_template) {
  std::vector<const StructurePart*> fitting;
  for (const StructurePart& part : model.parts)
    if (has_numbering(model, part, the_template)) fitting.push_back(&part);
  const StructurePart* named = part_named(model.parts, file_stem(the_template.source));
  if (named != nullptr && std::ranges::find(fitting, named) != fitting.end()) return part_of(model, *named);
  if (fitting.size() > 1)
    return fail("", "has several structures of the template's numbering, such as " + fitting[0]->name + " and " +
                        fitting[1]->name + "; give the template's file the name of its structure");
  if (fitting.empty()) return fail("", "has no structure of the template's numbering");
  return part_of(model, *fitting.front());
}

}  // namespace

Result<AllowedShapes> allowed_by(const ShapeModel& model, const Template& the_template, double limit) {
  if (!model.parts.empty() && model.mean.size() / 3 != the_template.points.rows()) {
    const auto alone = model_for(model, the_template);
    if (!alone) return fail(alone.error());
    return allowed_by(*alone, the_template, limit);
  }
  const Eigen::Index vertices = model.mean.size() / 3;
  if (vertices != the_template.points.rows())
    return fail("", "has " + std::to_string(vertices) + " vertices where the template has " +
                        std::to_string(the_template.points.rows()) + "; both must have one numbering");
  if (model.topology && model.topology->triangles() != the_template.topology->triangles())
    return fail("", "has other faces than the template; both must have one numbering");
  const Similarity to_template = nearest_similarity(Points(points_of(model.mean)), the_template.points, Similarity{});
  auto shapes = std::make_shared<const ShapeModel>(moved(model, to_template));
  auto posed = std::make_shared<const ShapeModel>(with_pose(*shapes));
  AllowedShapes allowed;
  allowed.mean = points_of(shapes->mean);
  allowed.nearest = [shapes, posed, limit](const Points& targets, const Points& normals, const VertexScalars& weights,
                                           double noise) {
    Eigen::VectorXd b = nearest_coefficients(*posed, targets, normals, weights, noise);
    const Eigen::VectorXd own = clamped(*shapes, b.head(shapes->modes()), limit);
    b.head(shapes->modes()) = own;
    return AllowedShape{shape_of(*shapes, own), shape_of(*posed, b)};
  };
  return allowed;
}

}  // namespace homolog
