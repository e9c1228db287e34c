#include "core/base/text/short_names.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <set>

// Names in rooms of so many letters; those of the window are measured in its font.

namespace homolog {

namespace {

std::ptrdiff_t letters_in(const std::string& text) {
  return std::count_if(text.begin(), text.end(),
                       [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; });
}

TextFits room_for(int letters) {
  return [letters](const std::string& text) { return letters_in(text) <= letters; };
}

}  // namespace

TEST_CASE("a text without its middle keeps its ends and whole letters") {
  const std::string text = "\xc3\xa4\xc3\xb6\xc3\xbc\xc3\xa4\xc3\xb6\xc3\xbc";  // six letters
  CHECK(shortened(text, room_for(6)) == text);
  CHECK(shortened(text, room_for(5)) == "\xc3\xa4\xc3\xb6\xe2\x80\xa6\xc3\xb6\xc3\xbc");
  CHECK(shortened(text, room_for(3)) == "\xc3\xa4\xe2\x80\xa6\xc3\xbc");
  CHECK(shortened(text, room_for(2)) == "\xe2\x80\xa6");
  CHECK(shortened(text, room_for(0)) == "");
  CHECK(shortened("", room_for(-5)) == "");
}

TEST_CASE("names of several words are cut short word by word and are never taken for each other") {
  const std::vector<std::string> names{"body anterior superior",
                                       "body anterior inferior",
                                       "body posterior superior",
                                       "body posterior inferior",
                                       "lamina left",
                                       "lamina right"};
  for (const int room : {20, 17, 15, 14}) {
    std::set<std::string> shown;
    for (const std::string& name : names) {
      const std::string text = shortened_among(name, names, room_for(room));
      CAPTURE(text);
      CHECK(letters_in(text) <= room);
      shown.insert(text);
      if (!name.starts_with("body")) continue;
      // What tells the four apart is there: both words.
      CHECK(text.find(name.find("anterior") != std::string::npos ? "ant" : "pos") != std::string::npos);
      CHECK(text.find(name.find("superior") != std::string::npos ? "sup" : "inf") != std::string::npos);
    }
    CHECK(shown.size() == names.size());
  }
  CHECK(shortened_among(names[0], names, room_for(14)) == "body ant. sup.");
  // Where the beginnings of words are the same, words are not cut to them.
  const std::vector<std::string> alike{"left intermediate lobe", "left interlobar lobe"};
  const std::string one = shortened_among(alike[0], alike, room_for(12)),
                    other = shortened_among(alike[1], alike, room_for(12));
  CHECK(one != other);
  CHECK(one.find("int.") == std::string::npos);
}

TEST_CASE("the numbers of cases stay whole where names are cut short") {
  const std::vector<std::string> names{"kidney_0001_left_2021", "kidney_0002_right_2022", "kidney_0013_left_2023"};
  for (const int room : {15, 12, 10})
    for (std::size_t k = 0; k < names.size(); ++k) {
      const std::string text = shortened_among(names[k], names, room_for(room));
      CAPTURE(text);
      CHECK(text.find(std::array{"0001", "0002", "0013"}[k]) != std::string::npos);
    }
}

TEST_CASE("names that would look alike keep what tells them apart") {
  std::vector<std::string> names;
  for (const char* number : {"00000", "00003", "00014", "00096"})
    names.push_back(std::string("case_") + number + "_left_healthy_thin");
  for (const int room : {17, 12, 8}) {
    std::set<std::string> shown;
    for (const std::string& name : names) {
      shown.insert(shortened_among(name, names, room_for(room)));
      CHECK(letters_in(shortened_among(name, names, room_for(room))) <= room);
    }
    CHECK(shown.size() == names.size());
    for (const char* number : {"14", "96"})  // whole, in each
      CHECK(std::any_of(shown.begin(), shown.end(),
                        [&](const std::string& one) { return one.find(number) != std::string::npos; }));
  }
  CHECK(shortened_among("left kidney of a horse", {"left kidney of a horse"}, room_for(8)) ==
        shortened("left kidney of a horse", room_for(8)));
  CHECK(shortened_among(names[0], names, room_for(60)) == names[0]);
}

}  // namespace homolog
