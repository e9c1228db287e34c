#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>

namespace homolog {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
/// n×3, one point a row, LPS mm unless the name says otherwise. Row-major: a point's coordinates lie together.
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
/// m×3 vertex indices, counter-clockwise seen from outside.
using Triangles = Eigen::Matrix<std::int32_t, Eigen::Dynamic, 3, Eigen::RowMajor>;
/// One value a vertex.
using VertexScalars = Eigen::VectorXd;

/// x ↦ scale · rotation · x + translation; `rotation` is a unit quaternion, `scale` > 0, translation in mm. Never a
/// reflection.
struct Similarity {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  double scale = 1;
  Vec3 translation = Vec3::Zero();

  Vec3 apply(const Vec3& x) const { return scale * (rotation * x) + translation; }
  Points apply(const Points& x) const {
    return ((scale * x) * rotation.toRotationMatrix().transpose()).rowwise() + translation.transpose();
  }
  /// this ∘ first: `first` is applied to the point before this.
  Similarity after(const Similarity& first) const {
    return {(rotation * first.rotation).normalized(), scale * first.scale, apply(first.translation)};
  }
  Similarity inverse() const {
    const Eigen::Quaterniond turned = rotation.conjugate();
    return {turned, 1 / scale, -(turned * translation) / scale};
  }
  bool operator==(const Similarity& other) const {
    return rotation.coeffs() == other.rotation.coeffs() && scale == other.scale && translation == other.translation;
  }
};

/// Axis-aligned box in mm; empty (min > max) until something is added.
using Box = Eigen::AlignedBox3d;

inline Box bounds_of(const Points& points) {
  Box box;
  for (Eigen::Index i = 0; i < points.rows(); ++i) box.extend(Vec3(points.row(i)));
  return box;
}

}  // namespace homolog
