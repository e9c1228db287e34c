#include <algorithm>

#include "core/case/action_line.h"
#include "core/catalogue/catalogue.h"
#include "core/phantom/phantom.h"
#include "core/session/checkpoint.h"
#include "tests/case_folder.h"
#include "tests/must.h"

namespace homolog {

namespace {

/// The template's ball, blown up unevenly.
std::shared_ptr<const Points> found_points(double factor) {
  Points points = icosphere(3, 40 * factor).points;
  points.col(1) *= 1 / 1.3;
  return std::make_shared<const Points>(std::move(points));
}

std::vector<Action> some_of_every_kind() {
  return {
      SetPlacement{{Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Vec3(1, 2, 2) / 3)), 1.1, Vec3(3, 0.1, -7)}},
      PlaceLandmark{"north", Vec3(2, 1, 45)},
      PlaceLandmark{"south", Vec3(0, 2, -43)},
      PlaceLandmark{"east", Vec3(44, 2, 0)},
      PlaceLandmark{"front", Vec3(-3, -41, 1)},
      PlaceLandmark{"east", std::nullopt},
      PlaceLandmark{"east", Vec3(45, 2, 0)},
      SetLandmarkPull{LandmarkPull::similarity},
      SetLandmarkPull{LandmarkPull::warp},
      SetStiffnessBase{7.5},
      PaintStiffness{Vec3(0, 0, 40), 15, 30, 0.5},
      pull(pole, Vec3(4, 1, 52)),
      Stroke{Tool::grab, Vec3(40, 0, 0), Vec3(46, 3, 1), 8, {}, true, 1},
      Stroke{Tool::slide, Vec3(0, 40, 0), Vec3(3, 40, 2), 8, {}, false, 1},
      SetEvenSpacing{0.5},
      pull(Vec3(0, 40, 0), Vec3(0, 48, 3)),
      Stroke{Tool::relax, Vec3(0, 44, 0), Vec3(0, 44, 0), 12, {}, false, 0.7},
      Confirm{Vec3(0, 0, -40), 12, true},
      pull(Vec3(-40, 0, 0), Vec3(-45, 0, -3)),
      SetScheme{Scheme::paper, 3},
      pull(Vec3(0, -40, 0), Vec3(0, -44, 0)),
      SetScheme{Scheme::anchored, 1},
      Confirm{Vec3(0, 0, -40), 12, false},
      SetPoints{FoundBy::fit, Similarity{Eigen::Quaterniond::Identity(), 1.3, Vec3(0.1, 0, 7)}, found_points(1.3)},
      pull(Vec3(0, 0, 52), Vec3(1, 2, 55)),
      SetPoints{FoundBy::snap, std::nullopt, found_points(1.1)},
      Note{"naïve, “quoted” \\ note"},
      SetPlacement{{Eigen::Quaterniond::Identity(), 1.2, Vec3(1, 2, 3)}},
      Undo{},
      Undo{},
      Redo{},
      MirrorTemplate{},
      Undo{},
  };
}

}  // namespace

TEST_CASE("every action reads back from its line as it was") {
  for (Action action : some_of_every_kind()) {
    for (const bool joined : {false, true}) {
      const auto read = parse_action(action_line({action, {}, joined}));
      REQUIRE(read);
      CHECK(read->action == action);
      CHECK(read->joined == joined);
    }
  }
}

TEST_CASE("replaying the file alone gives the same mesh to the last bit and the same history") {
  const CaseFolder folder;
  EditSession session = folder.create();
  for (const Action& action : some_of_every_kind()) {
    const auto done = session.apply(action);
    CHECK_MESSAGE(done, action_line({action}) << ": " << (done ? "" : done.error().sentence()));
  }
  auto read = read_case(folder.case_path);
  REQUIRE(read);
  CHECK(read->warnings.empty());
  const Document &kept = session.document(), &restored = read->session.document();
  CHECK(same_document(kept, restored));
  CHECK(session.undo_name() == read->session.undo_name());
  CHECK(session.redo_name() == read->session.redo_name());
  CHECK(session.strokes() == read->session.strokes());
}

TEST_CASE("landmarks near a line place without spinning and in any order alike") {
  const auto kidney = load_template("built-in:kidney").value();
  const MeshFile truth = phantom_truth(Organ::kidney, 3).front();
  const auto placed = [&](std::vector<std::string> names) {
    EditSession session(new_document("", nullptr, kidney));
    test::must(session.apply(SetLandmarkPull{LandmarkPull::similarity}));
    for (const std::string& name : names)
      for (const Landmark& landmark : truth.landmarks)
        if (landmark.name == name) test::must(session.apply(PlaceLandmark{name, landmark.position}));
    return *session.document().view()->shape.points;
  };
  const Points poles_last = placed({"hilum", "superior pole", "inferior pole"});
  CHECK(mean_distance(poles_last, truth.points) < 8);
  CHECK(largest_difference(poles_last, placed({"inferior pole", "hilum", "superior pole"})) < 1e-9);
}

TEST_CASE("a case begun by an older rule for landmarks replays to the same points") {
  const CaseFolder folder;
  const auto replayed = [&](LandmarkRule rule) {
    fs::remove(folder.case_path);
    Document document = folder.document();
    document.change({}, [&](Structure& first) { first.landmarks.rule = rule; });
    auto session = create_case(std::move(document), folder.case_path).value();
    for (const auto& [name, at] : {std::pair("north", Vec3(2, 1, 45)), std::pair("south", Vec3(0, 9, -43)),
                                   std::pair("east", Vec3(44, 2, 0)), std::pair("front", Vec3(1, -48, 5))})
      test::must(session.apply(PlaceLandmark{name, at}));
    auto read = read_case(folder.case_path);
    REQUIRE(read);
    CHECK(read->session.document().structure()->landmarks.rule == rule);
    CHECK(largest_difference(*read->session.document().view()->shape.points, *session.document().view()->shape.points) <
          1e-12);
    return session.document().view()->shape;
  };
  const Shape oldest = replayed(LandmarkRule::closed_form), older = replayed(LandmarkRule::weighed),
              now = replayed(LandmarkRule::by_size);
  CHECK(oldest.placement.rotation.angularDistance(older.placement.rotation) > 1e-4);
  CHECK(older.placement == now.placement);
  CHECK(largest_difference(*older.points, *now.points) > 1e-4);
}

TEST_CASE("undo takes back everything one by one and redo does it again") {
  const CaseFolder folder;
  EditSession session = folder.create();
  const Points start = *session.document().view()->shape.points;
  for (const Action& action : some_of_every_kind()) REQUIRE(session.apply(action));
  while (session.can_redo()) REQUIRE(session.apply(Redo{}));
  const Points end = *session.document().view()->shape.points;
  while (session.can_undo()) REQUIRE(session.apply(Undo{}));
  CHECK(*session.document().view()->shape.points == start);
  CHECK(session.document().view()->shape.landmarks.empty());
  CHECK(!session.apply(Undo{}));
  while (session.can_redo()) REQUIRE(session.apply(Redo{}));
  CHECK(*session.document().view()->shape.points == end);
}

TEST_CASE("joined edits are one step of the history, in the file too") {
  const CaseFolder folder;
  EditSession session = folder.create();
  const auto paint = [](double x) { return PaintStiffness{Vec3(x, 0, 40), 6, 50, 0.5}; };
  REQUIRE(session.apply(pull(pole, Vec3(0, 0, 50))));
  const auto pulled = session.shared_document();
  REQUIRE(session.apply(paint(0)));
  REQUIRE(session.apply(paint(5), true));
  REQUIRE(session.apply(paint(10), true));
  const VertexScalars painted = *session.document().structure()->paint.stiffness;
  auto read = read_case(folder.case_path);
  REQUIRE(read);
  for (EditSession* one : {&session, &read->session}) {
    REQUIRE(one->apply(Undo{}));
    CHECK(*one->document().structure()->paint.stiffness == *pulled->structure()->paint.stiffness);
    CHECK(one->undo_name().starts_with(action_name(pull(pole, pole)) + " 10 mm, "));
    REQUIRE(one->apply(Redo{}));
    CHECK(*one->document().structure()->paint.stiffness == painted);
    CHECK_FALSE(one->can_redo());
  }
  // What is taken back or refused joins nothing.
  REQUIRE(session.apply(Undo{}));
  REQUIRE(session.apply(paint(-5), true));
  REQUIRE(session.apply(Undo{}));
  CHECK(*session.document().view()->shape.points == *pulled->view()->shape.points);
  CHECK_FALSE(session.apply(PaintStiffness{pole, -1, 50, 0.5}));
  REQUIRE(session.apply(paint(0), true));
  REQUIRE(session.apply(Undo{}));
  CHECK(*session.document().view()->shape.points == *pulled->view()->shape.points);
}

TEST_CASE("points that were found are taken as they are and lines with other counts are refused") {
  const CaseFolder folder;
  EditSession session(folder.document());
  const auto found = found_points(1.2);
  REQUIRE(session.apply(SetPoints{FoundBy::fit, std::nullopt, found}));
  CHECK(*session.document().view()->shape.points == *found);
  CHECK(*session.document().view()->shape.reference == session.document().structure()->the_template->points);
  CHECK(session.undo_name() == "fit");
  CHECK(!session.apply(SetPoints{FoundBy::fit, std::nullopt, std::make_shared<const Points>(Points::Zero(5, 3))}));
  Points broken = *found;
  broken(7, 1) = std::nan("");
  CHECK(!session.apply(SetPoints{FoundBy::fit, std::nullopt, std::make_shared<const Points>(broken)}));
  CHECK(!parse_action(R"({"points":[1,2],"by":"fit"})"));
  CHECK(!parse_action(R"({"points":[1,2,"x"],"by":"fit"})"));
}

TEST_CASE("a preview changes neither the document nor the file") {
  const CaseFolder folder;
  EditSession session = folder.create();
  const std::string before = folder.text();
  const auto shown = session.preview(pull(pole, Vec3(0, 0, 50)));
  REQUIRE(shown);
  CHECK(*shown->document.view()->shape.points != *session.document().view()->shape.points);
  CHECK(folder.text() == before);
}

TEST_CASE("a preview goes on with what is computed of it and says where that is refused") {
  const CaseFolder folder;
  EditSession session(folder.document());
  const Compute twice = [](const Document& document, const std::string&) -> Result<std::optional<Action>> {
    return SetPoints{FoundBy::model, std::nullopt, std::make_shared<const Points>(2 * *document.view()->shape.points)};
  };
  const Compute nothing = [](const Document&, const std::string&) -> Result<std::optional<Action>> {
    return std::optional<Action>();
  };
  const Compute refused = [](const Document&, const std::string&) -> Result<std::optional<Action>> {
    return fail("", "Not today.");
  };
  const Stroke stroke = pull(pole, Vec3(0, 0, 50));
  const Points plain = *session.preview(stroke).value().document.view()->shape.points;
  const Updated followed = session.preview(stroke, {nothing, twice, refused}).value();
  CHECK(*followed.document.view()->shape.points == 2 * plain);
  CHECK(followed.report.message.find("Not today") != std::string::npos);
  CHECK(*session.preview(std::nullopt, {twice}).value().document.view()->shape.points ==
        2 * *session.document().view()->shape.points);
}

TEST_CASE("what strokes and fits decide is known until it is undone and what a model did is not") {
  const CaseFolder folder;
  Document document = folder.document();
  Volume cine;
  cine.geometry.dims = {2, 2, 2};
  cine.frames = 2;
  cine.data = std::vector<std::int16_t>(16);
  document.scan.image = std::make_shared<const Volume>(std::move(cine));
  EditSession session(std::move(document));
  const auto known = [&] { return known_vertices(session.document().view()->shape); };
  CHECK(known().isZero());
  REQUIRE(session.apply(SetPoints{FoundBy::model, std::nullopt, found_points(1.1)}));
  CHECK(known().isZero());
  REQUIRE(session.apply(pull(pole, Vec3(0, 0, 50))));
  CHECK(known().maxCoeff() == 1);
  CHECK(known().mean() < 0.3);
  SetPoints fit{FoundBy::fit, std::nullopt, session.document().view()->shape.points};
  fit.doubt_mm = doubt_on_grid(VertexScalars::Ones(known().size()));
  fit.outlier = std::make_shared<const VertexScalars>(VertexScalars::Ones(known().size()));
  REQUIRE(session.apply(fit));
  REQUIRE(session.document().view()->shape.doubt_mm);
  REQUIRE(session.apply(SetFrame{1}));
  REQUIRE(session.apply(StartFrameFrom{0}));
  CHECK(*session.document().view()->shape.points == *session.document().structure()->shape(0)->points);
  CHECK(known().isZero());
  CHECK_FALSE(session.document().view()->shape.doubt_mm);  // it was of the other frame
  CHECK_FALSE(session.document().view()->shape.outlier);
  REQUIRE(session.apply(SetPoints{FoundBy::fit, std::nullopt, found_points(1.2)}));
  CHECK(known().minCoeff() == 1);
  for (int step = 0; step < 5; ++step) REQUIRE(session.apply(Undo{}));
  CHECK(known().isZero());
}

TEST_CASE("what edits alone made of a shape goes along with edits of the aided one") {
  const CaseFolder folder;
  EditSession session = folder.create();
  const auto shape = [&]() -> const Shape& { return session.document().view()->shape; };
  const auto largest = [](const Points& a, const Points& b) { return (a - b).cwiseAbs().maxCoeff(); };
  const Points begun = *shape().points;
  const auto aided = found_points(1.2);
  CHECK(unaided_points(shape()) == begun);
  REQUIRE(session.apply(SetPoints{FoundBy::model, std::nullopt, aided}));
  CHECK(unaided_points(shape()) == begun);

  // Relax takes out of the mesh what it takes out, not as much again of what the edits made.
  REQUIRE(session.apply(Stroke{.tool = Tool::relax, .at = 1.2 * pole, .sigma_mm = 30, .strength = 1}));
  const Points relaxed = *shape().points, unaided = unaided_points(shape());
  int there = 0;
  for (Eigen::Index i = 0; i < begun.rows(); ++i) {
    CHECK((unaided.row(i) == begun.row(i) || unaided.row(i) == relaxed.row(i)));
    there += unaided.row(i) == relaxed.row(i);
  }
  CHECK(there > 100);
  REQUIRE(session.apply(Undo{}));

  // A refinement moves both alike, a placement carries both.
  Points along = *aided;
  along.col(0).array() += 2;
  REQUIRE(session.apply(SetPoints{FoundBy::refinement, std::nullopt, std::make_shared<const Points>(along)}));
  CHECK(largest(unaided_points(shape()), begun.rowwise() + Eigen::RowVector3d(2, 0, 0)) < 1e-9);
  Similarity moved = shape().placement;
  moved.translation += Vec3(0, 0, 100);
  REQUIRE(session.apply(SetPlacement{moved}));
  CHECK(largest(unaided_points(shape()), begun.rowwise() + Eigen::RowVector3d(2, 0, 100)) < 1e-9);
  REQUIRE(session.apply(Undo{}));
  REQUIRE(session.apply(Undo{}));

  // Replayed it is the same, and what something else put somewhere is no help.
  CHECK(*read_case(folder.case_path)->session.document().view()->shape.unaided == *shape().unaided);
  REQUIRE(session.apply(SetPoints{FoundBy::fit, std::nullopt, found_points(1.1)}));
  CHECK(shape().unaided == nullptr);
}

TEST_CASE("the doubt of a fit is kept until vertices are put elsewhere along the surface") {
  const CaseFolder folder;
  EditSession session = folder.create();
  const auto shape = [&]() -> const Shape& { return session.document().view()->shape; };
  const Eigen::Index n = shape().points->rows();
  SetPoints fit{FoundBy::fit, std::nullopt, found_points(1.1)};
  fit.doubt_mm = doubt_on_grid(VertexScalars::LinSpaced(n, 0.2, 4));
  CHECK(doubt_left_mm(shape()).size() == 0);
  REQUIRE(session.apply(fit));
  CHECK((doubt_left_mm(shape()) - VertexScalars::LinSpaced(n, 0.2, 4)).cwiseAbs().maxCoeff() < 0.002);
  REQUIRE(session.apply(SetPoints{FoundBy::snap, std::nullopt, found_points(1.12)}));
  REQUIRE(session.apply(Confirm{Vec3(0, 0, -40), 12, true}));

  const VertexScalars left = doubt_left_mm(shape());
  REQUIRE(left.size() == n);
  for (Eigen::Index i = 0; i < n; ++i) CHECK(left[i] == (*fit.doubt_mm)[i] * (1 - (*shape().confirmed)[i]));
  CHECK(left.minCoeff() == 0);
  CHECK(*to_mesh_file(*session.document().view(), false).doubt_mm == left);
  CHECK(doubt_left_mm(read_case(folder.case_path)->session.document().view()->shape) == left);

  REQUIRE(session.apply(SetPoints{FoundBy::propagation, std::nullopt, found_points(1)}));
  CHECK(doubt_left_mm(shape()).size() == 0);
  REQUIRE(session.apply(Undo{}));
  CHECK(doubt_left_mm(shape()) == left);
  Similarity larger = shape().placement;
  larger.scale *= 1.2;
  REQUIRE(session.apply(SetPlacement{larger}));
  CHECK(doubt_left_mm(shape()).size() == 0);
  REQUIRE(session.apply(Undo{}));
  REQUIRE(session.apply(MirrorTemplate{}));
  CHECK(doubt_left_mm(shape()).size() == 0);
  REQUIRE(session.apply(Undo{}));
  CHECK(doubt_left_mm(shape()) == left);
  fit.doubt_mm = doubt_on_grid(VertexScalars::Ones(n - 1));
  CHECK_FALSE(session.apply(fit));
}

TEST_CASE("a mirrored template lies where the mesh lay as its mirror image and older lines replay as they did") {
  const CaseFolder folder;
  // A template of another scan, as a fit has placed it here: a little turned, and far from its own frame's middle.
  MeshFile far = read_mesh_file(folder.template_path).value();
  for (auto p : far.points.rowwise())
    p = p.cwiseProduct(Eigen::RowVector3d(1, 0.6, 0.8)) + Eigen::RowVector3d(-180, 90, 700);
  far.landmarks.clear();
  far.comments.push_back(faced_comment({"left lung", false}));
  REQUIRE(write_mesh_file(far, folder.template_path));
  EditSession session = folder.create();
  const auto shape = [&]() -> const Shape& { return session.document().view()->shape; };
  const auto faced = [](const Document& document) { return document.view()->the_template().faced; };
  Similarity placement;
  placement.rotation = Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized());
  placement.scale = 1.1;
  placement.translation = Vec3(20, -5, 8);
  const auto fitted = std::make_shared<const Points>(placement.apply(far.points));
  REQUIRE(session.apply(SetPoints{FoundBy::fit, placement, fitted}));
  const Eigen::RowVector3d centre = fitted->colwise().mean();

  REQUIRE(session.apply(MirrorTemplate{}));
  Points image = fitted->rowwise() - centre;
  image.col(0) *= -1;
  CHECK((shape().points->rowwise() - centre - image).cwiseAbs().maxCoeff() < 1e-9);
  CHECK(*shape().points == *shape().placed);
  CHECK(shape().before_landmarks == shape().placement);
  CHECK(faced(session.document()) == FacedNames{"right lung", false});
  const Points mirrored = *shape().points;
  const auto again = read_case(folder.case_path);
  REQUIRE(again);
  CHECK(*again->session.document().view()->shape.points == mirrored);
  CHECK(faced(again->session.document()) == FacedNames{"right lung", false});
  REQUIRE(session.apply(MirrorTemplate{}));  // there and back
  CHECK(faced(session.document()) == FacedNames{"left lung", false});
  CHECK((*shape().points - *fitted).cwiseAbs().maxCoeff() < 1e-9);

  REQUIRE(session.apply(parse_action(R"({"mirror":"sagittal"})").value().action));
  CHECK((shape().points->colwise().mean() - centre).norm() > 300);
}

TEST_CASE("what a scan lacks is kept with the fit and goes into files") {
  const CaseFolder folder;
  EditSession session = folder.create();
  const auto shape = [&]() -> const Shape& { return session.document().view()->shape; };
  VertexScalars marks = VertexScalars::Zero(shape().points->rows());
  marks.head(5).setOnes();
  SetPoints fit{FoundBy::fit, std::nullopt, found_points(1.1)};
  fit.outlier = std::make_shared<const VertexScalars>(marks);
  REQUIRE(session.apply(fit));
  REQUIRE(session.apply(SetPoints{FoundBy::snap, std::nullopt, found_points(1.12)}));
  REQUIRE(shape().outlier);
  CHECK(*shape().outlier == marks);
  CHECK(*to_mesh_file(*session.document().view(), false).outlier == marks);
  const auto again = read_case(folder.case_path);
  REQUIRE(again);
  CHECK(*again->session.document().view()->shape.outlier == marks);

  REQUIRE(session.apply(SetPoints{FoundBy::fit, std::nullopt, found_points(1)}));
  CHECK_FALSE(shape().outlier);
  REQUIRE(session.apply(Undo{}));
  CHECK(*shape().outlier == marks);
  fit.outlier = std::make_shared<const VertexScalars>(marks.head(4));
  CHECK_FALSE(session.apply(fit));
}

TEST_CASE("a stroke is kept exactly as its preview showed it") {
  const CaseFolder folder;
  EditSession session = folder.create();
  Updated shown;
  for (double angle = 0; angle < 0.3; angle += 0.01) {
    shown = session.preview(pull(pole, 45 * Vec3(std::sin(angle), 0, std::cos(angle)))).value();
  }
  const Vec3 last = 45 * Vec3(std::sin(0.29), 0, std::cos(0.29));
  shown = session.preview(pull(pole, last)).value();
  REQUIRE(session.apply(pull(pole, last)));
  CHECK(largest_difference(*shown.document.view()->shape.points, *session.document().view()->shape.points) < 1e-9);
}

}  // namespace homolog
