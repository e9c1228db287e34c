#include "core/adapt/boundary/cut_faces.h"

#include <algorithm>
#include <cmath>

#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

// Lengths are shares of the surface's diagonal.
constexpr double flat_within = 0.008, flat_cosine = 0.95;  ///< how near to one plane, and to its normal
constexpr double edge_width = 0.025, edge_cosine = 0.87;   ///< behind a sharp edge the surface has turned by 30°
constexpr double sharp_share = 0.6;                        ///< share of the way around
constexpr double smoothing_width = 0.024;                  ///< the width over which normals are smoothed
/// A cut is where the template looks elsewhere on average. At a small face details of the organ do, too, so there it
/// has to look farther away. Or its normals spread (the length of their mean) at a large face, unless the template is
/// flat at more than this share of it too.
constexpr double elsewhere_cosine = 0.75, far_elsewhere_cosine = 0.6, flat_template = 0.9, as_in_template = 0.5;
constexpr double detail_share = 0.01;  ///< share of the surface's area
constexpr Eigen::Index seeds = 2000;

/// The normal of each face, unit length, without the steps that voxels leave.
Points smooth_normals(const Mesh& mesh) {
  Points normals = vertex_normals(mesh);
  const auto rounds = std::lround(smoothing_width * bounds_of(mesh.points).diagonal().norm() /
                                  mean_edge_mm(*mesh.topology, mesh.points));
  for (long round = 0; round < rounds; ++round) {
    Points next = normals;
    for (Eigen::Index i = 0; i < normals.rows(); ++i)
      for (const std::int32_t j : mesh.topology->one_ring(i)) next.row(i) += normals.row(j);
    for (Eigen::Index i = 0; i < normals.rows(); ++i) normals.row(i) = next.row(i).stableNormalized();
  }
  const Triangles& t = mesh.topology->triangles();
  Points of_faces(t.rows(), 3);
  for (Eigen::Index f = 0; f < t.rows(); ++f)
    of_faces.row(f) = (normals.row(t(f, 0)) + normals.row(t(f, 1)) + normals.row(t(f, 2))).stableNormalized();
  return of_faces;
}

class FlatFaces {
 public:
  explicit FlatFaces(const Mesh& surface)
      : topology_(*surface.topology), normals_(smooth_normals(surface)), taken_(faces(), 0), seen_(faces(), 0) {
    middles_.resize(static_cast<Eigen::Index>(faces()), 3);
    areas_.resize(static_cast<Eigen::Index>(faces()));
    for (Eigen::Index f = 0; f < middles_.rows(); ++f) {
      const auto t = topology_.triangles().row(f);
      middles_.row(f) = (surface.points.row(t[0]) + surface.points.row(t[1]) + surface.points.row(t[2])) / 3;
      areas_[f] = area_normal(surface, f).norm() / 2;
    }
    diagonal_mm_ = bounds_of(surface.points).diagonal().norm();
    edge_mm_ = mean_edge_mm(topology_, surface.points);
  }

  std::vector<std::vector<std::int32_t>> all(double smallest_share) {
    std::vector<std::vector<std::int32_t>> found;
    const auto count = static_cast<Eigen::Index>(faces());
    const double smallest = smallest_share * areas_.sum();
    for (Eigen::Index seed = 0; seed < count; seed += 1 + count / seeds) {
      if (taken_[seed] != 0) continue;
      // The seed's own plane is that of a few faces; the second one is that of all around it.
      auto flat = grown(seed, middles_.row(seed), normals_.row(seed));
      Vec3 normal;
      for (int k = 0; k < 3 && !flat.empty(); ++k) {
        const auto plane = plane_of(flat);
        normal = plane.second;
        flat = grown(seed, plane.first, normal);
      }
      if (area_of(flat) < smallest || sharp_edge_share(flat, normal) < sharp_share) {
        continue;
      }
      for (const std::int32_t f : flat) taken_[f] = 1;
      std::sort(flat.begin(), flat.end());
      found.push_back(std::move(flat));
    }
    return found;
  }

 private:
  std::size_t faces() const { return static_cast<std::size_t>(topology_.triangles().rows()); }

  std::vector<std::int32_t> grown(Eigen::Index seed, const Vec3& middle, const Vec3& normal) {
    const auto is_flat = [&](Eigen::Index f) {
      return normals_.row(f).dot(normal) > flat_cosine &&
             std::abs((middles_.row(f).transpose() - middle).dot(normal)) < flat_within * diagonal_mm_;
    };
    std::vector<std::int32_t> flat;
    ++growth_;
    const auto visit = [&](std::int32_t f) {
      if (f < 0 || seen_[f] == growth_ || taken_[f] != 0) return;
      seen_[f] = growth_;
      if (is_flat(f)) flat.push_back(f);
    };
    visit(static_cast<std::int32_t>(seed));
    for (std::size_t k = 0; k < flat.size(); ++k)
      for (const std::int32_t f : topology_.neighbours(flat[k])) visit(f);
    return flat;
  }

  std::pair<Vec3, Vec3> plane_of(const std::vector<std::int32_t>& some) const {
    Vec3 middle = Vec3::Zero(), normal = Vec3::Zero();
    for (const std::int32_t f : some) {
      middle += areas_[f] * middles_.row(f).transpose();
      normal += areas_[f] * normals_.row(f).transpose();
    }
    return {middle / std::max(area_of(some), 1e-300), normal.stableNormalized()};
  }

  double area_of(const std::vector<std::int32_t>& some) const {
    double area = 0;
    for (const std::int32_t f : some) area += areas_[f];
    return area;
  }

  /// The share of the faces a little way beyond the rim that have turned away. An opening counts as an edge.
  double sharp_edge_share(const std::vector<std::int32_t>& flat, const Vec3& normal) const {
    std::vector<char> seen(faces(), 0);
    for (const std::int32_t f : flat) seen[f] = 1;
    std::vector<std::int32_t> front = flat;
    const int layers = std::max(2, static_cast<int>(edge_width * diagonal_mm_ / (edge_mm_ / 2)));
    for (int layer = 0; layer < layers; ++layer) {
      std::vector<std::int32_t> next;
      for (const std::int32_t f : front)
        for (const std::int32_t g : topology_.neighbours(f))
          if (g >= 0 && seen[g] == 0) {
            seen[g] = 1;
            next.push_back(g);
          }
      front = std::move(next);
    }
    if (front.empty()) return 1;
    const auto turned = std::count_if(front.begin(), front.end(),
                                      [&](std::int32_t f) { return normals_.row(f).dot(normal) < edge_cosine; });
    return static_cast<double>(turned) / static_cast<double>(front.size());
  }

  const Topology& topology_;
  Points normals_, middles_;
  Eigen::VectorXd areas_;
  std::vector<char> taken_;  ///< faces of those found
  std::vector<int> seen_;    ///< by which growth last
  int growth_ = 0;
  double diagonal_mm_ = 0, edge_mm_ = 0;
};

/// A template, and how it lies to a flat face near it.
class TemplateSurface {
 public:
  TemplateSurface(const Mesh& on_surface, const Points& placed)
      : search_(on_surface),
        normals_(vertex_normals({on_surface.topology, placed})),
        flat_(static_cast<std::size_t>(on_surface.topology->triangles().rows()), 0) {
    for (const auto& face : FlatFaces({on_surface.topology, placed}).all(large_face_share))
      for (const std::int32_t f : face) flat_[f] = 1;
  }

  bool is_cut(const Mesh& surface, const std::vector<std::int32_t>& flat_face) const {
    double cosines = 0, natural = 0, area_mm2 = 0;
    Vec3 sum = Vec3::Zero();
    for (const std::int32_t f : flat_face) {
      const auto t = surface.topology->triangles().row(f);
      const Vec3 middle = (surface.points.row(t[0]) + surface.points.row(t[1]) + surface.points.row(t[2])) / 3;
      const SurfacePoint at = search_.nearest(middle).at;
      const Vec3 normal = at.interpolate(*search_.mesh().topology, normals_).transpose().stableNormalized();
      natural += flat_[at.face];
      cosines += normal.dot(area_normal(surface, f).stableNormalized());
      area_mm2 += area_normal(surface, f).norm() / 2;
      sum += normal;
    }
    const auto count = static_cast<double>(flat_face.size());
    const double share = area_mm2 / surface_area_mm2(surface), cosine = cosines / count;
    return cosine < (share < detail_share ? far_elsewhere_cosine : elsewhere_cosine) ||
           (share >= large_face_share && sum.norm() / count < flat_template && natural / count <= as_in_template);
  }

 private:
  SurfaceSearch search_;
  Points normals_;
  std::vector<char> flat_;  ///< faces of the template that are flat by nature
};

}  // namespace

std::vector<std::vector<std::int32_t>> flat_faces(const Mesh& surface, double smallest_share) {
  return FlatFaces(surface).all(smallest_share);
}

std::vector<std::uint8_t> cut_faces(const Mesh& surface, const std::vector<std::vector<std::int32_t>>& flat,
                                    const Mesh& on_surface, const Points& placed) {
  const TemplateSurface the_template(on_surface, placed);
  std::vector<std::uint8_t> cut;
  for (const auto& face : flat) {
    if (!the_template.is_cut(surface, face)) continue;
    cut.resize(static_cast<std::size_t>(surface.topology->triangles().rows()), 0);
    for (const std::int32_t f : face) cut[f] = 1;
  }
  return cut;
}

}  // namespace homolog
