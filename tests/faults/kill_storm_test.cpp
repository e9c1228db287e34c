#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <random>
#include <sstream>
#include <vector>

#include "core/session/unsaved_cases.h"
#include "tests/faults/disk.h"

// Sessions of the window, each in a process of its own that is killed at a random moment. Before each deed it says what
// it is about to do, and when the window shows it as done it says what it shows. All that was shown has to be there.

extern char** environ;

namespace homolog {

namespace {

constexpr const char* session_name = "a session that is killed";

/// Written at once, so that a kill cannot take it.
void say(const std::string& line) {
  const std::string text = line + '\n';
  (void)!::write(3, text.data(), text.size());
}

/// "done", the case's file, its state, the study's file, the number in its notes; by tabs.
void say_what_is_shown(Driver& driver, int note) {
  driver.settle();
  say("done\t" + driver.case_file().string() + '\t' + state_of(driver.document()) + '\t' +
      driver.state().models.kept.file.string() + '\t' + std::to_string(note));
}

void do_something(Driver& driver, const BallDesk& desk, std::mt19937& random, int number, int& note) {
  const auto pick = random() % 10;
  const auto names = [&](const char* name, const char* ending) {
    return desk.out / (name + std::to_string(number) + ending);
  };
  const std::string case_of_study = driver.state().models.study.cases.front().name;
  if (pick < 3) {
    say("doing\tan edit");
    apply(driver, BallDesk::pull(number));
  } else if (pick == 3) {
    say("doing\ta stroke of a brush");
    apply(driver, BallDesk::relax(number));
    for (int k = 1; k < 5; ++k) apply(driver, BallDesk::relax(number + k), true);
  } else if (pick == 4) {
    say("doing\tundo");
    driver.app().send(GoInHistory{-1});
  } else if (pick < 7) {
    const fs::path file = pick == 5 ? names("saved", ".homolog") : desk.out / "same.homolog";
    say("doing\tsave as\t" + file.string());
    driver.app().send(SaveCaseAs{{file}});
  } else if (pick == 7) {
    const fs::path file = names("study", ".study.json");
    say("doing\tsave study as\t" + file.string());
    driver.app().send(SaveStudyAs{{file}});
  } else if (pick == 8) {
    say("doing\texport");
    driver.app().send(ExportMesh{{desk.out / "mesh.ply"}});
  } else {
    say("doing\tnote");
  }
  // The study is written with everything.
  driver.app().send(SetCaseText{case_of_study, "notes", std::to_string(++note)});
  say_what_is_shown(driver, note);
}

struct Told {
  fs::path case_file, study_file, next;  ///< next: to where it was going on when it was killed
  std::string state;
  int note = 0;
  bool any = false;
  std::string doing;
};

Told told_by(const std::string& text) {
  Told told;
  std::istringstream lines(text.substr(0, text.rfind('\n') + 1));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string kind, word;
    std::getline(words, kind, '\t');
    told.next.clear();
    if (kind == "doing") {
      std::getline(words, told.doing, '\t');
      if (std::getline(words, word, '\t')) told.next = word;
      continue;
    }
    told.any = true;
    told.doing.clear();
    std::getline(words, word, '\t');
    told.case_file = word;
    std::getline(words, told.state, '\t');
    std::getline(words, word, '\t');
    told.study_file = word;
    words >> told.note;
  }
  return told;
}

/// Starts a session, kills it so long after its first words, and gives all that it said.
std::string killed_session(const fs::path& folder, unsigned seed, std::chrono::milliseconds after) {
  int ends[2];
  REQUIRE(::pipe2(ends, O_CLOEXEC) == 0);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], 3);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
  const EnvironmentVariable its_seed("HOMOLOG_STORM", std::to_string(seed)), temporary("TMPDIR", folder.string());
  std::string program = "/proc/self/exe", which = std::string("-tc=") + session_name, all = "--no-skip";
  char* arguments[] = {program.data(), which.data(), all.data(), nullptr};
  pid_t child = 0;
  REQUIRE(::posix_spawn(&child, "/proc/self/exe", &actions, nullptr, arguments, environ) == 0);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  std::string text;
  std::optional<std::chrono::steady_clock::time_point> end;
  for (;;) {
    const auto now = std::chrono::steady_clock::now();
    if (end && now >= *end) ::kill(child, SIGKILL);
    const auto left = end ? std::chrono::duration_cast<std::chrono::milliseconds>(*end - now).count() : 60'000;
    pollfd wait{ends[0], POLLIN, 0};
    if (::poll(&wait, 1, static_cast<int>(std::clamp<long>(left, 0, 60'000))) == 0) continue;
    char bytes[4096];
    const ssize_t got = ::read(ends[0], bytes, sizeof bytes);
    if (got <= 0) break;
    text.append(bytes, static_cast<std::size_t>(got));
    if (!end) end = std::chrono::steady_clock::now() + after;
  }
  ::close(ends[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  CHECK_MESSAGE(WIFSIGNALED(status), "the session ended by itself");
  return text;
}

void check_case(const Told& told) {
  const bool there = fs::exists(told.case_file);
  const fs::path file = there ? told.case_file : told.next;
  INFO(file.string());
  REQUIRE_MESSAGE(fs::exists(file), "the case is gone");
  const auto states = states_of_file(file);
  CHECK_MESSAGE(std::find(states.begin(), states.end(), told.state) != states.end(), "what was shown is lost");
}

void check_study(const Told& told) {
  INFO(told.study_file.string());
  const auto read = read_study(told.study_file);
  REQUIRE_MESSAGE(read, (read ? std::string() : read.error().sentence()));
  REQUIRE(read->study.cases.size() == 4);
  const std::string& notes = read->study.cases.front().notes;
  CHECK(!notes.empty());
  if (!notes.empty()) CHECK(std::stoi(notes) >= told.note);
}

}  // namespace

TEST_CASE("a session that is killed" * doctest::skip()) {
  const char* seed = std::getenv("HOMOLOG_STORM");
  if (seed == nullptr) return;
  std::mt19937 random(static_cast<unsigned>(std::atoi(seed)));
  const BallDesk desk;
  Driver driver(desk.document());
  driver.app().send(OpenStudy{{desk.study}});
  if (random() % 2 == 0) driver.app().send(OpenFiles{{desk.scan}});
  driver.settle();
  int note = 0;
  driver.app().send(SetCaseText{"ball100", "notes", std::to_string(++note)});
  say_what_is_shown(driver, note);
  for (int number = 1; number < 2000; ++number) do_something(driver, desk, random, number, note);
}

TEST_CASE("sessions that are killed at random moments lose nothing that was shown as done") {
  const int sessions = trials("HOMOLOG_KILLS", 2);
  std::mt19937 random(7);
  std::map<std::string, int> doing;
  for (int k = 0; k < sessions; ++k) {
    INFO("session ", k);
    const TemporaryFolder folder;
    const std::chrono::milliseconds after(random() % 800);
    const Told told = told_by(killed_session(folder.path, static_cast<unsigned>(k + 1), after));
    REQUIRE(told.any);
    INFO("killed while: ", told.doing);
    ++doing[told.doing.empty() ? "nothing" : told.doing];
    check_case(told);
    check_study(told);
    for (const auto& entry : fs::recursive_directory_iterator(folder.path)) {
      INFO(entry.path().string());
      if (entry.path().extension() == ".homolog") states_of_file(entry.path());
      if (entry.path().filename() == "mesh.ply") CHECK(read_mesh_file(entry.path()));
    }
  }
  std::string list;
  for (const auto& [what, times] : doing) list += "; " + std::to_string(times) + " while: " + what;
  MESSAGE(sessions, " sessions killed", list);
}

}  // namespace homolog
