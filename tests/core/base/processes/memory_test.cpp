#include "core/base/processes/memory.h"

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "tests/temporary_folder.h"

namespace fs = std::filesystem;
using namespace homolog;

namespace {

void save(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  write_bytes(path, text);
}

}  // namespace

TEST_CASE("memory is told in millions of bytes") {
  double all_pages = 0, resident_pages = 0;
  std::ifstream("/proc/self/statm") >> all_pages >> resident_pages;
  const double resident_mb = resident_pages * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1e6;
  CHECK(resident_memory_mb() == doctest::Approx(resident_mb).epsilon(0.015));
  CHECK(peak_memory_mb() >= 0.985 * resident_mb);
}

TEST_CASE("a control group of version 2 leaves its limit less what it uses") {
  const TemporaryFolder folder;
  const fs::path group = folder.path / "user.slice/session";
  save(group / "memory.max", "1000000\n");
  save(group / "memory.current", "400000\n");
  CHECK(control_group_room_bytes("0::/user.slice/session\n", folder.path) == 600000);
  save(group / "memory.stat", "anon 5\ninactive_file 150000\nactive_file 7\n");  // cached files give way
  CHECK(control_group_room_bytes("0::/user.slice/session\n", folder.path) == 750000);
  save(group / "memory.current", "2000000\n");
  CHECK(control_group_room_bytes("0::/user.slice/session\n", folder.path) == 0);
  save(group / "memory.max", "max\n");
  CHECK(std::isinf(control_group_room_bytes("0::/user.slice/session\n", folder.path)));
}

TEST_CASE("the groups around a control group limit it too") {
  const TemporaryFolder folder;
  save(folder.path / "outer/inner/memory.max", "1000000");
  save(folder.path / "outer/inner/memory.current", "0");
  save(folder.path / "outer/memory.max", "900000");
  save(folder.path / "outer/memory.current", "600000");
  CHECK(control_group_room_bytes("0::/outer/inner\n", folder.path) == 300000);
}

TEST_CASE("a control group of version 1 is found among the controllers") {
  const TemporaryFolder folder;
  save(folder.path / "memory/job/memory.limit_in_bytes", "5000000");
  save(folder.path / "memory/job/memory.usage_in_bytes", "1000000");
  save(folder.path / "memory/job/memory.stat", "cache 9\ntotal_inactive_file 500000\n");
  const std::string membership = "8:pids:/job\n4:memory:/job\n1:name=systemd:/\n0::/\n";
  CHECK(control_group_room_bytes(membership, folder.path) == 4500000);
}

TEST_CASE("in a container whose group bears another name outside the limit at the root counts") {
  const TemporaryFolder folder;
  save(folder.path / "memory.max", "2000000");
  save(folder.path / "memory.current", "500000");
  CHECK(control_group_room_bytes("0::/kubepods/pod7/c1\n", folder.path) == 1500000);
  CHECK(control_group_room_bytes("0::/../../other\n", folder.path) == 1500000);
}

TEST_CASE("what a process may take at most counts") {
  rlimit before{};
  REQUIRE(::getrlimit(RLIMIT_DATA, &before) == 0);
  if (before.rlim_cur == RLIM_INFINITY) CHECK(process_room_bytes() > 1e12);
  rlimit small = before;
  small.rlim_cur = 1;  // of data that is there nothing is taken back
  REQUIRE(::setrlimit(RLIMIT_DATA, &small) == 0);
  const double room = process_room_bytes(), available = available_memory_bytes();
  REQUIRE(::setrlimit(RLIMIT_DATA, &before) == 0);
  CHECK(room == 0);
  CHECK(available == 0);
}

TEST_CASE("without control groups the machine's free memory is what there is") {
  const TemporaryFolder folder;
  CHECK(std::isinf(control_group_room_bytes("", folder.path)));
  CHECK(std::isinf(control_group_room_bytes("damaged\n4:memory\n", folder.path)));
  CHECK(available_memory_bytes() > 0);
  CHECK(!check_memory("v.nii", 1e18));
  CHECK(check_memory("v.nii", 1));
}
