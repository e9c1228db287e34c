#include <doctest/doctest.h>

#include <algorithm>

#include "core/adapt/boundary/cut_faces.h"
#include "core/adapt/judge_fit.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/mesh/voxels/label_map.h"
#include "core/model/alignment/procrustes.h"
#include "core/model/model_prior.h"
#include "core/model/shape_model.h"
#include "core/phantom/phantom.h"
#include "tests/adapting.h"

// Fits to organs of which parts are missing.

namespace homolog {

namespace {

const std::shared_ptr<const Template>& kidney() {
  static const auto made = make_template(built_in_template(Organ::kidney), "built-in:kidney").value();
  return made;
}

/// A phantom kidney without the part where `along · p` is largest.
struct CutKidney {
  Points truth;
  Vec3 along;
  double limit;
  std::vector<char> missing;  ///< of each true vertex

  CutKidney(int subject, const Vec3& direction, double share)
      : truth(phantom_truth(Organ::kidney, subject)[0].points), along(direction) {
    const Eigen::VectorXd height = truth * along;
    std::vector<double> sorted(height.begin(), height.end());
    std::sort(sorted.begin(), sorted.end());
    limit = sorted[static_cast<std::size_t>((1 - share) * static_cast<double>(sorted.size() - 1))];
    for (const double h : height) missing.push_back(h > limit ? 1 : 0);
  }

  /// Without the part between two shares of the height instead.
  static CutKidney without_middle(int subject, const Vec3& direction, double from, double to) {
    CutKidney cut(subject, direction, 1 - from);
    const Eigen::VectorXd height = cut.truth * cut.along;
    std::vector<double> sorted(height.begin(), height.end());
    std::sort(sorted.begin(), sorted.end());
    const double end = sorted[static_cast<std::size_t>(to * static_cast<double>(sorted.size() - 1))];
    for (Eigen::Index i = 0; i < height.size(); ++i)
      if (height[i] > end) cut.missing[static_cast<std::size_t>(i)] = 0;
    return cut;
  }

  /// What is left, open where it was cut.
  Boundary open(bool all_parts = false) const {
    MeshFile left;
    left.points = truth;
    const Triangles& all = kidney()->topology->triangles();
    Triangles& faces = left.triangles.edit();
    faces.resize(all.rows(), 3);
    Eigen::Index count = 0;
    for (Eigen::Index f = 0; f < all.rows(); ++f)
      if (std::none_of(all.row(f).begin(), all.row(f).end(),
                       [&](std::int32_t v) { return missing[static_cast<std::size_t>(v)] != 0; }))
        faces.row(count++) = all.row(f);
    faces.conservativeResize(count, 3);
    return surface_boundary(left, kidney()->points.rows(), nullptr, all_parts).value();
  }

  /// Its label map, where the cut is a flat face.
  Boundary labelled() const {
    Volume labels = label_map({kidney()->topology, truth}, grid_around(truth, 1.5));
    auto& voxels = std::get<std::vector<std::uint8_t>>(labels.data);
    const auto [columns, rows, slices] = labels.geometry.dims;
    std::size_t voxel = 0;
    for (int k = 0; k < slices; ++k)
      for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i, ++voxel)
          if (labels.geometry.to_mm(Vec3(i, j, k)).dot(along) > limit) voxels[voxel] = 0;
    return label_boundary(labels, 1, 0, std::nullopt, kidney()->points.rows()).value();
  }

  /// F1 of the vertices that a fit calls missing.
  double f1(const FitResult& fit) const {
    double right = 0;
    for (const std::int32_t i : fit.outliers) right += missing[static_cast<std::size_t>(i)];
    const auto all = static_cast<double>(std::count(missing.begin(), missing.end(), 1));
    return 2 * right / (static_cast<double>(fit.outliers.size()) + all);
  }
};

FitResult partial_fit(const Boundary& boundary) {
  FitOptions options;
  options.partial = true;
  return fit_to_boundary(*kidney(), boundary, options).value();
}

}  // namespace

TEST_CASE("a partial fit finds what is missing and lies on what is there") {
  const CutKidney cut(5, Vec3(0.2, 0.1, 1).normalized(), 0.3);
  const FitResult fit = partial_fit(cut.open());
  CHECK(cut.f1(fit) > 0.9);
  CHECK(fit.turned_triangles == 0);

  const SurfaceSearch whole(Mesh{kidney()->topology, cut.truth});
  double sound_mm = 0, missing_mm = 0;
  for (Eigen::Index i = 0; i < cut.truth.rows(); ++i) {
    const double off_mm = (whole.nearest(fit.mesh.points.row(i)).position - Vec3(fit.mesh.points.row(i))).norm();
    (cut.missing[static_cast<std::size_t>(i)] != 0 ? missing_mm : sound_mm) += off_mm;
  }
  CHECK(sound_mm / static_cast<double>(cut.truth.rows()) < 0.2);
  CHECK(missing_mm / static_cast<double>(cut.truth.rows()) < 1.5);  // where only the template's shape speaks
}

TEST_CASE("an open surface is said to lack parts where the fit was not told so, unless the template is open too") {
  const CutKidney cut(5, Vec3(0.2, 0.1, 1).normalized(), 0.1);
  const Boundary open = cut.open();
  const FitResult fit = fit_to_boundary(*kidney(), open).value();
  const FitJudgement judgement = judge_fit(*kidney(), open, {}, fit);
  CHECK(judgement.doubtful);
  const auto says_partial = [](const FitJudgement& one) {
    return std::any_of(one.warnings.begin(), one.warnings.end(),
                       [](const std::string& warning) { return warning.find("use --partial") != std::string::npos; });
  };
  CHECK(says_partial(judgement));
  const auto open_template = make_template({open.surface.points, open.surface.topology->triangles()}, "open").value();
  const FitResult of_open = fit_to_boundary(*open_template, open).value();
  CHECK_FALSE(says_partial(judge_fit(*open_template, open, {}, of_open)));
}

TEST_CASE("an end that is gone is found although the template is placed too small at first and is in more doubt") {
  const CutKidney cut(3, Vec3(0.391, -0.311, 0.866).normalized(), 0.25);
  const FitResult fit = partial_fit(cut.open());
  CHECK(cut.f1(fit) > 0.9);
  const VertexScalars gone = outlier_marks(fit);
  const double gone_mm = fit.doubt_mm.dot(gone) / gone.sum();
  const double there_mm = (fit.doubt_mm.sum() - fit.doubt_mm.dot(gone)) / (1 - gone.array()).sum();
  CHECK(gone_mm > 1.2 * there_mm);
  CHECK(fit.doubt_mm.minCoeff() > 0);
}

TEST_CASE("the shape does not shrink into what a label map has left of an organ") {
  const CutKidney cut(6, Vec3(-0.131, -0.061, -0.989).normalized(), 0.1);
  CHECK(cut.f1(partial_fit(cut.labelled())) > 0.8);
}

TEST_CASE("the flat face that a cut leaves in a label map is found and is no target") {
  const CutKidney cut(6, Vec3(0.6, 0.7, 0.4).normalized(), 0.3);
  const FitResult fit = partial_fit(cut.labelled());
  CHECK(cut.f1(fit) > 0.9);
  double beyond_mm = 0;
  for (const std::int32_t i : fit.outliers)
    beyond_mm = std::max(beyond_mm, fit.mesh.points.row(i) * cut.along - cut.limit);
  CHECK(beyond_mm > 15);  // the template's end, which a face drawn to the cut would lose
}

TEST_CASE("a partial fit with a model finds what is missing and stays with the model where it is told to") {
  ShapeMatrix shapes(3 * kidney()->points.rows(), 10);
  for (int k = 0; k < 10; ++k) {
    const Points points = phantom_truth(Organ::kidney, 10 + k)[0].points;
    shapes.col(k) = Eigen::Map<const Eigen::VectorXd>(points.data(), points.size());
  }
  align(shapes, Alignment::similarity);
  const ShapeModel model = make_model(principal_components(std::move(shapes)), 0.95, kidney()->topology, {});
  const CutKidney cut(5, Vec3(0.2, 0.1, 1).normalized(), 0.3);
  for (const double beyond : {0.0, 1.0}) {
    auto allowed = allowed_by(model, *kidney()).value();
    allowed.beyond = beyond;
    FitOptions options;
    options.partial = true;
    options.allowed = std::make_shared<const AllowedShapes>(std::move(allowed));
    const FitResult fit = fit_to_boundary(*kidney(), cut.open(), options).value();
    CHECK(cut.f1(fit) > 0.85);
    CHECK((fit.mesh.points == fit.allowed) == (beyond == 0));
    // In the hole the model's shape stays, whatever the rim draws to.
    for (const std::int32_t i : fit.outliers) CHECK((fit.mesh.points.row(i) - fit.allowed.row(i)).norm() < 1e-9);
  }
}

TEST_CASE("all parts of what is left of an organ count in a partial fit") {
  const auto cut = CutKidney::without_middle(5, Vec3(0.2, 0.1, 1).normalized(), 0.55, 0.7);
  const FitResult of_all = partial_fit(cut.open(true)), of_largest = partial_fit(cut.open());
  CHECK(cut.f1(of_all) > 0.85);
  CHECK(cut.f1(of_largest) < 0.6);
}

TEST_CASE("a partial fit of a whole organ misses nothing and is the fit of the whole") {
  const Boundary whole = mesh_boundary({kidney()->topology, phantom_truth(Organ::kidney, 5)[0].points});
  const FitResult fit = partial_fit(whole);
  CHECK(fit.outliers.empty());
  CHECK(fit.mesh.points == fit_to_boundary(*kidney(), whole).value().mesh.points);
  FitOptions options;
  options.partial = true;
  CHECK_FALSE(judge_fit(*kidney(), whole, options, fit).doubtful);
}

TEST_CASE("a partial fit leaves a flat cut alone and keeps the template's shape beyond it") {
  // A long organ of which a third lacks behind a cut across it.
  Mesh organ = icosphere(3, 20);
  organ.points.col(2) *= 2;
  organ.points.col(0) *= 0.7;
  constexpr double cut_mm = 15;
  Volume labels = label_map(organ, grid_around(organ.points, 1.5));
  auto& voxels = std::get<std::vector<std::uint8_t>>(labels.data);
  for (std::size_t v = 0; v < voxels.size(); ++v) {
    const auto [columns, rows, slices] = labels.geometry.dims;
    const auto k = static_cast<double>(v / static_cast<std::size_t>(columns * rows));
    if (labels.geometry.to_mm(Vec3(0, 0, k)).z() > cut_mm) voxels[v] = 0;
  }
  const Boundary cut = label_boundary(labels, 1, 0, std::nullopt, organ.points.rows()).value();
  REQUIRE(flat_faces(cut.surface).size() == 1);
  FitOptions options;
  options.partial = true;
  options.placement = Similarity{};
  const auto whole = make_template({organ.points, organ.topology->triangles()}, "organ").value();
  const FitResult fit = fit_to_boundary(*whole, cut, options).value();
  double right = 0, beyond = 0;
  for (Eigen::Index i = 0; i < organ.points.rows(); ++i) beyond += organ.points(i, 2) > cut_mm ? 1 : 0;
  for (const std::int32_t i : fit.outliers) right += organ.points(i, 2) > cut_mm ? 1 : 0;
  CHECK(2 * right / (static_cast<double>(fit.outliers.size()) + beyond) > 0.9);
  CHECK(fit.mesh.points.col(2).maxCoeff() > 35);  // of 40
}

TEST_CASE("a ball that was cut has one flat face where the whole ball has none") {
  const auto cut_ball = [](double at) {
    constexpr int n = 64;
    Volume volume;
    volume.geometry.dims = {n, n, n};
    volume.geometry.origin_mm.setConstant(-32);
    std::vector<std::uint8_t> inside;
    for (int z = 0; z < n; ++z)
      for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
          const Vec3 p(x - 32, y - 32, z - 32);
          inside.push_back(p.norm() < 24 && p.dot(Vec3(0.3, 0.2, 1).normalized()) < at ? 1 : 0);
        }
    volume.data = std::move(inside);
    return label_boundary(volume, 1, 0, std::nullopt, 2500).value().surface;
  };
  CHECK(flat_faces(cut_ball(100)).empty());
  const Mesh cut = cut_ball(12);
  const auto flat = flat_faces(cut);
  REQUIRE(flat.size() == 1);
  const Mesh ball = icosphere(3, 24);
  const auto marked = cut_faces(cut, flat, ball, ball.points);
  REQUIRE(marked.size() == static_cast<std::size_t>(cut.topology->triangles().rows()));
  CHECK(std::count(marked.begin(), marked.end(), 1) == std::ssize(flat.front()));
  CHECK(cut_faces(cut, flat, cut, cut.points).empty());  // a template that is flat there too
}

}  // namespace homolog
