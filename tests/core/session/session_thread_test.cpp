#include "core/session/session_thread.h"

#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <new>
#include <stdexcept>

#include "tests/ball.h"
#include "tests/shapes.h"
#include "tests/wait.h"

using namespace homolog;

namespace {

Stroke pull(double to_mm, double sigma_mm = 10) {
  return {Tool::pull, Vec3(0, 0, 40), Vec3(0, 0, to_mm), sigma_mm, {}, false, 1};
}

/// Waits until `reached` holds of the latest snapshot; false where that takes too long.
template <class Reached>
bool wait_for(const SessionThread& thread, const Reached& reached) {
  return test::wait_until([&] { return reached(*thread.snapshot()); });
}

double height(const Document& document) {
  return document.view()->shape.points->col(2).maxCoeff();
}

}  // namespace

TEST_CASE("no queued action is lost and they come in order") {
  std::atomic<int> wakes{0};
  SessionThread thread(EditSession(ball_document(40)), [&] { ++wakes; });
  for (int k = 0; k < 20; ++k) {
    thread.preview(pull(41 + k));
    thread.apply(pull(45));
    thread.apply(Undo{});
  }
  thread.apply(pull(50));
  REQUIRE(wait_for(thread, [](const Snapshot& s) { return s.committed == 41; }));
  CHECK(thread.snapshot()->error.empty());
  const EditSession session = thread.finish();
  CHECK(session.strokes() == 1);
  CHECK(height(session.document()) == doctest::Approx(50).epsilon(0.01));
  CHECK(wakes >= 41);
}

TEST_CASE("a session is busy until what was posted is done") {
  SessionThread thread(EditSession(ball_document(40)), nullptr);
  CHECK_FALSE(thread.busy());
  std::atomic<bool> go{false};
  thread.apply_computed([&](const Document&, const std::string&) -> Result<std::optional<Action>> {
    while (!go) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return std::optional<Action>();
  });
  thread.apply(pull(45));
  CHECK(thread.busy());
  go = true;
  REQUIRE(wait_for(thread, [](const Snapshot& s) { return s.committed == 2; }));
  CHECK_FALSE(thread.busy());
}

TEST_CASE("the latest preview wins and its end shows the document again") {
  SessionThread thread(EditSession(ball_document(40)), nullptr);
  for (double to = 40; to <= 50; to += 0.05) thread.preview(pull(to));
  REQUIRE(wait_for(thread, [](const Snapshot& s) { return s.preview && height(*s.shown) > 49.9; }));
  CHECK(thread.snapshot()->document != thread.snapshot()->shown);
  CHECK(height(*thread.snapshot()->document) < 40.1);
  thread.preview(std::nullopt);
  REQUIRE(wait_for(thread, [](const Snapshot& s) { return !s.preview; }));
  CHECK(thread.snapshot()->document == thread.snapshot()->shown);
}

TEST_CASE("a stale preview never outlives the action that ends its gesture") {
  SessionThread thread(EditSession(ball_document(40)), nullptr);
  for (int k = 1; k <= 50; ++k) {
    thread.preview(pull(60));
    thread.apply(pull(41));
    thread.apply(Undo{});
    REQUIRE(wait_for(thread, [&](const Snapshot& s) { return s.committed == static_cast<std::uint64_t>(2 * k); }));
    CHECK(!thread.snapshot()->preview);
    CHECK(height(*thread.snapshot()->shown) < 40.1);
  }
}

TEST_CASE("a note ends no preview that waits") {
  SessionThread thread(EditSession(ball_document(40)), nullptr);
  for (int k = 1; k <= 50; ++k) {
    thread.preview(pull(60));
    thread.apply(Note{"a remark"});
    REQUIRE(wait_for(thread, [](const Snapshot& s) { return s.preview && height(*s.shown) > 59; }));
    thread.preview(std::nullopt);
    REQUIRE(wait_for(thread, [](const Snapshot& s) { return !s.preview; }));
  }
}

TEST_CASE("a refused action is told in a sentence and changes nothing") {
  SessionThread thread(EditSession(ball_document(40)), nullptr);
  thread.apply(SetStiffnessBase{-1});
  REQUIRE(wait_for(thread, [](const Snapshot& s) { return s.committed == 1; }));
  CHECK(!thread.snapshot()->error.empty());
  CHECK(!thread.snapshot()->can_undo);
  thread.apply(SetStiffnessBase{5});
  REQUIRE(wait_for(thread, [](const Snapshot& s) { return s.committed == 2; }));
  CHECK(thread.snapshot()->error.empty());
  CHECK(thread.snapshot()->can_undo);
}

TEST_CASE("a stale preview never outlives the computed edit that ends its gesture either") {
  SessionThread thread(EditSession(ball_document(40)), nullptr);
  const Compute nothing = [](const Document&, const std::string&) -> Result<std::optional<Action>> {
    return std::optional<Action>();
  };
  const Compute refused = [](const Document&, const std::string&) -> Result<std::optional<Action>> {
    return fail("", "Not today.");
  };
  const Compute softer = [](const Document&, const std::string&) -> Result<std::optional<Action>> {
    return SetStiffnessBase{5};
  };
  std::uint64_t edits = 0;
  for (int k = 0; k < 10; ++k)
    for (const Compute& compute : {nothing, refused, softer}) {
      // The first action keeps the thread busy, so that the preview still waits when the computed edit is posted.
      thread.apply(pull(41));
      thread.preview(pull(60));
      thread.apply_computed(compute);
      edits += 2;
      REQUIRE(wait_for(thread, [&](const Snapshot& s) { return s.committed == edits; }));
      thread.apply(Undo{});
      ++edits;
      REQUIRE(wait_for(thread, [&](const Snapshot& s) { return s.committed == edits; }));
      CHECK(!thread.snapshot()->preview);
      CHECK(thread.snapshot()->shown == thread.snapshot()->document);
    }
}

TEST_CASE("a preview that is shown ends with a computed edit that gives nothing") {
  SessionThread thread(EditSession(ball_document(40)), nullptr);
  thread.preview(pull(60));
  REQUIRE(wait_for(thread, [](const Snapshot& s) { return s.preview.has_value(); }));
  thread.apply_computed(
      [](const Document&, const std::string&) -> Result<std::optional<Action>> { return std::optional<Action>(); });
  REQUIRE(wait_for(thread, [](const Snapshot& s) { return s.committed == 1; }));
  CHECK(!thread.snapshot()->preview);
  CHECK(thread.snapshot()->shown == thread.snapshot()->document);
}

TEST_CASE("the mesh that a preview showed stays on the screen while what follows its edit is computed") {
  for (const bool joined : {true, false})
    for (const bool gives_something : {true, false}) {
      CAPTURE(joined);
      CAPTURE(gives_something);
      SessionThread thread(EditSession(ball_document(40)), nullptr);
      thread.preview(pull(60));
      REQUIRE(wait_for(thread, [](const Snapshot& s) { return s.preview && height(*s.shown) > 59; }));
      std::atomic<bool> runs{false}, go{false};
      thread.apply(SetStiffnessBase{7});
      thread.apply_computed(
          [&](const Document&, const std::string&) -> Result<std::optional<Action>> {
            runs = true;
            while (!go) std::this_thread::sleep_for(std::chrono::milliseconds(1));
            return gives_something ? std::optional<Action>(pull(50)) : std::nullopt;
          },
          joined);
      REQUIRE(test::wait_until([&] { return runs.load(); }));
      const auto meanwhile = thread.snapshot();
      CHECK(meanwhile->preview.has_value() == joined);
      CHECK((height(*meanwhile->shown) > 59) == joined);
      CHECK(height(*meanwhile->document) < 40.1);
      CHECK(meanwhile->shown->view()->paint().base == 7);  // what was edited is seen, too
      go = true;
      REQUIRE(wait_for(thread, [](const Snapshot& s) { return s.committed == 2; }));
      const auto after = thread.snapshot();
      CHECK(!after->preview);
      CHECK(after->shown == after->document);
      CHECK(height(*after->shown) == doctest::Approx(gives_something ? 50 : 40).epsilon(0.02));
    }
}

TEST_CASE("what is thrown in a job ends neither the thread nor the case") {
  SessionThread thread(EditSession(ball_document(40)), nullptr);
  thread.apply(pull(45));
  REQUIRE(wait_for(thread, [](const Snapshot& s) { return s.committed == 1; }));
  const auto done = thread.snapshot()->document;
  std::uint64_t jobs = 1;
  const auto told = [&](const Compute& compute) {
    thread.apply_computed(compute);
    ++jobs;
    REQUIRE(wait_for(thread, [&](const Snapshot& s) { return s.committed == jobs; }));
    CHECK((thread.snapshot()->document == done));
    return thread.snapshot()->error;
  };
  CHECK(told([](const Document&, const std::string&) -> Result<std::optional<Action>> {
          throw std::bad_alloc();
        }).find("needs more memory") != std::string::npos);
  CHECK(told([](const Document&, const std::string&) -> Result<std::optional<Action>> {
          throw std::runtime_error("no more threads");
        }).find("no more threads") != std::string::npos);
  thread.preview(std::nullopt, {[](const Document&, const std::string&) -> Result<std::optional<Action>> {
                   throw std::bad_alloc();
                 }});
  REQUIRE(wait_for(thread, [](const Snapshot& s) { return s.error.find("needs more memory") != std::string::npos; }));
  CHECK(thread.snapshot()->committed == jobs);
  thread.apply(pull(50));
  REQUIRE(wait_for(thread, [&](const Snapshot& s) { return s.committed == jobs + 1; }));
  CHECK(thread.snapshot()->error.empty());
}
