#include "app/editor/work/models/study_appearance.h"
#include "app/editor/work/snaps.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/session/case_file.h"
#include "core/volume/volume_io.h"
#include "tests/ball.h"
#include "tests/beating_ball.h"
#include "tests/desk.h"
#include "tests/failing_memory.h"
#include "tests/temporary_folder.h"
#include "tests/thread_limit.h"
#include "tests/wait.h"

namespace homolog {

namespace fs = std::filesystem;

TEST_CASE("the key N snaps the part under the pointer or else the whole mesh and Shift+N switches it on for strokes") {
  Desk desk;
  const Eigen::Vector2d at = desk.on_outline(ViewKind::axial);
  desk.send(MouseMove{}, at.x(), at.y());
  desk.send(KeyPress{'N'}, at.x(), at.y());
  auto snaps = desk.sent<SnapMesh>();
  REQUIRE(snaps.size() == 1);
  REQUIRE(snaps[0].region);
  CHECK((snaps[0].region->at - *desk.state.pointer.hover->on_mesh).norm() < 1e-9);
  CHECK(snaps[0].region->sigma_mm == desk.state.hand.sigma_mm());
  desk.state.pointer.hover.reset();
  press_key(desk.state, {}, 'N', desk.context(), desk.out);
  snaps = desk.sent<SnapMesh>();
  REQUIRE(snaps.size() == 1);
  CHECK_FALSE(snaps[0].region);

  const auto drag = [&] {
    desk.send(MousePress{}, at.x(), at.y());
    desk.send(MouseMove{}, at.x() - 10, at.y());
    desk.send(MouseRelease{}, at.x() - 10, at.y());
  };
  drag();
  CHECK(desk.sent<SnapMesh>().empty());
  desk.send(KeyPress{'N'}, at.x(), at.y(), true);
  CHECK(desk.state.automatic.snap.with_strokes);
  drag();
  CHECK(desk.sent<SnapMesh>().size() == 1);
  desk.send(KeyPress{'N'}, at.x(), at.y(), true);
  CHECK_FALSE(desk.state.automatic.snap.with_strokes);
}

TEST_CASE("a snap comes after what was asked before it and is undone as one step") {
  SessionThread session(EditSession(demo()), [] {});
  const Points before = *demo().view()->shape.points;
  session.apply(Confirm{Vec3(before.row(0)), 10, true});
  Snaps snaps;
  SnapSettings settings;
  snaps.start(session, std::nullopt, settings);
  session.apply(Note{"afterwards"});
  EditSession done = session.finish();
  CHECK(done.undo_name() == "snap");
  const auto found = snaps.take();
  REQUIRE(found);
  CHECK_FALSE(snaps.busy());
  CHECK(found->is_of(*done.document().view()->shape.points));
  CHECK(found->confidence->size() == before.rows());
  CHECK(found->moved_mm > 0);
  CHECK(done.document().view()->shape.points->row(0) == before.row(0));
  REQUIRE(done.apply(Undo{}));
  CHECK(*done.document().view()->shape.points == before);
}

TEST_CASE("a snap has ended wherever memory ran out") {
  const ThreadLimit one_thread(1);  // what one thread needs is always the same
  const Document ball = BeatingBall::document();
  // Whether a snap that has room for so many large things comes to its end.
  const auto snaps_with = [&](int allocations) {
    auto limit = std::make_shared<std::optional<test::MemoryEndsAfter>>();
    const auto nothing = [](const Document&) { return std::optional<Action>(); };
    SessionThread session{EditSession(ball), [] {}};
    session.apply_computed([=](const Document& document, const std::string&) {
      limit->emplace(allocations);
      return nothing(document);
    });
    Snaps snaps;
    snaps.start(session, std::nullopt, {});
    session.apply_computed([=](const Document& document, const std::string&) {
      limit->reset();
      return nothing(document);
    });
    (void)session.finish();
    CHECK_FALSE(snaps.busy());
    return snaps.take().has_value();
  };
  int too_few = 0, enough = 1 << 20;
  REQUIRE(snaps_with(enough));
  while (enough - too_few > 1) {
    const int middle = (too_few + enough) / 2;
    (snaps_with(middle) ? enough : too_few) = middle;
  }
  for (int fewer = 1; fewer < 8; ++fewer) CHECK_FALSE(snaps_with(enough - fewer));
}

namespace {

/// A ball of `radius_mm`, brighter than what surrounds it, with a template of 24 mm placed on it.
Document ball_on_image(double radius_mm, const fs::path& image_file) {
  VolumeGeometry grid;
  grid.dims = {40, 40, 40};
  grid.spacing_mm.setConstant(2);
  grid.origin_mm.setConstant(-39);
  auto image = std::make_shared<const Volume>(label_map(icosphere(3, radius_mm), grid, 100));
  if (!image_file.empty()) REQUIRE(write_volume(*image, image_file));
  return new_document(image_file.string(), std::move(image), ball_template(24));
}

}  // namespace

TEST_CASE("of several snaps the latest gives its result and one that is given up leaves the mesh") {
  const Document document = ball_on_image(27, {});
  SessionThread session(EditSession(document), [] {});
  Snaps snaps;
  snaps.start(session, std::nullopt, {});
  snaps.start(session, std::nullopt, {});
  REQUIRE(test::wait_until([&] { return session.snapshot()->committed == 2; }));
  CHECK_FALSE(snaps.busy());
  const auto found = snaps.take();
  REQUIRE(found);
  CHECK(found->is_of(*session.snapshot()->document->view()->shape.points));
  CHECK_FALSE(snaps.take());
  const auto before = session.snapshot()->document;
  snaps.start(session, std::nullopt, {});
  snaps.cancel();
  REQUIRE(test::wait_until([&] { return session.snapshot()->committed == 3; }));
  CHECK_FALSE(snaps.busy());
  CHECK(session.snapshot()->error.empty());
  if (!snaps.take()) CHECK(session.snapshot()->document == before);
}

TEST_CASE("what the boundary looks like is learned from the cases of a study that are done") {
  const TemporaryFolder folder;
  const Mesh ball = icosphere(3, 24);
  REQUIRE(write_mesh(ball, folder.path / "ball.ply"));
  const auto the_template = load_template((folder.path / "ball.ply").string()).value();
  Study study;
  for (const int number : {2, 3, 4}) {
    StudyCase one;
    one.name = "ball-" + std::to_string(number);
    one.file = folder.path / (one.name + ".homolog");
    one.state = number == 4 ? CaseState::to_do : CaseState::done;
    // The second is done but has no image.
    Document begun =
        number == 3 ? new_document("", nullptr, the_template) : ball_on_image(24, folder.path / (one.name + ".nrrd"));
    REQUIRE(create_case(new_document(begun.scan.source, begun.scan.image, the_template), one.file));
    study.cases.push_back(std::move(one));
  }
  const auto cases = cases_to_learn(study, {});
  REQUIRE(cases.size() == 2);
  CHECK(cases_to_learn(study, study.cases[0].file).size() == 1);

  StudyAppearance learning([] {});
  learning.ask(cases, ball.points.rows());
  learning.finish();
  const auto left_out = learning.update();
  REQUIRE(left_out.size() == 1);
  CHECK(left_out[0].starts_with("ball-3"));
  CHECK(learning.learned().cases == 1);
  REQUIRE(learning.learned().appearance);
  CHECK(learning.learned().appearance->vertices() == ball.points.rows());
  learning.ask(cases, ball.points.rows());
  CHECK_FALSE(learning.busy());

  // Snaps go by it, unless the polarity is given.
  const Document document = ball_on_image(27, {});
  const auto snapped = [&](std::shared_ptr<const Appearance> learned, Polarity polarity) {
    SessionThread session(EditSession(document), [] {});
    Snaps snaps;
    SnapSettings settings;
    settings.learned = std::move(learned);
    settings.polarity = polarity;
    snaps.start(session, std::nullopt, settings);
    session.finish();
    return snaps.take().value().points;
  };
  const auto learned = learning.learned().appearance;
  CHECK(snapped(learned, Polarity::automatic) != snapped(nullptr, Polarity::automatic));
  CHECK(snapped(learned, Polarity::either) == snapped(nullptr, Polarity::either));
  learning.forget();
  CHECK_FALSE(learning.learned().appearance);
}

}  // namespace homolog
