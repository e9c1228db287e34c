#include "core/model/joint_models/joint_alignment.h"

#include <cmath>

#include "core/base/demand.h"
#include "core/base/numbers/rotation.h"
#include "core/model/shape_model.h"
#include "core/placement/relative_pose.h"

namespace homolog {

namespace {

/// One structure of all shapes: its shapes on their own, and where each lies.
struct StructureAligned {
  ShapeMatrix shapes;              ///< 3n×M, centred on the origin
  std::vector<Similarity> places;  ///< each shape's way from its own place to where it lies
  Similarity mean_place;
};

StructureAligned aligned_alone(ShapeMatrix there, Alignment alignment) {
  StructureAligned alone{there, {}, {}};
  align(alone.shapes, alignment);
  for (Eigen::Index s = 0; s < there.cols(); ++s)
    alone.places.push_back(pose_onto(points_of(alone.shapes, s), points_of(there, s), alignment));
  alone.mean_place = mean_similarity(alone.places, Vec3::Zero());
  return alone;
}

/// The seven numbers of a structure [StructurePoses].
Eigen::VectorXd pose_numbers(const Similarity& place, const Similarity& mean) {
  Eigen::VectorXd numbers(StructurePoses::numbers);
  numbers << place.translation - mean.translation, turn_deg_of(place.rotation * mean.rotation.conjugate()),
      std::log(place.scale / mean.scale);
  return numbers;
}

}  // namespace

Similarity pose_onto(const Points& from, const Points& to, Alignment alignment) {
  const Eigen::RowVector3d from_middle = from.colwise().mean(), to_middle = to.colwise().mean();
  const Points a = from.rowwise() - from_middle, b = to.rowwise() - to_middle;
  Similarity pose;
  pose.rotation = Eigen::Quaterniond(nearest_rotation(b.transpose() * a)).normalized();
  if (alignment == Alignment::similarity && a.norm() > 0) pose.scale = b.norm() / a.norm();
  pose.translation = to_middle.transpose() - pose.scale * (pose.rotation * from_middle.transpose());
  return pose;
}

StructurePoses align_structures(ShapeMatrix& shapes, const std::vector<StructurePart>& parts, Alignment alignment,
                                bool each) {
  demand(!each || alignment != Alignment::none,
         "structures cannot be aligned each on its own without an alignment; choose rigid or similarity");
  align(shapes, alignment);
  const Alignment of_each = alignment == Alignment::none ? Alignment::rigid : alignment;
  StructurePoses poses;
  poses.apart = each;
  poses.values.resize(StructurePoses::numbers * std::ssize(parts), shapes.cols());
  poses.radius_mm.resize(std::ssize(parts));
  for (Eigen::Index k = 0; k < std::ssize(parts); ++k) {
    const StructurePart& part = parts[k];
    const StructureAligned alone = aligned_alone(rows_of(part, shapes), of_each);
    const Eigen::VectorXd mean = alone.shapes.rowwise().mean();
    poses.radius_mm[k] = alone.mean_place.scale * mean.norm() / std::sqrt(static_cast<double>(part.vertices));
    for (Eigen::Index s = 0; s < shapes.cols(); ++s) {
      poses.values.block(StructurePoses::numbers * k, s, StructurePoses::numbers, 1) =
          pose_numbers(alone.places[s], alone.mean_place);
      if (!each) continue;
      const Points placed = alone.mean_place.apply(Points(points_of(alone.shapes, s)));
      shapes.block(3 * part.first_vertex, s, 3 * part.vertices, 1) =
          Eigen::Map<const Eigen::VectorXd>(placed.data(), placed.size());
    }
  }
  const PrincipalComponents components = principal_components(poses.in_mm());
  poses.basis = components.basis(components.scatter.size());
  poses.variances = components.variances().head(components.scatter.size());
  return poses;
}

}  // namespace homolog
