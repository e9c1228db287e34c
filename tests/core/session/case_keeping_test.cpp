#include "core/session/case_keeping.h"

#include <thread>

#include "core/session/session_thread.h"
#include "core/session/unsaved_cases.h"
#include "tests/case_folder.h"
#include "tests/environment_variable.h"
#include "tests/refusal.h"
#include "tests/wait.h"

// What becomes of a case whose file another program deletes, moves or changes while it is open.

namespace homolog {

namespace {

/// A case with one pull, in a folder of its own, and a place for unsaved cases that nobody else has.
struct OpenCase {
  TemporaryFolder state;
  EnvironmentVariable state_home{"XDG_STATE_HOME", state.path};
  CaseFolder place;
  fs::path folder = place.folder.path / "cases", path = folder / "ball.homolog";
  EditSession session = opened();

  EditSession opened() const {
    fs::create_directories(folder);
    EditSession begun = create_case(place.document(), path).value();
    REQUIRE(begun.apply(pull(pole, 1.1 * pole)));
    return begun;
  }
  std::string news() {
    const std::string news = session.news();
    session.forget_news();
    return news;
  }
  bool pulls() { return session.apply(pull(-pole, -1.1 * pole)).has_value(); }
  bool is_unsaved() const { return session.journal()->path().parent_path() == unsaved_folder(); }
  /// Whether the file in which the case goes on holds the whole of it, also what can be undone.
  bool is_whole() const {
    const auto read = read_case(session.journal()->path());
    return read && read->session.strokes() == session.strokes() &&
           *read->session.document().view()->shape.points == *session.document().view()->shape.points &&
           Journal::in_use(session.journal()->path());
  }
};

bool has(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

void write_anew(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

}  // namespace

TEST_CASE("a case whose file is deleted is written anew with every line") {
  OpenCase one;
  REQUIRE(one.session.apply(Undo{}));
  REQUIRE(one.session.apply(Redo{}));
  const std::string before = read_whole_file(one.path).value();
  fs::remove(one.path);
  REQUIRE(one.pulls());
  CHECK(one.news() ==
        one.path.string() + " was deleted or moved while it was open. It was written anew, with every edit.");
  CHECK(one.session.journal()->path() == one.path);
  CHECK(read_whole_file(one.path).value().starts_with(before));
  CHECK(one.is_whole());
  REQUIRE(one.pulls());
  CHECK(one.news().empty());
  CHECK(one.is_whole());
}

TEST_CASE("a case whose folder is deleted or renamed goes on as an unsaved one") {
  OpenCase one;
  const fs::path away = one.place.folder.path / "renamed";
  SUBCASE("renamed") {
    fs::rename(one.folder, away);
  }
  SUBCASE("deleted") {
    fs::remove_all(one.folder);
  }
  REQUIRE(one.pulls());
  CHECK(has(one.news(),
            "ball.homolog was deleted, moved or unmounted while the case was open. Every edit is kept as an "
            "unsaved case; save it under a name."));
  CHECK_FALSE(fs::exists(one.folder));
  CHECK(one.is_unsaved());
  CHECK(one.is_whole());
  if (fs::exists(away)) CHECK(read_case(away / "ball.homolog")->session.strokes() == 1);
  REQUIRE(unsaved_cases().empty());  // it is in use
  one.session = EditSession(one.place.document());
  REQUIRE(unsaved_cases().size() == 1);
  CHECK(unsaved_cases().front().edited);
}

TEST_CASE("what another program wrote in place of a case stays and the case goes on as an unsaved one") {
  OpenCase one;
  std::string theirs = "{\"homolog\":1}\n{\"note\":\"newer\"}\n";
  const fs::path other = one.folder / "other";
  SUBCASE("another file") {
    write_anew(other, theirs);
    fs::rename(other, one.path);
  }
  SUBCASE("the same file with other lines") {
    write_anew(one.path, theirs);
  }
  SUBCASE("the same file with as many bytes") {
    theirs = std::string(one.session.journal()->bytes(), 'x');
    write_anew(one.path, theirs);
  }
  SUBCASE("the same file with a line more") {
    theirs = read_whole_file(one.path).value() + "{\"note\":\"from a script\"}\n";
    write_anew(one.path, theirs);
  }
  SUBCASE("the same file cut short") {
    theirs = read_whole_file(one.path).value().substr(0, one.session.journal()->bytes() / 2);
    write_anew(one.path, theirs);
  }
  REQUIRE(one.pulls());
  CHECK(has(one.news(),
            "ball.homolog was changed by another program while it was open. It stays as that program left it. "
            "Every edit is kept as an unsaved case; save it under a name."));
  CHECK(read_whole_file(one.path).value() == theirs);
  CHECK(one.is_unsaved());
  CHECK(one.is_whole());
  REQUIRE(save_case_as(one.session, one.folder / "saved.homolog"));
  CHECK(one.is_whole());
  CHECK(unsaved_cases().empty());
}

TEST_CASE("a case goes on in a file that another program wrote with the same lines") {
  OpenCase one;
  const std::string same = read_whole_file(one.path).value();
  const fs::path other = one.folder / "other";
  SUBCASE("anew") {
    write_anew(other, same);
    fs::rename(other, one.path);
  }
  SUBCASE("in its place") {
    write_anew(one.path, same);
  }
  SUBCASE("only its time of change") {
    fs::last_write_time(one.path, fs::file_time_type::clock::now());
  }
  SUBCASE("only its rights") {
    fs::permissions(one.path, fs::perms::owner_read | fs::perms::owner_write);
  }
  REQUIRE(one.pulls());
  CHECK(one.news().empty());
  CHECK(one.session.journal()->path() == one.path);
  CHECK(one.is_whole());
}

TEST_CASE("the same lines in a file that a third program has open are left to it") {
  OpenCase one;
  const fs::path other = one.folder / "other";
  write_anew(other, read_whole_file(one.path).value());
  fs::rename(other, one.path);
  const auto theirs = Journal::open(one.path);
  REQUIRE(theirs);
  REQUIRE(one.pulls());
  CHECK(one.is_unsaved());
  CHECK(one.is_whole());
  CHECK(read_case(one.path)->session.strokes() == 1);
}

TEST_CASE("a case whose file was emptied is written anew") {
  OpenCase one;
  write_anew(one.path, "");
  REQUIRE(one.pulls());
  CHECK(has(one.news(), "It was written anew"));
  CHECK(one.session.journal()->path() == one.path);
  CHECK(one.is_whole());
}

TEST_CASE("a case that nothing takes is kept in memory and said to be lost otherwise") {
  OpenCase one;
  fs::remove_all(one.folder);
  write_anew(one.state.path / "homolog", "a file where the folder should be");
  REQUIRE(one.pulls());
  CHECK(has(one.news(), "Save the case in another folder, or it is lost."));
  CHECK(one.session.journal() == nullptr);
  CHECK(one.session.strokes() == 2);
  REQUIRE(save_case_as(one.session, one.place.folder.path / "saved.homolog"));
  CHECK(one.is_whole());
}

TEST_CASE("a case is looked after when it is saved and when it is closed") {
  OpenCase one;
  SessionThread thread(std::move(one.session), {});
  thread.apply(pull(-pole, -1.1 * pole));
  thread.save(true);
  one.session = thread.finish();
  CHECK(thread.take_refusals().saved == "Saved: every edit is in " + one.path.string());

  SessionThread saving(std::move(one.session), {});
  saving.apply(pull(pole, 1.2 * pole));
  while (saving.busy()) std::this_thread::yield();
  fs::remove(one.path);
  SUBCASE("saved") {
    saving.save(true);
    one.session = saving.finish();
    const Refusals told = saving.take_refusals();
    REQUIRE(told.news.size() == 1);
    CHECK(told.saved == "Saved: every edit is in " + one.path.string());
  }
  SUBCASE("closed") {
    one.session = saving.finish();
    CHECK(saving.take_refusals().news.size() == 1);
  }
  SUBCASE("its folder is gone too") {
    fs::remove_all(one.folder);
    saving.save(true);
    one.session = saving.finish();
    const Refusals told = saving.take_refusals();
    REQUIRE(told.news.size() == 1);
    CHECK(told.saved.empty());  // it has no name yet
    CHECK(one.is_unsaved());
  }
  CHECK(one.is_whole());
  CHECK(one.session.strokes() == 3);
}

TEST_CASE("a case that was only looked at is not written again when its file is deleted") {
  OpenCase one;
  one.session = EditSession(one.place.document());
  auto read = open_case(one.path);
  REQUIRE(read);
  SessionThread thread(std::move(read->session), {});
  thread.apply(Note{"window", std::array<double, 2>{0, 1}, {}});
  while (thread.busy()) std::this_thread::yield();
  fs::remove(one.path);
  (void)thread.finish();
  CHECK(thread.take_refusals().news.empty());
  CHECK_FALSE(fs::exists(one.path));
}

TEST_CASE("a case that nobody saved is called kept and one that was saved by hand is called saved") {
  const OpenCase one;
  SessionThread session(EditSession(one.place.document()), [] {});
  const auto message_of = [&](const fs::path& path) {
    const auto before = session.snapshot()->committed;
    session.save_as(path);
    REQUIRE(test::wait_until([&] { return session.snapshot()->committed > before; }));
    return session.snapshot()->message;
  };
  CHECK(message_of(new_unsaved_path().value()) == "Kept until you save it.");
  const fs::path saved = one.folder / "saved.homolog";
  CHECK(message_of(saved) == "Saved as " + saved.string());
}

}  // namespace homolog
