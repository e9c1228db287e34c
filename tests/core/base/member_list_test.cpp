#include "core/base/member_list.h"

#include <doctest/doctest.h>

#include <array>
#include <string>
#include <vector>

#include "core/base/enumerators.h"

namespace homolog {

namespace {

struct Pot {
  int litres = 0;
  std::string name;
  int handles = 0;
};

template <class Value>
struct PotRow {
  const char* key;
  Value Pot::*of;
};
template <class Value>
PotRow(const char*, Value Pot::*) -> PotRow<Value>;

enum class Metal { iron, copper, tin };

struct MetalRow {
  Metal metal;
};

}  // namespace

TEST_CASE("a list of members is complete where it names each once under a key of its own") {
  constexpr auto name = PotRow{"name", &Pot::name};
  constexpr auto litres = PotRow{"litres", &Pot::litres}, handles = PotRow{"handles", &Pot::handles};
  CHECK(names_all<Pot>(std::make_tuple(litres, name, handles)));
  CHECK_FALSE(names_all<Pot>(std::make_tuple(litres, name)));
  CHECK_FALSE(names_all<Pot>(std::make_tuple(litres, name, litres)));
  CHECK_FALSE(names_all<Pot>(std::make_tuple(litres, name, PotRow{"more", &Pot::litres})));
  CHECK_FALSE(names_all<Pot>(std::make_tuple(litres, name, PotRow{"litres", &Pot::handles})));
  CHECK(names_all<Pot>(std::make_tuple(&Pot::litres, &Pot::name, &Pot::handles)));
  CHECK_FALSE(names_all<Pot>(std::make_tuple(&Pot::litres, &Pot::name, &Pot::litres)));
  std::vector<std::string> keys;
  for_each_member(std::make_tuple(litres, name, handles), [&](const auto& row) { keys.emplace_back(row.key); });
  CHECK(keys == std::vector<std::string>{"litres", "name", "handles"});
}

TEST_CASE("a table has a row for each value of an enumeration in its order or it is told") {
  static_assert(enumerators<Metal>() == 3);
  const auto complete = [](const auto& rows) { return has_row_of_each<Metal>(rows, &MetalRow::metal); };
  CHECK(complete(std::array{MetalRow{Metal::iron}, MetalRow{Metal::copper}, MetalRow{Metal::tin}}));
  CHECK_FALSE(complete(std::array{MetalRow{Metal::iron}, MetalRow{Metal::copper}}));
  CHECK_FALSE(complete(std::array{MetalRow{Metal::iron}, MetalRow{Metal::tin}, MetalRow{Metal::copper}}));
  CHECK_FALSE(complete(std::array{MetalRow{Metal::iron}, MetalRow{Metal::copper}, MetalRow{Metal::copper}}));
}

}  // namespace homolog
