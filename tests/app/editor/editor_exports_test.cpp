#include <doctest/doctest.h>

#include <atomic>
#include <fstream>
#include <new>
#include <thread>

#include "app/editor/work/exports.h"
#include "core/volume/volume_io.h"
#include "tests/temporary_folder.h"
#include "tests/wait.h"

namespace homolog {

TEST_CASE("files are written one after the other and each is told of once") {
  std::atomic<int> woken = 0;
  Exports exports([&] { ++woken; });
  std::vector<int> order;
  for (int i = 0; i < 3; ++i)
    exports.start("file " + std::to_string(i), [&order, i](Progress&) -> Result<void> {
      order.push_back(i);
      if (i == 1) return fail("file 1", "cannot be written");
      return {};
    });
  exports.finish();
  CHECK(order == std::vector<int>{0, 1, 2});
  const auto written = exports.take();
  REQUIRE(written.size() == 3);
  CHECK(written[0].result);
  CHECK(written[1].result.error().sentence() == "file 1: cannot be written");
  CHECK(written[2].path == "file 2");
  CHECK(exports.take().empty());
  CHECK_FALSE(exports.busy());
}

TEST_CASE("a file whose writing fails in any way is told of by name") {
  Exports exports([] {});
  exports.start("/full/a.ply", [](Progress&) -> Result<void> { throw std::bad_alloc(); });
  exports.start("/full/b.ply", [](Progress&) { return Result<void>(); });
  exports.finish();
  const auto written = exports.take();
  REQUIRE(written.size() == 2);
  CHECK(written[0].path == "/full/a.ply");
  CHECK(written[0].result.error().sentence() == "/full/a.ply: needs more memory than there is; close other programs");
  CHECK(written[1].result);
}

TEST_CASE("a file that is being written can be given up and those after it are written") {
  Exports exports([] {});
  const auto until_cancelled = [](Progress& progress) -> Result<void> {
    progress.report(0.5);
    REQUIRE(test::wait_until([&] { return progress.cancelled(); }));
    return fail("first", "was given up");
  };
  exports.start("first", until_cancelled);
  exports.start("second", [](Progress&) { return Result<void>(); });
  REQUIRE(test::wait_until([&] { return exports.running().value().fraction > 0; }));
  CHECK(exports.running()->subject == "first");
  exports.cancel("second");
  exports.cancel("first");
  exports.finish();
  const auto written = exports.take();
  REQUIRE(written.size() == 2);
  CHECK_FALSE(written[0].result);
  CHECK(written[0].cancelled);
  CHECK(written[1].result);
  CHECK_FALSE(written[1].cancelled);
}

TEST_CASE("giving up a file never gives up the one after it") {
  Exports exports([] {});
  for (int k = 0; k < 400; ++k) {
    std::atomic<bool> started = false, ends = false;
    exports.start("first", [&](Progress&) -> Result<void> {
      started = true;
      while (!ends) continue;
      return {};
    });
    exports.start("second", [](Progress&) { return Result<void>(); });
    while (!started) std::this_thread::yield();
    ends = true;
    exports.cancel("first");  // which ends at this moment
    exports.finish();
    for (const auto& written : exports.take())
      if (written.path == "second") REQUIRE_FALSE(written.cancelled);
  }
}

TEST_CASE("what is left to do once a file is written comes back with it") {
  Exports exports([] {});
  int done = 0;
  exports.start(
      "file", [](Progress&) { return Result<void>(); }, [&] { ++done; });
  exports.finish();
  CHECK(done == 0);
  for (const auto& written : exports.take()) written.then();
  CHECK(done == 1);
}

TEST_CASE("closing the window finishes what is being written") {
  std::atomic<bool> closing = false;
  std::atomic<int> written = 0;
  constexpr int files = 200;
  {
    Exports exports([] {});
    for (int k = 0; k < files; ++k)
      exports.start("file " + std::to_string(k), [&](Progress&) -> Result<void> {
        REQUIRE(test::wait_until([&] { return closing.load(); }));
        ++written;
        return {};
      });
    closing = true;
  }
  CHECK(written == files);
}

TEST_CASE("a volume whose writing is cancelled leaves the file as it was") {
  const TemporaryFolder folder;
  Volume volume;
  volume.geometry.dims = {512, 512, 20};  // more than is written at once
  volume.data = std::vector<std::uint8_t>(volume.geometry.voxels(), 1);
  for (const char* name : {"v.nii", "v.nii.gz", "v.nrrd", "v.mha"}) {
    const auto path = folder.path / name;
    std::ofstream(path) << "before";
    Progress progress;
    progress.cancel();
    const auto written = write_volume(volume, path, &progress);
    REQUIRE_FALSE(written);
    CHECK(written.error().sentence() == path.string() + ": was not written: cancelled");
    CHECK(std::filesystem::file_size(path) == 6);
  }
}

}  // namespace homolog
