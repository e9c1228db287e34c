#include "core/base/encoding/json.h"

#include <doctest/doctest.h>

#include "core/mesh/files/landmark_io.h"
#include "core/model/files/statismo.h"
#include "core/model/shapes/study.h"
#include "core/session/case_file.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace fs = std::filesystem;
using namespace homolog;

namespace {

std::string nested(int levels) {
  return std::string(static_cast<std::size_t>(levels), '[') + std::string(static_cast<std::size_t>(levels), ']');
}

std::string object_of(int members) {
  std::string text = "{";
  for (int k = 0; k < members; ++k) text += (k > 0 ? ",\"" : "\"") + std::to_string(k) + "\":0";
  return text + "}";
}

}  // namespace

TEST_CASE("JSON is read to a depth of 64") {
  CHECK(read_json<nlohmann::json>(nested(64)));
  CHECK(says(read_json<nlohmann::json>(nested(65)), "64 levels"));
  CHECK(says(read_json<nlohmann::ordered_json>(nested(100000)), "64 levels"));
  CHECK(says(read_json<nlohmann::json>(std::string(100000, '{')), "64 levels"));
  // Brackets within texts are no levels.
  const auto text = read_json<nlohmann::json>("\"" + nested(100) + "\\\"" + nested(100) + "\"");
  CHECK(text.value().get<std::string>().size() == 401);
  CHECK(says(read_json<nlohmann::json>("[1,2"), "no valid JSON"));
  CHECK(says(read_json<nlohmann::json>("]]]]"), "no valid JSON"));
  CHECK(says(read_json<nlohmann::json>(""), "no valid JSON"));
}

TEST_CASE("objects whose members are searched one after the other have a bound") {
  CHECK(read_json<nlohmann::ordered_json>(object_of(1000)));
  CHECK(says(read_json<nlohmann::ordered_json>(object_of(1001)), "1000 members"));
  CHECK(read_json<nlohmann::json>(object_of(5000)));
}

TEST_CASE("a hundred thousand brackets are refused wherever JSON is read") {
  const TemporaryFolder folder;
  const std::string deep = nested(100000);
  const auto file = [&](const std::string& name, const std::string& text) {
    write_bytes(folder.path / name, text);
    return folder.path / name;
  };
  const std::string header = R"({"homolog":1,"template":"built-in:kidney"})";
  CHECK(says(read_case(file("a.homolog", R"({"homolog":)" + deep + "}\n")), "no header"));
  CHECK(says(read_case(file("b.homolog", header + "\n{\"frame\":" + deep + "}\n{\"note\":\"x\"}\n")), "line 2"));
  CHECK(
      says(read_case(file("c.homolog", header + "\n{\"scheme\":\"raw\",\"events\":" + deep + "}\n{\"note\":\"x\"}\n")),
           "line 2"));
  CHECK(says(read_study(file("a.study.json", R"({"homolog_study":1,"cases":[],"x":)" + deep + "}")), "64 levels"));
  CHECK(says(read_study(file("b.study.json", R"({"homolog_study":1,"cases":[{"file":"s.ply","x":)" + deep + "}]}")),
             "64 levels"));
  CHECK(says(read_study(file("c.study.json", R"({"homolog_study":1,"cases":)" + deep + "}")), "64 levels"));
  CHECK(says(read_landmarks(file("a.mrk.json", R"({"markups":[{"coordinateUnits":)" + deep + "}]}")), "64 levels"));
  CHECK(says(read_model(file("a.h5.json", R"({"root":"a","groups":{},"datasets":{"d":{"shape":)" + deep + "}}}")),
             "64 levels"));
  const auto mesh = read_mesh_file(
      file("a.ply", "ply\nformat ascii 1.0\ncomment homolog.landmark {\"name\":" + deep +
                        "}\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face "
                        "1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
  REQUIRE(mesh);
  REQUIRE(mesh->warnings.size() == 1);
  CHECK(mesh->warnings.front().size() < 300);
}

TEST_CASE("a key that an object has twice is found and one of two objects is none") {
  CHECK(doubled_key(R"({"a": 1, "b": {"c": 1, "d": [{"c": 2}, {"e": 1, "e": 2}]}, "b": 3})") == "e");
  CHECK(doubled_key(R"({"a": 1, "b": 2, "a": {"x": 1}})") == "a");
  CHECK_FALSE(doubled_key(R"([{"a": 1}, {"a": 2, "b": {"a": 3}}])").has_value());
  CHECK_FALSE(doubled_key("3").has_value());
}
