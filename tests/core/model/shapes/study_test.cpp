#include "core/model/shapes/study.h"

#include <doctest/doctest.h>

#include <chrono>
#include <fstream>

#include "core/base/files/files.h"
#include "tests/temporary_folder.h"

namespace fs = std::filesystem;
using namespace homolog;

namespace {

void touch(const fs::path& path) {
  fs::create_directories(path.parent_path());
  std::ofstream(path) << "x";
}

/// A study in folder/s of three cases, all files there.
fs::path some_study(const TemporaryFolder& folder) {
  for (const char* name : {"t.ply", "a/a.homolog", "b/b.homolog", "meshes/c.ply"}) touch(folder.path / "s" / name);
  const fs::path path = folder.path / "s/kidneys.study.json";
  Study study;
  study.template_file = folder.path / "s/t.ply";
  study.cases = {{"Anna", folder.path / "s/a/a.homolog", 0, "healthy", CaseState::done, "good, \"clear\""},
                 {"Bert", folder.path / "s/b/b.homolog", 7, "ill", CaseState::in_work},
                 {"Nière", folder.path / "s/meshes/c.ply", 0, "healthy"}};
  REQUIRE(write_study(study, path));
  return path;
}

void check_refused(const TemporaryFolder& folder, const std::string& text, const std::string& what) {
  const fs::path path = folder.path / "bad.study.json";
  std::ofstream(path) << text;
  const auto read = read_study(path);
  REQUIRE(!read);
  INFO(read.error().sentence());
  CHECK(read.error().sentence().find("bad.study.json") != std::string::npos);
  CHECK(read.error().what.find(what) != std::string::npos);
}

}  // namespace

TEST_CASE("a study reads back as it was written and is readable text") {
  const TemporaryFolder folder;
  const fs::path path = some_study(folder);
  const StudyRead read = read_study(path).value();
  CHECK(read.warnings.empty());
  const Study& study = read.study;
  CHECK(study.template_file == folder.path / "s/t.ply");
  REQUIRE(study.cases.size() == 3);
  CHECK(study.cases[0].notes == "good, \"clear\"");
  CHECK(study.cases[0].state == CaseState::done);
  CHECK(study.cases[1].frame == 7);
  CHECK(study.cases[1].file == folder.path / "s/b/b.homolog");
  CHECK(study.cases[2].name == "Nière");
  CHECK(study.cases[2].state == CaseState::to_do);
  CHECK(study.groups() == std::vector<std::string>{"healthy", "ill"});
  const std::string text = read_whole_file(path).value();
  CHECK(text.find("\"file\": \"meshes/c.ply\"") != std::string::npos);
  CHECK(text.find(folder.path.string()) == std::string::npos);
}

TEST_CASE("a study keeps what its worklist knows and goes to cases in doubt first") {
  const TemporaryFolder folder;
  const fs::path path = some_study(folder);
  Study study = read_study(path).value().study;
  StudyCase waiting{"Cleo", folder.path / "s/a/a.homolog"};
  waiting.from_scan = true;
  waiting.labels = folder.path / "s/maps/c.nii";
  study.cases.push_back(waiting);
  StudyCase doubtful = waiting;
  doubtful.name = "Dora";
  doubtful.state = CaseState::in_work;
  doubtful.doubt = "Only 80 % of the label is met.";
  doubtful.seconds = 61.25;
  doubtful.gestures = 14;
  study.cases.push_back(doubtful);
  REQUIRE(write_study(study, path));
  const Study again = read_study(path).value().study;
  CHECK(again.cases[3].waits());
  CHECK(again.cases[3].labels == waiting.labels);
  CHECK_FALSE(again.cases[4].waits());
  CHECK(again.cases[4].doubt == doubtful.doubt);
  CHECK(again.cases[4].gestures == 14);
  CHECK(again.cases[4].seconds == doctest::Approx(61.3));
  CHECK(again.next_case() == 4);
  CHECK(again.next_case(4) == 1);
  CHECK(read_whole_file(path).value().find("\"labels\": \"maps/c.nii\"") != std::string::npos);
}

TEST_CASE("a study that would name a file wrongly is not written") {
  const TemporaryFolder folder;
  const fs::path path = some_study(folder), odd = folder.path / "s" / "caf\xe9.homolog";
  const std::string before = read_whole_file(path).value();
  Study study = read_study(path).value().study;
  study.cases.push_back({"odd", odd});
  const auto written = write_study(study, path);
  REQUIRE_FALSE(written);
  CHECK(written.error().sentence().find("the name of " + odd.string() + " is no UTF-8") != std::string::npos);
  CHECK(read_whole_file(path).value() == before);
}

TEST_CASE("a study that was moved as a whole finds its cases again") {
  const TemporaryFolder folder;
  some_study(folder);
  fs::rename(folder.path / "s", folder.path / "elsewhere");
  const StudyRead read = read_study(folder.path / "elsewhere/kidneys.study.json").value();
  CHECK(read.warnings.empty());
  CHECK(read.study.cases[0].file == folder.path / "elsewhere/a/a.homolog");
}

TEST_CASE("a half deleted or moved study says what is missing and the rest goes on") {
  const TemporaryFolder folder;
  const fs::path path = some_study(folder);
  fs::remove_all(folder.path / "s/b");
  const StudyRead half = read_study(path).value();
  REQUIRE(half.warnings.size() == 1);
  CHECK(half.warnings[0].find("Bert") != std::string::npos);
  CHECK(half.study.cases.size() == 3);
  fs::rename(path, folder.path / "kidneys.study.json");
  const StudyRead alone = read_study(folder.path / "kidneys.study.json").value();
  REQUIRE(alone.warnings.size() == 2);
  CHECK(alone.warnings[0].find("none of its 3 cases") != std::string::npos);
  CHECK(alone.warnings[1].find("template") != std::string::npos);
}

TEST_CASE("fields that are not known are kept where they stood") {
  const TemporaryFolder folder;
  const fs::path path = folder.path / "s.study.json";
  touch(folder.path / "a.ply");
  std::ofstream(path) << R"({"homolog_study": 1, "ethics": {"number": 12}, "template": "built-in:kidney",
    "cases": [{"file": "a.ply", "age": 61, "side": "left"}]})";
  const StudyRead read = read_study(path).value();
  CHECK(read.warnings.empty());
  CHECK(read.study.cases[0].name == "a");
  CHECK(read.study.template_file == "built-in:kidney");
  REQUIRE(write_study(read.study, path));
  const auto json = nlohmann::json::parse(read_whole_file(path).value());
  CHECK(json["ethics"]["number"] == 12);
  CHECK(json["template"] == "built-in:kidney");
  CHECK(json["cases"][0]["age"] == 61);
  CHECK(json["cases"][0]["side"] == "left");
}

TEST_CASE("the label and the covariates of a case are written as they were read") {
  const TemporaryFolder folder;
  const fs::path path = folder.path / "s.study.json";
  touch(folder.path / "a.ply");
  std::ofstream(path) << R"({"homolog_study": 1, "cases": [
    {"file": "a.ply", "age": 61, "label": "left kidney", "covariates": {"sex": "f", "mass": 71.5}},
    {"name": "b", "file": "a.ply", "label": [1, 2], "covariates": "none"},
    {"name": "c", "file": "a.ply", "label": null, "covariates": {}}]})";
  Study study = read_study(path).value().study;
  CHECK(study.cases[0].label == "left kidney");
  CHECK(study.cases[0].covariates == nlohmann::ordered_json{{"sex", "f"}, {"mass", 71.5}});
  CHECK(study.cases[0].other == nlohmann::ordered_json{{"age", 61}});
  for (const std::size_t odd : {1U, 2U}) {  // what is of another kind is kept, and nothing is known by it
    CHECK(study.cases[odd].label.is_null());
    CHECK(study.cases[odd].covariates.empty());
    CHECK(study.cases[odd].other.size() == 2);
  }
  REQUIRE(write_study(study, path));
  const auto json = nlohmann::ordered_json::parse(read_whole_file(path).value());
  const auto& first = json["cases"][0];
  std::vector<std::string> keys;
  for (const auto& [key, value] : first.items()) keys.push_back(key);
  CHECK(keys == std::vector<std::string>{"name", "file", "state", "label", "covariates", "age"});
  CHECK(first["covariates"].dump() == R"({"sex":"f","mass":71.5})");
  CHECK(json["cases"][1]["label"] == nlohmann::ordered_json{1, 2});
  CHECK(json["cases"][1]["covariates"] == "none");
  CHECK(json["cases"][2]["label"].is_null());
  CHECK(json["cases"][2]["covariates"].empty());
  CHECK(read_study(path).value().study == study);
}

TEST_CASE("the next case is the next one that is not done") {
  const TemporaryFolder folder;
  Study study = read_study(some_study(folder)).value().study;
  CHECK(study.next_case() == 1);
  CHECK(study.next_case(1) == 2);
  CHECK(study.next_case(2) == 1);
  for (StudyCase& one : study.cases) one.state = CaseState::done;
  CHECK(study.next_case() == -1);
  CHECK(Study().next_case() == -1);
}

TEST_CASE("a file that is no study is refused with the fault named") {
  const TemporaryFolder folder;
  check_refused(folder, "", "no valid JSON");
  check_refused(folder, "{", "no valid JSON");
  check_refused(folder, "{}", "no study");
  check_refused(folder, "[]", "no study");
  check_refused(folder, R"({"homolog_study":2})", "newer");
  check_refused(folder, R"({"homolog_study":0})", "study version 0");
  check_refused(folder, R"({"homolog_study":-1})", "study version -1");
  check_refused(folder, R"({"homolog_study":1,"cases":3})", "no list");
  check_refused(folder, R"({"homolog_study":1,"cases":[3]})", "case 1");
  check_refused(folder, R"({"homolog_study":1,"cases":[{"name":"a"}]})", "no \"file\"");
  check_refused(folder, R"({"homolog_study":1,"cases":[{"file":"a.ply","state":"half"}]})", "half");
  check_refused(folder, R"({"homolog_study":1,"cases":[{"file":"a.ply","frame":-1}]})", "frame");
  check_refused(folder, R"({"homolog_study":1,"cases":[{"file":"a.ply"},{"file":"b/a.ply"}]})", "two cases");
  CHECK(!read_study(folder.path / "absent.study.json"));
}

TEST_CASE("a study that cannot be written leaves the old one whole") {
  const TemporaryFolder folder;
  const fs::path path = some_study(folder);
  CHECK(!write_study(Study(), folder.path / "nowhere/x.study.json"));
  CHECK(!fs::exists(folder.path / "nowhere"));
  CHECK(read_study(path)->study.cases.size() == 3);
}

TEST_CASE("a study that is the same is not written again") {
  const TemporaryFolder folder;
  const fs::path path = some_study(folder);
  Study study = read_study(path)->study;
  const auto long_ago = fs::last_write_time(path) - std::chrono::hours(1);
  fs::last_write_time(path, long_ago);
  CHECK(write_study(study, path));
  CHECK(fs::last_write_time(path) == long_ago);
  study.cases[1].group = "sick";
  CHECK(write_study(study, path));
  CHECK(fs::last_write_time(path) != long_ago);
  CHECK(read_study(path)->study.cases[1].group == "sick");
}

TEST_CASE("cases are found by their names") {
  const TemporaryFolder folder;
  const Study study = read_study(some_study(folder))->study;
  const CasesByName by_name(study);
  CHECK(by_name.find("Bert") == &study.cases[1]);
  CHECK(by_name.find("bert") == nullptr);
}
