#include "core/base/files/files.h"

#include <doctest/doctest.h>

#include <fcntl.h>
#include <pwd.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <iterator>
#include <set>

#include "core/session/case_file.h"
#include "core/session/unsaved_cases.h"
#include "tests/environment_variable.h"
#include "tests/refusal.h"
#include "tests/small_files.h"
#include "tests/temporary_folder.h"

namespace fs = std::filesystem;
using namespace homolog;

namespace {

mode_t rights(const fs::path& path) {
  struct stat now {};
  REQUIRE(::lstat(path.c_str(), &now) == 0);
  return now.st_mode & 07777;
}

constexpr const char *own_list = "system.posix_acl_access", *handed_on_list = "system.posix_acl_default";

/// An access list as Linux keeps it [acl(5)]: user 1 and the owner may read and write, the group and others nothing.
std::string access_list() {
  const auto entry = [](std::uint32_t tag, std::uint32_t rights, std::uint32_t id) {
    return little_endian(tag, 2) + little_endian(rights, 2) + little_endian(id, 4);
  };
  constexpr std::uint32_t nobody = 0xffffffff;
  return little_endian(2, 4) + entry(1, 6, nobody) + entry(2, 6, 1) + entry(4, 0, nobody) + entry(16, 6, nobody) +
         entry(32, 0, nobody);
}

bool put_list(const fs::path& path, const char* name) {
  const std::string list = access_list();
  return ::setxattr(path.c_str(), name, list.data(), list.size(), 0) == 0;
}

std::string list_of(const fs::path& path, const char* name) {
  std::string list(1024, '\0');
  const ssize_t size = ::getxattr(path.c_str(), name, list.data(), list.size());
  return list.substr(0, size < 0 ? 0 : static_cast<std::size_t>(size));
}

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

}  // namespace

TEST_CASE("a file is replaced only when the new one is whole") {
  TemporaryFolder folder;
  const fs::path file = folder.path / "a.txt";
  REQUIRE(write_whole_file(file, [](std::ostream& out) -> Result<void> {
    out << "first";
    return {};
  }));
  CHECK(!write_whole_file(file, [](std::ostream& out) -> Result<void> {
    out << "half";
    return fail("a.txt", "broke");
  }));
  CHECK(read_whole_file(file).value() == "first");
  CHECK(entries(folder.path) == 1);
}

TEST_CASE("a link stays one and what it leads to is replaced") {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path / "far");
  std::ofstream(folder.path / "far/file.txt") << "before";
  std::filesystem::create_symlink("far/file.txt", folder.path / "link.txt");
  const auto write = [](std::ostream& out) {
    out << "after";
    return Result<void>();
  };
  REQUIRE(write_whole_file(folder.path / "link.txt", write));
  CHECK(std::filesystem::is_symlink(folder.path / "link.txt"));
  CHECK(read_whole_file(folder.path / "far/file.txt").value() == "after");
}

TEST_CASE("a full disk is named and leaves the old file and nothing else") {
  const TemporaryFolder folder;
  const fs::path file = folder.path / "a.txt";
  REQUIRE(write_whole_file(file, "first"));
  Result<void> written;
  {
    const SmallFilesOnly full(4096);
    written = write_whole_file(file, std::string(100000, 'x'));
  }
  CHECK(says(written, "a.txt: cannot be written"));
  CHECK(says(written, "free some space"));
  CHECK(read_whole_file(file).value() == "first");
  CHECK(entries(folder.path) == 1);
}

TEST_CASE("a private file stays private and one for the user alone begins so") {
  const TemporaryFolder folder;
  const fs::path file = folder.path / "patient.txt", other = folder.path / "usual.txt";
  REQUIRE(write_whole_file(file, "first", Readers::user_alone));
  CHECK(rights(file) == 0600);
  REQUIRE(write_whole_file(file, [&](std::ostream& out) {
    out << "second";
    for (const auto& entry : fs::directory_iterator(folder.path)) CHECK(rights(entry.path()) == 0600);
    return Result<void>();
  }));
  CHECK(rights(file) == 0600);
  REQUIRE(write_whole_file(other, "first"));
  const mode_t mask = ::umask(0);
  ::umask(mask);
  CHECK(rights(other) == (0666 & ~mask));
  REQUIRE(::chmod(other.c_str(), 0640) == 0);
  REQUIRE(write_whole_file(other, "second"));
  CHECK(rights(other) == 0640);
  REQUIRE(make_folder(folder.path / "state/homolog", Readers::user_alone));
  CHECK(rights(folder.path / "state") == 0700);
  CHECK(rights(folder.path / "state/homolog") == 0700);
}

TEST_CASE("a file's access list is handed on and its group gets no more than before") {
  const TemporaryFolder folder;
  const fs::path listed = folder.path / "listed.txt", plain = folder.path / "plain.txt";
  write_bytes(listed, "first");
  write_bytes(plain, "first");
  REQUIRE(::chmod(plain.c_str(), 0640) == 0);
  if (!put_list(listed, own_list) || !put_list(folder.path, handed_on_list)) {
    MESSAGE("not tested: ", folder.path.string(), " keeps no access lists");
    return;
  }
  REQUIRE(rights(listed) == 0660);  // the group's bits are the list's mask
  for (const fs::path& path : {listed, plain}) REQUIRE(write_whole_file(path, "second"));
  CHECK(list_of(listed, own_list) == access_list());
  CHECK(rights(listed) == 0660);
  CHECK(list_of(plain, own_list).empty());  // the folder's is for new files
  CHECK(rights(plain) == 0640);
}

TEST_CASE("devices and pipes are neither replaced nor waited for") {
  const TemporaryFolder folder;
  const fs::path pipe = folder.path / "pipe", device = folder.path / "device";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  fs::create_symlink("/dev/zero", device);
  for (const fs::path& path : {pipe, device}) {
    CHECK(says(write_whole_file(path, "x"), "device or a pipe"));
    CHECK(says(read_whole_file(path), "device or a pipe"));
    CHECK(says(size_of_file(path), "device or a pipe"));
  }
  CHECK(fs::is_fifo(pipe));
  CHECK(fs::is_character_file(device));
  CHECK(entries(folder.path) == 2);
}

TEST_CASE("a name as long as names may be can be written") {
  const TemporaryFolder folder;
  const fs::path longest = folder.path / std::string(255, 'n');
  REQUIRE(write_whole_file(longest, "content"));
  CHECK(read_whole_file(longest).value() == "content");
  CHECK(says(write_whole_file(folder.path / std::string(256, 'n'), "content"), "shorter name"));
  CHECK(entries(folder.path) == 1);
}

TEST_CASE("two writers of one file do not meet") {
  const TemporaryFolder folder;
  const fs::path file = folder.path / "a.txt";
  REQUIRE(write_whole_file(file, [&](std::ostream& out) {
    out << "the outer one, ";
    CHECK(write_whole_file(file, "the inner one"));
    out << "whole";
    return Result<void>();
  }));
  CHECK(read_whole_file(file).value() == "the outer one, whole");
  CHECK(entries(folder.path) == 1);
}

TEST_CASE("nobody can lay a link where the temporary file will be") {
  const TemporaryFolder folder;
  const fs::path file = folder.path / "a.txt", victim = folder.path / "victim.txt";
  REQUIRE(write_whole_file(victim, "untouched"));
  fs::create_symlink(victim, folder.path / (".tmp" + std::to_string(::getpid()) + "-a.txt"));
  std::set<std::string> names;
  for (int k = 0; k < 3; ++k)
    REQUIRE(write_whole_file(file, [&](std::ostream&) {
      for (const auto& entry : fs::directory_iterator(folder.path)) names.insert(entry.path().filename().string());
      return Result<void>();
    }));
  CHECK(names.size() == 6);  // the link, the victim, the file, and each time another temporary one
  CHECK(read_whole_file(victim).value() == "untouched");
}

TEST_CASE("what a killed program left is swept when it is surely stale") {
  const TemporaryFolder folder;
  const auto left = [&](const std::string& name, int hours_ago) {
    write_bytes(folder.path / name, "half");
    fs::last_write_time(folder.path / name, fs::file_time_type::clock::now() - std::chrono::hours(hours_ago));
    return folder.path / name;
  };
  const fs::path stale = left(".homolog-0123456789abcdef.tmp", 30), young = left(".homolog-0123456789abcde0.tmp", 1),
                 in_work = left(".homolog-0123456789abcde1.tmp", 30), foreign = left(".homolog-notes.tmp", 30),
                 linked = left(".homolog-0123456789abcde2.tmp", 30);
  fs::create_hard_link(linked, folder.path / "kept.txt");
  const int writer = ::open(in_work.c_str(), O_RDONLY);
  REQUIRE(::flock(writer, LOCK_EX) == 0);
  REQUIRE(write_whole_file(folder.path / "a.txt", "content"));
  ::close(writer);
  CHECK(!fs::exists(stale));
  for (const fs::path& kept : {young, in_work, foreign, linked}) CHECK_MESSAGE(fs::exists(kept), kept.string());
}

TEST_CASE("unsaved cases are the user's alone and a pipe among them stops nothing") {
  const TemporaryFolder folder;
  const EnvironmentVariable state("XDG_STATE_HOME", folder.path / "state");
  {
    const auto session = create_unsaved_case(new_document("", nullptr, nullptr));
    REQUIRE(session);
    CHECK(rights(unsaved_folder()) == 0700);
    for (const auto& entry : fs::directory_iterator(unsaved_folder())) CHECK(rights(entry.path()) == 0600);
  }
  REQUIRE(::mkfifo((unsaved_folder() / "unsaved-1.homolog").c_str(), 0600) == 0);
  ::alarm(30);  // it would wait for a writer for ever
  for (const UnsavedCase& one : unsaved_cases()) CHECK_FALSE(one.edited);
  CHECK_FALSE(unsaved_case(unsaved_folder() / "unsaved-1.homolog"));
  ::alarm(0);
}

TEST_CASE("a home that is not set is said and nothing is kept elsewhere") {
  constexpr uid_t unknown = 54321;
  if (::geteuid() != 0 || ::getpwuid(unknown) != nullptr) return;  // only root can be a user without a home
  const EnvironmentVariable home("HOME", ""), state("XDG_STATE_HOME", ""), config("XDG_CONFIG_HOME", "");
  REQUIRE(::seteuid(unknown) == 0);
  const fs::path known = home_folder();
  REQUIRE(::seteuid(0) == 0);
  CHECK(known == no_home);
  // Root, who could make folders anywhere.
  const auto folder = make_folder(fs::path(no_home) / ".local/state/homolog");
  CHECK(says(folder, "HOME: is not set"));
  CHECK_FALSE(fs::exists("/.local"));
}

TEST_CASE("a write-protected file is kept and root is told too") {
  const TemporaryFolder folder;
  const fs::path file = folder.path / "atlas.ply";
  write_bytes(file, "the old one");
  fs::create_symlink("atlas.ply", folder.path / "link.ply");
  REQUIRE(::chmod(file.c_str(), 0444) == 0);
  for (const char* name : {"atlas.ply", "link.ply"})
    CHECK(says(write_whole_file(folder.path / name, "new"), "atlas.ply: is write-protected; change its permissions"));
  CHECK(read_whole_file(file).value() == "the old one");
  CHECK(entries(folder.path) == 2);
  REQUIRE(::chmod(file.c_str(), 0644) == 0);
  CHECK(write_whole_file(file, "new"));
}

TEST_CASE("a link that leads nowhere is not replaced") {
  const TemporaryFolder folder;
  fs::create_symlink("absent.ply", folder.path / "dangling.ply");
  fs::create_symlink("loop.ply", folder.path / "loop.ply");
  CHECK(says(write_whole_file(folder.path / "dangling.ply", "x"), "is a link to absent.ply, which does not exist"));
  CHECK(says(write_whole_file(folder.path / "loop.ply", "x"), "is a link that leads back to itself"));
  for (const char* name : {"dangling.ply", "loop.ply"}) CHECK(fs::is_symlink(folder.path / name));
  CHECK(entries(folder.path) == 2);
}

TEST_CASE("a file that belongs to another user does not change hands") {
  if (::geteuid() != 0) {
    MESSAGE("not tested: only root can make a file of another user");
    return;
  }
  const TemporaryFolder folder;
  const fs::path file = folder.path / "shared.ply";
  write_bytes(file, "theirs");
  REQUIRE(::chmod(folder.path.c_str(), 0777) == 0);
  REQUIRE(::chmod(file.c_str(), 0666) == 0);
  REQUIRE(::chown(file.c_str(), 0, 12345) == 0);
  const auto owner = [&] {
    struct stat now {};
    REQUIRE(::stat(file.c_str(), &now) == 0);
    return now.st_uid;
  };
  REQUIRE(::seteuid(65534) == 0);
  const auto refused = write_whole_file(file, "ours");
  REQUIRE(::seteuid(0) == 0);
  CHECK(says(refused, "belongs to another user and to a group that you are not in; choose another name"));
  CHECK(read_whole_file(file).value() == "theirs");
  CHECK(entries(folder.path) == 1);
  REQUIRE(::chown(file.c_str(), 65534, static_cast<gid_t>(-1)) == 0);
  REQUIRE(write_whole_file(file, "by root"));
  CHECK(owner() == 65534);
}

TEST_CASE("a colleague's file in a team's folder is replaced and stays the team's") {
  if (::geteuid() != 0) {
    MESSAGE("not tested: only root can make a file of another user");
    return;
  }
  const TemporaryFolder folder;
  const fs::path file = folder.path / "shared.ply";
  write_bytes(file, "a colleague's");
  constexpr uid_t colleague = 12345, user = 65534;
  constexpr gid_t team = 12346;
  REQUIRE(::chown(folder.path.c_str(), colleague, team) == 0);
  REQUIRE(::chmod(folder.path.c_str(), 02775) == 0);
  REQUIRE(::chown(file.c_str(), colleague, team) == 0);
  REQUIRE(::chmod(file.c_str(), 0664) == 0);
  REQUIRE(::setegid(team) == 0);
  REQUIRE(::seteuid(user) == 0);
  const auto written = write_whole_file(file, "the user's");
  REQUIRE(::seteuid(0) == 0);
  REQUIRE(::setegid(0) == 0);
  CHECK(written);
  CHECK(read_whole_file(file).value() == "the user's");
  struct stat now {};
  REQUIRE(::stat(file.c_str(), &now) == 0);
  CHECK(now.st_gid == team);
  CHECK(rights(file) == 0664);
}

TEST_CASE("a folder for results goes again where nothing was put into it") {
  const TemporaryFolder folder;
  fs::create_directory(folder.path / "old");
  {
    const auto a = ResultFolder::make(folder.path / "new/a"), b = ResultFolder::make(folder.path / "new/b/"),
               old = ResultFolder::make(folder.path / "old");
    REQUIRE((a && b && old));
    write_bytes(folder.path / "new/b/file.txt", "result");
  }
  CHECK_FALSE(fs::exists(folder.path / "new/a"));
  CHECK(fs::exists(folder.path / "new/b/file.txt"));
  CHECK(fs::exists(folder.path / "old"));
  CHECK(says(ResultFolder::make(folder.path / "new/b/file.txt/c"), "cannot be made a folder"));
}

TEST_CASE("what cannot be read is not called absent") {
  const TemporaryFolder folder;
  fs::create_symlink("loop", folder.path / "loop");
  CHECK(says(read_whole_file(folder.path / "loop"), "cannot be read"));
  write_bytes(folder.path / "locked.txt", "x");
  REQUIRE(::chmod((folder.path / "locked.txt").c_str(), 0) == 0);
  const bool root = ::geteuid() == 0;
  REQUIRE(::chmod(folder.path.c_str(), 0755) == 0);
  if (root) REQUIRE(::seteuid(65534) == 0);  // root may read everything
  const auto locked = read_whole_file(folder.path / "locked.txt");
  if (root) REQUIRE(::seteuid(0) == 0);
  CHECK(says(locked, "cannot be read (Permission denied); check its permissions"));
}

TEST_CASE("a message shows no control character and little of what a file says") {
  CHECK(printable("a\x1b[31m b\n\x7f\xc2\x9b"
                  "c\x9b") == "a?[31m b???c?");
  CHECK(printable("Hilus „ü“ µ 脾 \xe9") == "Hilus „ü“ µ 脾 \xe9");
  CHECK(excerpt("short") == "short");
  std::string umlauts;
  for (int k = 0; k < 1000; ++k) umlauts += "ü";
  CHECK(excerpt(umlauts) == umlauts.substr(0, 200) + "…");
  CHECK(excerpt("x" + umlauts) == "x" + umlauts.substr(0, 198) + "…");
  CHECK((Error{"a\nb.ply", "is\x1b wrong"}).sentence() == "a?b.ply: is? wrong");
}

TEST_CASE("a missing file and a folder are refused by name") {
  TemporaryFolder folder;
  CHECK(read_whole_file(folder.path / "absent").error().what.find("does not exist") != std::string::npos);
  CHECK(read_whole_file(folder.path).error().what.find("folder") != std::string::npos);
}
