#include "core/model/measures/suspicion.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/base/processes/parallel.h"
#include "core/model/measures/leave_one_out.h"

namespace homolog {

namespace {

/// The value below which `share` of the sorted values lie, interpolated between two: fences of a few shapes would jump
/// from one shape's value to the next with `quantile` of core/base, which gives a value that occurs.
double sorted_quantile(const std::vector<double>& sorted, double share) {
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (at - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

template <class Values>
std::vector<double> list_of(const Values& values) {
  return {values.begin(), values.end()};
}

/// Fences along both directions of a table with a row a place and a column a shape.
struct TableFences {
  std::vector<Fences> of_place, of_shape;

  explicit TableFences(const Eigen::MatrixXf& table) {
    of_place.resize(static_cast<std::size_t>(table.rows()));
    in_parallel(table.rows(), [&](Eigen::Index first, Eigen::Index last) {
      for (Eigen::Index row = first; row < last; ++row) of_place[row] = fences_of(list_of(table.row(row)));
    });
    for (Eigen::Index column = 0; column < table.cols(); ++column)
      of_shape.push_back(fences_of(list_of(table.col(column))));
  }
  bool beyond(double value, Eigen::Index place, Eigen::Index shape) const {
    return value > of_place[place].outer && value > of_shape[shape].outer;
  }
};

/// n×M: how far every vertex of every shape lies from where the model of the others puts it. Rounded, since it is as
/// large as a third of the shapes.
Eigen::MatrixXf deviations_mm(const PrincipalComponents& components, Eigen::Index modes) {
  const Eigen::MatrixXd combinations = left_out_errors(components, modes);
  Eigen::MatrixXf deviations(components.vertices(), components.shapes());
  constexpr Eigen::Index block = 64;
  in_parallel(
      components.vertices(),
      [&](Eigen::Index first, Eigen::Index last) {
        Eigen::MatrixXd errors;
        for (Eigen::Index v = first; v < last; v += block) {
          const Eigen::Index count = std::min(block, last - v);
          errors.noalias() = components.centred.middleRows(3 * v, 3 * count) * combinations;
          for (Eigen::Index i = 0; i < errors.cols(); ++i)
            deviations.col(i).segment(v, count) =
                errors.col(i).reshaped(3, count).colwise().norm().transpose().cast<float>();
        }
      },
      block);
  return deviations;
}

/// The edges of a triangle from its first corner, in the triangle's own plane; the first lies along x.
Eigen::Matrix2d flat_edges(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 first = b - a, second = c - a;
  const double length = first.norm();
  if (!(length > 0)) return Eigen::Matrix2d::Zero();
  const double along = second.dot(first) / length;
  Eigen::Matrix2d edges;
  edges << length, along, 0, first.cross(second).norm() / length;
  return edges;
}

/// Largest factor, either way, by which the map from one triangle to the other changes a length; 1 where either has no
/// area to speak of.
double stretch_between(const Eigen::Matrix2d& from, const Eigen::Matrix2d& to) {
  if (!(std::abs(from.determinant()) > 1e-12 * from.squaredNorm())) return 1;
  const Eigen::Matrix2d map = to * from.inverse();
  // The singular values: their product is |det|, their squares' sum the squared norm.
  const double product = std::abs(map.determinant()), squares = map.squaredNorm();
  const double larger = std::sqrt((squares + std::sqrt(std::max(squares * squares - 4 * product * product, 0.0))) / 2);
  constexpr double most = 1e6;  // the stretch of a triangle that collapsed
  const double smaller = std::max(larger > 0 ? product / larger : 0, 1 / most);
  return std::min(most, std::max(larger, 1 / smaller));
}

template <class Doubtful, class Value>
void sort_by(std::vector<Doubtful>& list, const Value& value) {
  std::stable_sort(list.begin(), list.end(), [&](const Doubtful& a, const Doubtful& b) { return value(a) > value(b); });
}

}  // namespace

Fences fences_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const double upper_quartile = sorted_quantile(values, 0.75), range = upper_quartile - sorted_quantile(values, 0.25);
  return {sorted_quantile(values, 0.5), upper_quartile + 1.5 * range, upper_quartile + 3 * range};
}

std::vector<SuspiciousShape> shapes_by_distance(const PrincipalComponents& components) {
  const Eigen::VectorXd distances_mm =
      components.centred.colwise().norm() / std::sqrt(static_cast<double>(components.vertices()));
  const Fences fences = fences_of(list_of(distances_mm));
  std::vector<SuspiciousShape> list;
  for (Eigen::Index i = 0; i < components.shapes(); ++i) {
    const double d = distances_mm[i];
    list.push_back({i, d,
                    d > fences.outer   ? Suspicion::far_outside
                    : d > fences.upper ? Suspicion::outside
                                       : Suspicion::none});
  }
  sort_by(list, [](const SuspiciousShape& shape) { return shape.distance_mm; });
  return list;
}

std::vector<SuspiciousVertex> suspicious_vertices(const PrincipalComponents& components,
                                                  const std::shared_ptr<const Topology>& topology, Eigen::Index modes) {
  const Eigen::MatrixXf deviations = deviations_mm(components, modes);
  const TableFences fences(deviations);
  const auto worst_of_its_ring = [&](Eigen::Index v, Eigen::Index i) {
    if (!topology) return true;
    const auto ring = topology->one_ring(v);
    return std::none_of(ring.begin(), ring.end(), [&](std::int32_t w) { return deviations(w, i) > deviations(v, i); });
  };
  std::vector<SuspiciousVertex> list;
  for (Eigen::Index i = 0; i < deviations.cols(); ++i) {
    for (Eigen::Index v = 0; v < deviations.rows(); ++v) {
      if (fences.beyond(deviations(v, i), v, i) && worst_of_its_ring(v, i))
        list.push_back({i, v, deviations(v, i), fences.of_place[v].median});
    }
  }
  sort_by(list, [](const SuspiciousVertex& one) { return one.deviation_mm; });
  return list;
}

std::vector<SuspiciousTriangle> suspicious_triangles(const PrincipalComponents& components, const Topology& topology) {
  const Triangles& triangles = topology.triangles();
  // Computed twice, by triangle and by shape: a table of all would be as large as the shapes themselves.
  const auto edges_of = [&](Eigen::Index t, const auto& corner) {
    return flat_edges(corner(triangles(t, 0)), corner(triangles(t, 1)), corner(triangles(t, 2)));
  };
  const auto mean_corner = [&](std::int32_t v) { return Vec3(components.mean.segment<3>(3 * v)); };
  const auto stretch = [&](Eigen::Index t, Eigen::Index i) {
    const auto corner = [&](std::int32_t v) {
      return Vec3(components.mean.segment<3>(3 * v) + components.centred.col(i).segment<3>(3 * v));
    };
    return stretch_between(edges_of(t, mean_corner), edges_of(t, corner));
  };
  std::vector<Fences> of_triangle(static_cast<std::size_t>(triangles.rows()));
  in_parallel(triangles.rows(), [&](Eigen::Index first, Eigen::Index last) {
    std::vector<double> stretches(static_cast<std::size_t>(components.shapes()));
    for (Eigen::Index t = first; t < last; ++t) {
      for (Eigen::Index i = 0; i < components.shapes(); ++i) stretches[i] = stretch(t, i);
      of_triangle[t] = fences_of(stretches);
    }
  });
  std::vector<std::vector<SuspiciousTriangle>> of_shape(static_cast<std::size_t>(components.shapes()));
  for_each_in_parallel(of_shape.size(), [&](std::size_t i) {
    const auto shape = static_cast<Eigen::Index>(i);
    std::vector<double> stretches(of_triangle.size());
    for (std::size_t t = 0; t < stretches.size(); ++t) stretches[t] = stretch(static_cast<Eigen::Index>(t), shape);
    const Fences own = fences_of(stretches);
    for (std::size_t t = 0; t < stretches.size(); ++t) {
      if (stretches[t] <= std::max(of_triangle[t].outer, own.outer)) continue;
      const auto triangle = static_cast<Eigen::Index>(t);
      const auto& beside = topology.neighbours(triangle);
      const bool worst = std::none_of(beside.begin(), beside.end(), [&](std::int32_t other) {
        return other >= 0 && stretches[other] > stretches[t];
      });
      if (worst) of_shape[i].push_back({shape, triangle, stretches[t], of_triangle[t].median});
    }
  });
  std::vector<SuspiciousTriangle> list;
  for (const auto& one : of_shape) list.insert(list.end(), one.begin(), one.end());
  sort_by(list, [](const SuspiciousTriangle& triangle) { return triangle.stretch; });
  return list;
}

}  // namespace homolog
