#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "core/base/encoding/json.h"
#include "core/base/files/files.h"
#include "core/case/action_line.h"
#include "core/mesh/mesh_io.h"
#include "core/session/case_keeping.h"
#include "core/session/session_thread.h"
#include "tests/case_steps.h"
#include "tests/must.h"
#include "tests/refusal.h"

// A case that holds several structures: what its file says, and that each is edited by itself.

namespace homolog {

namespace {

constexpr HistoryLimits checkpoints_often{.replayed_steps = 10};
const Similarity aside{Eigen::Quaterniond::Identity(), 0.5, Vec3(200, 0, 0)};

/// The structure "s2": the folder's template, smaller and aside.
SetStructure second(const CaseFolder& folder) {
  return {.id = "s2", .name = "small ball", .source = folder.template_path.string(), .placement = aside};
}

EditStep of_second(Action action) {
  return {std::move(action), "s2"};
}

Points points_of(const EditSession& session, const char* id) {
  return *session.document().view(id)->shape.points;
}

}  // namespace

TEST_CASE("a case with one structure stays of format 1 and a second one makes it format 2") {
  const CaseFolder folder;
  EditSession session = folder.create();
  REQUIRE(session.apply(pull(pole, 1.1 * pole)));
  CHECK(lines_of(folder.case_path).front().starts_with(R"({"homolog":1,)"));
  REQUIRE(session.apply(second(folder)));
  const auto lines = lines_of(folder.case_path);
  CHECK(lines.front().starts_with(R"({"homolog":2,)"));
  REQUIRE(lines.size() == 3);
  const auto line = nlohmann::ordered_json::parse(lines.back());
  CHECK(line["structure"]["id"] == "s2");
  CHECK(line["structure"]["name"] == "small ball");
  CHECK(line["structure"]["template"] == folder.template_path.filename().string());  // relative to the case
}

TEST_CASE("an edit of one structure leaves the others as they are and undo takes back the last of all") {
  const CaseFolder folder;
  EditSession session = folder.create();
  REQUIRE(session.apply(second(folder)));
  const Points first = points_of(session, "s1"), small = points_of(session, "s2");
  CHECK(small.isApprox(aside.apply(first), 1e-12));

  const Vec3 small_pole = aside.apply(pole);
  REQUIRE(session.apply(of_second(pull(small_pole, small_pole + Vec3(0, 0, 3)))));
  CHECK(points_of(session, "s1") == first);
  const double moved_mm = (points_of(session, "s2") - small).rowwise().norm().maxCoeff();
  CHECK(moved_mm > 2);
  CHECK(moved_mm < 4);
  CHECK(nlohmann::json::parse(lines_of(folder.case_path).back())["of"] == "s2");

  REQUIRE(session.apply(pull(pole, 1.1 * pole)));  // without an id it is of the first
  CHECK(points_of(session, "s1") != first);
  REQUIRE(session.apply(Undo{}));
  CHECK(points_of(session, "s1") == first);
  REQUIRE(session.apply(Undo{}));
  CHECK(points_of(session, "s2") == small);
  REQUIRE(session.apply(Undo{}));
  CHECK(session.document().structures.size() == 1);
  REQUIRE(session.apply(Redo{}));
  CHECK(points_of(session, "s2") == small);
}

TEST_CASE("a case of several structures replays and opens from a checkpoint to the same points") {
  const CaseFolder folder;
  std::mt19937 random(3);
  std::optional<Document> done;
  {
    auto session = create_case(folder.document(), folder.case_path, checkpoints_often).value();
    work(session, random, 8);
    REQUIRE(session.apply(second(folder)));
    const Vec3 small_pole = aside.apply(pole);
    for (int k = 0; k < 25; ++k) {
      REQUIRE(session.apply(of_second(pull(small_pole, small_pole + Vec3(0.1 * k, 0, 1)))));
      REQUIRE(session.apply(of_second(SetStiffnessBase{5.0 + k})));
      REQUIRE(session.apply(pull(-pole, -1.01 * pole)));
    }
    REQUIRE(session.apply(SetStructure{.id = "s2", .name = "renamed", .colour = {{1, 2, 3}}}));
    done = session.document();
  }
  CHECK(done->structure("s2")->name == "renamed");
  ReplayOptions every_line;
  every_line.from_checkpoint = false;
  const auto played = read_case(folder.case_path, every_line), opened = read_case(folder.case_path);
  REQUIRE_MESSAGE(played, played.error().sentence());
  REQUIRE_MESSAGE(opened, opened.error().sentence());
  CHECK(same_document(played->session.document(), *done));
  CHECK(same_document(opened->session.document(), *done));
  CHECK(opened->session.solves() < played->session.solves() / 3);

  // The history goes back beyond the second structure.
  auto again = open_case(folder.case_path, nullptr, {}, {.bytes = 0});
  REQUIRE(again);
  while (again->session.document().structures.size() == 2) REQUIRE(again->session.apply(Undo{}));
  CHECK(again->session.document().structure("s2") == nullptr);
}

TEST_CASE("a case of several structures finds their templates where it goes on and where all was moved") {
  const CaseFolder folder;
  const fs::path elsewhere = folder.folder.path / "other";
  fs::create_directories(elsewhere);
  std::optional<Document> done;
  {
    EditSession session = folder.create();
    REQUIRE(session.apply(second(folder)));
    REQUIRE(save_case_as(session, elsewhere / "saved.homolog"));
    REQUIRE(session.apply(SetStructure{.id = "s3", .source = folder.template_path.string(), .placement = aside}));
    done = session.document();
  }
  const auto there = read_case(elsewhere / "saved.homolog");
  REQUIRE_MESSAGE(there, there.error().sentence());
  CHECK(same_document(there->session.document(), *done));

  const fs::path moved = folder.folder.path.parent_path() / (folder.folder.path.filename().string() + "-moved");
  fs::rename(folder.folder.path, moved);
  const auto after = read_case(moved / "other" / "saved.homolog");
  REQUIRE_MESSAGE(after, after.error().sentence());
  CHECK(points_of(after->session, "s3") == *done->view("s3")->shape.points);
  fs::rename(moved, folder.folder.path);
}

TEST_CASE("a template file that became another mesh is refused, and one with another stiffness is told of") {
  const CaseFolder folder;
  const fs::path other = folder.folder.path / "other.ply";
  fs::copy_file(folder.template_path, other);
  {
    EditSession session = create_case(folder.document(), folder.case_path, checkpoints_often).value();
    SetStructure action = second(folder);
    action.source = other.string();
    REQUIRE(session.apply(std::move(action)));
    const Vec3 small_pole = aside.apply(pole);
    for (int k = 0; k < 25; ++k) REQUIRE(session.apply(of_second(pull(small_pole, small_pole + Vec3(0.1 * k, 0, 1)))));
  }
  ReplayOptions every_line;
  every_line.from_checkpoint = false;
  for (const fs::path& file : {folder.template_path, other}) {
    CAPTURE(file);
    const MeshFile as_it_was = read_mesh_file(file).value();
    MeshFile changed = as_it_was;
    const auto now = [&](const ReplayOptions& options) {
      REQUIRE(write_mesh_file(changed, file));
      return read_case(folder.case_path, options);
    };
    for (const ReplayOptions& options : {ReplayOptions{}, every_line}) {
      // Nothing that rounding in a file does, and less than two subjects differ by.
      changed.points = as_it_was.points.array() + 1e-5;
      CHECK(now(options));
      changed.points = as_it_was.points.array() + 0.05;
      CHECK(says(now(options), file.filename().string()));
      CHECK(says(now(options), "put the original back"));
      changed.points = as_it_was.points;
      changed.points.row(3) += Eigen::RowVector3d(0, 0, 1);
      CHECK(says(now(options), "its vertices lie elsewhere"));
      changed.points = as_it_was.points;
      VertexScalars stiffer = VertexScalars::Ones(changed.points.rows());
      stiffer[5] = 20;
      changed.stiffness = std::make_shared<const VertexScalars>(std::move(stiffer));
      const auto stiff = now(options);
      REQUIRE(stiff);
      REQUIRE(stiff->warnings.size() == 1);
      CHECK(stiff->warnings.front().find("has another stiffness") != std::string::npos);
      changed = as_it_was;
    }
    REQUIRE(write_mesh_file(as_it_was, file));
  }
  CHECK(read_case(folder.case_path)->warnings.empty());
}

TEST_CASE("a case that was begun without a file finds its templates where its folder was moved to") {
  const CaseFolder folder;
  const fs::path project = folder.folder.path / "project";
  fs::create_directories(project / "set");
  fs::copy_file(folder.template_path, project / "set" / "s.ply");
  const fs::path begun = folder.folder.path / "state" / "homolog" / "begun.homolog";
  fs::create_directories(begun.parent_path());
  std::optional<Document> done;
  {
    auto session = create_case(folder.document(), begun).value();
    SetStructure action = second(folder);
    action.source = (project / "set" / "s.ply").string();
    REQUIRE(session.apply(std::move(action)));
    fs::copy_file(folder.template_path, project / folder.template_path.filename());
    REQUIRE(save_case_as(session, project / "saved.homolog"));
    done = session.document();
  }
  fs::create_directories(folder.folder.path / "elsewhere" / "deep");
  fs::rename(project, folder.folder.path / "elsewhere" / "deep" / "renamed");
  const fs::path moved = folder.folder.path / "elsewhere" / "deep" / "renamed" / "saved.homolog";
  // The first line names the first template from where it was saved.
  std::string text = read_whole_file(moved).value();
  const std::string name = folder.template_path.filename().string();
  text.replace(text.find("\"../" + name), name.size() + 4, "\"" + name);
  REQUIRE(write_whole_file(moved, text));
  const auto after = read_case(moved);
  REQUIRE_MESSAGE(after, after.error().sentence());
  CHECK(points_of(after->session, "s2") == *done->view("s2")->shape.points);
  REQUIRE(after->warnings.size() == 1);
  CHECK(after->warnings.front().ends_with("set/s.ply was taken in its place"));
}

TEST_CASE("what no case can do with structures is refused in a sentence") {
  const CaseFolder folder;
  EditSession session = folder.create();
  CHECK(says(session.apply(RemoveStructure{"s1"}), "is the only one of this case"));
  CHECK(says(session.apply(RemoveStructure{"s7"}), "\"s7\" does not exist"));
  CHECK(says(session.apply(SetStructure{.id = "s2", .name = "ball"}), "give its template"));
  CHECK(says(session.apply(of_second(SetStiffnessBase{3})), "no structure \"s2\""));
  SetStructure missing = second(folder);
  missing.source = (folder.folder.path / "gone.ply").string();
  CHECK(says(session.apply(missing), "gone.ply"));
  CHECK(lines_of(folder.case_path).size() == 1);
  CHECK(lines_of(folder.case_path).front().starts_with(R"({"homolog":1,)"));
  REQUIRE(session.apply(second(folder)));
  CHECK(says(session.apply(second(folder)), "exists already"));
  REQUIRE(session.apply(RemoveStructure{"s1"}));
  CHECK(session.document().structure()->id == "s2");
}

namespace {

SharedWith shared_with(const char* id, const std::vector<VertexPair>& pairs) {
  return {id, std::make_shared<const std::vector<VertexPair>>(pairs)};
}

}  // namespace

TEST_CASE("what structures are to each other is in the case, and is read back from lines and from checkpoints") {
  const CaseFolder folder;
  const std::vector<SharedWith> shared{shared_with("s1", {{0, 5}, {3, 0}})};
  std::optional<Document> done;
  {
    auto session = create_case(folder.document(), folder.case_path, checkpoints_often).value();
    REQUIRE(session.apply(second(folder)));
    REQUIRE(session.apply(SetStructure{.id = "s1", .side = Side::left, .partner = "s2"}));
    REQUIRE(session.apply(SetStructure{.id = "s2", .side = Side::right, .partner = "s1", .shared = shared}));
    // No other name changes them.
    REQUIRE(session.apply(SetStructure{.id = "s1", .name = "another name"}));
    for (int k = 0; k < 25; ++k) REQUIRE(session.apply(SetStiffnessBase{5.0 + k}));
    done = session.document();
  }
  CHECK(done->structure("s1")->side == Side::left);
  CHECK(done->structure("s1")->partner == "s2");
  CHECK(done->structure("s1")->shared.empty());
  CHECK(done->structure("s2")->side == Side::right);
  CHECK(done->structure("s2")->shared == shared);
  const auto lines = lines_of(folder.case_path);
  const auto checkpoint =
      std::ranges::find_if(lines, [](const auto& line) { return line.starts_with("{\"checkpoint"); });
  REQUIRE(checkpoint != lines.end());
  CHECK(checkpoint->find("\"0:5 3:0\"") != std::string::npos);
  ReplayOptions every_line;
  every_line.from_checkpoint = false;
  for (const auto& options : {ReplayOptions{}, every_line}) {
    const auto read = read_case(folder.case_path, options);
    REQUIRE_MESSAGE(read, read.error().sentence());
    CHECK(same_document(read->session.document(), *done));
  }
  Document other = *done;
  other.change("s2", [](Structure& structure) { structure.shared = {shared_with("s1", {{0, 5}, {3, 1}})}; });
  CHECK_FALSE(same_document(other, *done));
}

TEST_CASE("a structure that leaves the case takes along what others shared with it, and comes back with it") {
  const CaseFolder folder;
  EditSession session = folder.create();
  REQUIRE(session.apply(second(folder)));
  REQUIRE(session.apply(SetStructure{.id = "s3", .source = folder.template_path.string(), .placement = aside}));
  const auto with_both = std::vector<SharedWith>{shared_with("s2", {{0, 0}}), shared_with("s3", {{1, 1}})};
  REQUIRE(session.apply(SetStructure{.id = "s1", .partner = "s2", .shared = with_both}));
  REQUIRE(session.apply(SetStructure{.id = "s3", .partner = "s1", .shared = {{shared_with("s2", {{2, 2}})}}}));
  REQUIRE(session.apply(RemoveStructure{"s2"}));
  CHECK_FALSE(session.document().structure("s1")->partner);
  CHECK(session.document().structure("s1")->shared == std::vector<SharedWith>{shared_with("s3", {{1, 1}})});
  CHECK(session.document().structure("s3")->partner == "s1");
  CHECK(session.document().structure("s3")->shared.empty());
  const auto read = read_case(folder.case_path);
  REQUIRE(read);
  CHECK(same_document(read->session.document(), session.document()));
  REQUIRE(session.apply(Undo{}));
  CHECK(session.document().structure("s1")->partner == "s2");
  CHECK(session.document().structure("s1")->shared == with_both);
  REQUIRE(session.apply(SetStructure{.id = "s1", .partner = "", .shared = std::vector<SharedWith>{}}));
  CHECK_FALSE(session.document().structure("s1")->partner);
  CHECK(session.document().structure("s1")->shared.empty());
}

TEST_CASE("a partner, or vertices to share, that there are not are refused in a sentence") {
  const CaseFolder folder;
  EditSession session = folder.create();
  REQUIRE(session.apply(second(folder)));
  const auto refused = [&](const SetStructure& action, const char* why) { CHECK(says(session.apply(action), why)); };
  refused({.id = "s1", .partner = "s7"}, "\"s7\" is no other structure of the case");
  refused({.id = "s1", .partner = "s1"}, "\"s1\" is no other structure of the case");
  refused({.id = "s1", .shared = {{shared_with("s7", {{0, 0}})}}}, "\"s7\" is no other structure of the case");
  refused({.id = "s1", .shared = {{shared_with("", {{0, 0}})}}}, "is no other structure of the case");
  refused({.id = "s1", .shared = {{shared_with("s2", {{0, 99999}})}}}, "0:99999 are not both there");
  refused({.id = "s1", .shared = {{shared_with("s2", {{99999, 0}})}}}, "99999:0 are not both there");
  CHECK(lines_of(folder.case_path).size() == 2);
  for (const char* line : {R"({"structure":{"id":"s1","side":"above"}})", R"({"structure":{"id":"s1","shared":"0:0"}})",
                           R"({"structure":{"id":"s1","shared":[{"with":"s2"}]}})",
                           R"({"structure":{"id":"s1","shared":[{"with":"s2","vertices":"0-0"}]}})"}) {
    CAPTURE(line);
    CHECK_FALSE(parse_action(line));
  }
}

TEST_CASE("the thread of a session edits and previews the structure that is named") {
  const CaseFolder folder;
  SessionThread thread(folder.create(), [] {});
  thread.apply(second(folder));
  const Vec3 small_pole = aside.apply(pole);
  thread.apply(pull(small_pole, small_pole + Vec3(0, 0, 3)), false, "s2");
  EditSession session = thread.finish();
  CHECK(session.document().view("s1")->shape.strokes == 0);
  CHECK(session.document().view("s2")->shape.strokes == 1);
}

namespace {

/// What undo calls the last step, as it is done and as it is read again, and redo the same.
std::vector<std::string> names_of_last_step(EditSession& session, const CaseFolder& folder) {
  std::vector<std::string> names{session.undo_name(), read_case(folder.case_path)->session.undo_name()};
  REQUIRE(session.apply(Undo{}));
  names.push_back(session.redo_name());
  names.push_back(read_case(folder.case_path)->session.redo_name());
  REQUIRE(session.apply(Redo{}));
  return names;
}

std::vector<std::string> four_times(const std::string& name) {
  return {4, name};
}

}  // namespace

TEST_CASE("a step of several edits is called by its deed, by undo and by redo") {
  const CaseFolder folder;
  EditSession session = folder.create();
  REQUIRE(session.apply(second(folder)));
  CHECK(names_of_last_step(session, folder) == four_times("new structure small ball"));

  // As a fit of a set makes it: the structure, its mesh, its relations.
  SetStructure third = second(folder);
  third.id = "s3";
  third.name = "other ball";
  REQUIRE(session.apply(third));
  Points points = points_of(session, "s3");
  points.array() += 0.5;
  const auto points_edit_of = [&](const char* id, FoundBy by) {
    return EditStep{points_edit(*session.document().view(id), points, by), id, true};
  };
  REQUIRE(session.apply(points_edit_of("s3", FoundBy::set_fit)));
  REQUIRE(session.apply(EditStep{SetStructure{.id = "s3", .partner = "s2"}, {}, true}));
  CHECK(names_of_last_step(session, folder) == four_times("fit of the set"));

  // A pull that its neighbour pushes back.
  REQUIRE(session.apply(pull(pole, 1.1 * pole)));
  const std::string pulled = session.undo_name();
  CHECK(pulled.starts_with("pull"));
  points = points_of(session, "s1");
  points.array() += 0.25;
  REQUIRE(session.apply(points_edit_of("s1", FoundBy::keep_apart)));
  CHECK(session.undo_name() == pulled);
  REQUIRE(session.apply(Undo{}));
  CHECK(session.redo_name() == pulled);
  REQUIRE(session.apply(Redo{}));

  points = points_of(session, "s3");
  points.array() -= 0.5;
  EditStep back = points_edit_of("s3", FoundBy::taken_back);
  back.joined = false;
  REQUIRE(session.apply(back));
  CHECK(names_of_last_step(session, folder) == four_times("other ball taken back"));

  REQUIRE(session.apply(SetStructure{.id = "s2", .confidence = 1, .doubt = ""}));
  CHECK(names_of_last_step(session, folder) == four_times("small ball is right"));
}

TEST_CASE("a step that renames structures level by level says so") {
  const CaseFolder folder;
  EditSession session = folder.create();
  REQUIRE(session.apply(second(folder)));
  REQUIRE(session.apply(SetStructure{.id = "s1", .name = "L1"}));
  const auto changed = session.apply(Undo{});
  REQUIRE(changed);
  CHECK(changed->message.ends_with(" is named L1."));
  REQUIRE(session.apply(Redo{}));
  REQUIRE(session.apply(SetStructure{.id = "s2", .name = "disc_L4_L5"}));
  const auto rename = [&](const char* first, const char* other) {
    REQUIRE(session.apply(SetStructure{.id = "s1", .name = first, .label = first}));
    REQUIRE(session.apply(EditStep{SetStructure{.id = "s2", .name = other, .label = other}, {}, true}));
  };
  rename("T12", "disc_L3_L4");
  CHECK(names_of_last_step(session, folder) == four_times("names one level up"));
  rename("L2", "disc_L5_L6");
  CHECK(names_of_last_step(session, folder) == four_times("names 2 levels down"));
}

}  // namespace homolog
