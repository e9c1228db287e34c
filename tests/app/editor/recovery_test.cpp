#include "app/editor/work/opening/recovery.h"

#include <doctest/doctest.h>

#include <chrono>
#include <fstream>

#include "tests/environment_variable.h"
#include "tests/must.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace homolog {

namespace fs = std::filesystem;

TEST_CASE("cases to recover are named first and counted then and what holds no edit goes when it is left alone") {
  const TemporaryFolder folder;
  const EnvironmentVariable state_home("XDG_STATE_HOME", folder.path);
  const fs::path state = folder.path / "homolog";
  fs::create_directories(state);
  const std::string header = "{\"homolog\":1,\"volume\":\"../ct.nii.gz\"}\n";
  std::ofstream(state / "edited.homolog")
      << header << "{\"stiffness_base\":5}\n{\"undo\":true}\n{\"stiffness_base\":6}\n"
      << "{\"stiffness_base\":7,\"joined\":true}\n{\"stiffness_base\":8,\"joined\":true}\n";
  std::ofstream(state / "looked.homolog") << header << "{\"frame\":0,\"look\":true}\n";
  std::ofstream(state / "begun.homolog") << header;
  fs::last_write_time(state / "looked.homolog", fs::file_time_type::clock::now() - std::chrono::hours(1));

  Recovery recovery([] {});
  recovery.look();
  recovery.finish();
  auto named = test::must(recovery.take().value());
  CHECK_FALSE(named.counted);
  REQUIRE(named.cases.size() == 1);
  CHECK(named.cases[0].name == "ct.nii.gz");
  CHECK(named.cases[0].details.find("edits") == std::string::npos);
  CHECK_FALSE(recovery.busy());  // nobody looks at the figures yet
  recovery.count(named);
  recovery.finish();
  const auto counted = test::must(recovery.take().value());
  CHECK(counted.counted);
  CHECK(counted.cases.at(0).details.starts_with("1 edit, "));
  CHECK_FALSE(recovery.take());

  CHECK(fs::exists(state / "edited.homolog"));
  CHECK_FALSE(fs::exists(state / "looked.homolog"));
  CHECK(fs::exists(state / "begun.homolog"));  // another window may be about to write to it
  remove_without_edits(state / "begun.homolog");
  remove_without_edits(state / "edited.homolog");
  CHECK_FALSE(fs::exists(state / "begun.homolog"));
  CHECK(fs::exists(state / "edited.homolog"));
}

TEST_CASE("where the folder of unsaved cases cannot be read that is said") {
  const TemporaryFolder folder;
  const EnvironmentVariable state("XDG_STATE_HOME", folder.path);
  const auto found = [] {
    Recovery recovery([] {});
    recovery.look();
    recovery.finish();
    return recovery.take().value();
  };
  CHECK(test::must(found()).cases.empty());  // there is no folder yet
  write_bytes(folder.path / "homolog", "a file in its place");
  CHECK(says(found(), (folder.path / "homolog").string() + ": the folder of unsaved cases cannot be read"));
}

}  // namespace homolog
