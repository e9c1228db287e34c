#pragma once

#include <memory>
#include <vector>

#include "core/mesh/topology.h"
#include "core/model/shape_model.h"

namespace homolog {

/// Tukey's fences of a sample [Tukey 1977]: 1.5 and 3 interquartile ranges above the upper quartile, with the median.
struct Fences {
  double median = 0, upper = 0, outer = 0;
};
Fences fences_of(std::vector<double> values);

enum class Suspicion {
  none,
  outside,     ///< beyond the upper fence
  far_outside  ///< beyond the outer fence
};

struct SuspiciousShape {
  Eigen::Index shape = 0;
  double distance_mm = 0;  ///< Procrustes distance: root mean square over the vertices to the mean shape
  Suspicion suspicion = Suspicion::none;
};
/// All shapes, the farthest from the mean first.
std::vector<SuspiciousShape> shapes_by_distance(const PrincipalComponents& components);

struct SuspiciousVertex {
  Eigen::Index shape = 0, vertex = 0;
  double deviation_mm = 0;  ///< distance from where the model of all other shapes puts it
  double usual_mm = 0;      ///< median of the same over all shapes
};
/// Vertices that lie elsewhere than the other shapes predict. A shape is rebuilt by `modes` modes of a model of the
/// others. A vertex is listed where its deviation is beyond the outer fence twice: among all shapes at this vertex, and
/// among all vertices of this shape. Only the worst of neighbours is listed (where a topology is given). The largest
/// deviation comes first.
std::vector<SuspiciousVertex> suspicious_vertices(const PrincipalComponents& components,
                                                  const std::shared_ptr<const Topology>& topology, Eigen::Index modes);

struct SuspiciousTriangle {
  Eigen::Index shape = 0, triangle = 0;
  double stretch = 1;  ///< how much longer or shorter its worst direction is than in the mean shape, ≥ 1
  double usual = 1;    ///< median of the same over all shapes
};
/// Triangles whose stretch is beyond the outer fence of all shapes' stretches of that triangle and of all triangles' in
/// that shape. Only the worst of triangles side by side is listed. The largest stretch comes first.
std::vector<SuspiciousTriangle> suspicious_triangles(const PrincipalComponents& components, const Topology& topology);

}  // namespace homolog
