#include "core/deform/volume_carrier.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>

#include "core/deform/volume_energy.h"
#include "core/deform/volume_minimiser.h"

namespace homolog {
namespace {

constexpr double margin = 1.02;   ///< over what is asked
constexpr int most_mending = 12;  ///< rounds
constexpr double weaker = 0.6;    ///< the springs of each round than those before

/// The frame of a face: two edges, and its normal as long as the edges are in the mean.
Eigen::Matrix3d frame_of(const Triangles& triangles, const Points& points, Eigen::Index face) {
  const Vec3 a = points.row(triangles(face, 0)), b = points.row(triangles(face, 1)), c = points.row(triangles(face, 2));
  const Vec3 normal = (b - a).cross(c - a);
  Eigen::Matrix3d frame;
  frame << b - a, c - a, normal / std::sqrt(std::max(normal.norm(), 1e-30));
  return frame;
}

/// How the surroundings of each vertex were turned and stretched from one shape to another: the mean of its faces.
std::vector<Eigen::Matrix3d> stretches(const Mesh& from, const Points& to) {
  const Triangles& triangles = from.topology->triangles();
  std::vector<Eigen::Matrix3d> of_face, of_vertex;
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    const Eigen::Matrix3d before = frame_of(triangles, from.points, f);
    const bool flat = std::abs(before.determinant()) < 1e-20;
    of_face.push_back(flat ? Eigen::Matrix3d(Eigen::Matrix3d::Identity())
                           : Eigen::Matrix3d(frame_of(triangles, to, f) * before.inverse()));
  }
  for (Eigen::Index i = 0; i < from.points.rows(); ++i) {
    Eigen::Matrix3d mean = Eigen::Matrix3d::Zero();
    const auto faces = from.topology->faces_of(i);
    for (const std::int32_t f : faces) mean += of_face[f] / static_cast<double>(faces.size());
    of_vertex.push_back(mean);
  }
  return of_vertex;
}

/// The affine map that takes `from` nearest to `to`, as 4×3: [x 1] M.
Eigen::Matrix<double, 4, 3> affine_between(const Points& from, const Points& to) {
  Eigen::Matrix<double, Eigen::Dynamic, 4> with_one(from.rows(), 4);
  with_one << from, Eigen::VectorXd::Ones(from.rows());
  const Eigen::Matrix4d normal = with_one.transpose() * with_one + 1e-9 * Eigen::Matrix4d::Identity();
  return normal.ldlt().solve(with_one.transpose() * to);
}

std::string mm_text(double mm) {
  char text[48];
  std::snprintf(text, sizeof text, mm < 10 ? "%.1f mm" : "%.0f mm", mm);
  return text;
}

/// Errors: the outside of a mesh is of another size than the template, as one in another unit is.
Result<void> check_size(double diagonal, double template_diagonal, bool of_units_alone) {
  struct Unit {
    double times;
    const char *name, *factor;
  };
  constexpr double near = 1.1, rounding = 1e-3;
  const double times = diagonal / template_diagonal;
  char shown[48];
  std::snprintf(shown, sizeof shown, "%.3g", times);
  const std::string size = std::string("has an outside ") + shown + " times as large as the template";
  for (const Unit& unit : {Unit{1e-3, "metres", "1000"}, Unit{0.1, "cm", "10"}, Unit{1e3, "micrometres", "0.001"}})
    if (times > unit.times / near && times < unit.times * near)
      return fail("", size + ", as a mesh in " + unit.name + " has; write it in mm (its coordinates times " +
                          unit.factor + ")");
  if (!of_units_alone && (times > near + rounding || times < 1 / near - rounding))
    return fail("", size + ", so it is not of this template; mesh the template itself");
  return {};
}

/// How far a vertex of a template lies from the outside of a mesh at most; 0 where that is no surface.
double farthest_from_outside(const VolumeMesh& mesh, const Mesh& the_template) {
  const auto outside = outside_of(mesh);
  if (!outside) return 0;
  const SurfaceSearch search(*outside);
  double farthest = 0;
  std::int32_t likely = 0;
  for (Eigen::Index i = 0; i < the_template.points.rows(); ++i) {
    const auto nearest = search.nearest(the_template.points.row(i), likely);
    likely = nearest.at.face;
    farthest = std::max(farthest, nearest.distance_mm);
  }
  return farthest;
}

/// The elements of which a point is `chosen`, as rows.
std::vector<Eigen::Index> elements_around(const Tetrahedra& tetrahedra, const std::vector<char>& chosen) {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index t = 0; t < tetrahedra.rows(); ++t)
    for (int k = 0; k < 4; ++k)
      if (chosen[tetrahedra(t, k)] != 0) {
        rows.push_back(t);
        break;
      }
  return rows;
}

}  // namespace

/// The stiffness matrix of linear elements in the mesh that was brought, of its points within: how it is filled between
/// its outside, and what the minimiser takes for the second derivatives of the energy.
struct VolumeCarrier::Solver {
  Eigen::SparseMatrix<double> to_fixed;  ///< free × fixed
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor;
};

Result<VolumeCarrier> VolumeCarrier::make(const VolumeMesh& mesh, const Mesh& the_template) {
  VolumeCarrier carrier;
  carrier.mesh_ = mesh;
  carrier.template_ = the_template;
  carrier.outside_ = on_outside(mesh);
  std::vector<char> used(static_cast<std::size_t>(mesh.points.rows()), 0);
  for (const std::int32_t v : mesh.tetrahedra.reshaped<Eigen::RowMajor>()) used[v] = 1;
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    (carrier.outside_[k] != 0 || used[k] == 0 ? carrier.fixed_ : carrier.free_).push_back(i);
  }
  const SurfaceSearch search(the_template);
  const double diagonal = bounds_of(the_template.points).sizes().norm();
  Box outside;
  for (const Eigen::Index i : carrier.fixed_)
    if (carrier.outside_[i] != 0) outside.extend(Vec3(mesh.points.row(i)));
  const double own_diagonal = outside.sizes().norm();
  if (auto usual = check_size(own_diagonal, diagonal, true); !usual) return fail(usual.error());
  std::int32_t likely = 0;
  for (const Eigen::Index i : carrier.fixed_) {
    const auto nearest = search.nearest(mesh.points.row(i), likely);
    likely = nearest.at.face;
    carrier.places_.push_back(nearest.at);
    if (carrier.outside_[i] != 0) carrier.off_mm_ = std::max(carrier.off_mm_, nearest.distance_mm);
  }
  constexpr double too_far = 0.1;  // of the diagonal
  if (carrier.off_mm_ > too_far * diagonal)
    return fail("", "has an outside that lies up to " + mm_text(carrier.off_mm_) +
                        " off the template's surface, so it is not of this template; mesh the template itself");
  if (auto alike = check_size(own_diagonal, diagonal, false); !alike) return fail(alike.error());
  if (const double lacking = farthest_from_outside(mesh, the_template); lacking > too_far * diagonal)
    return fail("", "has no outside within " + mm_text(lacking) +
                        " of a part of the template's surface, so it does not fill this template; mesh the template "
                        "itself");
  carrier.far_off_ = carrier.off_mm_ > 0.01 * diagonal;
  carrier.least_ = scaled_jacobians(mesh.tetrahedra, mesh.points).minCoeff();
  carrier.prepare();
  return carrier;
}

double VolumeCarrier::asked() const {
  return std::min(0.2, 0.8 * least_);
}

double VolumeCarrier::edge_mm() const {
  return std::cbrt(sixfold_volumes(mesh_.tetrahedra, mesh_.points).mean() * std::numbers::sqrt2);
}

void VolumeCarrier::prepare() {
  std::vector<Eigen::Index> index(static_cast<std::size_t>(mesh_.points.rows()));
  std::vector<char> is_free(index.size(), 0);
  for (std::size_t k = 0; k < free_.size(); ++k) {
    index[free_[k]] = static_cast<Eigen::Index>(k);
    is_free[free_[k]] = 1;
  }
  for (std::size_t k = 0; k < fixed_.size(); ++k) index[fixed_[k]] = static_cast<Eigen::Index>(k);
  std::vector<Eigen::Triplet<double>> within, across;
  for (Eigen::Index t = 0; t < mesh_.tetrahedra.rows(); ++t) {
    Eigen::Matrix3d edges;
    for (int k = 0; k < 3; ++k)
      edges.col(k) =
          (mesh_.points.row(mesh_.tetrahedra(t, k + 1)) - mesh_.points.row(mesh_.tetrahedra(t, 0))).transpose();
    Eigen::Matrix<double, 4, 3> slopes;
    slopes.bottomRows<3>() = edges.inverse();
    slopes.row(0) = -slopes.bottomRows<3>().colwise().sum();
    const Eigen::Matrix4d stiffness = slopes * slopes.transpose();
    for (int a = 0; a < 4; ++a) {
      const auto i = static_cast<std::size_t>(mesh_.tetrahedra(t, a));
      if (is_free[i] == 0) continue;
      for (int b = 0; b < 4; ++b) {
        const auto j = static_cast<std::size_t>(mesh_.tetrahedra(t, b));
        (is_free[j] != 0 ? within : across).emplace_back(index[i], index[j], stiffness(a, b));
      }
    }
  }
  auto solver = std::make_shared<Solver>();
  const auto free = std::ssize(free_);
  solver->to_fixed.resize(free, std::ssize(fixed_));
  solver->to_fixed.setFromTriplets(across.begin(), across.end());
  Eigen::SparseMatrix<double> matrix(free, free);
  matrix.setFromTriplets(within.begin(), within.end());
  if (free > 0) solver->factor.compute(matrix);
  solver_ = std::move(solver);
}

Points VolumeCarrier::outside_in(const Points& shape) const {
  const auto stretched = stretches(template_, shape);
  Points places(std::ssize(fixed_), 3);
  for (std::size_t k = 0; k < fixed_.size(); ++k) {
    const SurfacePoint& at = places_[k];
    const auto corners = template_.topology->triangles().row(at.face);
    Eigen::Matrix3d map = Eigen::Matrix3d::Zero();
    for (int c = 0; c < 3; ++c) map += at.weights[c] * stretched[corners[c]];
    const Vec3 off = mesh_.points.row(fixed_[k]) - at.interpolate(*template_.topology, template_.points);
    places.row(static_cast<Eigen::Index>(k)) = at.interpolate(*template_.topology, shape) + (map * off).transpose();
  }
  return places;
}

/// An affine map, and what is left of the outside spread as heat is.
Points VolumeCarrier::begin(const Points& outside) const {
  const Points before = mesh_.points(fixed_, Eigen::all);
  const auto affine = affine_between(before, outside);
  Points points = (mesh_.points * affine.topRows<3>()).rowwise() + affine.row(3);
  const Points left = outside - points(fixed_, Eigen::all);
  points(fixed_, Eigen::all) = outside;
  if (!free_.empty()) {
    const Eigen::MatrixX3d load = -(solver_->to_fixed * left);
    points(free_, Eigen::all) += solver_->factor.solve(load);
  }
  return points;
}

bool VolumeCarrier::settle_within(const Points& rest, Points& points, Progress* progress) const {
  if (free_.empty()) return true;
  std::vector<char> moves(outside_.size(), 0);
  for (const Eigen::Index i : free_) moves[i] = 1;
  const VolumeEnergy energy(mesh_.tetrahedra(elements_around(mesh_.tetrahedra, moves), Eigen::all), rest);
  const auto guess = [this](const Points& slope) -> Points {
    const Eigen::MatrixX3d rows = slope;
    return solver_->factor.solve(rows) / 4.0;
  };
  return Minimiser(energy, {}, free_, guess).run(points, 12, progress);
}

/// The surface of a case, to hold the outside of a volume mesh to it.
struct VolumeCarrier::Ground {
  SurfaceSearch search;
  Points outside;         ///< places of the fixed points, a row each
  VertexScalars heights;  ///< their heights above the surface, mm

  /// The foot of a point on the surface, raised by the height that it has there, and the normal.
  std::pair<Vec3, Vec3> foot(const Vec3& point, double height) const {
    const auto nearest = search.nearest(point);
    const Mesh& mesh = search.mesh();
    const Vec3 normal = frame_of(mesh.topology->triangles(), mesh.points, nearest.at.face).col(2).normalized();
    return {nearest.position + height * normal, normal};
  }
};

Springs VolumeCarrier::springs_for(const std::vector<char>& moves, const Ground& ground, const Points& points) const {
  Springs springs;
  std::vector<Eigen::Index> rows;
  for (std::size_t k = 0; k < fixed_.size(); ++k) {
    if (moves[fixed_[k]] == 0) continue;
    rows.push_back(static_cast<Eigen::Index>(k));
    springs.points.push_back(fixed_[k]);
  }
  springs.places = ground.outside(rows, Eigen::all);
  springs.feet.resize(std::ssize(rows), 3);
  springs.normals.resize(std::ssize(rows), 3);
  for (Eigen::Index r = 0; r < std::ssize(rows); ++r) {
    const Eigen::Index row = rows[r];
    const auto [foot, normal] = ground.foot(points.row(springs.points[r]), ground.heights[row]);
    springs.feet.row(r) = foot.transpose();
    springs.normals.row(r) = normal.transpose();
  }
  return springs;
}

/// The points of elements that are poor, and of those `rings` around them; empty where none is.
std::vector<char> VolumeCarrier::around_poor(const VertexScalars& quality, int rings) const {
  std::vector<char> chosen(outside_.size(), 0);
  const auto choose = [&](Eigen::Index t) {
    for (int k = 0; k < 4; ++k) chosen[mesh_.tetrahedra(t, k)] = 1;
  };
  bool any = false;
  for (Eigen::Index t = 0; t < quality.size(); ++t) {
    if (quality[t] >= margin * asked()) continue;
    any = true;
    choose(t);
  }
  if (!any) return {};
  for (int ring = 0; ring < rings; ++ring)
    for (const Eigen::Index t : elements_around(mesh_.tetrahedra, chosen)) choose(t);
  return chosen;
}

/// One round of `mend_poor` on the elements around the points that move, numbered anew so that it costs what they do.
bool VolumeCarrier::mend_around(const std::vector<char>& moves, const VertexScalars& quality, const Points& rest,
                                const Ground& ground, int round, Points& points, Progress* progress) const {
  const auto rows = elements_around(mesh_.tetrahedra, moves);
  Tetrahedra elements = mesh_.tetrahedra(rows, Eigen::all);
  std::vector<Eigen::Index> used(elements.data(), elements.data() + elements.size()), moving;
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  const auto here = [&](Eigen::Index i) { return std::lower_bound(used.begin(), used.end(), i) - used.begin(); };
  for (std::int32_t& v : elements.reshaped<Eigen::RowMajor>()) v = static_cast<std::int32_t>(here(v));
  for (std::size_t k = 0; k < used.size(); ++k)
    if (moves[used[k]] != 0) moving.push_back(static_cast<Eigen::Index>(k));
  const double edge_mm = std::cbrt(sixfold_volumes(mesh_.tetrahedra, rest).mean() * std::numbers::sqrt2);
  Springs springs = springs_for(moves, ground, points);
  for (Eigen::Index& i : springs.points) i = here(i);
  springs.length_mm = edge_mm;
  const double strength = std::pow(weaker, round);
  springs.along *= strength;
  springs.across *= strength;
  VolumeEnergy energy(elements, rest(used, Eigen::all));
  if (round >= most_mending / 2)
    for (std::size_t k = 0; k < rows.size(); ++k)
      if (quality[rows[k]] < 1.5 * asked()) energy.rest_regular(static_cast<Eigen::Index>(k));
  const auto guess = [&](const Points& slope) -> Points { return slope * (edge_mm * edge_mm / 60); };
  Points local = points(used, Eigen::all);
  const bool done = Minimiser(energy, springs, moving, guess).run(local, 12, progress);
  points(used, Eigen::all) = local;
  return done;
}

/// Elements whose corners all lie outside follow the surface alone: where it bends the other way, they turn over. So
/// around poor elements the outside may slide a little along the surface, round by round farther and farther from them.
/// In the last rounds these elements are drawn to a regular shape.
bool VolumeCarrier::mend_poor(const Points& rest, const Points& shape, const Points& outside, Points& points,
                              Progress* progress) const {
  std::optional<Ground> ground;
  for (int round = 0; round < most_mending; ++round) {
    const VertexScalars quality = scaled_jacobians(mesh_.tetrahedra, points);
    const auto moves = around_poor(quality, 1 + round / 2);
    if (moves.empty()) return true;
    if (!ground) ground = ground_of(shape, outside);
    if (!mend_around(moves, quality, rest, *ground, round, points, progress)) return false;
  }
  return true;
}

VolumeCarrier::Ground VolumeCarrier::ground_of(const Points& shape, const Points& outside) const {
  Ground ground{SurfaceSearch({template_.topology, shape}), outside, VertexScalars(outside.rows())};
  for (Eigen::Index k = 0; k < outside.rows(); ++k) {
    const auto [foot, normal] = ground.foot(outside.row(k), 0);
    ground.heights[k] = (outside.row(k).transpose() - foot).dot(normal);
  }
  return ground;
}

double VolumeCarrier::lifted(const Points& shape, const Points& outside, const Points& points) const {
  std::optional<Ground> ground;
  double most = 0;
  for (std::size_t k = 0; k < fixed_.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    if (points.row(fixed_[k]) == outside.row(row)) continue;
    if (!ground) ground = ground_of(shape, outside);
    const Vec3 point = points.row(fixed_[k]);
    const auto [foot, normal] = ground->foot(point, ground->heights[row]);
    most = std::max(most, std::abs((point - foot).dot(normal)));
  }
  return most;
}

Result<CarriedVolume> VolumeCarrier::carry(const Points& shape, Progress* progress) const {
  if (shape.rows() != template_.points.rows())
    return fail("", "has " + std::to_string(shape.rows()) + " vertices and the template " +
                        std::to_string(template_.points.rows()) + "; give shapes of this template");
  const Points outside = outside_in(shape);
  CarriedVolume carried;
  carried.points = begin(outside);
  const double volume = sixfold_volumes(mesh_.tetrahedra, carried.points).sum(),
               before = sixfold_volumes(mesh_.tetrahedra, mesh_.points).sum();
  if (!(volume > 0))
    return fail("", "is flat, or mirrored against the template, so no tetrahedron fits into it; mirror it back");
  const double scale = std::cbrt(volume / before);
  const Points rest = mesh_.points * scale;
  if (!settle_within(rest, carried.points, progress) || !mend_poor(rest, shape, outside, carried.points, progress))
    return fail("", "was cancelled");
  const VertexScalars quality = scaled_jacobians(mesh_.tetrahedra, carried.points);
  carried.least = quality.minCoeff();
  carried.inverted = (quality.array() <= 1e-12).count();
  carried.poor = (quality.array() < asked()).count();
  const Points slid = carried.points(fixed_, Eigen::all) - outside;
  carried.slid_mm = slid.rowwise().norm().maxCoeff();
  carried.lifted_mm = lifted(shape, outside, carried.points);
  return carried;
}

}  // namespace homolog
