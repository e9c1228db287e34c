#include <chrono>
#include <fstream>
#include <thread>

#include "app/editor/state/views.h"
#include "app/editor/update/file_purposes.h"
#include "app/editor/update/shown_case.h"
#include "app/editor/work/opening/sort_files.h"
#include "tests/ball.h"
#include "tests/desk.h"
#include "tests/temporary_folder.h"
#include "tests/wait.h"

namespace homolog {

TEST_CASE("a double click fills the window with a view and another brings the four back") {
  Desk desk;
  const auto click = [&](double seconds) {
    desk.seconds = seconds - 1;
    desk.send(MousePress{}, 60, 80);
    desk.send(MouseRelease{}, 60, 80);
  };
  click(10);
  click(10.2);
  CHECK(desk.state.look.maximised == ViewKind::axial);
  click(20);
  click(20.2);
  CHECK_FALSE(desk.state.look.maximised);
}

TEST_CASE("another structure and another case begin with nothing found") {
  Desk desk;
  const auto find = [&] {
    desk.state.scoring.z = std::make_shared<const VertexScalars>(VertexScalars::Ones(3));
    desk.state.found.last_fit.emplace();
    desk.state.found.volume_curve.frames[0] = {};
    desk.state.found.intersecting_at_rest = 4;
    desk.state.pointer.held_click.emplace();
  };
  const auto nothing_is_known = [&] {
    return desk.state.scoring.z == nullptr && !desk.state.found.last_fit &&
           desk.state.found.volume_curve.frames.empty() && desk.state.found.intersecting_at_rest == Found::not_known;
  };
  find();
  begin_on_structure(desk.state, desk.document);
  CHECK(nothing_is_known());
  find();
  show_document(desk.state, desk.document, desk.layout);
  CHECK(nothing_is_known());
  CHECK_FALSE(desk.state.pointer.held_click);
}

TEST_CASE("a finding of a mesh that is gone is not looked at") {
  EditorState state;
  const Mesh ball = icosphere(1, 20);
  const Vec3 before = state.look.crosshair_mm;
  look_closely(state, ball, static_cast<std::int32_t>(ball.points.rows()));
  CHECK(state.look.crosshair_mm == before);
  look_closely(state, ball, 0);
  CHECK(state.look.crosshair_mm == Vec3(ball.points.row(0)));
}

TEST_CASE("edits that are refused between two frames are told though the last one was done") {
  EditorState state;
  ShownCase shown([] {});
  CHECK(shown.start(EditSession(ball_document(40))).count == 0);
  const auto told_of = [&](const std::vector<Action>& actions) {
    state.notices.clear();
    for (const Action& action : actions) shown.session().apply(action);
    REQUIRE(test::wait_until([&] { return !shown.session().busy(); }));
    shown.update_snapshot(state);
    std::vector<std::string> told;
    for (const Notice& notice : state.notices) told.push_back(notice.text);
    return told;
  };
  const SetStiffnessBase good{5}, bad{-1};
  const auto of_stiffness = told_of({bad, good});
  REQUIRE(of_stiffness.size() == 1);
  CHECK(told_of({bad, bad, good}) == of_stiffness);  // one reason is told once
  const auto of_spacing = told_of({SetEvenSpacing{7}, good});
  REQUIRE(of_spacing.size() == 1);
  CHECK(told_of({bad, SetEvenSpacing{7}, good}) == std::vector{of_stiffness[0], of_spacing[0]});
  CHECK(told_of({bad, bad, SetEvenSpacing{7}, good}) ==
        std::vector{of_stiffness[0], "2 more edits were refused. The last one: " + of_spacing[0]});
  CHECK(told_of({good}).empty());
}

TEST_CASE("what a case refuses while it is closed is not lost") {
  ShownCase shown([] {});
  CHECK(told(shown.close()).empty());
  CHECK(shown.start(EditSession(ball_document(40))).count == 0);
  shown.session().apply_computed([](const Document&, const std::string&) -> Result<std::optional<Action>> {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return fail("ball", "cannot be snapped");
  });
  shown.session().apply(SetStiffnessBase{-1});
  const auto sentences = told(shown.close());
  REQUIRE(sentences.size() == 2);
  CHECK(sentences[0].find("ball: cannot be snapped") == 0);
  CHECK(told(shown.close()).empty());
}

TEST_CASE("saving takes the typed name and asks before it replaces a file") {
  const TemporaryFolder folder;
  std::ofstream(folder.path / "old.homolog") << "kept";
  Desk desk;
  desk.state.preferences.folder = folder.path;
  desk.give(ShowFileDialog{FilePurpose::save_case, "new"});
  desk.press(key::enter);
  auto saved = desk.sent<SaveCaseAs>();
  REQUIRE(saved.size() == 1);
  CHECK(saved[0].path == folder.path / "new.homolog");

  desk.give(ShowFileDialog{FilePurpose::save_case, "new"});
  desk.press(key::down);
  CHECK(std::get<FileDialog>(*desk.state.dialog).browser.name == "old.homolog");
  desk.press(key::enter);
  CHECK(desk.sent<SaveCaseAs>().empty());
  REQUIRE(desk.state.dialog);
  REQUIRE(std::holds_alternative<ReplaceDialog>(*desk.state.dialog));
  desk.give(AcceptReplacement{});
  saved = desk.sent<SaveCaseAs>();
  REQUIRE(saved.size() == 1);
  CHECK(saved[0].path == folder.path / "old.homolog");
}

TEST_CASE("a maximised view shows what it showed larger and then as before") {
  Desk desk;
  const double before = desk.state.look.slices[0].mm_per_px;
  const Layout whole = make_layout(1280, 800, 1, {ViewKind::axial, true});
  follow_layout(desk.state, whole);
  CHECK(desk.state.look.slices[0].mm_per_px < 0.6 * before);
  follow_layout(desk.state, desk.layout);
  CHECK(desk.state.look.slices[0].mm_per_px == doctest::Approx(before));
}

TEST_CASE("opening takes a file that is there without a question") {
  const TemporaryFolder folder;
  std::ofstream(folder.path / "points.mrk.json") << "{}";
  for (const FilePurpose purpose : {FilePurpose::open_landmarks, FilePurpose::open})
    CHECK_FALSE(file_purpose(purpose).files.saves);
  Desk desk;
  desk.state.preferences.folder = folder.path;
  desk.give(ShowFileDialog{FilePurpose::open_landmarks, "points"});
  desk.press(key::down);
  desk.press(key::enter);
  CHECK(desk.sent<ImportLandmarks>().size() == 1);
}

TEST_CASE("a case is opened alone or with its image") {
  CHECK_FALSE(sort_files({"a.homolog", "kidney.ply"}));
  CHECK_FALSE(sort_files({"a.homolog", "b.homolog"}));
  CHECK(sort_files({"a.homolog", "ct.nii.gz"})->volume_source == fs::absolute("ct.nii.gz"));
  CHECK(sort_files({"ct.nii.gz", "kidney.ply"})->template_source == fs::absolute("kidney.ply"));
}

TEST_CASE("whether a VTP file holds curves or a surface is told by its beginning") {
  const TemporaryFolder folder;
  const fs::path file = folder.path / "drawn.vtp";
  // The rest of the file is not there: what decides stands before it.
  const auto sorted = [&](const std::string& cells) {
    std::ofstream(file) << R"(<?xml version="1.0"?><VTKFile type="PolyData" version="1.0"><PolyData>)"
                        << "<Piece NumberOfPoints=\"400000\" " << cells << "><Points>";
    return sort_files({file}).value();
  };
  for (const char* cells : {R"(NumberOfVerts="0" NumberOfLines="12" NumberOfStrips="0" NumberOfPolys="0")",
                            R"(NumberOfLines = '1')", R"(NumberOfPolys="0" NumberOfLines="7")"}) {
    CAPTURE(cells);
    const OpenRequest request = sorted(cells);
    CHECK(request.contours == std::vector<fs::path>{file});
    CHECK(request.template_source.empty());
  }
  for (const char* cells :
       {R"(NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="9")",
        R"(NumberOfLines="3" NumberOfPolys="9")", R"(NumberOfLines="3" NumberOfStrips="1" NumberOfPolys="0")",
        R"(NumberOfVerts="5" NumberOfLines="" NumberOfPolys="0")", "", R"(NumberOfLines="0"></Piece>)"}) {
    CAPTURE(cells);
    const OpenRequest request = sorted(cells);
    CHECK(request.contours.empty());
    CHECK(request.template_source == file);
  }
}

TEST_CASE("landmarks of a file are taken by the template's names") {
  const std::string name = demo().structure()->the_template->landmarks.front().name;
  const auto known =
      landmarks_of_template({{"elsewhere", Vec3::Zero()}, {name, Vec3::Ones()}}, *demo().structure()->the_template);
  REQUIRE(known.size() == 1);
  CHECK(known[0].name == name);
}

TEST_CASE("what a brush paints is shown while it is in hand") {
  EditorState state;
  state.look.colouring = Colouring::moved;
  state.hand.tool = MouseTool::confirm;
  CHECK(shown_colouring(state) == Colouring::known);
  state.look.colouring = Colouring::doubt;  // white where it is confirmed
  CHECK(shown_colouring(state) == Colouring::doubt);
  state.look.colouring = Colouring::moved;
  state.hand.tool = MouseTool::stiffness;
  CHECK(shown_colouring(state) == Colouring::stiffness);
  state.hand.tool = MouseTool::pull;
  CHECK(shown_colouring(state) == Colouring::moved);
}

TEST_CASE("after a snap its confidence is shown until another colouring or a brush is chosen") {
  EditorState state;
  state.look.colouring = Colouring::moved;
  state.found.confidence = std::make_shared<const VertexScalars>(VertexScalars::Ones(3));
  CHECK(shown_colouring(state) == Colouring::confidence);
  state.hand.tool = MouseTool::confirm;
  CHECK(shown_colouring(state) == Colouring::known);
  state.hand.tool = MouseTool::pull;
  ChooseColouring{Colouring::quality}.run(state);
  CHECK(shown_colouring(state) == Colouring::quality);
  ChooseColouring{Colouring::confidence}.run(state);
  CHECK(shown_colouring(state) == Colouring::confidence);
  state.found.confidence.reset();
  CHECK(shown_colouring(state) == Colouring::quality);
}

TEST_CASE("reach presets grow with the mesh") {
  const Points& reference = *demo().view()->shape.reference;
  const auto once = default_sigmas_mm(reference), twice = default_sigmas_mm(2 * reference);
  for (std::size_t i = 0; i < 3; ++i) CHECK(twice[i] == doctest::Approx(2 * once[i]).epsilon(0.1));
}

TEST_CASE("a notice is shown once and old ones make room") {
  EditorState state;
  for (int i = 0; i < 9; ++i) add_notice(state, "notice " + std::to_string(i / 2));
  CHECK(state.notices.size() == 4);
  CHECK(state.notices.back().text == "notice 4");
}

}  // namespace homolog
