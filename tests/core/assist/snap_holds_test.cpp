#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "core/assist/assist.h"
#include "core/session/checkpoint.h"
#include "core/session/session.h"
#include "tests/case_folder.h"
#include "tests/must.h"

// What a snap leaves where a person put it.

namespace homolog {

namespace {

constexpr double edge_mm = 30;

/// A soft bright ball of 30 mm with some grain. Where x > 0 it is as bright as `far_side` says, in shares.
std::shared_ptr<const Volume> ball_image(double far_side = 1) {
  Volume image;
  image.geometry.dims = {48, 48, 48};
  image.geometry.spacing_mm.setConstant(2);
  image.geometry.origin_mm.setConstant(-47);
  std::vector<float> voxels;
  for (int k = 0; k < 48; ++k)
    for (int j = 0; j < 48; ++j)
      for (int i = 0; i < 48; ++i) {
        const Vec3 p = image.geometry.to_mm(Vec3(i, j, k));
        const double bright = far_side + (1 - far_side) / (1 + std::exp(p.x() / 3));
        voxels.push_back(
            static_cast<float>(100 * bright / (1 + std::exp(p.norm() - edge_mm)) + (i * 7 + j * 5 + k * 3) % 11));
      }
  image.data = std::move(voxels);
  return std::make_shared<const Volume>(std::move(image));
}

/// A ball of `radius_mm` with four landmarks, on its place in the image.
Document ball_case(double radius_mm, double far_side = 1) {
  const Mesh ball = icosphere(3, radius_mm);
  MeshFile file{ball.points, ball.topology->triangles()};
  file.landmarks = {{"north", Vec3(0, 0, radius_mm)},
                    {"south", Vec3(0, 0, -radius_mm)},
                    {"east", Vec3(radius_mm, 0, 0)},
                    {"front", Vec3(0, -radius_mm, 0)}};
  return new_document("ball", ball_image(far_side), test::must(make_template(std::move(file), "ball.ply")),
                      Similarity{});
}

SnapEdit snap_all(EditSession& session) {
  SnapEdit edit = test::must(snap_shape(session.document().scan, *session.document().view(), std::nullopt, {}));
  REQUIRE(session.apply(edit.action));
  return edit;
}

Vec3 at_landmark(const EditSession& session, std::size_t landmark) {
  return carried_landmark(*session.document().structure()->the_template, landmark,
                          *session.document().view()->shape.points);
}

/// How far from the origin the mesh lies in a direction.
double reach(const EditSession& session, const Vec3& direction) {
  Eigen::Index vertex = 0;
  (*session.document().view()->shape.points * direction).maxCoeff(&vertex);
  return session.document().view()->shape.points->row(vertex).norm();
}

Stroke pulled(const EditSession& session, const Vec3& from, const Vec3& to, Tool tool = Tool::pull) {
  Stroke stroke = pull(nearest_on_surface(*session.document().structure()->the_template->topology,
                                          *session.document().view()->shape.points, from)
                           .position,
                       to, 6);
  stroke.tool = tool;
  return stroke;
}

}  // namespace

TEST_CASE("a snap leaves the mesh at placed landmarks whatever the image shows") {
  for (const bool holds : {false, true}) {
    CAPTURE(holds);
    Document document = ball_case(28);
    document.change({}, [&](Structure& first) { first.landmarks.hold = holds; });
    EditSession session(document);
    const Vec3 north(0, 0, 36), south(0, 0, -29), east(31, 1, 0), front(0, -30, 1);
    REQUIRE(session.apply(PlaceLandmark{"north", north}));  // 6 mm beyond the edge: a person knows better
    REQUIRE(session.apply(PlaceLandmark{"south", south}));
    REQUIRE(session.apply(PlaceLandmark{"east", east}));
    REQUIRE(session.apply(PlaceLandmark{"front", front}));
    for (int round = 0; round < 3; ++round) {
      const SnapEdit edit = snap_all(session);
      CHECK(edit.landmarks == 4);
      CHECK(held_in_words(edit) == "4 landmarks");
      CHECK((at_landmark(session, 0) - north).norm() < 0.05);
      CHECK((at_landmark(session, 1) - south).norm() < 0.05);
      CHECK((at_landmark(session, 2) - east).norm() < 0.05);
      CHECK((at_landmark(session, 3) - front).norm() < 0.05);
      CHECK(std::abs(reach(session, -Vec3::UnitX()) - edge_mm) < 0.7);  // where nobody said anything
      if (round > 0) CHECK(edit.result.moved_mm < 0.4);
    }
  }
}

TEST_CASE("a snap draws the mesh to contours whatever the image shows but not to those outside, inexact or far away") {
  const auto circle = [](double radius_mm) {
    Contour curve;
    for (int k = 0; k < 60; ++k) {
      const double angle = 2 * std::numbers::pi * k / 60;
      curve.points.emplace_back(radius_mm * std::cos(angle), radius_mm * std::sin(angle), 0);
    }
    return std::make_shared<const std::vector<Contour>>(1, curve);
  };
  const auto snapped = [&](const std::vector<SetContours>& drawn) {
    EditSession session(ball_case(28));
    for (const SetContours& one : drawn) REQUIRE(session.apply(one));
    const SnapEdit edit = snap_all(session);
    const double there = (reach(session, Vec3::UnitX()) + reach(session, -Vec3::UnitY())) / 2;
    CHECK(std::abs(reach(session, Vec3::UnitZ()) - edge_mm) < 0.7);
    return std::pair(held_in_words(edit), there);
  };
  const auto [held, at_mm] = snapped({{.id = "c1", .curves = circle(33)}});
  CHECK(held == "1 contour");
  CHECK(at_mm == doctest::Approx(33).epsilon(0.01));
  const auto [nothing, edge] =
      snapped({{.id = "c1", .curves = circle(33), .outside = true}, {.id = "c2", .curves = circle(60)}});
  CHECK(nothing.empty());
  CHECK(snapped({{.id = "c1", .curves = circle(33), .off_mm = 3}}).first.empty());
  CHECK(edge == doctest::Approx(edge_mm).epsilon(0.02));
}

TEST_CASE("a landmark that was released or lies farther than a snap looks is not held") {
  Document document = ball_case(28);
  document.change({}, [&](Structure& first) { first.landmarks.hold = true; });
  EditSession session(document);
  REQUIRE(session.apply(PlaceLandmark{"north", Vec3(0, 0, 36)}));
  REQUIRE(session.apply(PlaceLandmark{"south", Vec3(0, 0, -28)}));
  REQUIRE(session.apply(PlaceLandmark{"east", Vec3(28, 0, 0)}));
  REQUIRE(session.apply(PlaceLandmark{"north", Vec3(0, 0, 36), false}));
  CHECK(snap_all(session).landmarks == 2);
  CHECK((at_landmark(session, 0) - Vec3(0, 0, 36)).norm() > 2);
  REQUIRE(session.apply(PlaceLandmark{"north", std::nullopt}));
  REQUIRE(session.apply(PlaceLandmark{"front", Vec3(0, -45, 0)}));
  const SnapEdit edit = snap_all(session);
  CHECK(edit.landmarks == 2);
  CHECK(edit.far_landmarks == 1);
  REQUIRE_FALSE(edit.result.warnings.empty());
  CHECK(edit.result.warnings.back().starts_with("1 placed landmark lies farther from the mesh than a snap looks"));
}

TEST_CASE("a snap holds what was pulled since the last fit and lets go of what is released") {
  for (const Tool tool : {Tool::pull, Tool::grab}) {
    EditSession session(ball_case(28));
    snap_all(session);
    const Vec3 up = Vec3::UnitZ(), out = Vec3::UnitY();
    REQUIRE(session.apply(pulled(session, 30 * up, 36 * up, tool)));
    REQUIRE(session.apply(pulled(session, 30 * out, 25 * out, tool)));
    const Points before = *session.document().view()->shape.points;
    CHECK(session.document().view()->shape.pulls == 2);
    for (int round = 0; round < 3; ++round) {
      const SnapEdit edit = snap_all(session);
      CHECK(edit.pulls == 2);
      CHECK(held_in_words(edit) == "2 pulls");
      const Points& after = *session.document().view()->shape.points;
      const VertexScalars& share = *session.document().view()->shape.pulled;
      for (Eigen::Index i = 0; i < after.rows(); ++i)
        if (share[i] > 0.97) CHECK((after.row(i) - before.row(i)).norm() < 0.7);
      CHECK(std::abs(reach(session, up) - 36) < 0.5);
      CHECK(std::abs(reach(session, -Vec3::UnitX()) - edge_mm) < 0.7);
    }
    // The part under the pointer too.
    const auto part =
        test::must(snap_shape(session.document().scan, *session.document().view(), SnapArea{36 * up, 8}, {}));
    CHECK(part.pulls == 2);
    // A snap that finishes the stroke itself does not wait for it.
    CHECK(test::must(
              snap_shape(session.document().scan, *session.document().view(), std::nullopt, {}, SnapHolds::landmarks))
              .pulls == 0);

    REQUIRE(session.apply(Confirm{36 * up, 25, false}));
    const SnapEdit released = snap_all(session);
    CHECK(released.pulls == 2);  // the other one is held still
    CHECK(std::abs(reach(session, up) - edge_mm) < 2);
    REQUIRE(session.apply(points_edit(*session.document().view(), before, FoundBy::fit)));
    CHECK(session.document().view()->shape.pulls == 0);
    CHECK(snap_all(session).pulls == 0);
    CHECK(std::abs(reach(session, out) - edge_mm) < 2);
  }
}

TEST_CASE("what is held and what snaps keep to come back from a checkpoint and with undo") {
  const Document start = ball_case(28);
  EditSession session(start);
  snap_all(session);
  REQUIRE(session.apply(pulled(session, Vec3(0, 0, 30), Vec3(0, 0, 34))));
  snap_all(session);
  const auto line = checkpoint_line(start, session.document(), 5);
  REQUIRE(line);
  const Document again = read_checkpoint(*line, start, 5).value();
  CHECK(again.view()->shape.pulls == 1);
  CHECK(*again.view()->shape.pulled == *session.document().view()->shape.pulled);
  CHECK(*again.view()->shape.unsnapped == *session.document().view()->shape.unsnapped);
  REQUIRE(session.apply(Undo{}));
  REQUIRE(session.apply(Undo{}));
  CHECK(session.document().view()->shape.pulls == 0);
  CHECK_FALSE(session.document().view()->shape.pulled);
}

TEST_CASE("where the image shows no edge a snap leaves the shape of the template and snaps do not add up") {
  EditSession session(ball_case(32, 0.05));
  const Points start = *session.document().view()->shape.points;
  Points first;
  for (int round = 0; round < 3; ++round) {
    snap_all(session);
    const Points& points = *session.document().view()->shape.points;
    CHECK(std::abs(reach(session, -Vec3::UnitX()) - edge_mm) < 0.7);
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      if (start(i, 0) < 12) continue;
      Vec3 from_others = points.row(i) - start.row(i);
      const auto ring = session.document().structure()->the_template->topology->one_ring(i);
      for (const std::int32_t j : ring)
        from_others -= Vec3(points.row(j) - start.row(j)) / static_cast<double>(ring.size());
      CHECK(from_others.norm() < 0.05);
      CHECK(std::abs(points.row(i).norm() - 31) < 2);  // between the template's size and the edge's
    }
    if (round == 0) first = points;
  }
  const Points later = *session.document().view()->shape.points - first;
  CHECK(later.rowwise().norm().maxCoeff() < 1.5);
  CHECK(later.rowwise().norm().mean() < 1);
}

}  // namespace homolog
