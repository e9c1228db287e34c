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

TEST_CASE("the templates of the built-in set are known by their names") {
  CHECK(built_in_set_source() == "built-in:spine");
  const std::string one = built_in_set_source("vertebrae_L3");
  CHECK((is_built_in(one) && !names_file(one) && !built_in_organ(one)));
  const auto third = test::must(load_template(one));
  CHECK(third->source == one);
  const auto below = test::must(load_template(built_in_set_source("vertebrae_L4")));
  CHECK(third->topology->triangles() == below->topology->triangles());
  CHECK(third->points.col(2).mean() > below->points.col(2).mean() + 25);
  CHECK(says(load_template("built-in:spine"), "name one of them, such as built-in:spine:vertebrae_L3"));
  CHECK(says(load_template("built-in:spine:L3"), "homolog set info built-in:spine lists them"));
  CHECK(says(load_volume("phantom:spine"), "for instance phantom:spine:1"));
}

TEST_CASE("a name of no organ and a phantom without a number are refused") {
  CHECK(says(load_template("built-in:liver"), "is no built-in template; there are built-in:kidney"));
  CHECK(says(load_volume("phantom:liver:1"), "choose kidney, vertebra, ventricle or spine"));
  for (const char* source : {"phantom:kidney", "phantom:kidney:", "phantom:kidney:x", "phantom:kidney:-1"})
    CHECK(says(load_volume(source), "for instance phantom:kidney:1"));
}

}  // namespace homolog
