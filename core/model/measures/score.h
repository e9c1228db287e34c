#pragma once

#include <optional>
#include <vector>

#include "core/mesh/mesh_io.h"
#include "core/model/shape_model.h"

namespace homolog {

/// How one structure of a shape stands.
struct ScoreOfPart {
  double z_rms = 0;        ///< root mean square of z over its vertices
  double residual_mm = 0;  ///< root mean square distance of its vertices from what the modes make
};

/// How a shape stands against a model, which it does not change.
struct ShapeScore {
  Points aligned;          ///< n×3, where the model's shapes lie
  Eigen::VectorXd modes;   ///< t coordinates, in standard deviations of their modes
  double distance = 0;     ///< √Σ modes²: the Mahalanobis distance within the model
  double residual_mm = 0;  ///< beyond the model: root mean square distance of the vertices from what the modes make
  double size_mm = 0;      ///< centroid size before it was aligned
  /// 0…100: how many of the training shapes, each left out in turn, lie nearer to the mean. None: too few of them are
  /// in the model's file.
  std::optional<double> percentile;
  /// n: how far each vertex lies outside of the mean along its normal, in standard deviations of the training shapes;
  /// below 0 within. `low`, `high`: its interval of 95 %, by the number of training shapes and by the doubt.
  VertexScalars z, z_low, z_high;
  /// Which of the model's training shapes it is itself, by its coefficients; none: another, or their coefficients are
  /// not in the model's file.
  std::optional<Eigen::Index> trained;
  ScoreOfPart all;
  std::vector<ScoreOfPart> parts;  ///< scores of a joint model's parts, in its order
};

/// Scores a shape of the model's numbering (n×3, mm), brought to the mean as the model's shapes were. `doubt_mm`: n, of
/// a fit, or empty; it is scaled as its shape is. A vertex in doubt says less: it weighs 1 / (1 + (doubt / spread)²) in
/// the coordinates, and its z is counted in the spread and the doubt together. The result depends on this shape and the
/// model alone. Errors: another number of vertices, a model without modes or faces.
Result<ShapeScore> score_shape(const ShapeModel& model, const Points& shape, const VertexScalars& doubt_mm = {});

/// Errors: faces of a mesh that are not the model's, so that the same number of vertices means nothing. Turned inside
/// out they are the same; points alone may be any.
Result<void> check_faces(const ShapeModel& model, const MeshFile& mesh);

}  // namespace homolog
