#include "core/base/text/text.h"

#include <doctest/doctest.h>

#include <string>
#include <utility>
#include <vector>

#include "core/base/files/file_stem.h"
#include "core/base/text/in_quotes.h"
#include "core/base/text/lengths.h"
#include "core/base/text/listed.h"

namespace homolog {

TEST_CASE("a file's name loses the ending of its format and no other dots") {
  for (const auto& [name, stem] :
       std::vector<std::pair<std::string, std::string>>{{"ct.nii.gz", "ct"},
                                                        {"CT.NII.GZ", "CT"},
                                                        {"sub.01.nii.gz", "sub.01"},
                                                        {"sub.02.nii", "sub.02"},
                                                        {"organ.seg.nrrd", "organ"},
                                                        {"v1.2.seg.nrrd", "v1.2"},
                                                        {"kidney 1.2.homolog", "kidney 1.2"},
                                                        {"points.mrk.json", "points"},
                                                        {"all.study.json", "all"},
                                                        {"femur.h5.json", "femur"},
                                                        {"1.2.840.113619.2", "1.2.840.113619.2"},
                                                        {"a.b.c", "a.b.c"},
                                                        {".nii.gz", ".nii"},
                                                        {"", ""}}) {
    CAPTURE(name);
    CHECK(file_stem("some.folder/" + name) == stem);
  }
}

TEST_CASE("blanks around a text are taken off and only whole texts are numbers") {
  CHECK(trimmed(" \t a b\r\n") == "a b");
  CHECK(trimmed(" \t\r\n").empty());
  CHECK(as_number<int>("-12") == -12);
  CHECK(as_number<double>("2.5e1") == 25);
  for (const char* text : {"", " 1", "1 ", "+1", "1.0", "1x", "99999999999"}) CHECK_FALSE(as_number<int>(text));
}

TEST_CASE("a line of a table is cut at its separator but not within quotes") {
  using Cells = std::vector<std::string>;
  CHECK(table_separator("a,b;c\td") == ',');
  CHECK(table_separator("a;b\tc") == '\t');
  CHECK(table_separator("a;b") == ';');
  CHECK(table_separator("a") == ',');
  CHECK(csv_fields(R"(a, "b,""c""" ,)") == Cells{"a", R"( b,"c" )", ""});
  CHECK(table_cells("a; \"b;c\" ;d\r", ';') == Cells{"a", "b;c", "d"});
}

TEST_CASE("bytes that are no UTF-8 are known as such") {
  for (const char* text : {"", "plain", "Öffnung", "心", "\xf0\x9f\xab\x80"}) CHECK(is_utf8(text));
  for (const char* text :
       {"caf\xe9", "\xc3", "\xc0\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xff", "\xe2\x82", "a\x80"})
    CHECK_FALSE(is_utf8(text));
}

TEST_CASE("names stand in quotes and lengths with their unit") {
  CHECK(in_quotes("lower pole") == "\"lower pole\"");
  CHECK(in_quotes(std::vector<std::string>{"a", "b"}) == "\"a\", \"b\"");
  CHECK(in_quotes(std::vector<std::string>{}).empty());
  CHECK(excerpt_in_quotes("a\tb") == "\"a?b\"");
  CHECK(in_mm(2.5, 2) == "2.50 mm");
  CHECK(in_mm(12.6, 0) == "13 mm");
  CHECK(in_mm_by_digits(0.12345, 3) == "0.123 mm");
  CHECK(in_mm_by_digits(12.5, 3) == "12.5 mm");
}

TEST_CASE("of many words the first are listed") {
  const std::vector<std::string> words{"a", "b", "c"};
  CHECK(some_of(words) == "a, b, c");
  CHECK(some_of(words, 2) == "a, b and 1 more");
}

}  // namespace homolog
