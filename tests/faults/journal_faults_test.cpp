#include <cerrno>

#include "core/session/journal.h"
#include "core/session/session_thread.h"
#include "tests/case_folder.h"
#include "tests/faults/disk.h"
#include "tests/must.h"
#include "tests/refusal.h"
#include "tests/small_files.h"

// A case's file where the system says too late that it could not write.

namespace homolog {

namespace {

/// What a disk does whose sync failed: it forgets what was not on it, and goes on as if nothing were.
void forget_behind(const fs::path& file, std::uintmax_t bytes) {
  fs::resize_file(file, bytes);
}

/// A file of lines without a case.
struct LinesFolder {
  TemporaryFolder folder;
  fs::path path = folder.path / "lines";
  std::string accepted = "first\n";

  LinesFolder() { std::ofstream(path) << accepted; }
  std::string text() const { return read_whole_file(path).value(); }
};

}  // namespace

TEST_CASE("from whatever call to whatever line the disk fails a journal ends with the lines it accepted") {
  const WatchedDisk watched;
  struct Step {
    std::string lines;  ///< empty: a sync
    bool synced = false;
  };
  const std::vector<Step> steps{{"aa\n", true}, {"bbb\n"},     {"cccc\n"}, {},
                                {"ddddd\n"},    {"e\n", true}, {"ff\n"},   {"ggg\n", true}};
  for (std::size_t recovers = 1; recovers <= steps.size(); ++recovers) {
    for (int at = 1; at < 16; ++at) {
      CAPTURE(recovers);
      CAPTURE(at);
      LinesFolder lines;
      {
        const auto journal = Journal::open(lines.path).value();
        disk_fail(at, ENOSPC, 1);
        for (std::size_t k = 0; k < steps.size(); ++k) {
          if (k == recovers) disk_fail(0, 0, 0);
          const bool done = steps[k].lines.empty() || journal->append(steps[k].lines, steps[k].synced);
          if (done) lines.accepted += steps[k].lines;
          if (steps[k].lines.empty()) (void)journal->sync();
          CHECK((k < recovers || done));  // edits are kept again
        }
        disk_fail(0, 0, 0);
      }
      CHECK(lines.text() == lines.accepted);
    }
  }
}

TEST_CASE("a disk that refuses a write as read-only is known as that from then on") {
  const WatchedDisk watched;
  LinesFolder lines;
  const auto journal = test::must(Journal::open(lines.path));
  disk_fail(1, EROFS, 1);
  const auto refused = journal->append("second\n");
  REQUIRE_FALSE(refused);
  CHECK(refused.error().what.find("goes on as an unsaved one") != std::string::npos);
  CHECK(journal->fate() == Journal::Fate::read_only);
  disk_fail(0, 0, 0);
  CHECK(lines.text() == lines.accepted);
}

TEST_CASE("half a line that the disk did not let be taken out is taken out when it does") {
  const WatchedDisk watched;
  LinesFolder lines;
  {
    const auto journal = Journal::open(lines.path).value();
    {
      const SmallFilesOnly full(10);
      disk_fail(3, EIO, 0);  // behind what fits and what does not: the cut
      CHECK_FALSE(journal->append("too long\n"));
    }
    disk_fail(0, 0, 0);
    CHECK(lines.text() == "first\ntoo ");
    CHECK(journal->append("short\n"));
  }
  CHECK(lines.text() == "first\nshort\n");
}

TEST_CASE("what another program makes of a file with a refused line stays as it is") {
  const WatchedDisk watched;
  for (const std::string theirs : {"first\nrefused\ntheirs\n", "fir"}) {
    CAPTURE(theirs);
    LinesFolder lines;
    {
      const auto journal = Journal::open(lines.path).value();
      disk_fail(2, EIO, 1);
      CHECK_FALSE(journal->append("refused\n"));
      disk_fail(0, 0, 0);
      CHECK(lines.text() == "first\nrefused\n");
      std::ofstream(lines.path) << theirs;
      CHECK(says(journal->append("next\n"), "was changed by another program"));
    }
    CHECK(lines.text() == theirs);
  }
}

TEST_CASE("a sync that fails while the case closes is told") {
  const WatchedDisk watched;
  const CaseFolder folder;
  EditSession session = folder.create();
  REQUIRE(session.apply(pull(pole, 1.1 * pole)));
  SessionThread thread(std::move(session), {});
  disk_fail(2, EIO, 1);  // behind the touch its sync, and all that would mend it
  thread.apply(pull(-pole, -1.1 * pole), true);
  const EditSession closed = thread.finish();
  CHECK(thread.take_refusals().first.find("shown but not saved") != std::string::npos);
  CHECK(closed.strokes() == 2);
  disk_fail(0, 0, 0);
}

TEST_CASE("lines that a failed sync may have lost are written again") {
  const WatchedDisk watched;
  const CaseFolder folder;
  EditSession session = folder.create();
  REQUIRE(session.apply(pull(pole, 1.1 * pole)));
  REQUIRE(session.apply(pull(-pole, -1.1 * pole), true));
  CHECK(session.unsynced());
  const std::string kept = folder.text();
  disk_record(1);
  disk_fail(2, EIO, 0);  // the second call of an edit is its sync
  CHECK(says(session.apply(pull(Vec3(40, 0, 0), Vec3(42, 0, 0))), "Input/output error"));
  disk_fail(0, 0, 0);
  disk_record(0);
  std::size_t count = 0;
  const disk_operation* done = disk_recorded(&count);
  std::string written;
  for (std::size_t k = 0; k < count; ++k)
    if (done[k].call == disk_writes) written = std::string(done[k].bytes, done[k].size);
  REQUIRE(written.size() > 10);
  CHECK(kept.ends_with(written));  // the touch, once more
  CHECK(done[count - 1].call == disk_syncs_file);
  CHECK(folder.text() == kept);
  CHECK_FALSE(session.unsynced());
  REQUIRE(session.apply(pull(Vec3(40, 0, 0), Vec3(42, 0, 0))));
  CHECK(state_of(read_case(folder.case_path)->session.document()) == state_of(session.document()));
}

TEST_CASE("a refused line that the disk did not let be taken out is taken out when it does") {
  const WatchedDisk watched;
  for (const bool goes_on : {true, false}) {
    CAPTURE(goes_on);
    const CaseFolder folder;
    std::string shown;
    {
      EditSession session = folder.create();
      REQUIRE(session.apply(pull(pole, 1.1 * pole)));
      const std::string kept = folder.text();
      disk_fail(2, EIO, 1);  // its sync, and the cut behind it
      CHECK(says(session.apply(pull(-pole, -1.1 * pole)), "Input/output error"));
      CHECK(says(session.apply(pull(-pole, -1.1 * pole)), "could not be removed"));
      disk_fail(0, 0, 0);
      CHECK(folder.text().size() > kept.size());
      if (goes_on) REQUIRE(session.apply(pull(Vec3(40, 0, 0), Vec3(42, 0, 0))));
      shown = state_of(session.document());
      CHECK(session.strokes() == (goes_on ? 2 : 1));
    }
    CHECK(state_of(read_case(folder.case_path)->session.document()) == shown);
  }
}

TEST_CASE("where no sync succeeds any more the last lines are in memory and can be saved elsewhere") {
  const WatchedDisk watched;
  const CaseFolder folder;
  EditSession session = folder.create();
  REQUIRE(session.apply(pull(pole, 1.1 * pole)));
  const auto synced = fs::file_size(folder.case_path);
  REQUIRE(session.apply(pull(-pole, -1.1 * pole), true));
  const std::string shown = state_of(session.document());
  disk_fail(2, EIO, 1);
  CHECK(says(session.apply(pull(Vec3(40, 0, 0), Vec3(42, 0, 0))), "the last ones are shown but not saved"));
  CHECK(says(session.apply(pull(Vec3(40, 0, 0), Vec3(42, 0, 0))), "so the edit was not made"));
  CHECK(says(session.apply(Undo{}), "so the edit was not made"));
  CHECK(state_of(session.document()) == shown);
  disk_fail(0, 0, 0);
  forget_behind(folder.case_path, synced);
  const fs::path saved = folder.folder.path / "saved.homolog";
  REQUIRE(save_case_as(session, saved));
  CHECK(state_of(read_case(saved)->session.document()) == shown);
  REQUIRE(session.apply(Undo{}));
  CHECK(session.strokes() == 0);  // both were one step
}

TEST_CASE("where syncs succeed again the next edit brings the last lines to the disk") {
  const WatchedDisk watched;
  const CaseFolder folder;
  EditSession session = folder.create();
  REQUIRE(session.apply(pull(pole, 1.1 * pole)));
  const auto synced = fs::file_size(folder.case_path);
  REQUIRE(session.apply(pull(-pole, -1.1 * pole), true));
  disk_fail(1, EIO, 1);
  CHECK(says(session.sync(), "the last edits are shown but not saved"));
  disk_fail(0, 0, 0);
  forget_behind(folder.case_path, synced);
  REQUIRE(session.apply(SetStiffnessBase{5}));
  CHECK(state_of(read_case(folder.case_path)->session.document()) == state_of(session.document()));
  CHECK(session.document().structure()->paint.base == 5);
  REQUIRE(session.apply(Undo{}));
  REQUIRE(session.apply(Undo{}));
  CHECK(session.strokes() == 0);
}

TEST_CASE("a sync that fails once leaves nothing that only memory holds") {
  const WatchedDisk watched;
  const CaseFolder folder;
  EditSession session = folder.create();
  REQUIRE(session.apply(pull(pole, 1.1 * pole), true));
  REQUIRE(session.apply(pull(-pole, -1.1 * pole), true));
  disk_fail(1, EIO, 0);
  CHECK(session.sync());
  CHECK(disk_calls() == 4);  // a sync that fails, and the lines again: cut, written, synced
  disk_fail(0, 0, 0);
  CHECK(state_of(read_case(folder.case_path)->session.document()) == state_of(session.document()));
}

}  // namespace homolog
