#include "core/base/files.h"

#include <doctest/doctest.h>

#include <filesystem>
#include <iterator>

#include "tests/temporary_folder.h"

namespace fs = std::filesystem;
using namespace homolog;

namespace {

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

TEST_CASE("a full disk is named and leaves nothing behind") {
  if (!fs::exists("/dev/full")) return;
  const auto written = write_whole_file("/dev/full/x", [](std::ostream&) -> Result<void> { return {}; });
  REQUIRE(!written);
  CHECK(written.error().subject == "/dev/full/x");
}

TEST_CASE("a missing file and a folder are refused by name") {
  TemporaryFolder folder;
  CHECK(read_whole_file(folder.path / "absent").error().what.find("does not exist") != std::string::npos);
  CHECK(read_whole_file(folder.path).error().what.find("folder") != std::string::npos);
}
