#include "core/model/measures/score.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/mesh/construction/mirror.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

/// The rows of a structure in an n×3 shape.
auto rows_of_part(const Points& points, const StructurePart& part) {
  return points.middleRows(part.first_vertex, part.vertices);
}

/// The centroid size to which the training shapes of a part were brought, mm. It is larger than the mean's, which has
/// lost what they vary by.
double trained_size_mm(const ShapeModel& model, const Points& mean, Eigen::Index first_vertex) {
  const auto shapes = static_cast<double>(model.scores.cols());
  double varied = model.noise_variance * static_cast<double>(mean.size());
  for (Eigen::Index k = 0; k < model.modes(); ++k)
    varied += model.variances[k] * model.basis.col(k).segment(3 * first_vertex, mean.size()).squaredNorm();
  const double size = centroid_size_mm(mean);
  return std::sqrt(size * size + varied * (shapes > 1 ? (shapes - 1) / shapes : 1));
}

/// A shape of a part brought to its mean as the training shapes were.
Points part_as_trained(const ShapeModel& model, const Points& shape, const Points& mean, Eigen::Index first_vertex,
                       Alignment alignment) {
  Points aligned = aligned_to(shape, mean, alignment);
  if (alignment != Alignment::similarity) return aligned;
  const double size = centroid_size_mm(aligned);
  if (!(size > 0)) return aligned;
  const Eigen::RowVector3d middle = aligned.colwise().mean();
  aligned = (aligned.rowwise() - middle) * (trained_size_mm(model, mean, first_vertex) / size);
  return aligned.rowwise() + middle;
}

/// A shape brought to the mean as the training shapes were.
Points aligned_as_trained(const ShapeModel& model, const Points& shape) {
  const Alignment alignment = model.alignment.value_or(Alignment::similarity);
  const Points mean = points_of(model.mean);
  if (alignment == Alignment::none) return shape;
  if (!model.poses || !model.poses->apart) return part_as_trained(model, shape, mean, 0, alignment);
  Points aligned(shape.rows(), 3);
  for (const StructurePart& part : model.parts) {
    const Points target = rows_of_part(mean, part);
    Points own = part_as_trained(model, rows_of_part(shape, part), target, part.first_vertex, alignment);
    // Each lies in its mean place.
    const Vec3 to = target.colwise().mean(), from = own.colwise().mean();
    aligned.middleRows(part.first_vertex, part.vertices) = own.rowwise() + (to - from).transpose();
  }
  return aligned;
}

/// n: doubts of a shape, mm, as large as they are where the shape is aligned.
VertexScalars doubts_as_aligned(const ShapeModel& model, const Points& shape, const Points& aligned,
                                VertexScalars doubt_mm) {
  if (model.alignment.value_or(Alignment::similarity) != Alignment::similarity) return doubt_mm;
  const auto scale = [&](Eigen::Index first, Eigen::Index count) {
    const double size = centroid_size_mm(shape.middleRows(first, count));
    if (size > 0) doubt_mm.segment(first, count) *= centroid_size_mm(aligned.middleRows(first, count)) / size;
  };
  if (!model.poses || !model.poses->apart)
    scale(0, shape.rows());
  else
    for (const StructurePart& part : model.parts) scale(part.first_vertex, part.vertices);
  return doubt_mm;
}

/// n: the variance of each vertex along a direction, mm², by the modes and beside them.
VertexScalars variances_along(const ShapeModel& model, const Points& directions) {
  VertexScalars variances = VertexScalars::Constant(directions.rows(), model.noise_variance);
  for (Eigen::Index k = 0; k < model.modes(); ++k) {
    const Eigen::Map<const Points> mode(model.basis.col(k).data(), directions.rows(), 3);
    variances += (model.variances[k] * mode.cwiseProduct(directions).rowwise().sum().array().square()).matrix();
  }
  return variances;
}

/// n: the mean variance of each vertex over its coordinates, mm².
VertexScalars mean_variances(const ShapeModel& model) {
  VertexScalars variances = VertexScalars::Constant(model.mean.size() / 3, model.noise_variance);
  for (Eigen::Index k = 0; k < model.modes(); ++k) {
    const Eigen::Map<const Points> mode(model.basis.col(k).data(), variances.size(), 3);
    variances += model.variances[k] / 3 * mode.rowwise().squaredNorm();
  }
  return variances;
}

/// t coefficients, mm: of all vertices alike, or of each by its weight.
Eigen::VectorXd weighed_coefficients(const ShapeModel& model, const Points& aligned, const VertexScalars& weights) {
  if (weights.size() == 0) return coefficients(model, aligned);
  Eigen::VectorXd of_rows(model.mean.size());
  for (Eigen::Index v = 0; v < weights.size(); ++v) of_rows.segment<3>(3 * v).setConstant(weights[v]);
  const Eigen::Map<const Eigen::VectorXd> shape(aligned.data(), aligned.size());
  const Eigen::MatrixXd weighed = of_rows.asDiagonal() * model.basis;
  // What the weights leave open, the model decides.
  Eigen::MatrixXd normal = weighed.transpose() * model.basis;
  const double noise = std::max(model.noise_variance, 1e-9 * model.variances[0]);
  normal.diagonal() += (noise * model.variances.cwiseMax(1e-12 * model.variances[0]).cwiseInverse());
  return normal.ldlt().solve(weighed.transpose() * (shape - model.mean));
}

ScoreOfPart score_of_rows(const VertexScalars& z, const Points& beyond, Eigen::Index first, Eigen::Index count) {
  const auto rows = static_cast<double>(count);
  return {std::sqrt(z.segment(first, count).squaredNorm() / rows),
          std::sqrt(beyond.middleRows(first, count).squaredNorm() / rows)};
}

/// Which training shape has these coefficients (mm). They are equal but for what an alignment to the mean alone is off
/// the alignment of all. One coefficient may be equal by chance.
std::optional<Eigen::Index> training_shape_at(const ShapeModel& model, const Eigen::VectorXd& b) {
  constexpr double equal_share = 5e-4;  // share of the largest mode's deviation
  if (model.scores.rows() != b.size() || b.size() < 2) return std::nullopt;
  const double equal_mm = equal_share * std::sqrt(model.variances[0]);
  for (Eigen::Index k = 0; k < model.scores.cols(); ++k)
    if ((model.scores.col(k) - b).cwiseAbs().maxCoeff() < equal_mm) return k;
  return std::nullopt;
}

}  // namespace

Result<ShapeScore> score_shape(const ShapeModel& model, const Points& shape, const VertexScalars& doubt_mm) {
  if (!model.topology || model.modes() == 0 || model.variances.minCoeff() <= 0)
    return fail("", "is a model without faces or without modes that vary; make one with model of shapes with faces");
  if (3 * shape.rows() != model.mean.size())
    return fail("", "has " + std::to_string(shape.rows()) + " vertices and the model " +
                        std::to_string(model.mean.size() / 3) + "; give a shape of the model's template");
  ShapeScore score;
  score.size_mm = centroid_size_mm(shape);
  if (!(score.size_mm > 0)) return fail("", "has all its vertices in one place, so it is no shape");
  score.aligned = aligned_as_trained(model, shape);
  const bool doubted = doubt_mm.size() == shape.rows() && doubt_mm.maxCoeff() > 0;
  VertexScalars weights, doubts;
  if (doubted) doubts = doubts_as_aligned(model, shape, score.aligned, doubt_mm);
  if (doubted) weights = (1 + doubts.array().square() / mean_variances(model).array()).inverse();
  const Eigen::VectorXd b = weighed_coefficients(model, score.aligned, weights);
  score.modes = b.cwiseQuotient(model.variances.cwiseSqrt());
  score.distance = score.modes.norm();
  score.trained = training_shape_at(model, doubted ? coefficients(model, score.aligned) : b);
  const Points mean = points_of(model.mean), beyond = score.aligned - shape_of(model, b);
  const Points normals = vertex_normals({model.topology, mean});
  const VertexScalars along = (score.aligned - mean).cwiseProduct(normals).rowwise().sum();
  VertexScalars variances = variances_along(model, normals);
  // Where nothing varied among the training shapes a thousandth of the usual spread stands for it.
  constexpr double least_share = 1e-6;
  variances = variances.cwiseMax(least_share * variances.mean());
  if (doubted) variances += doubts.cwiseAbs2();
  score.z = along.cwiseQuotient(variances.cwiseSqrt());
  constexpr double of_95 = 1.96;
  const double shapes = std::max<double>(2, static_cast<double>(model.scores.cols()));
  VertexScalars error = 1 / shapes + score.z.array().square() / (2 * (shapes - 1));
  if (doubted) error += doubts.cwiseAbs2().cwiseQuotient(variances);
  score.z_low = score.z - of_95 * error.cwiseSqrt();
  score.z_high = score.z + of_95 * error.cwiseSqrt();
  score.all = score_of_rows(score.z, beyond, 0, shape.rows());
  score.residual_mm = score.all.residual_mm;
  for (const StructurePart& part : model.parts)
    score.parts.push_back(score_of_rows(score.z, beyond, part.first_vertex, part.vertices));
  if (const Eigen::VectorXd& others = model.left_out_distances; others.size() > 0)
    score.percentile =
        100 * static_cast<double>((others.array() < score.distance).count()) / static_cast<double>(others.size());
  return score;
}

Result<void> check_faces(const ShapeModel& model, const MeshFile& mesh) {
  const Triangles& own = mesh.triangles;
  if (!model.topology || own.rows() == 0 || 3 * mesh.points.rows() != model.mean.size()) return {};
  const Triangles& faces = model.topology->triangles();
  if (same_faces(faces, own) || turned_faces(faces, own)) return {};
  return fail("",
              "has other faces (or another numbering) than the model; make it from the model's template, or give the "
              "label map that it was made of");
}

}  // namespace homolog
