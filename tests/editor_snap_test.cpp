#include "app/editor/snaps.h"
#include "tests/desk.h"

namespace homolog {

TEST_CASE("the key N snaps the part under the pointer or else the whole mesh and Shift+N switches it on for strokes") {
  Desk desk;
  const Eigen::Vector2d at = desk.on_outline(ViewKind::axial);
  desk.send(MouseMove{}, at.x(), at.y());
  desk.send(KeyPress{'N'}, at.x(), at.y());
  auto snaps = desk.sent<SnapMesh>();
  REQUIRE(snaps.size() == 1);
  REQUIRE(snaps[0].region);
  CHECK((snaps[0].region->at - *desk.state.hover->on_mesh).norm() < 1e-9);
  CHECK(snaps[0].region->sigma_mm == desk.state.sigma_mm());
  desk.state.hover.reset();
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
  CHECK(desk.state.snap.with_strokes);
  drag();
  CHECK(desk.sent<SnapMesh>().size() == 1);
  desk.send(KeyPress{'N'}, at.x(), at.y(), true);
  CHECK_FALSE(desk.state.snap.with_strokes);
}

TEST_CASE("a snap comes after what was asked before it and is undone as one step") {
  SessionThread session(EditSession(demo()), [] {});
  const Points before = *demo().shape().points;
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
  CHECK(found->is_of(*done.document().shape().points));
  CHECK(found->confidence->size() == before.rows());
  CHECK(found->moved_mm > 0);
  CHECK(done.document().shape().points->row(0) == before.row(0));
  REQUIRE(done.apply(Undo{}));
  CHECK(*done.document().shape().points == before);
}

}  // namespace homolog
