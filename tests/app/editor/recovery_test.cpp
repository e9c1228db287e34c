#include "app/editor/work/recovery.h"

#include <doctest/doctest.h>

#include <chrono>
#include <cstdlib>
#include <fstream>

#include "tests/temporary_folder.h"

namespace homolog {

namespace fs = std::filesystem;

TEST_CASE("cases to recover are named first and counted then and what holds no edit goes when it is left alone") {
  const TemporaryFolder folder;
  ::setenv("XDG_STATE_HOME", folder.path.c_str(), 1);
  const fs::path state = folder.path / "homolog";
  fs::create_directories(state);
  const std::string header = "{\"homolog\":1,\"volume\":\"../ct.nii.gz\"}\n";
  std::ofstream(state / "edited.homolog")
      << header << "{\"stiffness_base\":5}\n{\"undo\":true}\n{\"stiffness_base\":6}\n";
  std::ofstream(state / "looked.homolog") << header << "{\"frame\":0,\"look\":true}\n";
  std::ofstream(state / "begun.homolog") << header;
  fs::last_write_time(state / "looked.homolog", fs::file_time_type::clock::now() - std::chrono::hours(1));

  Recovery recovery([] {});
  recovery.look();
  recovery.finish();
  auto named = recovery.take();
  REQUIRE(named);
  CHECK_FALSE(named->counted);
  REQUIRE(named->cases.size() == 1);
  CHECK(named->cases[0].name == "ct.nii.gz");
  CHECK(named->cases[0].details.find("edits") == std::string::npos);
  CHECK(recovery.busy());
  recovery.finish();
  const auto counted = recovery.take();
  REQUIRE(counted);
  CHECK(counted->counted);
  CHECK(counted->cases.at(0).details.starts_with("2 edits, "));
  CHECK_FALSE(recovery.busy());

  CHECK(fs::exists(state / "edited.homolog"));
  CHECK_FALSE(fs::exists(state / "looked.homolog"));
  CHECK(fs::exists(state / "begun.homolog"));  // another window may be about to write to it
  remove_without_edits(state / "begun.homolog");
  remove_without_edits(state / "edited.homolog");
  CHECK_FALSE(fs::exists(state / "begun.homolog"));
  CHECK(fs::exists(state / "edited.homolog"));
  ::unsetenv("XDG_STATE_HOME");
}

}  // namespace homolog
