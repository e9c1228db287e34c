#include "core/structures/template_set.h"

#include <doctest/doctest.h>

#include "core/base/files/files.h"
#include "core/mesh/construction/icosphere.h"
#include "tests/must.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace homolog {

namespace {

namespace fs = std::filesystem;

TemplateOfSet named(const std::string& name) {
  TemplateOfSet one;
  one.name = name;
  one.file = "built-in:kidney";
  return one;
}

Mesh ball_at(double x_mm) {
  Mesh ball = icosphere(3, 10);
  ball.points.col(0).array() += x_mm;
  return ball;
}

}  // namespace

TEST_CASE("partners are found in the set and neighbours by their distance") {
  TemplateSet set;
  for (const char* name : {"kidney_left", "Kidney_Right", "liver", "lung_left"}) set.structures.push_back(named(name));
  find_partners(set);
  CHECK(set.structures[0].partner == "Kidney_Right");
  CHECK(set.structures[1].partner == "kidney_left");
  CHECK(set.structures[3].side == Side::left);
  CHECK(set.structures[3].partner.empty());
  // Balls of 10 mm: 1 mm, 3 mm and 40 mm apart.
  find_neighbours(set, {ball_at(0), ball_at(21), ball_at(44), ball_at(104)}, 5);
  CHECK(set.structures[0].neighbours == std::vector<std::string>{"Kidney_Right"});
  CHECK(set.structures[1].neighbours == std::vector<std::string>{"kidney_left", "liver"});
  CHECK(set.structures[3].neighbours.empty());
}

TEST_CASE("a set reads back as it was written and keeps what it does not know") {
  const TemporaryFolder folder;
  const fs::path path = folder.path / "trunk.set.json";
  TemplateSet set;
  set.structures = {named("Leber, groß"), named("kidney_left")};
  TemplateOfSet& one = set.structures[1];
  one.value = 7;
  one.layer = 2;
  one.colour = {{1, 2, 3}};
  one.file = folder.path / "trunk" / "kidney_left.ply";
  one.side = Side::left;
  one.partner = "kidney_right";
  one.neighbours = {"liver", "spleen"};
  one.other["weight"] = 3;
  set.other["made_by"] = "anna";
  REQUIRE(write_template_set(set, path));
  CHECK(read_whole_file(path).value().find("\"trunk/kidney_left.ply\"") != std::string::npos);
  const TemplateSet read = test::must(read_template_set(path));
  REQUIRE(read.structures.size() == 2);
  CHECK(read.other == set.other);
  CHECK(read.find("LEBER, groß") == &read.structures[0]);
  const TemplateOfSet& again = read.structures[1];
  CHECK(again.value == 7);
  CHECK(again.layer == 2);
  CHECK(again.colour == one.colour);
  CHECK(again.file == one.file);
  CHECK(again.side == Side::left);
  CHECK(again.partner == one.partner);
  CHECK(again.neighbours == one.neighbours);
  CHECK(again.other == one.other);
}

TEST_CASE("what is no set is refused with what to do") {
  const TemporaryFolder folder;
  const fs::path path = folder.path / "a.set.json";
  const auto refused = [&](const std::string& text, const std::string& says_so) {
    REQUIRE(write_whole_file(path, text));
    CHECK(says(read_template_set(path), says_so));
  };
  CHECK(says(read_template_set(path), "does not exist"));
  refused("[1, 2", "take its last good copy");
  refused("{}", "homolog_set");
  refused(R"({"homolog_set":2})", "newer version");
  refused(R"({"homolog_set":0})", "set version 0");
  refused(R"({"homolog_set":-1})", "set version -1");
  const auto posed = [](const std::string& pose) {
    return R"({"homolog_set":1,"structures":[{"name":"a","template":"a.ply","pose":{)" + pose + "}}]}";
  };
  const std::string turned = R"(,"turn_deg":[0,0,0])";
  refused(posed(R"("subjects":1,"offset_mm":[0,0,0],"turn_deg":[0,0])"), "structure 1 (a) has a \"pose\"");
  refused(posed(R"("subjects":1,"offset_mm":[0,"x",0])" + turned), "has a \"pose\"");
  refused(posed(R"("subjects":1,"offset_mm":[0,1e10,0])" + turned), "has a \"pose\"");
  refused(posed(R"("offset_mm":[0,0,0])" + turned), "has a \"pose\"");
  refused(R"({"homolog_set":1})", "homolog set make");
  refused(R"({"homolog_set":1,"structures":[{"name":"a"}]})", "\"template\"");
  refused(R"({"homolog_set":1,"structures":[{"name":"a","template":"a.ply"},{"name":"A","template":"b.ply"}]})",
          "rename one");
  const auto one = [](const std::string& more) {
    return R"({"homolog_set":1,"structures":[{"name":"a","template":"a.ply",)" + more + "}]}";
  };
  refused(one(R"("value":4294967300)"), "no label can have");
  refused(one(R"("value":"4")"), "no label can have");
  refused(one(R"("value":-1)"), "no label can have");
  refused(one(R"("side":"Left")"), "\"left\" and \"right\"");
  refused(one(R"("colour":"blue")"), "#60a5d6");
  const std::string twice =
      R"({"homolog_set":1,"structures":[{"name":"a","template":"a.ply","value":4},{"name":"b","template":"b.ply","value":4)";
  refused(twice + "}]}", "a and b the value 4");
  REQUIRE(write_whole_file(path, twice + ",\"layer\":1}]}"));
  CHECK(read_template_set(path));
}

}  // namespace homolog
