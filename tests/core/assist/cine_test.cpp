#include "core/assist/cine.h"

#include <doctest/doctest.h>

#include <set>

#include "core/case/action_line.h"
#include "core/session/case_file.h"
#include "core/session/checkpoint.h"
#include "core/session/session.h"
#include "tests/beating_ball.h"
#include "tests/temporary_folder.h"

// A cine as a case: meshes carried from frame to frame, corrected, and carried again.

namespace homolog {

namespace {

/// Propagates as the editor does: all in one step to undo.
CineEdit propagated(EditSession& session) {
  CineEdit edit = test::must(propagate_shape(session.document().scan, *session.document().view(), {}));
  bool joined = false;
  for (const SetPoints& action : edit.actions) REQUIRE(session.apply(action, std::exchange(joined, true)));
  return edit;
}

std::set<int> changed_frames(const CineEdit& edit) {
  std::set<int> frames;
  for (const SetPoints& action : edit.actions) frames.insert(*action.of_frame);
  return frames;
}

}  // namespace

TEST_CASE("a cine is propagated in one step and a corrected frame stays as it is when it is propagated again") {
  EditSession session(BeatingBall::document());
  const Document start = session.document();
  CHECK(starting_frames(*start.view()) == std::vector<int>{0});
  propagated(session);
  const Document first = session.document();
  CHECK(first.frame == 0);
  CHECK(first.structure()->shapes.size() == BeatingBall::frames);
  const VolumeCurve curve = volume_curve(first, *first.structure());
  REQUIRE(curve.ejection);
  CHECK(curve.ejection->end_diastole == 0);
  CHECK(curve.ejection->end_systole == 3);
  CHECK(curve.ejection->fraction == doctest::Approx(1 - std::pow(22.0 / 30, 3)).epsilon(0.08));
  CHECK(curve.frames.at(0).known);
  CHECK_FALSE(curve.frames.at(3).known);
  CHECK(starting_frames(*first.view()) == std::vector<int>{0});

  // A person makes frame 2 larger than the image shows it.
  REQUIRE(session.apply(SetFrame{2}));
  const Points larger = 1.1 * *session.document().view()->shape.points;
  REQUIRE(session.apply(points_edit(*session.document().view(), larger, FoundBy::fit)));
  const Points corrected = *session.document().view()->shape.points;
  CHECK(starting_frames(*session.document().view()) == std::vector<int>{0, 2});
  const CineEdit again = propagated(session);
  CHECK(changed_frames(again) == std::set<int>{1, 3, 4, 5});
  CHECK(again.result.known == std::vector<int>{0, 2});
  CHECK(*session.document().structure()->shape(2)->points == corrected);
  CHECK(*session.document().structure()->shape(0)->points == *first.structure()->shape(0)->points);

  REQUIRE(session.apply(Undo{}));
  CHECK(*session.document().structure()->shape(4)->points == *first.structure()->shape(4)->points);
  CHECK(*session.document().structure()->shape(2)->points == corrected);
  REQUIRE(session.apply(Undo{}));
  REQUIRE(session.apply(Undo{}));
  CHECK(volume_curve(session.document(), *session.document().structure()).frames.empty());
}

TEST_CASE("a confirmed frame counts as known and a copied one does not") {
  EditSession session(BeatingBall::document());
  propagated(session);
  REQUIRE(session.apply(SetFrame{4}));
  Confirm confirm;
  confirm.at = session.document().view()->shape.points->row(0);
  REQUIRE(session.apply(confirm));
  CHECK(starting_frames(*session.document().view()) == std::vector<int>{0, 4});
  REQUIRE(session.apply(SetFrame{5}));
  REQUIRE(session.apply(StartFrameFrom{0}));
  CHECK(starting_frames(*session.document().view()) == std::vector<int>{0, 4});
}

TEST_CASE("what was carried through a cine and its doubts come back from the case file and from a checkpoint") {
  const TemporaryFolder folder;
  const Document start = BeatingBall::document();
  EditSession session(start);
  SetPoints carried = points_edit(*start.view(), 3, 0.8 * *start.view()->shape.points, FoundBy::propagation);
  carried.doubt = "shows less of the boundary than other frames";
  REQUIRE(session.apply(carried));
  const std::string line = action_line({carried});
  const auto read = parse_action(line);
  REQUIRE(read);
  CHECK(std::get<SetPoints>(read->action) == carried);
  CHECK(session.document().structure()->shape(3)->doubt == carried.doubt);
  CHECK_FALSE(frame_is_known(*session.document().structure()->shape(3)));
  CHECK(volume_curve(session.document(), *session.document().structure()).frames.at(3).doubt == carried.doubt);

  const auto checkpoint = checkpoint_line(start, session.document(), 7);
  REQUIRE(checkpoint);
  const auto again = read_checkpoint(*checkpoint, start, 7);
  REQUIRE(again);
  CHECK_FALSE(frame_is_known(*again->structure()->shape(3)));
  CHECK(again->structure()->shape(3)->doubt == carried.doubt);

  // A person edits it: it is known, and in no doubt.
  REQUIRE(session.apply(SetFrame{3}));
  REQUIRE(session.apply(
      points_edit(*session.document().view(), 1.01 * *session.document().view()->shape.points, FoundBy::snap)));
  CHECK(frame_is_known(*session.document().structure()->shape(3)));
  CHECK(volume_curve(session.document(), *session.document().structure()).frames.at(3).doubt.empty());
  SetPoints nowhere = carried;
  nowhere.of_frame = 17;
  CHECK_FALSE(session.apply(nowhere));
}

TEST_CASE("frames between two known ones are reached from both and agree with either") {
  const Document document = BeatingBall::document();
  PropagateOptions options;
  const Mesh ball{document.structure()->the_template->topology, *document.view()->shape.points};
  options.known[3] = BeatingBall::radius_mm(3) / BeatingBall::radius_mm(0) * ball.points;
  const VertexScalars ones = VertexScalars::Ones(ball.points.rows());
  const Propagation done = test::must(propagate(*document.scan.image, 0, ball, ones, options));
  CHECK(done.known == std::vector<int>{0, 3});
  CHECK(done.frames[3].points == options.known[3]);
  for (const std::size_t f : {1u, 2u, 4u, 5u}) {
    CAPTURE(f);
    REQUIRE(done.frames[f].disagreement_mm);
    CHECK(*done.frames[f].disagreement_mm < 1);
    CHECK(done.frames[f].points.rowwise().norm().mean() ==
          doctest::Approx(BeatingBall::radius_mm(static_cast<int>(f))).epsilon(0.04));
  }
  options.known[9] = ball.points;
  CHECK_FALSE(propagate(*document.scan.image, 0, ball, ones, options));
}

TEST_CASE("a cavity and the structure around it have a wall, with its thickness and its mass in every frame") {
  // An inner ball that shrinks, and an outer one that stays; both edited in frames 0 and 3.
  Document document = BeatingBall::document();
  const auto grown = [&](double by) {
    auto structure = std::make_shared<Structure>(*document.structures.front());
    for (const int frame : {0, 3}) {
      Shape shape = *document.structures.front()->shape(0);
      shape.points = std::make_shared<const Points>(*shape.points * (frame == 3 && by == 1 ? 0.8 : by));
      shape.strokes = 1;
      structure->set_shape(frame, std::move(shape));
    }
    return structure;
  };
  const auto inner = grown(1), outer = grown(1.4), far = grown(1);
  outer->id = "s2";
  far->id = "s3";
  for (const int frame : {0, 3}) {
    Shape shape = *far->shape(frame);
    shape.points = std::make_shared<const Points>(shape.points->rowwise() + Eigen::RowVector3d(200, 0, 0));
    far->set_shape(frame, std::move(shape));
  }
  document.structures = {inner, far};
  CHECK(volume_curve(document, *inner).outer.empty());
  document.structures = {inner, far, outer};
  const VolumeCurve curve = volume_curve(document, *inner);
  CHECK(curve.outer == "s2");
  const auto& rest = curve.frames.at(0).wall;
  REQUIRE(rest);
  const double cavity = curve.frames.at(0).volume_ml;
  CHECK(rest->volume_ml == doctest::Approx(cavity * (std::pow(1.4, 3) - 1)));
  CHECK(rest->mass_g() == doctest::Approx(1.05 * rest->volume_ml));
  CHECK(rest->thickness_mm == doctest::Approx(0.4 * BeatingBall::radius_mm(0)).epsilon(0.03));
  // It thickens as the cavity shrinks.
  CHECK(curve.frames.at(3).wall->thickness_mm == doctest::Approx(0.6 * BeatingBall::radius_mm(0)).epsilon(0.03));
  CHECK(volume_table(curve, 0.05).find("frame,seconds,volume_ml,known,doubt,wall_ml,wall_mm,mass_g\n0,") == 0);
  // From the outside it is the same wall; what lies elsewhere has none.
  CHECK(volume_curve(document, *outer).frames.at(3).wall->thickness_mm == curve.frames.at(3).wall->thickness_mm);
  CHECK(volume_curve(document, *far).inner.empty());
  // What was known serves again.
  CHECK(volume_curve(document, *inner, curve).frames.at(3).wall->volume_ml == curve.frames.at(3).wall->volume_ml);
}

}  // namespace homolog
