#include <doctest/doctest.h>

#include <atomic>

#include "app/editor/work/fitter.h"
#include "app/editor/work/models/build_study_model.h"
#include "app/editor/work/models/model_help.h"
#include "core/base/processes/parallel.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/voxels/label_map.h"
#include "core/model/shape_model.h"
#include "tests/ball.h"
#include "tests/must.h"

// What the editor does on threads of its own for the case: the fit to a label, and the model's help.

namespace homolog {

namespace {

/// Label 2 is a ball of 24 mm about (60, 60, 60).
std::shared_ptr<const Volume> labels() {
  VolumeGeometry grid;
  grid.dims = {60, 60, 60};
  grid.spacing_mm.setConstant(2);
  const Mesh organ = icosphere(3, 24, Vec3::Constant(60));
  return std::make_shared<const Volume>(label_map(organ, grid, 2));
}

std::shared_ptr<const Document> case_of(const std::shared_ptr<const Template>& the_template) {
  return std::make_shared<const Document>(new_document("", nullptr, the_template));
}

FitSettings settings() {
  FitSettings chosen;
  chosen.label = 2;
  return chosen;
}

/// Balls of 20, 22, 24 and 26 mm as a study's model, and the last of them a case.
std::shared_ptr<const StudyModel> balls_model() {
  StudyModel model;
  PrincipalComponents components;
  for (const int radius_mm : {20, 22, 24, 26}) {
    const std::string name = "ball" + std::to_string(radius_mm);
    model.places.emplace(name, model.names.size());
    model.names.push_back(name);
    const Mesh mesh = icosphere(3, radius_mm);
    Points points = mesh.points;
    if (radius_mm == 22) points.col(2) *= 1.2;
    model.topology = mesh.topology;
    const Eigen::VectorXd shape = points.reshaped<Eigen::RowMajor>();
    if (components.mean.size() == 0) components.mean = shape;
    components.centred.conservativeResize(shape.size(), components.centred.cols() + 1);
    components.centred.rightCols<1>() = shape - components.mean;
    model.sizes_mm.push_back(centroid_size_mm(points));
  }
  model.mean = {model.topology, points_of(components.mean)};
  model.components = std::make_shared<const PrincipalComponents>(std::move(components));
  return std::make_shared<const StudyModel>(std::move(model));
}

}  // namespace

TEST_CASE("a fit shows its steps and gives the shape of the label") {
  std::atomic<int> woken = 0;
  Fitter fitter([&] { ++woken; });
  const auto document = case_of(ball_template(20));
  fitter.start_fit(document, {labels(), "labels"}, settings());
  CHECK(fitter.document() == document);
  fitter.finish();
  CHECK(woken > 3);
  CHECK(fitter.take_step());
  CHECK_FALSE(fitter.take_step());
  const auto done = fitter.take();
  REQUIRE(done);
  const Fitted& fitted = test::must(*done);
  CHECK(fitted.figures.dice.value() > 0.97);
  CHECK(fitted.figures.remarks.empty());
  CHECK(fitted.figures.warnings.empty());
  const VertexScalars radii = (fitted.edit.points->rowwise() - Vec3::Constant(60).transpose()).rowwise().norm();
  CHECK(radii.minCoeff() > 23);
  CHECK(radii.maxCoeff() < 25);
  CHECK_FALSE(fitter.document());
  CHECK_FALSE(fitter.take());
}

TEST_CASE("a fit has the same bits whatever the number of threads") {
  const int before = thread_limit();
  std::vector<Points> fitted;
  for (const int threads : {1, 2, 7}) {
    set_thread_limit(threads);
    Fitter fitter([] {});
    fitter.start_fit(case_of(ball_template(20)), {labels(), "labels"}, settings());
    fitter.finish();
    fitted.push_back(*test::must(*fitter.take()).edit.points);
  }
  set_thread_limit(before);
  CHECK(fitted[0] == fitted[1]);
  CHECK(fitted[0] == fitted[2]);
}

TEST_CASE("a fit that was cancelled gives nothing and one to an absent label says so") {
  Fitter fitter([] {});
  fitter.start_fit(case_of(ball_template(20)), {labels(), "labels"}, settings());
  fitter.cancel();
  CHECK_FALSE(fitter.busy());
  CHECK_FALSE(fitter.take());
  CHECK_FALSE(fitter.take_step());
  FitSettings absent;
  absent.label = 7;
  fitter.start_fit(case_of(ball_template(20)), {labels(), "labels"}, absent);
  fitter.finish();
  const auto done = fitter.take();
  REQUIRE(done);
  CHECK_FALSE(*done);
}

TEST_CASE("the model completes what strokes leave open and leaves alone what is known") {
  ModelHelp help([] {});
  const auto study = balls_model();
  CHECK_FALSE(help.completion(1));
  help.ask(study, "ball26", false);
  help.finish();
  CHECK_FALSE(help.update());
  CHECK_FALSE(help.completion(0));

  EditSession session(new_document("", nullptr, ball_template(26)));
  const Points begun = *session.document().view()->shape.points;
  REQUIRE(session.apply(Confirm{Vec3(26, 0, 0), 15, true}));
  const VertexScalars held = *session.document().view()->shape.confirmed;
  const auto helped = [&](double strength) {
    return *test::must(session.preview(std::nullopt, {help.completion(strength)})).document.view()->shape.points;
  };
  const Points half = helped(0.5), full = helped(1);
  CHECK((full - begun).norm() > 0.1);
  CHECK((half - begun).norm() == doctest::Approx((full - begun).norm() / 2).epsilon(1e-4));
  for (Eigen::Index i = 0; i < held.size(); ++i)
    if (held[i] >= 1) CHECK(full.row(i) == begun.row(i));

  // A pull is completed while it is dragged: what it moved stays as it put it, the rest follows the model.
  Stroke pull;
  pull.at = Vec3(0, 0, 26);
  pull.to = Vec3(0, 0, 30);
  pull.sigma_mm = 8;
  const Document plain = test::must(session.preview(pull)).document;
  const Document completed = test::must(session.preview(pull, {help.completion(1)})).document;
  const VertexScalars known = known_vertices(plain.view()->shape);
  CHECK(known.maxCoeff() == 1);
  CHECK(known.mean() < 0.5);
  const VertexScalars moved = (*completed.view()->shape.points - *plain.view()->shape.points).rowwise().norm();
  for (Eigen::Index i = 0; i < known.size(); ++i)
    if (known[i] >= 1) CHECK(moved[i] == 0);
  CHECK(moved.maxCoeff() > 0.01);
  CHECK(known_vertices(completed.view()->shape) == known);
}

TEST_CASE("a model without one shape is the model of the others whatever that one is") {
  // Two studies that differ in the one that is left out, which alone is turned, far away and long.
  const auto study_with = [](double stretch, double turn) {
    std::vector<Points> shapes;
    for (const double share : {1.0, 1.1, 0.9, 1.05}) {
      shapes.push_back(icosphere(2, 20).points);
      shapes.back().col(2) *= share;
      shapes.back().col(0) *= 2 - share * share;
    }
    const Eigen::AngleAxisd turned(turn, Vec3(1, 2, 3).normalized());
    shapes.back().col(1) *= stretch;
    shapes.back() =
        Points(shapes.back() * turned.toRotationMatrix().transpose()).rowwise() + Eigen::RowVector3d(9, 9, 9);
    TrainingSet set;
    set.topology = icosphere(2, 20).topology;
    set.shapes.resize(shapes.front().size(), std::ssize(shapes));
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      set.names.push_back("ball" + std::to_string(k));
      set.shapes.col(static_cast<Eigen::Index>(k)) =
          Eigen::Map<const Eigen::VectorXd>(shapes[k].data(), shapes[k].size());
    }
    return test::must(make_study_model(std::move(set), std::vector<std::string>(4), Alignment::similarity, Progress()));
  };
  const auto plain = test::must(model_without(*study_with(1.2, 0), 3)),
             other = test::must(model_without(*study_with(3, 1.5), 3));
  CHECK((plain.mean - other.mean).cwiseAbs().maxCoeff() < 1e-6);
  CHECK((plain.variances - other.variances).cwiseAbs().maxCoeff() < 1e-6 * plain.variances[0]);
}

TEST_CASE("the model's help does not add up and can be taken back") {
  ModelHelp help([] {});
  help.ask(balls_model(), "ball26", false);
  help.finish();
  CHECK_FALSE(help.update());
  EditSession session(new_document("", nullptr, ball_template(26)));
  REQUIRE(session.apply(Confirm{Vec3(26, 0, 0), 15, true}));
  const auto points = [&] { return *session.document().view()->shape.points; };
  const auto blend = [&](double strength) {
    REQUIRE(session.apply(*test::must(help.completion(strength)(session.document(), {}))));
  };
  const Points begun = points();
  blend(0.5);
  const Points half = points();
  CHECK((half - begun).norm() > 0.1);
  blend(0.5);
  CHECK((points() - half).norm() < 1e-4);

  // An edit moves the aided shape and the one without help alike; what follows is as if the model came in just now.
  Stroke grab;
  grab.tool = Tool::grab;
  grab.at = Vec3(0, 0, 26);
  grab.to = Vec3(0, 3, 28);
  grab.sigma_mm = 8;
  REQUIRE(session.apply(grab));
  blend(0.5);
  const Points aided = points(), unaided = unaided_points(session.document().view()->shape);
  blend(0.5);
  CHECK((points() - aided).norm() < 1e-4);
  REQUIRE(session.apply(
      points_edit(*session.document().view(), unaided_points(session.document().view()->shape), FoundBy::model)));
  CHECK((points() - unaided).cwiseAbs().maxCoeff() < 2e-5);  // computed edits are rounded to 2⁻¹⁶ mm
  CHECK((unaided - aided).norm() > 0.05);
}

TEST_CASE("the model helps a case that the study holds flipped as it helps the mirror image of it") {
  const Mesh ball = icosphere(3, 26);
  Triangles turned = ball.topology->triangles();
  turned.col(1).swap(turned.col(2));
  MeshFile mirrored{ball.points, turned};
  mirrored.points.col(0) *= -1;
  const auto other_side = test::must(make_template(std::move(mirrored), "other side.ply"));
  const auto study = balls_model();
  const auto moved_by_help = [&](const std::shared_ptr<const Template>& the_template, bool flipped, double side) {
    ModelHelp help([] {});
    help.ask(study, "ball26", flipped);
    help.finish();
    REQUIRE_FALSE(help.update());
    EditSession session(new_document("", nullptr, the_template));
    REQUIRE(session.apply(Confirm{Vec3(side * 26, 0, 0), 15, true}));
    const Points before = *session.document().view()->shape.points;
    const auto helped = test::must(session.preview(std::nullopt, {help.completion(1)}));
    return Points(*helped.document.view()->shape.points - before);
  };
  const Points lying = moved_by_help(ball_template(26), false, 1);
  Points flipped = moved_by_help(other_side, true, -1);
  REQUIRE(lying.norm() > 0.1);
  flipped.col(0) *= -1;
  CHECK((flipped - lying).cwiseAbs().maxCoeff() < 1e-3);
  // As it lies the other side is no shape of the model.
  Points as_it_lies = moved_by_help(other_side, false, -1);
  as_it_lies.col(0) *= -1;
  CHECK((as_it_lies - lying).cwiseAbs().maxCoeff() > 0.1);
}

}  // namespace homolog
