#include <cmath>
#include <numbers>

#include "core/adapt/contours/contour_fit.h"
#include "core/assist/assist.h"
#include "core/session/checkpoint.h"
#include "tests/case_folder.h"
#include "tests/must.h"

// Contours as a part of a case.

namespace homolog {

namespace {

using Curves = std::vector<Contour>;

/// A circle about the z axis.
Contour circle(double radius_mm, double z_mm, double x_mm = 0) {
  Contour curve;
  for (int k = 0; k < 40; ++k) {
    const double angle = 2 * std::numbers::pi * k / 40;
    curve.points.emplace_back(x_mm + radius_mm * std::cos(angle), radius_mm * std::sin(angle), z_mm);
  }
  return curve;
}

SetContours drawn(const char* id, Curves curves) {
  return {.id = id, .name = "drawn", .curves = std::make_shared<const Curves>(std::move(curves))};
}

/// Slices of a ball of 46 mm about x = 3 mm.
Curves slices_of_larger_ball() {
  Curves curves;
  for (const double z : {-30.0, -15.0, 0.0, 15.0, 30.0}) curves.push_back(circle(std::sqrt(46.0 * 46 - z * z), z, 3));
  return curves;
}

/// The mean distance of a mesh from a ball about x = 3 mm.
double off_ball_mm(const Points& points, double radius_mm) {
  return ((points.rowwise() - Eigen::RowVector3d(3, 0, 0)).rowwise().norm().array() - radius_mm).abs().mean();
}

}  // namespace

TEST_CASE("contours are added and changed and removed and each is a step that comes back") {
  const CaseFolder folder;
  EditSession session = folder.create();
  REQUIRE(session.apply(drawn("c1", {circle(40, 0)})));
  REQUIRE(session.apply(SetContours{.id = "c1", .off_mm = 1.5, .outside = true}));
  const auto set = [&] { return session.document().structure()->contour_set("c1"); };
  REQUIRE(set() != nullptr);
  CHECK(set()->name == "drawn");
  CHECK(set()->off_mm == 1.5);
  CHECK(set()->outside);
  CHECK(set()->curves == Curves{circle(40, 0)});
  CHECK(free_contour_id(session.document()) == "c2");
  REQUIRE(session.apply(RemoveContours{"c1"}));
  CHECK(set() == nullptr);
  REQUIRE(session.apply(Undo{}));
  CHECK(set()->outside);
  REQUIRE(session.apply(Undo{}));
  CHECK_FALSE(set()->outside);
  REQUIRE(session.apply(Undo{}));
  CHECK(session.document().structure()->contours.empty());
  REQUIRE(session.apply(Redo{}));
  const auto again = read_case(folder.case_path);
  REQUIRE(again);
  CHECK(same_document(again->session.document(), session.document()));
}

TEST_CASE("one curve of several takes another's place in one step and the rest stays") {
  const CaseFolder folder;
  EditSession session = folder.create();
  REQUIRE(session.apply(drawn("c1", {circle(40, 0), circle(30, 10), circle(20, 20)})));
  REQUIRE(session.apply(SetContours{.id = "c1", .off_mm = 1.5, .outside = true}));
  const auto other = [](const char* id, Curves curves, int number) {
    return SetContours{.id = id, .curves = std::make_shared<const Curves>(std::move(curves)), .curve = number};
  };
  Contour open = circle(33, 10);
  open.closed = false;
  REQUIRE(session.apply(other("c1", {open}, 1)));
  const auto set = [&] { return session.document().structure()->contour_set("c1"); };
  CHECK(set()->curves == Curves{circle(40, 0), open, circle(20, 20)});
  CHECK(set()->name == "drawn");
  CHECK(set()->off_mm == 1.5);
  CHECK(set()->outside);
  const auto again = read_case(folder.case_path);
  REQUIRE(again);
  CHECK(same_document(again->session.document(), session.document()));
  REQUIRE(session.apply(Undo{}));
  CHECK(set()->curves[1] == circle(30, 10));

  for (const SetContours& refused :
       {other("c1", {open}, 3), other("c1", {open}, -1), other("c1", {open, open}, 1), other("c2", {open}, 0),
        other("c1", {Contour{{Vec3(0, 0, 0)}}}, 1), SetContours{.id = "c1", .curve = 1}})
    CHECK_FALSE(session.apply(refused));
  CHECK(session.apply(other("c1", {open}, 3)).error().sentence().find("have no curve 3; they have 3, from 0") !=
        std::string::npos);
  CHECK(set()->curves[1] == circle(30, 10));
}

TEST_CASE("contours that no case can hold are refused and nothing changes") {
  const CaseFolder folder;
  EditSession session = folder.create();
  REQUIRE(session.apply(drawn("c1", {circle(40, 0)})));
  Contour two{{Vec3(0, 0, 0), Vec3(1, 0, 0)}}, far = circle(40, 0);
  far.points[1].x() = 2e9;
  for (const Action& refused : std::vector<Action>{drawn("c1", {circle(30, 0)}), drawn("", {circle(30, 0)}),
                                                   drawn("c2", {}), drawn("c2", {two}), drawn("c2", {far}),
                                                   SetContours{.id = "c2"}, SetContours{.id = "c1", .off_mm = -1},
                                                   SetContours{.id = "c1", .name = "\xff"}, RemoveContours{"c2"}}) {
    CAPTURE(action_name(refused));
    CHECK_FALSE(session.apply(refused));
  }
  CHECK(lines_of(folder.case_path).size() == 2);
  two.closed = false;
  CHECK(session.apply(drawn("c2", {two})));
}

TEST_CASE("the mesh goes to the contours of its frame and those outside only hold it back") {
  const CaseFolder folder;
  EditSession session = folder.create();
  const auto fit = [&] { return fit_shape_to_contours(*session.document().view(), {}, false, {}); };
  CHECK(fit().error().what.find("no contour in this frame") != std::string::npos);
  REQUIRE(session.apply(drawn("c1", slices_of_larger_ball())));
  CHECK(off_ball_mm(*session.document().view()->shape.points, 46) > 5.5);
  const FitEdit fitted = test::must(fit());
  CHECK(off_ball_mm(*fitted.action.points, 46) < 0.4);

  // Far outside of the organ, and said to be so, they move it little.
  REQUIRE(session.apply(SetContours{.id = "c1", .outside = true}));
  const double outside_mm =
      contour_distance(drawn_contours(*session.document().view()),
                       {session.document().structure()->the_template->topology, *test::must(fit()).action.points})
          .mean_mm;
  CHECK(outside_mm < 0.1);
}

TEST_CASE("a mesh that was pulled goes on to contours from where it is and a fit begins anew") {
  const CaseFolder folder;
  EditSession session = folder.create();
  REQUIRE(session.apply(pull(-pole, -1.25 * pole, 8)));
  REQUIRE(session.apply(drawn("c1", {circle(44, 0)})));
  const auto lowest = [](const FitEdit& edit) { return edit.action.points->col(2).minCoeff(); };
  const ShapeView shown = *session.document().view();
  const FitEdit goes_on = test::must(fit_shape_to_contours(shown, {}, true, {})),
                anew = test::must(fit_shape_to_contours(shown, {}, false, {}));
  CHECK(lowest(goes_on) < -47);
  CHECK(lowest(anew) > -46);
  CHECK(goes_on.action.by == FoundBy::contours);
  CHECK_FALSE(goes_on.action.placement);
  // What was pulled is still known to be after it.
  REQUIRE(session.apply(goes_on.action));
  CHECK(session.document().view()->shape.pulls == 1);
  REQUIRE(session.apply(anew.action));
  CHECK(session.document().view()->shape.pulls == 0);
}

TEST_CASE("a single contour leaves the placement to where the mesh lies") {
  const CaseFolder folder;
  EditSession session = folder.create();
  REQUIRE(session.apply(drawn("c1", {circle(42, 0)})));
  const FitEdit fitted = test::must(fit_shape_to_contours(*session.document().view(), {}, true, {}));
  const Box box = bounds_of(*fitted.action.points);
  CHECK(box.max().x() == doctest::Approx(42).epsilon(0.01));
  CHECK(box.max().z() < 44);
  CHECK(box.max().z() > 39);
}

}  // namespace homolog
