#include "core/deform/stroke_kinds.h"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "core/base/encoding/json.h"
#include "core/base/files/files.h"
#include "tests/must.h"

namespace homolog {

TEST_CASE("the schema of a stroke names the tools in their order") {
  const std::string text =
      test::must(read_whole_file(std::string(HOMOLOG_SOURCE_DIR) + "/docs/schemas/case-line.schema.json"));
  const nlohmann::json schema = nlohmann::json::parse(text);
  std::vector<std::string> names;
  for (const StrokeKind& kind : stroke_kinds) names.emplace_back(kind.name);
  CHECK(schema.at("$defs").at("stroke").at("properties").at("tool").at("enum").get<std::vector<std::string>>() ==
        names);
}

TEST_CASE("each tool of strokes is found by its value") {
  for (const StrokeKind& kind : stroke_kinds) CHECK(&kind_of_stroke(kind.tool) == &kind);
  CHECK(kind_of_stroke(Tool::relax).is_dab());
  CHECK_FALSE(kind_of_stroke(Tool::grab).is_dab());
}

}  // namespace homolog
