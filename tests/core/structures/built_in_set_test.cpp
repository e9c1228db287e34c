#include "core/structures/built_in_set.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "core/catalogue/catalogue.h"
#include "tests/must.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace homolog {

TEST_CASE("the built-in set has a template for each structure and knows what touches it") {
  const BuiltInSet spine = test::must(built_in_set("built-in:spine"));
  REQUIRE(spine.templates.size() == spine.set.structures.size());
  CHECK(spine.templates.size() == 13);
  for (std::size_t k = 0; k < spine.templates.size(); ++k) {
    const TemplateOfSet& one = spine.set.structures[k];
    CAPTURE(one.name);
    const auto named = test::must(load_template(one.file.string()));
    CHECK(named->points == spine.templates[k].points);
    CHECK(named->topology->triangles() == spine.templates[k].triangles);
    if (k > 0) CHECK(std::ranges::find(one.neighbours, spine.set.structures[k - 1].name) != one.neighbours.end());
  }
  CHECK(says(built_in_set("built-in:kidney"), "choose built-in:spine"));
}

TEST_CASE("the built-in set is the same from its name and from a file") {
  const TemporaryFolder folder;
  const TemplateSet named = test::must(load_template_set("built-in:spine"));
  REQUIRE(write_template_set(named, folder.path / "spine.set.json"));
  const TemplateSet read = test::must(load_template_set((folder.path / "spine.set.json").string()));
  REQUIRE(read.structures.size() == named.structures.size());
  for (std::size_t k = 0; k < read.structures.size(); ++k) {
    CHECK(read.structures[k].name == named.structures[k].name);
    CHECK(read.structures[k].value == named.structures[k].value);
    CHECK(read.structures[k].file == named.structures[k].file);
    CHECK(read.structures[k].neighbours == named.structures[k].neighbours);
  }
}

}  // namespace homolog
