#include "core/session/journal.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <random>
#include <sstream>
#include <thread>

#include "core/session/case_lines.h"
#include "core/session/unsaved_cases.h"
#include "tests/case_folder.h"
#include "tests/environment_variable.h"
#include "tests/refusal.h"
#include "tests/small_files.h"

namespace {

std::atomic<int> syncs = 0;

}  // namespace

/// In place of the C library's, in this program: counts.
extern "C" int fsync(int descriptor) {
  ++syncs;
  return static_cast<int>(::syscall(SYS_fsync, descriptor));
}

namespace homolog {

TEST_CASE("every line is brought to the disk before it counts as written unless it may wait") {
  const CaseFolder folder;
  const fs::path path = folder.folder.path / "lines";
  write_bytes(path, "{}\n");
  const auto journal = Journal::open(path).value();
  const int before = syncs;
  REQUIRE(journal->append("{\"a\":1}\n"));
  CHECK(syncs == before + 1);
  CHECK_FALSE(journal->unsynced());
  REQUIRE(journal->append("{\"b\":1}\n", false));
  REQUIRE(journal->append("{\"c\":1}\n", false));
  CHECK(syncs == before + 1);
  CHECK(journal->unsynced());
  REQUIRE(journal->sync());
  CHECK(syncs == before + 2);
  CHECK_FALSE(journal->unsynced());
  REQUIRE(journal->sync());  // nothing waits
  CHECK(syncs == before + 2);
  REQUIRE(journal->append("{\"d\":1}\n", false));
  REQUIRE(journal->append("{\"e\":1}\n"));  // which brings the one before along
  CHECK(syncs == before + 3);
  CHECK_FALSE(journal->unsynced());
  REQUIRE(journal->keep_first(11));
  CHECK(syncs == before + 4);
  CHECK(read_whole_file(path).value() == "{}\n{\"a\":1}\n");
}

TEST_CASE("every edit of a case and every undo is on the disk when it is done") {
  const CaseFolder folder;
  EditSession session = folder.create();
  for (const Action& action : {Action(pull(pole, 1.1 * pole)), Action(SetStiffnessBase{5}), Action(Undo{}),
                               Action(Redo{}), Action(PlaceLandmark{"north", pole})}) {
    const int before = syncs;
    REQUIRE(session.apply(action));
    CHECK(syncs > before);
    CHECK_FALSE(session.unsynced());
  }
}

TEST_CASE("what waits for the disk is brought there when a journal is closed") {
  const CaseFolder folder;
  const fs::path path = folder.folder.path / "lines";
  write_bytes(path, "{}\n");
  int before = 0;
  {
    const auto journal = Journal::open(path).value();
    REQUIRE(journal->append("{\"a\":1}\n", false));
    before = syncs;
  }
  CHECK(syncs == before + 1);
  CHECK_FALSE(Journal::in_use(path));
}

TEST_CASE("a journal that is open is nobody else's") {
  const CaseFolder folder;
  const fs::path path = folder.folder.path / "lines";
  write_bytes(path, "{}\n");
  const auto journal = Journal::open(path).value();
  CHECK(Journal::in_use(path));
  CHECK(says(Journal::open(path), "is open in another program"));
  std::ofstream(path, std::ios::app) << "{}\n";
  CHECK(says(journal->append("{}\n"), "changed by another program"));
  fs::resize_file(path, 3);
  CHECK(journal->append("{}\n"));
}

TEST_CASE("a file is not in use because another asks whether it is") {
  const CaseFolder folder;
  const fs::path path = folder.folder.path / "lines";
  write_bytes(path, "{}\n");
  std::atomic<bool> over = false;
  std::atomic<std::uint64_t> asked = 0;
  std::jthread other([&] {
    for (; !over; ++asked) Journal::in_use(path);
  });
  while (asked == 0) std::this_thread::yield();
  int in_use = 0;
  for (int k = 0; k < 20000; ++k) in_use += Journal::in_use(path) ? 1 : 0;
  over = true;
  CHECK(in_use == 0);
}

TEST_CASE("half a line that cannot be taken back is the last one that a journal gets") {
  // A file in memory that may grow but not shrink, so that no rollback succeeds.
  const int file = ::memfd_create("journal", MFD_ALLOW_SEALING);
  REQUIRE(file >= 0);
  REQUIRE(::write(file, "{}\n", 3) == 3);
  REQUIRE(::fcntl(file, F_ADD_SEALS, F_SEAL_SHRINK) == 0);
  const fs::path path = "/proc/self/fd/" + std::to_string(file);
  auto journal = Journal::open(path);
  REQUIRE(journal);
  Result<void> too_long, later;
  {
    const SmallFilesOnly full(10);
    too_long = (*journal)->append("{\"note\":\"too long\"}\n");
    later = (*journal)->append("{}\n");  // there would be room for it
  }
  CHECK_FALSE(too_long);
  CHECK(says(later, "a refused line that could not be removed"));
  char bytes[64] = {};
  CHECK(::pread(file, bytes, sizeof bytes, 0) == 10);
  CHECK(std::string(bytes) == "{}\n{\"note\"");
  ::close(file);
}

TEST_CASE("a case that is only read keeps its lines when it goes on elsewhere") {
  const CaseFolder folder;
  { REQUIRE(folder.create().apply(pull(pole, 1.1 * pole))); }
  folder.append("{\"note\":\"x\",\"author\":\"someone\"}");  // without a line feed
  auto read = read_case(folder.case_path);
  REQUIRE(read);
  REQUIRE(read->session.apply(pull(-pole, -1.1 * pole)));
  REQUIRE(read->session.apply(Undo{}));
  const fs::path saved = folder.folder.path / "saved.homolog";
  REQUIRE(save_case_as(read->session, saved));
  REQUIRE(read->session.apply(Redo{}));
  CHECK(read_whole_file(saved)->find("\"author\":\"someone\"}\n{\"tool\"") != std::string::npos);
  CHECK(read_case(saved)->session.strokes() == 2);
  CHECK(read_case(folder.case_path)->session.strokes() == 1);
}

TEST_CASE("many unsaved cases are listed without reading them through") {
  const CaseFolder folder;
  const EnvironmentVariable state("XDG_STATE_HOME", folder.folder.path);
  const fs::path first = new_unsaved_path().value();
  CHECK(fs::status(first.parent_path()).permissions() == fs::perms::owner_all);
  const auto name = [&](int k) { return first.parent_path() / ("unsaved-" + std::to_string(1000 + k) + ".homolog"); };
  for (int k = 0; k < 200; ++k)
    std::ofstream(name(k)) << "{\"homolog\":1,\"volume\":\"" << k << ".nii\"}\n"
                           << (k % 2 == 0 ? "{\"frame\":1,\"look\":true}\n"
                                          : "{\"stiffness_base\":5}\n{\"undo\":true}\n");
  std::ofstream(name(200)) << "{\"homolog\":1}\n{\"of a newer version\":1}\n";
  std::ofstream(name(201)) << "{\"homolog\":1}\n{\"tool\":\"pu";
  REQUIRE(::mkfifo(name(202).c_str(), 0600) == 0);
  // 100 GB, of which only the first step is read.
  std::ofstream(name(203)) << "{\"homolog\":1}\n{\"stiffness_base\":5}\n";
  fs::resize_file(name(203), std::uintmax_t{100} << 30);
  const auto found = unsaved_cases();
  REQUIRE(found.size() == 203);
  CHECK(found.front().journal == name(203));
  for (const UnsavedCase& one : found) {
    const int number = std::stoi(one.journal.stem().string().substr(8)) - 1000;
    CHECK(one.edited == (number >= 200 || number % 2 == 1));
  }
  CHECK(found.back().header == "{\"homolog\":1,\"volume\":\"0.nii\"}");
}

TEST_CASE("what was taken back is not counted among the steps of an unsaved case") {
  const CaseFolder folder;
  const fs::path file = folder.folder.path / "counted.homolog";
  const auto steps_of = [&](const std::string& lines) {
    std::ofstream(file) << "{\"homolog\":1}\n" + lines;
    return count_steps(file);
  };
  const std::string edit = "{\"stiffness_base\":5}\n", joined = "{\"stiffness_base\":6,\"joined\":true}\n";
  const std::string undo = "{\"undo\":true}\n", redo = "{\"redo\":true}\n";
  CHECK(steps_of(edit + joined + edit) == 2);
  CHECK(steps_of(edit + undo) == 0);
  CHECK(steps_of(edit + edit + undo + undo + redo) == 1);
  CHECK(steps_of(edit + undo + edit + redo) == 1);
}

TEST_CASE("a long file is read line by line whatever its pieces are") {
  const CaseFolder folder;
  const fs::path path = folder.folder.path / "lines";
  std::string text;
  std::vector<std::string> lines;
  std::mt19937 random(1);
  for (int k = 0; k < 300; ++k) {
    lines.emplace_back(random() % (k % 50 == 0 ? 300000 : 2000), static_cast<char>('a' + k % 26));
    text += lines.back() + (k < 299 ? "\n" : "");
  }
  write_bytes(path, text);
  const auto file = LineFile::open(path).value();
  std::size_t k = 0;
  bool same = true, last_ended = true;
  REQUIRE(file->for_each_line([&](std::string_view line, std::uint64_t at, bool ended) -> Result<void> {
    same = same && k < lines.size() && line == lines[k] && file->read(at, line.size()).value() == line;
    ++k;
    last_ended = ended;
    return {};
  }));
  CHECK(same);
  CHECK(k == lines.size());
  CHECK_FALSE(last_ended);
  CHECK_FALSE(LineFile::open(folder.folder.path / "none"));
  CHECK_FALSE(LineFile::open(folder.folder.path));
  REQUIRE(::mkfifo((folder.folder.path / "pipe").c_str(), 0600) == 0);
  CHECK_FALSE(LineFile::open(folder.folder.path / "pipe"));
  CHECK_FALSE(Journal::open(folder.folder.path / "pipe"));
}

TEST_CASE("a line behind one without its line feed is found again and both are checked") {
  const CaseFolder folder;
  const fs::path path = folder.folder.path / "lines";
  write_bytes(path, "head\n{\"a\":1}");
  const auto file = LineFile::open(path).value();
  CaseLines lines(file, 5, 12, CaseLines::checked(0, "{\"a\":1}"));
  const auto second = lines.append("{\"b\":2}\n"), third = lines.append("{\"c\":3}\n");
  REQUIRE(second);
  REQUIRE(third);
  CHECK(lines.read({0, 7}).value() == "{\"a\":1}");
  CHECK(lines.read({*second, 7}).value() == "{\"b\":2}");
  CHECK(lines.read({*third, 7}).value() == "{\"c\":3}");
  CHECK(lines.check() == CaseLines::checked(0, "{\"a\":1}\n{\"b\":2}\n{\"c\":3}\n"));
  std::ostringstream all;
  REQUIRE(lines.copy_to(all));
  CHECK(all.str() == "{\"a\":1}\n{\"b\":2}\n{\"c\":3}\n");
}

}  // namespace homolog
