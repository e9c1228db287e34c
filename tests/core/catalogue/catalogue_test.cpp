#include "core/catalogue/catalogue.h"

#include <doctest/doctest.h>

#include "tests/must.h"
#include "tests/refusal.h"

namespace homolog {

TEST_CASE("what Homolog makes itself is known by its name and everything else is a file") {
  for (const Organ organ : {Organ::kidney, Organ::vertebra, Organ::ventricle}) {
    const std::string built_in = built_in_source(organ), phantom = phantom_source(organ, 3);
    CHECK((is_built_in(built_in) && !is_phantom(built_in) && !names_file(built_in)));
    CHECK((is_phantom(phantom) && !is_built_in(phantom) && !names_file(phantom)));
    CHECK(test::must(built_in_organ(built_in)) == organ);
    CHECK_FALSE(built_in_organ(phantom));
    CHECK(test::must(load_template(built_in))->source == built_in);
  }
  for (const char* file : {"kidney", "kidney.ply", "/images/phantom:kidney:1", "folder/built-in:kidney"})
    CHECK(names_file(file));
  CHECK_FALSE(names_file(""));
}

TEST_CASE("a phantom is the same under its name and its number") {
  const Volume named = test::must(load_volume(phantom_source(Organ::kidney, 2))).volume;
  CHECK(named.data == make_phantom(Organ::kidney, 2).image.data);
}

TEST_CASE("a name of no organ and a phantom without a number are refused") {
  CHECK(says(load_template("built-in:liver"), "choose kidney, vertebra or ventricle"));
  CHECK(says(load_volume("phantom:liver:1"), "choose kidney, vertebra or ventricle"));
  for (const char* source : {"phantom:kidney", "phantom:kidney:", "phantom:kidney:x", "phantom:kidney:-1"})
    CHECK(says(load_volume(source), "for instance phantom:kidney:1"));
}

}  // namespace homolog
